//! Polars: tables of measured coefficients, from CSV files or from those that come with the program.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use alula::aero::TableError;
use anyhow::{Context, anyhow};
use serde::Deserialize;

use crate::named::Named;
use crate::reference::{Row, Table};

/// Name and CSV text of every built-in polar.
pub const BUILT_IN: &[(&str, &str)] = &[
    (
        "naca-0021-re-160e3",
        include_str!("../data/naca-0021-re-160e3.csv"),
    ),
    (
        "naca-0021-re-5e6",
        include_str!("../data/naca-0021-re-5e6.csv"),
    ),
];

/// Most rows of a polar.
const ROWS: usize = 512;

/// A polar, as the core and as the plant take it.
///
/// Its tables live until the program ends: the core's tables are constants of a vehicle. Each text is loaded once, however
/// many flights of a campaign ask for it.
#[derive(Clone, Copy, Debug)]
pub struct Polar {
    /// Its name in the built-in list, or its file.
    pub name: &'static str,
    /// Its rows: α \[rad\], c_L, c_D.
    pub rows: &'static [Row],
    /// In single precision.
    pub core: alula::Table<'static>,
    /// In double precision.
    pub reference: &'static Table,
}

impl PartialEq for Polar {
    fn eq(&self, other: &Self) -> bool {
        self.rows == other.rows
    }
}

impl Polar {
    /// The polar that `argument` names: a built-in, or else a CSV file.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        static LOADED: Mutex<BTreeMap<String, Polar>> = Mutex::new(BTreeMap::new());
        let found = Named::find("polar", BUILT_IN, argument)?;
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        match loaded.get(&found.text) {
            // Of another name, perhaps.
            Some(polar) if polar.name == argument => Ok(*polar),
            _ => {
                let polar = Self::from_text(argument, &found.text)?;
                loaded.insert(found.text, polar);
                Ok(polar)
            }
        }
    }

    /// The polar in the CSV `text` with the columns `alpha_deg`, `cl` and `cd`; `origin` stands for it in errors,
    /// which name line and column. Lines that start with `#` are comments.
    pub fn from_text(origin: &str, text: &str) -> anyhow::Result<Self> {
        let (lines, rows) = read(origin, text)?;
        let line = |row: usize| lines.get(row).or(lines.last()).copied().unwrap_or(1);
        Self::new(origin, &rows)
            .map_err(|e| anyhow!("{origin}:{}: {}", line(e.row), e.problem.text()))
    }

    /// The polar through `degrees`: α \[°\], c_L, c_D; `name` is its name.
    ///
    /// # Errors
    /// As the core's table.
    pub fn new(name: &str, degrees: &[[f64; 3]]) -> Result<Self, TableError> {
        let nodes: Vec<alula::aero::Node> = degrees
            .iter()
            .map(|&[alpha, c_l, c_d]| {
                alula::aero::Node::from_degrees(alpha as f32, c_l as f32, c_d as f32)
            })
            .collect();
        let core = alula::aero::Polar::<{ ROWS - 1 }>::new(&nodes)?;
        let rows: Vec<Row> = degrees
            .iter()
            .map(|&[alpha, c_l, c_d]| [alpha.to_radians(), c_l, c_d])
            .collect();
        Ok(Self {
            name: String::leak(name.to_owned()),
            core: alula::Table::new(Box::leak(Box::new(core))),
            reference: Box::leak(Box::new(Table::new(&rows))),
            rows: rows.leak(),
        })
    }
}

