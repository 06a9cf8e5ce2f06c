//! The transitions of a flight as a film: the vehicle every half second between hover and wing, seen from beside its course.

use std::fmt::Write as _;

use super::side::vehicle;
use super::svg::{Drawn, title};
use alula_sim::experiment::{Experiment, V3};
use alula_sim::simulate::Step;

/// Angles of the nose from upright \[°\] up to which a vehicle hovers, and from which on it is on the wing.
const HOVER: f64 = 15.0;
const WING: f64 = 70.0;
/// Between two frames \[s\], what is shown before and after \[s\], and frames at most.
const EVERY: f64 = 0.5;
const AROUND: f64 = 1.0;
const MOST: f64 = 21.0;
/// Height of a row without its title, and the least and the most between two frames \[px\].
const HIGH: f64 = 142.0;
const NEAR: f64 = 52.0;
const APART: f64 = 76.0;

/// A way from hover to wing, or back.
struct Film<'a> {
    to_wing: bool,
    frames: Vec<&'a Step>,
    /// Between two frames \[s\].
    every: f64,
}

/// Angle of the nose from upright \[°\].
fn tilt(step: &Step) -> f64 {
    let [tail, ..] = step.truth.axes();
    tail.z.clamp(-1.0, 1.0).acos().to_degrees()
}

/// The first way to the wing, and the first back.
fn films(record: &[Step]) -> Vec<Film<'_>> {
    let mut films: Vec<Film> = Vec::new();
    // Where it is, and when it was seen there last.
    let mut at: Option<(bool, f64)> = None;
    for step in record {
        let there = match tilt(step) {
            angle if angle <= HOVER => false,
            angle if angle >= WING => true,
            _ => continue,
        };
        if let Some((before, left)) = at
            && before != there
            && films.iter().all(|film| film.to_wing != there)
        {
            films.push(film(record, there, [left - AROUND, step.t + AROUND]));
        }
        at = Some((there, step.t));
    }
    films
}

fn film(record: &[Step], to_wing: bool, [from, to]: [f64; 2]) -> Film<'_> {
    let from = (from / EVERY).ceil().max(0.0) * EVERY;
    let every = EVERY * ((to - from) / (MOST * EVERY)).ceil();
    let mut frames: Vec<&Step> = Vec::new();
    for step in record {
        // A rounding error early rather than a step late.
        let due = from + every * frames.len() as f64;
        if step.t > to {
            break;
        }
        if step.t >= due - 1e-9 {
            frames.push(step);
        }
    }
    Film {
        to_wing,
        frames,
        every,
    }
}

/// The picture of a flight with its films under it.
pub fn with_films(mut picture: Drawn, experiment: &Experiment, record: &[Step]) -> Drawn {
    let text = &mut picture.body;
    let [wide, high] = &mut picture.size;
    for film in films(record) {
        let columns = (*wide / NEAR).floor().min(film.frames.len() as f64);
        let way = if film.to_wing {
            "from hover to the wing"
        } else {
            "from the wing to hover"
        };
        let words = format!(
            "{way}: every {} s, seen from beside the course; thrust behind it",
            film.every
        );
        *high += 22.0 + title(text, &words, [2.0, *high + 15.0], *wide);
        let apart = (*wide / columns).min(APART);
        // Ahead is where it flies on the wing.
        let fastest = film.frames.iter().map(|step| step.truth.velocity);
        let fastest = fastest.max_by(|a, b| a.xy().norm().total_cmp(&b.xy().norm()));
        let course = fastest.map_or(V3::x(), |v| V3::new(v.x, v.y, 0.0).normalize());
        for (k, step) in film.frames.iter().enumerate() {
            let (column, row) = (k as f64 % columns, (k as f64 / columns).floor());
            let top = *high + HIGH * row;
            let at = [apart * (column + 0.5), top + 50.0];
            let [tail, belly, _] = step.truth.axes();
            let seen = |v: V3| [v.dot(&course), v.z];
            vehicle(
                text,
                at,
                [seen(-tail), seen(belly)],
                step.truth.thrust / experiment.weight(),
            );
            let airspeed = (step.truth.velocity - step.wind).norm();
            for (line, words) in [format!("{:.1} s", step.t), format!("{airspeed:.0} m/s")]
                .iter()
                .enumerate()
            {
                let _ = writeln!(
                    text,
                    "<text class=\"tick x\" x=\"{:.1}\" y=\"{:.1}\">{words}</text>",
                    at[0],
                    top + 114.0 + 15.0 * line as f64
                );
            }
        }
        *high += HIGH * (film.frames.len() as f64 / columns).ceil();
    }
    picture
}

#[cfg(test)]
mod tests {
    use super::*;
    use alula_sim::experiment::Document;
    use alula_sim::simulate::fly;

    #[test]
    fn a_round_trip_has_a_film_each_way_every_half_second() {
        let experiment = Document::load("round-trip").unwrap().checked().unwrap();
        let record = fly(&experiment).unwrap();
        let [out, back] = &films(&record)[..] else {
            panic!("two ways")
        };
        assert!(out.to_wing && !back.to_wing);
        for film in [out, back] {
            let (first, last) = (film.frames[0], film.frames[film.frames.len() - 1]);
            let [hover, wing] = if film.to_wing {
                [first, last]
            } else {
                [last, first]
            };
            assert!(tilt(hover) < HOVER + 10.0 && tilt(wing) > WING - 10.0);
            let times = film.frames.windows(2).map(|pair| pair[1].t - pair[0].t);
            assert!(times.into_iter().all(|dt| (dt - film.every).abs() < 1e-6));
            assert!(film.frames.len() > 4 && film.frames.len() as f64 <= MOST + 1.0);
        }
        // It takes the wing at 2 m/s², within seconds of the greatest lift; frames of the way out come first.
        assert!(out.frames[0].t < back.frames[0].t);
    }

    #[test]
    fn a_hover_has_none() {
        let experiment = Document::load("start-hover").unwrap().checked().unwrap();
        let record = fly(&experiment).unwrap();
        let upright = record.iter().filter(|step| tilt(step) < HOVER).cloned();
        assert_eq!(films(&upright.collect::<Vec<_>>()).len(), 0);
    }
}
