//! The files that are made from the parameter tables and the sources: the header, the page in the docs, the parameter files
//! of the PX4 module. Run `cargo run --package alula-capi --example generate` after a change; `cargo test` compares.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use alula::guidance::Status;
use alula::{ModelParameters, Row};
use alula_capi::{ALULA_MODEL_TABLE, CHOICES, MISSION, SECTIONS, Section};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Every generated file, by its path under the repository's root, and what it must hold.
pub fn files() -> Result<[(PathBuf, String); 4]> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
    let root = root.ok_or("no repository")?;
    let module = root.join("capi/examples/px4/src/modules/alula_guidance");
    Ok([
        (root.join("capi/include/alula.h"), header()?),
        (root.join("docs/parameters.md"), table()?),
        (module.join("module.yaml"), px4()?),
        (module.join("parameters.hpp"), px4_parameters()?),
    ])
}

/// The header, by cbindgen from the sources. It does not expand macros: what they make is written out for it.
fn header() -> Result<String> {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let scratch = tempfile::tempdir()?;
    let expanded = scratch.path().join("expanded.rs");
    fs::write(&expanded, status_flags()? + &models()? + &structures()?)?;
    let mut config = cbindgen::Config::from_file(sources.join("../cbindgen.toml"))?;
    for section in SECTIONS.iter().chain([&MISSION]) {
        config
            .export
            .rename
            .insert(section.structure.into(), c_name(section));
    }
    let mut bindings = Vec::new();
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in [
        "boundary",
        "code",
        "parameters",
        "for_vehicle",
        "table",
        "controller",
        "input",
        "command",
        "report",
        "goal",
        "guide",
        "mission",
        "step",
        "path",
        "plan",
        "envelope",
    ] {
        builder = builder.with_src(sources.join(file).with_extension("rs"));
    }
    builder.with_src(expanded).generate()?.write(&mut bindings);
    let text = String::from_utf8(bindings)?;
    // Markdown of the sources, which is noise in C.
    Ok(text
        .replace("\\[", "[")
        .replace("\\]", "]")
        .replace(" * # Safety", " * Pointers:"))
}

/// The name of a table's structure in C.
fn c_name(section: &Section) -> String {
    format!("alula_{}_parameters", section.field)
}

/// The core's status flags as constants, with the comments that they have in the core's sources.
fn status_flags() -> Result<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../src/guidance/status.rs");
    let source = fs::read_to_string(path)?;
    let mut text = String::new();
    for (name, flag) in Status::all().iter_names() {
        let (before, _) = source
            .split_once(&format!("const {name} "))
            .ok_or(format!("{name} is not in status.rs"))?;
        let comment: Vec<_> = before
            .lines()
            .rev()
            .skip(1)
            .map(str::trim)
            .take_while(|line| line.starts_with("///"))
            .collect();
        for line in comment.into_iter().rev() {
            writeln!(text, "{line}")?;
        }
        writeln!(
            text,
            "pub const ALULA_STATUS_{name}: u32 = {};",
            flag.bits()
        )?;
    }
    Ok(text)
}

/// The constant of a model in C.
fn model_constant(name: &str) -> String {
    format!("ALULA_MODEL_{}", name.to_uppercase().replace('-', "_"))
}

/// The core's models as constants.
fn models() -> Result<String> {
    let mut text = String::new();
    for model in ModelParameters::LIST {
        let (number, name) = (model.number, model.name);
        let (constant, fields) = (model_constant(name), model.parameters.join(", "));
        writeln!(text, "/// Coefficients by the {name} model: {fields}.")?;
        writeln!(text, "pub const {constant}: u32 = {number};")?;
    }
    Ok(text)
}

