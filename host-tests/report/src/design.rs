//! The page about a vehicle of one's own: what was said, what follows, and the polar that it rests on.

use super::flight::drawn;
use alula::guidance::REASONS;
use alula::{GuidanceParameters, Parameters as _};

use super::chart::{BLUE, Chart, ORANGE, Series};
use super::{Figure, Page, Table, fixed};
use alula_design::{Design, FirstFlight, ON_WING, Outcome, Performance, Verdict, vehicle_text};
use alula_sim::experiment::file_name;
use alula_sim::figures::words;
use alula_sim::margins::LONGEST;
use alula_sim::polar::Upto;

/// Says on a page of a vehicle, or of its first flight, what came of that.
pub fn judge(page: &mut Page, verdict: &Verdict) {
    let text = verdict.text();
    match verdict.outcome {
        Outcome::AsAsked => page.lead = format!("{text}. {}", page.lead),
        Outcome::OutsideGoals => page.remarks.insert(0, text),
        Outcome::Fails => page.warnings.insert(0, text),
    }
}

/// The page of the vehicle `name` and its first flight, without what came of that.
pub fn page(name: &str, design: &Design, flight: &FirstFlight) -> Page {
    let findings = &flight.findings;
    Page {
        links: [
            ("first-flight/report.html".to_owned(), "the first flight"),
            ("first-flight/view.html".to_owned(), "in three dimensions"),
            (format!("{name}-campaign.toml"), "its campaign, to be flown"),
        ]
        .map(|(address, words)| (address, words.to_owned()))
        .to_vec(),
        title: name.to_owned(),
        lead: format!("{}.", findings.story.join(". ")),
        warnings: findings.warnings.clone(),
        remarks: Vec::new(),
        figure: figure(design).with_picture(drawn(&flight.experiment, &flight.record)),
        tables: tables(name, design, flight),
        text: Some((format!("{name}.toml"), vehicle_text(name, design))),
        notes: format!(
            "Envelope and margins are of the vehicle as it was described, in still air. The first flight has no wind and no noise: {name}-campaign.toml has both."
        ),
    }
}

/// c_L and c_D over all angles and near stall; what was extended in another colour.
fn figure(design: &Design) -> Figure {
    let model = design.vehicle().reference().aerodynamics;
    let polar = design.wing.polar.map(|(polar, _)| polar);
    let symmetric = polar.is_none_or(|polar| polar.is_symmetric());
    let seam = polar.and_then(|polar| polar.seam);
    let given = seam.map(|seam| seam.given_deg);
    let upto = match seam.map(|seam| seam.upto) {
        Some(Upto::Section(_)) => "from the section given",
        Some(Upto::Given) | None => "given",
    };
    let chart = |title, most: f64, of: fn(&alula_sim::reference::Coefficients) -> f64| {
        let least = if symmetric { 0.0 } else { -most };
        let points = |inside: bool| {
            let angles = (0..=1000).map(|n| least + (most - least) * f64::from(n) / 1000.0);
            let point = |degrees: f64| {
                let there = given.is_none_or(|[from, to]| (from..=to).contains(&degrees));
                let value = of(&model.at(alula_sim::reference::wrap(degrees.to_radians())));
                (degrees, if there == inside { value } else { f64::NAN })
            };
            angles.map(point).collect()
        };
        let mut series = vec![Series::line(upto, BLUE, points(true))];
        if given.is_some() {
            series.push(Series::line("extended", ORANGE, points(false)));
        }
        Chart::over(title, "angle of attack α [°]", series)
    };
    let charts = [
        chart("c_L", 179.9, |c| c.c_l),
        chart("c_D", 179.9, |c| c.c_d),
        chart("c_L near stall", 30.0, |c| c.c_l),
        chart("c_D near stall", 30.0, |c| c.c_d),
    ];
    Figure::new(&charts, 250.0)
}

