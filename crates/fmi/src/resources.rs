//! From the URI of the resources to the scene file or the table, in all the spellings that masters use.

use std::path::{self, Path, PathBuf};

use percent_encoding::percent_decode_str;

use super::error::Error;

/// The scene's name in the FMU's folder `resources`.
pub const SCENE_FILE: &str = "scene.toml";

/// The name there of an element's table.
pub const TABLE_FILE: &str = "table.csv";

/// The name there of a patch.
pub const PATCH_FILE: &str = "patch.toml";

/// The name there of a seal.
pub const SEAL_FILE: &str = "seal.toml";

/// A file of the resources.
#[derive(Debug)]
pub(super) struct Resource {
    pub(super) path: PathBuf,
    /// Where `location` does not name the folder that it is in.
    pub(super) warning: Option<String>,
}

/// The first of `files` that is in the resources at `location`; else in those of the FMU's folder, as which some
/// masters pass it; else in those beside the folder of the `library`.
///
/// # Errors
/// [`Error::NoResource`] with the folders looked in.
pub(super) fn find(location: &str, library: Option<&Path>, files: &'static [&'static str]) -> Result<Resource, Error> {
    let named: Vec<_> = folders(location).into_iter().map(PathBuf::from).collect();
    let guessed = named.iter().map(|folder| folder.join(RESOURCES)).chain(library.and_then(beside));
    let tried: Vec<_> = named.iter().cloned().chain(guessed).collect();
    let in_folder = |folder: &PathBuf| files.iter().map(|file| folder.join(file)).find(|path| path.is_file());
    let found = tried.iter().enumerate().find_map(|(i, folder)| Some((i, folder, in_folder(folder)?)));
    let Some((i, folder, path)) = found else {
        return Err(Error::NoResource { location: location.into(), files, tried });
    };
    let warning = (i >= named.len()).then(|| {
        let folder = folder.display();
        format!("fmuResourceLocation is \"{location}\", not the FMU's folder {RESOURCES}: took that at \"{folder}\"")
    });
    // The working folder may change while the instance lives.
    Ok(Resource { path: path::absolute(&path).unwrap_or(path), warning })
}

/// The folder in an FMU.
const RESOURCES: &str = "resources";

/// The resources of the FMU in whose folder `binaries/PLATFORM` the library lies.
fn beside(library: &Path) -> Option<PathBuf> {
    Some(library.parent()?.parent()?.parent()?.join(RESOURCES))
}

/// The folders that `location` may mean, the likeliest first: a URI decoded, a plain path as it is, then the other way
/// round.
fn folders(location: &str) -> Vec<String> {
    let mut folders = Vec::new();
    if location.is_empty() {
        return folders;
    }
    let mut add = |folder: &str| {
        if !folders.iter().any(|known| known == folder) {
            folders.push(folder.to_owned());
        }
    };
    match path_of_uri(location) {
        Some(path) => spellings(path).for_each(|path| add(&path)),
        None => spellings(location).collect::<Vec<_>>().iter().rev().for_each(|path| add(path)),
    }
    folders
}

/// The path decoded, then raw; a path that is not UTF-8 once decoded was not encoded.
fn spellings(path: &str) -> impl Iterator<Item = String> {
    let decoded = percent_decode_str(path).decode_utf8().ok().map(|path| path.into_owned());
    decoded.into_iter().chain([path.to_owned()])
}

/// The path in a `file:` URI: `file:///a`, `file:////a`, `file://localhost/a`, `file:/a`, `file:///C:/a`; `None` for
/// anything else.
fn path_of_uri(location: &str) -> Option<&str> {
    let rest = strip_prefix_ignoring_case(location, "file:")?;
    let path = rest.strip_prefix("//").unwrap_or(rest);
    let path = match strip_prefix_ignoring_case(path, "localhost/") {
        Some(_) => &path["localhost".len()..],
        None => path,
    };
    Some(without_slash_before_drive(path))
}

