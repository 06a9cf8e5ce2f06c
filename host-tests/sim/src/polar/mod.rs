//! Polars: tables of measured coefficients, from files or from those that come with the program.
//!
//! A table that ends at stall is extended to all angles; [`Polar::seam`] says from where on.

mod doubt;
mod formats;
mod made;
mod resample;
mod spacing;
mod stall;
mod viterna;
mod wing;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use alula::aero::TableError;
use anyhow::{anyhow, bail, ensure};
use schemars::JsonSchema;
use serde::Deserialize;

pub use doubt::Doubt;
pub use resample::{Apart, resampled};
pub use stall::stall;
pub use viterna::{Seam, Upto, most_drag};

use crate::kind::Kind;
use crate::named::{Named, built_in, on_one_line};
use crate::reference::{Row, Table};

/// Name and CSV text of every built-in polar.
pub const BUILT_IN: &[(&str, &str)] = built_in! { "data", ".csv";
    "naca-0021-re-160e3",
    "naca-0021-re-5e6",
    "naca-0012-re-160e3",
    "naca-0012-re-5e6",
    "naca-0015-re-160e3",
    "naca-0015-re-5e6",
    "naca-0018-re-160e3",
    "naca-0018-re-5e6",
};

/// What was read of a polar that is made, and not read.
static UNREAD: Read = Read {
    lines: Vec::new(),
    rows: Vec::new(),
    of_wing: false,
};

/// Every polar loaded so far, by its text.
static LOADED: Mutex<BTreeMap<String, Polar>> = Mutex::new(BTreeMap::new());

/// What is odd about the polars that were loaded so far: [`Polar::warnings`] of each.
pub fn warnings() -> Vec<String> {
    let loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
    loaded.values().flat_map(Polar::warnings).collect()
}

/// Whether a text holds a polar, though perhaps a damaged one: what it holds decides, and not the name of its file.
pub fn holds_polar(text: &str) -> bool {
    formats::is_polar(text) && text.parse::<toml::Table>().is_err()
}

/// What a text is, with its line, that is of another program and none that is read.
pub fn foreign(text: &str) -> Option<(usize, String)> {
    formats::foreign::named(text)
}

/// Whether a text is a document, of a vehicle or an experiment, though perhaps a damaged one, and no polar.
pub fn is_document(text: &str) -> bool {
    // Documents have tables in brackets and assignments.
    let begins = |line: &str| {
        let line = line.trim();
        let key = line.split_once('=').map(|(key, _)| key.trim());
        let is_key = |key: &str| {
            let fits = |c: char| c.is_ascii_alphanumeric() || "_-.\"'".contains(c);
            !key.is_empty() && key.chars().all(fits)
        };
        line.starts_with('[') || key.is_some_and(is_key)
    };
    text.parse::<toml::Table>().is_ok() || !formats::is_polar(text) && text.lines().any(begins)
}

/// Most rows of a polar that is read and extended.
const ROWS: usize = 512;
/// Most rows of a whole one: with those of an extension, every 5° and a few. What is made is read again.
const MADE: usize = ROWS + 88;

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
    /// Where the table was extended, if it ended at stall.
    pub seam: Option<Seam>,
    /// What was read of a file.
    read: &'static Read,
    /// Whether its stall was told: its last row before the extension.
    told: bool,
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Read {
    /// Line numbers.
    pub lines: Vec<u64>,
    /// Rows of α \[°\], c_L and c_D, by increasing angle.
    pub rows: Vec<[f64; 3]>,
    /// Whether the file says that they are those of a whole wing, and no section's.
    pub of_wing: bool,
}

impl PartialEq for Polar {
    fn eq(&self, other: &Self) -> bool {
        self.rows == other.rows
    }
}

impl Polar {
    /// The polar that `argument` names: a built-in, or else a file.
    pub fn load(argument: &str) -> anyhow::Result<Self> {
        Self::named(argument, Named::find("polar", BUILT_IN, argument)?)
    }

