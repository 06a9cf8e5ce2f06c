//! An emulated target.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, Command};

use anyhow::{Context, bail};

use super::target::ATTEMPT;

/// QEMU with the image in it; ended when dropped.
pub struct Qemu {
    child: Child,
    /// What it says on standard error.
    said: File,
}

impl Qemu {
    /// Starts `image` on QEMU's STM32F405 machine, in real time. Returns the emulator and its USART1.
    pub fn start(image: &Path) -> anyhow::Result<(Self, UnixStream)> {
        std::fs::metadata(image).with_context(|| image.display().to_string())?;
        let (near, far) = UnixStream::pair()?;
        near.set_read_timeout(Some(ATTEMPT))?;
        let far = OwnedFd::from(far);
        let said = tempfile::tempfile()?;
        let child = Command::new("qemu-system-arm")
            .args([
                "-M",
                "netduinoplus2",
                "-display",
                "none",
                "-monitor",
                "none",
            ])
            // One thread for all of its parts costs a tenth less per byte.
            .args(["-accel", "tcg,thread=single", "-serial", "stdio", "-kernel"])
            .arg(image)
            .stdin(far.try_clone()?)
            .stdout(far)
            .stderr(said.try_clone()?)
            .spawn();
        match child {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                bail!("qemu-system-arm is missing (Debian, Ubuntu: apt install qemu-system-arm)")
            }
            child => {
                let child = child.context("qemu-system-arm")?;
                Ok((Self { child, said }, near))
            }
        }
    }

    /// Why it ended, if it has said so. After that it lists every register of the processor.
    pub fn complaint(&mut self) -> Option<String> {
        let mut text = String::new();
        self.said.seek(SeekFrom::Start(0)).ok()?;
        self.said.read_to_string(&mut text).ok()?;
        text.lines().next().map(str::to_owned)
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        // Nothing can be done about an emulator that does not end.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
