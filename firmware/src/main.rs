//! The image for the STM32F405: the supervised control loop on a serial link, a timer and a motor output.
//!
//! USART1 on PA9 (transmit) and PA10 (receive), 1 Mbit/s 8N1. Motor pulse at 400 Hz on PA6 (TIM3). PB12 to
//! ground arms it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod board;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("alula-firmware is an image: build it with --target thumbv7em-none-eabihf");
    std::process::exit(2);
}
