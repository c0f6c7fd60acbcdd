//! From the URI of the resources to the scene file or the table, in all the spellings that masters use.

use std::path::PathBuf;

use percent_encoding::percent_decode_str;

use super::error::Error;

/// The scene's name in the FMU's folder `resources`.
pub const SCENE_FILE: &str = "scene.toml";

/// The name there of an element's table.
pub const TABLE_FILE: &str = "table.csv";

/// The name there of a patch.
pub const PATCH_FILE: &str = "patch.toml";

/// The first of `files` that is in the resources at `location`.
///
/// # Errors
/// [`Error::NoResource`] with the folders looked in.
pub(super) fn find(location: &str, files: &'static [&'static str]) -> Result<PathBuf, Error> {
    let tried: Vec<_> = folders(location).into_iter().map(PathBuf::from).collect();
    let mut paths = tried.iter().flat_map(|folder| files.iter().map(|file| folder.join(file)));
    match paths.find(|path| path.is_file()) {
        Some(path) => Ok(path),
        None => Err(Error::NoResource { location: location.into(), files, tried }),
    }
}

/// The folders that `location` may mean, the likeliest first: a URI decoded, a plain path as it is, then the other way
/// round.
fn folders(location: &str) -> Vec<String> {
    let mut folders = Vec::new();
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
        let message = find("file:///no/such%20place", &[SCENE_FILE, TABLE_FILE]).unwrap_err().to_string();
        for part in ["no file scene.toml or table.csv", "file:///no/such%20place", "/no/such place", "/no/such%20place"]
        {
            assert!(message.contains(part), "{message}");
        }
    }
}
