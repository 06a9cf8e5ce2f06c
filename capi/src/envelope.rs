//! The envelope: which attitudes hold a reference, and how far the next jump is.

use alula::ned::{BodyAxes, Quaternion};
use alula::planar::equilibrium::{Branch, CAPACITY};
use alula::planar::equilibrium::{Equilibria, Equilibrium, FoldMap};
use alula::planar::{Inertial, Reference};
use alula::spatial::{Ned, Orientation};

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::{Controller, initialised};
use crate::input::Input;

/// Most equilibria of a set.
pub const ALULA_EQUILIBRIA: u32 = 24;
const _: () = assert!(ALULA_EQUILIBRIA as usize == CAPACITY);

/// An attitude at which a thrust holds the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct EquilibriumAttitude {
    /// The attitude: quaternion (w, x, y, z) from the input's body axes to world.
    pub quaternion: [f32; 4],
    /// Angle of attack \[rad\].
    pub alpha: f32,
    /// Thrust \[N\]; it may be negative.
    pub thrust: f32,
    /// Apparent external force along the tail \[N\]: negative where it is against the thrust.
    pub t_p: f32,
    /// 1 if thrust is along the apparent external force, as the laws fly; 0 if it is against it.
    pub aligned: u32,
    /// 1 if it moves continuously with the reference; 0 at a fold.
    pub isolated: u32,
}

/// The attitudes that hold a reference, by increasing angle of attack.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct EquilibriumSet {
    /// `ALULA_HEADER(alula_equilibria)`.
    pub header: u32,
    /// How many there are.
    pub count: u32,
    /// The first `count` are set, the rest are zero.
    pub items: [EquilibriumAttitude; ALULA_EQUILIBRIA as usize],
}

/// How far the nearest fold is, with the directions of air velocity and apparent weight kept.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct FoldMargin {
    /// `ALULA_HEADER(alula_fold_margin)`.
    pub header: u32,
    /// Angle of attack at the fold, less the present one \[rad\].
    pub alpha: f32,
    /// Airspeed at the fold over the present one, squared.
    pub a: f32,
}

/// A map of the folds, from which the margin to the nearest is read: opaque memory of the caller's. Set `header`, then call
/// `alula_fold_map_init`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Map {
    /// `ALULA_HEADER(alula_fold_map)` before `alula_fold_map_init`.
    pub header: u32,
    /// Private.
    pub reserved: u32,
    /// Private.
    pub opaque: [u64; 384],
}

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32 and f32.
unsafe impl Layout for EquilibriumSet {}
// SAFETY: As above.
unsafe impl Layout for FoldMargin {}
// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but unsigned integers.
unsafe impl Layout for Map {}

/// The header word of a map that is initialised.
const INITIALISED: u32 = Map::HEADER | 1 << 31;

/// What is in a [`Map`] after `alula_fold_map_init`.
#[repr(C)]
struct Initialised {
    header: u32,
    map: FoldMap,
}

const _: () = assert!(size_of::<Initialised>() <= size_of::<Map>());
const _: () = assert!(align_of::<Initialised>() <= align_of::<Map>());

impl EquilibriumSet {
    /// No equilibrium.
    pub const EMPTY: Self = Self {
        header: Self::HEADER,
        count: 0,
        items: [EquilibriumAttitude {
            quaternion: [0.0; 4],
            alpha: 0.0,
            thrust: 0.0,
            t_p: 0.0,
            aligned: 0,
            isolated: 0,
        }; ALULA_EQUILIBRIA as usize],
    };
}

impl FoldMargin {
    /// No margin.
    pub const EMPTY: Self = Self {
        header: Self::HEADER,
        alpha: 0.0,
        a: 0.0,
    };
}

impl EquilibriumAttitude {
    /// Of an equilibrium whose θ is counted from `base`, about its right wing.
    fn new(e: &Equilibrium, base: &Orientation, axes: BodyAxes) -> Self {
        let Quaternion { w, x, y, z } = base.pitched(e.attitude).to_quaternion(axes);
        Self {
            quaternion: [w, x, y, z],
            alpha: e.alpha,
            thrust: e.thrust,
            t_p: e.t_p,
            aligned: u32::from(e.branch() == Branch::Aligned),
            isolated: u32::from(e.isolated),
        }
    }
}

