//! `serve`: the plant for an autopilot that runs elsewhere.

use std::io::Write;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use alula_bridges::sitl::{self, Counts};
use anyhow::Context;

use alula_sil::ardupilot::Vehicle;

use super::fly::{Logs, report};
use super::output::Output;
use super::settings::Settings;

/// Be the physics of an autopilot that runs elsewhere
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    autopilot: Autopilot,
}

#[derive(clap::Subcommand)]
enum Autopilot {
    Ardupilot(ArduPilot),
}

/// Be the physics of ArduPilot's SITL (`--model JSON`); Ctrl-C ends, and leaves the flight as `fly` does
#[derive(clap::Args)]
struct ArduPilot {
    /// A built-in experiment or a TOML file: its vehicle, weather, sensors, reference and [ardupilot]
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    /// Where to listen; loopback alone unless told otherwise
    #[arg(long, value_name = "ADDRESS:PORT", default_value_t = SocketAddr::from(([127, 0, 0, 1], sitl::PORT)))]
    listen: SocketAddr,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    logs: Logs,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    match &args.autopilot {
        Autopilot::Ardupilot(args) => ardupilot(args),
    }
}

/// Whether Ctrl-C was pressed, or the process was asked to end.
pub fn interrupted() -> anyhow::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    let set = Arc::clone(&flag);
    ctrlc::set_handler(move || set.store(true, Ordering::Relaxed))?;
    Ok(flag)
}

fn ardupilot(args: &ArduPilot) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let experiment = document.checked()?;
    let out = args
        .output
        .folder(&format!("ardupilot/{}", document.name))?;
    let mut vehicle = Vehicle::new(&experiment)?;
    let socket = UdpSocket::bind(args.listen).with_context(|| args.listen.to_string())?;
    let interrupted = interrupted()?;
    // On standard error: standard output is the result's.
    eprintln!("listening on {}", socket.local_addr()?);
    let go_on = |_: &Counts| !interrupted.load(Ordering::Relaxed);
    let counts = sitl::serve(&socket, &mut vehicle, go_on)?;
    eprintln!(
        "{} steps; {} packets came again, {} were lost, {} late, {} malformed; {} restarts",
        counts.steps, counts.repeated, counts.lost, counts.late, counts.malformed, counts.restarts
    );
    for (speed, angle) in vehicle.landings() {
        eprintln!(
            "landed at {speed:.1} m/s, {:.0}° from upright",
            angle.to_degrees()
        );
    }
    if vehicle.record().is_empty() {
        eprintln!("no flight: the experiment's clock was not started");
        return Ok(std::io::stdout().flush()?);
    }
    eprintln!(
        "at most {:.1} m beside the plane of the record",
        vehicle.across()
    );
    report(
        &document,
        &experiment,
        vehicle.record(),
        &out,
        &args.output,
        &args.logs,
    )
}
