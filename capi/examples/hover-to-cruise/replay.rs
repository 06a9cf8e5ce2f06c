//! Replays a trace of `hover_to_cruise` through the core itself, past the C ABI, and compares the bits of every command
//! with what a C program's `replay` of the same trace has printed.
//!
//! ```text
//! cargo run --package alula-capi --example replay -- TRACE COMMANDS
//! ```
#![cfg(not(target_os = "none"))]

use std::error::Error;
use std::mem::offset_of;

use alula::ned::{BodyAxes, Ned, Quaternion, VerticalPlane};
use alula::{
    Attitude, Combined, CombinedParameters, GainParameters, Gains, Inertial, Reference, State,
    Vehicle, VehicleParameters, VelocityControl,
};
use alula_capi::{NedCommand, NedReport};

/// The numbers of a line, by the words of a C structure after its header.
struct Words(Vec<u32>);

impl Words {
    fn number(&self, at: usize) -> Result<f32, Box<dyn Error>> {
        let word = self.0.get(at).ok_or("the line is too short")?;
        Ok(f32::from_bits(*word))
    }

    fn numbers<const N: usize>(&self, at: usize) -> Result<[f32; N], Box<dyn Error>> {
        let mut numbers = [0.0; N];
        for (n, number) in numbers.iter_mut().enumerate() {
            *number = self.number(at + n)?;
        }
        Ok(numbers)
    }

    fn inertial(&self, at: usize) -> Result<Inertial, Box<dyn Error>> {
        let [down, forward] = self.numbers(at)?;
        Ok(Inertial::new(down, forward))
    }

    fn ned(&self, at: usize) -> Result<Ned, Box<dyn Error>> {
        let [north, east, down] = self.numbers(at)?;
        Ok(Ned::new(north, east, down))
    }
}

/// The controller that flew the trace.
fn control() -> Result<VelocityControl<Combined>, Box<dyn Error>> {
    let model = Combined::new(CombinedParameters::PAPER_BELIEF)?;
    let vehicle = Vehicle::new(VehicleParameters::PAPER_BELIEF, model)?;
    Ok(VelocityControl::new(
        vehicle,
        Gains::new(GainParameters::PAPER)?,
    ))
}

/// State and reference of an `alula_ned_input`'s words: flags, axes, attitude, heading, pitch, then vectors.
fn ned(words: &Words) -> Result<(State, Reference), Box<dyn Error>> {
    let plane = VerticalPlane::from_heading(words.number(3)?);
    let [w, x, y, z] = words.numbers(5)?;
    let projection = plane
        .attitude(&Quaternion { w, x, y, z }, BodyAxes::NoseForward)
        .ok_or("no attitude")?;
    Ok((
        State {
            velocity: plane.project(words.ned(9)?).0,
            attitude: projection.attitude,
            wind: plane.project(words.ned(12)?).0,
        },
        Reference {
            velocity: plane.project(words.ned(15)?).0,
            acceleration: plane.project(words.ned(18)?).0,
        },
    ))
}

/// State and reference of an `alula_input`'s words: flags, then vectors.
fn plane(words: &Words) -> Result<(State, Reference), Box<dyn Error>> {
    let [cos, sin] = words.numbers(3)?;
    Ok((
        State {
            velocity: words.inertial(1)?,
            attitude: Attitude { cos, sin },
            wind: words.inertial(5)?,
        },
        Reference {
            velocity: words.inertial(7)?,
            acceleration: words.inertial(9)?,
        },
    ))
}

/// The core's numbers of a command, each with its place among the words of a line: those of the C structures after their
/// headers, of `alula_command`, or of `alula_ned_command` and then `alula_ned_report`.
fn numbers(command: &alula::Command, letter: &str) -> [(&'static str, usize, f32); 6] {
    let d = &command.diagnostics;
    let word = |offset: usize| offset / 4 - 1;
    let places = if letter == "n" {
        let reported = |offset: usize| word(size_of::<NedCommand>()) + word(offset);
        [
            word(offset_of!(NedCommand, thrust)),
            word(offset_of!(NedCommand, pitch_rate)),
            reported(offset_of!(NedReport, alpha)),
            reported(offset_of!(NedReport, f_p_norm)),
            reported(offset_of!(NedReport, t_p)),
            reported(offset_of!(NedReport, k)),
        ]
    } else {
        [
            offset_of!(alula_capi::Command, thrust),
            offset_of!(alula_capi::Command, rate),
            offset_of!(alula_capi::Command, alpha),
            offset_of!(alula_capi::Command, f_p_norm),
            offset_of!(alula_capi::Command, t_p),
            offset_of!(alula_capi::Command, k),
        ]
        .map(word)
    };
    let [thrust, rate, alpha, f_p_norm, t_p, k] = places;
    [
        ("thrust", thrust, command.thrust),
        ("rate", rate, command.rate),
        ("alpha", alpha, d.alpha),
        ("f_p_norm", f_p_norm, d.f_p_norm),
        ("t_p", t_p, d.t_p),
        ("k", k, d.k),
    ]
}

fn parse(line: &str) -> Result<(&str, Words), Box<dyn Error>> {
    let mut items = line.split(' ');
    let letter = items.next().unwrap_or_default();
    let words: Result<_, _> = items.map(|w| u32::from_str_radix(w, 16)).collect();
    Ok((letter, Words(words?)))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut read = || {
        let path = arguments.next().ok_or("usage: replay TRACE COMMANDS")?;
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{path}: {e}"))?;
        Ok::<_, Box<dyn Error>>((path, text))
    };
    let ((path, trace), (commands_path, commands)) = (read()?, read()?);
    let control = control()?;
    let mut commands = commands.lines();
    let mut compared = 0;
    for (n, line) in trace.lines().enumerate() {
        let place = |e: Box<dyn Error>| format!("{path}:{}: {e}", n + 1);
        let (letter, words) = parse(line).map_err(place)?;
        let (state, reference) = match letter {
            "c" => continue,
            "n" => ned(&words),
            "p" => plane(&words),
            _ => Err("not a line of a trace".into()),
        }
        .map_err(place)?;
        let command = control
            .robust(&state, &reference, None)
            .map_err(|e| place(e.into()))?;
        compared += 1;
        let place = |e: Box<dyn Error>| format!("{commands_path}:{compared}: {e}");
        let line = commands.next().ok_or("there are fewer than in the trace");
        let (same, got) = parse(line.map_err(|e| place(e.into()))?).map_err(place)?;
        if same != letter {
            return Err(place("another sort than in the trace".into()).into());
        }
        for (name, at, wanted) in numbers(&command, letter) {
            let got = got.number(at).map_err(place)?;
            if got.to_bits() != wanted.to_bits() {
                let difference = format!("{name} is {got:e}, and {wanted:e} from Rust");
                return Err(place(difference.into()).into());
            }
        }
    }
    if commands.next().is_some() {
        return Err(format!("{commands_path}: more than in the trace").into());
    }
    println!("{compared} commands, bit for bit");
    Ok(())
}
