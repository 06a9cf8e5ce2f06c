//! Which autopilot, and the connection to it, of `companion` and of the simulated ones.

use std::io::ErrorKind;

use alula_bridges::companion::{Connection, Kind, Sticks};
use anyhow::{Context, anyhow, ensure};

/// The choice of an autopilot.
#[derive(clap::Args)]
pub struct Choice {
    /// What flies: PX4 in OFFBOARD, or ArduPlane in QACRO by overridden sticks
    #[arg(long, value_enum, default_value_t = Name::Px4)]
    autopilot: Name,
    #[command(flatten)]
    sticks: StickRates,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Name {
    Px4,
    Arduplane,
}

/// The rates of ArduPlane's sticks.
#[derive(clap::Args)]
pub struct StickRates {
    /// ArduPlane's Q_ACRO_RLL_RATE, Q_ACRO_PIT_RATE and Q_ACRO_YAW_RATE [°/s], as its parameters say
    #[arg(long, value_name = "ROLL,PITCH,YAW", value_delimiter = ',', default_values_t = [360.0, 180.0, 180.0])]
    stick_rates: Vec<f32>,
}

/// Least and greatest rate [°/s] that ArduPlane's parameters take.
const RATES: std::ops::RangeInclusive<f32> = 10.0..=500.0;

impl StickRates {
    /// The kind of autopilot that has these sticks.
    pub fn kind(&self) -> anyhow::Result<Kind> {
        let [roll, pitch, yaw] = self.stick_rates[..] else {
            anyhow::bail!("--stick-rates: three rates, as in 360,180,180");
        };
        ensure!(
            self.stick_rates.iter().all(|rate| RATES.contains(rate)),
            "--stick-rates: from 10 to 500 °/s, as ArduPlane takes them"
        );
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(f32::to_radians);
        Ok(Kind::ArduPlane(Sticks { roll, pitch, yaw }))
    }
}

/// The connection that `option` asks for at `address`.
pub fn connected(option: &str, address: &str) -> anyhow::Result<Connection> {
    Connection::open(address).with_context(|| format!("{option} {address}")).map_err(|error| {
        let io = error.downcast_ref().map(std::io::Error::kind);
        match io {
            Some(ErrorKind::AddrInUse | ErrorKind::AddrNotAvailable) => anyhow!(
                "{option} {address}: another program has it, or it is not of this machine; end that program, or choose another port"
            ),
            _ => error,
        }
    })
}

impl Choice {
    /// The kind of autopilot.
    pub fn kind(&self) -> anyhow::Result<Kind> {
        match self.autopilot {
            Name::Px4 => Ok(Kind::Px4),
            Name::Arduplane => self.sticks.kind(),
        }
    }
}
