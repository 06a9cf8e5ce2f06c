//! What the command line adds to the rooms beside it: the controller and the vehicle behind other programs' interfaces.
//!
//! [`pil`], the target as a controller, under QEMU or on a board; [`ardupilot`], the plant behind ArduPilot's physics interface;
//! [`companion`], the controller beside an autopilot, and the vehicle under a simulated one.
//! On a target without an operating system the package is empty.
#![cfg_attr(target_os = "none", no_std)]
#![cfg(not(target_os = "none"))]

pub mod ardupilot;
pub mod companion;
pub mod pil;
