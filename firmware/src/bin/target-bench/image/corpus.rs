//! The guidance over calls that the host has written to a file: those of the fuzz corpus. The file's format is that of
//! `fuzz/examples/frames.rs`.

use super::functions::{Fixture, Function, Output, keep};
use super::measure::Meter;
use super::sweep::{self, Case};
use alula::{
    Combined, Guidance, GuidanceInput, Hardened, HardenedState, Model, ModelParameters, Vehicle,
};
use alula_link::{Configuration, ControllerParameters, Counters, Input, Receiver, ToTarget};
use core::cell::Cell;
use cortex_m_semihosting::{hprintln, nr, syscall};

/// A file of the host, read front to back.
struct File {
    handle: usize,
    buffer: [u8; 512],
    /// What of the buffer has not been taken yet.
    left: core::ops::Range<usize>,
}

impl File {
    /// The file whose `name` ends with a zero.
    fn open(name: &[u8]) -> Self {
        const READ_BINARY: usize = 1;
        let block = [name.as_ptr() as usize, READ_BINARY, name.len() - 1];
        // SAFETY: SYS_OPEN reads the name, whose length it is told.
        let handle = unsafe { syscall(nr::OPEN, &block) };
        assert!(handle != usize::MAX, "no such file");
        Self {
            handle,
            buffer: [0; 512],
            left: 0..0,
        }
    }

    fn byte(&mut self) -> Option<u8> {
        if self.left.is_empty() {
            let length = self.buffer.len();
            let block = [self.handle, self.buffer.as_mut_ptr() as usize, length];
            // SAFETY: SYS_READ writes into the buffer, whose length it is told. It returns how many bytes it did not.
            let missing = unsafe { syscall(nr::READ, &block) };
            self.left = 0..length - missing;
        }
        self.left.next().map(|place| self.buffer[place])
    }

    /// The message of the frame that comes.
    fn message(&mut self) -> ToTarget {
        let (mut receiver, mut counters) = (Receiver::new(), Counters::default());
        loop {
            let byte = self.byte().expect("a whole frame");
            if let Some(message) = receiver.push(byte, &mut counters) {
                return message;
            }
            assert!(counters == Counters::default(), "a damaged frame");
        }
    }
}

/// What is called next: the functions measured have no arguments of their own for it. What it points to belongs to [`measure`].
struct Next(Cell<*mut Call>);

struct Call {
    guidance: Made,
    memory: HardenedState,
    input: GuidanceInput,
    dt: f32,
}

/// A guidance with the model that the bench's table is of, and one with a model that is chosen at run time.
#[allow(clippy::large_enum_variant)]
enum Made {
    Combined(Hardened<Guidance<Combined>>),
    Chosen(Hardened<Guidance<Model<'static>>>),
}

impl Made {
    fn of(configuration: &Configuration) -> Option<Self> {
        let ControllerParameters::Guidance { parameters, .. } = &configuration.controller else {
            return None;
        };
        let p = configuration.vehicle;
        Some(match configuration.model {
            ModelParameters::Combined(model) => {
                let vehicle = Vehicle::new(p, Combined::new(model).ok()?).ok()?;
                Self::Combined(Hardened::new(Guidance::new(vehicle, parameters).ok()?))
            }
            other => {
                let vehicle = Vehicle::new(p, other.model().ok()?).ok()?;
                Self::Chosen(Hardened::new(Guidance::new(vehicle, parameters).ok()?))
            }
        })
    }
}

// SAFETY: there is one thread, and no interrupt is enabled.
unsafe impl Sync for Next {}

static NEXT: Next = Next(Cell::new(core::ptr::null_mut()));

#[inline(never)]
fn combined(_: &Fixture, _: &Case, _: &mut Output) {
    // SAFETY: `measure` has put it there, and has it.
    let call = unsafe { &mut *NEXT.0.get() };
    if let Made::Combined(guidance) = &call.guidance {
        keep(guidance.update(&mut call.memory, &call.input, call.dt));
    }
}

#[inline(never)]
fn chosen(_: &Fixture, _: &Case, _: &mut Output) {
    // SAFETY: As above.
    let call = unsafe { &mut *NEXT.0.get() };
    if let Made::Chosen(guidance) = &call.guidance {
        keep(guidance.update(&mut call.memory, &call.input, call.dt));
    }
}

/// The plan after the step that is next.
#[inline(never)]
fn plan(_: &Fixture, _: &Case, _: &mut Output) {
    // SAFETY: As above.
    let call = unsafe { &mut *NEXT.0.get() };
    match &call.guidance {
        Made::Combined(guidance) => guidance.plan(&mut call.memory),
        Made::Chosen(guidance) => guidance.plan(&mut call.memory),
    }
}

/// One line for the steps of each model, the combined one and one that is chosen at run time, and one for their plans: calls, the most
/// instructions of one, and the deepest stack \[bytes\].
pub fn measure(fixture: &Fixture, meter: &Meter, name: &[u8]) {
    let case = sweep::case(fixture, 0);
    let mut file = File::open(name);
    let output = &mut Output::new();
    let mut configuration = None;
    let mut worst = [(0u32, 0, 0); 3];
    while let Some(kind) = file.byte() {
        if kind == 0 {
            let ToTarget::Configure(heard) = file.message() else {
                panic!("not a configuration");
            };
            configuration = Some(heard);
            continue;
        }
        let mut bytes = [0; HardenedState::BYTES];
        bytes.fill_with(|| file.byte().expect("a whole memory"));
        let ToTarget::Input(Input::Guidance { input, dt }) = file.message() else {
            panic!("not an input");
        };
        let made = configuration.as_ref().and_then(Made::of);
        let mut call = Call {
            guidance: made.expect("accepted on the host"),
            memory: HardenedState::from_bytes(&bytes),
            input,
            dt,
        };
        let (function, kind): (Function, _) = match call.guidance {
            Made::Combined(_) => (combined, 0),
            Made::Chosen(_) => (chosen, 1),
        };
        NEXT.0.set(&mut call);
        let count = meter.instructions(function, &case, output);
        // SAFETY: NEXT points to it, and nothing else does.
        unsafe { (*NEXT.0.get()).memory = HardenedState::from_bytes(&bytes) };
        let stack = meter.stack(function, &case, output);
        // The step has left the request.
        let planned = meter.instructions(plan, &case, output);
        let plan_stack = meter.stack(plan, &case, output);
        for (n, count, stack) in [(kind, count, stack), (2, planned, plan_stack)] {
            let (calls, most, deepest) = worst[n];
            worst[n] = (calls + 1, most.max(count), deepest.max(stack));
        }
    }
    for (calls, most, stack) in worst {
        hprintln!("{} {} {}", calls, most, stack);
    }
}
