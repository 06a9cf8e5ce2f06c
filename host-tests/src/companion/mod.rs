//! The controller of an experiment beside an autopilot, and the experiment's vehicle under a simulated one.
//!
//! An experiment in a vertical plane is flown by its controller in that plane ([`plane`]); one with a path by the guidance in
//! space ([`space`]).

mod craft;
pub mod plane;
pub mod space;

use alula_bridges::companion::{Kind, Settings};

pub use craft::Craft;

/// Settings for flying a PX4 for `duration` \[s\] under a controller that believes in `weight` \[N\]. If `hover_thrust` is none, thrust is taken
/// for proportional up to `most` \[N\].
fn settings(
    weight: f64,
    most: f64,
    hover_thrust: Option<f64>,
    duration: f64,
) -> anyhow::Result<Settings> {
    let hover_thrust = hover_thrust.unwrap_or(weight / most);
    if !(0.05..=0.95).contains(&hover_thrust) {
        anyhow::bail!("the thrust in hover is {hover_thrust}, must be from 0.05 to 0.95");
    }
    Ok(Settings {
        kind: Kind::Px4,
        weight: weight as f32,
        hover_thrust: hover_thrust as f32,
        engage: false,
        led: false,
        duration,
        timeout: 0.5,
    })
}
