//! `companion`: the controller beside a real autopilot.

use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use alula_bridges::companion::{Companion, Connection, Stage, Wanted};
use anyhow::Context;

use alula_sil::companion::{Controlled, keep, plan, settings};
use alula_sil::simulate::Record;

use super::fly::{Logs, report};
use super::output::Output;
use super::serve::interrupted;
use super::settings::Settings;

/// Fly a PX4 over MAVLink in its OFFBOARD mode, by body rates and thrust; its pilot ends it at any time by a change of mode
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment or a TOML file: its controller and its reference
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    /// udpin:ADDRESS:PORT, udpout:HOST:PORT, tcpout:HOST:PORT or serial:DEVICE:BAUD
    #[arg(long, value_name = "ADDRESS", default_value = "udpin:127.0.0.1:14540")]
    connect: String,
    /// Fly what comes as SET_POSITION_TARGET_LOCAL_NED, and not the experiment's reference
    #[arg(long)]
    from_link: bool,
    /// Ask for OFFBOARD; else the flight begins when somebody sets it
    #[arg(long)]
    engage: bool,
    /// The autopilot's thrust in hover, from 0 to 1 [default: by the experiment's belief and motors]
    #[arg(long, value_name = "SHARE")]
    hover_thrust: Option<f64>,
    /// Heading of the plane of the flight [°] [default: the vehicle's when OFFBOARD begins]
    #[arg(long, value_name = "DEG", allow_negative_numbers = true)]
    heading: Option<f32>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    logs: Logs,
}

/// Time between two steps.
const PERIOD: Duration = Duration::from_millis(20);

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let experiment = document.checked()?;
    let out = args
        .output
        .folder(&format!("companion/{}", document.name))?;
    let mut settings = settings(&experiment, args.hover_thrust)?;
    settings.engage = args.engage;
    settings.heading = args.heading.map(f32::to_radians);
    let plan = plan(&experiment);
    let wanted = match args.from_link {
        true => Wanted::Link,
        false => Wanted::Plan(&plan),
    };
    let mut companion = Companion::new(settings, wanted);
    let mut pilot = Controlled::new(&experiment)?;
    let mut link = Connection::open(&args.connect).with_context(|| args.connect.clone())?;
    let interrupted = interrupted()?;

    let begin = Instant::now();
    let mut next = begin;
    let mut record = Record::new();
    let mut malformed = 0_u64;
    let mut said = None;
    while !interrupted.load(Ordering::Relaxed) {
        for (when, came) in link.received() {
            match came {
                Some((header, message)) => {
                    companion.receive((when - begin).as_secs_f64(), &header, &message);
                }
                None => malformed += 1,
            }
        }
        let now = begin.elapsed().as_secs_f64();
        let (messages, commanded) = companion.step(now, &mut pilot);
        for message in messages {
            link.send(Companion::HEADER, &message);
        }
        if let Some(commanded) = commanded {
            keep(&mut record, &pilot, &experiment, &commanded);
        }
        let stage = companion.stage();
        if said != Some(std::mem::discriminant(&stage)) {
            said = Some(std::mem::discriminant(&stage));
            eprintln!("{now:8.2} s  {}", words(stage));
        }
        if matches!(stage, Stage::Ended(_)) {
            break;
        }
        // Steps that were missed are not made up for.
        next = (next + PERIOD).max(Instant::now());
        thread::sleep(next - Instant::now());
    }
    let counts = companion.inbox().counts;
    eprintln!(
        "{} messages used, {} dropped, {} ignored, {malformed} malformed",
        counts.used, counts.dropped, counts.ignored
    );
    if record.is_empty() {
        eprintln!("no flight");
        return Ok(());
    }
    report(
        &document,
        &experiment,
        &record,
        &out,
        &args.output,
        &args.logs,
    )
}

fn words(stage: Stage) -> String {
    match stage {
        Stage::Waiting => "waits for an autopilot".to_owned(),
        Stage::Streaming(_) => "sends hover, and waits for OFFBOARD".to_owned(),
        Stage::Flying(_) => "flies the reference".to_owned(),
        Stage::Leaving(_) => "asks the autopilot to hold".to_owned(),
        Stage::Ended(end) => format!("has ended: {end:?}"),
    }
}
