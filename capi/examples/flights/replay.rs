//! Replays a trace of `hover_to_cruise` or `eight` through the core itself, past the C ABI, and compares the bits of every
//! command with what a C program's `replay` of the same trace has printed.
//!
//! ```text
//! cargo run --package alula-capi --example replay -- TRACE COMMANDS
//! ```
#![cfg(not(target_os = "none"))]

use std::error::Error;
use std::mem::offset_of;

use alula::guidance::Air;
use alula::ned::{BodyAxes, Frd, Ned, Quaternion};
use alula::planar::{GainParameters, Gains};
use alula::spatial::{self, Heading, Orientation};
use alula::{
    BandwidthGains, Combined, CombinedParameters, GainChoice, Guidance, GuidanceInput,
    GuidanceParameters, GuidanceState, Parameters, Vehicle, VehicleParameters,
};
use alula_capi::{
    ALULA_GAINS_CONSTANT, ALULA_POSITION, ALULA_SPECIFIC_FORCE, Command, ControllerParameters,
    Input, Report,
};

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// The words of a line: those of C structures after their headers.
struct Words(Vec<u32>);

impl Words {
    fn word(&self, at: usize) -> Result<u32> {
        Ok(*self.0.get(at).ok_or("the line is too short")?)
    }

    fn number(&self, at: usize) -> Result<f32> {
        Ok(f32::from_bits(self.word(at)?))
    }

    /// Three numbers of an input, from the field at `offset` on.
    fn vector(&self, offset: usize) -> Result<Ned> {
        let at = offset / 4 - 1;
        Ok(Ned::new(
            self.number(at)?,
            self.number(at + 1)?,
            self.number(at + 2)?,
        ))
    }

    /// A table of parameters, from word `at` on, which is moved behind it.
    fn parameters<P: Parameters>(&self, at: &mut usize) -> Result<P> {
        let mut p = P::DEFAULT;
        for row in 0..P::ROWS.len() {
            p.set(row, self.number(*at)?);
            *at += 1;
        }
        Ok(p)
    }
}

type Controller = Guidance<Combined, GainChoice>;

/// The controller of an `alula_parameters`' words.
fn controller(words: &Words) -> Result<Controller> {
    let at = &mut 0;
    let controller: ControllerParameters = words.parameters(at)?;
    let vehicle: VehicleParameters = words.parameters(at)?;
    let guidance: GuidanceParameters = words.parameters(at)?;
    let gains: GainParameters = words.parameters(at)?;
    let coefficients: CombinedParameters = words.parameters(at)?;
    let vehicle = Vehicle::new(vehicle, Combined::new(coefficients)?)?;
    let gains = if controller.gains == ALULA_GAINS_CONSTANT as f32 {
        GainChoice::Constant(Gains::new(gains)?)
    } else {
        GainChoice::Bandwidth(BandwidthGains::new(&guidance, &vehicle)?)
    };
    Ok(Guidance::with_gains(vehicle, gains, &guidance)?)
}

/// The input of an `alula_input`'s words: fixed-wing axes, known wind.
fn input(words: &Words) -> Result<GuidanceInput> {
    let flags = words.word(0)?;
    if flags & !(ALULA_POSITION | ALULA_SPECIFIC_FORCE) != 0 || words.word(1)? != 0 {
        return Err("another kind of input than the programs leave".into());
    }
    let at = offset_of!(Input, quaternion) / 4 - 1;
    let q = Quaternion {
        w: words.number(at)?,
        x: words.number(at + 1)?,
        y: words.number(at + 2)?,
        z: words.number(at + 3)?,
    };
    let force = words.vector(offset_of!(Input, specific_force))?;
    let position = words.vector(offset_of!(Input, position_error))?;
    Ok(GuidanceInput::default()
        .velocity(words.vector(offset_of!(Input, velocity))?)
        .orientation(Orientation::from_quaternion(&q, BodyAxes::NoseForward)?)
        .state_age(0.0)
        .air(Air::Wind(words.vector(offset_of!(Input, air))?))
        .specific_force(
            (flags & ALULA_SPECIFIC_FORCE != 0)
                .then(|| Frd::new(force.north, force.east, force.down)),
        )
        .position_error((flags & ALULA_POSITION != 0).then_some(position))
        .reference(spatial::Reference {
            velocity: words.vector(offset_of!(Input, reference_velocity))?,
            acceleration: words.vector(offset_of!(Input, reference_acceleration))?,
            heading: Heading::from_angle(words.number(offset_of!(Input, heading) / 4 - 1)?),
        })
        .reference_age(0.0))
}

