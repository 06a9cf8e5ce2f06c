//! What a flight shows of a vehicle, and the files that say so.

use serde::Serialize;

use super::flown::ATTACHED;
use super::known::Actuators;
use super::regression::Measured;

/// Lag of the thrust that is assumed where the flight shows none \[s\].
pub(super) const ASSUMED_LAG: f64 = 0.08;

/// What a person knows besides the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// m \[kg\].
    pub mass_kg: f64,
    /// Area of the wing \[m²\].
    pub wing_m2: f64,
    /// Density of the air \[kg/m³\].
    pub air_kg_m3: f64,
}

/// Angular acceleration in pitch in hover [rad/s²].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Turn {
    /// The greatest that was had.
    pub had: f64,
    /// Whether the torque was at its stop meanwhile, where torques are logged: else there may be more.
    pub at_stop: bool,
}

/// Coefficients behind the stall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Beyond {
    /// α \[°\].
    pub alpha_deg: f64,
    /// c_L.
    pub c_l: Measured,
    /// c_D.
    pub c_d: Measured,
}

/// What a flight shows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Identified {
    /// Time that was looked at, and held out \[s\].
    pub seconds: [f64; 2],
    /// Static thrust of full throttle over the weight.
    pub thrust_to_weight: Option<Measured>,
    /// Airspeed along the nose at which full throttle gives no thrust [m/s].
    pub zero_thrust_speed_m_s: Option<Measured>,
    /// Lag of the thrust \[s\].
    pub thrust_lag_s: Option<Measured>,
    /// Lag of the pitch rate \[s\].
    pub rate_lag_s: Option<Measured>,
    /// Angular acceleration in pitch in hover.
    pub turn_rad_s2: Option<Turn>,
    /// c_L at α = 0 to the nose.
    pub c_l_0: Option<Measured>,
    /// Slope of c_L \[1/rad\].
    pub c_l_alpha: Option<Measured>,
    /// Angle of zero lift to the nose \[°\].
    pub zero_lift_deg: Option<Measured>,
    /// c_D at the c_L of cruise, and that c_L.
    pub c_d_cruise: Option<(Measured, f64)>,
    /// Coefficients behind the stall.
    pub beyond: Vec<Beyond>,
    /// Acceleration towards the belly per angular acceleration \[m\].
    pub surface_reaction_m: Option<Measured>,
    /// Share of the variance of the specific force along nose and belly that is predicted, on data that was not fitted.
    pub predicted: [f64; 2],
    /// Median of the airspeed on the wing [m/s].
    pub flown_m_s: Option<f64>,
    /// Specific force along nose and belly, measured and predicted, of what was held out: time \[s\], and four values.
    #[serde(skip)]
    pub held_out: Vec<[f64; 5]>,
    /// What the flight does not show, and which manoeuvre would.
    pub missing: Vec<String>,
}

/// What a person says besides, for the file that `new` takes.
#[derive(Clone, Debug, PartialEq)]
pub struct Besides {
    /// What turns it.
    pub actuators: Actuators,
    /// Speed of cruise; none is that of the flight, on its wing.
    pub cruise_m_s: Option<f64>,
    /// A section for what the flight does not show of the wing.
    pub section: String,
}

/// Name of the polar beside the file.
pub const POLAR: &str = "polar.csv";

impl Identified {
    /// The wing's coefficients as a table: what was seen, and below zero lift its mirror; none where the wing, or its stall, was not seen.
    pub fn polar(&self) -> Option<String> {
        let (zero, slope) = (self.zero_lift_deg?.value, self.c_l_alpha?.value);
        let (drag, cruise) = self.c_d_cruise?;
        // Attached: a line, and a parabola through the drag of cruise, of a wing whose drag at zero lift is a part of it.
        let lift = |degrees: f64| slope * (degrees - zero).to_radians();
        let induced = 0.3 * drag.value / cruise.powi(2).max(1e-3);
        let drag_at = |degrees: f64| 0.7 * drag.value + induced * lift(degrees).powi(2);
        let last = ATTACHED.to_degrees();
        let mut rows: Vec<[f64; 3]> = Vec::new();
        let mut angle = zero.ceil();
        while angle < last {
            rows.push([angle, lift(angle), drag_at(angle)]);
            angle += 1.0;
        }
        let mut next = last;
        for Beyond {
            alpha_deg: alpha,
            c_l,
            c_d,
        } in &self.beyond
        {
            // Without a gap, and where both are known.
            let known = c_l.within < 0.3 && c_d.within < 0.3 && c_d.value > 0.0;
            if *alpha < last || *alpha - next > 15.0 || !known || *alpha > 90.0 {
                continue;
            }
            rows.push([*alpha, c_l.value, c_d.value]);
            next = *alpha;
        }
        // Lift that has not fallen shows no stall.
        let most = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
        if rows.last()?[1] > 0.9 * most {
            return None;
        }
        let mirror = rows.iter().filter(|row| row[0] > zero + 0.5);
        let mirror: Vec<[f64; 3]> = mirror
            .map(|[alpha, c_l, c_d]| [2.0 * zero - alpha, -c_l, *c_d])
            .collect();
        let mut text =
            "# Identified from a flight; below zero lift its mirror: assumed.\nalpha_deg,cl,cd\n"
                .to_owned();
        for [alpha, c_l, c_d] in mirror.iter().rev().chain(&rows) {
            text += &format!("{alpha:.2},{c_l:.4},{:.5}\n", c_d.max(1e-3));
        }
        Some(text)
    }