/// The parameters' structures in Rust, as the macros make them, for cbindgen to read.
fn structures() -> Result<String> {
    let mut text = String::new();
    for section in SECTIONS.iter().chain([&MISSION]) {
        writeln!(text, "/// {}", section.about.trim())?;
        writeln!(text, "#[repr(C)]\npub struct {} {{", section.structure)?;
        for (n, p) in section.rows.iter().enumerate() {
            let about = match choices(section, n) {
                None => format!(
                    "{} From {} to {}, {}.",
                    unit(p),
                    number(p.min),
                    number(p.max),
                    default(p)
                ),
                Some(choices) => format!("{}; {}.", listed(&choices), default(p)),
            };
            for line in wrapped(p.meaning).into_iter().chain(wrapped(&about)) {
                writeln!(text, "/// {line}")?;
            }
            writeln!(text, "pub {}: f32,", p.name)?;
        }
        writeln!(text, "}}")?;
    }
    writeln!(
        text,
        "/// Everything that a controller is made of. `alula_parameters_default` fills in the defaults.\n\
         #[repr(C)]\npub struct Parameters {{\n\
         /// `ALULA_HEADER(alula_parameters)`.\npub header: u32,"
    )?;
    for section in SECTIONS {
        writeln!(text, "/// {}", section.about.trim())?;
        writeln!(text, "pub {}: {},", section.field, section.structure)?;
    }
    Ok(text + "}\n")
}

/// The values of the `n`th parameter of a table, if it is a choice: the first parameters of the first table are.
pub fn choices(section: &Section, n: usize) -> Option<Vec<String>> {
    if section.field != SECTIONS[0].field || n >= CHOICES {
        return None;
    }
    if n == 0 {
        let gains = [
            "by bandwidth (ALULA_GAINS_BANDWIDTH)",
            "constant (ALULA_GAINS_CONSTANT)",
        ];
        return Some(gains.map(str::to_owned).to_vec());
    }
    let models = ModelParameters::LIST.iter();
    let mut names: Vec<_> = models.map(|model| (model.number, model.name)).collect();
    names.push((ALULA_MODEL_TABLE, "table"));
    names.sort_unstable();
    let named = |(_, name): (u32, &str)| format!("{name} ({})", model_constant(name));
    Some(names.into_iter().map(named).collect())
}

fn default(p: &Row) -> String {
    if p.default.is_nan() {
        "no default".into()
    } else {
        format!("default {}", number(p.default))
    }
}

