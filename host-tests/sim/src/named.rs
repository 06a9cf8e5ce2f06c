//! Texts that are asked for by name: built in, or else files.

use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};

use crate::kind::{self, Kind};

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

/// Names and texts of the files in a folder beside the crate, whose names end so.
#[macro_export]
macro_rules! built_in {
    ($folder:literal, $end:literal; $($name:literal),+ $(,)?) => {
        &[$((
            $name,
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../", $folder, "/", $name, $end)),
        )),+]
    };
}
pub use built_in;

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
            text: text_of(path)?,
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

/// The text in the file `path`, in the code page that it is in: UTF-8, UTF-16, or else that of Windows for the West, which has Latin-1
/// in it. Lines may end as they did on a Macintosh. An error names the file, and the line of what is no text.
pub fn text_of(path: &Path) -> anyhow::Result<String> {
    let origin = || on_one_line(&path.display().to_string());
    kind::expect_no_folder(path)?;
    let bytes = std::fs::read(path).with_context(origin)?;
    if matches!(Kind::of(&bytes), Some(Kind::Log | Kind::Flights)) {
        kind::expect(&[], "a text", &origin(), &bytes)?;
    }
    decoded(&bytes).map_err(|(line, what)| anyhow!("{}:{line}: {what}", origin()))
}

/// The code of UTF-16 without a mark: Latin letters, digits and signs have a zero on one side.
fn utf16(bytes: &[u8]) -> Option<&'static encoding_rs::Encoding> {
    let zeros = |side: usize| {
        bytes
            .iter()
            .skip(side)
            .step_by(2)
            .filter(|b| **b == 0)
            .count()
    };
    let most = bytes.len() / 4;
    match [zeros(0), zeros(1)] {
        _ if !bytes.len().is_multiple_of(2) => None,
        [0, behind] if behind > most => Some(encoding_rs::UTF_16LE),
        [before, 0] if before > most => Some(encoding_rs::UTF_16BE),
        _ => None,
    }
}

/// The text of `bytes` with line ends of today.
fn decoded(bytes: &[u8]) -> Result<String, (usize, &'static str)> {
    let text = text_in(bytes)?;
    if text.trim().is_empty() {
        return Err((1, "the file is empty"));
    }
    Ok(match text.contains('\n') {
        true => text,
        false => text.replace('\r', "\n"),
    })
}

/// The text of `bytes`, or the line of what is none, and what it is.
fn text_in(bytes: &[u8]) -> Result<String, (usize, &'static str)> {
    if bytes.starts_with(b"PK\x03\x04") {
        return Err((1, "a spreadsheet or another archive: save its table as CSV"));
    }
    let marked = encoding_rs::Encoding::for_bom(bytes);
    if let Some((code, mark)) = marked.or_else(|| Some((utf16(bytes)?, 0))) {
        let (text, damaged) = code.decode_without_bom_handling(&bytes[mark..]);
        // What cannot be read is replaced by a sign of its own.
        let line = text.lines().position(|line| line.contains('\u{fffd}'));
        return match line.filter(|_| damaged) {
            Some(line) => Err((line + 1, "damaged text")),
            None => Ok(text.into_owned()),
        };
    }
    if let Some(zero) = bytes.iter().position(|byte| *byte == 0) {
        let line = 1 + bytes[..zero].iter().filter(|b| **b == b'\n').count();
        let what = match bytes.iter().all(|byte| *byte == 0) {
            true => "nothing but zeros: the file was never written, or its disk lost it",
            false => "no text",
        };
        return Err((line, what));
    }
    let text = std::str::from_utf8(bytes).map(str::to_owned);
    Ok(text.unwrap_or_else(|_| encoding_rs::WINDOWS_1252.decode(bytes).0.into_owned()))
}

