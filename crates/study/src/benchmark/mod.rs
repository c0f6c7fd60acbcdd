//! What the runs of a scene cost and how accurate they are: over the tolerances of each method, over the communication
//! steps of a master, and with its quantities scaled.

mod communication;
mod judgement;
mod picture;
mod reference;
mod run;
mod scene;
mod stress;
mod tables;
mod tolerances;
mod trace;

pub use communication::{CommunicationRow, MasterInputs};
pub use judgement::{Judgement, Ratios, Standing};
pub use picture::{communication_picture, judgement_picture, stress_picture, tolerance_picture};
pub use reference::{Comparison, Reference, StartSensitivity};
pub use run::{CompletedRun, Counts, Estimate, RunFigures};
pub use scene::{Benchmark, BenchmarkOptions, Tolerances};
pub use stress::{EndedTrial, Stress, Trial};
pub use tables::{Peer, Peers, communication_table, errors_table, judgements_table, read_peers, stress_table};
pub use tolerances::ToleranceRow;
pub use trace::{Errors, QUANTITIES, Trace, TraceRow, WINDOWS};