fn unit(p: &Row) -> String {
    match p.unit {
        "" => "No unit.".into(),
        "mg" => "Unit: the vehicle's weight m g.".into(),
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
fn listed(choices: &[String]) -> String {
    let numbered = choices.iter().enumerate();
    let items: Vec<_> = numbered.map(|(n, c)| format!("{n} = {c}")).collect();
    items.join(", ")
}

/// The table of the docs.
fn table() -> Result<String> {
    let mut text = String::from(
        "# Parameters\n\n\
         For anyone who sets parameters. Fields of `alula_parameters`, in order, with the names they have in PX4's parameter file. The unit mg is a multiple\n\
         of the vehicle's weight. A parameter without a default must be set.\n\n\
         Made by `cargo run --package alula-capi --example generate` from the tables in `src`, and of the controller in\n\
         `capi/src/parameters.rs`; do not edit.\n",
    );
    for section in SECTIONS.iter().chain([&MISSION]) {
        writeln!(
            text,
            "\n## {}: `{}`\n\n{}\n\n| name | PX4 | unit | minimum | maximum | default | meaning |\n\
             |---|---|---|---:|---:|---:|---|",
            section.group,
            section.field,
            section.about.trim()
        )?;
        for (n, p) in section.rows.iter().enumerate() {
            let choices = match choices(section, n) {
                None => String::new(),
                Some(choices) => format!(" {}.", listed(&choices)),
            };
            let default = match p.default.is_nan() {
                true => "must be set".into(),
                false => number(p.default),
            };
            writeln!(
                text,
                "| `{}` | `{}` | {} | {} | {} | {default} | {}{choices} |",
                p.name,
                p.px4,
                p.unit,
                number(p.min),
                number(p.max),
                p.meaning.replace('|', "\\|"),
            )?;
        }
    }
    Ok(text)
}

/// Longest short description of a parameter that PX4's build takes; a longer one ends the whole build.
pub const PX4_SHORT: usize = 150;

/// The first sentence of a meaning, up to a colon if it is long, and what is left to be said.
fn short(meaning: &str) -> Result<(String, &str)> {
    let (first, rest) = meaning.split_once(". ").unwrap_or((meaning, ""));
    let first = first.trim_end_matches('.');
    let (short, rest) = match first.split_once(": ") {
        Some((short, _)) if first.len() >= PX4_SHORT => (short, meaning),
        _ => (first, rest),
    };
    match short.chars().count() < PX4_SHORT {
        true => Ok((format!("{short}."), rest)),
        false => Err(format!("a clause of {PX4_SHORT} characters and more: {short}").into()),
    }
}

/// Units that PX4's schema of `module.yaml` allows, of those that the tables have. The description tells every unit.
const PX4_UNITS: [&str; 8] = ["rad", "rad/s", "rad/s^2", "kg", "m/s", "m/s^2", "s", "N"];

/// The parameter definitions of a PX4 module. It has no parameters without a default: those get zero, which is refused.
fn px4() -> Result<String> {
    let mut text = String::from(
        "# Parameters of alula, in the form of a PX4 module's `module.yaml`.\n\
         # Made by `cargo run --package alula-capi --example generate`; do not edit.\n\
         module_name: alula\nparameters:\n",
    );
    for section in SECTIONS {
        writeln!(text, "  - group: Alula {}\n    definitions:", section.group)?;
        for (n, p) in section.rows.iter().enumerate() {
            let (short, rest) = short(p.meaning)?;
            let field = format!("{}.{}", section.field, p.name);
            let long = format!("{rest} Field {field} of alula_parameters. {}", unit(p));
            let long = long.trim_start();
            writeln!(
                text,
                "      {}:\n        description:\n          short: {short:?}\n          \
                 long: {long:?}",
                p.px4,
            )?;
            if let Some(choices) = choices(section, n) {
                writeln!(text, "        type: enum\n        values:")?;
                for (n, choice) in choices.iter().enumerate() {
                    writeln!(text, "          {n}: {choice:?}")?;
                }
                writeln!(text, "        default: {}", p.default)?;
                continue;
            }
            writeln!(text, "        type: float")?;
            if PX4_UNITS.contains(&p.unit) {
                writeln!(text, "        unit: {}", p.unit)?;
            }
            if p.default.is_nan() {
                writeln!(
                    text,
                    "        # Must be set.\n        max: {}",
                    number(p.max)
                )?;
                writeln!(text, "        default: 0.0")?;
            } else {
                for (key, value) in [("min", p.min), ("max", p.max), ("default", p.default)] {
                    writeln!(text, "        {key}: {}", number(value))?;
                }
            }
            writeln!(text, "        decimal: 4")?;
        }
    }
    Ok(text)
}

/// How the PX4 module reads its parameters.
fn px4_parameters() -> Result<String> {
    let mut text = String::from(
        "// The parameters of module.yaml, into alula's.\n\
         // Made by `cargo run --package alula-capi --example generate`; do not edit.\n\
         #pragma once\n\n#include <alula.h>\n\n#include <parameters/param.h>\n\n#include <stddef.h>\n#include <stdint.h>\n\n\
         // Sets every parameter of `p`; false, and none set, if ALU_MASS is 0: then the vehicle is not that of the parameters.\n\
         inline bool load(alula_parameters &p)\n{\n\
         \tstatic const struct {\n\t\tconst char *name;\n\t\tsize_t offset;\n\t\tbool choice;\n\t} rows[] = {\n",
    );
    for section in SECTIONS {
        for (n, p) in section.rows.iter().enumerate() {
            writeln!(
                text,
                "\t\t{{\"{}\", offsetof(alula_parameters, {}.{}), {}}},",
                p.px4,
                section.field,
                p.name,
                choices(section, n).is_some()
            )?;
        }
    }
    text += "\t};\n\tfloat mass = 0.0f;\n\tparam_get(param_find(\"ALU_MASS\"), &mass);\n\n\
             \tif (!(mass > 0.0f)) {\n\t\treturn false;\n\t}\n\n\
             \tfor (const auto &row : rows) {\n\
             \t\tfloat &value = *reinterpret_cast<float *>(reinterpret_cast<char *>(&p) + row.offset);\n\n\
             \t\tif (row.choice) {\n\t\t\tint32_t choice = 0;\n\t\t\tparam_get(param_find(row.name), &choice);\n\
             \t\t\tvalue = static_cast<float>(choice);\n\n\
             \t\t} else {\n\t\t\tparam_get(param_find(row.name), &value);\n\t\t}\n\t}\n\n\treturn true;\n}\n";
    Ok(text)
}
