//! What is asked of a vehicle's flights: of its first one, which [`Verdict`](super::Verdict) judges, and of those of its campaign.
//!
//! Lengths are those of a round trip at 20 m/s and grow with the speed of cruise above that: so does the time that the reference takes, and the
//! way that an error of the same part of the speed makes.

use std::fmt::Write as _;

use super::Facts;
use alula_sim::figures::LOST;

/// Speed of the round trip that the lengths are those of [m/s].
const SPEED: f64 = 20.0;
/// Velocity [m/s] and position \[m\] within which a vehicle is back on its reference.
pub(super) const BACK: [f64; 2] = [0.5, 5.0];

/// A length that is asked for.
pub(super) struct Length {
    /// The figure of the first flight: how far to this side.
    pub first: &'static str,
    /// What it does who goes farther.
    pub text: &'static str,
    /// Asked of a calm flight by a controller that knows the vehicle \[m\].
    pub goal: f64,
    /// The figure of the campaign's flights, and whether its least value is meant.
    campaign: (&'static str, bool),
    /// Asked of flights in wind and turbulence by one that does not quite \[m\].
    pub limit: f64,
}

pub(super) const LENGTHS: [Length; 6] = [
    Length {
        first: "max_loss_out_m",
        text: "sinks below its reference on the way out",
        goal: 1.0,
        campaign: ("altitude_least_m", true),
        limit: 10.0,
    },
    Length {
        first: "max_gain_out_m",
        text: "climbs above its reference on the way out",
        goal: 1.0,
        campaign: ("altitude_most_m", false),
        limit: 10.0,
    },
    Length {
        first: "max_loss_back_m",
        text: "sinks below its reference on the way back",
        goal: 0.6,
        campaign: ("altitude_least_m", true),
        limit: 10.0,
    },
    Length {
        first: "max_gain_back_m",
        text: "climbs above its reference on the way back",
        goal: 0.6,
        campaign: ("altitude_most_m", false),
        limit: 10.0,
    },
    Length {
        first: "max_ahead_m",
        text: "runs ahead of its reference where that brakes",
        goal: 3.0,
        campaign: ("max_ahead_m", false),
        limit: 15.0,
    },
    Length {
        first: "forward_least_m",
        text: "falls behind its reference",
        goal: 10.0,
        campaign: ("forward_least_m", true),
        limit: 30.0,
    },
];

/// Shares of a campaign's flights: back on the reference, and within the lengths.
const SHARES: [f64; 2] = [0.98, 0.95];
/// Part of the speed of cruise by which it may be missed at its end: the wind drawn is as much.
const MISSED: f64 = 0.25;

/// How the lengths of a vehicle with this speed of cruise grow.
pub(super) fn scale(facts: &Facts) -> f64 {
    f64::max(1.0, facts.cruise_m_s / SPEED)
}

/// The limits of the vehicle's campaign as TOML, with the rule that they are by.
pub fn limits_text(facts: &Facts) -> String {
    let scale = scale(facts);
    let [back, within] = SHARES;
    let mut text = format!(
        "# Lost: more than {LOST} m below the reference at any time.\n[[limits]]\nfigure = \"altitude_least_m\"\nleast = -{LOST:?}\ndeparture = true\n\n\
         # Of a hundred flights {:.0} never climb {LOST} m and are back on the reference at the end, within {} m and {} m/s. {:.0} come within a quarter\n\
         # of the speed of cruise, which is the most that the wind is, and stay within the lengths below: those of a round trip at {SPEED} m/s, times\n\
         # cruise over that where it is faster (here {scale:.2}).\n",
        100.0 * back,
        BACK[1],
        BACK[0],
        100.0 * within,
    );
    let mut limit = |figure: &str, side: &str, value: f64, share: f64| {
        let _ = write!(
            text,
            "[[limits]]\nfigure = \"{figure}\"\n{side} = {:?}\nshare = {share}\n",
            value as f32
        );
    };
    limit("altitude_most_m", "most", LOST, back);
    limit("max_late_position_error_m", "most", BACK[1], back);
    limit("late_mean_velocity_error_m_s", "most", BACK[0], back);
    limit(
        "max_cruise_error_m_s",
        "most",
        MISSED * facts.cruise_m_s,
        within,
    );
    let mut written: Vec<&str> = Vec::new();
    for length in &LENGTHS {
        let (figure, least) = length.campaign;
        if written.contains(&figure) {
            continue;
        }
        written.push(figure);
        let (side, sign) = if least {
            ("least", -1.0)
        } else {
            ("most", 1.0)
        };
        limit(figure, side, sign * scale * length.limit, within);
    }
    text
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::Known;

    pub(crate) fn facts(cruise: f64) -> Facts {
        let known = Known {
            cruise_m_s: Some(cruise),
            ..Known::tail_sitter()
        };
        known.facts().unwrap()
    }

    /// Where a campaign's limits would not hold the first flight's failures, "passed" would mean nothing.
    #[test]
    fn the_campaign_has_every_limit() {
        let text = limits_text(&facts(30.0));
        let table: toml::Table = text.parse().unwrap();
        let limits = table["limits"].as_array().unwrap();
        let of = |figure: &str, side: &str| {
            let of_figure = limits
                .iter()
                .filter(|limit| limit["figure"].as_str() == Some(figure));
            let values = of_figure.filter_map(|limit| limit.get(side)?.as_float());
            values.collect::<Vec<f64>>()
        };
        assert_eq!(of("altitude_least_m", "least"), [-50.0, -15.0]);
        assert_eq!(of("altitude_most_m", "most"), [50.0, 15.0]);
        assert_eq!(of("forward_least_m", "least"), [-45.0]);
        assert_eq!(of("max_ahead_m", "most"), [22.5]);
        assert_eq!(of("max_late_position_error_m", "most"), [5.0]);
        assert_eq!(of("late_mean_velocity_error_m_s", "most"), [0.5]);
        assert_eq!(of("max_cruise_error_m_s", "most"), [7.5]);
        assert_eq!(limits.len(), 9);
    }
}
