//! The page about a campaign: fans, limits, worst flights, percentiles.

use super::chart::{BLUE, Chart, HEAT, Level, Series, Stroke, TINTS};
use super::{Figure, Page, Table, columns, fixed};
use alula_sim::columns::declared;
use alula_sim::figures::{LOST, words};
use alula_study::Campaign;
use alula_study::{CampaignSource, Fan, LimitResult, MapResult, PERCENTILES, Summary};

const NOTES: &str = "Percentiles are within half a percent; the least and the greatest are exact. A fan shows the range of all \
    flights, 1–99 %, 5–95 % and 25–75 % of them, and the median, each at its instant: no flight need follow its edges. \
    Correlations are linear, between a dispersed field and a limit's figure. A map has every bin in the colour of its worst flight.";

/// The page about what `source` found.
pub fn page(source: &CampaignSource, summary: &Summary) -> Page {
    let campaign = &source.campaign;
    let verdict = if summary.verdict() {
        "passed"
    } else {
        "FAILED"
    };
    let mut lead = format!(
        "{}. {} flights of {}, seed {}: {verdict}",
        campaign.description, summary.flights, campaign.base, campaign.seed,
    );
    if campaign.limits.iter().any(|limit| limit.departure) {
        lead += &format!("; {} departed", summary.departed);
        if summary.departed == 0 {
            // The rule of three.
            let bound = 3.0 / summary.flights as f64;
            lead += &format!(" (under {bound:.1e} of all with 95 % confidence)");
        }
    }
    if summary.diverged > 0 {
        lead += &format!("; {} DIVERGED", summary.diverged);
    }
    if !campaign.limits.is_empty() {
        lead += &format!("; {} keep every limit", summary.passed);
    }
    lead.push('.');
    let mut tables = Vec::new();
    if !summary.limits.is_empty() {
        tables.extend([limits(summary), worst(summary)]);
    }
    if !summary.faults.is_empty() {
        tables.push(faults(summary));
    }
    tables.push(figures(summary));
    if !summary.dispersions.is_empty() {
        tables.push(dispersions(summary));
    }
    Page {
        title: format!("Campaign {}", source.stem()),
        lead,
        warnings: warnings(source, summary),
        figure: figure(source, summary),
        tables,
        notes: NOTES.to_owned(),
        ..Page::default()
    }
}

/// What "passed" does not say.
fn warnings(source: &CampaignSource, summary: &Summary) -> Vec<String> {
    if summary.passed_yet_lost == 0 {
        return Vec::new();
    }
    let depths = summary.faults.iter().map(|fault| fault.least_m);
    let all = summary
        .figures
        .iter()
        .filter(|f| f.figure == "altitude_least_m");
    let least = depths
        .chain(all.map(|f| f.percentiles[0]))
        .fold(f64::INFINITY, f64::min);
    let mut text = format!(
        "\u{201c}Passed\u{201d} does not mean that the altitude was kept: {} of the {} flights that count as passed sank more than {LOST} m \
         below the reference, the lowest flight {:.0} m. No limit asked against it.",
        summary.passed_yet_lost, summary.passed, -least,
    );
    let falls = source
        .campaign
        .faults
        .iter()
        .any(|fault| fault.after.mode.as_deref() == Some("safe"));
    let thrust = source
        .base
        .number("controller.guidance.safe_thrust_mg")
        .unwrap_or(0.0);
    if falls && thrust == 0.0 {
        text += " A fault that lasts to the end ends in the safe command, and with safe_thrust = 0 that is no thrust: the vehicle falls \
                 until the flight is over.";
    }
    vec![text]
}

fn number(value: f64) -> String {
    if value.is_finite() {
        // Not "-0.000".
        format!("{:.3}", (value * 1e3).round() / 1e3 + 0.0)
    } else {
        "–".to_owned()
    }
}

fn bounds(limit: &LimitResult) -> String {
    match (limit.least, limit.most) {
        (Some(least), Some(most)) => format!("{least} to {most}"),
        (Some(least), None) => format!("≥ {least}"),
        (None, Some(most)) => format!("≤ {most}"),
        (None, None) => String::new(),
    }
}

fn limits(summary: &Summary) -> Table {
    let row = |limit: &LimitResult| {
        [
            words(limit.figure),
            bounds(limit),
            format!("{:.2}", 100.0 * limit.share_required),
            format!("{:.2}", 100.0 * limit.share),
            match (limit.kept, limit.departure) {
                (true, _) => "kept",
                (false, false) => "NOT KEPT",
                (false, true) => "DEPARTED",
            }
            .to_owned(),
        ]
    };
    let header = ["figure", "inside", "required [%]", "flights [%]", ""];
    Table::new("Limits", header, summary.limits.iter().map(row))
}

