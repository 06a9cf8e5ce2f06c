//! Forms of other programs that are no table under a line of names.

use anyhow::{anyhow, ensure};

use super::super::Read;
use super::{cells, number, several, sorted};

/// What a file is that is no polar but is taken for one: its line, and what to do.
pub fn named(text: &str) -> Option<(usize, String)> {
    let first = text.lines().position(|line| !line.trim().is_empty())?;
    let begins = text.lines().nth(first)?.trim_start().to_lowercase();
    if !begins.starts_with('<') {
        return None;
    }
    let lower = text.to_lowercase();
    let what = if lower.contains("jsbsim")
        || lower.contains("<fdm_config")
        || lower.contains("<tabledata")
    {
        "JSBSim's XML, where lift and drag are functions of their own, with angles in radians as a rule"
    } else if lower.contains("<html") {
        "a page of HTML"
    } else if lower.contains("xflr5") || lower.contains("<explane") {
        "XFLR5's XML of a plane or an analysis, and no polar"
    } else {
        "XML"
    };
    Some((
        first + 1,
        format!("{what}: write α [°], c_L and c_D as a table under the names alpha_deg, cl and cd"),
    ))
}

/// Whether it holds AVL's total forces: `CLtot =`. VSPAERO has a column of that name.
pub fn is_avl(text: &str) -> bool {
    let mut words = text.split_whitespace().peekable();
    while let Some(word) = words.next() {
        if word == "CLtot" && words.peek() == Some(&"=") {
            return true;
        }
    }
    false
}

/// What AeroDyn 13 has below its table.
pub fn is_end(line: &str) -> bool {
    let line = line.trim();
    line.eq_ignore_ascii_case("EOT") || line.eq_ignore_ascii_case("END")
}

/// What AeroDyn 13 and QBlade say above a table without names.
const TABLES: &str = "number of airfoil tables";
const QBLADE: [&str; 2] = ["POLARNAME", "ISDECOMPOSED"];

/// Whether it is one of the forms whose columns have no names.
pub fn is_nameless(text: &str) -> bool {
    let known = |line: &str| {
        line.to_lowercase().contains(TABLES) || QBLADE.iter().any(|word| line.contains(word))
    };
    text.lines().any(known)
}

/// The rows of such a form: lines of numbers alone, α, c_L, c_D and others.
pub fn nameless(origin: &str, all: &str) -> anyhow::Result<Read> {
    let is_several = |line: &str| {
        let first = cells(line).first().and_then(|cell| number(cell));
        let tables = line.to_lowercase().contains(TABLES);
        // QBlade has a Reynolds number for each.
        let reynolds = line.contains("REYNOLDS");
        let numbers = cells(line)
            .iter()
            .filter(|cell| number(cell).is_some())
            .count();
        tables && first.is_some_and(|n| n > 1.0) || reynolds && numbers > 1
    };
    let mut rows = Vec::new();
    for (line, text) in (1..).zip(all.lines()) {
        ensure!(
            !is_several(text),
            "{origin}:{line}: several polars in one file{}",
            several::listed(all)
        );
        if is_end(text) {
            ensure!(
                !several::goes_on(all, line as usize),
                "{origin}:{line}: another table follows{}",
                several::listed(all)
            );
            break;
        }
        let numbers: Option<Vec<f64>> = cells(text).iter().map(|cell| number(cell)).collect();
        if let Some([alpha, lift, drag, ..]) = numbers.as_deref() {
            rows.push((line, [*alpha, *lift, *drag]));
        }
    }
    ensure!(
        !rows.is_empty(),
        "{origin}: AeroDyn 13's or QBlade's, and no rows of numbers in it: α, c_L, c_D"
    );
    sorted(origin, all, rows, false)
}

/// The rows of AVL's outputs, one each.
pub fn avl(origin: &str, text: &str) -> anyhow::Result<Read> {
    let mut rows = Vec::new();
    let mut alpha = None;
    let mut lift = None;
    for (n, line) in text.lines().enumerate() {
        let value = |name: &str| -> anyhow::Result<Option<f64>> {
            let mut words = line.split_whitespace().skip_while(|word| *word != name);
            let after = words.nth(2);
            let parsed = after.map(|word| {
                let bad = |_| anyhow!("{origin}:{}: {word:?} is not a number", n + 1);
                word.parse().map_err(bad)
            });
            parsed.transpose()
        };
        alpha = value("Alpha")?.or(alpha);
        lift = value("CLtot")?.or(lift);
        if let Some(drag) = value("CDtot")? {
            let (Some(alpha), Some(lift)) = (alpha.take(), lift.take()) else {
                return Err(anyhow!(
                    "{origin}:{}: CDtot without Alpha and CLtot above it",
                    n + 1
                ));
            };
            rows.push((n as u64 + 1, [alpha, lift, drag]));
        }
    }
    ensure!(!rows.is_empty(), "{origin}: no CDtot");
    sorted(origin, text, rows, true)
}