fn strip_prefix_ignoring_case<'a>(text: &'a str, prefix: &str) -> Option<&'a str> {
    let (start, rest) = text.split_at_checked(prefix.len())?;
    start.eq_ignore_ascii_case(prefix).then_some(rest)
}

/// `/C:/a` is the drive's path `C:/a`.
fn without_slash_before_drive(path: &str) -> &str {
    match path.as_bytes() {
        [b'/', letter, b':', b'/' | b'\\', ..] if letter.is_ascii_alphabetic() => &path[1..],
        _ => path,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    fn first(location: &str) -> String {
        folders(location).remove(0)
    }

    #[test]
    fn uris_in_all_spellings() {
        for location in
            ["file:///a%20b", "file://localhost/a%20b", "FILE://LOCALHOST/a%20b", "file:/a%20b", "File:///a b"]
        {
            assert_eq!(first(location), "/a b", "{location}");
        }
        assert_eq!(first("file:////a"), "//a");
        assert_eq!(first("file:///a/"), "/a/");
        assert_eq!(first("file:///r%C3%A9/%23/%25"), "/ré/#/%");
    }

    #[test]
    fn drives_of_windows() {
        for location in
            ["file:///C:/a%20b", "file:/C:/a%20b", "file://localhost/C:/a b", "file:C:/a b", "file://C:/a b"]
        {
            assert_eq!(first(location), "C:/a b", "{location}");
        }
        assert_eq!(first("C:\\a b"), "C:\\a b");
    }

    #[test]
    fn raw_characters_are_tried_too() {
        assert_eq!(folders("file:///a%20b"), ["/a b", "/a%20b"]);
        assert_eq!(folders("file:///50%/#1"), ["/50%/#1"]);
        assert_eq!(folders("file:///a%FF"), ["/a%FF"]);
    }

    #[test]
    fn a_plain_path_is_tried_as_it_is_first() {
        assert_eq!(folders("/a%20b"), ["/a%20b", "/a b"]);
        assert_eq!(folders("/a b"), ["/a b"]);
        assert_eq!(first("fil"), "fil");
    }

    #[test]
    fn a_missing_file_is_reported_with_the_folders_tried() {
        let message = find("file:///no/such%20place", None, &[SCENE_FILE, TABLE_FILE]).unwrap_err().to_string();
        for part in ["no file scene.toml or table.csv", "file:///no/such%20place", "/no/such place", "/no/such%20place"]
        {
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn a_relative_folder_is_that_of_the_working_folder_now() {
        let found = find("src", None, &["lib.rs"]).unwrap();
        assert!(found.path.is_absolute() && found.path.ends_with("src/lib.rs"), "{found:?}");
        assert_eq!(found.path, std::env::current_dir().unwrap().join("src/lib.rs"));
        assert!(find("file:src", None, &["lib.rs"]).unwrap().path.is_absolute());
    }

    #[test]
    fn the_fmus_folder_and_none_are_taken_for_its_resources_with_a_warning() {
        let fmu = std::env::temp_dir().join(format!("asperity-resources-{}", std::process::id()));
        let (resources, library) = (fmu.join(RESOURCES), fmu.join("binaries/linux64/a.so"));
        std::fs::create_dir_all(&resources).unwrap();
        std::fs::write(resources.join(SCENE_FILE), "").unwrap();
        let found = |location: &str| find(location, Some(&library), &[SCENE_FILE]).unwrap();
        assert!(found(resources.to_str().unwrap()).warning.is_none());
        for location in [fmu.to_str().unwrap(), "", "file:///elsewhere"] {
            let Resource { path, warning } = found(location);
            assert_eq!(path, resources.join(SCENE_FILE), "{location}");
            assert!(warning.unwrap().contains("resources"), "{location}");
        }
        std::fs::remove_dir_all(fmu).unwrap();
    }
}
