//! The guidance over sequences of frames, with its memory changed between steps.
//!
//! What must hold: every command finite and inside the limits; no memory called corrupt that was not touched; one changed
//! number of the hardened memory undone; the bare guidance gives the same command, or one inside the limits where more has
//! changed; and after good frames for the recovery time and two steps more the guidance flies, if one
//! fresh from power-on does.

use alula::guidance::{Air, GuidanceParameters, Mode, PlannerOptions, RejectReason, Status};
use alula::ned::{BodyAxes, Frd, Quaternion};
use alula::planar::PlanarGuidanceInput;
use alula::spatial::{Heading, Ned, Orientation, Reference};
use alula::{Fault, Guidance, GuidanceInput, GuidanceOutput, Hardened, HardenedState, Model};

use crate::assert_finite;
use crate::bytes::Bytes;

type Memory = [u8; HardenedState::BYTES];

/// Frames at most: a longer sequence finds nothing new, and slows the search.
const FRAMES: usize = 64;
/// Step of the good frames at the end [s].
const DT: f32 = 0.1;

pub fn run(data: &[u8]) -> u64 {
    crate::vehicle::with(&mut Bytes::new(data), |bytes, vehicle| {
        let p = bytes.parameters(GuidanceParameters::default());
        match Guidance::new(vehicle, &p) {
            Ok(guidance) => fly(&Hardened::new(guidance), &p, bytes, &mut |_, _, _| ()),
            Err(_) => 1,
        }
    })
    .unwrap_or(1)
}

/// A call of the guidance: the memory before it, the frame, and the time step.
type Call<'a> = &'a mut dyn FnMut(&HardenedState, &GuidanceInput, f32);

/// What a guidance is made of.
#[cfg(feature = "boundaries")]
pub struct Made {
    pub vehicle: alula::VehicleParameters,
    pub model: alula::ModelParameters,
    pub parameters: GuidanceParameters,
}

/// Of what the input's guidance is made, and its calls without those at the end; nothing of one with a table.
#[cfg(feature = "boundaries")]
pub fn calls(data: &[u8], call: Call) -> Option<Made> {
    let mut bytes = Bytes::new(data);
    let (vehicle, model) = crate::vehicle::parameters(&mut bytes)?;
    let parameters = bytes.parameters(GuidanceParameters::default());
    let of = alula::Vehicle::new(vehicle, model.model().ok()?).ok()?;
    let guidance = Hardened::new(Guidance::new(of, &parameters).ok()?);
    fly(&guidance, &parameters, &mut bytes, call);
    Some(Made {
        vehicle,
        model,
        parameters,
    })
}

fn fly(
    hardened: &Hardened<Guidance<Model>>,
    p: &GuidanceParameters,
    bytes: &mut Bytes,
    call: Call,
) -> u64 {
    let guidance = hardened.guidance();
    let mut state = HardenedState::default();
    let mut calls = 0;
    for _ in 0..FRAMES {
        if bytes.is_empty() {
            break;
        }
        let change = Change::of(bytes, &mut state);
        let input = input(bytes);
        let dt = match bytes.byte() {
            0..=15 => bytes.number(0.3),
            _ => bytes.between(1e-4, 0.2),
        };
        let untouched = state;
        call(&state, &input, dt);
        let guided = hardened.update(&mut state, &input, dt);
        let mut bare = *untouched.guidance();
        let unhardened = guidance.update(&mut bare, &input, dt);
        if guided.plan_due {
            hardened.plan(&mut state);
        }
        if unhardened.plan_due {
            guidance.plan(&mut bare);
        }
        calls += 2;
        check(guidance, p, &guided);
        let reset = guided.status.contains(Status::STATE_RESET);
        match change {
            Change::None => {
                assert!(!reset, "a reset without a reason");
                assert_eq!(bits(&guided), bits(&unhardened));
                assert_eq!(bare.to_bytes(), state.guidance().to_bytes());
            }
            Change::One(before) => {
                // The step is that of the memory there was, to the bit.
                let mut state_before = before;
                let expected = hardened.update(&mut state_before, &input, dt);
                if expected.plan_due {
                    hardened.plan(&mut state_before);
                }
                calls += 1;
                assert_eq!(bits(&guided), bits(&expected), "{untouched:?}");
                assert_eq!(state_before.to_bytes(), state.to_bytes());
            }
            Change::Any => check(guidance, p, &unhardened),
        }
    }
    calls + recover(hardened, p, state)
}

