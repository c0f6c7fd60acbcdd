//! A point-contact element: the forces of a layer looked up in the table of a sweep instead of simulated.
//!
//! The carrier's height gives the pressure through the table's mean separation, its speed along x the friction
//! coefficient and the tangential stiffness; F_x is the force of a spring of that stiffness, limited by μ F_z: one
//! Jenkins element, of the same law and spring as those of a patch. So it knows what a layer does in steady sliding and
//! at the start of motion, and nothing between: no relaxation, no inertia, no position on the profile. Along z it is
//! elastic at each speed and dissipates nothing.

mod backing;
mod friction_table;
mod grid;
mod jenkins;
mod law;
mod law_points;
mod left_out;
mod limits;
mod low_end;
mod measured;
mod point_contact;
mod point_status;
mod quantity;
mod resampled;
mod run;
mod spring;
#[cfg(test)]
mod tests;

pub use friction_table::{FrictionTable, Node, SWEEP, rest_separation, some_of};
pub use grid::{Load, OperatingPoint, SweepGrid};
pub(crate) use law::{Law, LawAtSpeed};
pub use law_points::{ElementLaw, LawPoints};
pub use left_out::{LeftOut, left_out};
pub(crate) use limits::ROUNDING;
pub use limits::TableLimits;
pub use low_end::LowEnd;
pub use measured::{FRICTION_COEFFICIENT, MEASURED_TABLE, PRESSURE, SPEED, TEMPERATURE};
pub use point_contact::Clearance;
pub use point_contact::{PointContact, dependencies, variables};
pub use point_status::PointStatus;
pub use quantity::Quantity;
pub use resampled::{LawPlace, ResampledLaw, SpeedRange};
pub use run::{Element, ElementError, ElementRestoreError, ElementState};
pub(crate) use spring::{Segment, SpringLaw, advance, apply_jump, damped, damper_loss};
