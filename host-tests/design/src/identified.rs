//! What a flight shows of a vehicle, and the files that say so.

use std::f64::consts::PI;

use serde::Serialize;

use super::flown::ATTACHED;
use super::known::Actuators;
use super::regression::Measured;

/// Lag of the thrust that is assumed where the flight shows none \[s\].
pub(super) const ASSUMED_LAG: f64 = 0.08;

/// Aspect ratio that is assumed where nobody says it, and drag of the whole vehicle where the flight does not show it: those of tail-sitters.
const ASSUMED_RATIO: f64 = 4.0;
const ASSUMED_DRAG: f64 = 0.04;
/// Of a wing: the span efficiency.
const SPAN_EFFICIENCY: f64 = 0.85;
/// Interval of coefficients behind the stall within which they are known.
const KNOWN: f64 = 0.3;
/// Angle of attack \[°\] up to which the lift of a wing that is not seen behind its stall stays what it was: a wing of a small aspect ratio at a small Reynolds number.
const PLATEAU: f64 = 25.0;
/// Share of the greatest lift, short of which lift has fallen.
const FALLEN: f64 = 0.9;

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
    /// Lag of the rate about the nose \[s\].
    pub nose_lag_s: Option<Measured>,
    /// Lag of the rate about the belly \[s\].
    pub belly_lag_s: Option<Measured>,
    /// Angular acceleration in pitch in hover.
    pub turn_rad_s2: Option<Turn>,
    /// What a full torque of surfaces would give of it [rad/s²].
    pub full_torque_rad_s2: Option<Measured>,
    /// Slope of c_L \[1/rad\].
    pub c_l_alpha: Option<Measured>,
    /// Angle of zero lift to the nose \[°\].
    pub zero_lift_deg: Option<Measured>,
    /// The angle of attack to the nose \[°\] short of stall at which the flight knows c_L best, and c_L there.
    pub lift: Option<(f64, Measured)>,
    /// c_D at the c_L of cruise, and that c_L.
    pub c_d_cruise: Option<(Measured, f64)>,
    /// c_Y, of the same reference area.
    pub c_y: Option<Measured>,
    /// Coefficients behind the stall.
    pub beyond: Vec<Beyond>,
    /// Acceleration towards the belly per angular acceleration \[m\].
    pub surface_reaction_m: Option<Measured>,
    /// Share of the variance of the specific force along nose and belly that is predicted, on data that was not fitted.
    pub predicted: [f64; 2],
    /// Median of the airspeed on the wing [m/s].
    pub flown_m_s: Option<f64>,
    /// Level wind in the mean of the flight, towards north and east [m/s].
    pub wind_m_s: [Option<Measured>; 2],
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
    /// Aspect ratio of the wing; none is taken for 4.
    pub aspect_ratio: Option<f64>,
    /// A section for a wing that the flight does not show.
    pub section: String,
}

impl Besides {
    fn ratio(&self) -> f64 {
        self.aspect_ratio.unwrap_or(ASSUMED_RATIO)
    }
}

/// A wing as far as a flight shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct WingSeen {
    /// Its polar, in the columns of a file.
    pub csv: String,
    /// Where it is taken to stall \[°\]: where the polar ends, if lift does not fall before.
    pub stall_deg: Option<f64>,
}

/// Slope of c_L \[1/rad\] of a wing of this aspect ratio, of thin sections (Khan and Nahon, as the plant's).
fn slope_of(ratio: f64) -> f64 {
    2.0 * PI / (1.0 + 2.0 * (ratio + 4.0) / (ratio * (ratio + 2.0)))
}

/// The angles of attack behind the stall \[°\] at which coefficients are looked at.
fn angles_behind() -> impl Iterator<Item = f64> {
    (1..6).map(|n| 10.0 * f64::from(n) + 5.0)
}

/// Name of the polar beside the file.
pub const POLAR: &str = "polar.csv";

