//! `fit`: the combined model's parameters from a table.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use alula_sil::airframe::Airframe;
use alula_sil::envelope::{Curve, Fold};
use alula_sil::files;
use alula_sil::fit::{Errors, Metric, Sphericity, fit};
use alula_sil::page::fit::svg;
use alula_sil::page::{Page, Table, columns};
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
        svg: svg(polar.rows, &model),
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
    let value = |name: &str, x: f64| vec![name.to_owned(), format!("{x:.5}")];
    let errors = |range: &str, e: &Errors| {
        let mut row = vec![range.to_owned()];
        row.extend([e.rms_cl, e.max_cl, e.rms_cd, e.max_cd].map(|x| format!("{x:.4}")));
        row
    };
    let sphericity = |what: &str, s: &Sphericity| {
        vec![
            what.to_owned(),
            format!("{:.2}", s.rms_condition),
            format!("{:.2}", s.max_condition),
            format!("{:.1}", s.at_alpha_deg),
            format!("{:.4}", s.rms_simpler),
        ]
    };
    let fold = |what: &str, f: &FoldSummary| {
        vec![
            what.to_owned(),
            format!("{:.3}", f.alpha_deg),
            format!("{:.5}", f.a),
        ]
    };
    let of_table = s.folds_table.iter().map(|f| fold("table", f));
    let of_fit = s.folds.iter().map(|f| fold("fit", f));
    vec![
        Table {
            title: "Parameters".to_owned(),
            header: columns(["", "value"]),
            rows: vec![
                value("c0", p.c0),
                value("c1", p.c1),
                value("c2", p.c2),
                value("c3", p.c3),
                value("ᾱ [°]", p.alpha_bar_deg),
                value("k_L", p.k_l),
                value("k_D", p.k_d),
                value("distance from the table", s.metric),
            ],
        },
        Table {
            title: "Errors".to_owned(),
            header: columns(["", "c_L RMS", "c_L max", "c_D RMS", "c_D max"]),
            rows: vec![
                errors("0–20°", &s.errors_0_20),
                errors("0–180°", &s.errors_0_180),
            ],
        },
        Table {
            title: "Sphericity residuals, δ = 0".to_owned(),
            header: columns([
                "",
                "eq:condition RMS",
                "max",
                "at α [°]",
                "eq:condSimpler RMS",
            ]),
            rows: vec![
                sphericity("table", &s.sphericity_table),
                sphericity("fit", &s.sphericity),
            ],
        },
        Table {
            title: "Folds in level flight".to_owned(),
            header: columns(["", "α [°]", "a"]),
            rows: of_table.chain(of_fit).collect(),
        },
    ]
}
