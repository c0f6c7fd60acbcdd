//! What the runs of a scene cost and how accurate they are: over the tolerances of each method, over the communication
//! steps of a master, and with its quantities scaled.

mod communication;
mod figures;
mod judgement;
mod machine;
mod master;
mod picture;
mod recorder;
mod reference;
mod robustness;
mod run;
mod scene;
mod scenes;
mod tables;
mod tolerances;
mod trace;
mod weighed;

pub use communication::CommunicationRow;
pub use figures::{CompletedRun, Counts, Estimate, RunFigures};
pub use judgement::{Judgement, Ratios, Standing, median};
pub use machine::{Machine, build};
pub use master::MasterInputs;
pub use picture::{communication_picture, judgement_picture, tolerance_picture};
pub use reference::{Comparison, Reference, StartSensitivity};
pub use robustness::{
    BUDGET, COMMUNICATION_STEPS, EndedTrial, MAX_COMMUNICATION_STEPS, Robustness, SHORT_STEPS, Trial,
};
pub use scene::{ReportError, ReportOptions, SceneReport, method};
pub use tables::{Peers, communication_table, errors_table, judgements_table, read_peers, robustness_table};
pub use tolerances::{NoFigures, PATIENCE, PROGRAM, Timed, ToleranceRow};
pub use trace::{Errors, OF_ALL_SCENES, QUANTITIES, Trace, TraceRow, WINDOWS};
