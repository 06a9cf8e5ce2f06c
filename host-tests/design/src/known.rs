//! What a person knows of a vehicle: from flags, from a file of ten lines, or asked one by one.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::Wing;
use alula_sim::experiment::{FieldError, from_toml};
use alula_sim::kind::Kind;
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
    /// Airspeed at which full throttle gives no thrust (m/s; default: of usual propellers)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub zero_thrust_m_s: Option<f64>,
    /// Moment of inertia in pitch (kg m²; default: of usual vehicles)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub pitch_inertia_kg_m2: Option<f64>,
    /// Drag area of what is not wing (m²; default: 0): drag coefficient times frontal area of fuselage, motors and gear
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub drag_area_m2: Option<f64>,
    /// Side force coefficient c_Y, of the area of the wing (1/rad; default: 0, and sideslip is not estimated)
    #[cfg_attr(
        feature = "arguments",
        arg(long, value_name = "X", allow_negative_numbers = true)
    )]
    pub c_y: Option<f64>,
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
    /// Airspeed at which full throttle gives no thrust \[m/s\], if it is known.
    pub zero_thrust_m_s: Option<f64>,
    /// Moment of inertia in pitch \[kg m²\], if it is known.
    pub pitch_inertia_kg_m2: Option<f64>,
    /// Drag area of what is not wing \[m²\]; none if nothing is known of it.
    pub drag_area_m2: Option<f64>,
    /// Side force coefficient c_Y.
    pub c_y: f64,
    /// Density of the air ρ \[kg/m³\].
    pub air_kg_m3: f64,
}

/// What is believed of each number.
const RANGES: [(&str, [f64; 2]); 18] = [
    ("mass_kg", [0.01, 1e4]),
    ("wing_m2", [1e-4, 1e3]),
    ("thrust_to_weight", [1.02, 10.0]),
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
    ("zero_thrust_m_s", [3.0, 500.0]),
    ("pitch_inertia_kg_m2", [1e-7, 1e6]),
    ("drag_area_m2", [0.0, 100.0]),
    ("c_y", [0.0, 10.0]),
    ("air_kg_m3", [0.2, 2.0]),
];

/// Something that mass, areas and speeds come to together, of what flies.
struct Ratio {
    /// The numbers that it is of. Of the first ones it is asked first whether they are in another unit.
    fields: &'static [&'static str],
    /// From paper gliders to jets.
    range: [f64; 2],
    /// What somebody probably means.
    likely: [f64; 2],
    of: fn(&Known) -> Option<f64>,
    /// What it is, of these numbers.
    says: fn(&Known, f64) -> String,
}

