//! `fit`: the combined model's parameters from a table.

use std::path::Path;

use anyhow::Context;
use serde::Serialize;

use alula_design::ROWS;
use alula_design::envelope::{Curve, Fold};
use alula_design::fit::{Errors, Metric, Sphericity, fit};
use alula_report::fit::figure;
use alula_report::{Page, Table, fixed};
use alula_sim::airframe::Airframe;
use alula_sim::kind::Kind;
use alula_sim::polar::{Polar, stall};
use alula_sim::reference::{Aerodynamics, Combined, Vehicle};
use alula_study::files::leave_all;

use super::output::Output;
use super::settings::expect_name;

/// Identify the combined model's parameters from a table of coefficients
#[derive(clap::Args)]
pub struct Args {
    /// A built-in polar, or a file: a table of alpha, cl and cd, or an export of XFOIL, XFLR5, AVL, VSPAERO, AeroDyn or QBlade
    polar: String,
    /// Take the polar for the section of a wing of this aspect ratio
    #[arg(long, value_name = "X")]
    aspect_ratio: Option<f64>,
    /// Angle of attack of the greatest lift (°): rows beyond are left out [default: as the polar shows it]
    #[arg(long, value_name = "X")]
    stall_deg: Option<f64>,
    /// Rows of the table left in polar.csv, at most
    #[arg(long, value_name = "N", default_value_t = ROWS)]
    rows: usize,
    #[command(flatten)]
    output: Output,
}

/// Largest root mean square of c_L up to 20° of a model that suits. Of the presets 0.14 is the worst, of NACA 4415 it is 0.4.
const SUITS: f64 = 0.2;

/// What to do where the model does not do.
const FLY_TABLE: &str = "`[vehicle.aerodynamics.table] polar = \"polar.csv\"`";

/// How far a fit may move the stall before that is said \[°\]. Rows of tables are 1° apart, and the greatest lift of a thick section is flat.
const MOVED_DEG: f64 = 2.0;

/// What is to be said where the stall of `model` is not that of the `table`, at this angle \[°\], that it was fitted to.
fn stall_moved(model: &Aerodynamics, table: f64) -> Option<String> {
    let angles = (-120..=360).map(|n| 0.25 * f64::from(n));
    let lift: Vec<[f64; 2]> = angles
        .map(|angle| [angle, model.at(angle.to_radians()).c_l])
        .collect();
    let fitted = stall(&lift).map(|at| lift[at][0]);
    let stalls = match fitted {
        Some(fitted) if (fitted - table).abs() <= MOVED_DEG => return None,
        Some(fitted) => format!("stalls at {fitted:.1}°"),
        None => "does not stall".to_owned(),
    };
    Some(format!(
        "the model {stalls}, the table at {table:.1}°: fly the table, {FLY_TABLE}, where the stall matters"
    ))
}