impl Identified {
    /// What was seen at this angle of attack behind the stall \[°\]: it, c_L and c_D; none where they are not known.
    fn behind(&self, alpha: f64) -> Option<[f64; 3]> {
        let near = |beyond: &&Beyond| (beyond.alpha_deg - alpha).abs() < 1.0;
        let Beyond { c_l, c_d, .. } = self.beyond.iter().find(near)?;
        let known = c_l.within < KNOWN && c_d.within < KNOWN && c_d.value > 0.0;
        known.then_some([alpha, c_l.value, c_d.value])
    }

    /// Whether all is known of the wing up to [`PLATEAU`].
    pub(super) fn stall_is_seen(&self) -> bool {
        angles_behind()
            .take_while(|alpha| *alpha <= PLATEAU)
            .all(|alpha| self.behind(alpha).is_some())
    }

    /// The wing's coefficients as a table: what was seen, and below zero lift its mirror; none where the wing was not seen short of stall. What the flight does not
    /// show of it is that of a wing of this aspect ratio, whose lift stays behind the stall what it was.
    pub fn polar(&self, besides: &Besides) -> Option<WingSeen> {
        let (at, c_l) = self.lift?;
        let ratio = besides.ratio();
        let slope = self.c_l_alpha.map_or(slope_of(ratio), |slope| slope.value);
        let zero = at - (c_l.value / slope).to_degrees();
        let (drag, cruise) = self
            .c_d_cruise
            .map_or((ASSUMED_DRAG, c_l.value), |(drag, c_l)| (drag.value, c_l));
        // Attached: a line, and a parabola through the drag of cruise.
        let induced = 1.0 / (PI * SPAN_EFFICIENCY * ratio);
        let least = (drag - induced * cruise * cruise).max(0.3 * drag);
        let lift = |degrees: f64| slope * (degrees - zero).to_radians();
        let last = ATTACHED.to_degrees();
        let mut rows: Vec<[f64; 3]> = Vec::new();
        let mut angle = zero.ceil();
        while angle < last {
            rows.push([angle, lift(angle), least + induced * lift(angle).powi(2)]);
            angle += 1.0;
        }
        for alpha in angles_behind() {
            let [_, before, _] = *rows.last()?;
            // Behind the stall the force is across the chord.
            let assumed = [alpha, before, least + before * alpha.to_radians().tan()];
            match self.behind(alpha) {
                Some(seen) => rows.push(seen),
                None if alpha <= PLATEAU => rows.push(assumed),
                None => break,
            }
        }
        let end = *rows.last()?;
        let most = rows.iter().map(|row| row[1]).fold(0.0, f64::max);
        let stall_deg = (end[1] > FALLEN * most).then_some(end[0]);
        let mirror = rows.iter().filter(|row| row[0] > zero + 0.5);
        let mirror: Vec<[f64; 3]> = mirror
            .map(|[alpha, c_l, c_d]| [2.0 * zero - alpha, -c_l, *c_d])
            .collect();
        let mut csv = format!(
            "# For an aspect ratio of {ratio}: the whole wing, identified from a flight; below zero lift its mirror: assumed.\nalpha_deg,cl,cd\n"
        );
        for [alpha, c_l, c_d] in mirror.iter().rev().chain(&rows) {
            csv += &format!("{alpha:.2},{c_l:.4},{:.5}\n", c_d.max(1e-3));
        }
        Some(WingSeen { csv, stall_deg })
    }