    /// The file that `new --from` takes: each number with its interval, or the word "assumed".
    pub fn known(&self, given: &Given, besides: &Besides, flown_m_s: f64) -> String {
        let mut text = String::new();
        let mut line = |name: &str, value: f64, source: String| {
            text += &format!(
                "{:<28} # {source}\n",
                format!("{name} = {}", rounded(value))
            );
        };
        line("mass_kg", given.mass_kg, "given".to_owned());
        line("wing_m2", given.wing_m2, "given".to_owned());
        line("air_kg_m3", given.air_kg_m3, "given".to_owned());
        let mut either = |name: &str, measured: Option<Measured>, assumed: f64| match measured {
            Some(m) => line(
                name,
                m.value,
                format!("measured: within {}", rounded(m.within)),
            ),
            None => line(
                name,
                assumed,
                "assumed: the flight does not show it".to_owned(),
            ),
        };
        either("thrust_to_weight", self.thrust_to_weight, 1.6);
        either("thrust_lag_s", self.thrust_lag_s, ASSUMED_LAG);
        either("rate_lag_s", self.rate_lag_s, 0.12);
        match self.turn_rad_s2 {
            Some(Turn { had, at_stop }) => line(
                "turn_rad_s2",
                had.max(5.0),
                match at_stop {
                    true => "measured: the torque was at its stop".to_owned(),
                    false => "measured: at least, the torque was not at its stop".to_owned(),
                },
            ),
            None => line(
                "turn_rad_s2",
                15.0,
                "assumed: the flight does not show it".to_owned(),
            ),
        }
        match besides.cruise_m_s {
            Some(cruise) => line("cruise_m_s", cruise, "given".to_owned()),
            None => line("cruise_m_s", flown_m_s, "flown, on its wing".to_owned()),
        }
        let actuators = match besides.actuators {
            Actuators::Elevons => "elevons",
            Actuators::Motors => "motors",
            Actuators::Both => "both",
        };
        text += &format!("{:<28} # given\n", format!("actuators = \"{actuators}\""));
        match self.polar() {
            Some(_) => {
                text += &format!(
                    "{:<28} # measured, as far as it was seen\n",
                    format!("section = \"{POLAR}\"")
                );
            }
            None => {
                text += &format!(
                    "{:<28} # assumed: the flight does not show the wing\n",
                    format!("section = {:?}", besides.section)
                );
            }
        }
        text
    }

    /// The numbers, with their intervals, as rows of a table.
    pub fn rows(&self) -> Vec<[String; 3]> {
        let row = |what: &str, unit: &str, measured: Option<Measured>| {
            let (value, within) = match measured {
                Some(m) => (rounded(m.value), format!("± {}", rounded(m.within))),
                None => ("not shown".to_owned(), String::new()),
            };
            [
                format!(
                    "{what}{}",
                    if unit.is_empty() {
                        String::new()
                    } else {
                        format!(" [{unit}]")
                    }
                ),
                value,
                within,
            ]
        };
        let mut rows = vec![
            row("static thrust over weight", "", self.thrust_to_weight),
            row(
                "airspeed without thrust at full throttle",
                "m/s",
                self.zero_thrust_speed_m_s,
            ),
            row("lag of the thrust", "s", self.thrust_lag_s),
            row("lag of the pitch rate", "s", self.rate_lag_s),
        ];
        let what = "angular acceleration in pitch in hover";
        rows.push(match self.turn_rad_s2 {
            Some(Turn { had, at_stop }) => [
                format!("{what} [rad/s²]"),
                rounded(had),
                if at_stop {
                    "at the stop of the torque"
                } else {
                    "at least"
                }
                .to_owned(),
            ],
            None => row(what, "rad/s²", None),
        });
        rows.push(row("c_L per angle of attack", "1/rad", self.c_l_alpha));
        rows.push(row(
            "angle of zero lift to the nose",
            "°",
            self.zero_lift_deg,
        ));
        let cruise = self
            .c_d_cruise
            .map_or(String::new(), |(_, c_l)| format!(" at c_L = {c_l:.2}"));
        rows.push(row(
            &format!("c_D{cruise}"),
            "",
            self.c_d_cruise.map(|(drag, _)| drag),
        ));
        for Beyond {
            alpha_deg: alpha,
            c_l,
            c_d,
        } in &self.beyond
        {
            rows.push(row(&format!("c_L at {alpha:.0}°"), "", Some(*c_l)));
            rows.push(row(&format!("c_D at {alpha:.0}°"), "", Some(*c_d)));
        }
        rows
    }
}

/// A number in few digits.
fn rounded(x: f64) -> String {
    let digits = match x.abs() {
        x if x >= 100.0 => 0,
        x if x >= 10.0 => 1,
        x if x >= 1.0 => 2,
        _ => 3,
    };
    format!("{x:.digits$}")
}
