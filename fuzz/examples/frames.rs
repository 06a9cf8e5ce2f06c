//! Writes the calls of the guidance in the corpus of the target `guidance`, for the bench of the emulated target.
//!
//! `cargo run --release --example frames -- FILE`, then `cargo target-bench --corpus FILE` in the folder above. With folders after FILE, their
//! inputs in place of the corpus.
//!
//! For each input a frame of the link with its configuration, and for each call the memory before it, as bytes, and a frame with
//! its input; before either a byte that says which. Inputs whose vehicle has a table are left out, and calls with an attitude that is none:
//! the link knows neither.

use std::error::Error;
use std::fs;
use std::path::PathBuf;

use alula_link::{
    Configuration, ControllerParameters, Counters, Input, MAX_FRAME, Pacing, Receiver, ToTarget,
    encode,
};

/// The message in a frame, if the other side can read it.
fn frame(message: &ToTarget) -> Option<Vec<u8>> {
    let mut buffer = [0; MAX_FRAME];
    let frame = encode(message, &mut buffer).expect("every message has room");
    let (mut receiver, mut counters) = (Receiver::new(), Counters::default());
    let heard = frame
        .iter()
        .find_map(|&byte| receiver.push::<ToTarget>(byte, &mut counters));
    heard.map(|_| frame.to_vec())
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let to = arguments.next().ok_or("frames FILE [FOLDER…]")?;
    let mut folders: Vec<PathBuf> = arguments.map(PathBuf::from).collect();
    if folders.is_empty() {
        folders.push(concat!(env!("CARGO_MANIFEST_DIR"), "/corpus/guidance").into());
    }
    let mut inputs = Vec::new();
    for folder in folders {
        for entry in fs::read_dir(folder)? {
            inputs.push(entry?.path());
        }
    }
    inputs.sort();
    let (mut out, mut guidances, mut count, mut left_out) = (Vec::new(), 0, 0, 0);
    for input in inputs {
        let mut calls = Vec::new();
        let made = alula_fuzz::guidance::calls(&fs::read(input)?, &mut |memory, input, dt| {
            let input = *input;
            match frame(&ToTarget::Input(Input::Guidance { input, dt })) {
                Some(frame) => {
                    calls.push(1);
                    calls.extend(memory.to_bytes());
                    calls.extend(frame);
                    count += 1;
                }
                None => left_out += 1,
            }
        });
        if let Some(alula_fuzz::guidance::Made {
            vehicle,
            model,
            parameters,
        }) = made
        {
            guidances += 1;
            out.push(0);
            let configuration = ToTarget::Configure(Configuration {
                vehicle,
                model,
                controller: ControllerParameters::Guidance {
                    parameters,
                    gains: None,
                },
                pacing: Pacing::Lockstep,
            });
            out.extend(frame(&configuration).expect("it was accepted"));
            out.append(&mut calls);
        }
    }
    fs::write(to, out)?;
    println!("{count} calls of {guidances} guidances, {left_out} calls left out");
    Ok(())
}
