//! `sitl`: the plant for an autopilot that runs elsewhere.

use std::io::Write;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use alula_bridges::companion::{self, Kind};
use alula_bridges::sitl::{self, Counts};
use anyhow::Context;

use alula_report::fixed;
use alula_sil::ardupilot::Vehicle;
use alula_sil::companion::{ARDUPLANE_SHIPPED, Craft, PX4_SHIPPED, px4_rate_law};
use alula_sim::named::text_of;

use super::autopilot::{StickRates, connected};
use super::fly::{Logs, report};
use super::output::Output;
use super::settings::Settings;

/// Simulate the vehicle for an autopilot that runs elsewhere
#[derive(clap::Args)]
pub struct Args {
    #[command(subcommand)]
    autopilot: Autopilot,
}

#[derive(clap::Subcommand)]
enum Autopilot {
    Ardupilot(ArduPilot),
    Px4(Simulated),
    Arduplane(ArduPlane),
}

/// Be a simulated PX4 with the vehicle of an experiment, in real time, for `companion` to be tried on; Ctrl-C ends
#[derive(clap::Args)]
struct Simulated {
    /// A built-in experiment or a TOML file: its vehicle and weather
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    /// Parameters over those as shipped: a file of QGroundControl or ArduPilot
    #[arg(long, value_name = "FILE")]
    parameters: Vec<std::path::PathBuf>,
    /// Whom to talk to
    #[arg(long, value_name = "ADDRESS", default_value = "udpout:127.0.0.1:14540")]
    connect: String,
}

/// Be a simulated ArduPlane in QACRO with the vehicle of an experiment, in real time, for `companion --autopilot arduplane` to be tried on;
/// Ctrl-C ends
#[derive(clap::Args)]
struct ArduPlane {
    #[command(flatten)]
    simulated: Simulated,
    #[command(flatten)]
    sticks: StickRates,
}

/// Simulate the vehicle for ArduPilot's SITL (`--model JSON`); Ctrl-C ends it, and leaves the flight as `fly` does
#[derive(clap::Args)]
struct ArduPilot {
    /// A built-in experiment or a TOML file: its vehicle, weather, sensors, reference and [ardupilot]
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    /// Where to listen; loopback alone unless told otherwise
    #[arg(long, value_name = "ADDRESS:PORT", default_value_t = SocketAddr::from(([127, 0, 0, 1], alula_bridges::sitl::PORT)))]
    listen: SocketAddr,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    logs: Logs,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    match &args.autopilot {
        Autopilot::Ardupilot(args) => ardupilot(args),
        Autopilot::Px4(args) => simulated(args, Kind::Px4),
        Autopilot::Arduplane(args) => simulated(&args.simulated, args.sticks.kind()?),
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
    let mut vehicle = Vehicle::new(&experiment)?;
    let socket = UdpSocket::bind(args.listen).with_context(|| {
        format!(
            "--listen {}: another program has it, or it is not of this machine; choose another port",
            args.listen
        )
    })?;
    let folder = format!("sitl-ardupilot-{}", document.name);
    let out = args.output.folder(&folder)?;
    let interrupted = interrupted()?;
    // On standard error: standard output is the result's.
    eprintln!("listening on {}", socket.local_addr()?);
    let go_on = |_: &Counts| !interrupted.load(Ordering::Relaxed);
    let counts = sitl::run(&socket, &mut vehicle, go_on)?;
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
    report(
        &document,
        &experiment,
        vehicle.record(),
        &out,
        &args.output,
        &args.logs,
    )
}

/// Time step of a simulated autopilot's vehicle.
const STEP: Duration = Duration::from_millis(2);

fn simulated(args: &Simulated, kind: Kind) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let mut experiment = document.checked()?;
    let mut parameters = companion::Parameters::default();
    for path in args.parameters.iter().rev() {
        let read = companion::Parameters::from_text(&text_of(path)?);
        let read =
            read.map_err(|line| anyhow::anyhow!("{}: {line:?} is no parameter", path.display()))?;
        parameters = parameters.or(read);
    }
    let shipped = match kind {
        Kind::Px4 => PX4_SHIPPED,
        Kind::ArduPlane(_) => ARDUPLANE_SHIPPED,
    };
    let shipped = companion::Parameters::from_text(shipped).expect("tested");
    let parameters = parameters.or(shipped);
    if let (Some(plant), Kind::Px4) = (&mut experiment.tail_sitter, kind) {
        plant.vehicle.rate_loop.law = px4_rate_law(&parameters, plant.vehicle.mixer);
    }
    let craft = Craft::new(&experiment)?;
    let mut link = connected("--connect", &args.connect)?;
    let mut autopilot = companion::Autopilot::new(craft, kind).with_parameters(parameters);
    if let Some(reason) = autopilot.refuses_to_arm() {
        anyhow::bail!("PreArm: {reason}");
    }
    let interrupted = interrupted()?;
    let begin = Instant::now();
    let mut steps = 0_u32;
    let mut mode = None;
    let mut failed = false;
    let mut malformed = 0_u64;
    while !interrupted.load(Ordering::Relaxed) {
        let now = (STEP * steps).as_secs_f64();
        for (_, came) in link.received() {
            match came {
                Some((header, message)) => autopilot.receive(now, &header, &message),
                None => malformed += 1,
            }
        }
        autopilot.advance(now, STEP.as_secs_f64());
        for message in autopilot.send(now) {
            link.send(companion::Autopilot::<Craft>::HEADER, &message);
        }
        if mode != Some(autopilot.mode()) {
            mode = Some(autopilot.mode());
            let [first, second] = kind.parameters(autopilot.mode());
            match kind {
                Kind::Px4 => eprintln!("{now:8.2} s  mode {first}/{second}"),
                Kind::ArduPlane(_) => eprintln!("{now:8.2} s  mode {first}"),
            }
        }
        if autopilot.has_failed() != failed {
            failed = true;
            eprintln!("{now:8.2} s  attitude failure: beyond FD_FAIL_P or FD_FAIL_R");
        }
        steps += 1;
        thread::sleep((begin + STEP * steps).saturating_duration_since(Instant::now()));
    }
    let [north, east, down] = companion::Body::state(autopilot.body()).position;
    let [north, east, up] = [north, east, -down].map(|x| fixed(x, 1));
    eprintln!("ended {north} m north, {east} m east, {up} m up; {malformed} messages malformed");
    Ok(())
}
