//! No bytes make a reader panic: files of each kind, damaged at random, are read, searched for states and written.
//!
//! `cargo test -p alula-logs --test mutation` reads 100,000 inputs;
//! `cargo test --release -p alula-logs --test mutation -- --ignored` reads ten million.
#![cfg(not(target_os = "none"))]

use alula_logs::{Column, Log, Topic, csv, dataflash, mcap, states, ulog};
use std::io::Cursor;

/// Marsaglia's xorshift64*: the same inputs every time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, bound: usize) -> usize {
        ((self.next() >> 32) as usize) % bound.max(1)
    }
}

/// One to eight changes to a copy of `seed`.
fn mutated(seed: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    const BYTES: [u8; 20] = *b"\0\x01\x7f\x80\xff\xa3\x95FAD,;\n\":[]=.e";
    let mut bytes = seed.to_vec();
    for _ in 0..=random.below(8) {
        let at = random.below(bytes.len());
        let to = bytes.len().min(at + 1 + random.below(24));
        match random.below(9) {
            _ if bytes.is_empty() => break,
            0 => bytes[at] ^= 1 << random.below(8),
            1 => bytes[at] = BYTES[random.below(BYTES.len())],
            2 => bytes[at] = random.next() as u8,
            3 => bytes.truncate(at),
            4 => drop(bytes.drain(at..to)),
            5 => {
                let copy = bytes[at..to].to_vec();
                let into = random.below(bytes.len());
                bytes.splice(into..into, copy);
            }
            6 => bytes.insert(at, BYTES[random.below(BYTES.len())]),
            7 => bytes[at] = bytes[at].wrapping_add(1),
            _ => {
                let from = random.below(other.len());
                let piece = &other[from..other.len().min(from + 24)];
                bytes.splice(at..at, piece.iter().copied());
            }
        }
    }
    bytes
}

/// A log of the topics that the search for states knows.
fn sample() -> Log {
    let time = vec![1.0, 1.25, 2.0];
    let topic = |name: &str, instance, names: &[&str]| {
        let column = |(i, name): (usize, &&str)| {
            Column::new(
                name,
                "m/s",
                (0..3).map(|row| (row + i) as f64 * 0.1).collect(),
            )
        };
        let columns = names.iter().enumerate().map(column).collect();
        Topic::new(name, instance, time.clone(), columns).unwrap()
    };
    let topics = vec![
        topic("vehicle_attitude", 0, &["q[0]", "q[1]", "q[2]", "q[3]"]),
        topic(
            "vehicle_local_position",
            0,
            &["x", "y", "z", "vx", "vy", "vz"],
        ),
        topic("wind", 0, &["windspeed_north", "windspeed_east"]),
        topic("wind", 1, &["windspeed_north", "windspeed_east"]),
    ];
    Log {
        topics,
        notes: Vec::new(),
    }
}

fn text<const N: usize>(text: &str) -> [u8; N] {
    let mut bytes = [0; N];
    bytes[..text.len()].copy_from_slice(text.as_bytes());
    bytes
}