    /// The polar in the text `file` under the name `argument`.
    pub(crate) fn named(argument: &str, file: Named) -> anyhow::Result<Self> {
        Kind::Polar.expect(argument, file.text.as_bytes())?;
        if is_document(&file.text) {
            bail!(
                "{}: a vehicle or an experiment, and no polar",
                on_one_line(argument)
            );
        }
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        match loaded.get(&file.text) {
            // Of another name, perhaps.
            Some(polar) if polar.name == argument => Ok(*polar),
            _ => {
                let polar = Self::from_text(argument, &file.text)?;
                loaded.insert(file.text, polar);
                Ok(polar)
            }
        }
    }

    /// The polar in `text`: a table with the columns `alpha_deg`, `cl` and `cd` and comments behind `#`, as spreadsheets, XFOIL and XFLR5
    /// write it, or AVL's total forces. One that ends at stall is extended to all angles, as of a wing of infinite span. `origin` stands for the text in errors,
    /// which name line and column.
    pub fn from_text(origin: &str, text: &str) -> anyhow::Result<Self> {
        // Spreadsheets begin a file with a mark of its encoding.
        let text = text.trim_start_matches('\u{feff}');
        let read = formats::read(origin, text)?;
        let polar = Self::of_read(origin, read, None)?;
        // What no wing has no command takes.
        let doubts = polar.doubts();
        if let Some(doubt) = doubts.iter().find(|doubt| doubt.impossible) {
            bail!("{origin}:{}: {}", doubt.line, doubt.problem);
        }
        Ok(polar)
    }

    /// The polar of what was read; extended as of a wing of `aspect_ratio`, if it ends at stall.
    fn of_read(origin: &str, read: Read, aspect_ratio: Option<f64>) -> anyhow::Result<Self> {
        let Read { lines, rows, .. } = &read;
        let ends = rows.first().zip(rows.last());
        let at_stall = ends.is_some_and(|(first, last)| first[0] >= -90.0 && last[0] <= 90.0);
        if !at_stall {
            let far = |row: &[f64; 3]| (90.0..179.95).contains(&row[0].abs());
            let ends_between =
                rows.len() > 4 && rows.first().into_iter().chain(rows.last()).any(far);
            let whole = Self::from_rows(origin, lines, rows).map_err(|e| match ends_between {
                true => {
                    anyhow!("{e}; or leave out what is beyond 90°, and it is extended from there")
                }
                false => e,
            })?;
            return Ok(Self {
                read: Box::leak(Box::new(read)),
                ..whole
            });
        }
        ensure!(
            rows.len() <= ROWS,
            "{origin}: comes to {} rows, and at most {ROWS} are read of a table that is extended: leave out every second one",
            rows.len()
        );
        // Of the rows that are made from them no error could name the line.
        for (line, row) in lines.iter().zip(rows) {
            ensure!(
                row.iter().all(|x| x.is_finite()),
                "{origin}:{line}: every number must be finite"
            );
            ensure!(
                row[2] > 0.0,
                "{origin}:{line}: the drag coefficient must be positive; AVL and panel methods have no friction unless it is given to them"
            );
        }
        let first = lines.first().copied().unwrap_or(1);
        let (rows, seam) = viterna::extended(&halved(rows.clone()), aspect_ratio)
            .map_err(|e| anyhow!("{origin}:{first}: {e}"))?;
        // Some rows were left out, and others made: those of an error are found by their angle, the last of several.
        let line = |[alpha, ..]: &[f64; 3]| {
            let off = |row: &[f64; 3]| (row[0] - alpha).abs();
            let all = read.lines.iter().zip(&read.rows).rev();
            let nearest = all.min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
            nearest.map_or(first, |(line, _)| *line)
        };
        let made: Vec<u64> = rows.iter().map(line).collect();
        let whole = Self::from_rows(origin, &made, &rows)?;
        Ok(Self {
            seam: Some(seam),
            read: Box::leak(Box::new(read)),
            ..whole
        })
    }

