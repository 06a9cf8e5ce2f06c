//! The C ABI: structures of any bits behind their headers, pointers that are null or odd, calls in any order.

use std::ptr::{null, null_mut};

use alula::VehicleParameters;
use alula_capi::*;

use crate::assert_finite;
use crate::bytes::Bytes;

/// `value` with some of its words behind the header changed.
fn poked<T: Copy>(bytes: &mut Bytes, mut value: T, most: u8) -> T {
    let words = size_of::<T>() / 4;
    for _ in 0..bytes.byte() % (most + 1) {
        let word = 1 + usize::from(bytes.byte()) % (words - 1);
        let bits = match bytes.byte() {
            0..=63 => bytes.word(),
            64..=95 => u32::from(bytes.byte() % 8),
            _ => bytes.number(20.0).to_bits(),
        };
        // SAFETY: The word lies inside the structure, which is plain numbers of four bytes.
        unsafe { (&raw mut value).cast::<u32>().add(word).write(bits) };
    }
    value
}

/// Now and then a pointer that is none.
fn pointer<T>(bytes: &mut Bytes, good: *const T) -> *const T {
    match bytes.byte() {
        0..=3 => null(),
        4..=7 => good.wrapping_byte_add(2),
        _ => good,
    }
}

fn known(code: i32) {
    // SAFETY: `alula_strerror` gives a text for every code.
    let text = unsafe { std::ffi::CStr::from_ptr(alula_strerror(code)) };
    assert!(!text.is_empty() && text != c"unknown code", "{code}");
}

fn check(command: &Command) {
    assert_finite(&[command.thrust, command.thrust_normalised]);
    assert_finite(&command.body_rate);
}

pub fn run(data: &[u8]) -> u64 {
    let bytes = &mut Bytes::new(data);
    let paper = Parameters {
        vehicle: VehicleParameters::PAPER,
        ..Parameters::DEFAULT
    };
    let parameters = poked(bytes, paper, 3);
    let mut table = Table {
        header: Table::HEADER,
        reserved: 0,
        opaque: [0; 671],
    };
    let rows: Vec<TableRow> = (0..bytes.byte() % 12)
        .map(|n| TableRow {
            alpha: f32::from(n) * 0.3 + bytes.between(0.0, 0.2),
            c_l: bytes.number(1.0),
            c_d: bytes.number(1.0).abs(),
        })
        .collect();
    let mut row = 0;
    // SAFETY: The rows are so many, and everything else is a structure of this frame, or null, or odd.
    known(unsafe { alula_table_init(&mut table, rows.as_ptr(), rows.len() as u32, &mut row) });
    let mut controller = Controller {
        header: Controller::HEADER,
        reserved: 0,
        opaque: [0; 128],
    };
    // SAFETY: As above.
    let code = unsafe {
        alula_init(
            &mut controller,
            pointer(bytes, &parameters),
            pointer(bytes, &table),
        )
    };
    known(code);
    let ready = code == ALULA_OK;
    let mut calls = 2;
    while !bytes.is_empty() {
        calls += 1;
        let dt = match bytes.byte() {
            0..=31 => bytes.bits(),
            _ => 0.01,
        };
        let mut command = Command::SAFE;
        // SAFETY: As above; nothing else uses the controller meanwhile.
        unsafe {
            match bytes.byte() % 8 {
                0..=2 => {
                    let input = poked(bytes, Input::DEFAULT, 6);
                    let input = pointer(bytes, &input);
                    let from = pointer(bytes, &controller);
                    let code = alula_step(from, input, dt, &mut command, null_mut());
                    known(code);
                    check(&command);
                    assert!(ready || code != ALULA_OK);
                }
                3 => known(alula_reset(&mut controller)),
                _ => {
                    let input = poked(bytes, Input::DEFAULT, 6);
                    let input = pointer(bytes, &input);
                    let out = pointer(bytes, &raw mut command).cast_mut();
                    let code = alula_guide(&mut controller, input, dt, out, null_mut());
                    known(code);
                    check(&command);
                    assert!(ready || code != ALULA_OK);
                    if code == ALULA_OK && std::ptr::eq(out, &raw const command) {
                        let p = &parameters.vehicle;
                        let limits = p.thrust_min..=p.thrust_max;
                        assert!(limits.contains(&command.thrust), "{command:?}");
                    }
                }
            }
        }
    }
    calls
}
