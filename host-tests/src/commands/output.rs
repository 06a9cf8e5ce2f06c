//! What commands leave behind: a figure, a page, and text or JSON on standard output.

use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use serde::Serialize;

use alula_report::page::{PAGE, Page, SHEET};
use alula_report::viewer::{self, Flight};
use alula_study::files::{leave_all, make_folder};

/// Where results go.
#[derive(clap::Args, Default)]
pub struct Output {
    /// Folder for the results [default: under out/, by command and name]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Print one JSON object instead of the tables
    #[arg(long)]
    json: bool,
    /// Open the page in the browser
    #[arg(long)]
    open: bool,
}

impl Output {
    /// Where results go by default: as JSON or not, with the page opened or not.
    pub fn new(json: bool, open: bool) -> Self {
        Self {
            json,
            open,
            ..Self::default()
        }
    }

    /// Says which page to open, unless JSON was asked for, and opens it if that was.
    pub fn show(&self, page: &Path) -> anyhow::Result<()> {
        if !self.json {
            writeln!(std::io::stdout(), "open {}", page.display())?;
        }
        if self.open {
            open::that(page)
                .with_context(|| format!("--open: no browser for {}", page.display()))?;
        }
        Ok(())
    }

    /// Whether JSON was asked for.
    pub fn json(&self) -> bool {
        self.json
    }

    /// The folder asked for, or `out/<name>`; made if it is not there.
    pub fn folder(&self, name: &str) -> anyhow::Result<PathBuf> {
        let folder = (self.out.clone()).unwrap_or_else(|| Path::new("out").join(name));
        make_folder(&folder)?;
        Ok(folder)
    }

    /// Leaves the page in `folder`, as [`PAGE`] and [`SHEET`]; then prints `summary` as JSON if that was asked for, or
    /// else the page as text.
    pub fn leave(
        &self,
        folder: &Path,
        page: &Page,
        summary: &impl Serialize,
    ) -> anyhow::Result<()> {
        page.leave(folder)?;
        let mut stdout = std::io::stdout().lock();
        if self.json {
            writeln!(stdout, "{}", serde_json::to_string_pretty(summary)?)?;
        } else {
            let place = folder.display();
            writeln!(stdout, "{}\n{SHEET} and {PAGE} are in {place}", page.text())?;
        }
        drop(stdout);
        self.show(&folder.join(PAGE))
    }
}

/// Leaves `flights` in three dimensions in `folder`, and links them from `page`; nothing if there are none.
pub fn leave_view(
    page: &mut Page,
    folder: &Path,
    title: &str,
    flights: &[Flight],
) -> anyhow::Result<()> {
    for flight in flights {
        let words = format!("{} in three dimensions", flight.name);
        page.links.push((viewer::address(&flight.name), words));
    }
    match flights {
        [] => Ok(()),
        _ => leave_all(
            &folder.join(viewer::FILE),
            viewer::recorded(title, flights)?,
        ),
    }
}
