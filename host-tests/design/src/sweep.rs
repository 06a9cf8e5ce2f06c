//! The equilibria along an experiment's reference: is the flight as planned admissible?

use alula::planar::Reference;
use alula::planar::equilibrium::Equilibria;
use alula::planar::equilibrium::{Branch, Equilibrium, EquilibriumError};
use anyhow::Context;
use serde::{Serialize, Serializer};

use alula_sim::experiment::{Experiment, V3, ned};
use alula_sim::reference::wrap;

/// Most instants looked at.
const INSTANTS: usize = 4000;

/// θ_e moving by more than this \[rad\] between two instants is called a jump: 2°. Next to a fold it moves like a root, by
/// some tenths of a degree between instants a few milliseconds apart.
const JUMP: f64 = 2.0 * std::f64::consts::PI / 180.0;

/// One instant.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Time \[s\].
    pub t: f64,
    /// Reference acceleration \[m/s²\].
    pub acceleration: V3,
    /// The set, or why there is none.
    pub set: Result<Equilibria, EquilibriumError>,
    /// The equilibrium that the vehicle is to follow: on the branch θ̃ = 0, the nearest to the one before.
    pub followed: Option<Equilibrium>,
}

/// Why an equilibrium jumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// It met another at a fold and vanished: no vehicle follows that.
    Fold,
    /// The reference has a corner, where its acceleration jumps: the plan's own doing.
    Corner,
}

/// Writes a thousandth of each unit: the digits beyond say nothing.
fn rounded<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    ((value * 1e3).round() / 1e3).serialize(serializer)
}

/// Where the followed equilibrium jumps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Jump {
    /// Time \[s\].
    #[serde(serialize_with = "rounded")]
    pub t_s: f64,
    /// Why.
    pub cause: Cause,
    /// θ_e before \[°\].
    #[serde(serialize_with = "rounded")]
    pub from_theta_deg: f64,
    /// θ_e after \[°\].
    #[serde(serialize_with = "rounded")]
    pub to_theta_deg: f64,
    /// α_e before \[°\].
    #[serde(serialize_with = "rounded")]
    pub from_alpha_deg: f64,
    /// α_e after \[°\].
    #[serde(serialize_with = "rounded")]
    pub to_alpha_deg: f64,
}

/// A span of time, and the worst value in it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Span {
    /// Begin \[s\].
    #[serde(serialize_with = "rounded")]
    pub from_s: f64,
    /// End \[s\].
    #[serde(serialize_with = "rounded")]
    pub to_s: f64,
    /// Least value.
    #[serde(serialize_with = "rounded")]
    pub least: f64,
}

/// What stands against a planned flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Findings {
    /// Whether nothing does; jumps at corners of the reference do not.
    pub admissible: bool,
    /// Jumps of the equilibrium orientation.
    pub jumps: Vec<Jump>,
    /// |F_p| under the bound: the law loses its direction.
    pub low_fp: Vec<Span>,
    /// Negative thrust at the equilibrium.
    pub negative_thrust: Vec<Span>,
    /// No equilibrium to follow on the branch θ̃ = 0; the value is the number of equilibria on the other.
    pub none: Vec<Span>,
}

/// The least |F_p| \[N\] that the law of the experiment's controller is to meet: its τ.
pub fn least_fp(experiment: &Experiment) -> anyhow::Result<f64> {
    let spec = experiment.spec()?;
    let gains = spec.gains(spec.belief().unwrap_or(&experiment.vehicle));
    Ok(gains.map_or(0.0, |gains| gains.tau()))
}

/// The equilibria of the experiment's true vehicle along its reference.
pub fn sweep(experiment: &Experiment) -> anyhow::Result<Vec<Instant>> {
    let knots = experiment.path.knots().filter(|_| experiment.in_plane());
    let knots = knots.context("the sweep is of experiments in a vertical plane, with knots")?;
    let vehicle = experiment.vehicle.core().expect("validated when loaded");
    let wind = ned(experiment.weather.steady()).to_plane();
    let steps = experiment.steps().min(INSTANTS);
    let mut theta = experiment.initial.theta_deg.to_radians();
    let instants = (0..=steps)
        .map(|i| {
            let t = experiment.duration_s * i as f64 / steps as f64;
            let (velocity, acceleration) = knots.at(t);
            let reference = Reference {
                velocity: ned(velocity).to_plane(),
                acceleration: ned(acceleration).to_plane(),
            };
            let set = Equilibria::find(&vehicle, &reference, wind);
            let distance = |e: &Equilibrium| wrap(f64::from(e.attitude.angle()) - theta).abs();
            let followed = set.as_ref().ok().and_then(|set| {
                let aligned = set
                    .as_slice()
                    .iter()
                    .filter(|e| e.branch() == Branch::Aligned);
                aligned
                    .min_by(|a, b| distance(a).total_cmp(&distance(b)))
                    .copied()
            });
            if let Some(e) = followed {
                theta = e.attitude.angle().into();
            }
            Instant {
                t,
                acceleration,
                set,
                followed,
            }
        })
        .collect();
    Ok(instants)
}

