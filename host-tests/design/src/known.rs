//! What a person knows of a vehicle: from flags, from a file of ten lines, or asked one by one.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Wing;
use alula_sim::experiment::{FieldError, from_toml, require};
use alula_sim::named::{on_one_line, text_of};

/// What is known. The flags and the fields of a file have the same names, with their units; what is left out has a default, or is asked.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize)]
#[cfg_attr(feature = "arguments", derive(clap::Args))]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Mass, ready to fly (kg)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub mass_kg: Option<f64>,
    /// Area of the wing (m²)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub wing_m2: Option<f64>,
    /// Section: naca-0012, naca-0015, naca-0018, naca-0021, flat-plate, or a polar's file
    #[cfg_attr(feature = "arguments", arg(long, value_name = "NAME|FILE"))]
    pub section: Option<String>,
    /// Greatest thrust over weight
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub thrust_to_weight: Option<f64>,
    /// Time until 63 % of a step of thrust is there (s)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub thrust_lag_s: Option<f64>,
    /// Time until 63 % of a step of angular rate is there (s)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub rate_lag_s: Option<f64>,
    /// Speed of cruise (m/s)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub cruise_m_s: Option<f64>,
    /// Greatest angular acceleration in pitch in hover (rad/s²): `identify` reads it from a log
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub turn_rad_s2: Option<f64>,
    /// What turns it in pitch
    #[cfg_attr(feature = "arguments", arg(long, value_enum, value_name = "WHAT"))]
    pub actuators: Option<Actuators>,
    /// Rate at which the guidance is called (Hz; default: 100)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub control_rate_hz: Option<f64>,
    /// Angle from the polar's line of α = 0, as a rule the chord, to the thrust line (°; default: 0)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub delta_deg: Option<f64>,
    /// Aspect ratio, span squared over area, that makes a section a wing (default: the polar is taken as it is)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub aspect_ratio: Option<f64>,
    /// Angle of attack at which the wing stalls (°), where the polar does not show it: rows beyond are left out
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub stall_deg: Option<f64>,
    /// Least thrust over weight, that of motors that idle (default: 0)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub idle_to_weight: Option<f64>,
    /// Diameter of each propeller (m; default: assumed)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub propeller_m: Option<f64>,
    /// Drag area of what is not wing (m²; default: 0): drag coefficient times frontal area of fuselage, motors and gear
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub drag_area_m2: Option<f64>,
    /// Density of the air (kg/m³; default: 1.225)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub air_kg_m3: Option<f64>,
}

/// What turns a vehicle in pitch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[cfg_attr(feature = "arguments", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Actuators {
    /// Elevons in the slipstream of the propellers.
    Elevons,
    /// Differences of thrust between motors above and below the wing.
    Motors,
    /// Both.
    Both,
}

impl Actuators {
    /// In words, and how many propellers such a vehicle has.
    pub(super) fn words(self) -> (&'static str, f64) {
        match self {
            Self::Elevons => ("elevons in the slipstream", 2.0),
            Self::Motors => ("differences of thrust", 4.0),
            Self::Both => ("elevons in the slipstream and differences of thrust", 4.0),
        }
    }
}

/// What [`Known`] comes to when nothing is missing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Facts {
    /// m \[kg\].
    pub mass_kg: f64,
    /// Area of the wing Σ \[m²\].
    pub wing_m2: f64,
    /// A preset, or a polar's name or file.
    pub section: String,
    /// Greatest thrust over weight.
    pub thrust_to_weight: f64,
    /// Lag of the thrust \[s\].
    pub thrust_lag_s: f64,
    /// Lag of the rate loop \[s\].
    pub rate_lag_s: f64,
    /// Speed of cruise \[m/s\].
    pub cruise_m_s: f64,
    /// Greatest angular acceleration in pitch in hover \[rad/s²\].
    pub turn_rad_s2: f64,
    /// What turns it in pitch.
    pub actuators: Actuators,
    /// Diameter of each propeller \[m\], if it is known.
    pub propeller_m: Option<f64>,
    /// Rate of the guidance's steps \[Hz\].
    pub control_rate_hz: f64,
    /// δ \[°\].
    pub delta_deg: f64,
    /// Span squared over area; none if the polar is taken as it is.
    pub aspect_ratio: Option<f64>,
    /// Angle of attack of the greatest lift \[°\], of a polar that does not show it.
    pub stall_deg: Option<f64>,
    /// Least thrust over weight.
    pub idle_to_weight: f64,
    /// Drag area of what is not wing \[m²\]; none if nothing is known of it.
    pub drag_area_m2: Option<f64>,
    /// Density of the air ρ \[kg/m³\].
    pub air_kg_m3: f64,
}

