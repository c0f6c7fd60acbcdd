//! FMU states as byte strings.
//!
//! A mark, the version of the format, the FMU's GUID, the run, and a checksum of all that goes before it. The GUID stands
//! for the program's version, the scene and every file that it reads, so a state is taken up only where it can go on
//! bit for bit. The checksum finds what was cut short or changed by accident; whoever makes one up on purpose can at most
//! make up a run: lengths, modes, numbers and the profile are checked against the scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::scene::{ParameterError, Value};
use crate::simulation::{RestoreError, Saved, Simulation};

use super::carrier::Carrier;
use super::clock::Clock;
use super::fault::Status;
use super::lifecycle::State;
use super::parameters::Parameters;
use super::run::Run;

/// What every serialised FMU state begins with.
const MARK: [u8; 8] = *b"asperity";

/// The version of the format: to be raised whenever what is written changes.
const FORMAT: u32 = 1;

/// Bytes of the checksum.
const CHECKSUM: usize = 16;

/// Why a byte string is no FMU state.
#[derive(Debug, thiserror::Error)]
pub(super) enum Misfit {
    #[error("it does not begin like one, or is cut short")]
    Mark,
    #[error("its format is {0}, expected {FORMAT}")]
    Format(u32),
    #[error("its scene or version is another one")]
    Guid,
    #[error("it is cut short or has changed")]
    Changed,
    #[error("{0}")]
    Content(#[from] postcard::Error),
    #[error("it has the parameter {0}, which the scene does not have")]
    NoParameter(String),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Simulation(#[from] RestoreError),
    #[error("{0}")]
    Unsound(&'static str),
}

/// A run as it is written down: [`Run`] with what a byte string cannot hold left out.
#[derive(Serialize, Deserialize)]
struct Written {
    state: State,
    parameters: BTreeMap<String, Value>,
    carrier: Carrier,
    clock: Clock,
    last_step: Status,
    /// None before the run: it would start as things stand.
    simulation: Option<Saved>,
}

/// Writes `run` of the FMU with this GUID.
pub(super) fn write(run: &Run, guid: &str) -> Result<Vec<u8>, Misfit> {
    let Run { state, parameters, carrier, clock, last_step, simulation } = run;
    let written = Written {
        state: *state,
        parameters: parameters.values_set().clone(),
        carrier: *carrier,
        clock: *clock,
        last_step: *last_step,
        simulation: simulation.as_ref().filter(|_| !state.before_run()).map(Simulation::save),
    };
    let mut bytes = head(guid);
    bytes = postcard::to_extend(&written, bytes)?;
    bytes.extend(checksum(&bytes));
    Ok(bytes)
}

/// Reads a run of the FMU with this GUID, whose parameters were `original` before any was set.
pub(super) fn read(bytes: &[u8], guid: &str, original: &Arc<Parameters>) -> Result<Run, Misfit> {
    let written = body(bytes, guid)?;
    let (written, rest) = postcard::take_from_bytes::<Written>(written)?;
    if !rest.is_empty() {
        return Err(Misfit::Unsound("something follows its end"));
    }
    written.check()?;
    let parameters = parameters(original, written.parameters)?;
    let restore = |saved: &Saved| Simulation::restore(parameters.scene(), saved);
    let simulation = written.simulation.as_ref().map(restore).transpose()?;
    let Written { state, carrier, clock, last_step, .. } = written;
    Ok(Run { state, parameters, carrier, clock, last_step, simulation })
}

impl Written {
    fn check(&self) -> Result<(), Misfit> {
        let has_run = match self.state {
            State::Instantiated | State::InitializationMode => self.simulation.is_none(),
            State::StepComplete | State::StepFailed | State::Terminated => self.simulation.is_some(),
            // After a step or after an initialisation that failed.
            State::Error => true,
            State::Fatal => false,
        };
        match (has_run, self.clock.is_sound() && self.carrier.is_sound()) {
            (false, _) => Err(Misfit::Unsound("its lifecycle and its run do not fit together")),
            (_, false) => Err(Misfit::Unsound("its times or past inputs are no numbers")),
            _ => Ok(()),
        }
    }
}

fn parameters(original: &Arc<Parameters>, set: BTreeMap<String, Value>) -> Result<Arc<Parameters>, Misfit> {
    let mut parameters = Arc::clone(original);
    for (name, value) in set {
        match original.scene().parameter_named(&name) {
            Some(parameter) => Arc::make_mut(&mut parameters).set(parameter, value)?,
            None => return Err(Misfit::NoParameter(name)),
        }
    }
    Ok(parameters)
}

fn head(guid: &str) -> Vec<u8> {
    [&MARK[..], &FORMAT.to_le_bytes(), guid.as_bytes()].concat()
}

/// What stands between the head and the checksum, both found right.
fn body<'a>(bytes: &'a [u8], guid: &str) -> Result<&'a [u8], Misfit> {
    let rest = bytes.strip_prefix(&MARK).ok_or(Misfit::Mark)?;
    let (format, rest) = rest.split_first_chunk().ok_or(Misfit::Mark)?;
    match u32::from_le_bytes(*format) {
        FORMAT => (),
        other => return Err(Misfit::Format(other)),
    }
    let rest = rest.strip_prefix(guid.as_bytes()).ok_or(Misfit::Guid)?;
    let (body, found) = rest.split_last_chunk::<CHECKSUM>().ok_or(Misfit::Changed)?;
    if checksum(&bytes[..bytes.len() - CHECKSUM]) == *found { Ok(body) } else { Err(Misfit::Changed) }
}

/// 122 bits of SHA-1.
fn checksum(bytes: &[u8]) -> [u8; CHECKSUM] {
    Uuid::new_v5(&Uuid::NAMESPACE_URL, bytes).into_bytes()
}