/// Line numbers, and rows with α in degrees.
fn read(origin: &str, text: &str) -> anyhow::Result<(Vec<u64>, Vec<[f64; 3]>)> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let header = reader
        .headers()
        .with_context(|| format!("{origin}:1"))?
        .clone();
    // The reader places the header before the comments.
    let above = text.lines().take_while(|line| line.starts_with('#'));
    let header_line = 1 + above.count();
    let column = |name: &'static str| {
        let found = header.iter().position(|cell| cell == name);
        found.ok_or_else(|| anyhow!("{origin}:{header_line}: no column {name}"))
    };
    let columns = [column("alpha_deg")?, column("cl")?, column("cd")?];
    let (mut lines, mut rows) = (Vec::new(), Vec::new());
    for record in reader.records() {
        let record = record.map_err(|error| {
            let line = error.position().map_or(1, csv::Position::line);
            anyhow!("{origin}:{line}: not as many cells as columns")
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let mut row = [0.0; 3];
        for (value, index) in row.iter_mut().zip(columns) {
            let cell = &record[index];
            *value = cell
                .parse()
                .map_err(|_| anyhow!("{origin}:{line}: {cell:?} is not a number"))?;
        }
        lines.push(line);
        rows.push(row);
    }
    Ok((lines, rows))
}

impl<'de> Deserialize<'de> for Polar {
    /// From the name of a built-in polar, or of a CSV file relative to the working directory.
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let argument = String::deserialize(deserializer)?;
        Self::load(&argument).map_err(|e| serde::de::Error::custom(format!("{e:#}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula::{Aerodynamics, AngleOfAttack};

    /// The CSV files and the core's constants are the same tables, to the bit.
    /// The second time nothing is made anew; a file that has changed in between is.
    #[test]
    fn a_text_is_loaded_once() {
        let (name, text) = BUILT_IN[0];
        let rows = |argument: &str| Polar::load(argument).unwrap().rows.as_ptr();
        assert_eq!(rows(name), rows(name));
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        let path = file.path().to_str().unwrap();
        std::fs::write(path, text).unwrap();
        let first = Polar::load(path).unwrap();
        assert_eq!((first.name, first.rows.as_ptr()), (path, rows(path)));
        let mut shorter: Vec<&str> = text.lines().collect();
        let middle = shorter.len() / 2;
        shorter.remove(middle);
        std::fs::write(path, shorter.join("\n")).unwrap();
        assert_eq!(Polar::load(path).unwrap().rows.len(), first.rows.len() - 1);
    }

    #[test]
    fn the_shipped_files_are_the_cores_tables() {
        let core = [
            alula::Table::new(&alula::aero::NACA_0021_RE_160E3),
            alula::Table::new(&alula::aero::NACA_0021_RE_5E6),
        ];
        for ((name, _), core) in BUILT_IN.iter().zip(core) {
            assert_eq!(Polar::load(name).unwrap().core, core);
        }
    }

    /// The core's monomials in f32 against Bernstein's form in f64 with automatic derivatives.
    #[test]
    fn single_and_double_precision_agree() {
        for (name, _) in BUILT_IN {
            let polar = Polar::load(name).unwrap();
            let reference = crate::reference::Aerodynamics::Table(polar.reference);
            for n in -20_000..20_000 {
                let alpha = AngleOfAttack::from_radians(n as f32 * 1.570_7e-4);
                let (got, want) = (
                    polar.core.coefficients(alpha),
                    reference.at(f64::from(alpha.rad)),
                );
                // Roundings of the angle, 2e-7, times derivatives up to 20, 500 and 6e4; and of the polynomials.
                for (got, want, tolerance) in [
                    (got.c_l, want.c_l, 3e-6),
                    (got.c_d, want.c_d, 3e-6),
                    (got.dc_l, want.dc_l, 2e-4),
                    (got.dc_d, want.dc_d, 2e-4),
                    (got.ddc_l, want.ddc_l, 5e-2),
                    (got.ddc_d, want.ddc_d, 5e-2),
                ] {
                    let error = (f64::from(got) - want).abs();
                    assert!(error < tolerance, "{name} {}: {got} {want}", alpha.rad);
                }
            }
        }
    }

    #[test]
    fn errors_name_file_and_line() {
        let error = |text: &str| format!("{:#}", Polar::from_text("x.csv", text).unwrap_err());
        let good =
            "# a comment\nalpha_deg,cl,cd\n0,0,0.1\n45,1,0.9\n90,0,1.8\n135,-1,0.9\n180,0,0.1\n";
        assert!(Polar::from_text("x.csv", good).is_ok());
        let with = |from: &str, to: &str| error(&good.replace(from, to));
        assert_eq!(with("cd\n", "drag\n"), "x.csv:2: no column cd");
        assert_eq!(with("45,1,", "45,one,"), "x.csv:4: \"one\" is not a number");
        assert_eq!(
            with("45,1,0.9", "45,1"),
            "x.csv:4: not as many cells as columns"
        );
        assert_eq!(
            with("90,0,1.8", "90,0,-1.8"),
            "x.csv:5: the drag coefficient must be positive"
        );
        assert_eq!(
            with("180,0,0.1\n", ""),
            "x.csv:6: at least five rows are needed"
        );
        assert!(with("180,", "170,").starts_with("x.csv:7: the last angle"));
        let missing = Polar::load("nonesuch").unwrap_err().to_string();
        assert!(missing.contains("naca-0021-re-160e3") && !missing.contains('\n'));
    }
}
