//! The rate loop and the throttle of an autopilot, measured in hover: a small step of each rate and of the thrust to either side, and what is had of what is
//! asked.

use super::Kind;
use super::preflight::{Finding, Weight};

/// Amplitude of a nudge [rad/s], and how long each half of it lasts \[s\]: 4° there and back.
const AMPLITUDE: f32 = 0.25;
const HALF: f64 = 0.3;
/// Time of rest behind each \[s\].
const REST: f64 = 1.2;
/// Time before the first \[s\], of which the last second is taken for rest: a vehicle that leaned against a wind that nobody tells is first turned upright,
/// and drifts.
const SETTLING: f64 = 4.0;
/// The axes, in their order: belly, wing, tail, of hover.
const AXES: [&str; 3] = [
    "roll of hover, about the belly",
    "pitch",
    "yaw of hover, about the nose",
];
/// Gains of the rate loops about them.
const PX4: [&str; 3] = [
    "MC_ROLLRATE_P",
    "FW_PR_FF and FW_PR_P, or MC_PITCHRATE_P of motors",
    "FW_RR_FF and FW_RR_P, or MC_YAWRATE_P of motors",
];
const ARDUPLANE: [&str; 3] = [
    "Q_A_RAT_RLL_FF and Q_A_RAT_RLL_P",
    "Q_A_RAT_PIT_FF and Q_A_RAT_PIT_P",
    "Q_A_RAT_YAW_FF and Q_A_RAT_YAW_P",
];
/// What is to be changed of a pitch loop of PX4's elevons that gives way to the wing.
const MORE_P: &str = "FW_PR_P: more, and FW_PR_FF less";
/// That of pitch, and that about the nose.
const PITCH: usize = 1;
const NOSE: usize = 2;
/// Rates [rad/s] in rest, root mean square, from which on the loop swings.
const SWINGS: f64 = 0.35;
/// Shares of what is asked that are had, from and up to which a loop is good, and flown.
const SHARES: [[f64; 2]; 2] = [[0.7, 1.3], [0.4, 1.8]];
/// Amplitude of the thrust's nudge, as a share of the thrust.
const THRUST: f32 = 0.1;
/// Shares of a change of thrust that are had, from and up to which the thrust is proportional, and flown. A propeller's thrust goes with the square of an output
/// that nothing corrects: twice of a change is had. Of one that is corrected without need, half.
const PROPORTIONAL: [[f64; 2]; 2] = [[0.75, 1.35], [0.6, 1.6]];
/// Rate at which the wing may turn the nose against the loop, over the greatest that is commanded, up to which a loop is good, and flown. By hand, on draws of
/// `first_attempt`: of `mapping` within four, seeds 0 to 39, the five of less than half of the P that suits sank by 20 m or climbed by 6 to 39 m, at 1.9 and
/// more. The real PX4 flew at 1.3.
const YIELDS: [[f64; 2]; 2] = [[0.0, 1.0], [0.0, 1.6]];
/// Dead times and time constants that are tried: how many, and the step between them \[s\].
const DEAD_TIMES: usize = 15;
const TIME_CONSTANTS: usize = 60;
const LAG_STEP: f64 = 0.01;

/// What is believed of what turns the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turning {
    /// Whether elevons do.
    pub elevons: bool,
    /// Greatest rate that is commanded [rad/s].
    pub max_rate: f64,
    /// Greatest angular acceleration in pitch by the wing, in steady level flight at any angle of attack [rad/s²].
    pub wing: f64,
}

/// What the nudges of a flight gave.
#[derive(Clone, Debug)]
pub struct Nudge {
    kind: Kind,
    /// Lag of the rate loop that is believed \[s\].
    lag: f64,
    turning: Turning,
    samples: Vec<NudgeSample>,
}

/// The rates [rad/s] of a time.
#[derive(Clone, Copy, Debug)]
struct NudgeSample {
    /// Time \[s\].
    t: f64,
    /// Asked for besides those of the guidance.
    asked: [f32; 3],
    /// Had.
    had: [f32; 3],
    /// Thrust asked for, in any unit, and specific force along the nose, if told.
    thrust: f32,
    force: Option<f32>,
}

