//! Sequences of FMI calls on several instances, with any arguments that the standard's contract allows: wrong values,
//! wrong references, NULL, wrong sizes, calls in any order, states that are freed or of another instance.

mod functions;

use std::ffi::{CString, c_char};
use std::ptr;

use arbitrary::{Arbitrary, Unstructured};
use asperity_fmi::bindings::*;
use asperity_fmi::*;

use super::fmu::{self, Fmu, OK, Outputs, Site, checked, show};
use super::number::Number;
use functions::{call_function, on_nothing, step};

/// Maximum number of calls in a case and of elements in an array of arguments.
const MAX_CALLS: usize = 24;
const MAX_ELEMENTS: usize = 6;

/// Number of instances at a time.
const SLOTS: usize = 3;

#[derive(Debug, Arbitrary)]
struct Case {
    /// The scene of the first instance, which is initialised at the beginning if `started`.
    site: u8,
    started: Option<[Number; 4]>,
    calls: Vec<(u8, Call)>,
}

/// A value reference: small ones exist, 255 stands for the largest possible.
#[derive(Clone, Copy, Debug, Arbitrary)]
struct Reference(u8);

/// An FMU state: one of those kept so far, freed or not, NULL, or one that never existed.
#[derive(Clone, Copy, Debug, Arbitrary)]
struct Handle(u8);

/// An array; NULL where `null` is 7.
#[derive(Debug, Arbitrary)]
struct Array<T> {
    null: u8,
    elements: Vec<T>,
}

#[derive(Debug, Arbitrary)]
enum Text {
    Word(u8),
    Bytes(Vec<u8>),
    Null,
}

#[derive(Debug, Arbitrary)]
enum Call {
    // Ways that lead far.
    Start { site: u8, logging: bool, inputs: [Number; 4] },
    Inputs { u: Number, w: Number },
    Rates { u: Number, w: Number },
    Step { h: Number },
    StepsOfMicroseconds { count: u8, h: u8 },
    StepTwice { h: Number },
    Parameter { which: u8, value: Number },
    Thaw { from: u8 },
    // Each function with anything.
    Instantiate { name: Text, kind: u8, guid: Text, location: Text, functions: bool, logging: bool, site: u8 },
    Free,
    SetDebugLogging { on: bool, categories: Array<Text> },
    SetupExperiment { tolerance: Option<Number>, start: Number, stop: Option<Number> },
    EnterInitializationMode,
    ExitInitializationMode,
    Terminate,
    Reset,
    GetReal(Array<Reference>, bool),
    GetInteger(Array<Reference>, bool),
    GetBoolean(Array<Reference>, bool),
    GetString(Array<Reference>, bool),
    SetReal(Array<(Reference, Number)>, bool),
    SetInteger(Array<(Reference, i32)>, bool),
    SetBoolean(Array<(Reference, i32)>, bool),
    SetString(Array<(Reference, Text)>, bool),
    GetState { over: Option<Handle>, null: u8 },
    SetState(Handle),
    FreeState(Handle, u8),
    SerializedSize(Handle, u8),
    Serialize { state: Handle, off: i8, null: u8 },
    DeSerialize { which: u8, change: Option<(u16, u8)>, null: u8 },
    DirectionalDerivative { unknowns: Array<Reference>, knowns: Array<(Reference, Number)>, null: bool },
    AllDerivatives { u: Number, w: Number },
    SetInputDerivatives(Array<(Reference, i32, Number)>, bool),
    GetOutputDerivatives(Array<(Reference, i32)>, bool),
    DoStep { point: Option<Number>, h: Number },
    CancelStep,
    GetStatus { kind: u8, which: u8, null: bool },
    OnNothing,
}

/// Runs a sequence of calls of layers and elements.
pub fn run(bytes: &[u8]) {
    run_on(fmu::sites(), bytes);
}

/// Runs a sequence of calls of patches.
pub fn run_on_patches(bytes: &[u8]) {
    run_on(fmu::patch_sites(), bytes);
}

