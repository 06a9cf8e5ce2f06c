//! `identify`: a vehicle learned from the log of a flight.

use std::path::PathBuf;

use anyhow::{Context as _, ensure};

use alula_design::Actuators;
use alula_design::identify::{Besides, Given, POLAR, identify};
use alula_logs::states;
use alula_report::identify::page;
use alula_sim::kind::Kind;
use alula_sim::named::in_shell;
use alula_study::files::leave_all;

use super::output::Output;

/// Learn a vehicle from the log of a flight: thrust, lags, what turns it, its wing, each with an interval, and a file for `new`
#[derive(clap::Args)]
pub struct Args {
    /// A PX4 ULog, an ArduPilot DataFlash log or an MCAP: of any autopilot, or by hand
    log: PathBuf,
    /// Mass in that flight (kg)
    #[arg(long, value_name = "X")]
    mass_kg: f64,
    /// Area of the wing (m²)
    #[arg(long, value_name = "X")]
    wing_m2: f64,
    /// Density of the air (kg/m³)
    #[arg(long, value_name = "X", default_value_t = 1.225)]
    air_kg_m3: f64,
    /// What turns it in pitch
    #[arg(long, value_enum, default_value_t = Actuators::Elevons)]
    actuators: Actuators,
    /// Speed of cruise (m/s) [default: that of the flight, on its wing]
    #[arg(long, value_name = "X")]
    cruise_m_s: Option<f64>,
    /// Aspect ratio of the wing: its span squared over its area [default: assumed to be 4]
    #[arg(long, value_name = "X")]
    aspect_ratio: Option<f64>,
    /// Section of a wing that the flight does not show
    #[arg(long, value_name = "NAME|FILE", default_value = "naca-0012")]
    section: String,
    #[command(flatten)]
    output: Output,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let numbers = [
        ("mass-kg", Some(args.mass_kg), [0.01, 1e4]),
        ("wing-m2", Some(args.wing_m2), [1e-4, 1e3]),
        ("air-kg-m3", Some(args.air_kg_m3), [0.1, 10.0]),
        ("aspect-ratio", args.aspect_ratio, [0.5, 50.0]),
    ];
    for (name, value, [least, most]) in numbers {
        let Some(value) = value else { continue };
        ensure!(
            (least..=most).contains(&value),
            "--{name}: {value} is not from {least} to {most}"
        );
    }
    let place = args.log.display().to_string();
    Kind::Log.expect_file(&args.log)?;
    let log = alula_logs::read(&args.log)?;
    let states = states::find(&log).with_context(|| place.clone())?;
    let given = Given {
        mass_kg: args.mass_kg,
        wing_m2: args.wing_m2,
        air_kg_m3: args.air_kg_m3,
    };
    let vehicle = identify(&log, &states, &given).with_context(|| place)?;
    let besides = Besides {
        actuators: args.actuators,
        cruise_m_s: args.cruise_m_s,
        aspect_ratio: args.aspect_ratio,
        section: args.section.clone(),
    };
    let name = args.log.file_stem().unwrap_or_default();
    let name = name.to_string_lossy();
    let out = args.output.folder(&format!("identify-{name}"))?;
    let known = vehicle.known(&given, &besides, vehicle.flown_m_s.unwrap_or(15.0));
    let file = out.join("known.toml");
    leave_all(&file, &known)?;
    if let Some(wing) = vehicle.polar(&besides) {
        leave_all(&out.join(POLAR), wing.csv)?;
    }
    let mut notes = states.notes;
    notes.push(format!(
        "alula-sil view {} shows the flight in three dimensions",
        in_shell(&args.log.to_string_lossy())
    ));
    let page = page(&name, &vehicle, &known, &notes);
    args.output.leave(&out, &page, &vehicle)?;
    if !args.output.json() {
        println!(
            "known.toml is in {}. Next:\n  alula-sil new my-vehicle --from {}",
            out.display(),
            in_shell(&file.to_string_lossy())
        );
    }
    Ok(())
}