/// A loop about one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// What is had of what is asked.
    pub share: f64,
    /// Lag, of dead time and time constant together \[s\].
    pub lag_s: f64,
    /// Root mean square of the rate in rest [rad/s].
    pub rest_rad_s: f64,
}

/// When the nudge of this number begins \[s\].
const fn begin(number: usize) -> f64 {
    SETTLING + number as f64 * (2.0 * HALF + REST)
}

/// 1 in the first half of the nudge of this number, -1 in the second, 0 besides.
fn there_and_back(t: f64, number: usize) -> f32 {
    match t - begin(number) {
        since if (0.0..HALF).contains(&since) => 1.0,
        since if (HALF..2.0 * HALF).contains(&since) => -1.0,
        _ => 0.0,
    }
}

/// The share and the lag \[s\] with which the last column of rows of time \[s\], asked and had follows the one before: least squares, over dead times and time
/// constants, and what is had besides of nothing asked. The guidance answers a nudge while it lasts, so that what is asked has peaks: without a dead time a link
/// that is late looks like a loop that has twice of what is asked. Wind across the wing turns the vehicle, and a loop without integral is asked for a rate throughout to
/// have none: without what is had of nothing it looks like a loop that has a fifth of what is asked.
fn followed(rows: &[[f64; 3]]) -> [f64; 2] {
    let mut best = (f64::INFINITY, [0.0; 2]);
    for dead in (0..DEAD_TIMES).map(|n| n as f64 * LAG_STEP) {
        // What was asked so long before each row; before the first, as in it.
        let mut at = 0;
        let delayed: Vec<f64> = rows
            .iter()
            .map(|[t, ..]| {
                while rows[at + 1..]
                    .first()
                    .is_some_and(|next| next[0] <= t - dead)
                {
                    at += 1;
                }
                rows[at][1]
            })
            .collect();
        for lag in (0..TIME_CONSTANTS).map(|n| n as f64 * LAG_STEP) {
            let mut followed = delayed[0];
            // Sums of what follows and what is had, and of their squares and products.
            let [mut sum, mut had, mut squares, mut products, mut power] = [0.0; 5];
            for (pair, asked) in rows.windows(2).zip(&delayed) {
                let dt = pair[1][0] - pair[0][0];
                followed += (1.0 - (-dt / lag.max(1e-6)).exp()) * (asked - followed);
                sum += followed;
                had += pair[1][2];
                squares += followed * followed;
                products += followed * pair[1][2];
                power += pair[1][2] * pair[1][2];
            }
            let count = (rows.len() - 1) as f64;
            squares -= sum * sum / count;
            products -= sum * had / count;
            power -= had * had / count;
            let share = if squares > 0.0 {
                products / squares
            } else {
                0.0
            };
            let rest = power - share * products;
            if rest < best.0 {
                best = (rest, [share, dead + lag]);
            }
        }
    }
    best.1
}

impl Nudge {
    /// Of an autopilot of this `kind`, of whose rate loop this `lag` \[s\] is believed, and of a vehicle that this turns.
    #[must_use]
    pub fn new(kind: Kind, lag: f64, turning: Turning) -> Self {
        Self {
            kind,
            lag,
            turning,
            samples: Vec::new(),
        }
    }

    /// How long it takes \[s\].
    pub const DURATION: f64 = begin(AXES.len() + 1);

    /// Rates [rad/s] that are asked for at `t` \[s\] besides.
    #[must_use]
    pub fn asked(t: f64) -> [f32; 3] {
        std::array::from_fn(|axis| AMPLITUDE * there_and_back(t, axis))
    }

    /// Share of the thrust by which it is asked for at `t` \[s\] besides.
    #[must_use]
    pub fn thrust(t: f64) -> f32 {
        THRUST * there_and_back(t, AXES.len())
    }

