//! Inputs that a log does not know in some rows: a controller that lacks one does not follow there, and says no cause.

/// In which rows an input is not known.
pub struct Unknown {
    what: &'static str,
    /// Components that are not known in some row.
    parts: Vec<&'static str>,
    rows: usize,
    /// First and last time of those rows \[s\].
    times: Option<[f64; 2]>,
}

impl Unknown {
    /// Of the input `what`, before the first row.
    pub fn of(what: &'static str) -> Self {
        Self {
            what,
            parts: Vec::new(),
            rows: 0,
            times: None,
        }
    }

    /// Counts the row at `t` \[s\] with these components.
    pub fn count<const N: usize>(&mut self, t: f64, names: [&'static str; N], values: [f64; N]) {
        let unknown = std::iter::zip(names, values).filter(|(_, value)| !value.is_finite());
        let before = self.rows;
        for (name, _) in unknown {
            self.rows = before + 1;
            if !self.parts.contains(&name) {
                self.parts.push(name);
            }
        }
        if self.rows > before {
            let first = self.times.map_or(t, |[first, _]| first);
            self.times = Some([first, t]);
        }
    }

    /// What is to be said of it, of a log with so many rows.
    pub fn note(&self, rows: usize) -> Option<String> {
        let [first, last] = self.times?;
        Some(format!(
            "{} not known in {} of {rows} rows, from {first} to {last} s ({}): without it the mode is safe there",
            self.what,
            self.rows,
            self.parts.join(", ")
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_components_and_times_are_said() {
        let names = ["north", "east", "down"];
        let mut unknown = Unknown::of("velocity");
        assert_eq!(unknown.note(0), None);
        unknown.count(1.0, names, [0.0; 3]);
        unknown.count(2.0, names, [0.0, f64::NAN, 0.0]);
        unknown.count(3.0, names, [0.0, f64::NAN, f64::INFINITY]);
        unknown.count(4.0, names, [0.0; 3]);
        assert_eq!(
            unknown.note(4).unwrap(),
            "velocity not known in 2 of 4 rows, from 2 to 3 s (east, down): without it the mode is safe there"
        );
    }
}
