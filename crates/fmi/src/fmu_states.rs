//! The FMU states that an instance has handed out, and FMU states as byte strings.
//!
//! A byte string consists of a mark, the version of the format, the FMU's GUID, the state, and a checksum of everything
//! before it. The GUID stands for the program's version, the scene and every file that it reads, so a state is accepted
//! only where it can continue bit for bit. The checksum detects truncation and accidental changes. A forged string can
//! at most forge a run: lengths, modes, numbers and the profile are checked against the scene.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::{Deserialize, Serialize};
use uuid::Uuid;

use super::definition::Parameters;
use super::error::{Error, RestoreError, Status};
use super::inputs::Inputs;
use super::lifecycle::LifecycleState;
use super::model::{FmuRun, RunState};
use super::provisional::LastStep;
use super::state::{Clock, FmuState};
use super::variables::VariableTable;
use asperity::scene::Value;

/// FMU states by handle. A handle is a number that no other state of the process has or had; it is looked up and never
/// dereferenced, so that of a state that was freed is refused, as are those of other instances.
#[derive(Debug, Default)]
pub(super) struct FmuStates {
    states: BTreeMap<usize, FmuState>,
}

/// A handle that no other state of the process has or had. It follows from an address in this library, so that FMUs of
/// other libraries have others, but is far from small numbers and from addresses, which a master might pass by mistake.
fn new_handle() -> usize {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    /// Spreads addresses that are near each other: 2⁶⁴ over the golden ratio (Knuth).
    const SPREAD: u64 = 0x9E37_79B9_7F4A_7C15;
    let base = (ptr::from_ref(&COUNT).addr() as u64).wrapping_mul(SPREAD) as usize;
    base.wrapping_add(COUNT.fetch_add(1, Ordering::Relaxed)).max(1)
}

impl FmuStates {
    /// The state `handle`, to be written over.
    pub(super) fn recall_mut(&mut self, handle: usize) -> Result<&mut FmuState, Error> {
        self.states.get_mut(&handle).ok_or(Error::UnknownState("what FMUstate points to"))
    }

    /// Keeps `state` under a new handle, which it returns.
    pub(super) fn keep_new(&mut self, state: FmuState) -> usize {
        let handle = new_handle();
        self.states.insert(handle, state);
        handle
    }

    /// The state `handle`.
    pub(super) fn recall(&self, handle: usize) -> Result<&FmuState, Error> {
        self.states.get(&handle).ok_or(Error::UnknownState("FMUstate"))
    }

    /// Frees the state `handle`; 0 stands for no state.
    pub(super) fn remove(&mut self, handle: usize) -> Result<(), Error> {
        match (handle, self.states.remove(&handle)) {
            (0, _) | (_, Some(_)) => Ok(()),
            (_, None) => Err(Error::UnknownState("what FMUstate points to")),
        }
    }
}

/// The first bytes of every serialised FMU state.
const MARK: [u8; 8] = *b"asperity";

/// The version of the format, to be raised with each change of what is written.
const FORMAT: u32 = 13;

const CHECKSUM: usize = 16;

/// An [`FmuState`] as it is serialised: with the parameters set instead of the definition. What is written is borrowed: a
/// state of a patch may be large.
#[derive(Serialize, Deserialize)]
struct WrittenState<'a> {
    lifecycle: LifecycleState,
    parameters: Cow<'a, BTreeMap<String, Value>>,
    inputs: Inputs,
    clock: Clock,
    last_step: Status,
    run: Cow<'a, Option<RunState>>,
    last: Cow<'a, Option<LastStep>>,
}

impl<'a> WrittenState<'a> {
    fn new(state: &'a FmuState) -> Self {
        let FmuState { lifecycle, parameters, inputs, clock, last_step, run, last } = state;
        Self {
            lifecycle: *lifecycle,
            parameters: Cow::Borrowed(parameters.values_set()),
            inputs: *inputs,
            clock: *clock,
            last_step: *last_step,
            run: Cow::Borrowed(run),
            last: Cow::Borrowed(last),
        }
    }
}

