//! The image that measures. It prints one line per function by semihosting, for the runner to read:
//! name, least, median and most instructions per call, and peak stack [bytes].

mod functions;
mod measure;
mod sweep;

use core::hint::black_box;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use functions::{Fixture, Function, Output};
use measure::Meter;
use sweep::{CASES, Case};

/// Set by the runner to the name of one function: the image then holds that function and nothing else that an
/// image for `empty` does not, and what it adds to that one's flash is what the function needs.
const FOOTPRINT: Option<Function> = match option_env!("ALULA_FOOTPRINT") {
    Some(name) => Some(functions::by_name(name)),
    None => None,
};

#[entry]
fn main() -> ! {
    if let Some(function) = FOOTPRINT {
        let anything = black_box(0x2000_0000);
        // SAFETY: such an image is only weighed, never run.
        unsafe {
            let (fixture, case) = (anything as *const Fixture, anything as *const Case);
            function(&*fixture, &*case, &mut *(anything as *mut Output));
        }
    } else {
        bench();
    }
    loop {
        cortex_m::asm::nop();
    }
}

fn bench() {
    let fixture = &black_box(Fixture::new());
    let meter = Meter::new(fixture, &sweep::case(fixture, 0));
    let mut counts = [0; CASES];
    for &(name, function) in functions::TABLE {
        let mut stack = 0;
        for (n, count) in counts.iter_mut().enumerate() {
            let case = &black_box(sweep::case(fixture, n));
            let output = &mut Output::default();
            *count = meter.instructions(function, case, output);
            stack = stack.max(meter.stack(function, case, output));
        }
        counts.sort_unstable();
        let (least, median, most) = (counts[0], counts[CASES / 2], counts[CASES - 1]);
        hprintln!("{} {} {} {} {}", name, least, median, most, stack);
    }
    debug::exit(debug::EXIT_SUCCESS);
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    if FOOTPRINT.is_none() {
        hprintln!("{}", info);
        debug::exit(debug::EXIT_FAILURE);
    }
    loop {
        cortex_m::asm::nop();
    }
}
