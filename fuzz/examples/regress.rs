//! Runs every target, or those named, over its seed corpus and random inputs, and prints what was run. Stable Rust.
//!
//! `cargo run --release --example regress -- [--inputs N] [--seed N] [--seeds N] [--longest BYTES] [target…]`; on a violation the input
//! is written to `artifacts/`. Of the corpus, which is always run, random inputs are made only from what is not longer than `--longest`:
//! where reading takes long, short inputs have a change in every part of them, and there is time for more.
//!
//! As many targets run at once as there are processors; a line is printed where one ends.
//!
//! Of more than a hundred thousand inputs each so many are a process of their own: the harness keeps polars for ever, and what ends a
//! process (a stack that overflows, memory that does not suffice) is counted by that.

use std::panic;
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use alula_fuzz::{TARGETS, Target};

/// xorshift64*: the inputs need no quality, only to be the same everywhere.
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

    /// Random bytes; often a seed with some bytes changed. For a `parser` nearly always a seed, with pieces put elsewhere, left out, or taken
    /// from another one, too: random bytes are refused at once.
    fn input(&mut self, seeds: &[Vec<u8>], parser: bool) -> Vec<u8> {
        let of = self.below(16);
        if !seeds.is_empty() && (of < 4 || parser && of < 15) {
            let mut input = seeds[self.below(seeds.len())].clone();
            for _ in 0..self.below(8) {
                let other = &seeds[self.below(seeds.len())];
                self.change(&mut input, parser.then_some(other));
            }
            return input;
        }
        let length = 1usize << (4 + self.next() % 7);
        (0..length).map(|_| self.next() as u8).collect()
    }
}

impl Random {
    /// Changes a byte, or a piece with the help of an `other` input.
    fn change(&mut self, input: &mut Vec<u8>, other: Option<&Vec<u8>>) {
        if input.is_empty() {
            return;
        }
        let at = self.below(input.len());
        let to = input.len().min(at + 1 + self.below(24));
        match (self.below(8), other) {
            (0..=3, _) | (_, None) => input[at] = self.next() as u8,
            (4, _) => drop(input.drain(at..to)),
            (5, _) => input.truncate(at),
            (6, _) => {
                let piece = input[at..to].to_vec();
                let into = self.below(input.len());
                input.splice(into..into, piece);
            }
            (_, Some(other)) => {
                let from = self.below(other.len());
                let piece = &other[from..other.len().min(from + 24)];
                input.splice(at..at, piece.iter().copied());
            }
        }
    }
}

/// The targets whose inputs are files.
const PARSERS: [&str; 12] = [
    "experiment",
    "vehicle",
    "known",
    "comparison",
    "campaign",
    "replay",
    "ulog",
    "mcap",
    "dataflash",
    "csv",
    "map",
    "polar",
];

/// At most this many of the corpus.
fn seeds(name: &str, most: u64) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(name);
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    files.sort();
    files.truncate(usize::try_from(most).unwrap_or(usize::MAX));
    files.iter().filter_map(|f| std::fs::read(f).ok()).collect()
}

/// Calls of one input, or nothing if it violates what must hold.
fn attempt(name: &str, target: Target, input: &[u8]) -> Option<u64> {
    let calls = panic::catch_unwind(|| target(input)).ok();
    if calls.is_none() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("artifacts")
            .join(name);
        let hash = input.iter().fold(0xcbf2_9ce4_8422_2325u64, |h, &b| {
            (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3)
        });
        let file = folder.join(format!("crash-{hash:016x}"));
        let written = std::fs::create_dir_all(&folder).and_then(|()| std::fs::write(&file, input));
        eprintln!("{name}: {} ({written:?})", file.display());
    }
    calls
}

/// Bytes of a thread's stack: those of a process.
const STACK: usize = 8 << 20;

/// Inputs of a process.
const PIECE: u64 = 100_000;

/// What was run of a target.
#[derive(Default)]
struct Count {
    inputs: u64,
    calls: u64,
    failed: u64,
}

/// Random inputs of one target.
struct Piece<'a> {
    name: &'a str,
    inputs: u64,
    seed: u64,
    /// At most so many of the corpus.
    seeds: u64,
    /// Of these, at most so many bytes are changed.
    longest: u64,
    /// Whether the corpus itself is run as well.
    first: bool,
}