/// The number of bytes of `state` of the FMU with this GUID.
pub(super) fn size(state: &FmuState, guid: &str) -> Result<usize, RestoreError> {
    let own = postcard::experimental::serialized_size(&WrittenState::new(state))?;
    Ok(head(guid).len() + own + CHECKSUM)
}

/// `state` of the FMU with this GUID as a byte string.
pub(super) fn write(state: &FmuState, guid: &str) -> Result<Vec<u8>, RestoreError> {
    let mut bytes = Vec::with_capacity(size(state, guid)?);
    bytes.extend(head(guid));
    bytes = postcard::to_extend(&WrittenState::new(state), bytes)?;
    bytes.extend(checksum(&bytes));
    Ok(bytes)
}

/// Reads a state of the FMU with this GUID, whose parameters were `original` before any was set. Its calculated
/// variables must be finite: those of a forged state need not be.
pub(super) fn read(
    bytes: &[u8],
    guid: &str,
    original: &Arc<Parameters>,
    variables: &VariableTable,
) -> Result<FmuState, RestoreError> {
    let (written, rest) = postcard::take_from_bytes::<WrittenState<'_>>(body(bytes, guid)?)?;
    if !rest.is_empty() {
        return Err(RestoreError::Invalid("something follows its end"));
    }
    written.check()?;
    let WrittenState { lifecycle, parameters: set, inputs, clock, last_step, run, last } = written;
    let parameters = parameters(original, set.into_owned())?;
    let (run, last) = (run.into_owned(), last.into_owned());
    for state in run.iter().chain(last.as_ref().map(|last| &last.run)) {
        check_outputs(parameters.definition().restore(state)?.as_mut(), variables)?;
    }
    if last.is_some() && !parameters.definition().input_rule().extrapolates() {
        return Err(RestoreError::Invalid("its last step was not extrapolated"));
    }
    Ok(FmuState { lifecycle, parameters, inputs, clock, last_step, run, last })
}

fn check_outputs(run: &mut dyn FmuRun, variables: &VariableTable) -> Result<(), RestoreError> {
    let mut values = vec![0.0; variables.calculated()];
    run.evaluate(&mut values);
    let finite = values.iter().all(|value| value.is_finite());
    if finite { Ok(()) } else { Err(RestoreError::Invalid("its outputs are no finite numbers")) }
}

impl WrittenState<'_> {
    fn check(&self) -> Result<(), RestoreError> {
        let has_run = match self.lifecycle {
            LifecycleState::Instantiated | LifecycleState::InitializationMode => self.run.is_none(),
            LifecycleState::StepComplete | LifecycleState::StepFailed | LifecycleState::Terminated => {
                self.run.is_some()
            }
            // After a failed step or a failed initialisation.
            LifecycleState::Error => true,
            LifecycleState::Fatal => false,
        };
        match (has_run, self.clock.is_valid() && self.inputs.is_valid()) {
            (false, _) => Err(RestoreError::Invalid("its lifecycle and its run do not fit together")),
            (_, false) => Err(RestoreError::Invalid("its times or past inputs are no numbers")),
            _ => self.check_last_step(),
        }
    }

    fn check_last_step(&self) -> Result<(), RestoreError> {
        let fits = |last: &LastStep| self.run.is_some() && last.step.is_valid(&self.inputs, self.clock.time);
        match &*self.last {
            Some(last) if !fits(last) => Err(RestoreError::Invalid("its last step does not lead to it")),
            _ => Ok(()),
        }
    }
}

fn parameters(original: &Arc<Parameters>, set: BTreeMap<String, Value>) -> Result<Arc<Parameters>, RestoreError> {
    let mut parameters = Arc::clone(original);
    for (name, value) in set {
        match original.named(&name) {
            Some(parameter) => Arc::make_mut(&mut parameters).set(parameter, value)?,
            None => return Err(RestoreError::NoParameter(name)),
        }
    }
    Ok(parameters)
}

