//! The coefficients of a vehicle's wing: a preset, or a polar that somebody has.

use anyhow::{Context, bail, ensure};

use super::Facts;
use alula_sim::experiment::AerodynamicsSpec;
use alula_sim::named::{check, on_one_line};
use alula_sim::polar::{BUILT_IN, Polar};
use alula_sim::reference::LargeAngle;

/// Rows of the tables that fit on board: `ALULA_TABLE_ROWS` of the C interface.
pub const ROWS: usize = 96;
/// The Reynolds numbers of the presets that are built in, and how they stand in names.
const REYNOLDS: [(f64, &str); 2] = [(160e3, "160e3"), (5e6, "5e6")];
/// How far the nearest of them may be from that of cruise, as a factor, before it is warned of.
const NEAR: f64 = 3.0;
/// Least aspect ratio of a wing that is made of a section without a warning: below it the whole of the wing is near its tips.
const SLENDER: f64 = 3.0;
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
    /// What is to be doubted of it, in sentences.
    pub warnings: Vec<String>,
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
        let polars = BUILT_IN.iter().map(|(name, _)| *name);
        let names: Vec<&str> = PRESETS.into_iter().chain([PLATE]).chain(polars).collect();
        check("section", &names, section)?;
        Polar::load(section)
    }

    /// The wing of `facts`.
    pub fn new(facts: &Facts) -> anyhow::Result<Self> {
        if facts.section == PLATE {
            ensure!(
                facts.stall_deg.is_none(),
                "stall_deg: a flat plate has no stall"
            );
            return Ok(Self::plate(facts));
        }
        let (mut story, mut warnings) = (Vec::new(), Vec::new());
        let preset = PRESETS.contains(&&*facts.section);
        let section = if preset {
            let reynolds = facts.reynolds();
            let far = |(re, _): &(f64, &str)| (re / reynolds).ln().abs();
            let (built_in, name) = REYNOLDS
                .into_iter()
                .min_by(|a, b| far(a).total_cmp(&far(b)))
                .expect("two");
            story.push(format!(
                "{}, the table at Re = {name}. In cruise Re is {reynolds:.0}{}. Built in are the tables at 160e3 and 5e6; their source, SAND80-2114 \
                 (Sheldahl and Klimas), has 360e3, 700e3, 1e6 and 2e6, too",
                facts.section,
                if facts.aspect_ratio.is_none() { ", with the mean chord of an aspect ratio of 6, as none was given" } else { "" }
            ));
            if far(&(built_in, name)) > NEAR.ln() {
                warnings.push(format!(
                    "The Reynolds number of cruise, {reynolds:.0}, is far from the {name} of the table: stall and drag will differ. A polar of your own is better"
                ));
            }
            let polar = Polar::load(&format!("{}-re-{name}", facts.section))?;
            stalling(polar, facts.stall_deg, &mut story)?
        } else {
            story.push(format!("From the polar {}", on_one_line(&facts.section)));
            let polar = Self::measured(&facts.section)?;
            warnings.extend(polar.odd());
            stalling(polar, facts.stall_deg, &mut story)?
        };
        if let Some(ratio) = facts.aspect_ratio
            && ratio < SLENDER
            && !section.is_of_wing()
        {
            warnings.push(format!(
                "An aspect ratio of {ratio} is below {SLENDER}: Prandtl's lifting line, which makes the section a wing, has its stall too late and its lift too high there. Give \
                 the polar of the whole wing"
            ));
        }
        let (wing, how) = section.finite(facts.aspect_ratio)?;
        story.extend(how);
        let added = facts.added_drag();
        let wing = match added > 0.0 {
            true => {
                story.push(format!("What is not wing adds {added:.4} to c_D at every angle: its drag area over the area of the wing"));
                wing.with_drag(added)?
            }
            false => wing,
        };
        let (polar, apart) = wing.of_rows(ROWS)?;
        story.extend(apart.text(polar.rows.len(), wing.rows.len()));
        let own = !(preset && facts.aspect_ratio.is_none() && added == 0.0);
        Ok(Self {
            aerodynamics: AerodynamicsSpec::Table { polar },
            polar: Some((polar, own)),
            story,
            warnings,
        })
    }

    /// A flat plate: the large-angle model, with c_Dmax of Viterna and Corrigan.
    fn plate(facts: &Facts) -> Self {
        let most = alula_sim::polar::most_drag(facts.aspect_ratio);
        Self {
            aerodynamics: AerodynamicsSpec::LargeAngle(LargeAngle {
                c0: PLATE_FRICTION + facts.added_drag(),
                c1: 0.5 * (most - PLATE_FRICTION),
            }),
            polar: None,
            story: vec![format!(
                "A flat plate: c_L = c_1 sin 2α, c_D = c_0 + 2 c_1 sin²α, without stall, with c_D = {most:.3} broadside (Viterna and Corrigan)"
            )],
            warnings: Vec::new(),
        }
    }

    /// Angle of attack at which it stalls \[°\]; none if it does not.
    pub fn stall_deg(&self) -> Option<f64> {
        let (polar, _) = self.polar.as_ref()?;
        polar.stall_deg()
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

/// The polar up to its stall, which must be in it or be told; what that leaves out is said in the `story`.
fn stalling(
    polar: Polar,
    stall_deg: Option<f64>,
    story: &mut Vec<String>,
) -> anyhow::Result<Polar> {
    match stall_deg {
        Some(degrees) => {
            let (polar, cut) = polar.stalling_at(degrees).context("stall_deg")?;
            story.extend(cut);
            Ok(polar)
        }
        None => match polar.no_stall() {
            Some(problem) => bail!(
                "{problem}. Give rows up to the stall, or say at which of these it stalls: --stall-deg"
            ),
            None => Ok(polar),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Known;
    use crate::refusals::{begins, says};

    /// The wing with this polar as a file, and what else is changed.
    fn wing(text: &str, change: impl Fn(&mut Known)) -> anyhow::Result<Wing> {
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        std::fs::write(file.path(), text).unwrap();
        let mut known = Known {
            section: file.path().to_str().map(str::to_owned),
            ..Known::tail_sitter()
        };
        change(&mut known);
        Wing::new(&known.facts()?)
    }

    fn polar(lift: impl Fn(f64) -> f64) -> String {
        let rows = (0..=16).map(f64::from);
        let rows: String = rows
            .map(|a| format!("{a} {} {}\n", lift(a), 0.01 + 0.0003 * a * a))
            .collect();
        format!("alpha CL CD\n{rows}")
    }

    fn round(a: f64) -> f64 {
        1.05 * (a / 12.0 * 1.5).sin()
    }

    /// A table that ends before the stall is refused until the stall is told; with it, it stalls there.
    #[test]
    fn a_straight_polar_asks_for_its_stall() {
        let straight = polar(|a| 0.08 * a);
        let error = format!("{:#}", wing(&straight, |_| ()).unwrap_err());
        says(&error, &[".csv:18: ", "--stall-deg"]);
        for ratio in [None, Some(6.0)] {
            let made = wing(&straight, |known| {
                (known.stall_deg, known.aspect_ratio) = (Some(12.0), ratio);
            });
            let (polar, _) = made.unwrap().polar.unwrap();
            let most = polar
                .degrees()
                .iter()
                .filter(|row| row[0] < 25.0)
                .map(|row| row[1])
                .fold(0.0, f64::max);
            assert!((most - 0.96).abs() < 1e-9, "{most}");
        }
        assert!(wing(&polar(round), |_| ()).is_ok());
    }

    /// What no wing can have is refused with file and line, what is odd is warned of.
    #[test]
    fn what_no_wing_has_is_refused() {
        let refused = |text: &str| format!("{:#}", wing(text, |_| ()).unwrap_err());
        let ten = refused(&polar(|a| 10.0 * round(a)));
        assert!(
            ten.contains(".csv:6: c_L is") || ten.contains(".csv:5: c_L is"),
            "{ten}"
        );
        let mirrored = refused(&polar(|a| -round(a)));
        assert!(mirrored.contains("wrong sign"), "{mirrored}");
        let wild = refused(&polar(|a| if a == 5.0 { -0.6 } else { round(a) }));
        assert!(wild.contains(".csv:7: c_L is -0.6 at 5°"), "{wild}");
        let odd = wing(
            &polar(|a| if a == 5.0 { round(a) - 0.15 } else { round(a) }),
            |_| (),
        )
        .unwrap();
        assert!(odd.warnings[0].contains(".csv:7: "), "{:?}", odd.warnings);
        assert!(wing(&polar(round), |_| ()).unwrap().warnings.is_empty());
    }

    /// What the story says of a preset: what is built in, and what was published.
    #[test]
    fn the_story_says_which_table_it_is() {
        let preset = |wing_m2: f64| {
            wing("", |known| {
                (known.section, known.wing_m2) = (Some("naca-0012".to_owned()), Some(wing_m2));
            })
            .unwrap()
        };
        let made = preset(0.35);
        let story = &made.story[0];
        begins(
            story,
            "naca-0012, the table at Re = 160e3. In cruise Re is 297768",
        );
        says(
            story,
            &["Built in are the tables at 160e3 and 5e6", "360e3"],
        );
        assert!(made.warnings.is_empty());
        let slender = |aspect_ratio: f64| {
            let known = |known: &mut Known| {
                (known.section, known.wing_m2) = (Some("naca-0012".to_owned()), Some(0.35));
                known.aspect_ratio = Some(aspect_ratio);
            };
            wing("", known).unwrap().warnings
        };
        assert!(slender(3.0).is_empty());
        assert!(slender(2.9)[0].contains("below 3: Prandtl's lifting line"));
        let fine = (0..=160).map(|n| 0.1 * f64::from(n));
        let fine: String = fine.map(|a| format!("{a} {} 0.01\n", round(a))).collect();
        let thinned = wing(&format!("alpha CL CD\n{fine}"), |_| ()).unwrap();
        assert!(
            thinned
                .story
                .iter()
                .any(|s| s.starts_with("Thinned to 96 of 19")),
            "{:?}",
            thinned.story
        );
        assert!(preset(2.4).warnings[0].contains("far from the 160e3"));
        assert!(
            preset(2.4).story[0].contains("7797"),
            "{:?}",
            preset(2.4).story
        );
    }
}
