//! The host's half: builds the image, runs it under QEMU, weighs every function, prints the table.

mod cycles;
mod trace;

use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, elf};
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, error::Error, fs};
use trace::{Cost, Marks};

const TARGET: &str = "thumbv7em-none-eabihf";
type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// One function's line.
struct Row {
    name: String,
    least: u32,
    median: u32,
    most: u32,
    /// Median and most modelled cycles of the traced calls.
    cycles: (u32, u32),
    stack: u32,
    flash: u64,
}

/// What a function may take.
struct Limit {
    function: &'static str,
    /// Median of instructions.
    median: u32,
    /// Most over median of instructions.
    spread: f64,
    /// Flash and stack \[bytes\].
    flash: u64,
    stack: u32,
}

/// Of a law.
const fn law(function: &'static str, median: u32) -> Limit {
    Limit {
        function,
        median,
        spread: 1.15,
        flash: 6 * 1024,
        stack: 512,
    }
}

/// Of the guidance's fast step: what it takes, and 2 % for what comes. 3,000 are wanted. Three in ten instructions load constants and parameters or keep
/// what 32 registers do not hold.
const fn guidance(function: &'static str) -> Limit {
    Limit {
        function,
        median: 4_540,
        spread: 1.15,
        flash: 30_500,
        stack: 1120,
    }
}

/// Of a step and a plan. The loop of the rollouts is there twice, for large wings at high speed and
/// without: 3 kB, and 300 instructions less.
const fn plan(function: &'static str) -> Limit {
    Limit {
        function,
        median: 143_000,
        spread: 1.13,
        flash: 44_700,
        stack: 1160,
    }
}

/// Of the guidance whose state survives changes. 2 KiB are promised.
const fn hardened(function: &'static str) -> Limit {
    Limit {
        median: 5_680,
        // The longest step of the fuzz corpus.
        spread: 1.29,
        flash: 37_000,
        stack: 1720,
        ..guidance(function)
    }
}

/// Limits of the project.
const LIMITS: [Limit; 11] = [
    law("robust", 400),
    law("full_feed_forward", 900),
    guidance("guidance"),
    guidance("guidance_in_flight"),
    // With the air estimate, which the sweep does not ask for. 2 KiB of stack are promised.
    Limit {
        median: 5_070,
        spread: 1.1,
        stack: 1_190,
        ..guidance("guidance_flown")
    },
    plan("guidance_and_plan"),
    plan("guidance_and_plan_in_flight"),
    hardened("hardened"),
    hardened("hardened_in_flight"),
    law("winged_feed_forward", 900),
    // No step takes 1,000, whatever begins in it.
    Limit {
        flash: 27 * 1024,
        stack: 1024,
        spread: 1.239,
        ..law("mission_in_flight", 807)
    },
];

/// Lines of a page (`docs/results.md`) between which the table stands.
const BEGIN: &str = "<!-- cargo target-bench: begin -->\n";
const END: &str = "<!-- cargo target-bench: end -->\n";

/// Prints the table; with a file as argument, puts it there between its marks as well. With `--corpus` and a file of calls
/// (`fuzz/examples/frames.rs`), what the guidance needs over those.
pub fn main() -> Result<()> {
    let image = build(None)?;
    if env::args().nth(1).as_deref() == Some("--corpus") {
        return corpus(&image, &env::args().nth(2).ok_or("--corpus FILE")?);
    }
    let (mut rows, notes) = run(&image)?;
    add_cycles(&mut rows, &image)?;
    let empty = Weight::of(&build(Some("empty"))?)?;
    for row in &mut rows {
        let weight = Weight::of(&build(Some(&row.name))?)?;
        if weight.ram != empty.ram {
            return Err(format!("{} needs static RAM", row.name).into());
        }
        row.flash = weight.flash - empty.flash;
    }
    let text = format!("{}\nNo function adds static RAM. {notes}", table(&rows));
    print!("{text}");
    if let Some(file) = env::args().nth(1) {
        let old = fs::read_to_string(&file).map_err(|e| format!("{file}: {e}"))?;
        let parts = old
            .split_once(BEGIN)
            .and_then(|(a, b)| Some((a, b.split_once(END)?.1)));
        let (before, after) = parts.ok_or(format!("{file}: no lines {BEGIN}and {END}"))?;
        fs::write(&file, format!("{before}{BEGIN}{text}{END}{after}"))?;
    }
    check(&rows)
}