/// Refuses what is neither one of `names` nor a file. A bare word is a mistyped name rather than a file that is missing.
pub fn check(noun: &str, names: &[&str], argument: &str) -> anyhow::Result<()> {
    let path = Path::new(argument);
    if names.contains(&argument) || path.exists() || path.extension().is_some() {
        return Ok(());
    }
    // All of them where none is near.
    let named = match nearest(argument, names) {
        Some(name) => format!("; did you mean {name}?"),
        None => format!(": {}", names.join(", ")),
    };
    let argument = on_one_line(argument);
    bail!("{argument}: neither a file nor a built-in {noun}{named}");
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

/// Names that fields of files, figures and columns of traces had before, and the ones that they have now.
const RENAMED: &[(&str, &str)] = &[
    ("force_floor_mg", "gain_schedule_floor_mg"),
    ("max_turn_g", "max_lateral_acceleration_g"),
    ("entry_s", "settle_time_s"),
    ("theta_deg", "attitude_deg"),
    ("down_m_s", "velocity_m_s"),
    ("forward_m_s", "velocity_m_s"),
    ("rate_rad_s", "body_rates_rad_s"),
    ("rates_rad_s", "body_rates_rad_s"),
    ("inertia_kg_m2", "moment_of_inertia_kg_m2"),
    ("torque_max_n_m", "max_torque_n_m"),
    // A peak in a plane, and in space the root mean square.
    ("late_velocity_error_m_s", "max_late_velocity_error_m_s"),
    ("late_velocity_error_m_s", "late_velocity_error_rms_m_s"),
    ("late_position_error_m", "max_late_position_error_m"),
    ("cruise_error_m_s", "max_cruise_error_m_s"),
    ("max_rate_rad_s", "max_rate_command_rad_s"),
    ("loss_out_m", "max_loss_out_m"),
    ("gain_out_m", "max_gain_out_m"),
    ("loss_back_m", "max_loss_back_m"),
    ("gain_back_m", "max_gain_back_m"),
    ("ahead_m", "max_ahead_m"),
    ("turn_deg", "max_turn_deg"),
    ("oscillation_rad_s", "oscillation_rms_rad_s"),
    ("peak_rate_rad_s", "max_true_rate_rad_s"),
    ("cruise_thrust_to_weight", "cruise_mean_thrust_to_weight"),
    // In another table.
    ("side_force", "vehicle.c_y"),
    // Columns: some have other axes or signs.
    ("v_forward_m_s", "told_v_north_m_s"),
    ("vr_forward_m_s", "told_vr_north_m_s"),
    ("true_v_down_m_s", "v_down_m_s"),
    ("true_v_forward_m_s", "v_north_m_s"),
    ("true_theta_rad", "theta_rad"),
    ("true_rate_rad_s", "pitch_rate_rad_s"),
    ("true_alpha_rad", "wing_alpha_rad"),
    ("rate_rad_s", "command_pitch_rad_s"),
    ("q_w", "attitude_w"),
    ("told_q_w", "told_attitude_w"),
    ("rate_belly_rad_s", "yaw_rate_rad_s"),
    ("rate_wing_rad_s", "pitch_rate_rad_s"),
    ("rate_tail_rad_s", "roll_rate_rad_s"),
    ("command_belly_rad_s", "command_yaw_rad_s"),
    ("command_wing_rad_s", "command_pitch_rad_s"),
    ("command_tail_rad_s", "command_roll_rad_s"),
    ("told_f_tail_m_s2", "told_f_forward_m_s2"),
    ("told_f_belly_m_s2", "told_f_down_m_s2"),
    ("told_f_wing_m_s2", "told_f_right_m_s2"),
];

/// The names that `given` has now, of those that are among `names` or say their table.
pub fn renamed(given: &str, names: &[&str]) -> Vec<&'static str> {
    let now = RENAMED.iter().filter(|(old, _)| *old == given);
    let now = now.filter(|(_, new)| names.contains(new) || new.contains('.'));
    now.map(|(_, new)| *new).collect()
}

/// What an error adds to the unknown name `given`: the field's new name, or the one of `names` that was probably meant, or nothing.
pub fn hint(given: &str, names: &[&str]) -> String {
    let now = renamed(given, names);
    if !now.is_empty() {
        return format!("; its name is `{}` now", now.join("` or `"));
    }
    nearest(given, names).map_or(String::new(), |name| format!("; did you mean `{name}`?"))
}

