//! `capi/install` without the tools that it needs.
#![cfg(unix)]

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

/// A script that stands in for a program.
fn stand_in(directory: &Path, name: &str, body: &str) {
    let path = directory.join(name);
    std::fs::write(&path, format!("#!/bin/sh\n{body}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

/// A toolchain without `llvm-tools` is refused before anything is compiled or written, and the message says what to
/// install.
#[test]
fn without_llvm_tools_nothing_is_built_and_the_message_says_what_to_install() {
    let scratch = tempfile::tempdir().unwrap();
    let (bin, prefix) = (scratch.path().join("bin"), scratch.path().join("prefix"));
    let built = scratch.path().join("built");
    std::fs::create_dir(&bin).unwrap();
    // A Rust toolchain whose directory holds no tools, and a cargo that leaves a mark.
    stand_in(
        &bin,
        "rustc",
        "case $1 in --print) echo /nonexistent ;; *) echo 'host: x86_64-unknown-linux-gnu' ;; esac",
    );
    stand_in(
        &bin,
        "cargo",
        &format!("touch '{}'; exit 1", built.display()),
    );
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    let out = Command::new("bash")
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/install"))
        .arg(&prefix)
        .env("PATH", path)
        .output()
        .unwrap();
    let message = String::from_utf8(out.stderr).unwrap();
    assert!(!out.status.success());
    assert!(
        message.contains("rustup component add llvm-tools"),
        "{message}"
    );
    assert!(!built.exists(), "cargo was called");
    assert!(!prefix.exists(), "the prefix was created");
}
