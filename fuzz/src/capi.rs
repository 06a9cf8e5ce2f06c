//! The C ABI: structures of any bits behind their headers, pointers that are null or odd, calls in any order.

use std::ptr::{null, null_mut};

use alula::VehicleParameters;
use alula::mission::MissionParameters;
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
    let mut controller = Controller::BLANK;
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
    let mut goal = Goal::DEFAULT;
    let mut map = Map {
        header: Map::HEADER,
        reserved: 0,
        opaque: [0; 384],
    };
    let mut mission = Box::new(Mission::BLANK);
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
            // Zeros are numbers.
            let mut report = Report {
                header: Report::HEADER,
                ..std::mem::zeroed()
            };
            let about = match bytes.byte() % 2 {
                0 => null_mut(),
                _ => pointer(bytes, &raw mut report).cast_mut(),
            };
            match bytes.byte() % 16 {
                0..=3 => {
                    let input = poked(bytes, Input::DEFAULT, 6);
                    let input = pointer(bytes, &input);
                    let from = pointer(bytes, &controller);
                    let code = alula_step(from, input, dt, &mut command, about);
                    known(code);
                    check(&command);
                    assert!(ready || code != ALULA_OK);
                }
                4 => known(alula_reset(&mut controller)),
                5..=7 => {
                    // What its caller wants, and what it remembers.
                    goal = poked(bytes, goal, 3);
                    let mut input = poked(bytes, Input::DEFAULT, 2);
                    let position = [(); 3].map(|()| bytes.number(200.0));
                    let place = pointer(bytes, &raw const position).cast();
                    let asked = pointer(bytes, &raw mut goal).cast_mut();
                    let code = alula_goal_step(asked, place, dt, &mut input);
                    known(code);
                    if code == ALULA_OK {
                        assert_finite(&input.position_error);
                        known(alula_guide(
                            &mut controller,
                            &input,
                            dt,
                            &mut command,
                            about,
                        ));
                        check(&command);
                    }
                    // A good goal is taken again, whatever is remembered.
                    goal = Goal {
                        opaque: goal.opaque,
                        ..Goal::DEFAULT
                    };
                    let mut input = Input::DEFAULT;
                    let position = [10.0f32, 20.0, -30.0];
                    let code = alula_goal_step(&mut goal, position.as_ptr(), 0.01, &mut input);
                    assert_eq!(code, ALULA_OK);
                    assert_finite(&input.reference_velocity);
                    assert_finite(&input.reference_acceleration);
                    assert_finite(&input.position_error);
                }
                8 => {
                    let mut ruled = poked(bytes, parameters, 1);
                    let [a, b, c, d] = [(); 4].map(|()| bytes.number(1.0));
                    let to = pointer(bytes, &raw mut ruled).cast_mut();
                    known(alula_parameters_for_vehicle(to, a, b, 100.0 * c, 20.0 * d));
                    let mut other = Controller::BLANK;
                    known(alula_init(&mut other, &ruled, &table));
                    known(alula_parameters_default(to));
                    known(alula_input_default(&mut { Input::DEFAULT }));
                    known(alula_command_default(&mut command));
                    known(alula_goal_default(&mut goal));
                    assert_eq!(alula_abi_version(), ALULA_ABI_VERSION);
                }
                9 => {
                    let [x, v] = [(); 2].map(|()| [(); 3].map(|()| bytes.number(30.0)));
                    let mut scale = 0.0;
                    let code = alula_path_time_scale(
                        pointer(bytes, &controller),
                        pointer(bytes, &raw const x).cast(),
                        pointer(bytes, &raw const v).cast(),
                        &mut scale,
                    );
                    known(code);
                    assert!((0.5..=1.25).contains(&scale), "{scale}");
                }
                10 | 11 => {
                    let setup = MissionSetup {
                        parameters: MissionParameters::cruising_at(20.0),
                        ..MissionSetup::DEFAULT
                    };
                    let setup = poked(bytes, setup, 2);
                    let from = pointer(bytes, &controller);
                    if bytes.byte() < 64 {
                        known(alula_mission_init(&mut *mission, &setup, from));
                    }
                    let items: Vec<MissionItem> = (0..bytes.byte() % 6)
                        .map(|_| MissionItem {
                            kind: u32::from(bytes.byte() % 14),
                            place: [(); 3].map(|()| bytes.number(200.0)),
                            radius: bytes.number(150.0),
                            value: bytes.number(10.0),
                        })
                        .collect();
                    let (count, from) = (items.len() as u32, u32::from(bytes.byte() % 8));
                    let list = pointer(bytes, items.as_ptr());
                    let to = &mut *mission;
                    known(alula_mission_items(to, list, count, from, &mut row));
                    for _ in 0..bytes.byte() % 16 {
                        mission.flags = match bytes.byte() {
                            0..=7 => bytes.word(),
                            trouble => ALULA_ARMED | u32::from(trouble % 64),
                        };
                        mission.position = [(); 3].map(|()| bytes.number(100.0));
                        let input = poked(bytes, Input::DEFAULT, 4);
                        let input = pointer(bytes, &input);
                        let to = &mut *mission;
                        known(alula_mission_fly(
                            to,
                            &mut controller,
                            input,
                            dt,
                            &mut command,
                            about,
                        ));
                        check(&command);
                        let Mission {
                            energy,
                            right,
                            distance_to_go,
                            time_after,
                            ..
                        } = *mission;
                        assert_finite(&[energy, right, distance_to_go, time_after]);
                        calls += 1;
                    }
                }
                // Some hundred evaluations of the model each: now and then.
                12 if bytes.byte() < 16 => {
                    let input = poked(bytes, Input::DEFAULT, 6);
                    let mut set = poked(bytes, EquilibriumSet::EMPTY, 1);
                    let from = pointer(bytes, &controller);
                    known(alula_equilibria_at(from, &input, &mut set));
                    known(alula_fold_map_init(&mut map, from));
                    let mut margin = poked(bytes, FoldMargin::EMPTY, 1);
                    known(alula_fold_margin_at(&map, from, &input, &mut margin));
                }
                _ => {
                    let input = poked(bytes, Input::DEFAULT, 6);
                    let input = pointer(bytes, &input);
                    let out = pointer(bytes, &raw mut command).cast_mut();
                    let code = alula_guide(&mut controller, input, dt, out, about);
                    known(code);
                    check(&command);
                    assert!(ready || code != ALULA_OK);
                    if code == ALULA_OK && std::ptr::eq(out, &raw const command) {
                        let p = &parameters.vehicle;
                        let limits = p.thrust_min..=p.thrust_max;
                        assert!(limits.contains(&command.thrust), "{command:?}");
                    }
                    // A plan at once, and one by a search of any bits.
                    if code == ALULA_OK && bytes.byte() < 64 {
                        known(alula_plan(&mut controller));
                        let mut search = Search {
                            header: Search::HEADER,
                            more: 1,
                            opaque: std::array::from_fn(|_| u32::from(bytes.byte()) << 23),
                        };
                        known(alula_search_adopt(&mut controller, &search));
                        known(alula_search_begin(&controller, &mut search));
                        while search.more == 1 {
                            known(alula_search_look(&controller, &mut search));
                        }
                        known(alula_search_adopt(&mut controller, &search));
                    }
                }
            }
        }
    }
    calls
}
