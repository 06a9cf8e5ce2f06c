//! Where the stall of a polar is taken, against where it is: polars made to look like published ones.

use std::fmt::Write as _;

use alula_sim::polar::{Polar, Upto, stall};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Polars of each kind.
const EACH: usize = 8;
/// Where the table stands.
const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/your-vehicle.md");

/// A way in which published polars differ from a textbook's.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Round,
    Sharp,
    SawTeeth,
    Bubble,
    Double,
    HighLift,
    Noise,
    EndRises,
    DeepStall,
    Late,
    Reflexed,
    DeadZone,
    SmallSlope,
    PlateRise,
    ThinPlateau,
    WholeWing,
    SteepFoot,
    EarlyBurst,
}

const KINDS: [(Kind, &str); 18] = [
    (Kind::Round, "round stall"),
    (Kind::Sharp, "sharp stall"),
    (Kind::SawTeeth, "saw-teeth of 0.05 to 0.15"),
    (
        Kind::Bubble,
        "a bubble bursts at 2° to 7°: a fall of 0.06 to 0.25",
    ),
    (Kind::Double, "double stall, the second higher"),
    (
        Kind::HighLift,
        "high lift, to 2.5, and high behind the stall",
    ),
    (Kind::Noise, "noise of ±0.02 to ±0.05"),
    (Kind::EndRises, "lift grows again at the end of the table"),
    (
        Kind::DeepStall,
        "whole circle, more lift at 45° than at the stall",
    ),
    (Kind::Late, "thick: stall at 18° to 25°, a bubble before"),
    (
        Kind::Reflexed,
        "reflexed: zero lift at 0.5° to 2.5°, a bubble before the stall",
    ),
    (Kind::DeadZone, "no lift up to 2° to 5°"),
    (
        Kind::SmallSlope,
        "a third of the slope, stall at 18° to 28°, a bubble before",
    ),
    (
        Kind::PlateRise,
        "saw-teeth, a fall by 0.2 to 0.5 of the lift, and a plate's rise above what was",
    ),
    (
        Kind::ThinPlateau,
        "thin: a plateau from 6° to 8° on, of 0.3 to 0.5 of the way up to it, noise to ±0.01, and a plate's rise",
    ),
    (
        Kind::WholeWing,
        "whole wing of an aspect ratio of 0.7 to 1.5, steeper up to its stall at 22° to 36°",
    ),
    (
        Kind::SteepFoot,
        "symmetric, lift of 0.1 to 0.2 more from 1° to 1.5° on, as at a Reynolds number of 1e5",
    ),
    (
        Kind::EarlyBurst,
        "0.1 to 0.12 per degree up to 2° to 5°, a fall of 0.15 to 0.25 over 1°, and attached flow of 0.095 to 0.105 per degree to the stall",
    ),
];

/// A polar, and what is known of it by its making.
struct Made {
    rows: Vec<[f64; 3]>,
    /// Angle of the stall \[°\]: the greatest lift of the rows up to where the flow leaves the wing.
    stall: f64,
    /// Angle up to which lift is held behind it \[°\].
    held: f64,
    /// Lift without noise, and the noise's amplitude.
    clean: Vec<f64>,
    noise: f64,
    /// Distance of the rows \[°\].
    step: f64,
}

/// Lift of attached flow up to its round top at `top` \[°\]: a straight line from `zero` on, and a parabola from 0.65 of the way.
fn attached(alpha: f64, slope: f64, zero: f64, top: f64) -> f64 {
    let bend = zero + 0.65 * (top - zero);
    match alpha {
        alpha if alpha <= bend => slope * (alpha - zero),
        alpha => {
            let (width, left) = (top - bend, (top - alpha) / (top - bend));
            slope * (bend - zero) + 0.5 * slope * width * (1.0 - left * left)
        }
    }
}

/// Lift of a plate across which the flow is separated (S. F. Hoerner, *Fluid-Dynamic Drag*, 1965).
fn separated(alpha: f64) -> f64 {
    let (sin, cos) = alpha.to_radians().sin_cos();
    cos / (0.222 + 0.283 / sin)
}

