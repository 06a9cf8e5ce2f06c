//! Processor in the loop: the core on a target, behind its link.
//!
//! The plant and the target take turns: the plant waits for the answer to each input, however long it takes on
//! the wall's clock. In lockstep the target answers an input on arrival, and its timer only supervises the
//! link; paced by the timer it answers at the next tick. Either way the simulated time is the plant's, and a
//! pause of the host longer than the target's limit is to the target a lost link, from which the next input
//! brings it back: the commands are the same.

mod image;
mod qemu;
mod target;

pub use image::{Build, build};
pub use qemu::Qemu;
pub use target::{Port, Said, Target, open_serial};
