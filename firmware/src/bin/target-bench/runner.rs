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

pub fn main() -> Result<()> {
    let image = build(None)?;
    let mut rows = run(&image)?;
    let empty = Weight::of(&build(Some("empty"))?)?;
    for row in &mut rows {
        let weight = Weight::of(&build(Some(&row.name))?)?;
        if weight.ram != empty.ram {
            return Err(format!("{} needs static RAM", row.name).into());
        }
        row.flash = weight.flash - empty.flash;
    }
    print!("{}", table(&rows));
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

/// Runs the image, and reads its lines.
fn run(image: &Path) -> Result<Vec<Row>> {
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
    text.lines().map(row).collect()
}

/// What an image occupies [bytes].
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
