//! Any bytes as a mission, and the steps of its flight.
//!
//! What must hold: every number of what comes out finite, a thrust at the gate not negative, and an item that is refused named by its number.

use alula::mission::{
    Gate, Item, MissionInput, MissionParameters, MissionState, Missions, Pass, Response, Responses,
    Troubles, Until,
};
use alula::ned::Ned;

use crate::assert_finite;
use crate::bytes::Bytes;

/// Items and steps at most.
const ITEMS: usize = 12;
const STEPS: usize = 400;

fn ned(bytes: &mut Bytes, size: f32) -> Ned {
    Ned::new(bytes.number(size), bytes.number(size), bytes.number(size))
}

fn item(bytes: &mut Bytes) -> Item {
    match bytes.byte() % 8 {
        0 => Item::TakeOff {
            height: bytes.number(50.0),
        },
        1 => Item::Waypoint {
            place: ned(bytes, 400.0),
            pass: Pass::By,
        },
        2 => Item::Waypoint {
            place: ned(bytes, 400.0),
            pass: Pass::Over,
        },
        3 => Item::Waypoint {
            place: ned(bytes, 400.0),
            pass: Pass::Hover(bytes.number(3.0)),
        },
        4 => Item::Loiter {
            centre: ned(bytes, 400.0),
            radius: bytes.number(300.0),
            until: match bytes.byte() % 3 {
                0 => Until::Turns(bytes.number(2.0)),
                1 => Until::Time(bytes.number(5.0)),
                _ => Until::Forever,
            },
        },
        5 => Item::Speed(bytes.number(30.0)),
        6 => Item::Altitude {
            down: bytes.number(100.0),
        },
        _ => match bytes.byte() % 3 {
            0 => Item::Land { place: None },
            1 => Item::Land {
                place: Some(ned(bytes, 100.0)),
            },
            _ => Item::Return,
        },
    }
}

fn response(bytes: &mut Bytes) -> Response {
    match bytes.byte() % 4 {
        0 => Response::Continue,
        1 => Response::Loiter,
        2 => Response::Return,
        _ => Response::Land,
    }
}

pub fn run(data: &[u8]) -> u64 {
    crate::vehicle::with(&mut Bytes::new(data), |bytes, vehicle| {
        let p = bytes.parameters(MissionParameters::cruising_at(18.0));
        let responses = Responses::default()
            .link(response(bytes))
            .air(response(bytes))
            .position(response(bytes))
            .battery(response(bytes))
            .follow(response(bytes));
        let Ok(missions) = Missions::new(&vehicle, &p, responses) else {
            return 1;
        };
        let count = usize::from(bytes.byte()) % ITEMS;
        let items: Vec<Item> = (0..count).map(|_| item(bytes)).collect();
        let mission = match missions.mission(&items) {
            Ok(mission) => mission,
            Err(error) => {
                assert!(error.item < count);
                return 1;
            }
        };
        let mut state = MissionState::default();
        let (mut x, mut v) = (ned(bytes, 100.0), ned(bytes, 20.0));
        let mut steps = 0;
        while steps < STEPS {
            // A vehicle that does what it is asked, between frames of any kind.
            let told = match bytes.byte() {
                0..=20 => MissionInput::default()
                    .position(ned(bytes, 1e4))
                    .velocity(ned(bytes, 50.0))
                    .wind(ned(bytes, 20.0)),
                21..=30 => {
                    state.go_to(usize::from(bytes.byte()) % (ITEMS + 2));
                    continue_with(x, v, bytes)
                }
                _ => continue_with(x, v, bytes),
            };
            let dt = match bytes.byte() {
                0..=15 => bytes.number(0.3),
                _ => 0.1,
            };
            let asked = missions.step(&mut state, &mission, &told, dt);
            let (r, e, p) = (asked.reference, asked.position_error, asked.progress);
            for vector in [r.velocity, r.acceleration, e] {
                assert_finite(&[vector.north, vector.east, vector.down]);
            }
            assert_finite(&[
                p.time,
                p.distance_to_go,
                p.time_to_go,
                p.distance_after,
                p.time_after,
                p.energy,
                p.right,
                p.airspeed,
                p.steady_thrust,
                p.load_factor,
            ]);
            if let Gate::AtMost(most) = asked.gate {
                assert!(most.is_finite() && most >= 0.0);
            }
            v = r.velocity;
            x = x - e + v * 0.1;
            steps += 1;
            if bytes.is_empty() && steps > STEPS / 4 {
                break;
            }
        }
        steps as u64
    })
    .unwrap_or(1)
}

fn continue_with(x: Ned, v: Ned, bytes: &mut Bytes) -> MissionInput {
    MissionInput::default()
        .position((bytes.byte() % 16 > 0).then_some(x))
        .velocity(v)
        .wind(Ned::new(4.0, 2.0, 0.0))
        .airspeed((bytes.byte() % 2 > 0).then(|| bytes.number(50.0)))
        .thrust(20.0)
        .armed(true)
        .troubles(match bytes.byte() {
            250.. => Troubles::from_bits_truncate(bytes.byte()),
            _ => Troubles::empty(),
        })
}
