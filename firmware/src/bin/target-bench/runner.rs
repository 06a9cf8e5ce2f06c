//! The host's half: builds the image, runs it under QEMU, weighs every function, prints the table.

use object::{Object, ObjectSection, SectionFlags, elf};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, error::Error, fs};

const TARGET: &str = "thumbv7em-none-eabihf";
type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// One function's line.
struct Row {
    name: String,
    least: u32,
    median: u32,
    most: u32,
    stack: u32,
    flash: u64,
}

/// Limits of the project, `(function, median, worst over median)`.
const INSTRUCTIONS: [(&str, u32, f64); 4] = [
    ("robust", 400, 1.15),
    ("full_feed_forward", 900, 1.15),
    ("guidance", 900, 1.15),
    ("winged_feed_forward", 900, 1.15),
];
/// Most flash and stack of a control step \[bytes\].
const STEP: (u64, u32) = (6 * 1024, 512);

/// Lines of a README between which the table stands.
const BEGIN: &str = "<!-- cargo target-bench: begin -->\n";
const END: &str = "<!-- cargo target-bench: end -->\n";

/// Prints the table; with a file as argument, puts it there between its marks as well.
pub fn main() -> Result<()> {
    let (mut rows, notes) = run(&build(None)?)?;
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
    for (name, median, spread) in INSTRUCTIONS {
        let row = rows
            .iter()
            .find(|row| row.name == name)
            .ok_or(format!("no {name}"))?;
        let (flash, stack) = STEP;
        if row.median > median
            || f64::from(row.most) > spread * f64::from(row.median)
            || row.flash > flash
            || row.stack > stack
        {
            return Err(format!("{name} is over a limit").into());
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

/// Runs the image, and reads its lines: results, and notes after a `#`.
fn run(image: &Path) -> Result<(Vec<Row>, String)> {
    let output = Command::new("qemu-system-arm")
        .args([
            "-M",
            "netduinoplus2",
            "-nographic",
            "-monitor",
            "none",
            "-serial",
            "none",
        ])
        .args([
            "-icount",
            "shift=0",
            "-semihosting-config",
            "enable=on,target=native",
            "-kernel",
        ])
        .arg(image)
        .output()
        .map_err(|e| format!("qemu-system-arm: {e} (Debian: apt install qemu-system-arm)"))?;
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
        "| function | instructions: least | median | most | flash [bytes] | stack [bytes] |\n\
         |---|---:|---:|---:|---:|---:|\n",
    );
    for r in rows {
        let Row {
            name,
            least,
            median,
            most,
            flash,
            stack,
        } = r;
        text += &format!("| {name} | {least} | {median} | {most} | {flash} | {stack} |\n");
    }
    text
}