    /// The polar of whole `rows` \[°, c_L, c_D\], from these `lines` of `origin`.
    pub fn from_rows(origin: &str, lines: &[u64], degrees: &[[f64; 3]]) -> anyhow::Result<Self> {
        ensure!(
            degrees.len() <= MADE,
            "{origin}: comes to {} rows, and at most {MADE} are taken: leave out every second one",
            degrees.len()
        );
        let line = |row: usize| lines.get(row).or(lines.last()).copied().unwrap_or(1);
        Self::new(origin, degrees)
            .map_err(|e| anyhow!("{origin}:{}: {}", line(e.row), e.problem.text()))
    }

    /// The polar of rows in a document, each table once.
    fn of_table(rows: &[[f64; 3]]) -> anyhow::Result<Self> {
        let text = format!("{rows:?}");
        let mut loaded = LOADED.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(polar) = loaded.get(&text) {
            return Ok(*polar);
        }
        let polar = Self::from_rows("rows", &[], rows)?;
        loaded.insert(text, polar);
        Ok(polar)
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
        let core = alula::aero::Polar::<{ MADE - 1 }>::new(&nodes)?;
        let rows: Vec<Row> = degrees
            .iter()
            .map(|&[alpha, c_l, c_d]| [alpha.to_radians(), c_l, c_d])
            .collect();
        Ok(Self {
            name: String::leak(name.to_owned()),
            core: alula::Table::new(Box::leak(Box::new(core))),
            reference: Box::leak(Box::new(Table::new(&rows))),
            rows: rows.leak(),
            seam: None,
            read: &UNREAD,
            told: false,
        })
    }

    /// Its rows with α in degrees.
    pub fn degrees(&self) -> Vec<[f64; 3]> {
        let rows = self.rows.iter();
        // Twelve digits: what was read in degrees is read back as it was.
        rows.map(|&[alpha, c_l, c_d]| [(alpha.to_degrees() * 1e12).round() / 1e12, c_l, c_d])
            .collect()
    }

    /// Whether it is that of a symmetric section, with rows from 0 on.
    pub fn is_symmetric(&self) -> bool {
        self.rows.first().is_some_and(|row| row[0].abs() < 1e-9)
    }

    /// Why it is to be doubted that these are the coefficients of a wing: the worst first.
    pub fn doubts(&self) -> Vec<Doubt> {
        doubt::doubts(&self.read.lines, &self.read.rows)
    }

    /// What is odd about it, but not impossible, in lines that begin with its name.
    pub fn odd(&self) -> Vec<String> {
        let name = on_one_line(self.name);
        let possible = self.doubts().into_iter().filter(|d| !d.impossible);
        let lines = possible.map(|doubt| format!("{name}:{}: {}", doubt.line, doubt.problem));
        lines.collect()
    }

    /// What is odd about it, and what its end says of its stall: what every command says that takes it as it is.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.odd();
        if !self.told {
            warnings.extend(self.no_stall());
        }
        warnings
    }

    /// The line of its last row.
    pub fn last_line(&self) -> u64 {
        self.read.lines.last().copied().unwrap_or(1)
    }

    /// Why its stall is not in it, in a line that begins with its name: of a polar that ends before 180°.
    pub fn no_stall(&self) -> Option<String> {
        self.seam.as_ref()?;
        let (line, problem) = doubt::no_stall(&self.read.lines, &self.read.rows)?;
        Some(format!("{}:{line}: {problem}", on_one_line(self.name)))
    }

    /// Whether its file says that it is that of a whole wing: XFLR5's of planes and AVL's are, and those that this program wrote.
    pub fn is_of_wing(&self) -> bool {
        self.read.of_wing
    }

    /// The polar as a CSV file, under these comments.
    pub fn csv(&self, comments: &[String]) -> String {
        let comments = comments.iter().map(|line| on_one_line(line));
        let mut text: String = comments.map(|line| format!("# {line}\n")).collect();
        text += "alpha_deg,cl,cd\n";
        for [alpha, c_l, c_d] in self.written() {
            text += &format!("{alpha},{c_l},{c_d}\n");
        }
        text
    }

    /// Its rows as [`Self::csv`] writes them: α \[°\], c_L and c_D, to the sixth decimal.
    pub fn written(&self) -> Vec<[f64; 3]> {
        let short = |x: f64| (x * 1e6).round() / 1e6;
        let row = |[alpha, c_l, c_d]: [f64; 3]| {
            let ends = (alpha.abs() - 180.0).abs() < 1e-4;
            let alpha = if ends {
                180.0_f64.copysign(alpha)
            } else {
                alpha
            };
            [alpha, c_l, c_d].map(short)
        };
        self.degrees().into_iter().map(row).collect()
    }
}

