//! Figures one after another: an animated PNG, or a row of PNGs.

use std::error::Error;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::{Figure, pixels};
use crate::files::{self, FileError, ends_in};

/// How long a picture of an animated one is shown, as numerator and denominator of a second.
const SHOWN: (u16, u16) = (1, 10);

/// Writes `count` pictures of the same size: as an animation where the name of `path` ends in `.apng`, else each as a
/// PNG of its own.
pub(crate) fn write_film<F: Figure>(
    count: usize,
    picture: impl Fn(usize) -> F + Sync,
    path: &Path,
) -> Result<(), FileError> {
    if ends_in(path, "apng") {
        let animation = animated(count, picture).map_err(|error| FileError::picture(path, &*error))?;
        return files::write(path, animation);
    }
    (0..count).into_par_iter().try_for_each(|i| picture(i).write(&numbered(path, i, count)))
}

/// The files of a row of `count` pictures: `OUT-001.png` and so on for `OUT.png`.
fn numbered(path: &Path, i: usize, count: usize) -> PathBuf {
    let digits = count.to_string().len().max(3);
    let mut name = path.file_stem().unwrap_or_default().to_os_string();
    name.push(format!("-{:0digits$}.png", i + 1));
    path.with_file_name(name)
}

fn animated<F: Figure>(count: usize, picture: impl Fn(usize) -> F + Sync) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut bytes = Vec::new();
    let (width, height) = picture(0).size();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_animated(count as u32, 0)?;
    encoder.set_frame_delay(SHOWN.0, SHOWN.1)?;
    let mut writer = encoder.write_header()?;
    // As many at once as are drawn at once: a picture takes 36 times its size while it is drawn.
    let together = rayon::current_num_threads();
    for first in (0..count).step_by(together) {
        let drawn = (first..count.min(first + together))
            .into_par_iter()
            .map(|i| pixels(&picture(i), 1).map_err(|error| error.to_string()));
        for image in drawn.collect::<Result<Vec<_>, _>>()? {
            writer.write_image_data(&image)?;
        }
    }
    writer.finish()?;
    Ok(bytes)
}