impl Piece<'_> {
    fn run(&self, target: Target) -> Count {
        let mut seeds = seeds(self.name, self.seeds);
        let mut random = Random(self.seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1 << 63);
        let mut count = Count::default();
        let mut run = |input: &[u8]| {
            count.inputs += 1;
            match attempt(self.name, target, input) {
                Some(calls) => count.calls += calls,
                None => count.failed += 1,
            }
        };
        if self.first {
            seeds.iter().for_each(|seed| run(seed));
        }
        let parser = PARSERS.contains(&self.name);
        seeds.retain(|seed| seed.len() as u64 <= self.longest);
        (0..self.inputs).for_each(|_| run(&random.input(&seeds, parser)));
        count
    }

    /// The same in a process of its own, which prints its numbers. One that does not come to its end has failed once.
    fn run_apart(&self) -> Count {
        let own = std::env::current_exe().expect("a program has a path");
        let numbers = [
            self.inputs,
            self.seed,
            self.seeds,
            self.longest,
            u64::from(self.first),
        ];
        let mut command = Command::new(own);
        command.arg("--piece").arg(self.name);
        command.args(numbers.map(|n| n.to_string()));
        let output = command.stderr(Stdio::inherit()).output();
        let output = output.expect("this program runs");
        match numbers_in(&String::from_utf8_lossy(&output.stdout))[..] {
            [inputs, calls, failed] if output.status.success() => Count {
                inputs,
                calls,
                failed,
            },
            _ => {
                eprintln!("{}: {}, --seed {}", self.name, output.status, self.seed);
                Count {
                    failed: 1,
                    ..Count::default()
                }
            }
        }
    }
}

fn numbers_in(text: &str) -> Vec<u64> {
    let words = text.split_whitespace();
    words.filter_map(|word| word.parse().ok()).collect()
}

/// Runs the piece that `run_apart` asks for, if it does.
fn asked(arguments: &[String]) -> Option<()> {
    let [mark, name, numbers @ ..] = arguments else {
        return None;
    };
    let (name, target) = TARGETS.iter().find(|t| mark == "--piece" && t.0 == name)?;
    let &[inputs, seed, seeds, longest, first] = numbers_in(&numbers.join(" ")).as_slice() else {
        return None;
    };
    let piece = Piece {
        name,
        inputs,
        seed,
        seeds,
        longest,
        first: first == 1,
    };
    let count = piece.run(*target);
    println!("{} {} {}", count.inputs, count.calls, count.failed);
    Some(())
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if asked(&arguments).is_some() {
        return ExitCode::SUCCESS;
    }
    let (mut inputs, mut seed, mut chosen) = (10_000, 1, Vec::new());
    let (mut most, mut longest) = (u64::MAX, u64::MAX);
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        let mut number = |what: &mut u64| {
            let value = arguments.next().and_then(|a| a.parse().ok());
            value.map(|value| *what = value)
        };
        let ok = match argument.as_str() {
            "--inputs" => number(&mut inputs),
            "--seed" => number(&mut seed),
            // At most so many of the corpus, where each takes long.
            "--seeds" => number(&mut most),
            "--longest" => number(&mut longest),
            name if TARGETS.iter().any(|t| t.0 == name) => {
                chosen.push(argument);
                Some(())
            }
            _ => None,
        };
        if ok.is_none() {
            eprintln!("regress [--inputs N] [--seed N] [--seeds N] [--longest BYTES] [target…]");
            return ExitCode::FAILURE;
        }
    }
    println!(
        "{:12} {:>10} {:>14} {:>7} {:>7}",
        "target", "inputs", "calls", "failed", "s"
    );
    let asked_for = |name: &str| chosen.is_empty() || chosen.iter().any(|c| c == name);
    let next = Mutex::new(TARGETS.iter().filter(|(name, _)| asked_for(name)));
    let failed = AtomicU64::new(0);
    // One target after the other on each processor, each with the stack of a process.
    let work = || {
        while let Some((name, target)) = { next.lock().expect("no panic holds it").next() } {
            let (start, mut all) = (Instant::now(), Count::default());
            for n in 0..inputs.div_ceil(PIECE).max(1) {
                let piece = Piece {
                    name,
                    inputs: PIECE.min(inputs - n * PIECE),
                    seed: seed + n,
                    seeds: most,
                    longest,
                    first: n == 0,
                };
                let count = match inputs <= PIECE {
                    true => piece.run(*target),
                    false => piece.run_apart(),
                };
                all.inputs += count.inputs;
                all.calls += count.calls;
                all.failed += count.failed;
            }
            let seconds = start.elapsed().as_secs_f32();
            let Count {
                inputs,
                calls,
                failed: bad,
            } = all;
            println!("{name:12} {inputs:>10} {calls:>14} {bad:>7} {seconds:>7.1}");
            failed.fetch_add(bad, Ordering::Relaxed);
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..threads {
            let thread = std::thread::Builder::new().stack_size(STACK);
            thread.spawn_scoped(scope, work).expect("a thread");
        }
    });
    let failed = failed.into_inner();
    if failed == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
