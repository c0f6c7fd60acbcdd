//! Tests of the numerical kernels through the library's public interface: the Runge-Kutta method, its stages, its dense
//! output, the equations of motion against a dense assembly of them, and whole runs.
mod convergence;
mod dense_output;
mod drift;
mod equations;
mod layer;
mod matrices;
mod missed_events;
mod rods;
mod rollback;
mod stiff;
mod tableau;
mod two_stages;