/// The project's limits on the control step.
fn check(rows: &[Row]) -> Result<()> {
    for limit in &LIMITS {
        let row = rows
            .iter()
            .find(|row| row.name == limit.function)
            .ok_or(format!("no {}", limit.function))?;
        if row.median > limit.median
            || f64::from(row.most) > limit.spread * f64::from(row.median)
            || row.flash > limit.flash
            || row.stack > limit.stack
        {
            return Err(format!("{} is over a limit", limit.function).into());
        }
    }
    Ok(())
}

/// Runs the image over the calls in `file`, and holds what they need against the guidance's limits.
fn corpus(image: &Path, file: &str) -> Result<()> {
    let output = qemu(image, &format!("corpus,arg={file}")).output();
    let output = output.map_err(missing)?;
    let text = String::from_utf8(output.stdout)?;
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        return Err(format!("the image failed: {text}{errors}").into());
    }
    let lines = [
        ("combined model", hardened("hardened")),
        ("model chosen at run time", hardened("hardened")),
        // 150,000 instructions are promised of any.
        (
            "plans",
            Limit {
                median: 150_000,
                spread: 1.0,
                ..plan("plan")
            },
        ),
    ];
    for ((model, limit), line) in lines.iter().zip(text.lines()) {
        let numbers: Vec<u32> = line.split(' ').filter_map(|n| n.parse().ok()).collect();
        let &[calls, most, stack] = numbers.as_slice() else {
            return Err(format!("not a result: {line}").into());
        };
        println!("{model}: {calls} calls, at most {most} instructions, {stack} bytes of stack");
        if f64::from(most) > limit.spread * f64::from(limit.median) || stack > limit.stack {
            return Err("the guidance is over a limit".into());
        }
    }
    Ok(())
}

/// Builds the image that measures, or the one that holds one function only.
fn build(footprint: Option<&str>) -> Result<PathBuf> {
    let cargo = env::var_os("CARGO").unwrap_or("cargo".into());
    let mut command = Command::new(cargo);
    command.args(["build", "--quiet", "--release", "--target", TARGET]);
    command.args(["--package", "alula-firmware", "--bin", "target-bench"]);
    // An incremental build is cut up otherwise, and costs up to 4 % more instructions.
    command.env("CARGO_INCREMENTAL", "0");
    match footprint {
        Some(name) => command.env("ALULA_FOOTPRINT", name),
        None => command.env_remove("ALULA_FOOTPRINT"),
    };
    if !command.status()?.success() {
        return Err("the image does not build".into());
    }
    // This program is <target directory>/release/target-bench.
    let own = env::current_exe()?;
    let directory = own.ancestors().nth(2).ok_or("no target directory")?;
    Ok(directory.join(TARGET).join("release/target-bench"))
}

/// QEMU with `image`, which is given `argument`.
fn qemu(image: &Path, argument: &str) -> Command {
    let mut command = Command::new("qemu-system-arm");
    command.args(["-M", "netduinoplus2", "-nographic", "-monitor", "none"]);
    command.args(["-serial", "none", "-icount", "shift=0"]);
    command.arg("-semihosting-config");
    command.arg(format!("enable=on,target=native,arg={argument}"));
    command.arg("-kernel").arg(image);
    command
}

fn missing(error: std::io::Error) -> String {
    format!("qemu-system-arm: {error} (Debian: apt install qemu-system-arm)")
}

/// Runs the image, and reads its lines: results, and notes after a `#`.
fn run(image: &Path) -> Result<(Vec<Row>, String)> {
    let output = qemu(image, "measure").output().map_err(missing)?;
    let text = String::from_utf8(output.stdout)?;
    if !output.status.success() {
        let errors = String::from_utf8_lossy(&output.stderr);
        return Err(format!("the image failed: {text}{errors}").into());
    }
    let row = |line: &str| {
        let words: Vec<_> = line.split(' ').collect();
        let &[name, least, median, most, stack] = words.as_slice() else {
            return Err(format!("not a result: {line}").into());
        };
        Ok(Row {
            name: name.into(),
            least: least.parse()?,
            median: median.parse()?,
            most: most.parse()?,
            cycles: (0, 0),
            stack: stack.parse()?,
            flash: 0,
        })
    };
    let (notes, results): (Vec<_>, Vec<_>) = text.lines().partition(|l| l.starts_with('#'));
    let notes = notes
        .iter()
        .map(|l| l.trim_start_matches("# ").to_owned() + "\n");
    Ok((
        results.into_iter().map(row).collect::<Result<_>>()?,
        notes.collect(),
    ))
}