fn made(kind: Kind, seed: u64) -> Made {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
    let step: f64 = [0.1, 0.25, 0.5, 1.0][(4.0 * between(0.0, 1.0)) as usize];
    // A table has 512 rows at most.
    let step = if matches!(kind, Kind::DeepStall | Kind::WholeWing) {
        step.max(0.25)
    } else {
        step
    };
    let slope = match kind {
        Kind::SmallSlope => between(0.03, 0.05),
        Kind::WholeWing => between(0.025, 0.045),
        Kind::SteepFoot => between(0.075, 0.09),
        Kind::EarlyBurst => between(0.095, 0.105),
        _ => between(0.085, 0.108),
    };
    let (zero, stall) = match kind {
        Kind::Reflexed => (between(0.5, 2.5), between(9.0, 15.0)),
        Kind::DeadZone => (0.0, between(9.0, 15.0)),
        Kind::SmallSlope => (between(-3.0, 0.0), between(18.0, 28.0)),
        Kind::WholeWing => (between(-2.0, 0.0), between(22.0, 36.0)),
        Kind::SteepFoot => (0.0, between(9.0, 12.0)),
        Kind::EarlyBurst => (between(-1.0, 0.0), between(12.0, 14.0)),
        Kind::PlateRise => (between(-3.0, 0.0), between(7.0, 12.0)),
        Kind::ThinPlateau => (between(-3.0, 0.0), between(6.0, 8.0)),
        Kind::HighLift => (between(-12.0, -7.0), between(12.0, 17.0)),
        Kind::Late => (between(-2.0, 0.0), between(18.0, 25.0)),
        Kind::DeepStall => (between(-1.0, 0.0), between(7.0, 10.0)),
        _ => (between(-5.0, 0.0), between(9.0, 15.0)),
    };
    let rounded = |degrees: f64| ((degrees / step).round() * step * 1e6).round() / 1e6;
    let stall = rounded(stall);
    // Unslotted sections that stall so late have little lift there.
    let slope = match kind {
        Kind::Late => between(1.1, 1.45) / (0.825 * (stall - zero)),
        _ => slope,
    };
    let depth = match kind {
        Kind::SmallSlope => between(0.06, 0.12),
        Kind::EarlyBurst => between(0.15, 0.25),
        _ => between(0.06, 0.25),
    };
    let burst = match kind {
        Kind::Reflexed | Kind::SmallSlope => between(4.0, 7.0),
        Kind::EarlyBurst => between(2.0, 5.0),
        _ => between(2.0, 7.0),
    };
    let dead = between(2.0, 5.0);
    let (tooth, spacing) = (between(0.05, 0.15), between(1.2, 3.0));
    let second = stall;
    let first = stall - between(3.0, 6.0);
    let (kept, over) = (between(0.55, 0.8), between(1.0, 4.0));
    let plate = between(1.0, 1.25);
    let noise = match kind {
        Kind::Noise => between(0.02, 0.05),
        Kind::ThinPlateau => between(0.0, 0.01),
        _ => 0.0,
    };
    // Part of the lift that a deep fall leaves, what lift then rises to and over how many degrees, and how much of a plate's it is at most.
    let [left, more, rise, most] = match kind {
        Kind::PlateRise => [
            between(0.5, 0.8),
            between(1.0, 1.15),
            between(6.0, 12.0).max(16.0 - stall - over),
            between(0.85, 1.1),
        ],
        _ => [1.0; 4],
    };
    let straight = kind == Kind::PlateRise && between(0.0, 1.0) < 0.5;
    // Length of a plateau, and the part of the lift that it gains. A slender wing's secant grows.
    let [length, gained] = match kind {
        Kind::ThinPlateau => [
            rounded(between(0.3, 0.5) * (stall - zero)),
            between(-0.02, 0.03),
        ],
        _ => [0.0; 2],
    };
    let steeper = match kind {
        Kind::WholeWing => between(0.0, 0.5),
        _ => 0.0,
    };
    let [foot, reach] = match kind {
        Kind::SteepFoot => [between(0.1, 0.2), between(1.0, 1.5)],
        _ => [0.0, 1.0],
    };
    // Lift per degree before a laminar bubble bursts.
    let laminar = match kind {
        Kind::EarlyBurst => between(0.1, 0.12),
        _ => slope,
    };
    // From the angle of zero lift on, of either side.
    let side = |alpha: f64, zero: f64, stall: f64| -> f64 {
        // Of a laminar bubble that bursts: the fall, and from where it ends on the flow that is attached again.
        let again = |alpha: f64| {
            let fall = depth * (alpha - burst).min(1.0);
            let from = burst + 1.0;
            laminar * (burst - zero) - fall + attached(alpha.max(from), slope, from, stall)
        };
        let greatest = match kind {
            Kind::SteepFoot => attached(stall, slope, zero, stall) + foot,
            Kind::DeadZone => attached(stall, slope, dead, stall),
            Kind::EarlyBurst => again(stall),
            _ => attached(stall, slope, zero, stall),
        };
        let fallen = |greatest: f64, kept: f64, from: f64| {
            greatest * (1.0 - (1.0 - kept) * ((alpha - from) / over).min(1.0))
        };
        let behind = |from: f64| {
            // Lift falls to a part of the greatest, and then follows that of separated flow.
            let (kept, over) = match kind {
                Kind::Sharp => (0.9 * kept, 0.3 * over),
                Kind::HighLift => (0.85, 8.0),
                _ => (kept, over),
            };
            let part = 1.0 - (1.0 - kept) * ((alpha - from) / over).min(1.0);
            let separated = plate * (2.0 * alpha).to_radians().sin();
            let rises = match kind {
                Kind::EndRises => 0.5 * slope * (alpha - from - 8.0).max(0.0),
                _ => 0.0,
            };
            let held = greatest * part + rises.min(greatest * (0.97 - kept));
            match kind {
                Kind::DeepStall if alpha > from + over => {
                    separated.max(if alpha < 30.0 { greatest * kept } else { -9.0 })
                }
                _ => held,
            }
        };
        let held = stall + length;
        let gain = 1.0 + gained * ((alpha - stall) / length.max(1e-9)).clamp(0.0, 1.0);
        match kind {
            Kind::PlateRise if alpha > stall => {
                let fallen = fallen(greatest, left, stall);
                let on = alpha - stall - over;
                return match straight {
                    _ if on < 0.0 => fallen,
                    true => greatest * (left + (more - left) * (on / rise).min(1.0)),
                    // The fall is one of a fifth at least.
                    false => {
                        let most = (most * separated(alpha)).min(greatest * (0.8 + 0.06 * on));
                        fallen.max(most)
                    }
                };
            }
            Kind::ThinPlateau if alpha > held => {
                let fallen = fallen(greatest * gain, kept, held);
                return fallen.max((0.85 * separated(alpha)).min(0.9 * greatest));
            }
            Kind::ThinPlateau if alpha > stall => return greatest * gain,
            _ if alpha > stall => return behind(stall),
            _ => {}
        }
        let clean = attached(alpha, slope, zero, stall);
        match kind {
            // The last tooth ends where the wing stalls.
            Kind::SawTeeth | Kind::PlateRise => {
                let teeth = (stall - alpha) / spacing;
                clean
                    - tooth
                        * (1.0 - teeth.fract())
                        * f64::from(u8::from(teeth.fract() > 0.0))
                        * f64::from(u8::from(alpha > zero + 2.0))
            }
            Kind::Bubble | Kind::Late | Kind::Reflexed | Kind::SmallSlope if alpha > burst => {
                // The fall is made good for up to the stall.
                let left = (stall - alpha) / (stall - burst);
                clean - depth * left.sqrt()
            }
            Kind::EarlyBurst if alpha > burst => again(alpha),
            Kind::EarlyBurst => laminar * (alpha - zero),
            Kind::SteepFoot => clean + foot * ((alpha - zero) / reach).min(1.0),
            Kind::WholeWing => clean * (1.0 - steeper * (stall - alpha) / (stall - zero)),
            Kind::DeadZone => attached(alpha.max(dead), slope, dead, stall),
            Kind::Double if alpha > first => {
                let top = attached(first, slope, zero, stall);
                let dip = 0.07 + 0.5 * depth;
                let u = (alpha - first) / (second - first);
                top + (greatest - top) * u - dip * (std::f64::consts::PI * u).sin()
            }
            _ => clean,
        }
    };
    let [begin, end] = match kind {
        Kind::DeepStall => [-180.0, 180.0],
        Kind::EndRises | Kind::PlateRise => [-12.0, 30.0],
        Kind::ThinPlateau => [-12.0, 26.0],
        Kind::WholeWing => [-20.0, 40.0],
        Kind::HighLift | Kind::Late | Kind::SmallSlope => [-18.0, 32.0],
        _ => [-14.0, (stall + between(2.0, 8.0)).round()],
    };
    // The inverted stall is of the same kind, and comes sooner.
    let inverted = rounded(0.6 * (stall - zero) - zero);
    let lift = |alpha: f64| -> f64 {
        let upright = |alpha: f64| match alpha >= zero {
            true => side(alpha, zero, stall),
            false => -side(-alpha, -zero, inverted),
        };
        match alpha.abs() {
            magnitude if magnitude <= 90.0 => upright(alpha),
            magnitude if magnitude >= 179.999 => 0.0,
            // Tail first.
            _ => 0.7 * plate * (2.0 * alpha).to_radians().sin(),
        }
    };
    let held = rounded(stall + length);
    let far = if kind == Kind::DeepStall { 5.0 } else { step };
    let count = ((end - begin) / step).round() as i32;
    let angles = (0..=count).map(|n| begin + step * f64::from(n));
    // Rows of a whole circle are far apart where the flow is separated.
    let angles = angles.filter(|a| a.abs() < 30.0 || (a / far - (a / far).round()).abs() < 1e-9);
    let angles: Vec<f64> = angles.map(|a| (a * 1e6).round() / 1e6).collect();
    let short = |x: f64| (x * 1e4).round() / 1e4;
    let clean: Vec<f64> = angles.iter().map(|a| short(lift(*a))).collect();
    let rows = angles.iter().zip(&clean).map(|(a, lift)| {
        let drag = 0.012
            + 0.006 * lift * lift
            + 1.9 * (a.to_radians().sin().powi(2)) * f64::from(u8::from(a.abs() > stall));
        let wild = noise * (2.0 * between(0.0, 1.0) - 1.0);
        [*a, short(lift + wild), short(drag)]
    });
    Made {
        rows: rows.collect(),
        // The greatest lift of a plateau is at one of its ends.
        stall: if gained > 0.0 { held } else { stall },
        held,
        clean,
        noise,
        step,
    }
}

