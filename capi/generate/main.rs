//! Writes the generated files.
#![cfg(not(target_os = "none"))]

#[path = "mod.rs"]
mod generate;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (path, text) in generate::files()? {
        if let Some(directory) = path.parent() {
            std::fs::create_dir_all(directory)?;
        }
        std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("{}", path.display());
    }
    Ok(())
}