fn worst(summary: &Summary) -> Table {
    let sides = |limit: &LimitResult| (limit.figure, limit.least.is_some(), limit.most.is_some());
    let limits = summary.limits.iter().enumerate();
    // A stricter limit of the same figure has the same worst flights.
    let first = limits.filter(|(i, limit)| {
        let same = |earlier: &LimitResult| sides(earlier) == sides(limit);
        !summary.limits[..*i].iter().any(same)
    });
    let rows = first.flat_map(|(_, limit)| {
        limit.worst.iter().map(|worst| {
            [
                words(limit.figure),
                worst.flight.to_string(),
                number(worst.value),
                worst.command.clone(),
            ]
        })
    });
    let header = ["figure", "flight", "value", "fly it again"];
    Table::new("Worst flights", header, rows)
}

fn faults(summary: &Summary) -> Table {
    let rows = summary.faults.iter().map(|fault| {
        let kind = serde_json::to_value(fault.kind).expect("a name");
        let others: Vec<String> = fault.others.iter().map(ToString::to_string).collect();
        [
            kind.as_str().unwrap_or_default().to_owned(),
            fault.during.clone(),
            fault.flights.to_string(),
            fault.as_stated.to_string(),
            number(fault.least_m),
            others.join(", "),
        ]
    });
    let header = [
        "kind",
        "ends in",
        "flights",
        "as stated",
        "least altitude [m]",
        "flights that did not",
    ];
    Table::new("Faults", header, rows)
}

fn figures(summary: &Summary) -> Table {
    let rows = summary.figures.iter().map(|found| {
        let mut row = vec![words(found.figure)];
        row.extend(found.percentiles.map(number));
        row
    });
    Table {
        title: "Percentiles over all flights".to_owned(),
        header: columns([
            "figure", "least", "1 %", "5 %", "25 %", "50 %", "75 %", "95 %", "99 %", "greatest",
        ]),
        rows: rows.collect(),
    }
}

fn dispersions(summary: &Summary) -> Table {
    let rows = summary.dispersions.iter().map(|found| {
        let named = found.correlations.iter().zip(&summary.limits);
        let mut by_size: Vec<_> = named.collect();
        by_size.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        let largest = by_size.first().map_or(String::new(), |(r, limit)| {
            format!("{r:+.2} {}", words(limit.figure))
        });
        let [least, most] = [found.least, found.most].map(number);
        [found.field.clone(), least, most, largest]
    });
    let largest = "largest correlation with a limit's figure";
    Table::new("Dispersions", ["field", "least", "greatest", largest], rows)
}

fn figure(source: &CampaignSource, summary: &Summary) -> Figure {
    let titles = summary.fans.iter().map(title);
    let titles: Vec<String> = titles.collect();
    let fans = summary.fans.iter().zip(&titles);
    let fans = fans.map(|(found, title)| Chart {
        levels: levels(&source.campaign, found.column),
        ..fan(found, title)
    });
    let texts: Vec<MapTexts> = summary.maps.iter().map(MapTexts::new).collect();
    let maps = summary.maps.iter().zip(&texts);
    let maps = maps.map(|(found, texts)| map(found, texts));
    let charts: Vec<Chart> = fans.chain(maps).collect();
    Figure::new(&charts, 230.0)
}

/// The maps alone, on a sheet of their own; none if the campaign asks for none.
pub fn maps(summary: &Summary) -> Option<Figure> {
    let texts: Vec<MapTexts> = summary.maps.iter().map(MapTexts::new).collect();
    let maps = summary.maps.iter().zip(&texts);
    let charts: Vec<Chart> = maps.map(|(found, texts)| map(found, texts)).collect();
    (!charts.is_empty()).then(|| Figure::new(&charts, 320.0))
}

/// Figures of a part of the flight: the column whose extreme they are, and which part.
const PARTS: [(&str, &str, &str); 4] = [
    ("max_ahead_m", "forward_m", " where it brakes"),
    (
        "max_cruise_error_m_s",
        "velocity_error_m_s",
        " at the end of cruise",
    ),
    (
        "max_late_velocity_error_m_s",
        "velocity_error_m_s",
        " at the end",
    ),
    (
        "late_mean_velocity_error_m_s",
        "velocity_error_m_s",
        " at the end",
    ),
];

/// The column whose extreme the figure is, and of which part of the flight.
fn drawn(figure: &str) -> (String, &'static str) {
    match PARTS.iter().find(|(name, ..)| *name == figure) {
        Some((_, column, part)) => ((*column).to_owned(), part),
        None => {
            let column = figure.trim_start_matches("max_");
            (column.replace("_least", "").replace("_most", ""), "")
        }
    }
}