/// The polar as a file: of a section, or as XFLR5 writes that of a plane.
fn text(kind: Kind, rows: &[[f64; 3]]) -> String {
    let row = |[a, l, d]: &[f64; 3]| match kind {
        Kind::WholeWing => format!("{a} 0 {l} 0 {d} {d} 0\n"),
        _ => format!("{a} {l} {d}\n"),
    };
    let lines: String = rows.iter().map(row).collect();
    match kind {
        Kind::WholeWing => {
            format!("xflr5 v6.47\n Plane name : mine\n alpha Beta CL CDi CDv CD CY\n{lines}")
        }
        _ => format!("alpha CL CD\n{lines}"),
    }
}

/// Where the stall is taken in a polar of this kind, and whether that is where it is, in a cell of the table.
fn judged(kind: Kind, seed: u64) -> String {
    let made = made(kind, seed);
    let what = format!("{kind:?} {seed}");
    let at = stall(&made.rows).unwrap_or_else(|| panic!("{what}: nothing stalls"));
    let is = made
        .rows
        .iter()
        .position(|row| (row[0] - made.stall).abs() < 1e-6);
    let is = is.unwrap_or_else(|| panic!("{what}: no row at {}", made.stall));
    // Without noise it is that row, or one before it with the same four digits of lift. With noise another row may have more lift than that at the
    // stall, but not by more than the noise of both.
    let less = made.clean[is] - made.clean[at];
    assert!(
        less <= 2.0 * made.noise + 1e-9,
        "{what}: {less} at {}",
        made.rows[at][0]
    );

    // The whole way: the file is read, as a section and as a wing, which has the lift of the section at its stall.
    let polar =
        Polar::from_text("x", &text(kind, &made.rows)).unwrap_or_else(|e| panic!("{what}: {e:#}"));
    assert_eq!(
        polar
            .warnings()
            .iter()
            .filter(|w| w.contains("stall"))
            .count(),
        0,
        "{what}"
    );
    for ratio in [1.5, 2.0, 6.0, 20.0] {
        let (wing, story) = polar
            .finite(Some(ratio))
            .unwrap_or_else(|e| panic!("{what}: {e:#}"));
        let seam = wing.seam.unwrap();
        // The greatest lift is where it was; a whole wing is one already.
        let rows = wing.degrees();
        let lift = rows
            .iter()
            .find(|row| wing.stall_deg() == Some(row[0]))
            .map(|row| row[1]);
        assert_eq!(lift, Some(made.rows[at][1]), "{what}");
        if let Upto::Section([_, last]) = seam.upto {
            // The section's rows are used as long as lift is held, and no longer.
            let used = |row: &&[f64; 3]| (made.rows[at][0]..=last).contains(&row[0]);
            let least = made.rows.iter().filter(used).map(|row| row[1]);
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(least >= 0.95 * made.rows[at][1], "{what}: {last}");
            // Much noise hides where lift falls; of a wing of small span a little takes some rows, which go back.
            let lost = made.noise * (1.0 / (0.9 * std::f64::consts::PI * ratio)).to_degrees();
            assert!(
                kind == Kind::Noise || last >= made.held - 2.0 * lost - 2.0 * made.step,
                "{what}: {last} {}",
                made.held
            );
            assert!(
                story.iter().any(|s| s.contains("rows are left out")),
                "{what}: {story:?}"
            );
        } else {
            assert_eq!(kind, Kind::WholeWing);
        }
        // What is made of it is read again.
        let written = Polar::from_text("x", &wing.csv(&story));
        assert!(written.is_ok(), "{what} {ratio}: {:?}", written.err());
    }
    // Of infinite span, the same.
    assert_eq!(polar.stall_deg(), Some(made.rows[at][0]), "{what}");
    format!("{:.1} {:.1}", made.stall, made.rows[at][0])
}

