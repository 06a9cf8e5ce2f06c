//! What a vehicle can do: where it stalls, how tightly it turns, how steeply it descends, how soon it stops.

use anyhow::Context;
use serde::Serialize;

use super::Design;
use super::document::MASS;
use super::known::Actuators;
use crate::envelope::{Curve, Fold, Jump, JumpSummary, jump_down, jumps_down};
use alula_sim::experiment::{Document, VehicleSpec};
use alula_sim::figures::{Figures, REACHED};
use alula_sim::simulate::fly;

/// Where level flight stalls: between these speeds there is no equilibrium to be followed slowly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stall {
    /// Least airspeed \[m/s\] of level flight on the wing, where a vehicle that slows down falls off it: the speed of transition.
    pub slow_m_s: f64,
    /// Airspeed \[m/s\] up to which one that speeds up slowly stays behind the stall.
    pub fast_m_s: f64,
    /// Angles of attack \[°\] at which it does the one and the other.
    pub alpha_deg: [f64; 2],
}

/// What a vehicle can do.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Performance {
    /// The speed of transition, and the stall band of level flight; none where nothing stalls.
    pub stall: Option<Stall>,
    /// The widest jump of level flight that slows down, as the envelope has it; none where hover becomes cruise without one.
    pub jump: Option<JumpSummary>,
    /// Angle of attack \[°\] and thrust over weight of level cruise; none if it is below the speed of transition.
    pub cruise: Option<[f64; 2]>,
    /// Part of the weight that the wing carries in level cruise at most, with thrust that balances drag: below 1 none of it is on the wing.
    pub carried: f64,
    /// Greatest lift of the wing in cruise over the weight.
    pub lift: f64,
    /// Greatest load factor in cruise, and the radius of the turn with it \[m\]; none if it cannot turn.
    pub turn: Option<[f64; 2]>,
    /// Steepest glide on the wing in cruise: angle below the horizon \[°\], and sink \[m/s\].
    pub glide: Option<[f64; 2]>,
    /// Distance \[m\] in which it stops when hover is asked at once in cruise, and how far it sinks and climbs meanwhile \[m\]: flown. None
    /// if it does not reach cruise.
    pub stop_m: Option<[f64; 3]>,
}

/// Angles of attack that are looked at where nothing stalls \[rad\]: below zero lift, and to 40°.
const ANGLES: [f64; 2] = [-0.1, 0.7];

/// What a grows by behind the stall of level flight, relative to the least: less is rounding.
const RISE: f64 = 1e-3;
/// The same where a then becomes less than it was: less is a ripple, behind which level flight is still on the wing.
const RIPPLE: f64 = 0.05;
/// How far before the wing's stall that of level flight may be \[rad\]: between two rows the table is round.
const ROUND: f64 = 0.01;

/// The stall of level flight of a wing that stalls at `wing` \[rad\]: the first jump of the envelope's from there on, of those while the airspeed falls,
/// but for ripples.
fn stall(curve: &Curve, folds: &[Fold], wing: f64, speed: impl Fn(f64) -> f64) -> Option<Stall> {
    let worst = |from: f64, to: f64| {
        let between = folds.iter().filter(|fold| (from..to).contains(&fold.alpha));
        between.copied().max_by(|a, b| a.a.total_cmp(&b.a))
    };
    let rise =
        |from: &Jump, to: f64| worst(from.from_alpha, to).map_or(0.0, |up| up.a / from.a - 1.0);
    let jumps = jumps_down(curve, folds).into_iter();
    let mut jumps = jumps.filter(|jump| jump.from_alpha >= wing - ROUND);
    let mut down = jumps.next()?;
    for next in jumps {
        if rise(&down, next.from_alpha) >= RIPPLE {
            break;
        }
        down = next;
    }
    // Between there is the fold up to which one that speeds up stays behind the stall.
    let up = worst(down.from_alpha, down.to_alpha)?;
    (rise(&down, down.to_alpha) > RISE).then(|| Stall {
        slow_m_s: speed(down.a),
        fast_m_s: speed(up.a),
        alpha_deg: [down.from_alpha, up.alpha].map(f64::to_degrees),
    })
}