/// What is believed of the numbers together. Tail-sitters have 2 to 30 kg/m², lift coefficients in cruise of 0.1 to 1, and 50 to 1,000 N/m². A wing whose
/// greatest lift coefficient is 1 cruises at five times its stall speed at 0.04, and carries a tenth of the weight at 10.
const RATIOS: [Ratio; 8] = [
    Ratio {
        fields: &["mass_kg", "wing_m2"],
        range: [0.1, 800.0],
        likely: [0.5, 100.0],
        of: |known| Some(known.mass_kg? / known.wing_m2?),
        says: |known, loading| {
            format!(
                "{} kg on {} m² of wing are {loading:.3} kg/m²",
                given(known.mass_kg),
                given(known.wing_m2)
            )
        },
    },
    Ratio {
        fields: &["mass_kg", "wing_m2", "cruise_m_s"],
        range: [0.04, 10.0],
        likely: [0.06, 2.0],
        of: |known| {
            let pressure = 0.5 * known.air_kg_m3.unwrap_or(AIR) * known.cruise_m_s?.powi(2);
            Some(9.81 * known.mass_kg? / known.wing_m2? / pressure)
        },
        says: |known, lift| {
            format!(
                "to carry {} kg at {} m/s, {} m² of wing need a lift coefficient of {lift:.3}",
                given(known.mass_kg),
                given(known.cruise_m_s),
                given(known.wing_m2)
            )
        },
    },
    Ratio {
        fields: &["drag_area_m2", "wing_m2"],
        range: [0.0, 0.4],
        likely: [0.001, 0.3],
        // Without any there is nothing to compare.
        of: |known| Some(known.drag_area_m2.filter(|area| *area != 0.0)? / known.wing_m2?),
        says: |known, part| {
            format!(
                "{} m² of drag area are {part:.3} times the wing of {} m²",
                given(known.drag_area_m2),
                given(known.wing_m2)
            )
        },
    },
    Ratio {
        fields: &["turn_rad_s2", "wing_m2"],
        range: [0.0, 100.0],
        likely: [0.05, 60.0],
        of: |known| Some(known.turn_rad_s2? * known.wing_m2?.sqrt() / 9.81),
        says: |known, part| {
            format!(
                "at {} rad/s² a wing of {} m² turns with {part:.0} g at as far from the axis as the side of a square of its area",
                given(known.turn_rad_s2),
                given(known.wing_m2)
            )
        },
    },
    Ratio {
        fields: &["propeller_m", "wing_m2"],
        range: [0.05, 3.0],
        likely: [0.1, 1.0],
        of: |known| Some(known.propeller_m? / known.wing_m2?.sqrt()),
        says: |known, part| {
            format!(
                "propellers of {} m are {part:.3} times the side of a square as large as the wing",
                given(known.propeller_m)
            )
        },
    },
    Ratio {
        fields: &["zero_thrust_m_s", "cruise_m_s"],
        range: [1.05, 50.0],
        likely: [1.2, 5.0],
        of: |known| Some(known.zero_thrust_m_s? / known.cruise_m_s?),
        says: |known, part| {
            format!(
                "propellers that give nothing from {} m/s on are for {part:.3} times a cruise of {} m/s",
                given(known.zero_thrust_m_s),
                given(known.cruise_m_s)
            )
        },
    },
    Ratio {
        fields: &["pitch_inertia_kg_m2", "mass_kg", "wing_m2"],
        range: [0.03, 2.0],
        likely: [0.1, 0.6],
        of: |known| {
            let square = known.pitch_inertia_kg_m2? / known.mass_kg?;
            Some((square / known.wing_m2?).sqrt())
        },
        says: |known, part| {
            format!(
                "with {} kg m² the radius of gyration is {part:.3} times the side of a square as large as the wing",
                given(known.pitch_inertia_kg_m2)
            )
        },
    },
    Ratio {
        fields: &["propeller_m", "thrust_to_weight", "mass_kg"],
        range: [2.0, 2e4],
        likely: [10.0, 5e3],
        of: |known| {
            let (_, number) = known.actuators?.words();
            let discs = number * std::f64::consts::FRAC_PI_4 * known.propeller_m?.powi(2);
            Some(known.thrust_to_weight? * 9.81 * known.mass_kg? / discs)
        },
        says: |known, loading| {
            format!(
                "propellers of {} m are loaded with {loading:.3} N/m²",
                given(known.propeller_m)
            )
        },
    },
];

/// A number in a sentence.
fn given(number: Option<f64>) -> String {
    number.map_or("?".to_owned(), |number| number.to_string())
}

/// A foot \[m\].
const FOOT: f64 = 0.3048;

/// What a number is in its own unit, if it was given in another one.
type Converted = fn(f64, &Known) -> Option<f64>;