/// A hundred polars and more. The table of docs/your-vehicle.md says where each stalls, and where that is taken to be.
#[test]
fn the_stall_is_where_lift_falls_for_good() {
    let mut table =
        "| polars | stall \\[°\\], as it is and as it is taken |\n|---|---|\n".to_owned();
    for (i, (kind, name)) in KINDS.into_iter().enumerate() {
        let cells: Vec<String> = (0..EACH)
            .map(|n| judged(kind, (EACH * i + n) as u64))
            .collect();
        let _ = writeln!(table, "| {name} | {} |", cells.join(", "));
    }
    println!("{table}");
    let page = std::fs::read_to_string(PAGE).unwrap();
    let begin = page.find("| polars | stall").expect("the table");
    let rest = &page[begin..];
    let length = rest.find("\n\n").map_or(rest.len(), |end| end + 1);
    if std::env::var_os("ALULA_WRITE_TABLES").is_some() {
        let page = format!("{}{table}{}", &page[..begin], &page[begin + length..]);
        std::fs::write(PAGE, page).unwrap();
        return;
    }
    assert!(
        page[begin..begin + length] == table,
        "docs/your-vehicle.md is not current: ALULA_WRITE_TABLES=1 cargo test -p alula-sil --test theory stalls::"
    );
}

/// A fall is that of a bubble or that of a stall by what lift comes back to: neither is taken for the other in many more draws.
#[test]
fn a_bubble_and_a_plate_are_told_apart() {
    for kind in [Kind::EarlyBurst, Kind::PlateRise] {
        for seed in 10_000..11_000 {
            let made = made(kind, seed);
            let at = made.rows[stall(&made.rows).unwrap()][0];
            assert!(
                (at - made.stall).abs() <= made.step,
                "{kind:?} {seed}: {at} for {}",
                made.stall
            );
        }
    }
}