/// One step of the law or of the guidance.
fn fly(
    letter: &str,
    controller: &Controller,
    state: &mut GuidanceState,
    input: &GuidanceInput,
) -> Result<spatial::Command> {
    if letter == "g" {
        let output = controller.update(state, input, 0.01);
        if output.plan_due {
            controller.plan(state);
        }
        return Ok(output.command);
    }
    let Air::Wind(wind) = input.air else {
        return Err("no wind".into());
    };
    let at = spatial::State {
        velocity: input.velocity,
        orientation: input.orientation,
        wind,
        ..spatial::State::default()
    };
    Ok(controller.control().robust(&at, &input.reference, None)?)
}

/// A number of a command.
struct Number {
    name: &'static str,
    /// Its place among the words of a line of commands.
    place: usize,
    value: f32,
}

/// The core's numbers of a command.
fn numbers(command: &spatial::Command) -> [Number; 9] {
    let d = &command.diagnostics;
    let given = |offset: usize| offset / 4 - 1;
    let told = |offset: usize| size_of::<Command>() / 4 - 1 + offset / 4 - 1;
    let number = |name, place, value| Number { name, place, value };
    let rate = given(offset_of!(Command, body_rate));
    [
        number("thrust", given(offset_of!(Command, thrust)), command.thrust),
        number("roll rate", rate, command.rates.roll),
        number("pitch rate", rate + 1, command.rates.pitch),
        number("yaw rate", rate + 2, command.rates.yaw),
        number("alpha", told(offset_of!(Report, alpha)), d.plane.alpha),
        number("sideslip", told(offset_of!(Report, sideslip)), d.sideslip()),
        number("tilt", told(offset_of!(Report, tilt)), d.tilt()),
        number(
            "f_p_norm",
            told(offset_of!(Report, f_p_norm)),
            d.plane.f_p_norm,
        ),
        number("t_p", told(offset_of!(Report, t_p)), d.plane.t_p),
    ]
}

fn parse(line: &str) -> Result<(&str, Words)> {
    let mut items = line.split(' ');
    let letter = items.next().unwrap_or_default();
    let words: std::result::Result<_, _> = items.map(|w| u32::from_str_radix(w, 16)).collect();
    Ok((letter, Words(words?)))
}

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let mut read = || {
        let path = arguments.next().ok_or("usage: replay TRACE COMMANDS")?;
        let text = std::fs::read_to_string(&path).map_err(|e| format!("{path}: {e}"))?;
        Ok::<_, Box<dyn Error>>((path, text))
    };
    let ((path, trace), (commands_path, commands)) = (read()?, read()?);
    let mut core: Option<(Controller, GuidanceState)> = None;
    let mut commands = commands.lines();
    let mut compared = 0;
    for (n, line) in trace.lines().enumerate() {
        let place = |e: Box<dyn Error>| format!("{path}:{}: {e}", n + 1);
        let (letter, words) = parse(line).map_err(place)?;
        if letter == "c" {
            core = Some((controller(&words).map_err(place)?, GuidanceState::default()));
            continue;
        }
        if !["s", "g"].contains(&letter) {
            return Err(place("not a line of a trace".into()).into());
        }
        let (controller, state) = core.as_mut().ok_or("no parameters come first")?;
        let command = input(&words)
            .and_then(|input| fly(letter, controller, state, &input))
            .map_err(place)?;
        compared += 1;
        let place = |e: Box<dyn Error>| format!("{commands_path}:{compared}: {e}");
        let line = commands.next().ok_or("there are fewer than in the trace");
        let (same, got) = parse(line.map_err(|e| place(e.into()))?).map_err(place)?;
        if same != letter {
            return Err(place("another sort than in the trace".into()).into());
        }
        for wanted in numbers(&command) {
            let got = got.number(wanted.place).map_err(place)?;
            let Number { name, value, .. } = wanted;
            if got.to_bits() != value.to_bits() {
                let difference = format!("{name} is {got:e}, and {value:e} from Rust");
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