/// What is believed of each number.
const RANGES: [(&str, [f64; 2]); 15] = [
    ("mass_kg", [0.01, 1e4]),
    ("wing_m2", [1e-4, 1e3]),
    ("thrust_to_weight", [1.02, 20.0]),
    ("thrust_lag_s", [1e-3, 1.0]),
    ("rate_lag_s", [1e-3, 1.0]),
    ("cruise_m_s", [2.0, 200.0]),
    ("turn_rad_s2", [1.0, 2000.0]),
    ("control_rate_hz", [10.0, 1000.0]),
    ("delta_deg", [-90.0, 90.0]),
    ("aspect_ratio", [0.5, 50.0]),
    ("stall_deg", [5.0, 60.0]),
    ("idle_to_weight", [0.0, 0.9]),
    ("propeller_m", [0.02, 5.0]),
    ("drag_area_m2", [0.0, 100.0]),
    ("air_kg_m3", [0.1, 10.0]),
];

/// Mass over area of the wing \[kg/m²\] of what flies: from paper gliders to jets. Tail-sitters have 2 to 30.
const LOADING: [f64; 2] = [0.1, 800.0];

/// Units that people give a number in, other than its own: the number, what stands for one of its units, and their name.
const OTHER_UNITS: [(&str, f64, &str); 10] = [
    ("mass_kg", 1e-3, "g"),
    ("wing_m2", 1e-2, "dm²"),
    ("wing_m2", 1e-4, "cm²"),
    ("thrust_to_weight", 1e-2, "%"),
    ("thrust_lag_s", 1e-3, "ms"),
    ("rate_lag_s", 1e-3, "ms"),
    ("cruise_m_s", 1.0 / 3.6, "km/h"),
    ("turn_rad_s2", std::f64::consts::PI / 180.0, "°/s²"),
    ("propeller_m", 0.0254, "inches"),
    ("idle_to_weight", 1e-2, "%"),
];

/// What is asked for the first of these numbers: they must be known.
const QUESTIONS: [&str; 7] = [
    "Mass, ready to fly [kg]",
    "Area of the wing [m²]",
    "Greatest thrust over weight",
    "Time until 63 % of a step of thrust is there [s]",
    "Time until 63 % of a step of angular rate is there [s]",
    "Speed of cruise [m/s]",
    "Greatest angular acceleration in pitch in hover [rad/s²]",
];

const ACTUATORS: &str = "What turns it in pitch (elevons, motors, both)";

/// What is said to who types nothing.
const NOTHING: &str = "this must be known: there is no default";
const SECTION: &str =
    "Section (naca-0012, naca-0015, naca-0018, naca-0021, flat-plate, or a polar's file)";

impl Known {
    /// A tail-sitter of 3 kg: that of docs/your-vehicle.md.
    #[cfg(test)]
    pub(super) fn tail_sitter() -> Self {
        Self {
            mass_kg: Some(3.0),
            wing_m2: Some(0.35),
            section: Some("naca-0012".to_owned()),
            thrust_to_weight: Some(1.6),
            thrust_lag_s: Some(0.08),
            rate_lag_s: Some(0.06),
            cruise_m_s: Some(18.0),
            turn_rad_s2: Some(300.0),
            actuators: Some(Actuators::Both),
            // The numbers of the tests are those of the wing alone.
            drag_area_m2: Some(0.0),
            ..Self::default()
        }
    }

    /// What is known here, and of the rest what `other` knows.
    pub fn or(mut self, mut other: Self) -> Self {
        for (here, there) in self.numbers().into_iter().zip(other.numbers()) {
            *here = here.or(*there);
        }
        self.section = self.section.or(other.section);
        self.actuators = self.actuators.or(other.actuators);
        self
    }

    /// The numbers, in the order of [`RANGES`].
    fn numbers(&mut self) -> [&mut Option<f64>; RANGES.len()] {
        [
            &mut self.mass_kg,
            &mut self.wing_m2,
            &mut self.thrust_to_weight,
            &mut self.thrust_lag_s,
            &mut self.rate_lag_s,
            &mut self.cruise_m_s,
            &mut self.turn_rad_s2,
            &mut self.control_rate_hz,
            &mut self.delta_deg,
            &mut self.aspect_ratio,
            &mut self.stall_deg,
            &mut self.idle_to_weight,
            &mut self.propeller_m,
            &mut self.drag_area_m2,
            &mut self.air_kg_m3,
        ]
    }

