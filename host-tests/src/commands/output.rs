//! What the analyses leave behind: a picture, a page, and text or JSON on standard output.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;

use alula_sil::files;
use alula_sil::report::Page;

/// The folder asked for, or `out/<name>`; made if it is not there.
pub fn folder(asked: Option<&Path>, name: &str) -> anyhow::Result<PathBuf> {
    let folder = asked.map_or_else(|| Path::new("out").join(name), Path::to_owned);
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    Ok(folder)
}

/// Leaves `<stem>.svg` and `<stem>.html` in `folder`; then prints `json`, or the page as text.
pub fn leave(
    folder: &Path,
    stem: &str,
    page: &Page,
    json: Option<&impl Serialize>,
) -> anyhow::Result<()> {
    let html = page.html()?;
    for (extension, content) in [("svg", &page.svg), ("html", &html)] {
        files::leave(&folder.join(stem).with_extension(extension), |file| {
            Ok(file.write_all(content.as_bytes())?)
        })?;
    }
    let mut stdout = std::io::stdout().lock();
    match json {
        Some(json) => writeln!(stdout, "{}", serde_json::to_string_pretty(json)?)?,
        None => {
            let place = folder.display();
            writeln!(
                stdout,
                "{}\n{stem}.svg and {stem}.html are in {place}",
                page.text()
            )?;
        }
    }
    Ok(())
}
