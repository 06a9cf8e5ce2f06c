//! `[plant]` of kind `tail-sitter`: a vehicle as they are, as plain data. Every number of a file has its source, or the word "assumed".

use schemars::JsonSchema;
use serde::Deserialize;

use super::document::{FieldError, finite, positive, require};
use super::variation::Variation;
use crate::named::built_in;

/// Name and TOML text of every built-in vehicle.
pub const VEHICLES: &[(&str, &str)] = built_in! { "vehicles", ".toml";
    "small-flying-wing",
    "mapping",
    "biplane",
    "heavy",
    "xvert",
};

/// Where the vehicle stands in a document.
pub(crate) const VEHICLE: &str = "plant.vehicle";
/// Most propellers of a vehicle.
pub const MOTORS: usize = 4;
/// Most strips of a vehicle.
const STRIPS: usize = 64;

/// A strip of a wing or of a fin.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Strip {
    /// Its quarter-chord point, from the centre of mass, forward, right, down \[m\].
    pub position_m: [f64; 3],
    /// \[m\].
    pub span_m: f64,
    /// \[m\].
    pub chord_m: f64,
    /// Elevon's chord over the strip's; 0 for none, 1 for a strip that is all elevon. The left one moves strips on the left.
    #[serde(default)]
    pub elevon: f64,
    /// A fin: its span lies along down in place of right.
    #[serde(default)]
    pub upright: bool,
}

/// The wing.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wing {
    /// The profile of every strip.
    pub section: Section,
    /// Aspect ratio of the whole wing.
    pub aspect_ratio: f64,
    /// Its strips, and those of fins.
    pub strips: Vec<Strip>,
}

/// Elevons and their servos.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Servo {
    /// Stop, to either side \[°\].
    pub travel_deg: f64,
    /// First-order lag \[s\].
    pub lag_s: f64,
    /// Greatest rate \[°/s\].
    pub rate_deg_s: f64,
}

/// Motors and battery.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Motors {
    /// First-order lag of their speed \[s\].
    pub lag_s: f64,
    /// Loss of speed at the full static power, as a share.
    pub sag: f64,
}

/// `[plant.vehicle]` of a plant of kind `tail-sitter`. Axes: forward along the nose, right, down towards the belly.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TailSitterSpec {
    /// One line for reports.
    #[serde(default)]
    pub description: String,
    /// Speed of cruise that it is made for \[m/s\].
    pub cruise_speed_m_s: f64,
    /// m \[kg\].
    pub mass_kg: f64,
    /// Moments of inertia about forward, right, down \[kg·m²\].
    pub inertia_kg_m2: [f64; 3],
    /// Drag areas of the fuselage along forward, right, down \[m²\].
    pub drag_area_m2: [f64; 3],
    /// Force against the velocity through the air along forward, right, down, over that velocity \[N·s/m\]: PX4's simulator has one.
    #[serde(default)]
    pub linear_drag_n_s_m: [f64; 3],
    /// Torque against the rates about forward, right, down, over those rates \[N·m·s\]: PX4's simulator has one.
    #[serde(default)]
    pub linear_damping_n_m_s: [f64; 3],
    /// Points that it stands on besides trailing edges, fins and hubs, from the centre of mass, forward, right, down \[m\].
    #[serde(default)]
    pub feet_m: Vec<[f64; 3]>,
    /// The wing.
    pub wing: Wing,
    /// From one to [`MOTORS`].
    pub propellers: Vec<Propeller>,
    /// Their motors.
    pub motors: Motors,
    /// Elevons, where there are any.
    pub servo: Servo,
    /// Which actuator turns it about which axis.
    pub mixer: Mixer,
    /// The inner loop.
    pub rate_loop: RateLoop,
}

/// The profile of a wing, the same for all its strips.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Slope of c_L of the section at infinite span \[1/rad\].
    pub slope_1_rad: f64,
    /// Angle of attack of stall, flap at 0 \[°\].
    pub stall_deg: f64,
    /// c_D at zero lift.
    pub c_d_0: f64,
    /// Share of the leading-edge suction that the attached flow has, from 0 (sharp plate) to 1 (thick nose).
    pub suction: f64,
    /// Moment coefficient about a quarter of the chord at zero lift; positive turns the nose up.
    #[serde(default)]
    pub c_m_0: f64,
}

/// Geometry and coefficients of a propeller, and its motor.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Propeller {
    /// Hub, from the centre of mass, forward, right, down \[m\].
    pub position_m: [f64; 3],
    /// D \[m\].
    pub diameter_m: f64,
    /// Coefficients of C_T = c0 + c1 J + c2 J².
    pub c_t: [f64; 3],
    /// Coefficients of C_P = c0 + c1 J + c2 J².
    pub c_p: [f64; 3],
    /// Speed at full throttle on a full battery, unloaded by airspeed \[rev/s\].
    pub speed_max_rev_s: f64,
    /// Sense of rotation seen from behind: 1 clockwise, −1 counter-clockwise.
    pub turns: f64,
}