/// The attitudes at which the reference of `input` can be held in its wind without sideslip, in a turn banked as its
/// reference acceleration asks. The plane of symmetry is then that of the air velocity asked for and the apparent
/// weight. Where these are parallel, as in hover, the belly stays on the side it has in `input`. Velocity is not read,
/// unless the air is given relative to it. Slower than a step, and of bounded work: for a background task. With any
/// code but `ALULA_OK` the set is empty.
///
/// # Safety
/// As `alula_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_equilibria_at(
    controller: *const Controller,
    input: *const Input,
    equilibria: *mut EquilibriumSet,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        boundary::answer(equilibria, EquilibriumSet::EMPTY, || {
            let controller = initialised(controller)?;
            let input = boundary::read(input)?;
            let axes = input.axes()?;
            let (state, reference) = (input.state(axes)?, input.reference());
            // The law checks its input, here for the set.
            let still = alula::spatial::State {
                velocity: Ned::ZERO,
                ..state
            };
            let control = controller.guidance.guidance().control();
            control.forces(&still, &reference).map_err(code::of_fault)?;
            let vehicle = controller.guidance.guidance().vehicle();
            let pull = Ned::new(0.0, 0.0, vehicle.gravity()) - reference.acceleration;
            let v_a = reference.velocity - state.wind;
            let o = &state.orientation;
            let base = [v_a, o.down(), o.forward()]
                .into_iter()
                .find_map(|side| Orientation::from_directions(-pull, side))
                .ok_or(code::ALULA_ERROR_EVERY_ORIENTATION)?;
            // In that plane the apparent weight is down, and what it exceeds gravity by is an acceleration upwards.
            let v_a = base.to_body(v_a);
            let weight = -base.to_body(pull).forward;
            let reference = Reference {
                velocity: Inertial::new(-v_a.forward, v_a.down),
                acceleration: Inertial::new(vehicle.gravity() - weight, 0.0),
            };
            let equilibria = Equilibria::find(vehicle, &reference, Inertial::ZERO)
                .map_err(code::of_equilibrium)?;
            let mut set = EquilibriumSet::EMPTY;
            for (item, equilibrium) in set.items.iter_mut().zip(equilibria.as_slice()) {
                *item = EquilibriumAttitude::new(equilibrium, &base, axes);
                set.count += 1;
            }
            Ok(set)
        })
    }
}

/// Makes `map` the one of the controller's vehicle. Slower than a step: once, after `alula_init`.
///
/// # Safety
/// Each pointer is null or points to memory of the caller's that holds at least the header word; the whole structure
/// if that is right. No other call uses the map meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_fold_map_init(map: *mut Map, controller: *const Controller) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        match map_initialised(map) {
            Ok(_) | Err(code::ALULA_ERROR_NOT_INITIALISED) => {}
            Err(code) => return code,
        }
        map.cast::<u32>().write(Map::HEADER);
        match initialised(controller) {
            Ok(controller) => {
                let value = FoldMap::new(controller.guidance.guidance().vehicle());
                (&raw mut (*map.cast::<Initialised>()).map).write(value);
                map.cast::<u32>().write(INITIALISED);
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}

/// How far the nearest fold is from the state of `input`, if it is to accelerate as the reference does: in a turn of load
/// factor n every fold lies at √n times its airspeed.
/// `ALULA_ERROR_NO_FOLD` says that there is none near; with any code but `ALULA_OK` the margin is zero.
///
/// # Safety
/// As `alula_step`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_fold_margin_at(
    map: *const Map,
    controller: *const Controller,
    input: *const Input,
    margin: *mut FoldMargin,
) -> i32 {
    // SAFETY: Every pointer that passes its check points to the structure that its header word says, by the condition above.
    unsafe {
        boundary::answer(margin, FoldMargin::EMPTY, || {
            let map = map_initialised(map)?;
            let controller = initialised(controller)?;
            let input = boundary::read(input)?;
            let state = input.state(input.axes()?)?;
            let control = controller.guidance.guidance().control();
            let forces = control
                .forces(&state, &input.reference())
                .map_err(code::of_fault)?;
            let margin = map.margin(&forces).ok_or(code::ALULA_ERROR_NO_FOLD)?;
            Ok(FoldMargin {
                header: FoldMargin::HEADER,
                alpha: margin.alpha,
                a: margin.a,
            })
        })
    }
}

/// The map that C points to.
///
/// # Safety
/// `pointer` is null, unaligned, or points to a map that nothing changes for `'a`.
unsafe fn map_initialised<'a>(pointer: *const Map) -> Result<&'a FoldMap, i32> {
    boundary::check_pointer(pointer)?;
    // SAFETY: The pointer is neither null nor unaligned, so it points to a header word. INITIALISED is written by
    // `alula_fold_map_init` alone, and only together with the rest of an `Initialised`.
    unsafe {
        match pointer.cast::<u32>().read() {
            INITIALISED => Ok(&(*pointer.cast::<Initialised>()).map),
            Map::HEADER => Err(code::ALULA_ERROR_NOT_INITIALISED),
            _ => Err(code::ALULA_ERROR_LAYOUT),
        }
    }
}