    /// Takes what was asked in all, and had, at `t` \[s\]: rates [rad/s], and the thrust with the specific force along the nose.
    pub fn take(&mut self, t: f64, [asked, had]: [[f32; 3]; 2], thrust: f32, force: Option<f32>) {
        self.samples.push(NudgeSample {
            t,
            asked,
            had,
            thrust,
            force,
        });
    }

    /// The samples around the nudge of this number.
    fn around(&self, number: usize) -> impl Iterator<Item = &NudgeSample> {
        let begin = begin(number);
        let window = begin - 0.3..begin + 2.0 * HALF + 0.5;
        self.samples
            .iter()
            .filter(move |sample| window.contains(&sample.t))
    }

    /// What is had of a change of thrust; none if no specific force was told. Both are counted from their means: what holds the weight is no change.
    #[must_use]
    pub fn thrust_had(&self) -> Option<f64> {
        let of: Option<Vec<[f64; 3]>> = self
            .around(AXES.len())
            .map(|sample| Some([sample.t, sample.thrust.into(), sample.force?.into()]))
            .collect();
        let of = of.filter(|of| of.len() > 2)?;
        let mean = |which: usize| of.iter().map(|row| row[which]).sum::<f64>() / of.len() as f64;
        let (asked, had) = (mean(1), mean(2));
        let changes: Vec<[f64; 3]> = of
            .iter()
            .map(|[t, a, h]| [*t, a / asked - 1.0, h / had - 1.0])
            .collect();
        let [share, _] = followed(&changes);
        share.is_finite().then_some(share)
    }

    /// The loops about the three axes.
    #[must_use]
    pub fn loops(&self) -> [Loop; 3] {
        std::array::from_fn(|axis| {
            let of: Vec<[f64; 3]> = self
                .around(axis)
                .map(|sample| [sample.t, sample.asked[axis].into(), sample.had[axis].into()])
                .collect();
            let [share, lag_s] = followed(&of);
            let rests = self
                .samples
                .iter()
                .filter(|sample| (SETTLING - 1.0..SETTLING).contains(&sample.t));
            let rests: Vec<f64> = rests
                .map(|sample| f64::from(sample.had[axis]).powi(2))
                .collect();
            Loop {
                share,
                lag_s,
                rest_rad_s: (rests.iter().sum::<f64>() / rests.len().max(1) as f64).sqrt(),
            }
        })
    }

    /// What is to be said of the loops. Without elevons the propellers' torque turns the vehicle about the nose: that is slow, and flown by.
    #[must_use]
    pub fn findings(&self) -> Vec<Finding> {
        let gains = match self.kind {
            Kind::Px4 => PX4,
            Kind::ArduPlane(_) => ARDUPLANE,
        };
        let loops = self.loops();
        let yields = self.yields(loops[PITCH].lag_s);
        let holds = yields.as_ref().is_none_or(|of| of.weight < Weight::NoGo);
        let named = loops.into_iter().zip(AXES).zip(gains).enumerate();
        let findings = named.map(|(number, ((of_axis, axis), parameters))| {
            let Loop {
                share,
                lag_s,
                rest_rad_s,
            } = of_axis;
            let of_share = weigh(share, SHARES);
            let slow = lag_s > 2.0 * self.lag + 0.05;
            let (weight, change) = if rest_rad_s > SWINGS {
                // A loop that the wing turns swings for want of P.
                let way = if number == PITCH && !holds {
                    MORE_P.to_owned()
                } else {
                    format!(
                        "{parameters}: less, or a quarter less of natural_frequency_rad_s of [controller.guidance]"
                    )
                };
                (
                    Weight::NoGo,
                    Some(format!("{way}, it swings at {rest_rad_s:.1} rad/s")),
                )
            } else if share < 0.0 {
                (
                    Weight::NoGo,
                    Some("the output's sign: the axis turns the other way".to_owned()),
                )
            } else if of_share == Weight::NoGo {
                let way = if share < 1.0 { "more" } else { "less" };
                (Weight::NoGo, Some(format!("{parameters}: {way}")))
            } else if slow {
                let by_torque = number == NOSE && !self.turning.elevons;
                (
                    if by_torque {
                        Weight::Remark
                    } else {
                        Weight::NoGo
                    },
                    Some(format!(
                        "rate_lag_s {lag_s:.2} in what `new` is told, or {parameters}: more"
                    )),
                )
            } else {
                let remark = of_share == Weight::Remark;
                (of_share, remark.then(|| parameters.to_owned()))
            };
            Finding {
                weight,
                what: format!(
                    "{axis}: {:.0} % of what is asked, {:.0} ms late",
                    100.0 * share,
                    1e3 * lag_s
                ),
                change,
            }
        });
        findings
            .chain(yields)
            .chain(
                self.thrust_had()
                    .map(|share| proportional(self.kind, share)),
            )
            .collect()
    }

