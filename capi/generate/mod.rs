//! What is made of the parameter table and of the sources: the header, the table in the docs, the parameter file of
//! PX4. Run `cargo run --package alula-capi --example generate` after a change; `cargo test` compares.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use alula_capi::{Kind, PARAMETERS, Parameter};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Every generated file, by its path under the repository's root, and what it must hold.
pub fn files() -> Result<[(PathBuf, String); 3]> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
    let root = root.ok_or("no repository")?;
    Ok([
        (root.join("capi/include/alula.h"), header()?),
        (root.join("docs/parameters.md"), table()?),
        (root.join("capi/examples/px4/module.yaml"), px4()?),
    ])
}

/// The header, by cbindgen from the sources; the parameters' structure from the table, with what it knows of each.
fn header() -> Result<String> {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let scratch = tempfile::tempdir()?;
    let parameters = scratch.path().join("parameters.rs");
    let declarations = fs::read_to_string(sources.join("parameters.rs"))?;
    fs::write(&parameters, declarations + &structure()?)?;
    let mut bindings = Vec::new();
    cbindgen::Builder::new()
        .with_config(cbindgen::Config::from_file(
            sources.join("../cbindgen.toml"),
        )?)
        .with_src(sources.join("boundary.rs"))
        .with_src(sources.join("code.rs"))
        .with_src(parameters)
        .with_src(sources.join("table.rs"))
        .with_src(sources.join("controller.rs"))
        .with_src(sources.join("plane.rs"))
        .with_src(sources.join("ned_input.rs"))
        .with_src(sources.join("ned_command.rs"))
        .with_src(sources.join("guide.rs"))
        .with_src(sources.join("envelope.rs"))
        .generate()?
        .write(&mut bindings);
    let text = String::from_utf8(bindings)?;
    // Markdown of the sources, which is noise in C.
    Ok(text
        .replace("\\[", "[")
        .replace("\\]", "]")
        .replace(" * # Safety", " * Pointers:"))
}

/// The parameters' structure in Rust, as the macro makes it, for cbindgen to read.
fn structure() -> Result<String> {
    let mut text = String::from(
        "\n/// Everything that a controller is made of. `alula_parameters_default` fills in the defaults.\n\
         #[repr(C)]\npub struct Parameters {\n\
         /// `ALULA_HEADER(alula_parameters)`.\npub header: u32,\n",
    );
    for p in PARAMETERS {
        let about = match p.kind {
            Kind::Number => format!(
                "{} From {} to {}, default {}.",
                unit(p),
                number(p.min),
                number(p.max),
                number(p.default)
            ),
            Kind::Choice(choices) => format!("{}; default {}.", listed(choices), p.default),
        };
        let declaration = match p.kind {
            Kind::Number => "f32",
            Kind::Choice(_) => "u32",
        };
        for line in wrapped(p.meaning).into_iter().chain(wrapped(&about)) {
            writeln!(text, "/// {line}")?;
        }
        writeln!(text, "pub {}: {declaration},", p.name)?;
    }
    Ok(text + "}\n")
}

fn unit(p: &Parameter) -> String {
    match p.unit {
        "" => "No unit.".into(),
        unit => format!("Unit: {unit}."),
    }
}

/// A number as a person writes it, in a form that C and YAML read too.
fn number(value: f32) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        let text = format!("{value:e}");
        if text.contains('.') {
            text
        } else {
            text.replace('e', ".0e")
        }
    } else {
        format!("{value:?}")
    }
}

/// `text` in lines for a comment.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("there is one");
        if !line.is_empty() && line.len() + word.len() > 90 {
            lines.push(word.into());
        } else {
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines
}

/// `0 = a, 1 = b`.
fn listed(choices: &[&str]) -> String {
    let numbered = choices.iter().enumerate();
    let items: Vec<_> = numbered.map(|(n, c)| format!("{n} = {c}")).collect();
    items.join(", ")
}

/// The parameters in groups, in the table's order.
fn groups() -> impl Iterator<Item = &'static [Parameter]> {
    PARAMETERS.chunk_by(|a, b| a.group == b.group)
}

/// The table of the docs.
fn table() -> Result<String> {
    let mut text = String::from(
        "# Parameters\n\n\
         Fields of `alula_parameters`, in order, with the names they have in PX4's parameter file.\n\
         Made by `cargo run --package alula-capi --example generate` from `capi/src/parameters.rs`; do not edit.\n",
    );
    for group in groups() {
        writeln!(
            text,
            "\n## {}\n\n| name | PX4 | unit | minimum | maximum | default | meaning |\n\
             |---|---|---|---:|---:|---:|---|",
            group[0].group
        )?;
        for p in group {
            let choices = match p.kind {
                Kind::Number => String::new(),
                Kind::Choice(choices) => format!(" {}.", listed(choices)),
            };
            writeln!(
                text,
                "| `{}` | `{}` | {} | {} | {} | {} | {}{choices} |",
                p.name,
                p.px4,
                p.unit,
                shown(p, p.min),
                shown(p, p.max),
                shown(p, p.default),
                p.meaning.replace('|', "\\|"),
            )?;
        }
    }
    Ok(text)
}

/// A value of a parameter, as an integer for a choice.
fn shown(p: &Parameter, value: f32) -> String {
    match p.kind {
        Kind::Number => number(value),
        Kind::Choice(_) => value.to_string(),
    }
}

/// The parameter definitions of a PX4 module.
fn px4() -> Result<String> {
    let mut text = String::from(
        "# Parameters of alula, in the form of a PX4 module's `module.yaml`.\n\
         # Made by `cargo run --package alula-capi --example generate` from `capi/src/parameters.rs`; do not edit.\n\
         module_name: alula\nparameters:\n",
    );
    for group in groups() {
        writeln!(
            text,
            "  - group: Alula {}\n    definitions:",
            group[0].group
        )?;
        for p in group {
            writeln!(
                text,
                "      {}:\n        description:\n          short: {:?}",
                p.px4, p.meaning
            )?;
            match p.kind {
                Kind::Number => {
                    writeln!(text, "        type: float")?;
                    if !p.unit.is_empty() {
                        writeln!(text, "        unit: {}", p.unit.replace(' ', "*"))?;
                    }
                    for (key, value) in [("min", p.min), ("max", p.max), ("default", p.default)] {
                        writeln!(text, "        {key}: {}", number(value))?;
                    }
                    writeln!(text, "        decimal: 4")?;
                }
                Kind::Choice(choices) => {
                    writeln!(text, "        type: enum\n        values:")?;
                    for (n, choice) in choices.iter().enumerate() {
                        writeln!(text, "          {n}: {choice:?}")?;
                    }
                    writeln!(text, "        default: {}", p.default)?;
                }
            }
        }
    }
    Ok(text)
}
