//! `companion`: the guidance beside a real autopilot.

use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use alula_bridges::companion::{self, Companion, End, Kind, Nudge, Pilot as _, Stage, is_go};
use anyhow::{bail, ensure};

use alula_sil::companion::{Ground, Lead, OnPath, believed, settings};
use alula_sim::experiment::{Experiment, RateLoop};

use super::autopilot::{Choice, connected};
use super::fly::{Logs, report};
use super::output::Output;
use super::preflight::{look, say};
use super::settings::Settings;
use super::sitl::interrupted;

/// Fly a PX4 over MAVLink in its OFFBOARD mode, or an ArduPlane in QACRO, by body rates and thrust; its pilot ends it at any time by a change of mode
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment or a TOML file: its guidance and its path
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    autopilot: Choice,
    /// udpin:ADDRESS:PORT, udpout:HOST:PORT, tcpout:HOST:PORT or serial:DEVICE:BAUD
    #[arg(long, value_name = "ADDRESS", default_value = "udpin:127.0.0.1:14540")]
    connect: String,
    /// Be a vehicle to a ground station there, which uploads and changes the mission: udpout:127.0.0.1:14550 is QGroundControl on this machine
    #[arg(long, value_name = "ADDRESS", conflicts_with = "from_link")]
    ground: Option<String>,
    /// Fly what comes as SET_POSITION_TARGET_LOCAL_NED, and not the experiment's reference
    #[arg(long)]
    from_link: bool,
    /// Ask for OFFBOARD, or QACRO; else the flight begins when somebody sets it
    #[arg(long)]
    engage: bool,
    /// The autopilot's thrust in hover, from 0 to 1 [default: by the experiment's belief and motors]
    #[arg(long, value_name = "SHARE")]
    hover_thrust: Option<f64>,
    /// Heading of the path's north [°] [default: north; in a vertical plane the vehicle's when the flight begins]
    #[arg(
        long,
        value_name = "DEG",
        allow_negative_numbers = true,
        conflicts_with = "from_link"
    )]
    heading: Option<f32>,
    /// Fly whatever the preflight finds
    #[arg(long)]
    despite: bool,
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
        .folder(&format!("companion-{}", document.name))?;
    let heading = args.heading.map(f32::to_radians);
    let lead = match args.from_link {
        true => Lead::Link,
        false if experiment.in_plane() => Lead::Path(heading),
        false => Lead::Path(heading.or(Some(0.0))),
    };
    let lag = match experiment.plant.rate_loop {
        RateLoop::Lag { time_constant_s } => time_constant_s,
        _ => 0.1,
    };
    let mut pilot = OnPath::new(&experiment, lead)?;
    let mut settings = settings(&experiment, args.hover_thrust)?;
    if lead != Lead::Link {
        pilot = pilot.nudged(args.autopilot.kind()?, lag, args.despite);
        settings.duration += match pilot.is_nudging() {
            true => Nudge::DURATION,
            false => 0.0,
        };
    }
    let end = fly(args, &experiment, settings, &mut pilot)?;
    say(pilot.findings());
    ensure!(
        !pilot.is_over(),
        "the rate loop cannot be flown: the autopilot was asked to hold. Change what is said above, or fly --despite it"
    );
    if pilot.record().is_empty() {
        eprintln!("no flight");
        return verdict(end);
    }
    report(
        &document,
        &experiment,
        pilot.record(),
        &out,
        &args.output,
        &args.logs,
    )?;
    verdict(end)
}

/// Success where the flight ended as somebody wanted it; else an error that says how it did. The page is there either way.
fn verdict(end: End) -> anyhow::Result<()> {
    match end {
        End::Finished | End::TakenOver | End::Disarmed | End::Stopped => Ok(()),
        End::LinkLost => bail!("the link was lost in flight: what came last was too old to fly by"),
        End::Attitude => bail!("the attitude was none to fly by: the flight was given up"),
        End::Pilot => bail!("the guidance did not answer: the flight was given up"),
    }
}

/// Lets `pilot` fly over the link until the flight ends or Ctrl-C is pressed, and says how it ended.
fn fly(
    args: &Args,
    experiment: &Experiment,
    mut settings: companion::Settings,
    pilot: &mut OnPath,
) -> anyhow::Result<End> {
    settings.engage = args.engage;
    settings.led = args.from_link;
    settings.kind = args.autopilot.kind()?;
    let mut companion = Companion::new(settings);
    let mut link = connected("--connect", &args.connect)?;
    let station = args.ground.as_deref().map(|address| {
        let link = connected("--ground", address)?;
        anyhow::Ok((Ground::new(), link))
    });
    let mut station = station.transpose()?;
    let interrupted = interrupted()?;
    let stops = || interrupted.load(Ordering::Relaxed);
    eprintln!("waits for an autopilot, and looks at its parameters and streams");
    let believed = believed(experiment, settings.hover_thrust.into())?;
    let findings = look(believed, settings.kind, &mut link, stops)?;
    let Some(findings) = findings else {
        return Ok(End::Stopped);
    };
    say(&findings);
    ensure!(
        args.despite || is_go(&findings),
        "no-go: change what is said above, or fly --despite it"
    );

    let begin = Instant::now();
    let mut next = begin;
    let mut malformed = 0_u64;
    let mut said = None;
    while !companion.is_done() {
        if interrupted.load(Ordering::Relaxed) {
            companion.stop();
        }
        for (when, came) in link.received() {
            match came {
                Some((header, message)) => {
                    companion.receive((when - begin).as_secs_f64(), &header, &message);
                }
                None => malformed += 1,
            }
        }
        let now = begin.elapsed().as_secs_f64();
        for message in companion.step(now, pilot).0 {
            link.send(companion.header(), &message);
        }
        if let Some((ground, link)) = &mut station {
            for (when, came) in link.received() {
                if let Some((header, message)) = came {
                    let when = (when - begin).as_secs_f64();
                    ground.receive(when, &header, &message, &companion, pilot);
                }
            }
            for message in ground.step(now, &companion, pilot) {
                link.send(Ground::HEADER, &message);
            }
        }
        let words = words(&companion, settings.kind, pilot.is_nudging());
        if said.as_ref() != Some(&words) {
            eprintln!("{now:8.2} s  {words}");
            said = Some(words);
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
    match companion.stage() {
        Stage::Ended(end) => Ok(end),
        _ => Ok(End::Stopped),
    }
}

fn words(companion: &Companion, kind: Kind, nudging: bool) -> String {
    match (companion.stage(), kind) {
        (Stage::Waiting, _) => "waits for an autopilot".to_owned(),
        (Stage::Streaming(_), _) if !companion.is_ready() => {
            "waits for the autopilot to say that it is armed, and in the air (EXTENDED_SYS_STATE)"
                .to_owned()
        }
        (Stage::Streaming(_), Kind::Px4) => "sends hover, and waits for OFFBOARD".to_owned(),
        (Stage::Streaming(_), Kind::ArduPlane(_)) => "waits for QACRO".to_owned(),
        (Stage::Flying(_), _) if nudging => {
            "measures the rate loop: small steps in hover".to_owned()
        }
        (Stage::Flying(_), _) => "flies the reference".to_owned(),
        (Stage::Leaving(_), _) => "asks the autopilot to hold".to_owned(),
        (Stage::Ended(end), _) => format!("has ended: {end:?}"),
    }
}
