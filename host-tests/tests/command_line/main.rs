//! The command line, and what it leaves.
#[path = "../common/mod.rs"]
mod common;

use std::path::Path;
use std::process::{Command, Output};

mod analysis;
mod ardupilot;
mod campaigns;
mod comparison;
mod identify;
mod logs;
mod new;
mod usage;

/// The program with these arguments in `folder`, with nothing to read.
fn alula(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_alula-sil"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}
