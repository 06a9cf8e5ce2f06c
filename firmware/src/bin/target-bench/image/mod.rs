//! The image that measures, and prints lines by semihosting for the runner to read.

mod corpus;
mod flown;
mod functions;
mod measure;
mod space;
mod sweep;

use core::hint::black_box;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln, nr, syscall1};
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
    let mut argument = [0; ARGUMENT];
    match argument_of(&mut argument) {
        b"trace" => trace(fixture, &meter),
        [b'c', b'o', b'r', b'p', b'u', b's', b' ', file @ ..] => {
            let mut name = [0; ARGUMENT];
            name[..file.len()].copy_from_slice(file);
            corpus::measure(fixture, &meter, &name[..=file.len()]);
        }
        _ => measure(fixture, &meter),
    }
    debug::exit(debug::EXIT_SUCCESS);
}

/// One line per function: its name, least, median and most instructions per call, and peak stack \[bytes\].
fn measure(fixture: &Fixture, meter: &Meter) {
    report_coverage(fixture);
    let mut counts = [0; CASES];
    for &functions::Measured {
        name,
        function,
        memory,
    } in functions::TABLE
    {
        let mut stack = 0;
        let output = &mut Output::new();
        for (n, count) in counts.iter_mut().enumerate() {
            let case = &black_box(sweep::case(fixture, n));
            // Twice: the first call of a flight's new case meets other limits than the second.
            *count = 0;
            for _ in 0..2 {
                output.prepare(memory, fixture);
                *count = meter.instructions(function, case, output).max(*count);
            }
            output.prepare(memory, fixture);
            stack = stack.max(meter.stack(function, case, output));
        }
        counts.sort_unstable();
        let (least, median, most) = (counts[0], counts[CASES / 2], counts[CASES - 1]);
        hprintln!("{} {} {} {} {}", name, least, median, most, stack);
    }
}

/// One line per traced call: the function's name and the instructions by the clock.
fn trace(fixture: &Fixture, meter: &Meter) {
    for &functions::Measured {
        name,
        function,
        memory,
    } in functions::TABLE
    {
        let output = &mut Output::new();
        for n in (0..CASES).step_by(TRACE_STEP) {
            let case = &black_box(sweep::case(fixture, n));
            output.prepare(memory, fixture);
            hprintln!("{} {}", name, meter.marked(function, case, output));
        }
    }
}

/// Every so many cases are traced. It has no divisor in common with the kinds of cases, so that it meets them all.
const TRACE_STEP: usize = 11;

/// Room for an argument, a zero after it.
const ARGUMENT: usize = 256;

/// The argument that QEMU was started with.
fn argument_of(text: &mut [u8; ARGUMENT]) -> &[u8] {
    let mut block = [text.as_mut_ptr() as usize, text.len()];
    // SAFETY: SYS_GET_CMDLINE writes a string no longer than the block says.
    let result = unsafe { syscall1(nr::GET_CMDLINE, block.as_mut_ptr() as usize) };
    assert!(result == 0, "no room for the argument");
    let end = text.iter().position(|byte| *byte == 0);
    &text[..end.unwrap_or(0)]
}

/// Prints how many cases are where, and insists on some everywhere.
fn report_coverage(fixture: &Fixture) {
    let (mut guarded, mut opposite, mut still, mut reverse, mut faulted) = (0, 0, 0, 0, 0);
    let control = &fixture.combined_control;
    for n in 0..CASES {
        let case = sweep::case(fixture, n);
        match control.robust(&case.state, &case.reference, None) {
            Ok(command) => {
                let d = command.diagnostics;
                guarded += usize::from(d.f_p_norm < control.gains().guard().tau());
                opposite += usize::from(d.theta_tilde().abs() > 3.1);
                still += usize::from(case.v_a.norm() < 1e-5);
                reverse += usize::from(d.alpha.abs() > 2.0);
            }
            Err(_) => faulted += 1,
        }
    }
    for count in [guarded, opposite, still, reverse, faulted] {
        assert!(count >= CASES / 20);
    }
    hprintln!(
        "# {} cases: |F_p| < tau {}, |theta~| > 3.1 {}, no airspeed {}, |alpha| > 2 {}, faulted {}",
        CASES,
        guarded,
        opposite,
        still,
        reverse,
        faulted
    );
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