/// The limits of the extremes of a column.
fn levels(campaign: &Campaign, column: &str) -> Vec<Level> {
    let mut levels = Vec::new();
    for limit in &campaign.limits {
        let (of, part) = drawn(&limit.figure);
        if of != column {
            continue;
        }
        let label = match limit.share {
            1.0 => format!("limit{part}"),
            share => format!("limit of {} %{part}", fixed(100.0 * share, 1)),
        };
        let ends = limit.least.into_iter().chain(limit.most);
        levels.extend(ends.map(|at| Level::new(at, &*label)));
    }
    levels
}

/// Of values in radians, degrees.
fn scale(fan: &Fan) -> f64 {
    if fan.column.ends_with("_rad") {
        180.0 / std::f64::consts::PI
    } else {
        1.0
    }
}

/// The column's meaning and its unit.
fn title(fan: &Fan) -> String {
    let unit = match fan.column {
        name if name.ends_with("_m_s") => " [m/s]",
        name if name.ends_with("_m") => " [m]",
        name if name.ends_with("_rad") => " [°]",
        _ => "",
    };
    let meaning = declared(fan.column).meaning;
    format!("{}{unit}", meaning.replace('\\', ""))
}

/// What is written on a map.
struct MapTexts {
    title: String,
    /// Of the colours, from good to bad.
    classes: Vec<String>,
}

impl MapTexts {
    fn new(map: &MapResult) -> Self {
        let MapResult {
            x,
            y,
            figure,
            levels,
            ..
        } = map;
        let beyond = if levels[0] < levels[1] { ">" } else { "<" };
        let first = format!("to {}", levels[0]);
        let rest = levels.iter().map(|level| format!("{beyond} {level}"));
        Self {
            title: format!(
                "{}: the worst over {} → and {} ↑",
                words(figure),
                x.text(),
                y.text()
            ),
            classes: std::iter::once(first).chain(rest).collect(),
        }
    }
}

/// A map: every bin in the colour of its worst flight, and none where nothing flew.
fn map<'a>(map: &'a MapResult, texts: &'a MapTexts) -> Chart<'a> {
    let cell = |bin: usize| {
        let (left, right) = map.x.ends(bin % map.x.bins);
        let (low, high) = map.y.ends(bin / map.x.bins);
        let corners = [(left, low), (right, low), (right, high), (left, high)];
        // Not finite: the next cell is another area.
        corners.into_iter().chain([(left, f64::NAN)])
    };
    let classes = texts.classes.iter().zip(HEAT).enumerate();
    let series = classes.map(|(class, (name, color))| {
        let bins = 0..map.worst.len();
        let inside = bins.filter(|&bin| map.class(bin) == Some(class));
        Series {
            name,
            color,
            stroke: Stroke::Cells,
            points: inside.flat_map(cell).collect(),
        }
    });
    Chart::over(&texts.title, map.x.text(), series.collect())
}

fn fan<'a>(fan: &Fan, title: &'a str) -> Chart<'a> {
    const NAMES: [&str; 4] = ["all", "1–99 %", "5–95 %", "25–75 %"];
    let last = PERCENTILES.len() - 1;
    let scale = scale(fan);
    let mut series: Vec<Series> = Vec::new();
    for (i, (name, color)) in NAMES.into_iter().zip(TINTS).enumerate() {
        let edge = |j: usize| fan.points.iter().map(move |(t, p)| (*t, scale * p[j]));
        series.push(Series {
            name,
            color,
            stroke: Stroke::Fan,
            points: edge(i).chain(edge(last - i).rev()).collect(),
        });
    }
    let median = fan.points.iter().map(|(t, p)| (*t, scale * p[last / 2]));
    series.push(Series::line("median", BLUE, median.collect()));
    Chart::over_time(title, series)
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_study::SAMPLED;

    /// A figure that is renamed, or a column that is no longer sampled, would lose its line without a word.
    #[test]
    fn limits_of_parts_are_in_a_chart() {
        for (figure, column, _) in PARTS {
            let known = alula_sim::figures::index(figure).is_some();
            assert!(known && SAMPLED.contains(&column), "{figure}");
        }
        for (figure, column) in [
            ("altitude_least_m", "altitude_m"),
            ("max_load_factor", "load_factor"),
        ] {
            assert_eq!(drawn(figure), (column.to_owned(), ""));
        }
        assert_eq!(drawn("max_ahead_m").0, "forward_m");
    }
}
