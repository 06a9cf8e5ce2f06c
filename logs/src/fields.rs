//! The columns of a topic as the fields of a message: elements of an array together again.

use crate::error::problem;
use crate::{Column, Error, Topic};

/// One field: one column, or the elements of an array.
pub(crate) struct Field<'a> {
    /// The name without an index, of letters, digits and underscores only.
    pub name: String,
    /// One column; of an array, all elements from 0 on.
    pub columns: Vec<&'a Column>,
    /// Whether the field is an array.
    pub array: bool,
    /// Where its first column stands in the topic.
    pub first: usize,
}

/// The fields of `topic`, in its order. Neighbouring columns `name[0]`, `name[1]`, … are one array. In every other name
/// each character that a message's field may not have becomes an underscore.
pub(crate) fn fields(topic: &Topic) -> Vec<Field<'_>> {
    let mut fields: Vec<Field> = Vec::new();
    for (first, column) in topic.columns().iter().enumerate() {
        let element = element(&column.name);
        if let Some((name, index)) = element
            && let Some(last) = fields.last_mut()
            && last.array
            && last.name == name
            && last.columns.len() == index
        {
            last.columns.push(column);
        } else if let Some((name, 0)) = element {
            fields.push(Field {
                name: name.into(),
                columns: vec![column],
                array: true,
                first,
            });
        } else {
            fields.push(Field {
                name: identifier(&column.name),
                columns: vec![column],
                array: false,
                first,
            });
        }
    }
    fields
}

/// `name[index]` in its two parts, where `name` is an identifier already.
fn element(name: &str) -> Option<(&str, usize)> {
    let (name, index) = name.strip_suffix(']')?.split_once('[')?;
    (identifier(name) == name).then_some((name, index.parse().ok()?))
}

/// `name` with every character but ASCII letters, digits and underscores replaced by an underscore.
pub(crate) fn identifier(name: &str) -> String {
    let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let plain: String = name.chars().map(allowed).collect();
    if plain.is_empty() { "_".into() } else { plain }
}

/// The first name that two of `names` share.
pub(crate) fn twice<'a>(names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let mut seen = std::collections::HashSet::new();
    names.into_iter().find(|name| !seen.insert(*name))
}

/// A row of a log, to be written.
pub(crate) struct TimedRow {
    /// Its time \[s\].
    pub time: f64,
    /// Its time in the ticks of the format.
    pub ticks: u64,
    /// Index of its topic in the log.
    pub topic: usize,
    /// Its index in the topic.
    pub row: usize,
}

/// The rows of all topics in the order of their times, which the format counts in so many ticks `per_second`.
///
/// # Errors
/// [`Error::Write`]: a time before 0, or of more ticks than 64 bits hold.
pub(crate) fn rows_by_time(topics: &[Topic], per_second: f64) -> Result<Vec<TimedRow>, Error> {
    let mut timed = Vec::new();
    for (topic, of) in topics.iter().enumerate() {
        for (row, &time) in of.time().iter().enumerate() {
            let ticks = (time * per_second).round() as u64;
            timed.push(TimedRow {
                time,
                ticks,
                topic,
                row,
            });
        }
    }
    timed.sort_by(|a, b| a.time.total_cmp(&b.time));
    let held = 0.0..u64::MAX as f64 / per_second;
    match timed.iter().find(|row| !held.contains(&row.time)) {
        Some(row) => problem(format!("a row at the time {} s", row.time)),
        None => Ok(timed),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_of_arrays_come_together() {
        let names = ["x", "q[0]", "q[1]", "y[1]", "esc[0].rpm", "z[0]", "z[2]"];
        let columns = names.iter().map(|n| Column::new(n, "", vec![])).collect();
        let topic = Topic::new("t", 0, vec![], columns).unwrap();
        let named: Vec<(String, usize, bool)> = fields(&topic)
            .into_iter()
            .map(|f| (f.name, f.columns.len(), f.array))
            .collect();
        let expected = [
            ("x", 1, false),
            ("q", 2, true),
            ("y_1_", 1, false),
            ("esc_0__rpm", 1, false),
            ("z", 1, true),
            ("z_2_", 1, false),
        ];
        assert_eq!(
            named,
            expected.map(|(name, n, array)| (name.to_owned(), n, array))
        );
    }
}