/// The rows from 0 on, if those below are their mirror image or there are none, and there is no lift at 0 but for rounding.
fn halved(rows: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    /// Differences of coefficients that are rounding, of tables with four digits.
    const SAME: f64 = 2e-4;
    let zero = rows.iter().position(|row| row[0].abs() < 1e-6);
    let Some((below, above)) = zero.and_then(|zero| rows.split_at_checked(zero)) else {
        return rows;
    };
    let mirrored = |[alpha, c_l, c_d]: &[f64; 3]| {
        let there = above.iter().find(|row| (row[0] + alpha).abs() < 1e-6);
        there.is_some_and(|row| (row[1] + c_l).abs() < SAME && (row[2] - c_d).abs() < SAME)
    };
    if above[0][1].abs() > SAME || !below.iter().all(mirrored) || above.len() < below.len() {
        return rows;
    }
    let mut half = above.to_vec();
    half[0] = [0.0, 0.0, half[0][2]];
    half
}

/// A polar in a document: the name of a built-in one, or of a CSV file relative to the working directory, or rows of α \[°\], c_L and c_D.
#[derive(Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "must be a name, a file, or rows of [alpha_deg, c_l, c_d]"
)]
pub(crate) enum Given {
    Named(String),
    Rows(Vec<[f64; 3]>),
}

