//! `margins`: how much lag and delay the loop bears.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;

use alula_sil::files::leave;
use alula_sil::margins::{LONGEST, Loop, Point};
use alula_sil::mission::{GainChoiceSpec, MissionSource};
use alula_sil::report::margins_svg;
use alula_sil::scenario::GainsSpec;

/// Eigenvalues and the largest stable lag and delay in level flight, for the paper's gains and the mission's
#[derive(clap::Args)]
pub struct Args {
    /// A built-in mission or a TOML file: its vehicle and its gains
    #[arg(default_value = "round-trip")]
    vehicle: String,
    /// Speeds [m/s]
    #[arg(long, value_delimiter = ',', value_name = "V,V,…")]
    speeds: Vec<f64>,
    /// Take the mission's belief about the vehicle, not the vehicle itself, for the controller's
    #[arg(long)]
    belief: bool,
    /// Folder for the plot [default: out/margins/<vehicle>]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Summary<'a> {
    vehicle: &'a str,
    out: &'a Path,
    /// Lags and delays beyond this \[s\] are not looked for, and given as null.
    longest_s: f64,
    loops: &'a [Margins],
}

#[derive(Serialize)]
struct Margins {
    gains: &'static str,
    points: Vec<Point>,
}

const PAPER: GainChoiceSpec = GainChoiceSpec::Constant(GainsSpec {
    k1: 0.1529,
    k2: 0.0234,
    k3: 6.0,
    tau_n: 80.0,
});

pub fn run(args: &Args) -> anyhow::Result<()> {
    let source = MissionSource::load(&args.vehicle)?;
    let mission = &source.mission;
    let vehicle = mission.vehicle.plant_vehicle();
    let Some(guidance) = mission.controller.guidance() else {
        anyhow::bail!("{}: its controller has no gains", args.vehicle);
    };
    let believed = guidance.vehicle.as_ref().filter(|_| args.belief);
    let belief = believed.map_or(vehicle, |spec| spec.plant_vehicle());
    let speeds = match args.speeds.is_empty() {
        true => (0..=25).map(f64::from).collect(),
        false => args.speeds.clone(),
    };
    if let Some(bad) = speeds.iter().find(|v| !(0.0..=1000.0).contains(*v)) {
        anyhow::bail!("--speeds: {bad} is not from 0 to 1000 m/s");
    }
    let out = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out/margins").join(&source.name),
    };
    std::fs::create_dir_all(&out).with_context(|| out.display().to_string())?;

    let loops = [("paper", PAPER), ("mission", guidance.gains)].map(|(name, gains)| {
        let of = Loop {
            vehicle,
            belief,
            gains,
        };
        Margins {
            gains: name,
            points: speeds.iter().flat_map(|&speed| of.at(speed)).collect(),
        }
    });

    let curves: Vec<_> = loops.iter().map(|l| (l.gains, &l.points[..])).collect();
    let svg = margins_svg(&curves)?;
    leave(&out.join("margins.svg"), |file| {
        Ok(file.write_all(svg.as_bytes())?)
    })?;
    let mut stdout = std::io::stdout().lock();
    if args.json {
        let summary = Summary {
            vehicle: &source.name,
            out: &out,
            longest_s: LONGEST,
            loops: &loops,
        };
        writeln!(stdout, "{}", serde_json::to_string_pretty(&summary)?)?;
        return Ok(());
    }
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
            let eigenvalues = p.eigenvalues.map(|(re, im)| match im {
                0.0 => format!("{re:.2}"),
                _ => format!("{re:.2}{im:+.2}i"),
            });
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
