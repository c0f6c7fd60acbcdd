//! Outputs as they are being written: beside their places, which they take whole.

use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Stdout, Write};
use std::path::{Path, PathBuf};

use asperity_study::Error;
use asperity_study::files;
use tempfile::{Builder, NamedTempFile, TempDir};

use super::interrupt::Leftover;
use super::output::{STANDARD_OUTPUT, is_standard_output, is_stream, unwritten};

/// An output as it is being written. It takes its place when it is [finished](Self::finish); where the run ends before,
/// whatever was there is still there.
#[derive(Debug)]
pub(crate) struct Draft {
    path: PathBuf,
    file: BufWriter<Target>,
}

#[derive(Debug)]
enum Target {
    /// A file beside its place, and that place.
    Beside {
        file: NamedTempFile,
        place: PathBuf,
        leftover: Leftover,
    },
    /// A pipe or a device.
    Stream(File),
    Standard(Stdout),
}

impl Draft {
    /// Begins the output at `path`.
    ///
    /// # Errors
    /// Where it could not be written: there is no such folder, no permission, or a folder has the name.
    pub(crate) fn create(path: &Path) -> Result<Self, Error> {
        let target = Target::new(path).map_err(unwritten(path))?;
        Ok(Self { path: path.to_owned(), file: BufWriter::new(target) })
    }

    /// Checks that the output at `path` can be written; a pipe is not opened, for its reader would see it end.
    pub(crate) fn check(path: &Path) -> Result<(), Error> {
        let is_stream = fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir());
        if is_stream { Ok(()) } else { Self::create(path).map(drop) }
    }

    /// Puts the output in its place.
    pub(crate) fn finish(self) -> Result<(), Error> {
        let target = self.file.into_inner().map_err(io::IntoInnerError::into_error);
        target.and_then(Target::finish).map_err(unwritten(&self.path))
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Target {
    fn new(path: &Path) -> io::Result<Self> {
        if is_standard_output(path) {
            return Ok(Self::Standard(io::stdout()));
        }
        // A link stays, and what it leads to is replaced.
        let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let before = fs::metadata(&place).ok();
        if before.is_some() {
            // Where it may not be written it is not replaced either.
            let file = OpenOptions::new().write(true).open(&place)?;
            if !before.as_ref().is_some_and(fs::Metadata::is_file) {
                return Ok(Self::Stream(file));
            }
        }
        let folder = place.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
        let mut prefix = std::ffi::OsString::from(".");
        prefix.push(place.file_name().unwrap_or_default());
        prefix.push(".");
        remove_abandoned(folder, &prefix);
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(ENDING);
        #[cfg(unix)]
        builder.permissions(permissions(before.as_ref()));
        let file = builder.tempfile_in(folder)?;
        // Held until the file has its place or its writer has ended; some file systems have no locks.
        drop(file.as_file().try_lock());
        let leftover = Leftover::new(file.path());
        Ok(Self::Beside { file, place, leftover })
    }

    fn finish(self) -> io::Result<()> {
        match self {
            Self::Beside { file, place, leftover } => {
                file.as_file().sync_all()?;
                leftover.keep_while(|| file.persist(&place))?;
                Ok(())
            }
            Self::Stream(_) => Ok(()),
            Self::Standard(mut stdout) => stdout.flush(),
        }
    }

    fn stream(&mut self) -> &mut dyn Write {
        match self {
            Self::Beside { file, .. } => file.as_file_mut(),
            Self::Stream(file) => file,
            Self::Standard(stdout) => stdout,
        }
    }
}

impl Write for Target {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream().flush()
    }
}

/// How the names of drafts end.
const ENDING: &str = ".part";

/// Removes drafts of an output that begin with `prefix` and whose writers were killed: nobody holds their locks. One that
/// is empty may just have been made.
fn remove_abandoned(folder: &Path, prefix: &OsStr) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let is_draft = |name: &OsStr| {
        let name = name.to_string_lossy();
        name.strip_prefix(&*prefix.to_string_lossy()).and_then(|rest| rest.strip_suffix(ENDING)).is_some_and(is_random)
    };
    for entry in entries.flatten().filter(|entry| is_draft(&entry.file_name())) {
        let abandoned = File::open(entry.path()).is_ok_and(|file| {
            file.metadata().is_ok_and(|found| found.is_file() && found.len() > 0) && file.try_lock().is_ok()
        });
        if abandoned {
            drop(fs::remove_file(entry.path()));
        }
    }
}

/// Whether a part of a name is what makes drafts differ.
fn is_random(part: &str) -> bool {
    !part.is_empty() && part.chars().all(|letter| letter.is_ascii_alphanumeric())
}

/// Those of the file that was there, else those of any new file.
#[cfg(unix)]
fn permissions(before: Option<&fs::Metadata>) -> fs::Permissions {
    use std::os::unix::fs::PermissionsExt as _;
    before.map_or_else(|| fs::Permissions::from_mode(0o666), fs::Metadata::permissions)
}

/// Writes a file at once: what is at `path` is the one before or this one, whole.
pub(crate) fn write(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Error> {
    let mut draft = Draft::create(path)?;
    draft.write_all(content.as_ref()).map_err(unwritten(path))?;
    draft.finish()
}

pub(crate) fn print(text: &str) -> Result<(), Error> {
    write(Path::new(STANDARD_OUTPUT), text)
}

/// Where a table is that is continued: in its place or, for standard output and other streams, in a folder of its own until
/// it is whole.
#[derive(Debug)]
pub(crate) struct TablePlace {
    pub(crate) path: PathBuf,
    stream: Option<(PathBuf, TempDir, Leftover)>,
}

impl TablePlace {
    pub(crate) fn new(output: &Path) -> Result<Self, Error> {
        if !is_stream(output) {
            return Ok(Self { path: output.to_owned(), stream: None });
        }
        let folder = tempfile::tempdir().map_err(Error::io("write", &std::env::temp_dir()))?;
        let leftover = Leftover::new(folder.path());
        Ok(Self { path: folder.path().join("table.csv"), stream: Some((output.to_owned(), folder, leftover)) })
    }

    /// Writes the whole table where it is for a stream.
    pub(crate) fn finish(self) -> Result<(), Error> {
        match &self.stream {
            Some((output, ..)) => write(output, files::bytes(&self.path)?),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drafts_of_writers_that_were_killed_are_removed_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let (abandoned, other, named_alike) =
            (at(".t.csv.Ab12Cd.part"), at(".u.csv.Ab12Cd.part"), at(".t.csv.x.y.part"));
        [&abandoned, &other, &named_alike].into_iter().for_each(|path| fs::write(path, "1,2").unwrap());
        let mut running = Draft::create(&at("t.csv")).unwrap();
        running.write_all(&[b'1'; 1 << 16]).unwrap();
        assert!(!abandoned.exists() && other.exists() && named_alike.exists());
        write(&at("t.csv"), "whole").unwrap();
        running.finish().unwrap();
        assert_eq!(fs::read(at("t.csv")).unwrap().len(), 1 << 16);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    }
}
