//! Runs every target, or those named, over its seed corpus and random inputs, and prints what was run. Stable Rust.
//!
//! `cargo run --release --example regress -- [--inputs N] [--seed N] [--seeds N] [target…]`; on a violation the input is written to `artifacts/`.

use std::panic;
use std::path::Path;
use std::process::ExitCode;
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
const PARSERS: [&str; 8] = [
    "experiment",
    "campaign",
    "replay",
    "ulog",
    "dataflash",
    "csv",
    "map",
    "polar",
];

fn seeds(name: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("corpus")
        .join(name);
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    files.sort();
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

fn main() -> ExitCode {
    let (mut inputs, mut seed, mut most, mut chosen) = (10_000, 1, u64::MAX, Vec::new());
    let mut arguments = std::env::args().skip(1);
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
            name if TARGETS.iter().any(|t| t.0 == name) => {
                chosen.push(argument);
                Some(())
            }
            _ => None,
        };
        if ok.is_none() {
            eprintln!("regress [--inputs N] [--seed N] [--seeds N] [target…]");
            return ExitCode::FAILURE;
        }
    }
    let mut failed = 0u64;
    println!(
        "{:12} {:>7} {:>10} {:>14} {:>7} {:>7}",
        "target", "seeds", "inputs", "calls", "failed", "s"
    );
    for (name, target) in TARGETS {
        if !chosen.is_empty() && !chosen.iter().any(|c| c == *name) {
            continue;
        }
        let (start, seeds, mut random) = (Instant::now(), seeds(name), Random(seed | 1 << 63));
        let seeds = &seeds[..seeds.len().min(most as usize)];
        let (mut calls, mut bad) = (0, 0);
        let mut run = |input: &[u8]| match attempt(name, *target, input) {
            Some(n) => calls += n,
            None => bad += 1,
        };
        seeds.iter().for_each(|seed| run(seed));
        (0..inputs).for_each(|_| run(&random.input(seeds, PARSERS.contains(name))));
        let seconds = start.elapsed().as_secs_f32();
        println!(
            "{name:12} {:>7} {inputs:>10} {calls:>14} {bad:>7} {seconds:>7.1}",
            seeds.len()
        );
        failed += bad;
    }
    if failed == 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