fn run_on(sites: &'static [Site], bytes: &[u8]) {
    let Ok(case) = Case::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    show(&case);
    let mut master = Master { sites, slots: [None; SLOTS], uses: [0; SLOTS], states: Vec::new(), bytes: Vec::new() };
    master.put(0, case.site);
    if let (Some(inputs), Some(fmu)) = (case.started, &master.slots[0]) {
        fmu.start(inputs.map(Number::value));
    }
    for (slot, call) in case.calls.iter().take(MAX_CALLS) {
        master.call(usize::from(*slot) % SLOTS, call);
    }
}

/// A state kept.
struct Kept {
    handle: fmi2FMUstate,
    slot: usize,
    /// The outputs when it was kept; `None` where it is freed, was made from bytes, or there were none.
    outputs: Option<Outputs>,
}

/// The instances and states of a master.
struct Master {
    sites: &'static [Site],
    slots: [Option<Fmu>; SLOTS],
    /// Number of cases that each instance was used in before.
    uses: [usize; SLOTS],
    states: Vec<Kept>,
    bytes: Vec<Vec<u8>>,
}

impl Drop for Master {
    fn drop(&mut self) {
        // After a failed assertion no instance is used again.
        if !std::thread::panicking() {
            (0..SLOTS).for_each(|slot| self.give_back(slot));
        }
    }
}

impl Reference {
    fn number(self) -> u32 {
        if self.0 == u8::MAX { u32::MAX } else { self.0.into() }
    }
}

impl<T> Array<T> {
    fn taken(&self) -> impl Iterator<Item = &T> {
        self.elements.iter().take(MAX_ELEMENTS)
    }

    /// The pointer to pass for `values`.
    fn pointer<V>(&self, values: &[V]) -> *const V {
        if self.null == 7 { ptr::null() } else { values.as_ptr() }
    }
}

fn or_null<V>(null: bool, place: &mut [V]) -> *mut V {
    if null { ptr::null_mut() } else { place.as_mut_ptr() }
}

impl Text {
    fn string(&self) -> Option<CString> {
        const WORDS: [&str; 9] =
            ["event", "step", "auto", "relaxed", "undeformed", "linear", "hold", "logEvents", "logSolver"];
        match self {
            Self::Word(i) => CString::new(WORDS[usize::from(*i) % WORDS.len()]).ok(),
            Self::Bytes(bytes) => {
                CString::new(bytes.iter().copied().take_while(|&byte| byte != 0).collect::<Vec<_>>()).ok()
            }
            Self::Null => None,
        }
    }
}

fn pointer(string: &Option<CString>) -> *const c_char {
    string.as_ref().map_or(ptr::null(), |string| string.as_ptr())
}

impl Master {
    fn put(&mut self, slot: usize, site: u8) {
        self.give_back(slot);
        let (fmu, uses) = self.sites[usize::from(site) % self.sites.len()].take();
        (self.slots[slot], self.uses[slot]) = (Some(fmu), uses);
    }

    /// Frees the states and returns the instance for another case.
    fn give_back(&mut self, slot: usize) {
        let Some(fmu) = self.slots[slot].take() else { return };
        for kept in self.states.iter_mut().filter(|kept| kept.slot == slot) {
            // SAFETY: an instance that lives, any handle.
            unsafe { fmi2FreeFMUstate(fmu.c, &mut kept.handle) };
            kept.outputs = None;
        }
        fmu.site.give_back(fmu, self.uses[slot]);
    }

    fn free(&mut self, slot: usize) {
        if let Some(fmu) = self.slots[slot].take() {
            // SAFETY: from fmi2Instantiate, and freed once.
            unsafe { fmi2FreeInstance(fmu.c) };
            self.states.iter_mut().filter(|kept| kept.slot == slot).for_each(|kept| kept.outputs = None);
        }
    }

    fn handle(&self, handle: Handle) -> fmi2FMUstate {
        match (handle.0, self.states.len()) {
            (255, _) | (_, 0) => ptr::null_mut(),
            (254, _) => ptr::without_provenance_mut(8),
            (i, count) => self.states[usize::from(i) % count].handle,
        }
    }