/// What stands against the flight: jumps, |F_p| below `least_fp` \[N\], negative thrust.
pub fn findings(instants: &[Instant], least_fp: f64) -> Findings {
    let jumps: Vec<Jump> = instants
        .windows(2)
        .filter_map(|pair| {
            let (before, after) = (pair[0].followed?, pair[1].followed?);
            let theta = |e: &Equilibrium| f64::from(e.attitude.angle());
            let jump = wrap(theta(&after) - theta(&before)).abs() > JUMP;
            let corner = (pair[1].acceleration - pair[0].acceleration).norm() > 0.1;
            jump.then(|| Jump {
                t_s: pair[1].t,
                cause: if corner { Cause::Corner } else { Cause::Fold },
                from_theta_deg: theta(&before).to_degrees(),
                to_theta_deg: theta(&after).to_degrees(),
                from_alpha_deg: f64::from(before.alpha).to_degrees(),
                to_alpha_deg: f64::from(after.alpha).to_degrees(),
            })
        })
        .collect();
    let followed = |of: fn(&Equilibrium) -> f32, below: f64| {
        spans(instants, |instant| {
            let value = f64::from(of(instant.followed.as_ref()?));
            (value < below).then_some(value)
        })
    };
    let low_fp = followed(|e| e.f_p_norm(), least_fp);
    let negative_thrust = followed(|e| e.thrust, 0.0);
    let none = spans(instants, |instant| {
        match (&instant.followed, &instant.set) {
            (Some(_), _) => None,
            (None, Ok(set)) => Some(set.as_slice().len() as f64),
            (None, Err(_)) => Some(0.0),
        }
    });
    Findings {
        admissible: [&low_fp, &negative_thrust, &none]
            .iter()
            .all(|v| v.is_empty())
            && jumps.iter().all(|jump| jump.cause == Cause::Corner),
        jumps,
        low_fp,
        negative_thrust,
        none,
    }
}

/// The spans in which `value` has something to say.
fn spans(instants: &[Instant], value: impl Fn(&Instant) -> Option<f64>) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    let mut open = false;
    for instant in instants {
        let value = value(instant);
        match (value, spans.last_mut()) {
            (Some(least), Some(span)) if open => {
                span.to_s = instant.t;
                span.least = span.least.min(least);
            }
            (Some(least), _) => spans.push(Span {
                from_s: instant.t,
                to_s: instant.t,
                least,
            }),
            _ => {}
        }
        open = value.is_some();
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::experiment::Document;

    #[test]
    fn the_papers_flight_jumps_at_the_fold_and_nowhere_else() {
        let experiment = Document::load("hover-to-cruise").unwrap().checked();
        let instants = sweep(&experiment.unwrap()).unwrap();
        let findings = findings(&instants, 80.0);
        assert!(
            !findings.admissible && findings.negative_thrust.is_empty() && findings.none.is_empty()
        );
        // Level acceleration at 2 m/s²: ε = 11.5°, |W| = 100.1 N. The fold is at α = 16.56°, a = 1.40657: 14.76 m/s at 7.38 s.
        let [jump] = &findings.jumps[..] else {
            panic!("{findings:?}")
        };
        assert_eq!(jump.cause, Cause::Fold);
        assert!((jump.t_s - 7.381).abs() < 0.01, "{jump:?}");
        assert!((jump.from_alpha_deg - 16.6).abs() < 0.5, "{jump:?}");
        assert!(jump.to_alpha_deg < 9.0, "{jump:?}");
        let [span] = &findings.low_fp[..] else {
            panic!("{findings:?}")
        };
        assert!(
            (span.to_s - jump.t_s).abs() < 0.02 && span.least < 60.0,
            "{span:?}"
        );
    }

    /// A sphere's equilibrium moves only as fast as the reference: it jumps where that has corners.
    #[test]
    fn a_sphere_jumps_at_corners_alone() {
        let experiment = Document::load("large-angle").unwrap().checked();
        let findings = findings(&sweep(&experiment.unwrap()).unwrap(), 20.0);
        assert!(findings.admissible, "{findings:?}");
        let corners = [6.0, 11.0, 13.0, 18.0];
        assert_eq!(findings.jumps.len(), corners.len());
        for (jump, corner) in findings.jumps.iter().zip(corners) {
            assert!((jump.t_s - corner).abs() < 0.01 && jump.cause == Cause::Corner);
        }
    }
}
