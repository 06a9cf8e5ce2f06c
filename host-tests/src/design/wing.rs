//! The coefficients of a vehicle's wing: a preset, or a polar that somebody has.

use anyhow::Context;

use super::Facts;
use crate::experiment::AerodynamicsSpec;
use crate::polar::{Polar, SPAN_EFFICIENCY};
use crate::reference::LargeAngle;

/// Rows of the tables that fit on board: `ALULA_TABLE_ROWS` of the C interface.
pub const ROWS: usize = 96;
/// The Reynolds numbers that the presets were published at, and how they stand in names.
const REYNOLDS: [(f64, &str); 2] = [(160e3, "160e3"), (5e6, "5e6")];
/// The sections that need no table.
const PRESETS: [&str; 4] = ["naca-0012", "naca-0015", "naca-0018", "naca-0021"];
const PLATE: &str = "flat-plate";
/// Drag of a flat plate along the air: two turbulent boundary layers.
const PLATE_FRICTION: f64 = 0.02;

/// A wing.
#[derive(Clone, Debug)]
pub struct Wing {
    /// The coefficients.
    pub aerodynamics: AerodynamicsSpec,
    /// The polar, and what a file of its own must hold; none where it is built in.
    pub polar: Option<(Polar, bool)>,
    /// How it came about, in sentences.
    pub story: Vec<String>,
}

impl Wing {
    /// Whether `section` is a preset, or a polar that can be read.
    pub(super) fn check(section: &str) -> anyhow::Result<()> {
        if section != PLATE && !PRESETS.contains(&section) {
            Self::measured(section)?;
        }
        Ok(())
    }

    /// The polar of that name or file.
    fn measured(section: &str) -> anyhow::Result<Polar> {
        let presets = || format!("section is none of {}, {PLATE}", PRESETS.join(", "));
        Polar::load(section).with_context(presets)
    }

    /// The wing of `facts`.
    pub fn new(facts: &Facts) -> anyhow::Result<Self> {
        if facts.section == PLATE {
            return Ok(Self::plate(facts));
        }
        let mut story = Vec::new();
        let preset = PRESETS.contains(&&*facts.section);
        let section = if preset {
            let far = |(re, _): &(f64, &str)| (re / facts.reynolds()).ln().abs();
            let (_, name) = REYNOLDS
                .into_iter()
                .min_by(|a, b| far(a).total_cmp(&far(b)))
                .expect("two");
            story.push(format!(
                "{} at Re = {name}, of the two published the nearer to {:.0} in cruise (Sheldahl and Klimas, SAND80-2114)",
                facts.section,
                facts.reynolds()
            ));
            Polar::load(&format!("{}-re-{name}", facts.section))?
        } else {
            Self::measured(&facts.section)?
        };
        story.extend(section.seam.map(|seam| seam.text()));
        let wing = match facts.aspect_ratio {
            None => {
                story.push(
                    "Without an aspect ratio: the wing is taken for the polar as it is".to_owned(),
                );
                section
            }
            Some(ratio) => {
                let wing = section.of_wing(ratio)?;
                story.push(format!(
                    "For an aspect ratio of {ratio}: Prandtl's lifting line up to stall, with a span efficiency of {SPAN_EFFICIENCY}"
                ));
                story.extend(wing.seam.map(|seam| seam.text()));
                wing
            }
        };
        let (polar, apart) = wing.of_rows(ROWS)?;
        story.extend(apart.text(polar.rows.len(), wing.rows.len()));
        let own = !(preset && facts.aspect_ratio.is_none());
        Ok(Self {
            aerodynamics: AerodynamicsSpec::Table { polar },
            polar: Some((polar, own)),
            story,
        })
    }

    /// A flat plate: the large-angle model, with c_Dmax of Viterna and Corrigan.
    fn plate(facts: &Facts) -> Self {
        let most = crate::polar::most_drag(facts.aspect_ratio);
        Self {
            aerodynamics: AerodynamicsSpec::LargeAngle(LargeAngle {
                c0: PLATE_FRICTION,
                c1: 0.5 * (most - PLATE_FRICTION),
            }),
            polar: None,
            story: vec![format!(
                "A flat plate: c_L = c_1 sin 2α, c_D = c_0 + 2 c_1 sin²α, without stall, with c_D = {most:.3} broadside (Viterna and Corrigan)"
            )],
        }
    }

    /// Its table of the vehicle's file.
    pub fn toml(&self) -> String {
        match (&self.aerodynamics, &self.polar) {
            (AerodynamicsSpec::LargeAngle(m), _) => {
                format!(
                    "[vehicle.aerodynamics.large-angle]\nc0 = {}\nc1 = {}\n",
                    m.c0, m.c1
                )
            }
            (_, Some((_, true))) => {
                "[vehicle.aerodynamics.table]\npolar = \"polar.csv\"\n".to_owned()
            }
            (_, Some((polar, false))) => {
                format!("[vehicle.aerodynamics.table]\npolar = \"{}\"\n", polar.name)
            }
            (_, None) => String::new(),
        }
    }
}
