//! The results as a Markdown page.

use std::collections::BTreeMap;
use std::fmt::Write;

use anyhow::Context;
use minijinja::{Environment, context};

use super::Table;
use super::comparison::{definitions, summary, tables};
use crate::study::{Comparison, Results, names};

fn write(table: &Table, text: &mut String) {
    let line = |cells: Vec<&str>| format!("| {} |\n", cells.join(" | "));
    let escaped: Vec<String> = table.header.iter().map(|h| h.replace('|', "\\|")).collect();
    text.push_str(&line(escaped.iter().map(String::as_str).collect()));
    let rules = (0..table.header.len()).map(|i| if i == 0 { "---" } else { "---:" });
    let _ = writeln!(text, "|{}|", rules.collect::<Vec<_>>().join("|"));
    for row in &table.rows {
        text.push_str(&line(row.iter().map(String::as_str).collect()));
    }
}

/// The page. Introduction and discussion are templates in which `v[policy][condition]` has the figures by the names of
/// the tables' columns.
pub fn markdown(name: &str, comparison: &Comparison, results: &Results) -> anyhow::Result<String> {
    let mut values: BTreeMap<String, BTreeMap<String, BTreeMap<String, String>>> = BTreeMap::new();
    for cell in &results.cells {
        let figures = names().into_iter().zip(cell.texts()).collect();
        let policy = values.entry(cell.policy.clone()).or_default();
        policy.insert(cell.condition.clone(), figures);
    }
    let values = minijinja::Value::from(values);
    let mut environment = Environment::new();
    // A name mistyped in the prose is an error, not a gap.
    environment.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
    let prose = |field: &str, text: &str| {
        environment
            .render_str(text, context! { v => values.clone() })
            .with_context(|| field.to_owned())
    };
    let command = match name {
        "tail-sitter" => "compare --markdown docs/comparison.md".to_owned(),
        _ => format!("compare {name}.toml --markdown FILE"),
    };
    let mut text = format!(
        "<!-- Written by `cargo run --release -- {command}`; edit the comparison instead. -->\n\n{}\n",
        prose("introduction", &comparison.introduction)?.trim()
    );
    text.push_str("\n## Policies\n\n| policy | |\n|---|---|\n");
    for policy in &comparison.policies {
        let _ = writeln!(text, "| {} | {} |", policy.name, policy.title);
    }
    let all = summary(comparison, results);
    let _ = write!(text, "\n## {}\n\n", all.title);
    write(&all, &mut text);
    let discussion = prose("discussion", &comparison.discussion)?;
    let _ = write!(
        text,
        "\n{}\n\n## Every figure\n\n{}\n",
        discussion.trim(),
        definitions()
    );
    for table in tables(comparison, results) {
        let _ = write!(text, "\n### {}\n\n", table.title);
        write(&table, &mut text);
    }
    Ok(text)
}
