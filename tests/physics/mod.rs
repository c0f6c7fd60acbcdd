//! The layer: exact results, kernels of the integrators, laws of nature on random scenes, references, both methods.

mod calibration;
mod exact;
mod figure_7;
mod fine;
mod foundation;
mod invariants;
mod kernels;
mod leaving_out;
mod load;
mod patch;
mod reduce;
mod reference;
mod rows;
mod seal;
mod steady;
mod steady_slopes;
mod steady_way;
mod step;
mod tangent;
