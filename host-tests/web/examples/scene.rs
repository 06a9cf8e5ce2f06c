//! The numbers of an experiment's scene, in hexadecimal, with the elementary functions that a browser has: `cargo run -p alula-web --example scene -- NAME`.
//!
//! On this machine Rust takes sines and logarithms in double precision from the C library, in a browser from the crate `libm`. Here they are
//! those of `libm`, too: what is left to differ is the code.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    loop {}
}

/// Functions of one number in place of the C library's.
#[cfg(not(target_os = "none"))]
macro_rules! in_place {
    ($($name:ident)*) => {
        $(
            #[unsafe(no_mangle)]
            extern "C" fn $name(x: f64) -> f64 {
                libm::$name(x)
            }
        )*
    };
}

#[cfg(not(target_os = "none"))]
mod functions {
    in_place! { sin cos tan asin acos atan exp exp2 expm1 log log2 log10 log1p sinh cosh tanh cbrt }

    #[unsafe(no_mangle)]
    extern "C" fn atan2(y: f64, x: f64) -> f64 {
        libm::atan2(y, x)
    }

    #[unsafe(no_mangle)]
    extern "C" fn hypot(x: f64, y: f64) -> f64 {
        libm::hypot(x, y)
    }

    #[unsafe(no_mangle)]
    extern "C" fn pow(x: f64, y: f64) -> f64 {
        libm::pow(x, y)
    }

    #[unsafe(no_mangle)]
    extern "C" fn fmod(x: f64, y: f64) -> f64 {
        libm::fmod(x, y)
    }

    /// The compiler makes it of a sine and a cosine.
    #[unsafe(no_mangle)]
    extern "C" fn sincos(x: f64, sin: &mut f64, cos: &mut f64) {
        (*sin, *cos) = libm::sincos(x);
    }
}

#[cfg(not(target_os = "none"))]
fn main() -> anyhow::Result<()> {
    use std::io::Write;

    use alula_sim::experiment::Document;
    use alula_sim::scene::Scene;
    use alula_sim::simulate::fly;
    use anyhow::Context;

    let name = std::env::args().nth(1).context("which experiment?")?;
    let experiment = Document::load(&name)?.checked()?;
    let scene = Scene::of(&experiment, &fly(&experiment)?);
    let mut stdout = std::io::stdout().lock();
    for number in scene.rows {
        writeln!(stdout, "{:x}", number.to_bits())?;
    }
    Ok(())
}