/// A binary DataFlash log with units, an instance, an array and the messages of an attitude and a position.
fn binary() -> Vec<u8> {
    let head = |kind: u8| [0xa3, 0x95, kind].to_vec();
    let format = |kind: u8, length: u8, name: &str, kinds: &str, labels: &str| {
        let stated = [kind, length];
        [
            &head(128)[..],
            &stated,
            &text::<4>(name),
            &text::<16>(kinds),
            &text::<64>(labels),
        ]
        .concat()
    };
    let mut bytes = [
        format(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns"),
        format(2, 76, "UNIT", "QbZ", "TimeUS,Id,Label"),
        format(3, 20, "MULT", "Qbd", "TimeUS,Id,Mult"),
        format(4, 44, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
        format(5, 28, "XKQ", "QBffff", "TimeUS,C,Q1,Q2,Q3,Q4"),
        format(6, 23, "POS", "QLLf", "TimeUS,Lat,Lng,Alt"),
        format(7, 75, "ARR", "Qa", "TimeUS,A"),
        [&head(2)[..], &[0; 8], b"#", &text::<64>("instance")].concat(),
        [&head(3)[..], &[0; 8], b"F", &1e-6f64.to_le_bytes()].concat(),
        [
            &head(4)[..],
            &[0; 8],
            &[5],
            &text::<16>("s#????"),
            &text::<16>("F-????"),
        ]
        .concat(),
    ]
    .concat();
    for i in 0..4u8 {
        let time = (u64::from(i) * 100_000).to_le_bytes();
        let q = [0.5f32; 4].map(f32::to_le_bytes).concat();
        bytes.extend([&head(5)[..], &time, &[i % 2], &q].concat());
        let place = (473_977_000 + i32::from(i)).to_le_bytes();
        bytes.extend([&head(6)[..], &time, &place, &place, &488.5f32.to_le_bytes()].concat());
    }
    bytes.extend([&head(7)[..], &[0; 8], &[7; 64]].concat());
    bytes
}

const TEXT: &str = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
    FMT, 4, 44, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds\n\
    FMT, 3, 20, MULT, Qbd, TimeUS,Id,Mult\n\
    FMT, 9, 17, ATT, Qccc, TimeUS,Roll,Pitch,Yaw\n\
    FMT, 10, 75, MSG, QZ, TimeUS,Message\n\
    MULT, 0, 66, 0.01\nFMTU, 0, 9, sddd, FBBB\n\
    ATT, 1500000, -12.5, 3, 250\nMSG, 1, one, two\nATT, 2000000, 3, 10, nan\n";

const MAP: &str = "time = { from = 't', scale = 0.001 }\n[columns]\nqw = { from = 'w' }\nqx = { from = 'x', offset = 1 }\n";

/// How many of `inputs` damaged files were read, how many had states, how many were refused.
fn run(inputs: usize) -> [usize; 3] {
    let mut ulog_seed = Vec::new();
    ulog::write(&sample(), &mut ulog_seed).unwrap();
    let nested = b"nested:uint64_t timestamp;inner[2] a;char[3] c;uint8_t[3] _padding0;";
    ulog_seed.extend((nested.len() as u16).to_le_bytes());
    ulog_seed.push(b'F');
    ulog_seed.extend(nested);
    ulog_seed.extend(b"\x1c\0Finner:int16_t v;double[2] w;\x09\0A\0\x09\0nested\x33\0D\x09\0");
    ulog_seed.extend([3; 49]);
    ulog_seed.extend(b"\x08\0S\x2f\x73\x13\x20\x25\x0c\xbb\x12");
    let csv_seed =
        b"t,qw,qx,qy,qz,vn [m/s],w,x\n0,1,0,0,0,\"2.5\",1,2\n1.5e0,.5,.5,.5,-.5,,3,nan\n";
    let mut mcap_seed = Cursor::new(Vec::new());
    mcap::write(&sample(), &mut mcap_seed).unwrap();
    let seeds = [
        ulog_seed,
        mcap_seed.into_inner(),
        binary(),
        TEXT.into(),
        csv_seed.to_vec(),
        MAP.into(),
    ];
    let map = csv::Map::parse("m", MAP).unwrap();

    let mut random = Random(0x5eed);
    let mut counts = [0; 3];
    for input in 0..inputs {
        let which = input % seeds.len();
        let bytes = mutated(
            &seeds[which],
            &seeds[random.below(seeds.len())],
            &mut random,
        );
        let log = match which {
            0 => ulog::read("f", &bytes),
            1 => mcap::read("f", &bytes),
            2 | 3 => dataflash::read("f", &bytes),
            4 => csv::read("f", &bytes, (random.below(2) == 0).then_some(&map)),
            _ => match csv::Map::parse("m", &String::from_utf8_lossy(&bytes)) {
                Ok(map) => csv::read("f", csv_seed, Some(&map)),
                Err(e) => Err(e),
            },
        };
        let Ok(log) = log else {
            counts[2] += 1;
            continue;
        };
        counts[0] += 1;
        let numbers: usize = log
            .topics
            .iter()
            .map(|t| t.time().len() * (1 + t.columns().len()))
            .sum();
        // Each number takes a byte of the file at least, each row brings one time; a CSV may name a column more than once.
        assert!(
            numbers <= 10 * bytes.len(),
            "{numbers} numbers out of {} bytes",
            bytes.len()
        );
        for topic in &log.topics {
            assert!(topic.time().is_sorted() && topic.time().iter().all(|t| t.is_finite()));
            assert!(
                topic
                    .columns()
                    .iter()
                    .all(|c| c.values.len() == topic.time().len())
            );
        }
        if let Ok(states) = states::find(&log) {
            counts[1] += 1;
            assert_eq!(states.attitude.values.len(), states.time.len());
        }
        // What is written reads back whole.
        let mut written = Vec::new();
        if ulog::write(&log, &mut written).is_ok() {
            let back = ulog::read("f", &written).unwrap();
            assert!(back.notes.is_empty(), "{:?}", back.notes);
            let rows = |log: &Log| log.topics.iter().map(|t| t.time().len()).sum::<usize>();
            assert_eq!(
                rows(&back),
                rows(&log),
                "{log:?}, from {:?}",
                String::from_utf8_lossy(&bytes)
            );
        }
        // Unoptimised, the crate behind it takes most of the time.
        if input % 8 < 2 {
            let _ = mcap::write(&log, Cursor::new(Vec::new()));
        }
    }
    counts
}

fn check(inputs: usize) {
    let [read, states, refused] = run(inputs);
    println!("{inputs} damaged files: {read} read, {states} with states, {refused} refused");
    // Damage that is always refused at once, or never does harm, would try little: a tenth goes each way.
    assert!(read.min(states).min(refused) > inputs / 10);
}

#[test]
fn damaged_files_do_not_panic() {
    check(100_000);
}

#[test]
#[ignore = "minutes"]
fn ten_million_damaged_files_do_not_panic() {
    check(10_000_000);
}