/// The law from rates asked for to torques.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum RateLaw {
    /// u = P e + I ∫e − D ω̇ + F ω_sp, as PX4's rate control.
    Pid {
        /// \[s/rad\].
        p: [f64; 3],
        /// \[1/rad\].
        i: [f64; 3],
        /// \[s²/rad\].
        d: [f64; 3],
        /// Feed-forward \[s/rad\].
        feed_forward: [f64; 3],
    },
    /// u += (K e − ω̇) / G: incremental dynamic inversion.
    Incremental {
        /// K \[1/s\].
        gain_1_s: [f64; 3],
        /// G: angular acceleration at full torque, as believed \[rad/s²\].
        effectiveness_rad_s2: [f64; 3],
    },
}

/// The inner loop.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RateLoop {
    /// Its rate \[Hz\].
    pub rate_hz: f64,
    /// Greatest rate that it takes as a command, about each axis \[rad/s\].
    pub rate_max_rad_s: f64,
    /// Corner of the filter on ω̇ and on the torque that it is compared with \[Hz\].
    pub cutoff_hz: f64,
    /// The law.
    pub law: RateLaw,
}

/// Which actuators turn the vehicle about each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Mixer {
    /// Elevons pitch and roll, the difference between left and right motors yaws.
    Elevons,
    /// Differences of thrust pitch and yaw, differences of propeller torque roll.
    DifferentialThrust,
    /// Both at once: elevons pitch and roll, differences of thrust pitch and yaw.
    Both,
}

/// `[plant]` of kind `tail-sitter`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TailSitterPlant {
    /// The vehicle.
    pub vehicle: TailSitterSpec,
    /// How it differs from that.
    #[serde(default)]
    pub variation: Variation,
    /// How it differs besides, which the controller is not told of.
    #[serde(default)]
    pub unknown: Variation,
    /// Transport delay of the command \[s\], in whole steps of the plant.
    #[serde(default)]
    pub delay_s: f64,
    /// The ground, below where positions are counted from \[m\]; none if left out.
    pub ground_m: Option<f64>,
    /// Whether it stands on the ground at the start: the ground is then where its tail is.
    #[serde(default)]
    pub standing: bool,
}

impl TailSitterPlant {
    /// The vehicle that the controller is told of.
    pub fn measured(&self) -> TailSitterSpec {
        self.variation.of(&self.vehicle)
    }

    /// The vehicle that flies.
    pub fn true_vehicle(&self) -> TailSitterSpec {
        self.unknown.of(&self.measured())
    }

    /// How far elevons of the true vehicle go, either way \[°\]; 0 without any.
    pub fn travel_deg(&self) -> f64 {
        self.vehicle.servo.travel_deg * self.variation.travel * self.unknown.travel
    }

    /// Checks every field. Errors name it inside `[plant]`.
    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        self.vehicle.validate().map_err(|e| e.inside("vehicle"))?;
        for (field, variation, varied) in [
            ("variation", &self.variation, self.measured()),
            ("unknown", &self.unknown, self.true_vehicle()),
        ] {
            variation.validate().map_err(|e| e.inside(field))?;
            varied.validate().map_err(|e| {
                FieldError::new(field, format!("{} of the vehicle {}", e.field, e.problem))
            })?;
        }
        let one = !self.standing || self.ground_m.is_none();
        require(one, "ground_m", "is where it stands, if it is standing")?;
        within("ground_m", self.ground_m.unwrap_or(0.0), [-1e4, 1e4])
    }
}

/// `value` must be from `least` to `most`.
fn within(field: &str, value: f64, [least, most]: [f64; 2]) -> Result<(), FieldError> {
    finite(field, value)?;
    let problem = format_args!("must be from {least} to {most}");
    require((least..=most).contains(&value), field, problem)
}

/// Each of `values` must be from `least` to `most`.
fn each(field: &str, values: &[f64], range: [f64; 2]) -> Result<(), FieldError> {
    let mut all = values.iter().enumerate();
    all.try_for_each(|(i, value)| within(&format!("{field}[{i}]"), *value, range))
}