    /// The record of a state of the instance in `slot`.
    fn kept(&mut self, slot: usize, handle: fmi2FMUstate) -> Option<&mut Kept> {
        self.states.iter_mut().rev().find(|kept| kept.handle == handle && kept.slot == slot)
    }

    fn call(&mut self, slot: usize, call: &Call) {
        match call {
            Call::Start { site, logging, inputs } => {
                self.put(slot, *site);
                if let Some(fmu) = &self.slots[slot] {
                    // SAFETY: an instance that lives.
                    checked(unsafe { fmi2SetDebugLogging(fmu.c, (*logging).into(), 0, ptr::null()) });
                    fmu.start(inputs.map(Number::value));
                }
            }
            Call::Instantiate { name, kind, guid, location, functions, logging, site } => {
                let strings = [name, guid, location].map(Text::string);
                self.instantiate(slot, (strings, *kind), *functions, *logging, *site);
            }
            Call::Free => self.free(slot),
            Call::OnNothing => on_nothing(),
            _ => {
                if let Some(fmu) = self.slots[slot] {
                    self.call_on(slot, fmu, call);
                }
            }
        }
    }

    fn call_on(&mut self, slot: usize, fmu: Fmu, call: &Call) {
        match call {
            Call::GetState { .. }
            | Call::SetState(_)
            | Call::FreeState(..)
            | Call::SerializedSize(..)
            | Call::Serialize { .. }
            | Call::DeSerialize { .. }
            | Call::Thaw { .. } => self.call_on_states(slot, fmu, call),
            Call::Inputs { .. }
            | Call::Rates { .. }
            | Call::Step { .. }
            | Call::StepsOfMicroseconds { .. }
            | Call::StepTwice { .. }
            | Call::DoStep { .. } => step(fmu, call),
            _ => call_function(fmu, call),
        }
    }

    fn instantiate(
        &mut self,
        slot: usize,
        ([name, guid, location], kind): ([Option<CString>; 3], u8),
        functions: bool,
        logging: bool,
        site: u8,
    ) {
        self.free(slot);
        let site = &self.sites[usize::from(site) % self.sites.len()];
        let callbacks = fmu::callbacks();
        let functions = if functions { ptr::from_ref(&callbacks) } else { ptr::null() };
        // A short text stands for the right one.
        let right = |text: &Option<CString>, right: *const c_char| match text {
            Some(text) if text.as_bytes().len() < 2 => right,
            text => pointer(text),
        };
        let (guid, location) = (right(&guid, site.guid.as_ptr()), right(&location, site.location.as_ptr()));
        let kind = fmi2Type::from(kind & 1);
        // SAFETY: strings that live or NULL, callbacks that live or NULL.
        let c = unsafe { fmi2Instantiate(pointer(&name), kind, guid, location, functions, 0, logging.into()) };
        (self.slots[slot], self.uses[slot]) = ((!c.is_null()).then_some(Fmu::new(site, c)), 0);
    }

    fn call_on_states(&mut self, slot: usize, fmu: Fmu, call: &Call) {
        match *call {
            Call::GetState { over, null } => self.get_state(slot, fmu, over.map(|handle| self.handle(handle)), null),
            Call::SetState(handle) => self.set_state(slot, fmu, self.handle(handle)),
            Call::FreeState(handle, null) => self.free_state(fmu, self.handle(handle), null),
            Call::SerializedSize(handle, null) => {
                let mut size = [0];
                // SAFETY: an instance that lives, any handle, a place or NULL.
                checked(unsafe {
                    fmi2SerializedFMUstateSize(fmu.c, self.handle(handle), or_null(null == 7, &mut size))
                });
            }
            Call::Serialize { state, off, null } => self.serialise(fmu, self.handle(state), off, null),
            Call::DeSerialize { which, change, null } => self.deserialise(slot, fmu, which, change, null),
            Call::Thaw { from } => self.thaw(slot, fmu, usize::from(from) % SLOTS),
            _ => (),
        }
    }