    /// What the file `path` says: TOML, names as those of the flags. A polar is looked for beside the file. An error names file, line and field.
    pub fn load(path: &Path) -> anyhow::Result<Self> {
        let origin = path.display().to_string();
        let text = text_of(path)?;
        let beside = |section: &String| {
            let beside = path.with_file_name(section);
            match beside.is_file() {
                true => beside.to_string_lossy().into_owned(),
                false => section.clone(),
            }
        };
        let mut known = from_toml(&origin, &text, |known: &Self| {
            known.check()?;
            match &known.section {
                Some(section) => Wing::check(&beside(section))
                    .map_err(|e| FieldError::new("section", format!("{e:#}"))),
                None => Ok(()),
            }
        })?;
        known.section = known.section.as_ref().map(beside);
        Ok(known)
    }

    /// What the TOML `text` says; `origin` stands for it in errors.
    pub fn from_text(origin: &str, text: &str) -> anyhow::Result<Self> {
        from_toml(origin, text, Self::check)
    }

    /// Every number that is known is in its range.
    fn check(&self) -> Result<(), FieldError> {
        let mut numbers = self.clone();
        let mut known = RANGES.iter().zip(numbers.numbers());
        known.try_for_each(|((name, _), number)| number.map_or(Ok(()), |x| ranged(name, x)))
    }

    /// Asks for what is missing: `ask` gives the answer to a question. Nothing, a number that is none, or one out of its range, is asked for again,
    /// and why.
    pub fn ask(
        &mut self,
        mut ask: impl FnMut(&str) -> anyhow::Result<String>,
    ) -> anyhow::Result<()> {
        // The problem with the answer before, if there was one, stands above the question.
        let mut answer = |question: &str, problem: Option<String>| {
            let above = |problem: &str| format!("{problem}\n{question}");
            let mut answer = ask(&problem.map_or(question.to_owned(), |text| above(&text)))?;
            while answer.trim().is_empty() {
                answer = ask(&above(NOTHING))?;
            }
            anyhow::Ok(answer.trim().to_owned())
        };
        let numbers = self.numbers().into_iter().zip(RANGES);
        for ((place, (name, _)), question) in numbers.zip(QUESTIONS) {
            let mut problem = None;
            while place.is_none() {
                match number(name, &answer(question, problem.take())?) {
                    Ok(number) => *place = Some(number),
                    Err(error) => problem = Some(error),
                }
            }
        }
        let mut problem = None;
        while self.section.is_none() {
            let section = answer(SECTION, problem.take())?;
            match Wing::check(&section) {
                Ok(()) => self.section = Some(section),
                Err(error) => problem = Some(format!("{error:#}")),
            }
        }
        let mut problem = None;
        while self.actuators.is_none() {
            self.actuators = match answer(ACTUATORS, problem.take())?.as_str() {
                "elevons" => Some(Actuators::Elevons),
                "motors" => Some(Actuators::Motors),
                "both" => Some(Actuators::Both),
                other => {
                    problem = Some(format!(
                        "{} is none of the three",
                        on_one_line(&format!("{other:?}"))
                    ));
                    None
                }
            };
        }
        Ok(())
    }

    /// All of it, each number in its range.
    pub fn facts(self) -> Result<Facts, FieldError> {
        self.check()?;
        let missing = |name: &str| {
            let flag = name.replace('_', "-");
            FieldError::new(name, format!("is missing: --{flag}, or a line of the file"))
        };
        let need = |name: &str, number: Option<f64>| number.ok_or_else(|| missing(name));
        let mass_kg = need("mass_kg", self.mass_kg)?;
        let wing_m2 = need("wing_m2", self.wing_m2)?;
        loading(mass_kg, wing_m2)?;
        Ok(Facts {
            mass_kg,
            wing_m2,
            thrust_to_weight: need("thrust_to_weight", self.thrust_to_weight)?,
            thrust_lag_s: need("thrust_lag_s", self.thrust_lag_s)?,
            rate_lag_s: need("rate_lag_s", self.rate_lag_s)?,
            cruise_m_s: need("cruise_m_s", self.cruise_m_s)?,
            section: self.section.ok_or_else(|| missing("section"))?,
            turn_rad_s2: need("turn_rad_s2", self.turn_rad_s2)?,
            actuators: self.actuators.ok_or_else(|| missing("actuators"))?,
            propeller_m: self.propeller_m,
            control_rate_hz: self.control_rate_hz.unwrap_or(100.0),
            delta_deg: self.delta_deg.unwrap_or(0.0),
            aspect_ratio: self.aspect_ratio,
            stall_deg: self.stall_deg,
            idle_to_weight: self.idle_to_weight.unwrap_or(0.0),
            drag_area_m2: self.drag_area_m2,
            air_kg_m3: self.air_kg_m3.unwrap_or(1.225),
        })
    }
}

