//! `pil`: a flight by a target.

use std::path::{Path, PathBuf};

use alula_link::{Configuration, Pacing};
use alula_sim::controllers::Controller;
use alula_sim::kind::expect_no_folder;
use anyhow::Context;

use alula_sil::pil::{Build, Qemu, Target, build, open_serial};

use super::fly;

/// Fly an experiment with the core on its target: emulated, or a board on a serial device
// Groups are named after their types, and this one holds another `Args`.
#[derive(clap::Args)]
#[group(skip)]
pub struct Args {
    #[command(flatten)]
    flight: fly::Args,
    /// Image to emulate [default: build it]
    #[arg(long, value_name = "ELF", conflicts_with = "serial")]
    image: Option<PathBuf>,
    /// Serial device of a board that runs the image
    #[arg(long, value_name = "DEVICE")]
    serial: Option<String>,
    /// Have each step released by the target's timer, as in real flight, and not by its input
    #[arg(long)]
    timer: bool,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let pacing = match args.timer {
        true => Pacing::Timer,
        false => Pacing::Lockstep,
    };
    // The emulator lives as long as the flight.
    let mut emulator = None;
    let mut connect = |configuration: Configuration| {
        let mut target = match &args.serial {
            Some(device) => {
                expect_no_folder(Path::new(device))?;
                Target::new(open_serial(device)?)?
            }
            None => {
                let image = match &args.image {
                    Some(path) => path.clone(),
                    None => build(Build::Release)?,
                };
                let (qemu, port) = Qemu::start(&image)?;
                emulator = Some(qemu);
                Target::new(port)?
            }
        };
        target.configure(configuration)?;
        anyhow::Ok(Box::new(target) as Box<dyn Controller>)
    };
    let outcome = fly::with(&args.flight, "pil", |experiment| {
        connect(experiment.configuration(pacing)?)
    });
    match emulator.as_mut().and_then(Qemu::complaint) {
        Some(complaint) => outcome.with_context(|| format!("the image stopped: {complaint}")),
        None => outcome,
    }
}