/// What was done to the memory before a step.
enum Change {
    None,
    /// One number was changed; this was the memory before.
    One(HardenedState),
    /// Anything.
    Any,
}

impl Change {
    fn of(bytes: &mut Bytes, state: &mut HardenedState) -> Self {
        let before = *state;
        let mut memory = before.to_bytes();
        let change = match bytes.byte() {
            0..=31 => {
                let bit = bytes.word() as usize % (8 * memory.len());
                memory[bit / 8] ^= 1 << (bit % 8);
                Self::One(before)
            }
            32..=47 => {
                let word = bytes.word() as usize % (memory.len() / 4);
                memory[4 * word..][..4].copy_from_slice(&bytes.array::<4>());
                Self::One(before)
            }
            48..=55 => {
                for _ in 0..bytes.byte() {
                    let bit = bytes.word() as usize % (8 * memory.len());
                    memory[bit / 8] ^= 1 << (bit % 8);
                }
                Self::Any
            }
            56..=71 => {
                for _ in 0..=bytes.byte() % 4 {
                    let word = bytes.word() as usize % (memory.len() / 8);
                    let value = bytes.number(10.0).to_le_bytes();
                    memory[4 * word..][..4].copy_from_slice(&value);
                }
                memory = sealed(memory);
                Self::Any
            }
            72..=79 => {
                memory = sealed(bytes.array());
                Self::Any
            }
            80..=83 => {
                memory = bytes.array();
                Self::Any
            }
            _ => return Self::None,
        };
        *state = HardenedState::from_bytes(&memory);
        change
    }
}

/// These bytes with the copy and the check word that belong to them, as if the check had missed the change: so that the
/// bounds behind it are attacked too.
fn sealed(memory: Memory) -> Memory {
    let mut memory = HardenedState::from_bytes(&memory).to_bytes();
    let words = (memory.len() / 4 - 1) / 2;
    let (left, rest) = memory.split_at_mut(4 * words);
    let (copy, check) = rest.split_at_mut(4 * words);
    copy.copy_from_slice(left);
    let sum = left.as_chunks().0.iter().fold(0u32, |sum, word| {
        sum.rotate_left(7) ^ u32::from_le_bytes(*word)
    });
    check.copy_from_slice(&sum.to_le_bytes());
    memory
}

/// A frame: mostly ordinary, in parts of any bits.
pub(crate) fn input(bytes: &mut Bytes) -> GuidanceInput {
    let age = |bytes: &mut Bytes| match bytes.byte() {
        0..=23 => bytes.number(1.0),
        _ => 0.0,
    };
    let kind = bytes.byte();
    if kind < 64 {
        return GuidanceInput::from(&planar(bytes));
    }
    GuidanceInput::default()
        .velocity(ned(bytes, 30.0))
        .orientation(orientation(bytes))
        .state_age(age(bytes))
        .air(match bytes.byte() % 3 {
            0 => Air::Velocity(ned(bytes, 30.0)),
            1 => Air::Wind(ned(bytes, 15.0)),
            _ => Air::Unknown,
        })
        .specific_force(match bytes.byte() % 2 {
            0 => None,
            _ => Some(Frd::new(
                bytes.number(30.0),
                bytes.number(10.0),
                bytes.number(30.0),
            )),
        })
        .position_error(match bytes.byte() % 4 {
            0 => None,
            _ => Some(ned(bytes, 50.0)),
        })
        .reference(Reference {
            velocity: ned(bytes, 30.0),
            acceleration: ned(bytes, 10.0),
            heading: Heading::from_angle(match bytes.byte() % 2 {
                0 => f32::NAN,
                _ => bytes.number(4.0),
            }),
        })
        .reference_age(age(bytes))
        // Of the byte that says which kind of frame it is: what follows in the corpus is read as ever.
        .planner_options(
            PlannerOptions::default()
                .altitude_band(match kind {
                    240.. => bytes.number(1.0),
                    _ => 0.0,
                })
                .nose_below_vertical(kind % 8 == 7)
                .hold_altitude_only(kind % 16 > 13),
        )
}

