//! Logs, topics and columns; the last value held.

use crate::Error;

/// What a file held: topics, in the file's order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// The tables.
    pub topics: Vec<Topic>,
    /// What the reader left out or repaired, in words. Empty for a sound file.
    pub notes: Vec<String>,
}

impl Log {
    /// The topic `name` of the lowest instance.
    #[must_use]
    pub fn topic(&self, name: &str) -> Option<&Topic> {
        self.topics
            .iter()
            .filter(|t| t.name == name)
            .min_by_key(|t| t.instance)
    }

    /// The topic `name` of one instance: the second airspeed sensor, the third estimator.
    #[must_use]
    pub fn instance(&self, name: &str, instance: u8) -> Option<&Topic> {
        self.topics
            .iter()
            .find(|t| t.name == name && t.instance == instance)
    }

    /// The column `column` of the topic `topic`, lowest instance.
    #[must_use]
    pub fn column(&self, topic: &str, column: &str) -> Option<&Column> {
        self.topic(topic)?.column(column)
    }

    /// Refuses a log without a row: nothing can be done with it, and its notes say why.
    pub(crate) fn not_empty(self, file: &str) -> Result<Self, Error> {
        if self.topics.iter().any(|topic| !topic.time.is_empty()) {
            return Ok(self);
        }
        let why = self.notes.iter().map(|note| format!("; {note}"));
        Err(Error::Format {
            file: file.into(),
            offset: 0,
            problem: format!("no row of data{}", why.collect::<String>()),
        })
    }
}

/// A table: columns over one time base.
///
/// Every column is as long as the time, and time is finite and does not run backwards: [`Topic::new`] sees to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    name: String,
    instance: u8,
    time: Vec<f64>,
    columns: Vec<Column>,
}

/// One quantity over the time of its topic.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// Its name, as the log gives it. Elements of arrays are `name[0]`, `name[1]`, …
    pub name: String,
    /// Its unit as the log gives it, empty where the log gives none.
    pub unit: String,
    /// Its values. NaN where the log holds none.
    pub values: Vec<f64>,
}

impl Column {
    /// A column.
    #[must_use]
    pub fn new(name: &str, unit: &str, values: Vec<f64>) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            values,
        }
    }
}

impl Topic {
    /// A table of `columns` over `time` \[s\].
    ///
    /// # Errors
    /// A column of another length than the time, a name twice, a time that is not finite or runs backwards.
    pub fn new(
        name: &str,
        instance: u8,
        time: Vec<f64>,
        columns: Vec<Column>,
    ) -> Result<Self, Error> {
        let problem = |problem: String| {
            Err(Error::Table {
                topic: name.into(),
                problem,
            })
        };
        if let Some(c) = columns.iter().find(|c| c.values.len() != time.len()) {
            let (rows, times) = (c.values.len(), time.len());
            return problem(format!(
                "column `{}` has {rows} values for {times} times",
                c.name
            ));
        }
        let mut names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            return problem(format!("column `{}` is there twice", pair[0]));
        }
        if let Some(row) = time.iter().position(|t| !t.is_finite()) {
            return problem(format!("time of row {row} is {}", time[row]));
        }
        if let Some(row) = time.windows(2).position(|pair| pair[1] < pair[0]) {
            let (before, after) = (time[row], time[row + 1]);
            return problem(format!(
                "time runs backwards at row {}: {after} after {before}",
                row + 1
            ));
        }
        Ok(Self {
            name: name.into(),
            instance,
            time,
            columns,
        })
    }

    /// A table of which the caller knows that it is one.
    pub(crate) fn unchecked(name: &str, time: Vec<f64>, columns: Vec<Column>) -> Self {
        Self {
            name: name.into(),
            instance: 0,
            time,
            columns,
        }
    }

    /// A table whose rows a reader took from a file that may be damaged: rows without a finite time are dropped, rows out
    /// of order are sorted, and a note is left of either. None without rows or without columns, as a message of text alone
    /// has none. Of columns of one name the first is kept.
    pub(crate) fn from_rows(
        name: &str,
        instance: u8,
        mut time: Vec<f64>,
        mut columns: Vec<Column>,
        notes: &mut Vec<String>,
    ) -> Option<Self> {
        let mut order: Vec<usize> = (0..time.len())
            .filter(|&row| time[row].is_finite())
            .collect();
        if order.len() < time.len() {
            notes.push(format!(
                "{name}: {} rows without a time dropped",
                time.len() - order.len()
            ));
        }
        if !order.is_sorted_by(|&a, &b| time[a] <= time[b]) {
            notes.push(format!("{name}: time runs backwards; rows sorted"));
            order.sort_by(|&a, &b| time[a].total_cmp(&time[b]));
        }
        if order.is_empty() || columns.is_empty() {
            return None;
        }
        if order.len() < time.len() || !order.is_sorted() {
            for column in &mut columns {
                column.values = order.iter().map(|&row| column.values[row]).collect();
            }
            time = order.iter().map(|&row| time[row]).collect();
        }
        let mut seen = std::collections::HashSet::new();
        columns.retain(|c| seen.insert(c.name.clone()));
        Some(Self {
            name: name.into(),
            instance,
            time,
            columns,
        })
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Which of several topics of its name it is, from 0.
    #[must_use]
    pub fn instance(&self) -> u8 {
        self.instance
    }

    /// Time of each row \[s\], in the log's own epoch; never decreasing.
    #[must_use]
    pub fn time(&self) -> &[f64] {
        &self.time
    }

    /// Its columns.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The column `name`.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|c| c.name == name)
    }

    /// The rows of this topic as they stood at each time of `base` \[s\].
    #[must_use]
    pub fn held_at(&self, base: &[f64]) -> Held {
        let row = |&t: &f64| self.time.partition_point(|&own| own <= t).checked_sub(1);
        let rows: Vec<Option<usize>> = base.iter().map(row).collect();
        let age = std::iter::zip(base, &rows)
            .map(|(t, row)| row.map_or(f64::INFINITY, |row| t - self.time[row]))
            .collect();
        Held { rows, age }
    }
}