/// The range of `name`.
fn range(name: &str) -> [f64; 2] {
    let range = RANGES.iter().find(|(known, _)| *known == name);
    range.expect("listed").1
}

/// `value` must be in the range of `name`; else it is said in which unit it would be.
fn ranged(name: &str, value: f64) -> Result<(), FieldError> {
    let within = |value: f64| {
        let [least, most] = range(name);
        (least..=most).contains(&value)
    };
    let [least, most] = range(name);
    let meant = meant(name, value, within);
    let problem = format_args!("{value} is not from {least} to {most}{meant}");
    require(within(value), name, problem)
}

/// The end of a refusal of `value`: what it is if it was given in another unit in which `fits` takes it, or nothing.
fn meant(name: &str, value: f64, fits: impl Fn(f64) -> bool) -> String {
    let units = OTHER_UNITS.iter().filter(|(of, ..)| *of == name);
    let mut converted = units.map(|(_, unit, words)| (value * unit, words));
    match converted.find(|(number, _)| fits(*number)) {
        Some((number, words)) => {
            // Not the rounding's digits.
            let number = number as f32;
            format!(": were these {words}? Then it is {number}")
        }
        None => String::new(),
    }
}

/// Mass and wing must be those of one aircraft; else it is said which of them was probably given in another unit.
fn loading(mass: f64, wing: f64) -> Result<(), FieldError> {
    let flies = |mass: f64, wing: f64| (LOADING[0]..=LOADING[1]).contains(&(mass / wing));
    if flies(mass, wing) {
        return Ok(());
    }
    let of_mass = meant("mass_kg", mass, |mass| flies(mass, wing));
    let of_wing = meant("wing_m2", wing, |wing| flies(mass, wing));
    let [least, most] = LOADING;
    let (field, meant) = match of_mass.is_empty() {
        true => ("wing_m2", of_wing),
        false => ("mass_kg", of_mass),
    };
    let problem = format!(
        "{mass} kg on {wing} m² of wing are {:.3} kg/m², and aircraft have {least} to {most}{meant}",
        mass / wing
    );
    Err(FieldError::new(field, problem))
}

/// The number that somebody typed for `name`, or why it is none.
fn number(name: &str, typed: &str) -> Result<f64, String> {
    let Ok(value) = typed.parse() else {
        let hint = match typed.contains(',') && typed.replace(',', ".").parse::<f64>().is_ok() {
            true => ": decimals are parted by a point",
            false => "",
        };
        return Err(format!(
            "{} is not a number{hint}",
            on_one_line(&format!("{typed:?}"))
        ));
    };
    ranged(name, value).map_err(|error| error.problem)?;
    Ok(value)
}

impl Facts {
    /// k_a = ρΣ/2 \[kg/m\].
    pub fn k_a(&self) -> f64 {
        0.5 * self.air_kg_m3 * self.wing_m2
    }

    /// What the drag area of all that is not wing adds to c_D.
    pub fn added_drag(&self) -> f64 {
        self.drag_area_m2.unwrap_or(0.0) / self.wing_m2
    }

    /// Weight \[N\].
    pub fn weight(&self) -> f64 {
        9.81 * self.mass_kg
    }

