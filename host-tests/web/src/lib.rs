//! The library in the browser. `alula-sil view --live` puts it into a page.
//!
//! The page writes a request into [`request`] and calls [`open`], then [`fly`] for a whole flight, or [`step`] again and again for one that
//! is steered. Texts are UTF-8, numbers are doubles in rows of the scene's columns; both stay where they are until the next call.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

mod session;
mod sliders;
mod steered;

use std::cell::RefCell;

use session::Session;

thread_local! {
    static SESSION: RefCell<Session> = RefCell::default();
}

fn with<R>(of: impl FnOnce(&mut Session) -> R) -> R {
    SESSION.with_borrow_mut(of)
}

/// Does what may fail: 1, or 0 with the error as [`answer`].
fn done(of: impl FnOnce(&mut Session) -> anyhow::Result<()>) -> u32 {
    with(|session| {
        let done = of(session);
        if let Err(error) = &done {
            session.answer = format!("{error:#}");
        }
        done.is_ok().into()
    })
}

/// Room for a request of `length` bytes: JSON, `{"experiment": name, "set": ["path=value", …], "sliders": {name: value, …}, "steered": bool}`.
#[unsafe(no_mangle)]
pub extern "C" fn request(length: usize) -> *mut u8 {
    with(|session| {
        session.request = vec![0; length];
        session.request.as_mut_ptr()
    })
}

/// Takes the request: 1, with what it is of as [`answer`] (JSON), or 0 and why not.
#[unsafe(no_mangle)]
pub extern "C" fn open() -> u32 {
    done(Session::open)
}

/// Flies what is open from beginning to end: 1, with the numbers as [`numbers`], the plans as [`plans`] and the words as [`answer`], or 0 and why not.
#[unsafe(no_mangle)]
pub extern "C" fn fly() -> u32 {
    done(Session::fly)
}

/// Begins the flight of what is open, to be steered: 1, or 0 and why not.
#[unsafe(no_mangle)]
pub extern "C" fn begin() -> u32 {
    done(Session::begin)
}

/// The goal from now on: 1 to hover at a place \[m\], north, east and down; 2 to stop; 3 to fly at a velocity \[m/s\]; 4 to fly a
/// square of waypoints, as a mission, and come back.
#[unsafe(no_mangle)]
pub extern "C" fn goal(kind: u32, north: f64, east: f64, down: f64) -> u32 {
    done(|session| session.aim(kind, [north, east, down]))
}

/// Goes on by so many control steps: 1, with the new rows as [`numbers`], the new plans as [`plans`] and the words as [`answer`], or 0 and why not.
#[unsafe(no_mangle)]
pub extern "C" fn step(steps: u32) -> u32 {
    done(|session| session.step(steps))
}

/// Where the answer is.
#[unsafe(no_mangle)]
pub extern "C" fn answer() -> *const u8 {
    with(|session| session.answer.as_ptr())
}

/// How many bytes it has.
#[unsafe(no_mangle)]
pub extern "C" fn answer_length() -> usize {
    with(|session| session.answer.len())
}

/// Where the numbers are.
#[unsafe(no_mangle)]
pub extern "C" fn numbers() -> *const f64 {
    with(|session| session.scene.rows.as_ptr())
}

/// How many there are.
#[unsafe(no_mangle)]
pub extern "C" fn numbers_length() -> usize {
    with(|session| session.scene.rows.len())
}

/// Where the plans are: doubles, in rows of the scene's candidates.
#[unsafe(no_mangle)]
pub extern "C" fn plans() -> *const f64 {
    with(|session| session.scene.plans.as_ptr())
}

/// How many numbers they have.
#[unsafe(no_mangle)]
pub extern "C" fn plans_length() -> usize {
    with(|session| session.scene.plans.len())
}
