//! Linker arguments of the images. Given here and not in a config file: an environment `RUSTFLAGS` replaces
//! the flags of a config file, and what links then is an empty image.

fn main() {
    if std::env::var("CARGO_CFG_TARGET_OS").as_deref() == Ok("none") {
        println!("cargo:rustc-link-arg-bins=-Tlink.x");
        println!("cargo:rustc-link-arg-bins=--nmagic");
        println!("cargo:rustc-link-arg-bin=alula-firmware=-Tdefmt.x");
    }
    println!("cargo:rerun-if-changed=../memory.x");
}