    /// Reynolds number of cruise, of the mean chord; of an aspect ratio that is not known, that of 6.
    pub fn reynolds(&self) -> f64 {
        /// Kinematic viscosity of air at 15 °C and sea level \[m²/s\]; it goes as one over the density.
        const VISCOSITY: f64 = 1.46e-5;
        self.cruise_m_s * self.chord() / VISCOSITY * self.air_kg_m3 / 1.225
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusals::{begins, refusal, says};

    #[test]
    fn what_is_missing_is_named_and_asked() {
        let facts = Known::tail_sitter().facts().unwrap();
        assert!((facts.k_a() - 0.214_375).abs() < 1e-12 && facts.control_rate_hz == 100.0);
        let mut short = Known::tail_sitter();
        (short.mass_kg, short.section) = (None, None);
        let error = short.clone().facts().unwrap_err().to_string();
        begins(&error, "mass_kg: is missing: --mass-kg");
        // Neither a word nor a mass below every range is one, and neither nothing nor a slip of the fingers a section. What
        // was said of one answer is not said of the next.
        let mut answers = ["much", "-3", "3,5", "", "3", "", "NACA0013", "flat-plate"].iter();
        let mut asked = Vec::new();
        short
            .ask(|question| {
                asked.push(question.to_owned());
                Ok((*answers.next().unwrap()).to_owned())
            })
            .unwrap();
        assert!(
            asked[7].starts_with(
                "NACA0013: neither a file nor a built-in section; did you mean naca-0012?\nSection "
            ),
            "{asked:?}"
        );
        // Each time it is said why.
        for (i, why) in [
            (1, "\"much\" is not a number\n"),
            (2, "-3 is not from 0.01 to 10000\n"),
            (
                3,
                "\"3,5\" is not a number: decimals are parted by a point\n",
            ),
            (
                4,
                "this must be known: there is no default\nMass, ready to fly [kg]",
            ),
            (6, "this must be known: there is no default\nSection"),
        ] {
            assert!(asked[i].starts_with(why), "{asked:?}");
        }
        assert_eq!(
            (short.mass_kg, short.section.as_deref()),
            (Some(3.0), Some("flat-plate"))
        );
        assert!(answers.next().is_none());
    }

    #[test]
    fn what_nothing_flies_with_is_refused() {
        let refused = |change: fn(&mut Known)| {
            let mut bad = Known::tail_sitter();
            change(&mut bad);
            bad.facts().unwrap_err().field
        };
        assert_eq!(
            refused(|k| k.thrust_to_weight = Some(0.9)),
            "thrust_to_weight"
        );
        assert_eq!(refused(|k| k.wing_m2 = Some(f64::NAN)), "wing_m2");
        assert_eq!(refused(|k| k.aspect_ratio = Some(-1.0)), "aspect_ratio");
        assert_eq!(refused(|k| k.rate_lag_s = Some(60.0)), "rate_lag_s");
    }

    /// A number in another unit than its own is refused, in its range or not, and it is said what was probably meant.
    #[test]
    fn other_units_are_recognised() {
        let refused = |change: fn(&mut Known)| {
            let mut bad = Known::tail_sitter();
            change(&mut bad);
            bad.facts().unwrap_err().to_string()
        };
        begins(
            &refused(|k| k.mass_kg = Some(3000.0)),
            "mass_kg: 3000 kg on 0.35 m² of wing are 8571.4",
        );
        says(
            &refused(|k| k.mass_kg = Some(3000.0)),
            &["were these g? Then it is 3"],
        );
        says(
            &refused(|k| k.wing_m2 = Some(35.0)),
            &["wing_m2: ", "were these dm²? Then it is 0.35"],
        );
        says(
            &refused(|k| k.wing_m2 = Some(3500.0)),
            &["were these dm²? Then it is 35"],
        );
        says(
            &refused(|k| k.rate_lag_s = Some(60.0)),
            &["were these ms? Then it is 0.06"],
        );
        says(
            &refused(|k| k.thrust_to_weight = Some(160.0)),
            &["were these %? Then it is 1.6"],
        );
        // What flies is left alone: a glider of foam, a fast wing of metal.
        let with = |mass: f64, wing: f64| loading(mass, wing);
        assert!(with(0.02, 0.1).is_ok() && with(150.0, 0.3).is_ok());
    }

    /// A number of the file is refused with its line, and so is a polar that is not there.
    #[test]
    fn a_file_is_refused_by_line_and_field() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("known.toml");
        let error = |text: &str| refusal(&path, text, Known::load);
        let mass = error("wing_m2 = 0.3\nmass_kg = -3\n");
        assert!(
            mass.ends_with("known.toml:2: mass_kg: -3 is not from 0.01 to 10000"),
            "{mass}"
        );
        let stall = error("mass_kg = 3\n\nstall_deg = 2.0\n");
        says(&stall, &["known.toml:3: stall_deg: 2 is not from 5"]);
        let section = error("mass_kg = 3\nsection = 'mine.csv'\n");
        says(&section, &["known.toml:2: section: mine.csv: No such file"]);
        std::fs::write(folder.path().join("mine.csv"), "alpha_deg,cl,cd\n0,0,x\n").unwrap();
        let polar = error("mass_kg = 3\nsection = 'mine.csv'\n");
        says(&polar, &["known.toml:2: section: /", "mine.csv:2: \"x\""]);
    }
}