fn head(guid: &str) -> Vec<u8> {
    [&MARK[..], &FORMAT.to_le_bytes(), guid.as_bytes()].concat()
}

/// The bytes between the head and the checksum, after checking both.
fn body<'a>(bytes: &'a [u8], guid: &str) -> Result<&'a [u8], RestoreError> {
    let rest = bytes.strip_prefix(&MARK).ok_or(RestoreError::Mark)?;
    let (format, rest) = rest.split_first_chunk().ok_or(RestoreError::Mark)?;
    match u32::from_le_bytes(*format) {
        FORMAT => (),
        other => return Err(RestoreError::Format { found: other, expected: FORMAT }),
    }
    let rest = rest.strip_prefix(guid.as_bytes()).ok_or(RestoreError::Guid)?;
    let (body, found) = rest.split_last_chunk::<CHECKSUM>().ok_or(RestoreError::Changed)?;
    if checksum(&bytes[..bytes.len() - CHECKSUM]) == *found { Ok(body) } else { Err(RestoreError::Changed) }
}

/// 122 bits of SHA-1.
fn checksum(bytes: &[u8]) -> [u8; CHECKSUM] {
    Uuid::new_v5(&Uuid::NAMESPACE_URL, bytes).into_bytes()
}

#[cfg(test)]
mod tests {
    use super::super::error::Status;
    use super::super::instance::Instance;
    use super::super::instance::tests::instance_of;
    use super::super::lifecycle::Function;
    use super::super::variables::VariableRef;
    use super::*;
    use crate::Kind;
    use asperity::scene::Input;

    /// A run in contact with a low limit of its work, which holds for a forged one, too.
    fn lively() -> Instance {
        let text = include_str!("../../../tests/common/everything.toml");
        let mut instance = instance_of(&text.replace("1e-11", "1e-6\nmax_steps = 40"));
        instance.state.inputs.set(Input::W as usize, -2e-6);
        instance.state.inputs.set_rate(Input::U as usize, 0.1);
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

    /// `bytes` with a few changes and a matching checksum.
    fn forged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
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

    /// Reads every Real of the instance, one call each.
    fn check_reals(instance: &mut Instance) {
        let is_real = |entry: &VariableRef| entry.is_calculated() && entry.kind == Kind::Real;
        let reals = instance.variables.entries().filter(|(_, entry)| is_real(entry));
        let references: Vec<u32> = reals.map(|(reference, _)| reference).collect();
        for reference in references {
            for call in [Function::GetReal, Function::GetDirectionalDerivative, Function::GetRealOutputDerivatives] {
                let mut value = [0.0];
                let status = instance.call(call, |instance| match call {
                    Function::GetReal => instance.get_reals(&[reference], &mut value),
                    Function::GetRealOutputDerivatives => instance.output_derivatives(&[reference], &[1], &mut value),
                    _ => instance.directional_derivatives(&[reference], &[0, 1], &[1.0, 1.0], &mut value),
                });
                assert!(status != Status::Fatal && value[0].is_finite(), "{call} {reference}: {value:?}");
                assert!(call != Function::GetReal || status == Status::Ok, "no value of {reference}");
            }
        }
    }

    /// A forged state is an error or a run with finite numbers: no panic, no NaN, no endless step.
    #[test]
    fn a_forged_state_is_refused_or_runs() {
        let mut instance = lively();
        let state = instance.get_state(0).unwrap();
        let bytes = instance.serialise_state(state).unwrap();
        let mut random = Random(20_260_101);
        let mut taken = 0;
        for _ in 0..2_000 {
            let bytes = forged(&bytes, &mut random);
            let mut handle = 0;
            let status = instance.call(Function::DeSerializeFmuState, |instance| {
                handle = instance.deserialise_state(&bytes)?;
                instance.set_state(handle)
            });
            assert_ne!(status, Status::Fatal, "{:?}", instance.take_messages());
            if status == Status::Ok {
                taken += 1;
                check_reals(&mut instance);
                let point = instance.state.clock.time;
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
