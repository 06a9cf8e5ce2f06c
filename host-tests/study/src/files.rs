//! Files that appear only when they are complete.

use std::fs::File;
use std::io::Write;
use std::path::Path;

use anyhow::{Context, ensure};

/// Makes the folder `path` if it is not there.
pub fn make_folder(path: &Path) -> anyhow::Result<()> {
    let origin = || path.display().to_string();
    ensure!(
        !path.is_file(),
        "{}: a file, where a folder is wanted",
        origin()
    );
    std::fs::create_dir_all(path).with_context(origin)
}

/// Lets `write` fill the file `path` under a temporary name in the same folder, and then renames
/// it. On failure nothing is left; the error names `path` if it is of writing, and else is what `write` says. The content is synchronised to disk before the file is renamed, so that a loss of power leaves
/// the whole file or none. If `path` exists and is not a regular file, such as `/dev/null` or a pipe, it is written to directly.
pub fn leave(
    path: &Path,
    write: impl FnOnce(&mut File) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    // The permissions of any new file, which the user's mask restricts.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let written = || {
        if path.metadata().is_ok_and(|m| !m.is_file() && !m.is_dir()) {
            return write(&mut File::options().write(true).open(path)?);
        }
        let mut file = builder.tempfile_in(folder)?;
        write(file.as_file_mut())?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|e| e.error)?;
        anyhow::Ok(())
    };
    written().map_err(|error| match is_of_writing(&error) {
        true => error.context(path.display().to_string()),
        false => error,
    })
}

/// Whether an error comes of the system, and not of what was to be written.
fn is_of_writing(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let csv = cause.downcast_ref::<csv::Error>().map(csv::Error::kind);
        matches!(csv, Some(csv::ErrorKind::Io(_))) || cause.is::<std::io::Error>()
    })
}

/// The same with a `content` that is there.
pub fn leave_all(path: &Path, content: impl AsRef<[u8]>) -> anyhow::Result<()> {
    leave(path, |file| Ok(file.write_all(content.as_ref())?))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::FileTypeExt;

    /// A rename would replace the device by a file.
    #[test]
    fn a_device_stays_one() {
        let null = Path::new("/dev/null");
        leave_all(null, b"nothing").unwrap();
        assert!(null.metadata().unwrap().file_type().is_char_device());
    }

    /// What is wrong with the content does not hide behind the file that it was meant for; what is wrong with the file names it.
    #[test]
    fn the_cause_stands_first() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.csv");
        let error = leave(&path, |_| anyhow::bail!("no velocity")).unwrap_err();
        assert_eq!(format!("{error:#}"), "no velocity");
        assert!(!path.exists());
        let missing = folder.path().join("none/x.csv");
        let error = format!("{:#}", leave_all(&missing, "x").unwrap_err());
        assert!(error.starts_with(missing.to_str().unwrap()), "{error}");
    }
}