/// What people give a number in, other than its own unit.
const OTHER_UNITS: [(&str, &str, Converted); 37] = [
    ("mass_kg", "g", |x, _| Some(1e-3 * x)),
    // A vehicle of half a kilogram has a kitchen scale's numbers.
    ("mass_kg", "N", |x, _| (x >= 5.0).then_some(x / 9.81)),
    // Nobody has a vehicle of that many tonnes.
    ("mass_kg", "t", |x, _| (x < 1.0).then_some(1e3 * x)),
    ("wing_m2", "dm²", |x, _| Some(1e-2 * x)),
    ("wing_m2", "cm²", |x, _| Some(1e-4 * x)),
    ("wing_m2", "mm²", |x, _| Some(1e-6 * x)),
    // A square foot of wing is little.
    ("wing_m2", "ft²", |x, _| {
        (x >= 1.0).then_some(FOOT * FOOT * x)
    }),
    ("thrust_to_weight", "%", |x, _| Some(1e-2 * x)),
    ("thrust_to_weight", "N", |x, known| {
        Some(x / (9.81 * known.mass_kg?))
    }),
    ("thrust_to_weight", "g of thrust", |x, known| {
        Some(1e-3 * x / known.mass_kg?)
    }),
    // Thrust goes as throttle where that is made linear.
    (
        "thrust_to_weight",
        "parts of full throttle in hover",
        |x, _| (x < 1.0).then_some(1.0 / x),
    ),
    ("thrust_lag_s", "ms", |x, _| Some(1e-3 * x)),
    ("rate_lag_s", "ms", |x, _| Some(1e-3 * x)),
    ("cruise_m_s", "km/h", |x, _| Some(x / 3.6)),
    ("cruise_m_s", "ft/s", |x, _| Some(FOOT * x)),
    ("turn_rad_s2", "°/s²", |x, _| Some(x.to_radians())),
    ("control_rate_hz", "kHz", |x, _| Some(1e3 * x)),
    ("control_rate_hz", "s of one period", |x, _| Some(1.0 / x)),
    ("delta_deg", "mrad", |x, _| Some((1e-3 * x).to_degrees())),
    ("aspect_ratio", "m of span", |x, known| {
        Some(x.powi(2) / known.wing_m2?)
    }),
    ("aspect_ratio", "cm of span", |x, known| {
        Some((1e-2 * x).powi(2) / known.wing_m2?)
    }),
    ("aspect_ratio", "mm of span", |x, known| {
        Some((1e-3 * x).powi(2) / known.wing_m2?)
    }),
    ("stall_deg", "rad", |x, _| Some(x.to_degrees())),
    ("idle_to_weight", "%", |x, _| Some(1e-2 * x)),
    ("propeller_m", "inches", |x, _| Some(0.0254 * x)),
    ("propeller_m", "cm", |x, _| Some(1e-2 * x)),
    ("propeller_m", "mm", |x, _| Some(1e-3 * x)),
    ("zero_thrust_m_s", "km/h", |x, _| Some(x / 3.6)),
    ("pitch_inertia_kg_m2", "kg cm²", |x, _| Some(1e-4 * x)),
    ("pitch_inertia_kg_m2", "g m²", |x, _| Some(1e-3 * x)),
    ("drag_area_m2", "dm²", |x, _| Some(1e-2 * x)),
    ("drag_area_m2", "cm²", |x, _| Some(1e-4 * x)),
    ("drag_area_m2", "ft²", |x, _| Some(FOOT * FOOT * x)),
    ("air_kg_m3", "g/m³", |x, _| Some(1e-3 * x)),
    ("air_kg_m3", "g/cm³", |x, _| Some(1e3 * x)),
    ("air_kg_m3", "hPa at 15 °C", |x, _| {
        Some(100.0 * x / (287.05 * 288.15))
    }),
    ("air_kg_m3", "Pa at 15 °C", |x, _| {
        Some(x / (287.05 * 288.15))
    }),
];

