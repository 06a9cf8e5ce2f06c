//! Compiles the library for browsers into the program, which puts it into a page: `$OUT_DIR/alula_web.wasm`. Of builds that are not
//! optimised, of the target's, and without Rust's target for browsers it is empty.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

const TARGET: &str = "wasm32-unknown-unknown";
/// The profile of `Cargo.toml`.
const PROFILE: &str = "web";
/// What decides how it is compiled, beside its sources.
const SETTINGS: [&str; 5] = [
    "build.rs",
    "web/Cargo.toml",
    "../Cargo.toml",
    "../Cargo.lock",
    "../.cargo/config.toml",
];

fn main() {
    for file in SETTINGS {
        println!("cargo::rerun-if-changed={file}");
    }
    let library = PathBuf::from(of("OUT_DIR")).join("alula_web.wasm");
    let flies = of("PROFILE") == "release" && of("CARGO_CFG_TARGET_OS") != "none";
    if flies && is_installed() {
        compile(&library);
    } else {
        fs::write(library, []).expect("OUT_DIR can be written");
    }
}

fn of(variable: &str) -> String {
    env::var(variable).unwrap_or_else(|_| panic!("cargo sets {variable}"))
}

/// What a program that has to succeed says.
fn said(command: &mut Command) -> String {
    let done = command.output().expect("it can be run");
    let complaint = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{command:?}: {complaint}");
    String::from_utf8_lossy(&done.stdout).trim().to_owned()
}

/// Whether Rust's standard library is there for browsers. Asked again when something is installed beside it.
fn is_installed() -> bool {
    let folder =
        said(Command::new(of("RUSTC")).args(["--print", "target-libdir", "--target", TARGET]));
    let folder = Path::new(&folder);
    // Its folder is `rustlib/TARGET/lib`.
    if let Some(all) = folder.ancestors().nth(2) {
        println!("cargo::rerun-if-changed={}", all.display());
    }
    folder.exists()
}

/// Compiles it as a build of its own, with none of the settings of this one.
fn compile(to: &Path) {
    let build = Path::new(&of("OUT_DIR")).join("browser");
    said(
        Command::new(of("CARGO"))
            .args([
                "build",
                "--lib",
                "-p",
                "alula-web",
                "--profile",
                PROFILE,
                "--target",
                TARGET,
            ])
            .arg("--target-dir")
            .arg(&build)
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .env_remove("RUSTFLAGS")
            .env_remove("RUSTC_WORKSPACE_WRAPPER"),
    );
    let left = build.join(TARGET).join(PROFILE);
    fs::copy(left.join("alula_web.wasm"), to).expect("cargo left the library");
    // "library: source source …", where a blank in a name has a backslash before it.
    let sources = fs::read_to_string(left.join("alula_web.d")).expect("cargo left its sources");
    let (_, sources) = sources.split_once(": ").expect("a list of sources");
    for source in sources.trim().replace("\\ ", "\0").split(' ') {
        println!("cargo::rerun-if-changed={}", source.replace('\0', " "));
    }
}
