//! A point-contact element: the forces of a layer looked up in the table of a sweep instead of simulated.
//!
//! The carrier's height gives the pressure through the table's mean separation, its speed along x the friction
//! coefficient and the tangential stiffness; F_x is a spring of that stiffness limited by μ F_z: one Jenkins element.
//! So it knows what a layer does in steady sliding and at the start of motion, and nothing of what comes between: no
//! relaxation, no inertia, no place on the profile. Along z it is elastic at each speed and loses nothing.

mod error;
mod jenkins;
mod law;
mod leave_one_out;
mod outputs;
mod reader;
mod run;
mod settings;
mod table;
#[cfg(test)]
mod tests;

pub use error::{ElementError, RestoreError, TableError, TableProblem};
pub use leave_one_out::{LeftOut, left_out};
pub use outputs::{dependencies, variables};
pub use run::{Element, Saved};
pub use settings::PointContact;
pub use table::{Load, Place, Quantity, Table};