/// For each time of a base the last row of a topic up to then.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    rows: Vec<Option<usize>>,
    /// Time since that row \[s\]; infinite before the first row.
    pub age: Vec<f64>,
}

impl Held {
    /// The values of `column`, a column of the topic, held at the base; NaN before the first row.
    #[must_use]
    pub fn values(&self, column: &Column) -> Vec<f64> {
        let value = |row: &Option<usize>| row.and_then(|row| column.values.get(row).copied());
        self.rows
            .iter()
            .map(|row| value(row).unwrap_or(f64::NAN))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topic(time: &[f64]) -> Result<Topic, Error> {
        let values = (0..time.len()).map(|i| i as f64).collect();
        Topic::new("t", 0, time.to_vec(), vec![Column::new("x", "m", values)])
    }

    #[test]
    fn values_are_held_with_their_age() {
        let topic = topic(&[1.0, 2.0, 2.0, 4.0]).unwrap();
        let held = topic.held_at(&[0.5, 1.0, 1.5, 2.0, 10.0]);
        let values = held.values(topic.column("x").unwrap());
        assert!(values[0].is_nan());
        // Of two rows at one time the later one holds.
        assert_eq!(values[1..], [0.0, 0.0, 2.0, 3.0]);
        assert_eq!(held.age, [f64::INFINITY, 0.0, 0.5, 0.0, 6.0]);
    }

    #[test]
    fn what_is_no_table_is_refused() {
        assert!(
            topic(&[1.0, 0.5])
                .unwrap_err()
                .to_string()
                .contains("row 1: 0.5 after 1")
        );
        assert!(
            topic(&[1.0, f64::NAN])
                .unwrap_err()
                .to_string()
                .contains("row 1 is NaN")
        );
        let x = Column::new("x", "", vec![0.0]);
        let twice = Topic::new("t", 0, vec![0.0], vec![x.clone(), x.clone()]);
        assert!(
            twice
                .unwrap_err()
                .to_string()
                .contains("`x` is there twice")
        );
        let short = Topic::new("t", 0, vec![0.0, 1.0], vec![x]);
        assert!(
            short
                .unwrap_err()
                .to_string()
                .contains("1 values for 2 times")
        );
    }

    #[test]
    fn rows_of_a_damaged_file_are_sorted_and_noted() {
        let mut notes = Vec::new();
        let x = Column::new("x", "", vec![0.0, 1.0, 2.0, 3.0]);
        let time = vec![1.0, f64::NAN, 3.0, 2.0];
        let topic = Topic::from_rows("t", 0, time, vec![x.clone(), x], &mut notes).unwrap();
        assert_eq!(topic.time(), [1.0, 2.0, 3.0]);
        assert_eq!(topic.columns().len(), 1);
        assert_eq!(topic.columns()[0].values, [0.0, 3.0, 2.0]);
        assert_eq!(notes.len(), 2);
        assert!(Topic::from_rows("t", 0, vec![f64::NAN], Vec::new(), &mut notes).is_none());
    }

    #[test]
    fn the_lowest_instance_is_found_first() {
        let of = |instance| Topic::new("t", instance, Vec::new(), Vec::new()).unwrap();
        let log = Log {
            topics: vec![of(2), of(1)],
            ..Log::default()
        };
        assert_eq!(log.topic("t").unwrap().instance(), 1);
        assert_eq!(log.instance("t", 2).unwrap().instance(), 2);
        assert!(log.topic("u").is_none() && log.column("t", "x").is_none());
    }
}