    /// What is to be said of how the wing turns the nose against a loop without an integral, as PX4's of elevons in the multicopter state: at its angular
    /// acceleration times the `lag` \[s\]. The guidance can ask for its greatest rate against it, and for no more.
    fn yields(&self, lag: f64) -> Option<Finding> {
        let Turning {
            elevons,
            max_rate,
            wing,
        } = self.turning;
        if self.kind != Kind::Px4 || !elevons {
            return None;
        }
        let yields = wing * lag;
        let weight = weigh(yields / max_rate, YIELDS);
        Some(Finding {
            weight,
            what: format!(
                "the stalled wing turns the nose at up to {yields:.1} rad/s against the loop, which has no integral, and the guidance asks for {max_rate:.1}"
            ),
            change: (weight > Weight::Good).then(|| MORE_P.to_owned()),
        })
    }
}

/// Good within the first band, flown within the second.
fn weigh(value: f64, bands: [[f64; 2]; 2]) -> Weight {
    match bands.map(|[least, most]| (least..=most).contains(&value)) {
        [true, _] => Weight::Good,
        [_, true] => Weight::Remark,
        _ => Weight::NoGo,
    }
}

/// What is to be said of a thrust of whose change this share is had.
fn proportional(kind: Kind, share: f64) -> Finding {
    let weight = weigh(share, PROPORTIONAL);
    let parameter = kind.thrust_model();
    let (had, way) = if share > 1.0 {
        (
            "outputs whose square is the thrust, and that nothing corrects",
            "more, at most 1",
        )
    } else {
        (
            "outputs that are thrusts already, and are corrected",
            "less, at least 0",
        )
    };
    let percent = 100.0 * share;
    let what = format!("thrust: {percent:.0} % of a change that is asked");
    match weight {
        Weight::Good => Finding {
            weight,
            what,
            change: None,
        },
        _ => Finding {
            weight,
            what: format!("{what}, as of {had}"),
            change: Some(format!("{parameter}: {way}; then the throttle of hover")),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Elevons of a vehicle whose wing is as slow as its loops.
    const TURNING: Turning = Turning {
        elevons: true,
        max_rate: 1.2,
        wing: 6.0,
    };

    /// A loop of this share and lag, in steps of 20 ms, with a swing [rad/s] of 3 Hz.
    fn measured(share: f64, lag: f64, swing: f64) -> Nudge {
        let mut nudge = Nudge::new(Kind::Px4, 0.08, TURNING);
        let mut had = [0.0_f64; 3];
        for n in 0..(Nudge::DURATION / 0.02) as u32 {
            let t = 0.02 * f64::from(n);
            let asked = Nudge::asked(t);
            let sum = had.map(|x| (x + swing * (18.8 * t).sin()) as f32);
            nudge.take(t, [asked, sum], 1.0 + Nudge::thrust(t), None);
            for (had, asked) in had.iter_mut().zip(asked) {
                *had += (1.0 - (-0.02 / lag).exp()) * (share * f64::from(asked) - *had);
            }
        }
        nudge
    }

    #[test]
    fn share_and_lag_are_measured() {
        for (share, lag) in [(1.0, 0.08), (0.6, 0.15), (-1.0, 0.1), (1.5, 0.05)] {
            for found in measured(share, lag, 0.0).loops() {
                assert!((found.share - share).abs() < 0.05, "{found:?}");
                assert!((found.lag_s - lag).abs() < 0.015, "{found:?}");
            }
        }
    }

    #[test]
    fn a_late_link_is_not_a_high_gain() {
        // The guidance answers while the nudge lasts, by the attitude that it hears of 60 ms late: what is asked has peaks, as on a real ArduPlane.
        let (lag, late) = (0.06, 3);
        let mut nudge = Nudge::new(Kind::Px4, 0.08, TURNING);
        let mut angles = vec![[0.0_f64; 3]; late + 1];
        let mut had = vec![[0.0_f64; 3]; late + 1];
        for n in 0..(Nudge::DURATION / 0.02) as u32 {
            let t = 0.02 * f64::from(n);
            let heard = angles[angles.len() - 1 - late];
            let asked: [f64; 3] =
                std::array::from_fn(|axis| f64::from(Nudge::asked(t)[axis]) - 4.0 * heard[axis]);
            let of = had[had.len() - 1 - late].map(|x| x as f32);
            nudge.take(t, [asked.map(|x| x as f32), of], 1.0, None);
            let (rate, angle) = (had[had.len() - 1], angles[angles.len() - 1]);
            had.push(std::array::from_fn(|axis| {
                rate[axis] + (1.0 - (-0.02_f64 / lag).exp()) * (asked[axis] - rate[axis])
            }));
            angles.push(std::array::from_fn(|axis| angle[axis] + 0.02 * rate[axis]));
        }
        for found in nudge.loops() {
            assert!((found.share - 1.0).abs() < 0.05, "{found:?}");
            // What is heard is late by the link, too.
            assert!((found.lag_s - lag - 0.06).abs() < 0.02, "{found:?}");
        }
    }

    #[test]
    fn wind_across_the_wing_is_not_a_low_gain() {
        // On the real PX4 in 2.1 m/s of wind a pitch rate of -0.65 rad/s had to be asked for throughout, so that none was had.
        let mut nudge = measured(1.0, 0.08, 0.0);
        for sample in &mut nudge.samples {
            sample.asked[1] -= 0.65;
        }
        for found in nudge.loops() {
            assert!((found.share - 1.0).abs() < 0.05, "{found:?}");
            assert!((found.lag_s - 0.08).abs() < 0.015, "{found:?}");
        }
        let findings = nudge.findings();
        assert!(
            findings.iter().all(|found| found.weight == Weight::Good),
            "{findings:?}"
        );
    }

    #[test]
    fn what_is_to_be_changed_is_a_parameter_of_the_autopilot() {
        let changes = |kind| {
            let mut nudge = measured(0.3, 0.08, 0.0);
            nudge.kind = kind;
            let changes = nudge
                .findings()
                .into_iter()
                .filter_map(|found| found.change);
            changes.collect::<Vec<_>>().join("; ")
        };
        let plane = changes(Kind::ArduPlane(crate::companion::Sticks::default()));
        assert!(
            plane.contains("Q_A_RAT_PIT_P") && !plane.contains("FW_PR_P"),
            "{plane}"
        );
        let px4 = changes(Kind::Px4);
        assert!(px4.contains("FW_PR_P") && !px4.contains("Q_A_RAT"), "{px4}");
    }

    /// A loop of PX4's elevons that follows what is asked, by its feed-forward, and does not hold against the wing: 80 ms times 30 rad/s² are twice what is
    /// asked at most.
    #[test]
    fn a_loop_that_yields_to_the_wing_is_no_go() {
        let weight = |kind, elevons, wing| {
            let mut nudge = measured(1.0, 0.08, 0.0);
            (nudge.kind, nudge.turning) = (
                kind,
                Turning {
                    elevons,
                    wing,
                    ..TURNING
                },
            );
            nudge.findings().iter().map(|f| f.weight).max().unwrap()
        };
        let plane = Kind::ArduPlane(crate::companion::Sticks::default());
        assert_eq!(weight(Kind::Px4, true, 30.0), Weight::NoGo);
        assert_eq!(weight(Kind::Px4, true, 17.0), Weight::Remark);
        assert_eq!(weight(Kind::Px4, true, 12.0), Weight::Good);
        // Motors of PX4's multicopter state and ArduPlane's loops have an integral.
        assert_eq!(weight(Kind::Px4, false, 30.0), Weight::Good);
        assert_eq!(weight(plane, true, 30.0), Weight::Good);
    }

    /// A thrust that goes with this power of what is asked, with the lag \[s\] of motors, on noise that is no thrust's.
    fn thrust_by(power: f64, lag: f64) -> Nudge {
        let mut nudge = Nudge::new(Kind::Px4, 0.08, TURNING);
        let mut had = 1.0_f64;
        for n in 0..(Nudge::DURATION / 0.02) as u32 {
            let t = 0.02 * f64::from(n);
            let asked = 0.49 * (1.0 + Nudge::thrust(t));
            let force = 9.81 * (had + 0.01 * (40.0 * t).sin());
            nudge.take(t, [[0.0; 3]; 2], asked, Some(force as f32));
            let wanted = f64::from(1.0 + Nudge::thrust(t)).powf(power);
            had += (1.0 - (-0.02 / lag).exp()) * (wanted - had);
        }
        nudge
    }

    #[test]
    fn a_thrust_that_is_not_proportional_is_found() {
        for (power, weight) in [
            (1.0, Weight::Good),
            (2.0, Weight::NoGo),
            (0.5, Weight::NoGo),
        ] {
            for lag in [0.03, 0.1] {
                let nudge = thrust_by(power, lag);
                let share = nudge.thrust_had().unwrap();
                assert!((share / power - 1.0).abs() < 0.1, "{power}: {share}");
                let findings = nudge.findings();
                let thrust = findings.last().unwrap();
                assert_eq!(thrust.weight, weight, "{findings:?}");
                // Which way is wrong is what was measured: the square asks for more of a correction, the root for less.
                let way = thrust.change.as_ref().map(|change| {
                    ["more", "less"].map(|way| change.contains(&format!("{way}, at")))
                });
                let wanted = match power {
                    2.0 => Some([true, false]),
                    0.5 => Some([false, true]),
                    _ => None,
                };
                assert_eq!(way, wanted, "{findings:?}");
            }
        }
        // Without specific forces nothing is said of it.
        assert_eq!(measured(1.0, 0.08, 0.0).findings().len(), 4);
    }

    #[test]
    fn what_cannot_be_flown_is_no_go() {
        let weights = |nudge: &Nudge| {
            let findings = nudge.findings();
            findings.iter().map(|f| f.weight).max().unwrap()
        };
        assert_eq!(weights(&measured(1.0, 0.08, 0.0)), Weight::Good);
        for bad in [
            (-1.0, 0.08, 0.0),
            (0.3, 0.08, 0.0),
            (1.0, 0.35, 0.0),
            (1.0, 0.08, 0.8),
        ] {
            assert_eq!(
                weights(&measured(bad.0, bad.1, bad.2)),
                Weight::NoGo,
                "{bad:?}"
            );
        }
        // Propellers' torque is slow about the nose; about the other axes a slow loop is none to fly by.
        let mut slow = measured(1.0, 0.35, 0.0);
        slow.turning.elevons = false;
        let weights: Vec<Weight> = slow.findings().iter().map(|f| f.weight).collect();
        assert_eq!(weights, [Weight::NoGo, Weight::NoGo, Weight::Remark]);
        // There and back.
        let turned: f64 = (0..1000)
            .map(|n| f64::from(Nudge::asked(f64::from(n) * 0.01)[1]) * 0.01)
            .sum();
        assert!(turned.abs() < 1e-6);
    }
}