/// Greatest lift in cruise over the weight from which on mass and area are doubted: about 2.5 times the speed of transition.
const MOST_LIFT: f64 = 6.0;
/// Thrust over weight that is left to the heaviest vehicle that the campaign draws, or the thrust is doubted: 1.15 of the mass given. The tail-sitter of
/// docs/your-vehicle.md loses of 120 flights 17 at 1.04, 6 at 1.08, and none at 1.1, 1.12, 1.14 and 1.16.
const THRUST_LEFT: f64 = 1.045;

/// Thrust over weight from which on elevon wings that turn slowly are not lost, and the angular acceleration in hover \[rad/s²\] below which they do. Of 600
/// `heavy`, 14 rad/s², 12 of 164 with less thrust were lost and 0 of 436 with more; of 103 `mapping`, 38 rad/s², 5 of 24 below 1.5; of small flying wings,
/// 77 rad/s², none.
const ELEVON_THRUST: f64 = 1.7;
const SLOW_TURN: f64 = 50.0;

/// Speed over that of transition from which on the guidance prefers the wing to the thrust with all of its weight; it begins to at 1.18.
pub const ON_WING: f64 = 1.3;

/// Thrust over weight of level cruise below which the wing is taken for one without a vehicle: lift over drag of 20, that of good aeroplanes.
const CLEAN: f64 = 0.05;

/// Rate lag \[s\] from which on a crossing of a sharp stall may fail: the vehicle of docs/your-vehicle.md does not reach a cruise of 17 m/s with 0.14
/// and 0.16 s, and one with 0.12 s not one of 17.5 m/s.
const SLOW_RATE: f64 = 0.1;