/// Density of the air at sea level \[kg/m³\].
const AIR: f64 = 1.225;

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
            &mut self.zero_thrust_m_s,
            &mut self.pitch_inertia_kg_m2,
            &mut self.drag_area_m2,
            &mut self.c_y,
            &mut self.air_kg_m3,
        ]
    }

    /// What the file `path` says: TOML, names as those of the flags. A polar is looked for beside the file. An error names file, line and field.
    pub fn load(path: &Path) -> anyhow::Result<Self> {
        let origin = path.display().to_string();
        let text = text_of(path)?;
        Kind::Known.expect(&origin, text.as_bytes())?;
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

    /// Every number that is known is in its range, and all of them are those of one aircraft; else it is said what was probably meant.
    fn check(&self) -> Result<(), FieldError> {
        for (name, value) in self.values() {
            self.ranged(name, value)?;
        }
        match RATIOS.iter().find(|ratio| !self.keeps(ratio, ratio.range)) {
            Some(ratio) => Err(self.of_no_aircraft(ratio)),
            None => Ok(()),
        }
    }

    /// The numbers that are known, by name.
    fn values(&self) -> Vec<(&'static str, f64)> {
        let mut known = self.clone();
        let named = RANGES.iter().zip(known.numbers());
        named
            .filter_map(|((name, _), number)| Some((*name, (*number)?)))
            .collect()
    }

    /// The same with `value` for the number `name`.
    fn with(&self, name: &str, value: f64) -> Self {
        let mut known = self.clone();
        let place = RANGES.iter().position(|(of, _)| *of == name);
        *known.numbers()[place.expect("listed")] = Some(value);
        known
    }

    /// Whether a ratio that is known is from `least` to `most`.
    fn keeps(&self, ratio: &Ratio, [least, most]: [f64; 2]) -> bool {
        (ratio.of)(self).is_none_or(|value| (least..=most).contains(&value))
    }

    /// `value` must be in the range of `name`; else it is said in which unit it would be.
    fn ranged(&self, name: &str, value: f64) -> Result<(), FieldError> {
        let [least, most] = range(name);
        if (least..=most).contains(&value) {
            return Ok(());
        }
        let all = self.meant(name, value);
        // Of several numbers in wrong units each is told by itself.
        let meant = match all.is_empty() {
            true => Self::default().meant(name, value),
            false => all,
        };
        let problem = format!("{value} is not from {least} to {most}{}", told(&meant));
        Err(FieldError::new(name, problem))
    }

    /// The units in which `value` for the number `name` would be a likely one, with what it is then.
    fn meant(&self, name: &str, value: f64) -> Vec<(&'static str, f64)> {
        let [least, most] = range(name);
        let units = OTHER_UNITS.iter().filter(|(of, ..)| *of == name);
        let converted = units.filter_map(|(_, words, to)| Some((*words, to(value, self)?)));
        let flies = |number: f64| {
            let known = self.with(name, number);
            let mut of_it = RATIOS.iter().filter(|ratio| ratio.fields.contains(&name));
            (least..=most).contains(&number) && of_it.all(|ratio| known.keeps(ratio, ratio.likely))
        };
        converted.filter(|(_, number)| flies(*number)).collect()
    }

    /// Which of these numbers was probably meant otherwise, and what it would be: the first that has another unit.
    fn doubted(&self, fields: &[&'static str]) -> (&'static str, Vec<(&'static str, f64)>) {
        let mut values = self.values();
        values.retain(|(name, _)| fields.contains(name));
        let of = |name| values.iter().find(|(of, _)| *of == name);
        let mut meant = fields.iter().filter_map(|name| {
            let (_, value) = of(*name)?;
            Some((*name, self.meant(name, *value)))
        });
        // Or else the last that one is asked: it is chosen for those before.
        let last = values.last().map_or(fields[0], |(name, _)| *name);
        meant
            .find(|(_, meant)| !meant.is_empty())
            .unwrap_or((last, Vec::new()))
    }

    /// The refusal of numbers that are not those of one aircraft.
    fn of_no_aircraft(&self, ratio: &Ratio) -> FieldError {
        let (field, meant) = self.doubted(ratio.fields);
        let value = (ratio.of)(self).unwrap_or(f64::NAN);
        let [least, most] = ratio.range;
        let problem = format!(
            "{}, and aircraft have {least} to {most}{}",
            (ratio.says)(self, value),
            told(&meant)
        );
        FieldError::new(field, problem)
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
                match typed(name, &answer(question, problem.take())?) {
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
            zero_thrust_m_s: self.zero_thrust_m_s,
            pitch_inertia_kg_m2: self.pitch_inertia_kg_m2,
            control_rate_hz: self.control_rate_hz.unwrap_or(100.0),
            delta_deg: self.delta_deg.unwrap_or(0.0),
            aspect_ratio: self.aspect_ratio,
            stall_deg: self.stall_deg,
            idle_to_weight: self.idle_to_weight.unwrap_or(0.0),
            drag_area_m2: self.drag_area_m2,
            c_y: self.c_y.unwrap_or(0.0),
            air_kg_m3: self.air_kg_m3.unwrap_or(AIR),
        })
    }
}

/// The range of `name`.
fn range(name: &str) -> [f64; 2] {
    let range = RANGES.iter().find(|(known, _)| *known == name);
    range.expect("listed").1
}

/// The end of a refusal: in which units the number was probably given, and what it is then.
fn told(meant: &[(&str, f64)]) -> String {
    let all: Vec<String> = meant
        .iter()
        // Not the rounding's digits.
        .map(|(words, number)| format!("were these {words}? Then it is {}", *number as f32))
        .collect();
    match all[..] {
        [] => String::new(),
        _ => format!(": {}", all.join("; or ")),
    }
}

/// The number that somebody typed for `name`, or why it is none.
fn typed(name: &str, typed: &str) -> Result<f64, String> {
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
    Known::default()
        .ranged(name, value)
        .map_err(|error| error.problem)?;
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

    /// The refusal of a vehicle whose wing carries no more than the part `carried` of its weight in cruise.
    pub(super) fn not_carried(&self, carried: f64) -> FieldError {
        let known = Known {
            mass_kg: Some(self.mass_kg),
            wing_m2: Some(self.wing_m2),
            cruise_m_s: Some(self.cruise_m_s),
            air_kg_m3: Some(self.air_kg_m3),
            ..Known::default()
        };
        let (field, meant) = known.doubted(&["mass_kg", "wing_m2", "cruise_m_s"]);
        let problem = format!(
            "a wing of {} m² and this section carries {:.2} kg at {} m/s, {:.0} % of {} kg: that is no cruise on a wing. It takes a wing of {:.3} m², or a \
             cruise from {:.1} m/s on{}",
            self.wing_m2,
            carried * self.mass_kg,
            self.cruise_m_s,
            100.0 * carried,
            self.mass_kg,
            self.wing_m2 / carried,
            self.cruise_m_s / carried.sqrt(),
            told(&meant)
        );
        FieldError::new(field, problem)
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
            &["were these cm²? Then it is 0.35"],
        );
        says(
            &refused(|k| k.rate_lag_s = Some(60.0)),
            &["were these ms? Then it is 0.06"],
        );
        says(
            &refused(|k| k.thrust_to_weight = Some(160.0)),
            &["were these %? Then it is 1.6"],
        );
        // Numbers in their ranges, which are not those of one aircraft.
        begins(
            &refused(|k| {
                (k.mass_kg, k.wing_m2) = (Some(2200.0), Some(3.5));
                k.cruise_m_s = Some(12.0);
            }),
            "mass_kg: to carry 2200 kg at 12 m/s, 3.5 m² of wing need a lift coefficient of 69",
        );
        for (change, says_so) in [
            (
                (|k: &mut Known| k.mass_kg = Some(0.0022)) as fn(&mut Known),
                "were these t? Then it is 2.2",
            ),
            (
                |k| k.thrust_to_weight = Some(0.55),
                "0.55 is not from 1.02 to 10: were these parts of full throttle in hover? Then it is 1.818",
            ),
            (
                |k| k.drag_area_m2 = Some(1.2),
                "drag_area_m2: 1.2 m² of drag area are 3.429 times the wing of 0.35 m², and aircraft have 0 to 0.4: were these dm²? Then it is 0.012",
            ),
            (
                |k| k.drag_area_m2 = Some(0.35),
                "drag_area_m2: 0.35 m² of drag area are 1.000 times the wing",
            ),
            (
                |k| k.wing_m2 = Some(350.0),
                "wing_m2: 3 kg on 350 m² of wing are 0.009 kg/m²",
            ),
            (
                |k| k.wing_m2 = Some(3.77),
                "wing_m2: to carry 3 kg at 18 m/s, 3.77 m² of wing need a lift coefficient of 0.039, and aircraft have 0.04 to 10: were these ft²? Then it is 0.350",
            ),
            (
                |k| k.cruise_m_s = Some(3.0),
                "cruise_m_s: to carry 3 kg at 3 m/s",
            ),
            (
                |k| k.cruise_m_s = Some(65.0),
                "cruise_m_s: to carry 3 kg at 65 m/s, 0.35 m² of wing need a lift coefficient of 0.032, and aircraft have 0.04 to 10: were these km/h? Then it is 18.055555; or were these ft/s? Then it is 19.812",
            ),
            (
                |k| {
                    (k.mass_kg, k.wing_m2) = (Some(3000.0), Some(35.0));
                    k.cruise_m_s = Some(65.0);
                },
                "were these °/s²? Then it is 5.23",
            ),
            (
                |k| {
                    (k.mass_kg, k.wing_m2) = (Some(1.0), Some(0.12));
                    k.thrust_to_weight = Some(16.0);
                },
                "16 is not from 1.02 to 10: were these N? Then it is 1.63",
            ),
            (
                |k| k.drag_area_m2 = Some(120.0),
                "were these cm²? Then it is 0.012",
            ),
            (
                |k| k.air_kg_m3 = Some(1225.0),
                "were these g/m³? Then it is 1.225",
            ),
            (
                |k| k.air_kg_m3 = Some(1013.0),
                "were these hPa at 15 °C? Then it is 1.2247",
            ),
            (
                |k| k.air_kg_m3 = Some(0.0012),
                "were these g/cm³? Then it is 1.2",
            ),
            (
                |k| k.aspect_ratio = Some(145.0),
                "were these cm of span? Then it is 6.007",
            ),
            (
                |k| k.aspect_ratio = Some(1450.0),
                "were these mm of span? Then it is 6.007",
            ),
            (
                |k| k.propeller_m = Some(30.0),
                "is not from 0.02 to 5: were these cm? Then it is 0.3",
            ),
            (
                |k| k.propeller_m = Some(300.0),
                "were these mm? Then it is 0.3",
            ),
            (
                |k| k.thrust_to_weight = Some(47.0),
                "were these N? Then it is 1.597",
            ),
            (
                |k| k.stall_deg = Some(0.26),
                "were these rad? Then it is 14.8",
            ),
            (
                |k| k.control_rate_hz = Some(0.005),
                "were these s of one period? Then it is 200",
            ),
        ] {
            says(&refused(change), &[says_so]);
        }
        // What flies is left alone: a glider of foam, a fast wing of metal.
        let with = |mass: f64, wing: f64, cruise: f64| Known {
            mass_kg: Some(mass),
            wing_m2: Some(wing),
            cruise_m_s: Some(cruise),
            ..Known::default()
        };
        assert_eq!(with(0.02, 0.1, 4.0).check(), Ok(()));
        assert_eq!(with(150.0, 0.3, 120.0).check(), Ok(()));
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
