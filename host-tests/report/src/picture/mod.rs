//! The picture of a flight: over the ground and from above, with the vehicle's attitude at equal times along the track, and
//! altitude and attitude over time.

mod ground;
mod profile;
mod track;
mod view;

use std::fmt::Write as _;

use self::ground::Ground;
use self::view::{BACK, BELLY, View, label, metres};
use super::svg::{Drawn, Format, NARROW, title, width};
use alula_sim::simulate::Step;

/// Width of the picture on a sheet \[px\].
const WIDE: f64 = 1280.0;

/// Where the parts of a picture are: frames (left, top, width, height), and pixels of texts.
struct Layout {
    size: [f64; 2],
    /// The view over the ground, the one from above, and altitude over time.
    side: [f64; 4],
    above: [f64; 4],
    profile: [f64; 4],
    /// Titles of the two latter.
    title_above: [f64; 2],
    title_profile: [f64; 2],
    /// What is said of vehicles and ground, from where to where.
    notes: [([f64; 2], &'static str); 2],
    legend: [f64; 2],
}

impl Layout {
    /// Views beside each other, altitude under them.
    fn sheet() -> Self {
        Self {
            size: [WIDE, 870.0],
            side: [60.0, 40.0, 730.0, 560.0],
            above: [800.0, 40.0, 480.0, 560.0],
            profile: [100.0, 668.0, WIDE - 160.0, 170.0],
            title_above: [812.0, 24.0],
            title_profile: [12.0, 638.0],
            notes: [([12.0, 614.0], "start"), ([WIDE - 12.0, 614.0], "end")],
            legend: [560.0, 638.0],
        }
    }

    /// One below the other.
    fn narrow() -> Self {
        Self {
            size: [NARROW, 1030.0],
            side: [60.0, 40.0, NARROW - 70.0, 330.0],
            above: [10.0, 440.0, NARROW - 20.0, 320.0],
            profile: [76.0, 870.0, NARROW - 116.0, 120.0],
            title_above: [12.0, 430.0],
            title_profile: [12.0, 850.0],
            notes: [([12.0, 388.0], "start"), ([12.0, 408.0], "start")],
            legend: [12.0, 786.0],
        }
    }
}

/// The view over the ground: towards the north-north-east.
const COURSE: f64 = 25.0;
const ELEVATION: f64 = 32.0;

/// The picture of a flight.
pub fn picture(record: &[Step], format: Format) -> Drawn {
    let layout = match format {
        Format::Sheet => Layout::sheet(),
        Format::Narrow => Layout::narrow(),
        Format::Small => return small(record),
    };
    let mut text = String::new();
    let ground = Ground::of(record);
    let Layout { side, above, .. } = layout;
    let over = track::fitted(View::along(COURSE, ELEVATION), record, &ground, side, true);
    let down = track::fitted(View::along(0.0, 90.0), record, &ground, above, false);
    // The same times in both.
    let every = track::spacing(record, &down).max(track::spacing(record, &over));
    track::draw(&mut text, record, &ground, &over, side, (every, true));
    track::draw(&mut text, record, &ground, &down, above, (every, false));
    let along = profile::draw(&mut text, record, &over, layout.profile);
    let plane = ground.altitude();
    let side = if plane > 0.0 { "above" } else { "below" };
    for (at, words) in [
        (
            [12.0, 24.0],
            "seen from the south-south-west, 32° above the horizon",
        ),
        (layout.title_above, "from above"),
        (
            layout.title_profile,
            &format!("altitude over the start and attitude, every {along} s"),
        ),
    ] {
        title(&mut text, words, at, layout.size[0]);
    }
    let words = [
        format!("a vehicle every {every} s, but where one stands already"),
        format!(
            "ground drawn {} {side} the start, squares of {}",
            metres(plane.abs()),
            metres(ground.grid)
        ),
    ];
    for ((at, anchor), words) in layout.notes.into_iter().zip(&words) {
        label(&mut text, at, words, anchor);
    }
    legend(&mut text, layout.legend, layout.size[0]);
    Drawn {
        size: layout.size,
        attributes: String::new(),
        body: text,
    }
}

/// The way flown, over the ground, alone.
fn small(record: &[Step]) -> Drawn {
    let mut text = String::new();
    let ground = Ground::of(record);
    let frame = [60.0, 4.0, NARROW - 70.0, 216.0];
    let over = track::fitted(View::along(COURSE, ELEVATION), record, &ground, frame, true);
    let every = track::spacing(record, &over);
    track::draw(&mut text, record, &ground, &over, frame, (every, true));
    Drawn {
        size: [NARROW, 224.0],
        attributes: String::new(),
        body: text,
    }
}

/// What the colours are, in lines of a picture of this width.
fn legend(text: &mut String, [left, mut y]: [f64; 2], wide: f64) {
    let mut x = left;
    for (class, words) in [
        (BACK, "flown; back of the vehicle"),
        (BELLY, "its belly"),
        ("orange area", "path (dashed)"),
        ("grey area", "track on the ground"),
    ] {
        let long = 20.0 + width(words, 14.0);
        if x + long > wide {
            (x, y) = (left, y + 20.0);
        }
        let top = y - 9.0;
        let _ = writeln!(
            text,
            "<rect class=\"{class}\" x=\"{x}\" y=\"{top}\" width=\"14\" height=\"10\"/>"
        );
        label(text, [x + 20.0, y], words, "start");
        x += 24.0 + long;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refusals::says;
    use alula_sim::experiment::Document;
    use alula_sim::simulate::fly;

    /// What a reader needs is written: the ground's altitude, its squares, the times, north; and the ground is where it says.
    #[test]
    fn the_picture_says_what_it_shows() {
        let record = |name: &str, settings: &[&str]| {
            let mut document = Document::load(name).unwrap();
            settings.iter().for_each(|s| document.assign(s).unwrap());
            fly(&document.checked().unwrap()).unwrap()
        };
        let climb = record("climbing-turn", &["duration_s=30.0"]);
        let text = picture(&climb, Format::Sheet).body;
        // 120 m high, circles of 80 m: squares of 20 m, and the first whole number of them 0.8 squares under the start.
        says(
            &text,
            &["ground drawn 20 m below the start, squares of 20 m"],
        );
        assert!(text.contains(">N</text>") && text.contains(">80 m</text>"));
        assert!(text.contains("a vehicle every ") && text.contains(">0 s</text>"));
        assert!(!text.contains("mean wind"));
        let ground = Ground::of(&climb);
        assert_eq!((ground.altitude(), ground.grid), (-20.0, 20.0));
        let windy = record("cross-wind", &["duration_s=30.0"]);
        assert!(
            picture(&windy, Format::Sheet)
                .body
                .contains("mean wind 8.0 m/s")
        );
    }
}