fn tables(name: &str, design: &Design, flight: &FirstFlight) -> Vec<Table> {
    let findings = &flight.findings;
    let parameters = GuidanceParameters::ROWS.iter().zip(REASONS).enumerate();
    let parameters = parameters.map(|(i, (row, (_, reason)))| {
        let value = design.parameters.get(i).to_string();
        [file_name(row), value, (*reason).to_owned()]
    });
    let figures = [
        "altitude_least_m",
        "altitude_most_m",
        "forward_least_m",
        "max_ahead_m",
        "max_true_rate_rad_s",
        "max_late_velocity_error_m_s",
    ];
    let figures = figures.map(|name| [words(name), fixed(flight.figures.get(name), 2)]);
    vec![
        Table::new(
            "What it can do",
            ["", ""],
            envelope(design, &findings.performance),
        ),
        Table::new(
            format!("First flight: the round trip of {name}.toml"),
            ["figure", "value"],
            figures,
        ),
        Table::of(
            "Margins in level flight, with its own lags",
            &findings.margins,
            &[
                ("v [m/s]", &|p| fixed(p.speed_m_s, 1)),
                ("α [°]", &|p| {
                    p.alpha_deg.map_or("–".to_owned(), |a| fixed(a, 1))
                }),
                ("largest rate-loop lag [s]", &|p| limit(p.lag_s)),
                ("largest delay [s]", &|p| limit(p.delay_s)),
            ],
        ),
        Table::new(
            "Parameters of the guidance, and why",
            ["parameter", "value", "reason"],
            parameters,
        ),
    ]
}

fn limit(time: Option<f64>) -> String {
    time.map_or(format!("> {LONGEST}"), |time| fixed(time, 3))
}

/// The envelope in words and numbers.
fn envelope(design: &Design, p: &Performance) -> Vec<[String; 2]> {
    let cruise = design.facts.cruise_m_s;
    let row = |what: &str, value: String| [what.to_owned(), value];
    let stall = match (p.stall, p.jump) {
        (Some(s), _) => format!(
            "{:.1} m/s (α = {:.1}°), the least at which the wing carries level flight. Slowing down, it stalls there. Speeding up slowly, it would stay \
             behind the stall until {:.1} m/s (α = {:.1}°); the guidance crosses earlier, from about {:.1} m/s on",
            s.slow_m_s,
            s.alpha_deg[0],
            s.fast_m_s,
            s.alpha_deg[1],
            ON_WING * s.slow_m_s
        ),
        (None, Some(jump)) => format!(
            "none: nothing stalls in level flight; but slowing down it jumps at {:.1} m/s, from α = {:.1}° to {:.1}°",
            jump.speed_m_s, jump.from_alpha_deg, jump.to_alpha_deg
        ),
        (None, None) => {
            "none: nothing stalls in level flight, and hover becomes cruise without a jump"
                .to_owned()
        }
    };
    let none = |why: &str| why.to_owned();
    let stop = p.stop_m.map_or(
        none("not known: where cruise is asked of hover in one ramp, it is not reached"),
        |[stop, loss, gain]| {
            format!("within {stop:.1} m, {loss:.1} m lower and {gain:.1} m higher at most")
        },
    );
    let off = match p.stall {
        Some(_) => "not on the wing: below the speed of transition",
        None => "not on the wing: at more than 40° of angle of attack",
    };
    let mut rows = vec![
        row("speed of transition", stall),
        row(
            "level cruise",
            p.cruise.map_or(none(off), |[alpha, thrust]| {
                let most = design.facts.thrust_to_weight;
                let short = match thrust > most {
                    true => format!(": MORE than the {:.0} % there are", 100.0 * most),
                    false => String::new(),
                };
                format!("{cruise} m/s at α = {alpha:.1}°, thrust {:.0} % of the weight{short}", 100.0 * thrust)
            }),
        ),
        row(
            "smallest turn in cruise",
            p.turn.map_or(none("none on the wing"), |[load, radius]| {
                format!("radius {radius:.0} m, load factor {load:.2}")
            }),
        ),
        row(
            "steepest glide in cruise",
            p.glide.map_or(none("none: least thrust holds it up"), |[angle, sink]| {
                format!("{angle:.1}°, {sink:.1} m/s of sink; steeper descents are flown behind the stall or tail first")
            }),
        ),
        row("stops from cruise, flown", stop),
    ];
    rows.extend(
        design
            .limits()
            .into_iter()
            .flat_map(|limits| limits.rows(cruise)),
    );
    rows
}
