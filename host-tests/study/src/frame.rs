//! Columns of numbers.

use anyhow::{Context, bail};

/// A column.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Counts and numbers of things.
    Integer(Vec<i64>),
    /// Figures.
    Real(Vec<f64>),
    /// Samples.
    Single(Vec<f32>),
    /// Verdicts.
    Flag(Vec<bool>),
}

/// Columns of equal length, with their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Frame {
    /// Names and columns.
    pub columns: Vec<(String, Column)>,
}

impl Column {
    fn len(&self) -> usize {
        match self {
            Self::Integer(values) => values.len(),
            Self::Real(values) => values.len(),
            Self::Single(values) => values.len(),
            Self::Flag(values) => values.len(),
        }
    }

    /// Name of the type, for errors.
    fn kind(&self) -> &'static str {
        match self {
            Self::Integer(_) => "of integers",
            Self::Real(_) => "of real numbers",
            Self::Single(_) => "of single-precision numbers",
            Self::Flag(_) => "of flags",
        }
    }
}

impl Frame {
    /// Adds a column.
    pub fn push(&mut self, name: impl Into<String>, column: Column) {
        debug_assert!(self.columns.is_empty() || column.len() == self.rows());
        self.columns.push((name.into(), column));
    }

    /// Adds the rows of `other`, which has the same columns.
    pub fn append(&mut self, other: Self) -> anyhow::Result<()> {
        if self.columns.is_empty() {
            *self = other;
            return Ok(());
        }
        anyhow::ensure!(self.columns.len() == other.columns.len(), "other columns");
        for ((name, to), (other, from)) in self.columns.iter_mut().zip(other.columns) {
            anyhow::ensure!(*name == other, "column {other} in place of {name}");
            match (to, from) {
                (Column::Integer(to), Column::Integer(from)) => to.extend(from),
                (Column::Real(to), Column::Real(from)) => to.extend(from),
                (Column::Single(to), Column::Single(from)) => to.extend(from),
                (Column::Flag(to), Column::Flag(from)) => to.extend(from),
                _ => bail!("column {name} changes its type"),
            }
        }
        Ok(())
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |(_, column)| column.len())
    }

    /// The column of this name.
    pub fn column(&self, name: &str) -> anyhow::Result<&Column> {
        let column = self.columns.iter().find(|(known, _)| known == name);
        let (_, column) = column.with_context(|| format!("no column {name}"))?;
        Ok(column)
    }

    /// The column of this name, of real numbers.
    pub fn real(&self, name: &str) -> anyhow::Result<&[f64]> {
        match self.column(name)? {
            Column::Real(values) => Ok(values),
            other => bail!("column {name} is {}", other.kind()),
        }
    }

    /// The column of this name, of single-precision numbers.
    pub fn single(&self, name: &str) -> anyhow::Result<&[f32]> {
        match self.column(name)? {
            Column::Single(values) => Ok(values),
            other => bail!("column {name} is {}", other.kind()),
        }
    }

    /// The column of this name, of integers.
    pub fn integer(&self, name: &str) -> anyhow::Result<&[i64]> {
        match self.column(name)? {
            Column::Integer(values) => Ok(values),
            other => bail!("column {name} is {}", other.kind()),
        }
    }

    /// The column of this name, of flags.
    pub fn flag(&self, name: &str) -> anyhow::Result<&[bool]> {
        match self.column(name)? {
            Column::Flag(values) => Ok(values),
            other => bail!("column {name} is {}", other.kind()),
        }
    }
}