/// Runs the image with QEMU's log on, and gives each row its modelled cycles.
///
/// The instructions in the log must be those of the emulator's clock, call by call.
fn add_cycles(rows: &mut [Row], image: &Path) -> Result<()> {
    let marks = marks(image)?;
    let mut command = qemu(image, "trace");
    command.args(["-d", "in_asm,exec,nochain"]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(missing)?;
    let log = child.stderr.take().ok_or("no log")?;
    let mut stdout = child.stdout.take().ok_or("no output")?;
    let (costs, text) = std::thread::scope(|scope| {
        let log = scope.spawn(move || trace::costs(BufReader::new(log), marks));
        let mut text = String::new();
        let read = stdout.read_to_string(&mut text);
        (log.join(), read.map(|_| text))
    });
    let (costs, text) = (costs.map_err(|_| "the log's reader failed")??, text?);
    if !child.wait()?.success() || text.lines().count() != costs.len() {
        return Err(format!("the traced image failed: {text}").into());
    }
    let mut calls = Vec::new();
    for (line, cost) in text.lines().zip(costs) {
        let (name, ticks) = line.split_once(' ').ok_or(line)?;
        calls.push((name, ticks.parse::<u32>()?, cost));
    }
    // The same for every call: the call itself, and the marks.
    let &(_, empty_ticks, empty) = calls.iter().find(|c| c.0 == "empty").ok_or("no empty")?;
    for row in rows {
        let mut cycles = Vec::new();
        for &(
            _,
            ticks,
            Cost {
                instructions,
                cycles: c,
            },
        ) in calls.iter().filter(|c| c.0 == row.name)
        {
            if instructions - empty.instructions != ticks - empty_ticks {
                let (traced, clocked) = (instructions - empty.instructions, ticks - empty_ticks);
                return Err(format!(
                    "{}: {traced} instructions in the log, {clocked} by the clock",
                    row.name
                )
                .into());
            }
            cycles.push(c - empty.cycles);
        }
        cycles.sort_unstable();
        let median = cycles.get(cycles.len() / 2).ok_or("not traced")?;
        row.cycles = (*median, *cycles.last().ok_or("not traced")?);
    }
    Ok(())
}

/// Where the image marks the beginning and the end of a traced call.
fn marks(image: &Path) -> Result<Marks> {
    let data = fs::read(image)?;
    let file = object::File::parse(&*data)?;
    let address = |name: &str| {
        let symbol = file.symbols().find(|s| s.name() == Ok(name));
        // The lowest bit says that the function is Thumb code.
        symbol
            .map(|s| s.address() as u32 & !1)
            .ok_or(format!("the image has no {name}"))
    };
    Ok(Marks {
        begin: address("trace_begin")?,
        end: address("trace_end")?,
    })
}

/// What an image occupies \[bytes\].
struct Weight {
    /// Code, constants, and the initial values of `.data`.
    flash: u64,
    /// `.data` and `.bss`.
    ram: u64,
}

impl Weight {
    fn of(image: &Path) -> Result<Self> {
        let data = fs::read(image)?;
        let file = object::File::parse(&*data)?;
        let mut weight = Self { flash: 0, ram: 0 };
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags, .. } = section.flags() else {
                continue;
            };
            if !sh_flags.contains(elf::SHF_ALLOC) {
                continue;
            }
            let writable = sh_flags.contains(elf::SHF_WRITE);
            if writable {
                weight.ram += section.size();
            }
            if !writable || section.file_range().is_some() {
                weight.flash += section.size();
            }
        }
        Ok(weight)
    }
}

fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| function | instructions: least | median | most | modelled cycles: median | most | flash [bytes] | stack [bytes] |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for r in rows {
        let (median, most) = r.cycles;
        text += &format!(
            "| {} | {} | {} | {} | {median} | {most} | {} | {} |\n",
            r.name, r.least, r.median, r.most, r.flash, r.stack
        );
    }
    text
}
