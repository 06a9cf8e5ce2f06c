//! `envelope`: folds, equilibrium counts, jumps and cusps of a vehicle.

use anyhow::anyhow;
use serde::Serialize;

use alula_sil::airframe::Airframe;
use alula_sil::envelope::{Curve, Cusp, Fold, FoldCurve, Interval, Jump, jump_down, jump_up};
use alula_sil::page::envelope::{Shown, figure};
use alula_sil::page::{Page, Table, fixed};
use alula_sil::reference::Vehicle;

use super::output::Output;

/// Where a vehicle's equilibria fold and jump, in level flight, in a climb or in an acceleration
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment, vehicle or polar, a TOML file of an experiment or vehicle, or a polar CSV
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
    #[command(flatten)]
    output: Output,
}

#[derive(Serialize)]
struct FoldSummary {
    alpha_deg: f64,
    a: f64,
    speed_m_s: f64,
}

#[derive(Serialize)]
struct JumpSummary {
    from_alpha_deg: f64,
    to_alpha_deg: f64,
    a: f64,
    speed_m_s: f64,
}

#[derive(Serialize)]
struct CuspSummary {
    epsilon_deg: f64,
    a: f64,
    alpha_deg: f64,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary {
    vehicle: String,
    epsilon_deg: f64,
    folds: Vec<FoldSummary>,
    counts: Vec<Interval>,
    jump_up: Option<JumpSummary>,
    jump_down: Option<JumpSummary>,
    cusps: Vec<CuspSummary>,
}

/// The flight along which the airspeed varies.
struct Ray {
    epsilon: f64,
    /// |W| \[N\].
    weight: f64,
    k_a: f64,
}

impl Ray {
    fn new(args: &Args, vehicle: &Vehicle) -> anyhow::Result<Self> {
        let finite = |name: &str, value: Option<f64>| match value {
            Some(x) if !x.is_finite() => Err(anyhow!("{name}: must be a finite number")),
            value => Ok(value.unwrap_or(0.0)),
        };
        let climb = finite("--climb-deg", args.climb_deg)?;
        let acceleration = finite("--accel", args.accel)?;
        if climb.abs() > 90.0 {
            return Err(anyhow!("--climb-deg: must be from -90 to 90"));
        }
        let epsilon = match args.accel {
            Some(_) => (acceleration / vehicle.gravity).atan(),
            None => climb.to_radians(),
        };
        Ok(Self {
            epsilon,
            weight: vehicle.mass * vehicle.gravity.hypot(acceleration),
            k_a: vehicle.k_a,
        })
    }

    /// Airspeed at `a` \[m/s\].
    fn speed(&self, a: f64) -> f64 {
        (a * self.weight / self.k_a).sqrt()
    }
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    let airframe = Airframe::load(&args.vehicle)?;
    let vehicle = airframe.reference();
    let ray = Ray::new(args, &vehicle)?;
    let name = format!("envelope-{}", airframe.name);
    let out = args.output.folder(&name)?;
    let curve = Curve::new(&vehicle, ray.epsilon).ok_or_else(|| {
        anyhow!(
            "{}: no equilibrium curve begins at hover at δ = {:.1}°",
            airframe.name,
            vehicle.delta.to_degrees()
        )
    })?;
    let folds = curve.folds();
    let fold_curve = FoldCurve::new(&vehicle);
    let cusps = fold_curve.cusps();
    let shown = Shown {
        vehicle: &vehicle,
        curve: &curve,
        epsilon: ray.epsilon,
        folds: &folds,
        fold_curve: &fold_curve.pieces(),
        cusps: &cusps,
    };
    let summary = Summary {
        vehicle: airframe.name.clone(),
        epsilon_deg: ray.epsilon.to_degrees(),
        folds: folds.iter().map(|fold| fold_summary(&ray, fold)).collect(),
        counts: curve.counts(&folds),
        jump_up: jump_up(&curve, &folds).map(|jump| jump_summary(&ray, &jump)),
        jump_down: jump_down(&curve, &folds).map(|jump| jump_summary(&ray, &jump)),
        cusps: cusps.iter().map(cusp_summary).collect(),
    };
    let page = Page {
        title: format!("Envelope of {}", airframe.name),
        lead: format!(
            "{}; {}",
            airframe.description.trim_end_matches('.'),
            flight(args, &ray)
        ),
        warnings: Vec::new(),
        figure: figure(&shown),
        tables: tables(&summary, &ray),
        text: None,
        notes: "Equilibria from hover to infinite airspeed; see docs/envelope.md.".to_owned(),
    };
    args.output.leave(&out, "envelope", &page, &summary)
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

fn fold_summary(ray: &Ray, fold: &Fold) -> FoldSummary {
    FoldSummary {
        alpha_deg: fold.alpha.to_degrees(),
        a: fold.a,
        speed_m_s: ray.speed(fold.a),
    }
}

fn jump_summary(ray: &Ray, jump: &Jump) -> JumpSummary {
    JumpSummary {
        from_alpha_deg: jump.from_alpha.to_degrees(),
        to_alpha_deg: jump.to_alpha.to_degrees(),
        a: jump.a,
        speed_m_s: ray.speed(jump.a),
    }
}

fn cusp_summary(cusp: &Cusp) -> CuspSummary {
    CuspSummary {
        epsilon_deg: cusp.epsilon.to_degrees(),
        a: cusp.a,
        alpha_deg: cusp.alpha.to_degrees(),
    }
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
            "Cusps",
            &summary.cusps,
            &[
                ("ε [°]", &|c| fixed(c.epsilon_deg, 2)),
                ("a", &|c| fixed(c.a, 4)),
                ("α [°]", &|c| fixed(c.alpha_deg, 2)),
            ],
        ),
    ];
    tables.into_iter().filter(|t| !t.rows.is_empty()).collect()
}
