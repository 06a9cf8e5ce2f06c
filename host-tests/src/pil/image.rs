//! Building the image.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context, bail};

/// Which image.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Build {
    /// The one to flash.
    Release,
    /// The same with one coefficient of the received configuration off by one unit in the last place.
    Perturbed,
}

/// Builds the image in the workspace that the current directory is in; returns its path.
pub fn build(build: Build) -> anyhow::Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
    let mut command = Command::new(cargo);
    command.args([
        "build",
        "--quiet",
        "--release",
        "--target",
        "thumbv7em-none-eabihf",
    ]);
    command.args(["--package", "alula-firmware", "--bin", "alula-firmware"]);
    command.arg("--message-format=json-render-diagnostics");
    if build == Build::Perturbed {
        command.args(["--features", "perturbed"]);
    }
    let hint = "cannot build the image here (run in the workspace, or give an image by --image)";
    let output = command
        .stderr(std::process::Stdio::inherit())
        .output()
        .context(hint)?;
    if !output.status.success() {
        bail!(hint);
    }
    let built = String::from_utf8(output.stdout)?
        .lines()
        .filter_map(|line| serde_json::from_str::<serde_json::Value>(line).ok())
        .find_map(|message| Some(PathBuf::from(message.get("executable")?.as_str()?)))
        .context("cargo names no image")?;
    if build == Build::Release {
        return Ok(built);
    }
    // Where the next build of the other does not overwrite it.
    let kept = built.with_extension("perturbed");
    std::fs::copy(&built, &kept).with_context(|| kept.display().to_string())?;
    Ok(kept)
}
