//! `margins`: how much lag and delay the loop bears.

use std::path::Path;

use serde::Serialize;

use alula_report::{Page, Table, fixed, margins_figure};
use alula_sim::airframe::{Airframe, LoopMargins};
use alula_sim::experiment::{PlantSpec, RateLoop};
use alula_sim::margins::{LONGEST, Point};

use super::output::{Output, leave_view};
use super::settings::{Settings, expect_airframe};

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
    /// Let the controller know the vehicle as it believes it to be, not as it is
    #[arg(long)]
    belief: bool,
    /// The loop alone, without the experiment's lags and delay
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
    let out = args.output.folder(&format!("margins-{}", airframe.name))?;

    let included = included(&airframe.plant);
    let curves: Vec<_> = loops
        .iter()
        .map(|l| (title(l.gains), &l.points[..]))
        .collect();
    let mut page = Page {
        title: format!("Margins of {}", airframe.name),
        lead: format!("Level flight, small errors. {included}"),
        figure: margins_figure(&curves),
        tables: loops.iter().map(table).collect(),
        notes: "Each point is an equilibrium: a speed may have several, of other angles of attack."
            .to_owned(),
        ..Page::default()
    };
    let title = page.title.clone();
    leave_view(
        &mut page,
        &out,
        &title,
        args.settings.flight(&args.vehicle).as_slice(),
    )?;
    let summary = Summary {
        vehicle: &airframe.name,
        out: &out,
        longest_s: LONGEST,
        included: &included,
        loops: &loops,
    };
    args.output.leave(&out, &page, &summary)
}

/// What a choice of gains is called.
fn title(gains: &str) -> &'static str {
    match gains {
        "paper" => "the paper's gains",
        _ => "the experiment's gains",
    }
}

/// The margins with one choice of gains.
fn table(of: &LoopMargins) -> Table {
    let limit = |t: Option<f64>| t.map_or(format!("> {LONGEST}"), |t| fixed(t, 4));
    let eigenvalue = |&(re, im): &(f64, f64)| match im {
        0.0 => fixed(re, 2),
        _ => format!("{re:.2}{im:+.2}i"),
    };
    Table::of(
        format!("With {}", title(of.gains)),
        &of.points,
        &[
            ("v [m/s]", &|p: &Point| fixed(p.speed_m_s, 1)),
            ("θ [°]", &|p| fixed(p.theta_deg, 2)),
            ("α [°]", &|p| {
                p.alpha_deg.map_or("–".to_owned(), |a| fixed(a, 2))
            }),
            ("apparent force [N]", &|p| fixed(p.fp_n, 1)),
            ("lag [s]", &|p| limit(p.lag_s)),
            ("delay [s]", &|p| limit(p.delay_s)),
            ("eigenvalues [rad/s]", &|p| {
                let all: Vec<String> = p.eigenvalues.iter().map(eigenvalue).collect();
                all.join(", ")
            }),
        ],
    )
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
            true => {
                expect_airframe(argument)?;
                Airframe::load(argument)
            }
            false => Airframe::of(&self.document(argument)?),
        }
    }
}
