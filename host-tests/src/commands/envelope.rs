//! `envelope`: folds, equilibrium counts, jumps and cusps of a vehicle.

use anyhow::{Context, anyhow, ensure};

use alula_design::Limits;
use alula_design::envelope::{CuspSummary, Envelope, Ray, Refused, Summary};
use alula_report::envelope::{Shown, figure};
use alula_report::{Page, Table, fixed};
use alula_sim::airframe::Airframe;
use alula_sim::controllers::GuidanceSpec;

use super::output::{Output, leave_view};
use super::settings::{Settings, expect_airframe};

/// Where a vehicle's equilibria fold and jump, in level flight, in a climb or in an acceleration
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment, vehicle or polar, or a file: of an experiment or vehicle (TOML), or a polar as `fit` reads it
    #[arg(default_value = "paper")]
    vehicle: String,
    /// Steady climb angle [°], from -90 to 90
    #[arg(
        long,
        value_name = "X",
        allow_negative_numbers = true,
        conflicts_with = "accel"
    )]
    climb_deg: Option<f64>,
    /// Level acceleration [m/s²]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    accel: Option<f64>,
    /// Speed of cruise (m/s): say, too, how it brakes from there, in which wind it hovers and how fast it descends
    #[arg(long, value_name = "X")]
    cruise_m_s: Option<f64>,
    #[command(flatten)]
    output: Output,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    expect_airframe(&args.vehicle)?;
    let airframe = Airframe::load(&args.vehicle)?;
    let vehicle = airframe.reference();
    let option = |e: Refused| anyhow!("--{}: {}", e.field.replace('_', "-"), e.problem);
    let ray = Ray::new(&vehicle, args.climb_deg, args.accel).map_err(option)?;
    let name = format!("envelope-{}", airframe.name);
    let out = args.output.folder(&name)?;
    let envelope = Envelope::new(&vehicle, ray).with_context(|| airframe.name.clone())?;
    let shown = Shown {
        vehicle: &vehicle,
        curve: &envelope.curve,
        epsilon: ray.epsilon,
        folds: &envelope.folds,
        fold_curve: &envelope.fold_curve.pieces(),
        cusps: &envelope.cusps,
    };
    let summary = envelope.summary(&airframe.name);
    let mut page = Page {
        title: format!("Envelope of {}", airframe.name),
        lead: format!(
            "{}; {}",
            airframe.description.trim_end_matches('.'),
            flight(args, &ray)
        ),
        figure: figure(&shown),
        tables: tables(&summary, &ray)
            .into_iter()
            .chain(limits(&airframe, args.cruise_m_s)?)
            .collect(),
        notes: "Equilibria from hover to infinite airspeed; see docs/envelope.md. a is k_a V²/(m g): what the air presses on the wing by, over the weight; hover has 0. A cusp is a climb angle ε at which two folds meet: beyond it both are gone.".to_owned(),
        ..Page::default()
    };
    let title = page.title.clone();
    let flight = Settings::default().flight(&args.vehicle);
    leave_view(&mut page, &out, &title, flight.as_slice())?;
    args.output.leave(&out, &page, &summary)
}

/// What turning leaves, at the speed of `cruise` [m/s].
fn limits(airframe: &Airframe, cruise: Option<f64>) -> anyhow::Result<Option<Table>> {
    let Some(cruise) = cruise else {
        return Ok(None);
    };
    ensure!(
        (1.0..=340.0).contains(&cruise),
        "--cruise-m-s: {cruise} is not from 1 to 340"
    );
    let thrust = airframe.thrust_limits();
    let vehicle = airframe.spec.parameters(thrust);
    let guidance = GuidanceSpec::read(airframe.controller.table.clone()).ok();
    let parameters = guidance.and_then(|spec| spec.ruled(&vehicle, &spec.parameters).ok());
    let sink = parameters.unwrap_or_default().max_sink.into();
    let limits = Limits::of(&airframe.spec, thrust, cruise, sink)?;
    Ok(Some(Table::new(
        "By what turns it",
        ["", ""],
        limits.rows(cruise),
    )))
}

fn flight(args: &Args, ray: &Ray) -> String {
    match (args.accel, args.climb_deg) {
        (Some(a), _) => format!(
            "level flight accelerating at {a} m/s² (ε = {:.2}°)",
            ray.epsilon.to_degrees()
        ),
        (None, Some(climb)) => format!("steady climb at ε = {climb}°"),
        (None, None) => "steady level flight (ε = 0)".to_owned(),
    }
}

/// Cusps that a flight may meet: within these angles of zero lift and of the horizon \[°\].
const NEAR: [f64; 2] = [30.0, 60.0];

/// What the table of `near` cusps says, of all that there are.
fn cusps_title(near: usize, all: usize) -> String {
    let others = match all - near {
        0 => String::new(),
        n => format!(
            "; {n} more at steeper paths or behind the stall, where a table bends: --json has them"
        ),
    };
    format!("Cusps: climb angles beyond which two folds are gone{others}")
}

fn tables(summary: &Summary, ray: &Ray) -> Vec<Table> {
    let or_infinity = |a: Option<f64>, of: &dyn Fn(f64) -> String| a.map_or("∞".to_owned(), of);
    let airspeed = |a: f64| fixed(ray.speed(a), 2);
    let jumps = [
        ("accelerating", &summary.jump_up),
        ("decelerating", &summary.jump_down),
    ];
    let jumps: Vec<_> = jumps
        .into_iter()
        .filter_map(|(which, jump)| Some((which, jump.as_ref()?)))
        .collect();
    let is_near = |c: &&CuspSummary| c.alpha_deg.abs() < NEAR[0] && c.epsilon_deg.abs() < NEAR[1];
    let near: Vec<&CuspSummary> = summary.cusps.iter().filter(is_near).collect();
    let tables = [
        Table::of(
            "Folds",
            &summary.folds,
            &[
                ("α [°]", &|f| fixed(f.alpha_deg, 3)),
                ("a", &|f| fixed(f.a, 5)),
                ("airspeed [m/s]", &|f| fixed(f.speed_m_s, 2)),
            ],
        ),
        Table::of(
            "Equilibria",
            &summary.counts,
            &[
                ("a from", &|c| fixed(c.a_min, 4)),
                ("to", &|c| or_infinity(c.a_max, &|a| fixed(a, 4))),
                ("airspeed from [m/s]", &|c| airspeed(c.a_min)),
                ("to", &|c| or_infinity(c.a_max, &airspeed)),
                ("number", &|c| c.n.to_string()),
            ],
        ),
        Table::of(
            "Jumps",
            &jumps,
            &[
                ("", &|(which, _)| (*which).to_owned()),
                ("from α [°]", &|(_, j)| fixed(j.from_alpha_deg, 2)),
                ("to α [°]", &|(_, j)| fixed(j.to_alpha_deg, 2)),
                ("a", &|(_, j)| fixed(j.a, 4)),
                ("airspeed [m/s]", &|(_, j)| fixed(j.speed_m_s, 2)),
            ],
        ),
        Table::of(
            cusps_title(near.len(), summary.cusps.len()),
            near.iter().copied(),
            &[
                ("ε [°]", &|c| fixed(c.epsilon_deg, 2)),
                ("a", &|c| fixed(c.a, 4)),
                ("α [°]", &|c| fixed(c.alpha_deg, 2)),
            ],
        ),
    ];
    tables.into_iter().filter(|t| !t.rows.is_empty()).collect()
}