/// The name that was probably meant: as near to `given` as a slip or two, hyphens and underscores aside, and of several the first.
pub fn nearest<'a>(given: &str, names: &[&'a str]) -> Option<&'a str> {
    let joined = |name: &str| name.to_lowercase().replace(['-', '_'], "");
    let given = joined(given);
    let likeness = |name: &&str| strsim::jaro_winkler(&given, &joined(name));
    let all = names.iter().rev().map(|name| (likeness(name), *name));
    let (likeness, name) = all.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (likeness > 0.85).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn old_names_are_refused_with_the_new_one() {
        for (old, new) in RENAMED {
            assert_eq!(
                hint(old, &["seed", new]),
                format!("; its name is `{new}` now")
            );
        }
        let either = ["max_late_velocity_error_m_s", "late_velocity_error_rms_m_s"];
        let both =
            "; its name is `max_late_velocity_error_m_s` or `late_velocity_error_rms_m_s` now";
        assert_eq!(hint("late_velocity_error_m_s", &either), both);
        // Where the new one does not belong it is not named, unless it says its table.
        assert_eq!(hint("max_turn_g", &["seed"]), "");
        assert_eq!(
            hint("side_force", &["elevons"]),
            "; its name is `vehicle.c_y` now"
        );
    }

    #[test]
    fn other_code_pages_are_read_and_what_is_no_text_has_a_line() {
        let text = "# Flügel, 5 °\nx\n";
        assert_eq!(decoded(text.as_bytes()).unwrap(), text);
        let marked = [b"\xef\xbb\xbf", text.as_bytes()].concat();
        assert_eq!(decoded(&marked).unwrap(), text);
        assert_eq!(decoded(b"# Fl\xfcgel, 5 \xb0\nx\n").unwrap(), text);
        let units = || text.encode_utf16();
        let little: Vec<u8> = units().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = units().flat_map(u16::to_be_bytes).collect();
        assert_eq!(decoded(&[b"\xff\xfe", &little[..]].concat()).unwrap(), text);
        assert_eq!(decoded(&[b"\xfe\xff", &big[..]].concat()).unwrap(), text);
        // Without a mark, too; and where text ends within a letter it is none.
        assert_eq!(decoded(&little).unwrap(), text);
        assert_eq!(decoded(&big).unwrap(), text);
        assert_eq!(decoded(&little[1..]), Err((1, "no text")));
        // Lines that end as on a Macintosh, and files without any.
        assert_eq!(decoded(b"a\rb\r").unwrap(), "a\nb\n");
        assert_eq!(decoded(b"a\r\nb\r\n").unwrap(), "a\r\nb\r\n");
        for empty in [&b""[..], b"\n \r\n", b"\xef\xbb\xbf"] {
            assert_eq!(decoded(empty), Err((1, "the file is empty")));
        }
        // Half of a pair of surrogates.
        let broken = b"\xff\xfex\0\n\0\x00\xd8x\0";
        assert_eq!(decoded(broken), Err((2, "damaged text")));
        assert_eq!(decoded(b"a\nb\0c"), Err((2, "no text")));
        assert!(
            decoded(&[0; 9])
                .unwrap_err()
                .1
                .starts_with("nothing but zeros")
        );
        assert!(decoded(b"PK\x03\x04...").unwrap_err().1.contains("CSV"));
    }

    #[test]
    fn hyphens_do_not_lead_to_another_name() {
        let names = ["naca-0021-re-160e3", "naca-0012-re-160e3"];
        for given in ["naca0012-re-160e3", "NACA_0012-re160e3"] {
            assert_eq!(nearest(given, &names), Some(names[1]));
        }
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
            "plum: neither a file nor a built-in fruit: apple, pear"
        );
        assert_eq!(
            error("Aple"),
            "Aple: neither a file nor a built-in fruit; did you mean apple?"
        );
        assert!(error("plum.toml").starts_with("plum.toml: No such file"));
        let file = tempfile::NamedTempFile::with_suffix(".toml").unwrap();
        std::fs::write(&file, "blue").unwrap();
        let path = file.path().to_str().unwrap();
        let named = find(path).unwrap();
        assert_eq!((&*named.origin, &*named.text), (path, "blue"));
        assert_eq!(
            named.name,
            file.path().file_stem().unwrap().to_str().unwrap()
        );
    }
}
