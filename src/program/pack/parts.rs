//! The parts of the archive that are the same for every scene, from `modelDescription/` and the project's licences.

/// The page that [`super::documentation`] fills in.
pub(super) const PAGE: &str = include_str!("../../../modelDescription/documentation/index.html");

/// The page of an element.
pub(super) const ELEMENT_PAGE: &str = include_str!("../../../modelDescription/documentation/element.html");

/// Path in the archive, content.
pub(super) const PARTS: [(&str, &str); 4] = [
    ("documentation/style.css", include_str!("../../../modelDescription/documentation/style.css")),
    ("documentation/licenses/LICENSE-APACHE", include_str!("../../../LICENSE-APACHE")),
    ("documentation/licenses/LICENSE-MIT", include_str!("../../../LICENSE-MIT")),
    (
        "documentation/licenses/third-party.txt",
        include_str!("../../../modelDescription/documentation/licenses/third-party.txt"),
    ),
];

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::*;

    #[test]
    fn every_package_in_the_library_is_named() {
        let mut cargo = Command::new(env!("CARGO"));
        cargo.current_dir(env!("CARGO_MANIFEST_DIR")).args(["tree", "--locked", "--no-default-features"]);
        cargo.args(["-e", "normal,no-proc-macro", "--prefix", "none"]);
        let platforms = ["x86_64-unknown-linux-gnu", "x86_64-pc-windows-gnu"];
        let output = cargo.args(platforms.map(|platform| format!("--target={platform}"))).output().unwrap();
        let packages = String::from_utf8(output.stdout).unwrap();
        assert!(packages.lines().count() > 10, "{}", String::from_utf8_lossy(&output.stderr));
        let names = packages.lines().filter_map(|line| line.split(' ').next()).filter(|name| *name != "asperity");
        let (_, third_party) = PARTS[3];
        let missing: Vec<_> = names.filter(|name| !third_party.contains(&format!("\n{name} "))).collect();
        assert!(missing.is_empty(), "missing in third-party.txt: {missing:?}");
    }
}
