//! Several polars in one file: what stands where, so that one can be taken out.

use anyhow::{anyhow, bail};

use super::{cells, is_rule, number};

/// Rows from which on a block of numbers is a table.
const LEAST: usize = 3;
/// Columns that are the same throughout one polar.
const SAME: [&str; 7] = [
    "re", "reynolds", "re/1e6", "re/10^6", "mach", "beta", "ncrit",
];

/// A table of numbers: the line of its first row, and the Reynolds number that is said above it.
struct Table {
    line: usize,
    reynolds: Option<f64>,
}

/// The tables in `text`, each of several rows of three numbers and more.
fn tables(text: &str) -> Vec<Table> {
    let mut tables = Vec::new();
    let (mut reynolds, mut rows) = (None, 0);
    for (line, text) in (1..).zip(text.lines()) {
        let cells = cells(text);
        // A row with one damaged cell is a row.
        let words = cells.iter().filter(|cell| number(cell).is_none()).count();
        let begins = cells.first().is_some_and(|cell| number(cell).is_some());
        if cells.len() > 2 && begins && words < 2 {
            rows += 1;
            if rows == LEAST {
                let line = line + 1 - LEAST;
                tables.push(Table { line, reynolds });
            }
        } else if !is_rule(text) {
            if rows > 0 {
                reynolds = None;
            }
            rows = 0;
            reynolds = said(text).or(reynolds);
        }
    }
    tables
}

/// The Reynolds number in a line such as `Re = 0.160 e 6`, `Reynolds number: 160000` or `0.75 Re ! in millions`.
fn said(line: &str) -> Option<f64> {
    let lower = line.to_lowercase().replace(',', " ");
    let words: Vec<&str> = lower
        .split(|c: char| c.is_whitespace() || "=:()[]#!".contains(c))
        .filter(|word| !word.is_empty())
        .collect();
    let at = words.iter().position(|w| matches!(*w, "re" | "reynolds"))?;
    let behind = words[at + 1..]
        .iter()
        .skip_while(|word| number(word).is_none());
    let behind: Vec<&str> = behind.copied().take(3).collect();
    let value = match *behind {
        [mantissa, "e", exponent] => number(&format!("{mantissa}e{exponent}"))?,
        [value, ..] => number(value)?,
        [] => number(words.first()?)?,
    };
    let millions = lower.contains("million") && value < 1e3;
    Some(if millions { 1e6 * value } else { value })
}

/// What is said of a file with several tables, if it is one.
pub fn listed_if_several(text: &str) -> String {
    match tables(text).len() {
        0 | 1 => String::new(),
        _ => listed(text),
    }
}

/// What is said of a file with several polars: where each begins, and what to do.
pub fn listed(text: &str) -> String {
    let each = |table: &Table| match table.reynolds {
        Some(reynolds) => format!("line {} (Re {reynolds})", table.line),
        None => format!("line {}", table.line),
    };
    let all: Vec<String> = tables(text).iter().map(each).collect();
    let from = match all.len() {
        0 | 1 => String::new(),
        _ => format!(": tables begin in {}", all.join(", ")),
    };
    format!("{from}. One file, one polar: leave the one that is wanted in a file of its own")
}

/// Whether rows of numbers follow behind this line.
pub fn goes_on(text: &str, line: usize) -> bool {
    tables(text).iter().any(|table| table.line > line)
}

/// Refuses rows of several polars that a column tells apart, and says which: `names` are those of the columns, `rows` the cells of each line.
pub fn by_column(origin: &str, names: &[&str], rows: &[(u64, Vec<f64>)]) -> anyhow::Result<()> {
    for (column, name) in names.iter().enumerate().filter(|(_, n)| SAME.contains(n)) {
        let value = |row: &(u64, Vec<f64>)| row.1.get(column).copied();
        let mut values: Vec<f64> = rows.iter().filter_map(value).collect();
        values.sort_by(f64::total_cmp);
        values.dedup();
        let of = |wanted: f64| rows.iter().filter(move |row| value(row) == Some(wanted));
        if values.len() < 2 || values.iter().any(|v| of(*v).count() < LEAST) {
            continue;
        }
        let each = |v: &f64| {
            let lines = of(*v).map(|row| row.0);
            let (first, last) = (lines.clone().min(), lines.max());
            format!(
                "{v} (lines {} to {})",
                first.unwrap_or(0),
                last.unwrap_or(0)
            )
        };
        let each: Vec<String> = values.iter().map(each).collect();
        let first = rows.first().ok_or_else(|| anyhow!("{origin}: no rows"))?.0;
        bail!(
            "{origin}:{first}: several polars, by the column {name}: {}. One file, one polar: leave the rows of one of them",
            each.join(", ")
        );
    }
    Ok(())
}
