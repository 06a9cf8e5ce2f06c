//! Texts that are asked for by name: built in, or else files.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

/// A text with where it came from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Named {
    /// Built-in name, or the file's name without its extension.
    pub name: String,
    /// What stands for it in errors.
    pub origin: String,
    /// The text.
    pub text: String,
    /// The file, if it is not built in.
    pub file: Option<PathBuf>,
}

/// Names and texts of the files in a folder beside `src`, whose names end so.
macro_rules! built_in {
    ($folder:literal, $end:literal; $($name:literal),+ $(,)?) => {
        &[$((
            $name,
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $folder, "/", $name, $end)),
        )),+]
    };
}
pub(crate) use built_in;

impl Named {
    /// A text that is in no file; `origin` stands for it in errors.
    pub fn new(name: &str, origin: &str, text: &str) -> Self {
        Self {
            name: name.to_owned(),
            origin: origin.to_owned(),
            text: text.to_owned(),
            file: None,
        }
    }

    /// The text that `argument` names: one of `built_in`, (name, text) each, or else a file. `noun` is what there is
    /// to choose from, in errors.
    pub fn find(noun: &str, built_in: &[(&str, &str)], argument: &str) -> anyhow::Result<Self> {
        if let Some((name, text)) = built_in.iter().find(|(name, _)| *name == argument) {
            return Ok(Self::new(name, &format!("built-in {name}"), text));
        }
        let names: Vec<_> = built_in.iter().map(|(name, _)| *name).collect();
        check(noun, &names, argument)?;
        let path = Path::new(argument);
        let name = path.file_stem().unwrap_or(path.as_os_str());
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            origin: argument.to_owned(),
            text: std::fs::read_to_string(path).with_context(|| on_one_line(argument))?,
            file: Some(path.to_owned()),
        })
    }

    /// The text that this one names: a file beside its own, or else what [`Self::find`] finds.
    pub fn beside(
        &self,
        noun: &str,
        built_in: &[(&str, &str)],
        argument: &str,
    ) -> anyhow::Result<Self> {
        let beside = self.file.as_ref().map(|file| file.with_file_name(argument));
        match beside.filter(|path| path.is_file()) {
            Some(path) => Self::find(noun, built_in, &path.to_string_lossy()),
            None => Self::find(noun, built_in, argument),
        }
    }
}

/// Refuses what is neither one of `names` nor a file. A bare word is a mistyped name rather than a file that is missing.
pub(crate) fn check(noun: &str, names: &[&str], argument: &str) -> anyhow::Result<()> {
    let path = Path::new(argument);
    if names.contains(&argument) || path.exists() || path.extension().is_some() {
        return Ok(());
    }
    let meant = nearest(argument, names);
    let meant = meant.map_or(String::new(), |name| format!("; did you mean {name}?"));
    let names = names.join(", ");
    let argument = on_one_line(argument);
    bail!("{argument}: neither a file nor a built-in {noun} ({names}){meant}");
}

/// The text with its control characters escaped: a message that quotes what a file says stays on one line.
pub fn on_one_line(text: &str) -> String {
    let mut line = String::with_capacity(text.len());
    for c in text.chars() {
        match c.is_control() {
            true => line.extend(c.escape_default()),
            false => line.push(c),
        }
    }
    line
}

/// A word as a shell takes it for one, in commands that are shown.
pub fn in_shell(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./+,:@%=".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

/// Names that fields of files had before, and the ones that they have now.
pub(crate) const RENAMED: &[(&str, &str)] = &[
    ("force_floor_mg", "gain_schedule_floor_mg"),
    ("max_turn_g", "max_lateral_acceleration_g"),
];

/// What an error adds to the unknown name `given`: the field's new name, or the one of `names` that was probably meant, or nothing.
pub(crate) fn hint(given: &str, names: &[&str]) -> String {
    let renamed = RENAMED.iter().find(|(old, _)| *old == given);
    if let Some((_, new)) = renamed.filter(|(_, new)| names.contains(new)) {
        return format!("; its name is `{new}` now");
    }
    nearest(given, names).map_or(String::new(), |name| format!("; did you mean `{name}`?"))
}

/// The name that was probably meant: as near to `given` as a slip or two, and of several the first.
pub(crate) fn nearest<'a>(given: &str, names: &[&'a str]) -> Option<&'a str> {
    let given = given.to_lowercase();
    let likeness = |name: &&str| strsim::jaro_winkler(&given, name);
    let all = names.iter().rev().map(|name| (likeness(name), *name));
    let (likeness, name) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (likeness > 0.85).then_some(name)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Why `load` refuses the file `path` with this text, which is one line.
    pub(crate) fn refusal<T: std::fmt::Debug>(
        path: &Path,
        text: &str,
        load: impl FnOnce(&Path) -> anyhow::Result<T>,
    ) -> String {
        std::fs::write(path, text).unwrap();
        let error = format!("{:#}", load(path).unwrap_err());
        assert_eq!(error.lines().count(), 1, "{error}");
        error
    }

    /// `text` must hold each of the `parts`.
    #[track_caller]
    pub(crate) fn says(text: &str, parts: &[&str]) {
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }

    /// `text` must begin so.
    #[track_caller]
    pub(crate) fn begins(text: &str, start: &str) {
        assert!(text.starts_with(start), "{text}");
    }

    #[test]
    fn a_name_with_a_line_break_is_refused_in_one_line() {
        for name in ["ro\nd-trip", "ro\r\nund.toml", "round\ttrip"] {
            let error = Named::find("experiment", &[("round-trip", "")], name).unwrap_err();
            let text = format!("{error:#}");
            assert_eq!(text.lines().count(), 1, "{text}");
            assert!(text.contains("\\n") || text.contains("\\t"), "{text}");
        }
    }

    #[test]
    fn a_shell_reads_a_quoted_word_back() {
        assert_eq!(in_shell("my-plane/my-plane.toml"), "my-plane/my-plane.toml");
        for word in ["my plane/x.toml", "it's", "a\"b$c\\d", "", "a\nb"] {
            let command = format!("printf %s {}", in_shell(word));
            let said = std::process::Command::new("sh")
                .args(["-c", &command])
                .output();
            assert_eq!(String::from_utf8(said.unwrap().stdout).unwrap(), word);
        }
    }

    #[test]
    fn names_come_before_files_and_mistyped_ones_are_listed() {
        let find =
            |argument| Named::find("fruit", &[("apple", "red"), ("pear", "green")], argument);
        let pear = find("pear").unwrap();
        assert_eq!(
            (&*pear.name, &*pear.origin, &*pear.text),
            ("pear", "built-in pear", "green")
        );
        let error = |argument| format!("{:#}", find(argument).unwrap_err());
        assert_eq!(
            error("plum"),
            "plum: neither a file nor a built-in fruit (apple, pear)"
        );
        assert_eq!(
            error("Aple"),
            "Aple: neither a file nor a built-in fruit (apple, pear); did you mean apple?"
        );
        assert!(error("plum.toml").starts_with("plum.toml: No such file"));
        let file = tempfile::NamedTempFile::with_suffix(".toml").unwrap();
        std::fs::write(&file, "blue").unwrap();
        let path = file.path().to_str().unwrap();
        let found = find(path).unwrap();
        assert_eq!((&*found.origin, &*found.text), (path, "blue"));
        assert_eq!(
            found.name,
            file.path().file_stem().unwrap().to_str().unwrap()
        );
    }
}
