//! The files of a vehicle: itself with its first flight, and a campaign of it.

use std::fmt::Write as _;

use alula::guidance::REASONS;
use alula::{GuidanceParameters, Parameters as _};

use super::Design;
use super::goals::limits_text;
use alula_sim::experiment::{FieldError, file_name, require};
use alula_sim::named::on_one_line;

/// What the campaign draws the true mass from, over the one given.
pub(super) const MASS: [f64; 2] = [0.85, 1.1];
/// As [`MASS`], of k_a.
const K_A: [f64; 2] = [0.75, 1.25];

/// `name` must do for files and folders, in TOML, in C and in a shell.
pub fn check_name(name: &str) -> Result<(), FieldError> {
    let fits = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let begins = name.chars().next().is_some_and(char::is_alphanumeric);
    if let Some(short) = name.strip_suffix(".toml") {
        let problem = format!("{name:?}: the name is without the extension of its file: {short:?}");
        return Err(FieldError::new("name", problem));
    }
    let problem = format_args!(
        "{name:?}: a name is of letters, digits, -, _ and ., and begins with one of the first two; another folder is --out"
    );
    require(begins && name.chars().all(fits), "name", problem)
}

/// A number in few digits: what single precision holds and no more.
pub(super) fn short(x: f64) -> String {
    format!("{}", x as f32)
}

/// The vehicle's file: the vehicle, its actuators, its guidance with the reason for each number, and a round trip to fly.
pub fn vehicle_text(name: &str, design: &Design) -> String {
    let (facts, parameters) = (&design.facts, &design.parameters);
    let [least, most] = facts.thrust().map(short);
    let mut text = format!(
        "# {name}, made by `alula-sil new` from {} kg, {} m², {}, T/W {}, lags of {} s (thrust) and {} s (rate), {} m/s.\n\
         # Every command takes this file: fly, margins, envelope, equilibria, sweep; {name}-campaign.toml flies it dispersed.\n\
         description = \"{name}: hover to {} m/s {}\"\n",
        facts.mass_kg,
        facts.wing_m2,
        on_one_line(&facts.section),
        facts.thrust_to_weight,
        facts.thrust_lag_s,
        facts.rate_lag_s,
        facts.cruise_m_s,
        facts.cruise_m_s,
        design.trip.text(facts.cruise_m_s),
    );
    let _ = write!(
        text,
        "duration_s = {}\ncontrol_rate_hz = {}\n\n[vehicle]\nmass_kg = {}\n\
         k_a_kg_m = {} # ρΣ/2 with ρ = {} kg/m³ and Σ = {} m²\n\
         delta_deg = {} # from where the polar's α is zero to the thrust line\n",
        short(design.trip.duration(facts.cruise_m_s)),
        facts.control_rate_hz,
        facts.mass_kg,
        short(facts.k_a()),
        facts.air_kg_m3,
        facts.wing_m2,
        facts.delta_deg,
    );
    if facts.c_y > 0.0 {
        let _ = writeln!(text, "c_y = {} # side force over sideslip", facts.c_y);
    }
    text += "\n";
    for sentence in &design.wing.story {
        let _ = writeln!(text, "# {}.", on_one_line(sentence));
    }
    text += &design.wing.toml();
    let (words, _) = facts.actuators.words();
    let _ = writeln!(
        text,
        "\n# Turned by {words}: {} rad/s² in hover.\n[vehicle.authority]",
        facts.turn_rad_s2
    );
    let (authority, sources) = facts.turning();
    let table = authority.table();
    for (field, source) in sources {
        let value = short(table[field].as_float().unwrap_or_default());
        let number = format!("{field} = {value}");
        let _ = writeln!(text, "{number:<34} # {source}");
    }
    let _ = write!(
        text,
        "\n[plant]\nrate_loop.lag = {{ time_constant_s = {} }}\nthrust_lag_s = {}\n\
         thrust_n = [{least}, {most}] # {} and {} times the weight of {:.2} N\n\n\
         # By the rules of `GuidanceParameters::for_vehicle`, each with its reason. The controller believes in the [vehicle] above.\n\
         [controller.guidance]\n",
        facts.rate_lag_s,
        facts.thrust_lag_s,
        facts.idle_to_weight,
        facts.thrust_to_weight,
        facts.weight(),
    );
    for (i, (row, (_, reason))) in GuidanceParameters::ROWS.iter().zip(REASONS).enumerate() {
        let number = format!("{} = {}", file_name(row), short(parameters.get(i).into()));
        let _ = writeln!(text, "{number:<34} # {reason}");
    }
    text += "\n# Hover, cruise, hover. `--set` or a file with `base` flies something else.\n[reference]\nknots = [\n";
    for [time, down, forward] in design.trip.knots(facts.cruise_m_s) {
        let _ = writeln!(
            text,
            "    {{ t_s = {}, down_m_s = {:?}, forward_m_s = {} }},",
            short(time),
            down as f32,
            short(forward)
        );
    }
    let _ = write!(
        text,
        "]\n\n[initial]\nthrust_n = {}\n",
        short(facts.weight())
    );
    text
}

