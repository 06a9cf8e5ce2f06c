//! The picture of a flight: over the ground and from above, with the vehicle's attitude at equal times along the track, and
//! altitude and attitude over time.

mod ground;
mod profile;
mod track;
mod view;

use std::fmt::Write as _;

use self::ground::Ground;
use self::view::{BACK, BELLY, View, label, metres};
use super::svg::{Drawn, width};
use alula_sim::simulate::Step;

/// Width of the picture, and height of the views and of the whole \[px\].
const WIDE: f64 = 1280.0;
const VIEWS: f64 = 620.0;
const HIGH: f64 = VIEWS + 250.0;

/// The view over the ground: towards the north-north-east.
const COURSE: f64 = 25.0;
const ELEVATION: f64 = 32.0;

/// The picture of a flight.
pub fn picture(record: &[Step]) -> Drawn {
    let mut text = String::new();
    let ground = Ground::of(record);
    let side = [60.0, 40.0, 730.0, VIEWS - 60.0];
    let above = [800.0, 40.0, 480.0, VIEWS - 60.0];
    let over = track::fitted(View::along(COURSE, ELEVATION), record, &ground, side, true);
    let down = track::fitted(View::along(0.0, 90.0), record, &ground, above, false);
    // The same times in both.
    let every = track::spacing(record, &down).max(track::spacing(record, &over));
    track::draw(&mut text, record, &ground, &over, side, (every, true));
    track::draw(&mut text, record, &ground, &down, above, (every, false));
    let profile = [100.0, VIEWS + 48.0, WIDE - 160.0, HIGH - VIEWS - 80.0];
    let along = profile::draw(&mut text, record, &over, profile);
    let plane = ground.altitude();
    let side = if plane > 0.0 { "above" } else { "below" };
    for (x, y, words) in [
        (
            12.0,
            24.0,
            "seen from the south-south-west, 32° above the horizon".to_owned(),
        ),
        (812.0, 24.0, "from above".to_owned()),
        (
            12.0,
            VIEWS + 18.0,
            format!("altitude over the start and attitude, every {along} s"),
        ),
    ] {
        let _ = writeln!(
            text,
            "<text class=\"title\" x=\"{x}\" y=\"{y}\">{words}</text>"
        );
    }
    let words = format!("a vehicle every {every} s, but where one stands already");
    label(&mut text, [12.0, VIEWS - 6.0], &words, "start");
    let words = format!(
        "ground drawn {} {side} the start, squares of {}",
        metres(plane.abs()),
        metres(ground.grid)
    );
    label(&mut text, [WIDE - 12.0, VIEWS - 6.0], &words, "end");
    legend(&mut text, [560.0, VIEWS + 18.0]);
    Drawn {
        size: [WIDE, HIGH],
        attributes: String::new(),
        body: text,
    }
}

/// What the colours are.
fn legend(text: &mut String, [mut x, y]: [f64; 2]) {
    for (class, words) in [
        (BACK, "flown; back of the vehicle"),
        (BELLY, "its belly"),
        ("orange area", "path (dashed)"),
        ("grey area", "track on the ground"),
    ] {
        let top = y - 9.0;
        let _ = writeln!(
            text,
            "<rect class=\"{class}\" x=\"{x}\" y=\"{top}\" width=\"14\" height=\"10\"/>"
        );
        label(text, [x + 20.0, y], words, "start");
        x += 44.0 + width(words, 14.0);
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
        let text = picture(&climb).body;
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
        assert!(picture(&windy).body.contains("mean wind 8.0 m/s"));
    }
}
