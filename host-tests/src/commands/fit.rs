//! `fit`: the combined model's parameters from a table.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use alula_sil::airframe::Airframe;
use alula_sil::envelope::{Curve, Fold};
use alula_sil::files;
use alula_sil::fit::{Errors, Metric, Sphericity, fit};
use alula_sil::page::fit::figure;
use alula_sil::page::{Page, Table, fixed};
use alula_sil::polar::Polar;
use alula_sil::reference::{Aerodynamics, Combined, Vehicle};

use super::output::Output;

/// Identify the combined model's parameters from a table of coefficients
#[derive(clap::Args)]
pub struct Args {
    /// A built-in polar or a CSV file (alpha_deg,cl,cd)
    polar: String,
    #[command(flatten)]
    output: Output,
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
    let polar = Polar::load(&args.polar)?;
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
    let summary = Summary {
        polar: name.to_string(),
        parameters,
        metric: Metric::new(polar.rows).of(&model),
        errors_0_20: Errors::of(&model, polar.rows, 20.0),
        errors_0_180: Errors::of(&model, polar.rows, 180.0),
        sphericity: Sphericity::of(&model),
        sphericity_table: Sphericity::of(&table),
        folds: level(model),
        folds_table: level(table),
    };
    let toml = toml(&name, &parameters, &paper);
    files::leave(&out.join("vehicle.toml"), |file| {
        Ok(file.write_all(toml.as_bytes())?)
    })?;
    let page = Page {
        title: format!("Fit of {name}"),
        lead: "the combined model, nearest to the table by weighted least squares; vehicle.toml has it".to_owned(),
        warnings: Vec::new(),
        figure: figure(polar.rows, &model),
        tables: tables(&summary),
        text: None,
        notes: "A row weighs the range of α it stands for; rows up to 20° together weigh as much as all others. Folds are those of level flight.".to_owned(),
    };
    args.output.leave(&out, "fit", &page, &summary)
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
