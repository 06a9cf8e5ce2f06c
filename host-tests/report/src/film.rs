//! The transitions of a flight as a film: the vehicle every half second between hover and wing, seen from beside its course.

use std::fmt::Write as _;

use super::side::vehicle;
use super::svg::{Drawn, Format, title};
use alula_sim::experiment::{Experiment, V3};
use alula_sim::simulate::Step;

/// Angles of the nose from upright \[°\] up to which a vehicle hovers, and from which on it is on the wing.
const HOVER: f64 = 15.0;
const WING: f64 = 70.0;
/// Between two frames \[s\], and what is shown before and after \[s\].
const EVERY: f64 = 0.5;
const AROUND: f64 = 1.0;

/// How large a film is.
struct Size {
    /// Over that of a picture by itself.
    scale: f64,
    /// Frames at most.
    most: f64,
    /// Room beside a row, height of one without its title, and the least and the most between two frames \[px\].
    beside: f64,
    high: f64,
    near: f64,
    apart: f64,
    /// Height of a title of one line \[px\].
    title: f64,
    /// Where the middle of a vehicle and the first line of text lie below the top of a row \[px\].
    middle: f64,
    below: f64,
    /// Every so many frames have their time; whether they have their airspeed, too.
    timed: usize,
    airspeed: bool,
}

impl Size {
    const LARGE: Self = Self {
        scale: 1.0,
        most: 21.0,
        beside: 0.0,
        high: 142.0,
        near: 52.0,
        apart: 76.0,
        title: 22.0,
        middle: 50.0,
        below: 114.0,
        timed: 1,
        airspeed: true,
    };
    /// A way in one row.
    const SMALL: Self = Self {
        scale: 0.42,
        most: 20.0,
        beside: 10.0,
        high: 54.0,
        near: 20.0,
        apart: 28.0,
        title: 16.0,
        middle: 12.0,
        below: 47.0,
        timed: 3,
        airspeed: false,
    };
}

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
fn films(record: &[Step], most: f64) -> Vec<Film<'_>> {
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
            films.push(film(record, there, [left - AROUND, step.t + AROUND], most));
        }
        at = Some((there, step.t));
    }
    films
}

fn film(record: &[Step], to_wing: bool, [from, to]: [f64; 2], most: f64) -> Film<'_> {
    let from = (from / EVERY).ceil().max(0.0) * EVERY;
    let every = EVERY * ((to - from) / (most * EVERY)).ceil();
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
pub fn with_films(
    mut picture: Drawn,
    experiment: &Experiment,
    record: &[Step],
    format: Format,
) -> Drawn {
    let size = match format {
        Format::Small => Size::SMALL,
        Format::Sheet | Format::Narrow => Size::LARGE,
    };
    let text = &mut picture.body;
    let [wide, high] = &mut picture.size;
    for film in films(record, size.most) {
        let row = *wide - 2.0 * size.beside;
        let columns = (row / size.near).floor().min(film.frames.len() as f64);
        let way = if film.to_wing {
            "onto the wing"
        } else {
            "off the wing"
        };
        let seen = match format {
            Format::Small => "",
            _ => ", seen from beside the course; thrust behind it",
        };
        let words = format!("{way}: every {} s{seen}", film.every);
        let before = size.title;
        *high += before + title(text, &words, [2.0, *high + 0.7 * before], *wide);
        let apart = (row / columns).min(size.apart);
        // Ahead is where it flies on the wing.
        let fastest = film.frames.iter().map(|step| step.truth.velocity);
        let fastest = fastest.max_by(|a, b| a.xy().norm().total_cmp(&b.xy().norm()));
        let course = fastest.map_or(V3::x(), |v| V3::new(v.x, v.y, 0.0).normalize());
        for (k, step) in film.frames.iter().enumerate() {
            let (column, row) = (k as f64 % columns, (k as f64 / columns).floor());
            let top = *high + size.high * row;
            let at = [size.beside + apart * (column + 0.5), top + size.middle];
            let [tail, belly, _] = step.truth.axes();
            let seen = |v: V3| [v.dot(&course), v.z];
            let _ = writeln!(
                text,
                "<g transform=\"translate({:.1} {:.1}) scale({})\">",
                at[0], at[1], size.scale
            );
            vehicle(
                text,
                [0.0; 2],
                [seen(-tail), seen(belly)],
                step.truth.thrust / experiment.weight(),
            );
            *text += "</g>\n";
            if k % size.timed != 0 {
                continue;
            }
            let airspeed = (step.truth.velocity - step.wind).norm();
            let lines = [format!("{:.1} s", step.t), format!("{airspeed:.0} m/s")];
            for (line, words) in lines
                .iter()
                .take(1 + usize::from(size.airspeed))
                .enumerate()
            {
                // Within the drawing: half of a letter is 4 px at most.
                let half = 4.0 * words.len() as f64;
                let _ = writeln!(
                    text,
                    "<text class=\"tick x\" x=\"{:.1}\" y=\"{:.1}\">{words}</text>",
                    at[0].max(half).min(*wide - half),
                    top + size.below + 15.0 * line as f64
                );
            }
        }
        *high += size.high * (film.frames.len() as f64 / columns).ceil();
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
        let [out, back] = &films(&record, Size::LARGE.most)[..] else {
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
            assert!(film.frames.len() > 4 && film.frames.len() as f64 <= Size::LARGE.most + 1.0);
        }
        // It takes the wing at 2 m/s², within seconds of the greatest lift; frames of the way out come first.
        assert!(out.frames[0].t < back.frames[0].t);
    }

    /// In a gallery, too, a vehicle is drawn every half second of a transition, both ways in a row each.
    #[test]
    fn small_films_are_as_dense() {
        let experiment = Document::load("round-trip").unwrap().checked().unwrap();
        let record = fly(&experiment).unwrap();
        let nothing = || Drawn {
            size: [440.0, 0.0],
            attributes: String::new(),
            body: String::new(),
        };
        let small = with_films(nothing(), &experiment, &record, Format::Small);
        let ways = films(&record, Size::SMALL.most);
        let frames: usize = ways.iter().map(|film| film.frames.len()).sum();
        assert_eq!(small.body.matches("class=\"craft").count(), frames);
        assert_eq!(small.body.matches("every 0.5 s").count(), 2);
        assert!(small.size[1] < 2.0 * (Size::SMALL.high + 30.0));
    }

    #[test]
    fn a_hover_has_none() {
        let experiment = Document::load("start-hover").unwrap().checked().unwrap();
        let record = fly(&experiment).unwrap();
        let upright = record.iter().filter(|step| tilt(step) < HOVER).cloned();
        assert_eq!(films(&upright.collect::<Vec<_>>(), 9.0).len(), 0);
    }
}
