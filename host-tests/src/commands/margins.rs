//! `margins`: how much lag and delay the loop bears.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use alula_report::margins_figure;
use alula_sim::airframe::{Airframe, LoopMargins};
use alula_sim::experiment::{PlantSpec, RateLoop};
use alula_sim::margins::LONGEST;
use alula_study::files::leave_all;

use super::output::Output;
use super::settings::Settings;

/// Eigenvalues and the largest stable lag and delay in level flight, for the paper's gains and the experiment's
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment, vehicle or polar, or a file: of an experiment or vehicle (TOML), or a polar as `fit` reads it
    #[arg(default_value = "round-trip")]
    vehicle: String,
    #[command(flatten)]
    settings: Settings,
    /// Speeds [m/s]
    #[arg(long, value_delimiter = ',', value_name = "V,V,…")]
    speeds: Vec<f64>,
    /// Take the controller's belief about the vehicle, not the vehicle itself, for the controller's
    #[arg(long)]
    belief: bool,
    /// Leave the experiment's own lags and delay out: the bare loop
    #[arg(long)]
    bare: bool,
    #[command(flatten)]
    output: Output,
}

#[derive(Serialize)]
struct Summary<'a> {
    vehicle: &'a str,
    out: &'a Path,
    /// Lags and delays beyond this \[s\] are not looked for, and given as null.
    longest_s: f64,
    /// What is counted of the experiment's actuators.
    included: &'a str,
    loops: &'a [LoopMargins],
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let mut airframe = args.settings.airframe(&args.vehicle)?;
    if args.bare {
        airframe.plant = PlantSpec::default();
    }
    let loops = airframe.margins(&args.speeds, args.belief)?;
    let out = args.output.folder(&format!("margins/{}", airframe.name))?;

    let curves: Vec<_> = loops.iter().map(|l| (l.gains, &l.points[..])).collect();
    let svg = margins_figure(&curves).svg();
    leave_all(&out.join("margins.svg"), svg)?;
    let included = included(&airframe.plant);
    let mut stdout = std::io::stdout().lock();
    if args.output.json() {
        let summary = Summary {
            vehicle: &airframe.name,
            out: &out,
            longest_s: LONGEST,
            included: &included,
            loops: &loops,
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
        return Ok(());
    }
    writeln!(stdout, "{included}")?;
    for l in &loops {
        writeln!(stdout, "gains: {}", l.gains)?;
        let head = [
            "v [m/s]",
            "θ [°]",
            "α [°]",
            "|F_p| [N]",
            "lag [s]",
            "delay [s]",
        ];
        let head = head.map(|h| format!("{h:>9}")).join(" ");
        writeln!(stdout, "{head}  eigenvalues [rad/s]")?;
        for p in &l.points {
            let limit = |t: Option<f64>| t.map_or(format!("> {LONGEST}"), |t| format!("{t:.4}"));
            let eigenvalue = |&(re, im): &(f64, f64)| match im {
                0.0 => format!("{re:.2}"),
                _ => format!("{re:.2}{im:+.2}i"),
            };
            let eigenvalues: Vec<String> = p.eigenvalues.iter().map(eigenvalue).collect();
            writeln!(
                stdout,
                "{:9.1} {:9.2} {:9.2} {:9.1} {:>9} {:>9}  {}",
                p.speed_m_s,
                p.theta_deg,
                p.alpha_deg,
                p.fp_n,
                limit(p.lag_s),
                limit(p.delay_s),
                eigenvalues.join(", ")
            )?;
        }
    }
    writeln!(stdout, "margins.svg is in {}", out.display())?;
    Ok(())
}

/// What is counted of the actuators, in one sentence.
fn included(actuators: &PlantSpec) -> String {
    let rate = match actuators.rate_loop {
        RateLoop::Ideal => "no lag of the rate loop".to_owned(),
        RateLoop::Lag { time_constant_s } => format!("a rate loop of {time_constant_s} s"),
        RateLoop::Inertia { bandwidth_1_s, .. } => format!("a rate loop of {bandwidth_1_s} 1/s"),
    };
    format!(
        "Included: {rate}, a thrust lag of {} s, a delay of {} s. The largest lag is that of the rate loop in place of its own, the largest \
         delay that of the command in place of its own.",
        actuators.thrust_lag_s, actuators.delay_s
    )
}

impl Settings {
    /// The vehicle that `argument` names, with the fields of its document changed.
    fn airframe(&self, argument: &str) -> anyhow::Result<Airframe> {
        match self.is_empty() {
            true => Airframe::load(argument),
            false => Airframe::of(&self.document(argument)?),
        }
    }
}
