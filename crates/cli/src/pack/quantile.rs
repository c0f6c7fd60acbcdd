//! The files of one sample of a table, packed as those of the table are.

use std::fs;
use std::path::{Path, PathBuf};

use asperity_study::Error;
use asperity_study::files::{load_patch, text};
use asperity_study::progress::Stop;
use asperity_study::sweep::{SweepTable, quantile_table};
use asperity_study::uncertainty::UncertainScene;
use tempfile::TempDir;

use crate::cli::Pack;
use crate::files::{load_without_run, name_of};
use crate::terminal::note;

/// A table of one sample, or a patch with such a table, in a folder of their own.
#[derive(Debug)]
pub(super) struct Sample {
    pub(super) table: Option<PathBuf>,
    pub(super) patch: Option<PathBuf>,
    _folder: TempDir,
}

impl Sample {
    /// The sample at the quantile `share` of the table that is packed, drawn from the scene and swept again.
    pub(super) fn new(command: &Pack, share: f64) -> Result<Self, Error> {
        let folder = tempfile::tempdir().map_err(Error::io("write", Path::new("a folder of its own")))?;
        let scene = command.scene.clone().unwrap_or_default();
        let read = load_without_run(&scene, &[], |_| true)?;
        let uncertain = UncertainScene::new(read)?;
        let packed = |table: &Path| {
            let sample = quantile_table(&uncertain, &SweepTable::read(table)?, share, &Stop::default())?;
            sample.header.keys.text_of("sample").iter().for_each(|sample| note(&format!("sample {sample}")));
            Ok::<_, Error>(sample.text())
        };
        let place = |name: &Path| folder.path().join(name);
        if let Some(path) = &command.patch {
            let patch = load_patch(path, &[])?;
            let own = path.parent().unwrap_or(Path::new(""));
            for file in patch.files() {
                let content = fs::read(own.join(file)).map_err(Error::io("read", file))?;
                write(&place(file), &content)?;
            }
            write(&place(patch.table_file()), packed(&own.join(patch.table_file()))?.as_bytes())?;
            let file = place(Path::new(&name_of(path)));
            write(&file, text(path)?.as_bytes())?;
            return Ok(Self { table: None, patch: Some(file), _folder: folder });
        }
        let table = command.table.clone().unwrap_or_default();
        let file = place(Path::new(&name_of(&table)));
        write(&file, packed(&table)?.as_bytes())?;
        Ok(Self { table: Some(file), patch: None, _folder: folder })
    }
}

/// Writes a file and the folders that it is in.
fn write(path: &Path, content: &[u8]) -> Result<(), Error> {
    let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
    folder.and_then(|()| fs::write(path, content)).map_err(Error::io("write", path))
}
