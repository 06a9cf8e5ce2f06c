//! An emulated target.

use std::io::ErrorKind;
use std::os::fd::OwnedFd;
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Child, Command};

use anyhow::{Context, bail};

use super::target::ATTEMPT;

/// QEMU with the image in it; ended when dropped.
pub struct Qemu(Child);

impl Qemu {
    /// Starts `image` on QEMU's STM32F405 machine, in real time. Returns the emulator and its USART1.
    pub fn start(image: &Path) -> anyhow::Result<(Self, UnixStream)> {
        std::fs::metadata(image).with_context(|| image.display().to_string())?;
        let (near, far) = UnixStream::pair()?;
        near.set_read_timeout(Some(ATTEMPT))?;
        let far = OwnedFd::from(far);
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
            .spawn();
        match child {
            Err(error) if error.kind() == ErrorKind::NotFound => {
                bail!("qemu-system-arm is missing (Debian, Ubuntu: apt install qemu-system-arm)")
            }
            child => Ok((Self(child.context("qemu-system-arm")?), near)),
        }
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        // Nothing can be done about an emulator that does not end.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
