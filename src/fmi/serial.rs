//! FMU states as byte strings.
//!
//! A mark, the version of the format, the FMU's GUID, the run, and a checksum of all that goes before it. The GUID
//! stands for the program's version, the scene and every file that it reads, so a state is taken up only where it can
//! go on bit for bit. The checksum finds what was cut short or changed by accident; whoever makes one up on purpose can
//! at most make up a run: lengths, modes, numbers and the profile are checked against the scene.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use uuid::Uuid;

use crate::element;
use crate::outputs::Variable;
use crate::scene::{ParameterError, Value};
use crate::simulation::RestoreError;

use super::carrier::Carrier;
use super::clock::Clock;
use super::fault::Status;
use super::lifecycle::State;
use super::parameters::Parameters;
use super::plant::{Plant, Saved};
use super::run::Run;

/// What every serialised FMU state begins with.
const MARK: [u8; 8] = *b"asperity";

/// The version of the format: to be raised whenever what is written changes.
const FORMAT: u32 = 5;

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
    #[error("it has the parameter {0}, which the FMU does not have")]
    NoParameter(String),
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    #[error(transparent)]
    Simulation(#[from] RestoreError),
    #[error(transparent)]
    Element(#[from] element::RestoreError),
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
    plant: Option<Saved>,
}

/// Writes `run` of the FMU with this GUID.
pub(super) fn write(run: &Run, guid: &str) -> Result<Vec<u8>, Misfit> {
    let Run { state, parameters, carrier, clock, last_step, plant } = run;
    let written = Written {
        state: *state,
        parameters: parameters.values_set().clone(),
        carrier: *carrier,
        clock: *clock,
        last_step: *last_step,
        plant: plant.as_ref().filter(|_| !state.before_run()).map(Plant::save),
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
    let plant = written.plant.as_ref().map(|saved| parameters.subject().restore(saved)).transpose()?;
    let Written { state, carrier, clock, last_step, .. } = written;
    Ok(Run { state, parameters, carrier, clock, last_step, plant })
}

/// A run that goes on from numbers shows numbers; one that was made up of large ones need not.
pub(super) fn check_outputs(run: &mut Run, outputs: &[Variable]) -> Result<(), Misfit> {
    let Some(plant) = &mut run.plant else { return Ok(()) };
    let mut values = vec![0.0; outputs.len()];
    plant.evaluate(outputs, &mut values);
    let finite = values.iter().all(|value| value.is_finite());
    if finite { Ok(()) } else { Err(Misfit::Unsound("its outputs are no finite numbers")) }
}

impl Written {
    fn check(&self) -> Result<(), Misfit> {
        let has_run = match self.state {
            State::Instantiated | State::InitializationMode => self.plant.is_none(),
            State::StepComplete | State::StepFailed | State::Terminated => self.plant.is_some(),
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
        match original.subject().parameter_named(&name) {
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

#[cfg(test)]
mod tests {
    use super::super::fault::Status;
    use super::super::instance::Instance;
    use super::super::instance::tests::instance_of;
    use super::super::lifecycle::Function;
    use super::*;
    use crate::fmi::{Entry, Input, Kind};

    /// A run in contact that may do little work, so that a made-up one does no more.
    fn lively() -> Instance {
        let mut instance = instance_of(&crate::simulation::tests::TEXT.replace("1e-11", "1e-6\nmax_steps = 40"));
        instance.run.carrier.set_input(Input::W, -2e-6);
        instance.run.carrier.set_rate(Input::U, 0.1);
        assert_eq!(instance.call(Function::EnterInitializationMode, Instance::enter_initialization_mode), Status::Ok);
        assert_eq!(instance.call(Function::ExitInitializationMode, Instance::exit_initialization_mode), Status::Ok);
        assert_eq!(instance.call(Function::DoStep, |instance| instance.do_step(0.0, 1e-6)), Status::Ok);
        instance
    }

    /// Random numbers (Marsaglia, Xorshift RNGs, 2003).
    struct Random(u64);

    impl Random {
        fn below(&mut self, end: usize) -> usize {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            usize::try_from(self.0 % end as u64).unwrap()
        }
    }

    /// `bytes` with a few changes that its checksum does not tell of.
    fn made_up(bytes: &[u8], random: &mut Random) -> Vec<u8> {
        const NUMBERS: [f64; 8] = [0.0, -1.0, 1e300, -1e300, 1e-300, 1e8, f64::NAN, f64::NEG_INFINITY];
        let (start, end) = (head("{}").len(), bytes.len() - CHECKSUM);
        let mut bytes = bytes[..end].to_vec();
        for _ in 0..=random.below(3) {
            let place = start + random.below(end - start - 8);
            if random.below(2) == 0 {
                bytes[place] = random.0 as u8;
            } else {
                bytes[place..place + 8].copy_from_slice(&NUMBERS[random.below(8)].to_le_bytes());
            }
        }
        bytes.extend(checksum(&bytes));
        bytes
    }

    /// Every Real that the instance gives, one call each.
    fn check_reals(instance: &mut Instance) {
        let real = |(reference, entry): (u32, Entry<'_>)| {
            let is_output = matches!(entry, Entry::Output(..)) && entry.kind() == Kind::Real;
            is_output.then_some(reference)
        };
        let references: Vec<u32> = instance.catalogue.entries().filter_map(real).collect();
        for reference in references {
            for call in [Function::GetReal, Function::GetDirectionalDerivative, Function::GetRealOutputDerivatives] {
                let mut value = [0.0];
                let status = instance.call(call, |instance| match call {
                    Function::GetReal => instance.get_reals(&[reference], &mut value),
                    Function::GetRealOutputDerivatives => instance.output_derivatives(&[reference], &[1], &mut value),
                    _ => instance.directional_derivatives(&[reference], (&[0, 1], &[1.0, 1.0]), &mut value),
                });
                assert!(status != Status::Fatal && value[0].is_finite(), "{call} {reference}: {value:?}");
                assert!(call != Function::GetReal || status == Status::Ok, "no value of {reference}");
            }
        }
    }

    /// Whoever makes a state up gets an error or a run with numbers: no panic, no NaN, no endless step.
    #[test]
    fn a_made_up_state_is_refused_or_runs() {
        let mut instance = lively();
        let state = instance.get_state(0).unwrap();
        let bytes = instance.serialise_state(state).unwrap();
        let mut random = Random(20_260_101);
        let mut taken = 0;
        for _ in 0..2_000 {
            let bytes = made_up(&bytes, &mut random);
            let mut handle = 0;
            let status = instance.call(Function::DeSerializeFmuState, |instance| {
                handle = instance.deserialise_state(&bytes)?;
                instance.set_state(handle)
            });
            assert_ne!(status, Status::Fatal, "{:?}", instance.take_messages());
            if status == Status::Ok {
                taken += 1;
                check_reals(&mut instance);
                let point = instance.run.clock.time;
                let status = instance.call(Function::DoStep, |instance| instance.do_step(point, 1e-6));
                assert_ne!(status, Status::Fatal, "{:?}", instance.take_messages());
                check_reals(&mut instance);
                assert_eq!(instance.call(Function::FreeFmuState, |instance| instance.free_state(handle)), Status::Ok);
                instance.set_state(state).unwrap();
            }
            instance.take_messages();
        }
        assert!((100..1900).contains(&taken), "{taken} taken");
    }
}