    /// In words, the axes whose rates are later than that in pitch, which `pitch` is.
    fn later(&self, pitch: Measured) -> String {
        let axes = [("nose", self.nose_lag_s), ("belly", self.belly_lag_s)];
        let known = axes
            .into_iter()
            .filter_map(|(axis, lag)| Some((axis, lag?)));
        let later = known
            .filter(|(_, lag)| lag.value - pitch.value > lag.within.hypot(pitch.within))
            .map(|(axis, lag)| {
                format!(
                    "; that is in pitch, about the {axis} it is {}",
                    rounded(lag.value)
                )
            });
        later.collect()
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
        let mut either =
            |name: &str, measured: Option<Measured>, assumed: f64, also: &str| match measured {
                Some(m) => line(
                    name,
                    m.value,
                    format!("measured: within {}{also}", rounded(m.within)),
                ),
                None => line(
                    name,
                    assumed,
                    "assumed: the flight does not show it".to_owned(),
                ),
            };
        either("thrust_to_weight", self.thrust_to_weight, 1.6, "");
        either("thrust_lag_s", self.thrust_lag_s, ASSUMED_LAG, "");
        either("c_y", self.c_y, 0.0, "");
        let later = self.rate_lag_s.map(|pitch| self.later(pitch));
        either(
            "rate_lag_s",
            self.rate_lag_s,
            0.12,
            &later.unwrap_or_default(),
        );
        let of_surfaces = (besides.actuators == Actuators::Elevons)
            .then_some(self.full_torque_rad_s2)
            .flatten();
        match (of_surfaces, self.turn_rad_s2) {
            (Some(full), _) => line(
                "turn_rad_s2",
                full.value,
                format!("measured: within {}", rounded(full.within)),
            ),
            (None, Some(Turn { had, at_stop })) => line(
                "turn_rad_s2",
                had.max(5.0),
                match at_stop {
                    true => "measured: the torque was at its stop".to_owned(),
                    false => "measured: at least, the torque was not at its stop".to_owned(),
                },
            ),
            (None, None) => line(
                "turn_rad_s2",
                15.0,
                "assumed: the flight does not show it".to_owned(),
            ),
        }
        // What is not shown is assumed by `new`.
        if let Some(speed) = self.zero_thrust_speed_m_s {
            line(
                "zero_thrust_m_s",
                speed.value,
                format!("measured: within {}", rounded(speed.within)),
            );
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
        let mut line = |what: String, source: &str| {
            text += &format!("{what:<28} # {source}\n");
        };
        line(
            format!("aspect_ratio = {}", besides.ratio()),
            match besides.aspect_ratio {
                Some(_) => "given",
                None => "assumed: nobody says it",
            },
        );
        match self.polar(besides) {
            Some(WingSeen { stall_deg, .. }) => {
                line(
                    format!("section = \"{POLAR}\""),
                    match (self.c_l_alpha, self.c_d_cruise) {
                        (Some(_), Some(_)) => "measured, as far as it was seen",
                        (Some(_), None) => "measured, but for the drag in cruise",
                        (None, _) => "measured, but for the slope of c_L",
                    },
                );
                if let Some(stall) = stall_deg {
                    line(
                        format!("stall_deg = {stall:.2}"),
                        "assumed: as far as it was seen lift does not fall",
                    );
                }
            }
            None => line(
                format!("section = {:?}", besides.section),
                "assumed: the flight does not show the wing",
            ),
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
            row("lag of the rate about the nose", "s", self.nose_lag_s),
            row("lag of the rate about the belly", "s", self.belly_lag_s),
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
        rows.push(row(
            &format!("{what}, of a full torque of surfaces"),
            "rad/s²",
            self.full_torque_rad_s2,
        ));
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
        rows.push(row("c_Y, side force over sideslip", "1/rad", self.c_y));
        for Beyond {
            alpha_deg: alpha,
            c_l,
            c_d,
        } in &self.beyond
        {
            rows.push(row(&format!("c_L at {alpha:.0}°"), "", Some(*c_l)));
            rows.push(row(&format!("c_D at {alpha:.0}°"), "", Some(*c_d)));
        }
        for (toward, wind) in ["north", "east"].into_iter().zip(self.wind_m_s) {
            rows.push(row(&format!("mean wind towards {toward}"), "m/s", wind));
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

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::polar::Polar;

    fn measured(value: f64) -> Measured {
        Measured {
            value,
            within: 0.05,
        }
    }

    /// A flight that shows the wing short of stall alone: c_L of 0.3 at 4°, and c_D of 0.04 there.
    fn short_of_stall() -> Identified {
        Identified {
            lift: Some((4.0, measured(0.3))),
            c_d_cruise: Some((measured(0.04), 0.3)),
            ..Identified::default()
        }
    }

    fn besides(aspect_ratio: f64) -> Besides {
        Besides {
            actuators: Actuators::Elevons,
            cruise_m_s: None,
            aspect_ratio: Some(aspect_ratio),
            section: "naca-0012".to_owned(),
        }
    }

    fn polar(identified: &Identified, aspect_ratio: f64) -> (Polar, Option<f64>) {
        let WingSeen { csv, stall_deg } = identified.polar(&besides(aspect_ratio)).unwrap();
        (Polar::from_text("seen", &csv).unwrap(), stall_deg)
    }

    fn at(polar: &Polar, alpha: f64) -> [f64; 2] {
        let rows = polar.degrees();
        let n = rows.iter().position(|row| row[0] >= alpha).unwrap();
        let [a, b] = [rows[n - 1], rows[n]];
        let part = (alpha - a[0]) / (b[0] - a[0]);
        [1, 2].map(|k| a[k] + part * (b[k] - a[k]))
    }

    /// What was measured short of stall is flown whether the flight shows the stall or not; the slope that is not measured is that of the aspect ratio, about the
    /// angle at which the lift is known; and the table is that of a whole wing, which no lifting line makes another.
    #[test]
    fn what_was_seen_of_a_wing_is_kept() {
        let (seen, stall) = polar(&short_of_stall(), 4.0);
        assert_eq!(stall, Some(PLATEAU));
        assert!(seen.is_of_wing());
        let [c_l, c_d] = at(&seen, 4.0);
        assert!((c_l - 0.3).abs() < 1e-3 && (c_d - 0.04).abs() < 1e-3);
        let slope = |polar: &Polar| (at(polar, 6.0)[0] - at(polar, 2.0)[0]) / 4.0_f64.to_radians();
        assert!((slope(&seen) - slope_of(4.0)).abs() < 0.02);
        let steeper = Identified {
            c_l_alpha: Some(measured(5.0)),
            ..short_of_stall()
        };
        let (seen, _) = polar(&steeper, 4.0);
        assert!((slope(&seen) - 5.0).abs() < 0.02 && (at(&seen, 4.0)[0] - 0.3).abs() < 1e-3);
    }

    /// A rate that is later than that in pitch is said beside it, and one that may be as early is not; what is not shown is assumed.
    #[test]
    fn each_number_says_where_it_is_from() {
        let given = Given {
            mass_kg: 2.4,
            wing_m2: 0.4,
            air_kg_m3: 1.225,
        };
        let line = |identified: &Identified, name: &str| {
            let text = identified.known(&given, &besides(4.0), 18.0);
            let line = text.lines().find(|line| line.starts_with(name));
            line.unwrap().split_once('#').unwrap().1.trim().to_owned()
        };
        let lag = |value: f64| {
            Some(Measured {
                value,
                within: 0.01,
            })
        };
        let seen = Identified {
            rate_lag_s: lag(0.08),
            nose_lag_s: lag(0.15),
            belly_lag_s: lag(0.09),
            c_y: Some(measured(0.4)),
            ..Identified::default()
        };
        assert_eq!(
            line(&seen, "rate_lag_s"),
            "measured: within 0.010; that is in pitch, about the nose it is 0.150"
        );
        assert_eq!(line(&seen, "c_y"), "measured: within 0.050");
        let assumed = "assumed: the flight does not show it";
        for name in ["rate_lag_s", "c_y"] {
            assert_eq!(line(&Identified::default(), name), assumed);
        }
    }

    /// Behind the stall what was seen is taken, with the angle where lift falls; what was not is across the chord.
    #[test]
    fn behind_the_stall_what_was_seen_is_taken() {
        let beyond = |alpha_deg: f64, c_l: f64, c_d: f64| Beyond {
            alpha_deg,
            c_l: measured(c_l),
            c_d: measured(c_d),
        };
        let (assumed, _) = polar(&short_of_stall(), 4.0);
        let [c_l, c_d] = at(&assumed, 25.0);
        assert!((c_d / c_l - 25.0_f64.to_radians().tan()).abs() < 0.06);
        let falls = Identified {
            beyond: vec![beyond(15.0, 0.9, 0.2), beyond(25.0, 0.6, 0.35)],
            ..short_of_stall()
        };
        let (seen, stall) = polar(&falls, 4.0);
        assert_eq!((at(&seen, 25.0), stall), ([0.6, 0.35], None));
        assert!(falls.stall_is_seen() && !short_of_stall().stall_is_seen());
    }
}