#[derive(Serialize)]
struct FoldSummary {
    alpha_deg: f64,
    a: f64,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Summary {
    polar: String,
    #[serde(flatten)]
    parameters: Combined,
    /// Whether the model suits the polar.
    suits: bool,
    /// What was made of the polar before the fit, and how far polar.csv is from it.
    polar_csv: Vec<String>,
    /// The distance from the table that was minimised.
    metric: f64,
    errors_0_20: Errors,
    errors_0_180: Errors,
    sphericity: Sphericity,
    sphericity_table: Sphericity,
    folds: Vec<FoldSummary>,
    folds_table: Vec<FoldSummary>,
}

pub fn run(args: &Args) -> anyhow::Result<()> {
    expect_name(&[Kind::Polar], "a polar", &args.polar)?;
    let section = Polar::load(&args.polar)?;
    if let Some(ratio) = args.aspect_ratio.filter(|x| !(0.5..=50.0).contains(x)) {
        anyhow::bail!("--aspect-ratio: {ratio} is not from 0.5 to 50");
    }
    if let Some(degrees) = args.stall_deg.filter(|x| !(5.0..=60.0).contains(x)) {
        anyhow::bail!("--stall-deg: {degrees} is not from 5 to 60");
    }
    let (section, cut) = match args.stall_deg {
        Some(degrees) => section.stalling_at(degrees).context("--stall-deg")?,
        None => (section, None),
    };
    let (polar, how) = section.finite(args.aspect_ratio)?;
    let mut story: Vec<String> = cut.into_iter().chain(how).collect();
    let name = Path::new(polar.name).file_stem().unwrap_or_default();
    let name = name.to_string_lossy();
    let parameters = fit(polar.rows).map_err(|e| e.context(args.polar.clone()))?;
    let out = args.output.folder(&format!("fit-{name}"))?;
    let (model, table) = (
        Aerodynamics::Combined(parameters),
        Aerodynamics::Table(polar.reference),
    );
    let paper = Airframe::of_polar(&name, polar).reference();
    let level = |aerodynamics| {
        level_folds(&Vehicle {
            aerodynamics,
            ..paper
        })
    };
    let (on_board, apart) = polar.of_rows(args.rows)?;
    story.extend(apart.text(on_board.rows.len(), polar.rows.len()));
    leave_all(&out.join("polar.csv"), on_board.csv(&story))?;
    let errors = Errors::of(&model, polar.rows, 20.0);
    let suits = errors.rms_cl <= SUITS;
    let lead = match suits {
        true => "the combined model, nearest to the table by weighted least squares; vehicle.toml has it".to_owned(),
        false => format!(
            "THE COMBINED MODEL DOES NOT SUIT this polar: c_L is off by {:.2} (RMS) up to 20°{}. Fly the table: {FLY_TABLE}",
            errors.rms_cl,
            if polar.is_symmetric() { "" } else { ", as of every section with camber" }
        ),
    };
    let summary = Summary {
        polar: name.to_string(),
        suits,
        polar_csv: story.clone(),
        parameters,
        metric: Metric::new(polar.rows).of(&model),
        errors_0_20: errors,
        errors_0_180: Errors::of(&model, polar.rows, 180.0),
        sphericity: Sphericity::of(&model),
        sphericity_table: Sphericity::of(&table),
        folds: level(model),
        folds_table: level(table),
    };
    let toml = toml(&name, &parameters, &paper);
    leave_all(&out.join("vehicle.toml"), toml)?;
    let mut warnings = section.warnings();
    let shift = polar
        .stall_deg()
        .and_then(|table| stall_moved(&model, table));
    warnings.extend(shift);
    let page = Page {
        title: format!("Fit of {name}"),
        lead: format!("{lead}. polar.csv: {}", story.join(". ")),
        warnings,
        figure: figure(polar.rows, &model),
        tables: tables(&summary),
        notes: "A row weighs the range of α it stands for; rows up to 20° together weigh as much as all others. Folds are those of level flight.".to_owned(),
        ..Page::default()
    };
    args.output.leave(&out, &page, &summary)
}

fn level_folds(vehicle: &Vehicle) -> Vec<FoldSummary> {
    let summary = |fold: &Fold| FoldSummary {
        alpha_deg: fold.alpha.to_degrees(),
        a: fold.a,
    };
    let folds = Curve::new(vehicle, 0.0).map(|curve| curve.folds());
    folds.unwrap_or_default().iter().map(summary).collect()
}

/// A vehicle file: the paper's vehicle with the fitted model.
fn toml(name: &str, p: &Combined, vehicle: &Vehicle) -> String {
    format!(
        "description = \"The paper's vehicle with the combined model fitted to {name}\"\n\n\
         [vehicle]\nmass_kg = {:?}\nk_a_kg_m = {:?}\n\n\
         [vehicle.aerodynamics.combined]\nc0 = {:?}\nc1 = {:?}\nc2 = {:?}\nc3 = {:?}\n\
         alpha_bar_deg = {:?}\nk_l = {:?}\nk_d = {:?}\n",
        vehicle.mass, vehicle.k_a, p.c0, p.c1, p.c2, p.c3, p.alpha_bar_deg, p.k_l, p.k_d
    )
}

fn tables(s: &Summary) -> Vec<Table> {
    let p = &s.parameters;
    let errors = [("0–20°", s.errors_0_20), ("0–180°", s.errors_0_180)];
    let spheres = [("table", s.sphericity_table), ("fit", s.sphericity)];
    let folds = |which, folds| std::iter::repeat(which).zip(folds);
    let folds: Vec<(&str, &FoldSummary)> = folds("table", &s.folds_table)
        .chain(folds("fit", &s.folds))
        .collect();
    vec![
        Table::of(
            "Parameters",
            &[
                ("c0", p.c0),
                ("c1", p.c1),
                ("c2", p.c2),
                ("c3", p.c3),
                ("ᾱ [°]", p.alpha_bar_deg),
                ("k_L", p.k_l),
                ("k_D", p.k_d),
                ("distance from the table", s.metric),
            ],
            &[
                ("", &|(name, _)| (*name).to_owned()),
                ("value", &|(_, value)| fixed(*value, 5)),
            ],
        ),
        Table::of(
            "Errors",
            &errors,
            &[
                ("", &|(range, _)| (*range).to_owned()),
                ("c_L RMS", &|(_, e)| fixed(e.rms_cl, 4)),
                ("c_L max", &|(_, e)| fixed(e.max_cl, 4)),
                ("c_D RMS", &|(_, e)| fixed(e.rms_cd, 4)),
                ("c_D max", &|(_, e)| fixed(e.max_cd, 4)),
            ],
        ),
        Table::of(
            "Sphericity residuals, δ = 0",
            &spheres,
            &[
                ("", &|(which, _)| (*which).to_owned()),
                ("eq:condition RMS", &|(_, s)| fixed(s.rms_condition, 2)),
                ("max", &|(_, s)| fixed(s.max_condition, 2)),
                ("at α [°]", &|(_, s)| fixed(s.at_alpha_deg, 1)),
                ("eq:condSimpler RMS", &|(_, s)| fixed(s.rms_simpler, 4)),
            ],
        ),
        Table::of(
            "Folds in level flight",
            &folds,
            &[
                ("", &|(which, _)| (*which).to_owned()),
                ("α [°]", &|(_, f)| fixed(f.alpha_deg, 3)),
                ("a", &|(_, f)| fixed(f.a, 5)),
            ],
        ),
    ]
}