/// A frame in one vertical plane, whose attitude may be none.
fn planar(bytes: &mut Bytes) -> PlanarGuidanceInput {
    let position = bytes.inertial(50.0);
    PlanarGuidanceInput::default()
        .velocity(bytes.inertial(30.0))
        .attitude(bytes.attitude())
        .air(Air::Velocity(bytes.inertial(30.0)))
        .position_error((bytes.byte() % 4 > 0).then_some(position))
        .reference(alula::planar::Reference {
            velocity: bytes.inertial(30.0),
            acceleration: bytes.inertial(10.0),
        })
}

fn ned(bytes: &mut Bytes, size: f32) -> Ned {
    Ned::new(bytes.number(size), bytes.number(size), bytes.number(size))
}

/// Any attitude; nose up where the bytes make none.
fn orientation(bytes: &mut Bytes) -> Orientation {
    let raw = [(); 4].map(|()| bytes.between(-1.0, 1.0));
    let length = raw.iter().map(|c| c * c).sum::<f32>().sqrt();
    let [w, x, y, z] = raw.map(|c| c / length);
    Orientation::from_quaternion(&Quaternion { w, x, y, z }, BodyAxes::NoseUp).unwrap_or_default()
}

fn bits(guided: &GuidanceOutput) -> ([u32; 4], Mode) {
    let c = guided.command;
    let numbers = [c.thrust, c.rates.roll, c.rates.pitch, c.rates.yaw];
    (numbers.map(f32::to_bits), guided.mode)
}

fn check(guidance: &Guidance<Model>, p: &GuidanceParameters, guided: &GuidanceOutput) {
    let vehicle = guidance.vehicle();
    let (thrust, rates) = (guided.command.thrust, guided.command.rates);
    assert!(
        (vehicle.thrust_min()..=vehicle.thrust_max()).contains(&thrust),
        "{guided:?}"
    );
    for rate in [rates.roll, rates.pitch, rates.yaw] {
        assert!(rate.abs() <= p.max_rate, "{guided:?}");
    }
    for v in [guided.reference.velocity, guided.reference.acceleration] {
        assert_finite(&[v.north, v.east, v.down]);
    }
    let (m, d) = (guided.margin, guided.command.diagnostics);
    assert_finite(&[
        m.force,
        m.k,
        m.fold,
        d.plane.f_p_norm,
        d.plane.t_p,
        d.plane.alpha,
    ]);
    assert_finite(&[d.v_a.right, d.aerodynamic.right, d.tilt()]);
    assert_eq!(guided.mode != Mode::Flying, d.plane.k == 0.0);
    assert!(guided.mode != Mode::Flying || guided.reject_reason.is_none());
}

/// Good frames, until the guidance flies as one fresh from power-on does.
fn recover(
    guidance: &Hardened<Guidance<Model>>,
    p: &GuidanceParameters,
    mut state: HardenedState,
) -> u64 {
    let hover = GuidanceInput::default().air(Air::Wind(Ned::ZERO));
    let mut fresh = HardenedState::default();
    let frames = (p.recovery / DT) as u64 + 2;
    let (mut modes, mut undefined) = ((Mode::Safe, Mode::Safe), false);
    for _ in 0..frames {
        let guided = guidance.update(&mut state, &hover, DT);
        check(guidance.guidance(), p, &guided);
        // The wind remembered may be one in which an absurd vehicle has no command; a fresh memory has none.
        undefined |= guided.reject_reason == Some(RejectReason::Law(Fault::Undefined));
        modes = (guided.mode, guidance.update(&mut fresh, &hover, DT).mode);
    }
    assert!(modes.0 == Mode::Flying || modes.1 != Mode::Flying || undefined);
    2 * frames
}
