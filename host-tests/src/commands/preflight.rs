//! `preflight`: whether an autopilot can be flown as it is.

use std::sync::atomic::Ordering;
use std::thread;
use std::time::{Duration, Instant};

use alula_bridges::companion::{Believed, Connection, Finding, Kind, Preflight, Weight, is_go};
use anyhow::{bail, ensure};

use alula_sil::companion::{believed, settings};

use super::autopilot::{Choice, connected};
use super::settings::Settings;
use super::sitl::interrupted;

/// Ask an autopilot for its parameters and streams, and say go or no-go, with what is to be changed; exit code 1 is no-go
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment or a TOML file: the vehicle that is believed to be there
    experiment: String,
    #[command(flatten)]
    settings: Settings,
    #[command(flatten)]
    autopilot: Choice,
    /// udpin:ADDRESS:PORT, udpout:HOST:PORT, tcpout:HOST:PORT or serial:DEVICE:BAUD
    #[arg(long, value_name = "ADDRESS", default_value = "udpin:127.0.0.1:14540")]
    connect: String,
    /// The autopilot's thrust in hover, from 0 to 1 [default: by the experiment's belief and motors]
    #[arg(long, value_name = "SHARE")]
    hover_thrust: Option<f64>,
    /// PX4 is to be flown by attitudes, as `alula_guidance start attitude` does, and not by rates
    #[arg(long)]
    attitudes: bool,
}

/// Time between two steps, and after which nobody is there.
const PERIOD: Duration = Duration::from_millis(20);
const PATIENCE: Duration = Duration::from_secs(30);

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.experiment)?;
    let experiment = document.checked()?;
    let mut link = connected("--connect", &args.connect)?;
    let kind = args.autopilot.kind()?;
    let stops = interrupted()?;
    let begin = Instant::now();
    let stops = || stops.load(Ordering::Relaxed) || begin.elapsed() > PATIENCE;
    ensure!(
        kind == Kind::Px4 || !args.attitudes,
        "--attitudes: an ArduPlane in QACRO takes rates alone"
    );
    let hover_thrust = settings(&experiment, args.hover_thrust)?.hover_thrust;
    let believed = Believed {
        attitudes: args.attitudes,
        ..believed(&experiment, hover_thrust.into())?
    };
    let findings = look(believed, kind, &mut link, stops)?;
    let Some(findings) = findings else {
        bail!("no autopilot answered: no heartbeat of component 1, or a link that only sends");
    };
    say(&findings);
    match is_go(&findings) {
        true => {
            println!("go");
            Ok(())
        }
        false => bail!("no-go: change what is said above"),
    }
}

/// What is found over `link`; none if it was stopped before.
pub fn look(
    believed: Believed,
    kind: Kind,
    link: &mut Connection,
    stops: impl Fn() -> bool,
) -> anyhow::Result<Option<Vec<Finding>>> {
    let mut preflight = Preflight::new(kind, believed);
    let begin = Instant::now();
    loop {
        for (when, came) in link.received() {
            if let Some((header, message)) = came {
                preflight.receive((when - begin).as_secs_f64(), &header, &message);
            }
        }
        let now = begin.elapsed().as_secs_f64();
        for message in preflight.step(now) {
            link.send(preflight.header(), &message);
        }
        if let Some(findings) = preflight.findings(now) {
            return Ok(Some(findings));
        }
        if stops() {
            return Ok(None);
        }
        thread::sleep(PERIOD);
    }
}

/// Prints findings, and what is to be changed.
pub fn say(findings: &[Finding]) {
    for finding in findings {
        let mark = match finding.weight {
            Weight::Good => "ok     ",
            Weight::Remark => "note   ",
            Weight::NoGo => "NO-GO  ",
        };
        println!("{mark}{}", finding.what);
        if let Some(change) = &finding.change {
            println!("         change: {change}");
        }
    }
}
