//! `docs/architecture.md` is true: its lists of crates and rooms are complete, and the arrows between them point one way.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The page under `heading`, up to the next one.
fn section(heading: &str) -> String {
    let page = fs::read_to_string(root().join("docs/architecture.md")).unwrap();
    let section = page
        .split_once(&format!("\n{heading}\n"))
        .expect(heading)
        .1
        .to_owned();
    section.split("\n##").next().unwrap().to_owned()
}

/// The rows of a section's table whose first cell is a name: that, and the other cells.
fn rows(section: &str) -> Vec<(String, Vec<String>)> {
    let rows = section.lines().filter_map(|line| {
        let (name, rest) = line.strip_prefix("| `")?.split_once("` |")?;
        Some((
            name.to_owned(),
            rest.split('|').map(|cell| cell.trim().to_owned()).collect(),
        ))
    });
    rows.collect()
}

/// The rooms that are there: files and folders of `folder` that hold Rust, but for the roots of crates.
fn rooms(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(root().join(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut rooms: Vec<String> = paths
        .filter(|path| path.is_dir() || path.extension().is_some_and(|e| e == "rs"))
        .filter(|path| {
            let mut of_room = Vec::new();
            files(path, &mut of_room);
            !of_room.is_empty()
        })
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .filter(|name| !matches!(name.as_str(), "lib" | "main"))
        .collect();
    rooms.sort();
    rooms.dedup();
    rooms
}

/// Every Rust file of a room.
fn files(path: &Path, files_found: &mut Vec<PathBuf>) {
    if path.is_dir() {
        for entry in fs::read_dir(path).unwrap() {
            files(&entry.unwrap().path(), files_found);
        }
    } else if path.extension().is_some_and(|e| e == "rs") {
        files_found.push(path.to_owned());
    }
}

/// The rooms that `code` names behind one of `roots`, alone or in a group: `crate::{a, b::{c, d}}` names a and b.
fn imports(code: &str, roots: &[&str]) -> Vec<String> {
    let name = |text: &str| -> String {
        let letters = text.trim_start().chars();
        let letters = letters.take_while(|c| c.is_ascii_alphanumeric() || *c == '_');
        letters.collect()
    };
    let mut names = Vec::new();
    for after in roots.iter().flat_map(|root| code.split(root).skip(1)) {
        let Some(group) = after.strip_prefix('{') else {
            names.push(name(after));
            continue;
        };
        let (mut depth, mut begin) = (1, 0);
        for (at, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => {
                    names.push(name(&group[begin..at]));
                    begin = at + 1;
                }
                _ => {}
            }
            if depth == 0 {
                names.push(name(&group[begin..at]));
                break;
            }
        }
    }
    names
}

#[test]
fn imports_are_seen_alone_and_in_groups() {
    let code = "use crate::air::{AirData, Wind}; use crate::{aero::{self, Table}, math, vehicle::Vehicle}; fn f() { crate::guidance::g() }";
    let seen = imports(code, &["crate::"]);
    assert_eq!(seen, ["air", "aero", "math", "vehicle", "guidance"]);
    assert_eq!(
        imports("use super::{ned,}", &["crate::", "super::"]),
        ["ned", ""]
    );
}

/// Imports by `crate::` from a room further down the list, outside tests.
fn arrows_back(folder: &str, order: &[String]) -> Vec<String> {
    let mut wrong = Vec::new();
    for (place, room) in order.iter().enumerate() {
        let base = root().join(folder).join(room);
        let mut of_room = Vec::new();
        files(&base, &mut of_room);
        let alone = base.with_extension("rs");
        if alone.is_file() {
            of_room.push(alone.clone());
        }
        for file in of_room {
            let text = fs::read_to_string(&file).unwrap();
            let code = text.split("#[cfg(test)]\nmod ").next().unwrap();
            let roots: &[&str] = match file == alone || file == base.join("mod.rs") {
                true => &["crate::", "super::"],
                false => &["crate::"],
            };
            let lines = code.lines().map(str::trim_start);
            let lines = lines.filter(|line| !line.starts_with("//"));
            for to in imports(&lines.collect::<Vec<_>>().join(" "), roots) {
                let back = order.iter().position(|name| *name == to);
                if back.is_some_and(|back| back > place) {
                    wrong.push(format!("{room} -> {to} in {}", file.display()));
                }
            }
        }
    }
    wrong
}

fn check(heading: &str, folder: &str) {
    let order: Vec<String> = rows(&section(heading)).into_iter().map(|r| r.0).collect();
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

/// The folder of a crate of the harness.
fn folder(name: &str) -> String {
    match name {
        "sil" => "host-tests".to_owned(),
        _ => format!("host-tests/{name}"),
    }
}

#[test]
fn the_rooms_of_the_harness_are_listed_and_its_arrows_point_one_way() {
    for (name, _) in rows(&section("## The harness")) {
        check(&format!("### `{name}`"), &format!("{}/src", folder(&name)));
    }
}

/// Each crate of the harness depends on those that its row says, which stand above it.
#[test]
fn the_crates_of_the_harness_use_only_those_above_them() {
    let crates = rows(&section("## The harness"));
    assert!(crates.len() > 2, "{crates:?}");
    for (place, (name, cells)) in crates.iter().enumerate() {
        let above: Vec<&str> = crates[..place].iter().map(|(name, _)| &**name).collect();
        let said: Vec<&str> = match cells[0].as_str() {
            "all" => above.clone(),
            cell => cell
                .split(", ")
                .map(|name| name.trim_matches('`'))
                .collect(),
        };
        let manifest = root().join(folder(name)).join("Cargo.toml");
        let manifest = fs::read_to_string(manifest).unwrap();
        for (other, _) in &crates {
            let uses = manifest.contains(&format!("\nalula-{other} = "));
            assert_eq!(uses, said.contains(&&**other), "{name} uses {other}");
            assert!(
                !uses || above.contains(&&**other),
                "{name} is above {other}"
            );
        }
    }
    let members = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    for (name, _) in &crates {
        let member = format!("\"{}\"", folder(name));
        assert_eq!(
            members.matches(&member).count(),
            2,
            "{member} in Cargo.toml"
        );
    }
}

/// What Python and a browser build need is small: none of the packages that only campaigns in folders, pages or the command line take.
#[test]
fn the_python_package_needs_neither_parquet_nor_the_command_line() {
    let lock = fs::read_to_string(root().join("python/Cargo.lock")).unwrap();
    let packages: Vec<&str> = lock
        .lines()
        .filter_map(|line| line.strip_prefix("name = ")?.split('"').nth(1))
        .collect();
    assert!(packages.contains(&"alula-study") && packages.contains(&"rayon"));
    for apart in ["parquet", "clap", "minijinja", "alula-report", "alula-sil"] {
        assert!(!packages.contains(&apart), "{apart}");
    }
}