/// The vehicle's campaign: its round trip in wind and turbulence with a vehicle that differs from what the controller believes.
pub fn campaign_text(name: &str, design: &Design) -> String {
    let facts = &design.facts;
    let wind = short(0.25 * facts.cruise_m_s);
    let [lightest, heaviest] = MASS;
    let [least, most] = K_A;
    let limits = limits_text(facts);
    format!(
        "# {name} as it may really be: what is weighed and measured is off, and so is the day. The controller believes in {name}.toml.\n\
description = \"{name}: round trips, dispersed\"
base = \"{name}.toml\"
flights = 1000
seed = 1

[set]
substeps = 2
\"weather.turbulence\" = {{ wind_at_20_ft_m_s = 5.0, height_m = 30.0 }}
\"weather.steady_m_s\" = [0.0, 0.0, 0.0]
\"sensors.velocity_m_s\" = {{ noise = 0.05, bias = 0.0, quantum = 0.01 }}
\"sensors.position_m\" = {{ noise = 0.1, bias = 0.0 }}
\"sensors.attitude_deg\" = {{ noise = 0.2, bias = 0.0 }}
\"sensors.air_m_s\" = {{ noise = 0.3, bias = 0.0 }}

[[disperse]]
field = \"vehicle.mass_kg\"
scale.uniform = [{lightest}, {heaviest}]
[[disperse]]
field = \"vehicle.k_a_kg_m\"
scale.uniform = [{least}, {most}]
[[disperse]]
field = \"vehicle.delta_deg\"
add.uniform = [-2.0, 2.0]
[[disperse]]
field = \"plant.rate_loop.lag.time_constant_s\"
scale.uniform = [0.8, 1.25]
[[disperse]]
field = \"plant.thrust_lag_s\"
scale.uniform = [0.8, 1.25]
[[disperse]]
field = \"plant.delay_s\"
to.uniform = [0.0, 0.02]
[[disperse]]
field = \"sensors.attitude_deg.bias\"
to.normal = {{ mean = 0.0, deviation = 0.5, within = 3.0 }}
[[disperse]]
field = \"weather.steady_m_s[0]\"
to.uniform = [-{wind}, {wind}]
[[disperse]]
field = \"weather.turbulence.wind_at_20_ft_m_s\"
to.uniform = [2.0, 10.0]

{limits}
[[maps]]
x = {{ field = \"vehicle.mass_kg\", from = {}, to = {}, bins = 12 }}
y = {{ field = \"vehicle.k_a_kg_m\", from = {}, to = {}, bins = 12 }}
figure = \"altitude_least_m\"
levels = [-0.5, -1.5, -3.0, -10.0, -50.0]
",
        short(lightest * facts.mass_kg),
        short(heaviest * facts.mass_kg),
        short(least * facts.k_a()),
        short(most * facts.k_a()),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Known;

    /// No product of what was typed is written as 26.325000000000003.
    #[test]
    fn numbers_have_few_digits() {
        for n in 1..20 {
            let known = Known {
                mass_kg: Some(0.1 * f64::from(n)),
                wing_m2: Some(0.03 * f64::from(n)),
                cruise_m_s: Some(20.0 + 0.15 * f64::from(n)),
                ..Known::tail_sitter()
            };
            let facts = known.facts().unwrap();
            let known = [facts.mass_kg, facts.wing_m2, facts.cruise_m_s].map(|x| x.to_string());
            let design = Design::new(facts).unwrap();
            for text in [vehicle_text("x", &design), campaign_text("x", &design)] {
                let numbers = text.split(|c: char| !(c.is_ascii_digit() || c == '.'));
                let long = numbers.filter(|number| number.len() > 11);
                let made: Vec<&str> = long
                    .filter(|number| !known.iter().any(|known| known == number))
                    .collect();
                assert_eq!(made, [""; 0]);
            }
        }
    }

    /// x.toml.toml is nobody's wish.
    #[test]
    fn a_file_is_no_name() {
        let error = check_name("x.toml").unwrap_err().to_string();
        assert!(error.ends_with("extension of its file: \"x\""), "{error}");
    }

    #[test]
    fn names_that_would_break_a_file_are_refused() {
        for name in ["tail-sitter", "Flügel_2.1", "x"] {
            assert_eq!(check_name(name), Ok(()), "{name}");
        }
        for name in [
            "", "a\"b", "a\\b", "a\nb", "a b", "../x", "a/b", "-x", ".x", "a*/b",
        ] {
            let error = check_name(name).unwrap_err().to_string();
            assert!(
                error.contains("a name is of letters") && error.lines().count() == 1,
                "{error}"
            );
        }
    }
}
