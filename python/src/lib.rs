//! `asperity._native`: what the module `asperity` of Python needs of the library. The classes that users see, their
//! documentation and their types are in `python/asperity`.

mod background;
mod calibrate;
mod compare;
mod contact;
mod converge;
mod elements;
mod errors;
mod fit;
mod found;
mod laws;
mod options;
mod pack;
mod patch;
mod rank;
mod run;
mod scene;
mod seal;
mod simulation;
mod state;
mod surface;
mod sweep;
mod verify;

use pyo3::prelude::*;

/// The native part of the module asperity.
#[pymodule]
mod _native {
    #[pymodule_export]
    use super::calibrate::{calibrate, with_covariance};
    #[pymodule_export]
    use super::contact::contact;
    #[pymodule_export]
    use super::converge::converge;
    #[pymodule_export]
    use super::elements::{animate, moment};
    #[pymodule_export]
    use super::fit::{Fit, fit};
    #[pymodule_export]
    use super::found::{Picture, curves};
    #[pymodule_export]
    use super::laws::{fit_friction, scale_tir};
    #[pymodule_export]
    use super::patch::{MagicFormula, Patch, PatchRun, PatchState, SlipCurves};
    #[pymodule_export]
    use super::rank::rank;
    #[pymodule_export]
    use super::run::simulate;
    #[pymodule_export]
    use super::scene::Scene;
    #[pymodule_export]
    use super::seal::{Seal, SealRun, SealState};
    #[pymodule_export]
    use super::simulation::{Simulation, State};
    #[pymodule_export]
    use super::surface::{surface, surface_of};
    #[pymodule_export]
    use super::sweep::{Table, pack_table, sweep};
    #[pymodule_export]
    use super::verify::verify;

    #[pymodule_init]
    fn init(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        pyo3::types::PyModuleMethods::add(module, "__version__", env!("CARGO_PKG_VERSION"))
    }
}
