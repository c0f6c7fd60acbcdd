//! The comparisons of the validation page, each a function that returns its rows. Reference solutions stand beside them
//! and call nothing of what is compared.

pub mod elastic;
pub mod film;
pub mod heat;
pub mod layer;
pub mod oscillator;
pub mod page;
pub mod reference;
pub mod road;
pub mod rough;
pub mod row;
pub mod rubber;
pub mod scenes;
pub mod springs;
pub mod strain;
pub mod viscoelastic;

use std::path::Path;

use row::Entry;

/// The repository.
pub fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

/// In the order of the page.
pub const ALL: &[Entry] = &[
    elastic::CYLINDER,
    elastic::SPHERE,
    elastic::WAVE,
    elastic::WAVES,
    viscoelastic::ROLLING,
    viscoelastic::CYLINDERS,
    viscoelastic::CONSTANT_LOSS,
    viscoelastic::FULL,
    rough::AREA,
    rough::SPECTRUM,
    strain::FRICTION_NEAR_ONE,
    film::RIDGES,
    film::ROUGH,
    heat::HALF_SPACE,
    heat::STRIP,
    rubber::SOLID,
    oscillator::BLOCK,
    springs::SPRINGS,
    reference::CASES,
    layer::CATTANEO,
    layer::RADOK,
    road::LAYER,
    road::TREAD,
];
