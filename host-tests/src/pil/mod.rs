//! Processor in the loop: a controller of the core on a target, behind its link.
//!
//! The plant and the target take turns: the plant waits for the answer to each input, however long it takes on
//! the wall's clock. In lockstep the target answers an input on arrival, and its timer only supervises the
//! link; paced by the timer it answers at the next tick. Either way the simulated time is the plant's. To the target, a
//! pause of the host that is longer than its limit is a lost link, from which the next input brings it back: the
//! commands are the same.

mod image;
mod qemu;
mod target;

pub use image::{Build, build};
pub use qemu::Qemu;
pub use target::{Heard, Port, Target, core_answer, link_input, open_serial};
