//! Flights that a guidance of this library has lost, at any time of its making. They stay here, and none may be lost again.
//!
//! A row is an experiment and the fields that are changed of it. A campaign's flight is kept as it was drawn: `campaign NAME --refly N`
//! leaves it as `experiment.toml`, which is the file named here.

use alula_sim::experiment::Document;
use alula_sim::figures::Figures;
use alula_sim::simulate::fly;

/// What was lost, the experiment, its changes.
const LOST: &[(&str, &str, &[&str])] = &[
    (
        "a steep descent in 1 m/s of wind: nose down, 4200 m lower",
        "steep-descent",
        &["weather.steady_m_s=[1.0,0.0,0.0]"],
    ),
    (
        "the same with the exact belief",
        "steep-descent",
        &["weather.steady_m_s=[1.0,0.0,0.0]", "controller.guidance={}"],
    ),
    (
        "a steep descent in 5 m/s of headwind",
        "steep-descent",
        &["weather.steady_m_s=[-5.0,0.0,0.0]"],
    ),
    (
        "hover asked of a nose-down fall at 20 m/s: never left",
        "round-trip",
        &[
            HOVER,
            "initial.theta_deg=-170",
            "initial.velocity_m_s=[0,0,20]",
        ],
    ),
    (
        "hover asked upside down at 3 m/s: never left",
        "round-trip",
        &[
            HOVER,
            "initial.theta_deg=180",
            "initial.velocity_m_s=[0,0,3]",
        ],
    ),
    (
        "from a sink of 12 m/s to level cruise: 42 m lower",
        "round-trip",
        &[
            "reference.knots=[{t_s=0,down_m_s=0,forward_m_s=0},{t_s=8,down_m_s=12,forward_m_s=0},\
             {t_s=14,down_m_s=12,forward_m_s=0},{t_s=26,down_m_s=0,forward_m_s=20},\
             {t_s=40,down_m_s=0,forward_m_s=20},{t_s=50,down_m_s=0,forward_m_s=0}]",
        ],
    ),
    (
        "level braking in half a metre per second of updraft: never back",
        "round-trip",
        &["weather.steady_m_s=[0.0,0.0,-0.5]"],
    ),
    (
        "level braking with an idle thrust of 3 % of the weight: never back",
        "round-trip",
        &["plant.thrust_n=[2.943,196.2]"],
    ),
    (
        "both, in an updraft of 1 m/s",
        "round-trip",
        &[
            "weather.steady_m_s=[0.0,0.0,-1.0]",
            "plant.thrust_n=[2.943,196.2]",
        ],
    ),
    (
        "the zero-lift line believed 5° off: 617 m lower",
        "round-trip",
        &["vehicle.delta_deg=5"],
    ),
    (
        "the same, the other way",
        "round-trip",
        &["vehicle.delta_deg=-5"],
    ),
    (
        "lift per weight believed 1.8 times too high: a dive below 13 m/s",
        "round-trip",
        &["vehicle.k_a_kg_m=0.31"],
    ),
    (
        "a biplane whose roll was bounded as in level cruise, on its side, too: 74 m lower",
        "tests/flights/biplane-in-turbulence.toml",
        &[],
    ),
];

const HOVER: &str = "reference.knots=[{t_s=0,down_m_s=0,forward_m_s=0}]";

/// None sinks 50 m, and every one is back on its reference at its end.
#[test]
fn none_is_lost_again() {
    let mut failed = Vec::new();
    for (what, base, changes) in LOST {
        let mut document = Document::load(base).unwrap();
        for change in *changes {
            document.assign(change).unwrap();
        }
        let experiment = document.checked().unwrap();
        let figures = Figures::of(&experiment, &fly(&experiment).unwrap());
        let sunk = figures.get("altitude_least_m");
        let end = figures.get("late_mean_velocity_error_m_s");
        println!("{sunk:8.2} m {end:6.3} m/s  {what}");
        // NaN is within neither.
        if !(sunk > -50.0 && end < 0.5) {
            failed.push((what, sunk, end));
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}
