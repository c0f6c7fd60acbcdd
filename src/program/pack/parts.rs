//! The parts of the archive that are the same for every scene, from `modelDescription/` and the project's licences.

/// The page that [`super::documentation`] fills in.
pub(super) const PAGE: &str = include_str!("../../../modelDescription/documentation/index.html");

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
