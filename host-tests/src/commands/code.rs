//! `code`: a vehicle's file as C and as Rust.

use std::path::PathBuf;

use alula_design::{Coded, c_code, rust_code};
use alula_sim::controllers::GuidanceSpec;
use alula_study::files::{leave_all, make_folder};

use super::settings::Settings;

/// Write a vehicle's file as C and as Rust: vehicle.h and vehicle.rs, with every number that the file comes to
#[derive(clap::Args)]
pub struct Args {
    /// A TOML file, as `new` or `identify` leaves it, or a built-in experiment
    vehicle: String,
    #[command(flatten)]
    settings: Settings,
    /// Folder for the files [default: that of the file]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let document = args.settings.document(&args.vehicle)?;
    let experiment = document.checked()?;
    let spec = GuidanceSpec::of(&experiment).map_err(|e| document.located(e))?;
    let vehicle = spec.vehicle.as_ref().unwrap_or(&experiment.vehicle);
    let thrust = experiment.thrust_limits(spec.thrust_n, vehicle.weight());
    let parameters = spec
        .ruled(&vehicle.parameters(thrust), &spec.parameters)
        .map_err(|e| document.located(e))?;
    let coded = Coded {
        vehicle,
        thrust,
        parameters: &parameters,
    };
    let beside = PathBuf::from(&args.vehicle);
    let beside = beside.parent().filter(|_| beside.is_file());
    let out = args.out.as_deref().or(beside).unwrap_or(".".as_ref());
    make_folder(out)?;
    for (file, text) in [
        ("vehicle.h", c_code(&document.name, &coded)),
        ("vehicle.rs", rust_code(&document.name, &coded)),
    ] {
        leave_all(&out.join(file), text)?;
        println!("{}", out.join(file).display());
    }
    Ok(())
}
