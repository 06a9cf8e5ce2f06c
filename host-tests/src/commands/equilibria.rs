//! `equilibria`: the orientations that hold one reference, as the core finds them on board.

use alula::ned::Ned;
use alula::planar::Reference;
use alula::planar::equilibrium::{Branch, Equilibrium, Spherical, existence};
use alula::planar::equilibrium::{Equilibria, FoldMap, FoldMargin};
use anyhow::anyhow;
use serde::Serialize;

use alula_report::equilibria::figure;
use alula_report::{Page, Table, fixed};
use alula_sim::airframe::Airframe;
use alula_sim::reference::Vector;

use super::output::Output;
use super::settings::expect_airframe;

/// The orientations that hold a reference velocity, with thrust and branch
#[derive(clap::Args)]
pub struct Args {
    /// A built-in experiment, vehicle or polar, or a file: of an experiment or vehicle (TOML), or a polar as `fit` reads it
    vehicle: String,
    /// Reference velocity over ground [m/s]. East is 0, here and below: the vertical plane is the one to the north
    #[arg(long, value_name = "NORTH,EAST,DOWN", value_parser = vector, allow_hyphen_values = true)]
    velocity: Ned,
    /// Reference acceleration [m/s²]
    #[arg(long, value_name = "NORTH,EAST,DOWN", value_parser = vector, default_value = "0,0,0", allow_hyphen_values = true)]
    accel: Ned,
    /// Wind over ground [m/s]
    #[arg(long, value_name = "NORTH,EAST,DOWN", value_parser = vector, default_value = "0,0,0", allow_hyphen_values = true)]
    wind: Ned,
    #[command(flatten)]
    output: Output,
}

/// A vector in the vertical plane to the north. A pair is what it was once, down and forward.
fn vector(text: &str) -> Result<Ned, String> {
    let number = |part: &str| match part.trim().parse::<f32>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("{part:?} is not a finite number")),
    };
    let parts: Vec<&str> = text.split(',').collect();
    match parts[..] {
        [north, east, down] => {
            if number(east)? != 0.0 {
                return Err("EAST must be 0: the vertical plane is the one to the north".to_owned());
            }
            Ok(Ned::new(number(north)?, 0.0, number(down)?))
        }
        [down, forward] => Err(format!(
            "must be three numbers, NORTH,EAST,DOWN: what was {down},{forward} (down, forward) is now {forward},0,{down}"
        )),
        _ => Err("must be three numbers, NORTH,EAST,DOWN".to_owned()),
    }
}

#[derive(Serialize)]
struct Row {
    alpha_deg: f32,
    theta_deg: f32,
    thrust_n: f32,
    thrust_to_weight: f32,
    t_p_n: f32,
    fp_n: f32,
    branch: &'static str,
    isolated: bool,
    in_theta_plus: bool,
    /// To the nearest fold within 11° \[°\], and the airspeed there over the present one.
    fold_alpha_deg: Option<f32>,
    fold_speed_ratio: Option<f32>,
}

