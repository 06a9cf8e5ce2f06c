//! `docs/architecture.md` is true: its lists of rooms are complete, and the arrows between rooms point one way.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The rooms listed on the page under `heading`, in order: the first cell of each row, up to the next heading.
fn listed(heading: &str) -> Vec<String> {
    let page = fs::read_to_string(root().join("docs/architecture.md")).unwrap();
    let section = page.split_once(heading).expect(heading).1;
    let section = section.split("\n## ").next().unwrap();
    let cells = section.lines().filter_map(|line| {
        let cell = line.strip_prefix("| `")?.split('`').next()?;
        Some(cell.to_owned())
    });
    cells.collect()
}

/// The rooms that are there: files and folders of `folder`, but for the roots of crates.
fn rooms(folder: &str) -> Vec<String> {
    let mut rooms: Vec<String> = fs::read_dir(root().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .map(|name| name.trim_end_matches(".rs").to_owned())
        .filter(|name| !matches!(name.as_str(), "lib" | "main"))
        .collect();
    rooms.sort();
    rooms
}

/// Every Rust file of a room.
fn files(path: &Path, found: &mut Vec<PathBuf>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            files(&entry.unwrap().path(), found);
        }
    } else if path.extension().is_some_and(|e| e == "rs") {
        found.push(path.to_owned());
    }
}

/// Imports by `crate::` from a room further down the list, outside tests.
fn arrows_back(folder: &str, order: &[String]) -> Vec<String> {
    let mut wrong = Vec::new();
    for (place, room) in order.iter().enumerate() {
        let base = root().join(folder).join(room);
        let mut of_room = Vec::new();
        files(&base, &mut of_room);
        let file = base.with_extension("rs");
        if file.is_file() {
            of_room.push(file);
        }
        for file in of_room {
            let text = fs::read_to_string(&file).unwrap();
            let code = text.split("#[cfg(test)]").next().unwrap();
            let lines = code.lines().map(str::trim_start);
            for line in lines.filter(|line| !line.starts_with("//")) {
                for after in line.split("crate::").skip(1) {
                    let to: String = after
                        .chars()
                        .take_while(|c| c.is_ascii_alphanumeric() || *c == '_')
                        .collect();
                    let back = order.iter().position(|name| *name == to);
                    if back.is_some_and(|back| back > place) {
                        wrong.push(format!("{room} -> {to} in {}", file.display()));
                    }
                }
            }
        }
    }
    wrong
}

fn check(heading: &str, folder: &str) {
    let order = listed(heading);
    let mut sorted = order.clone();
    sorted.sort();
    assert_eq!(sorted, rooms(folder), "rooms of {folder}");
    let wrong = arrows_back(folder, &order);
    assert!(
        wrong.is_empty(),
        "arrows that point back:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn the_rooms_of_the_core_are_listed_and_its_arrows_point_one_way() {
    check("## The core", "src");
}

#[test]
fn the_rooms_of_the_harness_are_listed_and_its_arrows_point_one_way() {
    check("## The harness", "host-tests/src");
}
