//! Plans: at once, or one candidate at a time, apart from the step.

use alula::guidance::PlanSearch;

use crate::boundary::{self, Layout};
use crate::code;
use crate::controller::{Controller, initialised, initialised_mut};

/// A plan in the making: memory of the caller's. Set `header`, then call `alula_search_begin`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Search {
    /// `ALULA_HEADER(alula_search)`.
    pub header: u32,
    /// Result: 1 while there is a candidate to look at, 0 at the end.
    pub more: u32,
    /// Private.
    pub opaque: [u32; 34],
}

const _: () = assert!(PlanSearch::BYTES == 4 * 34);

// SAFETY: `repr(C)`, its first word is the header, and it holds nothing but u32.
unsafe impl Layout for Search {}

impl Search {
    fn core(&self) -> PlanSearch {
        let mut bytes = [0; PlanSearch::BYTES];
        for (place, word) in bytes.as_chunks_mut().0.iter_mut().zip(self.opaque) {
            *place = word.to_le_bytes();
        }
        PlanSearch::from_bytes(&bytes)
    }

    fn of(search: &PlanSearch, more: bool) -> Self {
        let bytes = search.to_bytes();
        let mut opaque = [0; 34];
        for (place, word) in opaque.iter_mut().zip(bytes.as_chunks().0) {
            *place = u32::from_le_bytes(*word);
        }
        Self {
            header: Self::HEADER,
            more: u32::from(more),
            opaque,
        }
    }
}

/// Makes the plan that `ALULA_STATUS_PLAN_DUE` asks for: the vehicle is flown ahead by the plan in force and by others.
/// The next step goes on by the best of them. It takes some twenty times the instructions of `alula_guide`. Without
/// plans the vehicle flies on by the last one: it follows what it can without crossing a stall.
///
/// # Safety
/// As `alula_guide`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_plan(controller: *mut Controller) -> i32 {
    // SAFETY: As in `alula_guide`.
    match unsafe { initialised_mut(controller) } {
        Ok(controller) => {
            controller.guidance.plan(&mut controller.memory.state);
            code::ALULA_OK
        }
        Err(code) => code,
    }
}

/// Begins a plan apart from the controller, for a task of lower priority, or for one candidate a step. `alula_plan` is this,
/// `alula_search_look` while `more` is 1, and `alula_search_adopt`.
///
/// # Safety
/// `controller` and `search` are null, unaligned, or point to their structures, which no other call changes meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_search_begin(
    controller: *const Controller,
    search: *mut Search,
) -> i32 {
    // SAFETY: By the condition above.
    unsafe {
        if let Err(code) = boundary::check(search) {
            return code;
        }
        match initialised(controller) {
            Ok(controller) => {
                let begun = controller.guidance.search(&controller.memory.state);
                search.write(Search::of(&begun, true));
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}

/// Looks at the plan in force, or at one candidate more: at most one flight ahead. Of the controller it reads what
/// `alula_init` has left, and no step changes: `alula_guide` may interrupt it.
///
/// # Safety
/// As `alula_search_begin`, but `alula_guide` may change the controller meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_search_look(
    controller: *const Controller,
    search: *mut Search,
) -> i32 {
    // SAFETY: By the condition above. The guidance itself is not changed by a step.
    unsafe {
        let given = match boundary::read(search) {
            Ok(given) => given,
            Err(code) => return code,
        };
        match initialised(controller) {
            Ok(controller) => {
                let mut core = given.core();
                let more = controller.guidance.look(&mut core).is_some();
                search.write(Search::of(&core, more));
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}

/// Flies by what a search found from the next step on. A search that began more than 0.3 s ago, or before `alula_reset`, changes
/// nothing.
///
/// # Safety
/// As `alula_guide`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn alula_search_adopt(
    controller: *mut Controller,
    search: *const Search,
) -> i32 {
    // SAFETY: As in `alula_guide`.
    unsafe {
        let given = match boundary::read(search) {
            Ok(given) => given,
            Err(code) => return code,
        };
        match initialised_mut(controller) {
            Ok(controller) => {
                let state = &mut controller.memory.state;
                controller.guidance.adopt(state, &given.core());
                code::ALULA_OK
            }
            Err(code) => code,
        }
    }
}
