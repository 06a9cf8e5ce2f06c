//! Instructions by the emulator's clock, and stack by painting; and the check of both on known code.

use super::functions::{Fixture, Function, Output, empty};
use super::sweep::Case;
use core::arch::asm;
use core::hint::black_box;
use stm32f4xx_hal::pac;

/// Calls functions, and counts what they take.
///
/// Under `-icount shift=0` QEMU's virtual clock advances 1 ns per instruction, and its TIM2 counts at 1 GHz:
/// one tick per instruction, exactly. (On silicon TIM2 counts its clock.)
pub struct Meter<'a> {
    fixture: &'a Fixture,
    timer: pac::TIM2,
}

impl<'a> Meter<'a> {
    /// Checks the method on code whose instructions and stack are known by hand.
    pub fn new(fixture: &'a Fixture, case: &Case) -> Self {
        // SAFETY: nothing else uses the peripheral.
        let timer = unsafe { pac::Peripherals::steal() }.TIM2;
        let meter = Self { fixture, timer };
        let output = &mut Output::new();
        // Every function of this target begins by pushing two registers, the frame record.
        for (function, count, bytes) in [
            (empty as Function, 0, 8),
            (ten_turns, 1 + 2 * 10, 8),
            (thousand_turns, 1 + 2 * 1000, 8),
            (push_of_eight, 2, 8 + 32),
        ] {
            assert_eq!(meter.instructions(function, case, output), count);
            assert_eq!(meter.stack(function, case, output), bytes);
        }
        meter
    }

    /// Instructions `function` executes between its call and its return, neither counted.
    pub fn instructions(&self, function: Function, case: &Case, output: &mut Output) -> u32 {
        self.ticks(function, case, output) - self.ticks(empty, case, output)
    }

    /// As `instructions`, between the marks that the runner looks for in QEMU's log; the marks are counted too.
    #[inline(never)]
    pub fn marked(&self, function: Function, case: &Case, output: &mut Output) -> u32 {
        let before = self.timer.cnt().read().bits();
        trace_begin();
        black_box(function)(self.fixture, case, output);
        trace_end();
        self.timer.cnt().read().bits() - before
    }

    #[inline(never)]
    fn ticks(&self, function: Function, case: &Case, output: &mut Output) -> u32 {
        let before = self.timer.cnt().read().bits();
        black_box(function)(self.fixture, case, output);
        self.timer.cnt().read().bits() - before
    }

    /// Bytes `function` writes below the stack pointer it is called with.
    #[inline(never)]
    pub fn stack(&self, function: Function, case: &Case, output: &mut Output) -> usize {
        const WORDS: usize = 1024;
        // A colour for each word: one for all would be hidden where the caller's register that holds it is saved.
        let paint = |n: usize| (n as u32).wrapping_mul(0x9E37_79B9);
        let top = cortex_m::register::msp::read() as *mut u32;
        // SAFETY: the memory below the stack pointer is nobody's: no interrupt is enabled.
        unsafe {
            for n in 1..=WORDS {
                top.sub(n).write_volatile(paint(n));
            }
            black_box(function)(self.fixture, case, output);
            let mut deepest = WORDS;
            while deepest > 0 && top.sub(deepest).read_volatile() == paint(deepest) {
                deepest -= 1;
            }
            4 * deepest
        }
    }
}

/// Marks of a traced call, by name. Each does something that the other does not: equal functions are merged.
#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn trace_begin() {
    // SAFETY: touches nothing.
    unsafe { asm!("nop") }
}

#[unsafe(no_mangle)]
#[inline(never)]
extern "C" fn trace_end() {
    // SAFETY: touches nothing.
    unsafe { asm!("nop", "nop") }
}

#[inline(never)]
fn ten_turns(_: &Fixture, _: &Case, _: &mut Output) {
    // SAFETY: touches one register and the flags.
    unsafe { asm!("movw {n}, #10", "2: subs {n}, {n}, #1", "bne 2b", n = out(reg) _) }
}

#[inline(never)]
fn thousand_turns(_: &Fixture, _: &Case, _: &mut Output) {
    // SAFETY: as above.
    unsafe { asm!("movw {n}, #1000", "2: subs {n}, {n}, #1", "bne 2b", n = out(reg) _) }
}

#[inline(never)]
fn push_of_eight(_: &Fixture, _: &Case, _: &mut Output) {
    // SAFETY: leaves registers and stack as they were.
    unsafe { asm!("push {{r4-r11}}", "pop {{r4-r11}}") }
}