impl<'de> Deserialize<'de> for Polar {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let polar = match Given::deserialize(deserializer)? {
            Given::Named(argument) => Self::load(&argument),
            Given::Rows(rows) => Self::of_table(&rows),
        };
        polar.map_err(|e| serde::de::Error::custom(format!("{e:#}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusals::begins;
    use alula::{Aerodynamics, AngleOfAttack};

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

    /// The CSV files and the core's constants are the same tables, to the bit.
    #[test]
    fn the_shipped_files_are_the_cores_tables() {
        let core = [
            alula::Table::new(&alula::aero::NACA_0021_RE_160E3),
            alula::Table::new(&alula::aero::NACA_0021_RE_5E6),
        ];
        for (name, core) in ["naca-0021-re-160e3", "naca-0021-re-5e6"].iter().zip(core) {
            assert_eq!(Polar::load(name).unwrap().core, core);
        }
    }

    /// The core's monomials in f32 against Bernstein's form in f64 with automatic derivatives.
    #[test]
    fn single_and_double_precision_agree() {
        for (name, _) in BUILT_IN {
            let polar = Polar::load(name).unwrap();
            let reference = crate::reference::Aerodynamics::Table(polar.reference);
            // Derivatives grow with the steepest secant: of NACA 0021 it is 6.4 per radian, of NACA 0012 at Re = 160e3, where lift falls
            // by 0.72 within a degree, 41.
            let secant =
                |pair: &[Row], k: usize| (pair[1][k] - pair[0][k]) / (pair[1][0] - pair[0][0]);
            let secants = polar
                .rows
                .windows(2)
                .flat_map(|pair| [secant(pair, 1).abs(), secant(pair, 2).abs()]);
            let steep = (secants.fold(0.0, f64::max) / 6.4).max(1.0);
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
                    assert!(
                        error < steep * tolerance,
                        "{name} {}: {got} {want}",
                        alpha.rad
                    );
                }
            }
        }
    }

    #[test]
    fn errors_name_file_and_line() {
        let error = |text: &str| format!("{:#}", Polar::from_text("x.csv", text).unwrap_err());
        assert!(
            Polar::from_text(
                "x.csv",
                "\u{feff}alpha,CL,CD\n0,0,0.01\n5,0.5,0.01\n9,0.8,0.02\n"
            )
            .is_ok()
        );
        let good =
            "# a comment\nalpha_deg,cl,cd\n0,0,0.1\n45,1,0.9\n90,0,1.8\n135,-1,0.9\n180,0,0.1\n";
        assert!(Polar::from_text("x.csv", good).is_ok());
        let with = |from: &str, to: &str| error(&good.replace(from, to));
        assert_eq!(
            with("cd\n", "drag\n"),
            "x.csv:2: no column cd among alpha_deg, cl, drag"
        );
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
        let between = with("180,", "170,");
        assert!(
            between.starts_with("x.csv:7: the last angle")
                && between.ends_with("extended from there"),
            "{between}"
        );
        let rows: String = (0..=720)
            .map(|n| format!("{},0,0.1\n", 0.25 * f64::from(n)))
            .collect();
        let many = error(&format!("alpha_deg,cl,cd\n{rows}"));
        begins(&many, "x.csv: comes to 721 rows, and at most 600");
        let short = error("alpha_deg,cl,cd\n0,0,0.1\n1,0.1,0.1\n2,0.2,0.1\n");
        assert!(short.starts_with("x.csv:2: goes from 0° to 2°"), "{short}");
        let drag = error("alpha CL CD\n-8 -1 0.1\n0 0.1 0\n9 1 0.1\n");
        assert!(drag.starts_with("x.csv:3: the drag"), "{drag}");
        // Of a symmetric section the rows below 0 are left out, and of one with camber others come before them: the line is the file's.
        for below in [
            "",
            "-9,-0.8,0.02\n-5,-0.5,0.01\n",
            "-9,-0.7,0.02\n-5,-0.4,0.01\n",
        ] {
            let rows = "0,0,0.01\n5,0.5,0.01\n5.02,0.5,0.01\n9,0.8,0.02\n";
            let near = error(&format!("alpha_deg,cl,cd\n{below}{rows}"));
            let line = 4 + below.lines().count();
            assert!(
                near.starts_with(&format!("x.csv:{line}: angles must increase")),
                "{near}"
            );
        }
        let missing = Polar::load("nonesuch").unwrap_err().to_string();
        assert!(missing.contains("naca-0021-re-160e3") && !missing.contains('\n'));
    }

    /// XFOIL leaves −9e-17 for the lift of a symmetric section at 0, and sweeps both ways.
    #[test]
    fn a_symmetric_section_is_symmetric_but_for_rounding() {
        let row = |a: i32| {
            format!(
                "{a} {} 0.01\n",
                if a == 0 { -9e-17 } else { 0.1 * f64::from(a) }
            )
        };
        let text = |from: i32| {
            let rows: String = (from..=12).map(row).collect();
            format!("alpha CL CD\n{rows}")
        };
        for from in [-12, -5, 0] {
            let polar = Polar::from_text("x", &text(from)).unwrap();
            assert!(polar.is_symmetric() && polar.seam.unwrap().given_deg == [0.0, 12.0]);
        }
        // And a whole table.
        let whole =
            "alpha_deg,cl,cd\n0,-9e-17,0.1\n45,1,0.9\n90,0,1.8\n135,-1,0.9\n180,2e-16,0.1\n";
        assert!(Polar::from_text("x", whole).unwrap().is_symmetric());
        let cambered = text(-5).replace("0 -0.00000000000000009", "0 0.04");
        assert!(!Polar::from_text("x", &cambered).unwrap().is_symmetric());
    }

    #[test]
    fn what_is_written_is_read_again() {
        for (name, _) in BUILT_IN {
            let wing = Polar::load(name).unwrap().of_wing(6.0).unwrap();
            let again = Polar::from_text("x", &wing.csv(&["made".to_owned()])).unwrap();
            let far = wing.rows.iter().zip(again.rows);
            // Six digits.
            assert!(
                far.flat_map(|(a, b)| a.iter().zip(b))
                    .all(|(a, b)| (a - b).abs() < 1e-6)
            );
        }
    }
}