impl Performance {
    /// What is to be doubted of the vehicle of `design`, in words.
    pub fn doubts(&self, design: &Design) -> Vec<String> {
        let facts = &design.facts;
        let (given, heaviest) = (facts.thrust_to_weight, MASS[1]);
        let weak = (given < THRUST_LEFT * heaviest).then(|| {
            format!(
                "The thrust is {given} times the weight: of vehicles {heaviest} times as heavy as said, which the campaign flies, it is {:.2} times, and less than \
                 {THRUST_LEFT} leaves too little to climb and to stop a sink. Have thrust of {:.2} times the weight and more",
                given / heaviest,
                THRUST_LEFT * heaviest
            )
        });
        let slow_elevons = facts.actuators != Actuators::Motors && facts.turn_rad_s2 < SLOW_TURN;
        let stuck = (slow_elevons && given < ELEVON_THRUST).then(|| {
            format!(
                "The thrust is {given} times the weight, and elevons turn it with {} rad/s²: of simulated ones with less than {ELEVON_THRUST} times one in fourteen was \
                 lost on its way from a start to cruise and back, in turbulence. Near the stall they have too little lift to pull up, and at half throttle too little \
                 to turn with",
                facts.turn_rad_s2
            )
        });
        let unknown = facts.actuators == Actuators::Motors && facts.zero_thrust_m_s.is_none();
        let falling = unknown.then(|| {
            format!(
                "It is not known how thrust falls with speed: where differences of thrust turn it, guidances that believed it not to fall lost 15 of 20 simulated vehicles \
                 as they braked, and told none. Taken is {:.0} m/s, from which on usual propellers give nothing: for a real vehicle give --zero-thrust-m-s",
                design.vehicle().authority.zero_thrust_speed_m_s
            )
        });
        let slow = self.cruise.is_none().then(|| {
            let what = match self.stall {
                Some(stall) => format!(
                    "is behind the stall, below the speed of transition, {:.1} m/s",
                    stall.slow_m_s
                ),
                None => format!(
                    "is not on the wing: level flight at less than {:.0}° of angle of attack begins at {:.1} m/s",
                    ANGLES[1].to_degrees(),
                    facts.cruise_m_s / self.carried.sqrt()
                ),
            };
            format!(
                "Cruise at {} m/s {what}; the wing carries {:.0} % of the weight, and the thrust the rest. It takes a wing of {:.3} m², or a faster cruise",
                facts.cruise_m_s,
                100.0 * self.carried,
                facts.wing_m2 / self.carried
            )
        });
        // Where cruise can be flown on the wing and behind the stall.
        let sharp = self.stall.filter(|stall| facts.cruise_m_s < stall.fast_m_s);
        let near = sharp
            .filter(|stall| self.cruise.is_some() && facts.cruise_m_s < ON_WING * stall.slow_m_s);
        let near = near.map(|stall| {
            format!(
                "Cruise at {} m/s is within {:.0} % of the speed of transition, {:.1} m/s: too near for the guidance to leave the stall on purpose. It may cruise \
                 behind it, with half of the weight on the thrust. From {:.1} m/s on it prefers the wing",
                facts.cruise_m_s,
                100.0 * (ON_WING - 1.0),
                stall.slow_m_s,
                ON_WING * stall.slow_m_s
            )
        });
        let late = sharp.filter(|_| facts.rate_lag_s >= SLOW_RATE).map(|_| {
            format!(
                "Cruise at {} m/s can be flown behind the stall too, and with a rate lag of {} s the vehicle may be caught there on its way to the wing: it then sinks by \
                 metres, cruises there with half of the weight on the thrust, or goes to and fro. A rate lag below {SLOW_RATE} s, or a wing with a softer stall, helps",
                facts.cruise_m_s, facts.rate_lag_s
            )
        });
        let fast = (self.lift > MOST_LIFT).then(|| {
            format!(
                "In cruise the wing could lift {:.0} times the weight: with more than {MOST_LIFT} a vehicle climbs, sinks or runs ahead where it brakes. \
                 Are mass, area (m²) and cruise (m/s) right?",
                self.lift
            )
        });
        let idle = self.cruise.map(|[_, thrust]| thrust);
        let idle = idle.filter(|thrust| *thrust < facts.idle_to_weight);
        let idle = idle.map(|thrust| {
            format!(
                "Level flight at {} m/s needs {thrust:.2} times the weight of thrust, and idle is {}: it climbs or runs ahead. Have motors that idle lower, or a \
                 faster cruise",
                facts.cruise_m_s, facts.idle_to_weight
            )
        });
        let clean = self
            .cruise
            .filter(|[_, thrust]| facts.drag_area_m2.is_none() && *thrust < CLEAN);
        let clean = clean.map(|[_, thrust]| {
            format!(
                "Level cruise takes {:.1} % of the weight as thrust: that is the wing alone, without fuselage, motors and gear. Give their drag area, \
                 --drag-area-m2: drag coefficient times frontal area; or 0 if the polar has it",
                100.0 * thrust
            )
        });
        let polar = design.wing.polar.as_ref().map(|(polar, _)| polar);
        let extended = polar.and_then(|polar| polar.seam);
        let endless = extended.filter(|_| self.stall.is_none() && facts.aspect_ratio.is_none());
        let endless = endless.map(|seam| {
            format!(
                "Nothing stalls in level flight, by an extension beyond {:.1}° for an infinite span. That of a wing of finite span stalls: give its aspect ratio",
                seam.given_deg[1]
            )
        });
        [
            weak, stuck, falling, slow, near, late, fast, idle, clean, endless,
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Of the vehicle `spec`, before it has stopped, whose wing stalls at `stall_deg` \[°\], with `thrust` \[N\] (least, most) and at a `cruise`
    /// speed [m/s]; `max_lateral_acceleration` \[g\] is the guidance's limit to the side.
    pub fn of(
        spec: &VehicleSpec,
        stall_deg: Option<f64>,
        thrust: [f64; 2],
        cruise: f64,
        max_lateral_acceleration: f64,
    ) -> Self {
        let vehicle = &spec.reference();
        let weight = spec.weight();
        let pressure = vehicle.k_a * cruise * cruise;
        let speed = |a: f64| (a * weight / vehicle.k_a).sqrt();
        let curve = Curve::new(vehicle, 0.0).map(|curve| (curve, curve.folds()));
        let stall = curve.as_ref().zip(stall_deg).and_then(|(level, degrees)| {
            let (curve, folds) = level;
            stall(curve, folds, degrees.to_radians(), speed)
        });
        let jump = curve.and_then(|(curve, folds)| jump_down(&curve, &folds));
        // On the wing: below the angle of attack at which level flight stalls.
        let last = stall.map_or(ANGLES[1], |stall| stall.alpha_deg[0].to_radians());
        let attached = || {
            const STEP: f64 = 0.001;
            let count = ((last - ANGLES[0]) / STEP).ceil();
            (0..=count as u32).map(move |n| ANGLES[0] + f64::from(n) / count * (last - ANGLES[0]))
        };

        // Level at the cruise speed at α: thrust balances drag, and lift with its part carries n times the weight.
        let level = |alpha: f64| {
            let c = vehicle.aerodynamics.at(alpha);
            let (sin, cos) = (alpha + vehicle.delta).sin_cos();
            let needed = pressure * c.c_d / cos;
            (needed, (pressure * c.c_l + needed * sin) / weight)
        };
        let trim = attached().find(|alpha| level(*alpha).1 >= 1.0);
        let cruises = trim.map(|alpha| [alpha.to_degrees(), level(alpha).0 / weight]);
        let most = |of: &dyn Fn(f64) -> f64| attached().map(of).fold(0.0, f64::max);
        let carried = most(&|alpha| level(alpha).1);
        let lift = most(&|alpha| pressure * vehicle.aerodynamics.at(alpha).c_l / weight);
        let within = attached().filter(|alpha| level(*alpha).0 <= thrust[1]);
        let load = within.map(|alpha| level(alpha).1).fold(0.0, f64::max);
        let load = load.min(f64::hypot(1.0, max_lateral_acceleration));
        let turn = (load > 1.0).then(|| {
            let side = vehicle.gravity * (load * load - 1.0).sqrt();
            [load, cruise * cruise / side]
        });

        // A glide at the cruise speed: along the path W sin γ = D − T cos, across it W cos γ = L + T sin.
        let glide = trim.and_then(|trim| {
            let idle = thrust[0];
            let angle = |alpha: f64| {
                let c = vehicle.aerodynamics.at(alpha);
                let (sin, cos) = (alpha + vehicle.delta).sin_cos();
                let along = pressure * c.c_d - idle * cos;
                let across = pressure * c.c_l + idle * sin;
                (along.atan2(across), along.hypot(across) / weight)
            };
            let carries =
                |alpha: &f64| *alpha <= trim + 0.1 && vehicle.aerodynamics.at(*alpha).c_l > 0.0;
            let below = attached().filter(carries);
            let off = |alpha: &f64| (angle(*alpha).1 - 1.0).abs();
            let best = below.min_by(|a, b| off(a).total_cmp(&off(b)))?;
            let (gamma, _) = angle(best);
            (gamma > 0.0).then(|| [gamma.to_degrees(), cruise * gamma.sin()])
        });
        Self {
            stall,
            jump: jump.map(|jump| JumpSummary::new(&jump, speed(jump.a))),
            cruise: cruises,
            carried,
            lift,
            turn,
            glide,
            stop_m: None,
        }
    }
}

/// Flies `document` with a reference that goes from `cruise` [m/s] to hover at once: how far ahead of that the vehicle comes, and how low and
/// high.
pub(super) fn stop(document: &Document, cruise: f64) -> anyhow::Result<Option<[f64; 3]>> {
    let mut document = document.clone();
    let knot = |time: f64, speed: f64| {
        format!("{{ t_s = {time:?}, down_m_s = 0.0, forward_m_s = {speed:?} }}")
    };
    let start = 2.0 + 0.5 * cruise;
    let knots = [
        knot(2.0, 0.0),
        knot(start, cruise),
        knot(start + 15.0, cruise),
        knot(start + 15.01, 0.0),
    ];
    document.assign(&format!("reference.knots=[{}]", knots.join(",")))?;
    document.assign(&format!("duration_s={:?}", start + 45.0))?;
    let experiment = document.checked()?;
    let figures = Figures::of(
        &experiment,
        &fly(&experiment).context("the stop from cruise")?,
    );
    let distances =
        ["max_ahead_m", "max_loss_back_m", "max_gain_back_m"].map(|name| figures.get(name));
    Ok((figures.get("max_cruise_error_m_s") < REACHED).then_some(distances))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Known;
    use crate::refusals::says;

    /// A flat plate has its numbers in closed form: c_L = c_1 sin 2α, c_D = c_0 + 2 c_1 sin²α.
    #[test]
    fn a_flat_plate_is_what_theory_says() {
        let (design, p) = made(|known| {
            known.section = Some("flat-plate".to_owned());
            (known.mass_kg, known.wing_m2, known.cruise_m_s) = (Some(2.0), Some(0.4), Some(15.0));
        });
        let vehicle = design.vehicle();
        assert_eq!(p.stall, None);
        // Level: q (c_L + c_D tan α) = W, and c_L + c_D tan α is (2 c_1 + c_0) tan α; angles are in steps of 0.06°.
        let pressure = vehicle.k_a_kg_m * 225.0;
        let trim = (vehicle.weight() / (pressure * (1.99 + 0.02)))
            .atan()
            .to_degrees();
        assert!((p.cruise.unwrap()[0] - trim).abs() < 0.07, "{p:?} {trim}");
        // Without thrust the glide is not steeper than drag over lift at small angles, and sinks by its angle.
        let [glide, sink] = p.glide.unwrap();
        assert!(glide > 5.0 && glide < 30.0);
        assert!((sink - 15.0 * glide.to_radians().sin()).abs() < 1e-9);
        // The load factor is bound by 2 g to the side.
        let [load, radius] = p.turn.unwrap();
        assert!(load <= 5f64.sqrt() + 1e-9 && radius > 225.0 / (2.0 * 9.82));
        // It stops, and neither falls nor climbs far.
        let [stop, loss, gain] = p.stop_m.unwrap();
        assert!(stop > 5.0 && stop < 60.0, "{stop}");
        assert!(loss < 5.0 && gain < 10.0, "{loss} {gain}");
    }

    /// The vehicle of `change`d facts, and what it can do at its cruise speed.
    fn made(change: impl Fn(&mut Known)) -> (Design, Performance) {
        let mut known = Known::tail_sitter();
        change(&mut known);
        let design = Design::new(known.facts().unwrap()).unwrap();
        let (vehicle, facts) = (design.vehicle(), &design.facts);
        let mut p = Performance::of(
            &vehicle,
            design.wing.stall_deg(),
            facts.thrust(),
            facts.cruise_m_s,
            2.0,
        );
        let document = design.document("x").unwrap();
        p.stop_m = stop(&document, facts.cruise_m_s).unwrap();
        (design, p)
    }

    fn performance(change: impl Fn(&mut Known)) -> Performance {
        made(change).1
    }

    /// The speed of transition is one: where it falls off its wing when it slows down, and where level cruise on the wing ends.
    #[test]
    fn the_speed_of_transition_is_one() {
        for (preset, wing) in [("naca-0012", 0.35), ("naca-0021", 0.35), ("naca-0021", 0.6)] {
            let at = |cruise: f64| {
                performance(|known| {
                    known.section = Some(preset.to_owned());
                    (known.wing_m2, known.cruise_m_s) = (Some(wing), Some(cruise));
                })
            };
            let transition = at(18.0).stall.expect("a stall").slow_m_s;
            assert!(
                at(1.002 * transition).cruise.is_some(),
                "{preset} {transition}"
            );
            assert!(
                at(0.998 * transition).cruise.is_none(),
                "{preset} {transition}"
            );
        }
        // By hand: the greatest c_L + c_D tan α is at 9°, 0.8527 + 0.0203 tan 9°.
        let want = (29.43 / (0.214_375 * (0.8527 + 0.0203 * 9_f64.to_radians().tan()))).sqrt();
        let slow = performance(|_| ()).stall.unwrap().slow_m_s;
        assert!((slow / want - 1.0).abs() < 1e-3, "{slow} {want}");
    }

    /// What a section can do whose lift falls by 0.12 at 6° and comes back, and stalls at 13°, with these facts changed.
    fn with_a_kink(change: impl Fn(&mut Known)) -> Option<Stall> {
        let lift = |a: f64| match a {
            a if a <= 6.0 => 0.1 * a,
            a if a <= 13.0 => 0.1 * a - 0.12,
            _ => 0.7,
        };
        let file = tempfile::NamedTempFile::new().unwrap();
        let rows: String = (0..=36)
            .map(|n| 0.5 * f64::from(n))
            .map(|a| format!("{a} {:.4} 0.02\n", lift(a)))
            .collect();
        std::fs::write(&file, format!("alpha CL CD\n{rows}")).unwrap();
        let performance = performance(|known| {
            known.section = Some(file.path().to_str().unwrap().to_owned());
            change(known);
        });
        performance.stall
    }

    /// The speed of transition is that of the stall, by hand, as above: of the section, of wings however small their slope of lift is, whose drag grows by
    /// c_L²/(π AR e) and whose angle by as much, and where the stall is told.
    #[test]
    fn the_speed_of_transition_is_that_of_the_stall() {
        let close = |stall: Option<Stall>, lift: f64, drag: f64, degrees: f64| {
            let stall = stall.expect("it jumps");
            let most = lift + drag * degrees.to_radians().tan();
            let want = (29.43 / (0.214_375 * most)).sqrt();
            // The table's interpolation is round at its greatest lift; drag makes it later, and most on a wing of small span.
            assert!(
                (stall.slow_m_s / want - 1.0).abs() < 5e-3,
                "{stall:?} {want}"
            );
            let later = stall.alpha_deg[0] - degrees;
            assert!((-0.2..2.0).contains(&later), "{stall:?} {degrees}");
        };
        close(with_a_kink(|_| ()), 1.18, 0.02, 13.0);
        for ratio in [1.5, 3.0, 6.0, 20.0] {
            let of_wing = |told: Option<f64>, lift: f64, degrees: f64| {
                let stall = with_a_kink(|known| {
                    (known.aspect_ratio, known.stall_deg) = (Some(ratio), told);
                });
                let induced = lift / (std::f64::consts::PI * ratio * 0.9);
                let degrees = degrees + induced.to_degrees();
                // The drag of separated flow grows faster than the lift of a slender wing falls: no jump.
                if stall.is_some() || ratio >= 6.0 {
                    close(stall, lift, 0.02 + lift * induced, degrees);
                }
            };
            of_wing(None, 1.18, 13.0);
            of_wing(Some(11.0), 0.98, 11.0);
        }
        close(
            with_a_kink(|known| known.stall_deg = Some(13.0)),
            1.18,
            0.02,
            13.0,
        );
    }

    /// A deep fall behind 9°, a rise as of a plate to more lift at 20°, and another fall: the least speed of level flight on the wing is at 9°, and the envelope's widest
    /// jump is another.
    #[test]
    fn a_plates_lift_behind_the_stall_is_not_on_the_wing() {
        let lift = |a: f64| match a {
            a if a <= 9.0 => 0.95 / 9.0 * a,
            a if a <= 12.0 => 0.95 - 0.35 * (a - 9.0) / 3.0,
            a if a <= 20.0 => 0.6 + 0.45 * (a - 12.0) / 8.0,
            a => 1.05 - 0.06 * (a - 20.0),
        };
        let rows: String = (0..=60)
            .map(|n| 0.5 * f64::from(n))
            .map(|a| format!("{a} {:.4} 0.02\n", lift(a)))
            .collect();
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(&file, format!("alpha CL CD\n{rows}")).unwrap();
        let performance =
            performance(|known| known.section = file.path().to_str().map(str::to_owned));
        let stall = performance.stall.unwrap();
        assert!((stall.alpha_deg[0] - 9.0).abs() < 0.1, "{stall:?}");
        assert!((stall.alpha_deg[1] - 12.0).abs() < 0.1, "{stall:?}");
        assert!(
            performance.jump.unwrap().from_alpha_deg > 19.0,
            "{performance:?}"
        );
    }

    /// What `new` says of a jump is what the envelope has: of a section whose lift falls at 6° alone, of infinite span, told to stall at 12°, where its
    /// extension goes on.
    #[test]
    fn a_jump_is_that_of_the_envelope() {
        let endless = |deep: f64| {
            let lift = |a: f64| match a {
                a if a <= 6.0 => 0.1 * a,
                a => 0.6 - deep * (a - 6.0).min(1.0) + 0.04 * (a - 6.0),
            };
            let rows: String = (0..=48)
                .map(|n| 0.25 * f64::from(n))
                .map(|a| format!("{a} {:.4} 0.02\n", lift(a)))
                .collect();
            let file = tempfile::NamedTempFile::new().unwrap();
            std::fs::write(&file, format!("alpha CL CD\n{rows}")).unwrap();
            file
        };
        for deep in [0.0, 0.12, 0.3] {
            let file = endless(deep);
            let (design, p) = made(|known| {
                known.section = file.path().to_str().map(str::to_owned);
                known.stall_deg = Some(12.0);
            });
            let vehicle = design.vehicle().reference();
            let curve = Curve::new(&vehicle, 0.0).unwrap();
            let folds = curve.folds();
            assert_eq!(p.jump.is_some(), !folds.is_empty(), "{deep}");
            assert_eq!(p.jump.is_some(), deep > 0.0, "{deep}");
            // The wing's stall is told to be at 12°, and what is before it is none.
            assert_eq!(p.stall, None, "{deep}");
            if let Some(jump) = p.jump {
                let nearest = folds.iter().map(|fold| fold.alpha.to_degrees());
                let off = nearest.map(|fold| (fold - jump.from_alpha_deg).abs());
                assert!(off.fold(f64::INFINITY, f64::min) < 1e-9, "{jump:?}");
                assert!((5.5..6.5).contains(&jump.from_alpha_deg), "{jump:?}");
            }
        }
    }

    /// Of a wing that carries less than half of the weight in cruise it is said what was probably meant: the table's greatest c_L + c_D tan α at 18 m/s
    /// carries 6.05 kg. With a little more it is doubted, and flown.
    #[test]
    fn a_wing_that_carries_too_little_is_refused() {
        let refused = |mass: f64, change: fn(&mut Known)| {
            let mut known = Known::tail_sitter();
            known.mass_kg = Some(mass);
            change(&mut known);
            Design::new(known.facts().unwrap()).unwrap_err().to_string()
        };
        says(
            &refused(30.0, |_| ()),
            &[
                "mass_kg: a wing of 0.35 m² and this section carries 6.0",
                " kg at 18 m/s, 20 % of 30 kg",
                "It takes a wing of 1.73",
                "from 40.0 m/s on: were these N? Then it is 3.058",
            ],
        );
        // No unit makes this one fly: the cruise is what is chosen for the rest.
        says(
            &refused(3.0, |known| known.cruise_m_s = Some(8.0)),
            &[
                "cruise_m_s: a wing of 0.35 m²",
                "40 % of 3 kg",
                "from 12.7 m/s on",
            ],
        );
        let (_, p) = made(|known| known.mass_kg = Some(12.0));
        assert!((0.5..0.51).contains(&p.carried), "{p:?}");
    }

    #[test]
    fn what_is_doubted_is_said() {
        let doubts = |change: fn(&mut Known)| {
            let (design, p) = made(change);
            p.doubts(&design)
        };
        let one = |change: fn(&mut Known)| {
            let doubts = doubts(change);
            assert_eq!(doubts.len(), 1, "{doubts:?}");
            doubts.into_iter().next().unwrap()
        };
        assert_eq!(doubts(|_| ()), [""; 0]);
        // A table that ends at 10°, which an infinite span carries on to 45°, and one of 6 does not.
        let file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        let rows = "alpha_deg,cl,cd\n0,0,.012\n5,.4,.02\n10,.8,.044\n15,1.2,.084\n";
        std::fs::write(&file, rows).unwrap();
        let ending = |known: &mut Known| {
            known.section = Some(file.path().to_str().unwrap().to_owned());
            known.stall_deg = Some(10.0);
        };
        let (design, p) = made(ending);
        assert!(p.doubts(&design)[0].contains("give its aspect ratio"));
        let (design, p) = made(|known| {
            ending(known);
            known.aspect_ratio = Some(6.0);
        });
        assert_eq!(p.doubts(&design), [""; 0]);
        // 1.04 / 1.1, which does not hover.
        let weak = one(|known| known.thrust_to_weight = Some(1.04));
        says(&weak, &["it is 0.95 times", "of 1.15 times"]);
        one(|known| known.thrust_to_weight = Some(1.14));
        assert_eq!(doubts(|known| known.thrust_to_weight = Some(1.15)), [""; 0]);
        // As large elevon wings turn; the others have enough of one or of the other.
        let stuck = one(|known| known.turn_rad_s2 = Some(20.0));
        says(&stuck, &["1.6 times the weight", "turn it with 20 rad/s²"]);
        assert_eq!(
            doubts(|known| {
                (known.turn_rad_s2, known.thrust_to_weight) = (Some(20.0), Some(1.7));
            }),
            [""; 0]
        );
        let falling = one(|known| known.actuators = Some(Actuators::Motors));
        says(&falling, &["Taken is 26 m/s"]);
        // By hand, as above: 12.67 m/s of 0.35 m², so (12.67 / 9)² of the area; and 0.15 m² would want 19.3 m/s.
        let slow = one(|known| known.cruise_m_s = Some(9.0));
        says(
            &slow,
            &[
                "behind the stall, below the speed of transition, 12.7 m/s",
                "a wing of 0.693 m²",
            ],
        );
        let small = one(|known| known.wing_m2 = Some(0.15));
        says(&small, &["19.3 m/s", "a wing of 0.173 m²"]);
        // The large-angle model's 2.01 tan 40.1° is 1.69 of the pressure, 0.214 · 42.3 N, over 29.4 N.
        let plate = one(|known| {
            known.section = Some("flat-plate".to_owned());
            known.cruise_m_s = Some(6.5);
        });
        says(
            &plate,
            &[
                "not on the wing: level flight at less than 40°",
                "52 % of the weight",
            ],
        );
        let late = one(|known| known.rate_lag_s = Some(0.15));
        assert!(late.contains("a rate lag of 0.15 s"), "{late}");
        // Level cruise needs c_D over c_L of thrust, some 0.03 of the weight.
        let idle = one(|known| known.idle_to_weight = Some(0.1));
        assert!(idle.contains("of thrust, and idle is 0.1"), "{idle}");
        assert_eq!(doubts(|known| known.idle_to_weight = Some(0.01)), [""; 0]);
        // A wing ten times as large, with a sharp stall and without one.
        for change in [
            (|known| known.wing_m2 = Some(3.5)) as fn(&mut Known),
            |known: &mut Known| {
                (known.wing_m2, known.aspect_ratio) = (Some(3.5), Some(6.0));
                known.section = Some("naca-0021".to_owned());
            },
        ] {
            let large = one(change);
            assert!(large.contains("Are mass, area"), "{large}");
        }
        let round = performance(|known| {
            known.section = Some("naca-0021".to_owned());
            known.aspect_ratio = Some(6.0);
        });
        // It jumps there, but by little.
        let stall = round.stall.unwrap();
        assert!(stall.fast_m_s < 1.03 * stall.slow_m_s, "{stall:?}");
    }
}