    fn get_state(&mut self, slot: usize, fmu: Fmu, over: Option<fmi2FMUstate>, null: u8) {
        let mut place = [over.unwrap_or(ptr::null_mut())];
        let before = place[0];
        // SAFETY: an instance that lives, a place that holds any handle, or NULL.
        let status = checked(unsafe { fmi2GetFMUstate(fmu.c, or_null(null == 7, &mut place)) });
        assert!(status == OK || place[0] == before);
        if status == OK {
            assert!(null != 7 && !place[0].is_null());
            self.states.push(Kept { handle: place[0], slot, outputs: fmu.outputs() });
        }
    }

    fn set_state(&mut self, slot: usize, fmu: Fmu, handle: fmi2FMUstate) {
        let before = fmu.outputs();
        // SAFETY: an instance that lives, any handle.
        let status = checked(unsafe { fmi2SetFMUstate(fmu.c, handle) });
        let after = fmu.outputs();
        if status != OK {
            assert_eq!(after, before);
        } else if let Some(expected) = self.kept(slot, handle).and_then(|kept| kept.outputs.as_ref()) {
            assert_eq!(after.as_ref(), Some(expected));
        }
    }

    fn free_state(&mut self, fmu: Fmu, handle: fmi2FMUstate, null: u8) {
        let mut place = [handle];
        // SAFETY: an instance that lives, a place that holds any handle, or NULL.
        let status = checked(unsafe { fmi2FreeFMUstate(fmu.c, or_null(null == 7, &mut place)) });
        if status == OK && null != 7 {
            assert!(place[0].is_null());
            // The same handle may be given again, to another state.
            self.states.iter_mut().filter(|kept| kept.handle == handle).for_each(|kept| kept.outputs = None);
        }
    }

    fn serialise(&mut self, fmu: Fmu, state: fmi2FMUstate, off: i8, null: u8) {
        let mut size = 0;
        // SAFETY: an instance that lives, any handle, slices of the lengths given or NULL.
        unsafe {
            checked(fmi2SerializedFMUstateSize(fmu.c, state, &mut size));
            let wrong = size.saturating_add_signed(off.into());
            let mut bytes = vec![0_u8; wrong];
            let status = checked(fmi2SerializeFMUstate(fmu.c, state, or_null(null == 7, &mut bytes).cast(), wrong));
            if status == OK && self.bytes.len() < 8 {
                assert!(wrong == size && size > 0);
                self.bytes.push(bytes);
            }
        }
    }

    fn deserialise(&mut self, slot: usize, fmu: Fmu, which: u8, change: Option<(u16, u8)>, null: u8) {
        if self.bytes.is_empty() {
            return;
        }
        let mut bytes = self.bytes[usize::from(which) % self.bytes.len()].clone();
        if let Some((place, byte)) = change {
            let place = usize::from(place) % bytes.len();
            bytes[place] = byte;
        }
        let mut place = [ptr::null_mut()];
        let from = if null == 9 { ptr::null() } else { bytes.as_ptr().cast() };
        // SAFETY: an instance that lives, slices of the lengths given or NULL.
        let status =
            checked(unsafe { fmi2DeSerializeFMUstate(fmu.c, from, bytes.len(), or_null(null == 7, &mut place)) });
        assert_eq!(status == OK, !place[0].is_null());
        if status == OK {
            self.states.push(Kept { handle: place[0], slot, outputs: None });
        }
    }

    /// One instance continues from the state of another of the same scene.
    fn thaw(&mut self, slot: usize, fmu: Fmu, from: usize) {
        let Some((other, bytes)) = self.slots[from].and_then(|other| Some((other, other.frozen()?))) else { return };
        let mut state = ptr::null_mut();
        // SAFETY: an instance that lives, a slice of the length given.
        let status = checked(unsafe { fmi2DeSerializeFMUstate(fmu.c, bytes.as_ptr().cast(), bytes.len(), &mut state) });
        assert_eq!(status == OK, ptr::eq(other.site, fmu.site), "a state of another scene");
        if status == OK {
            let expected = other.outputs();
            self.set_state(slot, fmu, state);
            fmu.forget(state);
            assert_eq!(fmu.outputs(), expected);
        }
    }
}
