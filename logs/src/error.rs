//! Why a log could not be read or written.

use std::fmt;
use std::path::Path;

/// A refusal, with the place that caused it.
#[derive(Debug)]
pub enum Error {
    /// The operating system refused.
    Io {
        /// The file.
        file: String,
        /// Its reason.
        source: std::io::Error,
    },
    /// A CSV file does not hold what it must.
    Csv {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: u64,
        /// The column's name, where one column is at fault.
        column: Option<String>,
        /// What is wrong.
        problem: String,
    },
    /// A column map does not parse, or asks for what cannot be.
    Map {
        /// The file.
        file: String,
        /// Line, counted from 1, where the text itself is at fault.
        line: Option<usize>,
        /// What is wrong.
        problem: String,
    },
    /// A binary or text log cannot be read at all.
    Format {
        /// The file.
        file: String,
        /// Byte at which reading stopped.
        offset: usize,
        /// What is wrong.
        problem: String,
    },
    /// A table is not one: columns of different lengths, time that is not finite or runs backwards, a name twice.
    Table {
        /// The topic's name.
        topic: String,
        /// What is wrong.
        problem: String,
    },
    /// A log cannot be expressed in the format asked for.
    Write {
        /// What is wrong.
        problem: String,
    },
}

impl fmt::Display for Error {
    /// One line: control characters of what is quoted are escaped.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Io { file, source } => format!("{file}: {source}"),
            Self::Csv {
                file,
                line,
                column: Some(column),
                problem,
            } => format!("{file}: line {line}, column `{column}`: {problem}"),
            Self::Csv {
                file,
                line,
                column: None,
                problem,
            } => format!("{file}: line {line}: {problem}"),
            Self::Map {
                file,
                line: Some(line),
                problem,
            } => format!("{file}: line {line}: {problem}"),
            Self::Map {
                file,
                line: None,
                problem,
            } => format!("{file}: {problem}"),
            Self::Format {
                file,
                offset,
                problem,
            } => format!("{file}: byte {offset}: {problem}"),
            Self::Table { topic, problem } => format!("topic `{topic}`: {problem}"),
            Self::Write { problem } => format!("cannot be written: {problem}"),
        };
        text.chars().try_for_each(|c| match c.is_control() {
            true => write!(f, "{}", c.escape_default()),
            false => write!(f, "{c}"),
        })
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Io { source, .. } => Some(source),
            _ => None,
        }
    }
}

/// A log that the format cannot hold.
pub(crate) fn problem<T>(problem: String) -> Result<T, Error> {
    Err(Error::Write { problem })
}

/// What writing to a writer that failed is.
pub(crate) fn output(source: std::io::Error) -> Error {
    Error::Io {
        file: "output".into(),
        source,
    }
}

pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(|source| Error::Io {
        file: path.display().to_string(),
        source,
    })
}