/// What is known of every reference: true if the theorem's hypotheses are met, and why or why not.
#[derive(Serialize)]
struct Answer {
    theorem: &'static str,
    met: bool,
    reason: String,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary {
    vehicle: String,
    equilibria: Vec<Row>,
    existence: Vec<Answer>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    expect_airframe(&args.vehicle)?;
    let airframe = Airframe::load(&args.vehicle)?;
    let name = format!("equilibria-{}", airframe.name);
    let out = args.output.folder(&name)?;
    let vehicle = airframe.core();
    let reference = Reference {
        velocity: args.velocity.to_plane(),
        acceleration: args.accel.to_plane(),
    };
    let wind = args.wind.to_plane();
    let set = Equilibria::find(&vehicle, &reference, wind)
        .map_err(|e| anyhow!("{}: {e}", airframe.name))?;
    let map = FoldMap::new(&vehicle);
    let margin = |e: &Equilibrium| {
        map.margin(&alula::planar::equivalency::ApparentForces::new(
            &vehicle,
            e.attitude,
            reference.velocity - wind,
            reference.acceleration,
        ))
    };
    let weight = vehicle.mass() * vehicle.gravity();
    let summary = Summary {
        vehicle: airframe.name.clone(),
        equilibria: set
            .as_slice()
            .iter()
            .map(|e| row(e, margin(e), weight))
            .collect(),
        existence: existence(&vehicle),
    };
    let points: Vec<(f64, f64)> = set
        .as_slice()
        .iter()
        .map(|e| (e.attitude.angle().into(), e.thrust.into()))
        .collect();
    let in_plane = |v: Ned| Vector::new(v.down.into(), v.north.into());
    let vectors = [args.velocity, args.accel, args.wind].map(in_plane);
    let said = |v: Ned| format!("({}, {}, {})", v.north, v.east, v.down);
    let page = Page {
        title: format!("Equilibria of {}", airframe.name),
        lead: format!(
            "velocity {} m/s, acceleration {} m/s², wind {} m/s, each (north, east, down)",
            said(args.velocity),
            said(args.accel),
            said(args.wind)
        ),
        figure: figure(&airframe.reference(), vectors, &points),
        tables: tables(&summary),
        notes: "The set is the core's, in single precision; the curves are in double precision."
            .to_owned(),
        ..Page::default()
    };
    args.output.leave(&out, &page, &summary)
}

fn row(e: &Equilibrium, margin: Option<FoldMargin>, weight: f32) -> Row {
    Row {
        alpha_deg: e.alpha.to_degrees(),
        theta_deg: e.attitude.angle().to_degrees(),
        thrust_n: e.thrust,
        thrust_to_weight: e.thrust / weight,
        t_p_n: e.t_p,
        fp_n: e.f_p_norm(),
        branch: match e.branch() {
            Branch::Aligned => "0",
            Branch::Opposed => "pi",
        },
        isolated: e.isolated,
        in_theta_plus: e.is_in_theta_plus(),
        fold_alpha_deg: margin.map(|m| m.alpha.to_degrees()),
        fold_speed_ratio: margin.map(|m| m.a.sqrt()),
    }
}

fn existence(vehicle: &alula_sim::experiment::Vehicle) -> Vec<Answer> {
    fn answer<T: ToString, E: ToString>(theorem: &'static str, result: Result<T, E>) -> Answer {
        Answer {
            theorem,
            met: result.is_ok(),
            reason: result.map_or_else(|e| e.to_string(), |t| t.to_string()),
        }
    }
    let model = vehicle.model();
    vec![
        answer("Theorem 1 i", existence::theorem_1_symmetric(vehicle)),
        answer("Theorem 1 ii", existence::theorem_1_bisymmetric(model)),
        answer("Theorem 2", existence::theorem_2(model)),
        answer(
            "Lemma 1 (passivity)",
            existence::passive(model).map(|()| "the air does no work; no equilibrium follows"),
        ),
        answer(
            "Lemma 3",
            Spherical::new(vehicle).map(|_| "two opposite equilibria but at one bad velocity"),
        ),
    ]
}

fn tables(summary: &Summary) -> Vec<Table> {
    let which = |yes: bool, [one, other]: [&str; 2]| if yes { one } else { other }.to_owned();
    vec![
        Table::of(
            format!("{} equilibria", summary.equilibria.len()),
            &summary.equilibria,
            &[
                ("α [°]", &|e| fixed(e.alpha_deg, 3)),
                ("θ [°]", &|e| fixed(e.theta_deg, 3)),
                ("thrust [N]", &|e| fixed(e.thrust_n, 3)),
                ("T/(m g)", &|e| fixed(e.thrust_to_weight, 3)),
                ("apparent force [N]", &|e| fixed(e.fp_n, 3)),
                ("branch", &|e| which(e.branch == "0", ["θ̃ = 0", "θ̃ = π"])),
                ("isolated", &|e| which(e.isolated, ["yes", "no"])),
                ("to fold [°]", &|e| {
                    let fold = e.fold_alpha_deg;
                    fold.map_or("–".to_owned(), |x| format!("{x:+.1}"))
                }),
            ],
        ),
        Table::of(
            "What holds at every reference",
            &summary.existence,
            &[
                ("", &|a| a.theorem.to_owned()),
                ("hypotheses", &|a| which(a.met, ["met", "not met"])),
                ("because", &|a| a.reason.clone()),
            ],
        ),
    ]
}