impl TailSitterSpec {
    /// Checks every field. Errors name it inside the vehicle's own table.
    pub(crate) fn validate(&self) -> Result<(), FieldError> {
        within("mass_kg", self.mass_kg, [0.01, 1000.0])?;
        within("cruise_speed_m_s", self.cruise_speed_m_s, [1.0, 340.0])?;
        for (axis, value) in self.inertia_kg_m2.iter().enumerate() {
            positive(&format!("inertia_kg_m2[{axis}]"), *value)?;
        }
        each("drag_area_m2", &self.drag_area_m2, [0.0, 100.0])?;
        each("linear_drag_n_s_m", &self.linear_drag_n_s_m, [0.0, 1e3])?;
        each(
            "linear_damping_n_m_s",
            &self.linear_damping_n_m_s,
            [0.0, 1e4],
        )?;
        let problem = format_args!("{} feet, must be up to {STRIPS}", self.feet_m.len());
        require(self.feet_m.len() <= STRIPS, "feet_m", problem)?;
        for (i, foot) in self.feet_m.iter().enumerate() {
            each(&format!("feet_m[{i}]"), foot, PLACE)?;
        }
        self.wing.validate().map_err(|e| e.inside("wing"))?;
        let count = self.propellers.len();
        let problem = format_args!("{count} propellers, must be from 1 to {MOTORS}");
        require((1..=MOTORS).contains(&count), "propellers", problem)?;
        for (i, propeller) in self.propellers.iter().enumerate() {
            let inside = |e: FieldError| e.inside(&format!("propellers[{i}]"));
            propeller.validate().map_err(inside)?;
        }
        within("motors.lag_s", self.motors.lag_s, LAG)?;
        within("motors.sag", self.motors.sag, [0.0, 0.5])?;
        within("servo.travel_deg", self.servo.travel_deg, [0.0, 70.0])?;
        within("servo.lag_s", self.servo.lag_s, LAG)?;
        within("servo.rate_deg_s", self.servo.rate_deg_s, [1.0, 1e4])?;
        self.rate_loop.validate().map_err(|e| e.inside("rate_loop"))
    }
}

/// Lags of motors and servos \[s\]: from four periods of the slowest inner loop.
const LAG: [f64; 2] = [0.005, 1.0];

impl Wing {
    /// Mean chord of its strips without fins \[m\].
    pub(crate) fn mean_chord(&self) -> f64 {
        let level = self.strips.iter().filter(|strip| !strip.upright);
        let (area, span) = level.fold((0.0, 0.0), |(area, span), strip| {
            (area + strip.span_m * strip.chord_m, span + strip.span_m)
        });
        area / span
    }

    fn validate(&self) -> Result<(), FieldError> {
        within("aspect_ratio", self.aspect_ratio, [0.5, 50.0])?;
        let section = &self.section;
        within("section.slope_1_rad", section.slope_1_rad, [1.0, 8.0])?;
        within("section.stall_deg", section.stall_deg, [1.0, 45.0])?;
        within("section.c_d_0", section.c_d_0, [1e-4, 1.0])?;
        within("section.suction", section.suction, [0.0, 1.0])?;
        within("section.c_m_0", section.c_m_0, [-0.5, 0.5])?;
        let count = self.strips.len();
        let problem = format_args!("{count} strips, must be from 1 to {STRIPS}");
        require((1..=STRIPS).contains(&count), "strips", problem)?;
        for (i, strip) in self.strips.iter().enumerate() {
            let field = |name: &str| format!("strips[{i}].{name}");
            each(&field("position_m"), &strip.position_m, PLACE)?;
            within(&field("span_m"), strip.span_m, [1e-3, 100.0])?;
            within(&field("chord_m"), strip.chord_m, [1e-3, 20.0])?;
            within(&field("elevon"), strip.elevon, [0.0, 1.0])?;
        }
        let level = self.strips.iter().any(|strip| !strip.upright);
        require(level, "strips", "one must not be upright")
    }
}

/// Coordinates \[m\].
const PLACE: [f64; 2] = [-50.0, 50.0];

impl Propeller {
    fn validate(&self) -> Result<(), FieldError> {
        each("position_m", &self.position_m, PLACE)?;
        within("diameter_m", self.diameter_m, [0.01, 5.0])?;
        each("c_t", &self.c_t, [-1.0, 1.0])?;
        each("c_p", &self.c_p, [-1.0, 1.0])?;
        positive("c_t[0]", self.c_t[0])?;
        positive("c_p[0]", self.c_p[0])?;
        within("speed_max_rev_s", self.speed_max_rev_s, [1.0, 2000.0])?;
        require(self.turns.abs() == 1.0, "turns", "must be 1 or -1")
    }
}

impl RateLoop {
    fn validate(&self) -> Result<(), FieldError> {
        within("rate_hz", self.rate_hz, [200.0, 2000.0])?;
        within("cutoff_hz", self.cutoff_hz, [1.0, 1000.0])?;
        within("rate_max_rad_s", self.rate_max_rad_s, [0.1, 100.0])?;
        match &self.law {
            RateLaw::Pid {
                p,
                i,
                d,
                feed_forward,
            } => {
                each("law.pid.p", p, GAIN)?;
                each("law.pid.i", i, GAIN)?;
                each("law.pid.d", d, GAIN)?;
                each("law.pid.feed_forward", feed_forward, GAIN)
            }
            RateLaw::Incremental {
                gain_1_s,
                effectiveness_rad_s2,
            } => {
                each("law.incremental.gain_1_s", gain_1_s, GAIN)?;
                let field = "law.incremental.effectiveness_rad_s2";
                each(field, effectiveness_rad_s2, [0.01, 1e4])
            }
        }
    }
}

/// Gains of the inner loop, in their units.
const GAIN: [f64; 2] = [0.0, 100.0];
