//! The lock of a table that a long command adds to: two of them at once would lose each other's rows.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read as _, Write as _};
use std::path::{Path, PathBuf};

use same_file::Handle;

use asperity_study::Error;

use super::interrupt::{Leftover, command_line};
use super::terminal::warn;

/// Held while a table is written. It is a file beside the table, with the holder's name in it, for the table itself is
/// replaced; the system releases it however the holder ends.
#[derive(Debug)]
pub(crate) struct TableLock {
    path: PathBuf,
    /// `None` where the file system has no locks.
    _file: Option<File>,
    _leftover: Leftover,
}

impl TableLock {
    /// Takes the lock of the table at `path`.
    ///
    /// # Errors
    /// Where another process has it, with its holder.
    pub(crate) fn take(path: &Path) -> Result<Self, Error> {
        let mut name = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()).into_os_string();
        name.push(".lock");
        let lock = PathBuf::from(name);
        loop {
            match attempt(&lock).map_err(Error::io("write", path))? {
                Attempt::Locked(file) => return Ok(Self { _leftover: Leftover::new(&lock), path: lock, _file: file }),
                Attempt::HeldBy(holder) => return Err(locked(path, &holder)),
                // The holder of before removed it meanwhile.
                Attempt::Removed => (),
            }
        }
    }
}

impl Drop for TableLock {
    /// Removes the file while it is still locked, so that none is left that another process has just locked.
    fn drop(&mut self) {
        drop(fs::remove_file(&self.path));
    }
}

fn locked(path: &Path, holder: &str) -> Error {
    let path = path.display();
    Error::value(format!("cannot write {path}: {holder} writes it; wait for that, or name another -o"))
}

enum Attempt {
    Locked(Option<File>),
    HeldBy(String),
    Removed,
}

fn attempt(lock: &Path) -> io::Result<Attempt> {
    let mut file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(lock)?;
    match file.try_lock() {
        Ok(()) => (),
        Err(TryLockError::WouldBlock) => return Ok(Attempt::HeldBy(holder(&mut file))),
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => {
            warn("this file system has no locks: nothing keeps a second command from writing the same table");
            return Ok(Attempt::Locked(None));
        }
        Err(TryLockError::Error(error)) => return Err(error),
    }
    let own = Handle::from_file(file.try_clone()?)?;
    if Handle::from_path(lock).is_ok_and(|there| there != own) || !lock.exists() {
        return Ok(Attempt::Removed);
    }
    file.set_len(0)?;
    writeln!(file, "process {}{} ({})", std::process::id(), machine(), command_line())?;
    Ok(Attempt::Locked(Some(file)))
}

fn holder(file: &mut File) -> String {
    let mut text = String::new();
    match file.read_to_string(&mut text) {
        Ok(_) if !text.trim().is_empty() => text.trim().to_owned(),
        // It has not written its name yet, or locked files cannot be read here.
        _ => "another process".to_owned(),
    }
}

/// ` on HOST`; nothing where the system does not say.
fn machine() -> String {
    let host = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    if host.trim().is_empty() { String::new() } else { format!(" on {}", host.trim()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_has_one_holder_at_a_time_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let table = folder.path().join("table.csv");
        let first = TableLock::take(&table).unwrap();
        let message = TableLock::take(&table).unwrap_err().to_string();
        assert!(message.contains(&format!("process {}", std::process::id())), "{message}");
        drop(first);
        drop(TableLock::take(&table).unwrap());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
