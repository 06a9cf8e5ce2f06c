//! The C ABI of alula: check, convert, call.
//!
//! The interface of a C or C++ autopilot is `include/alula.h`, generated from this crate; `docs/integrating.md` tells
//! how to use it. Nothing here allocates, has a global or panics, and nothing unwinds into the caller. The caller owns
//! every structure. All are plain numbers of fixed size, and begin with a header word. It holds the version of the ABI
//! and the size of the structure as the caller's compiler saw it.
#![no_std]
#![deny(unsafe_op_in_unsafe_fn)]

// Where panics unwind, in tests and debug builds on a host, the standard library brings what they need.
#[cfg(panic = "unwind")]
extern crate std;

mod boundary;
mod code;
mod command;
mod controller;
mod decimal;
mod envelope;
mod for_vehicle;
mod goal;
mod guide;
mod input;
mod memory;
mod mission;
mod parameters;
mod path;
mod plan;
mod report;
mod step;
mod table;

pub use boundary::{ALULA_ABI_VERSION, Layout, alula_abi_version};
pub use code::*;
pub use command::{Command, alula_command_default};
pub use controller::{Controller, alula_init, alula_reset};
pub use envelope::*;
pub use for_vehicle::alula_parameters_for_vehicle;
pub use goal::*;
pub use guide::{alula_guide, alula_take_over};
pub use input::*;
pub use mission::*;
pub use parameters::{
    ALULA_GAINS_BANDWIDTH, ALULA_GAINS_CONSTANT, ALULA_MODEL_TABLE, CHOICES, ControllerParameters,
    MISSION, Parameters, SECTIONS, Section, alula_parameters_default,
};
pub use path::alula_path_time_scale;
pub use plan::*;
pub use report::*;
pub use step::alula_step;
pub use table::{ALULA_TABLE_ROWS, Table, TableRow, alula_table_init};

/// Never reached: no code of this library panics, which `capi/check` verifies on the linked object.
#[cfg(panic = "abort")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}
