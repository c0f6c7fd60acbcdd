//! FMU states as byte strings: valid ones with a few changes and a matching checksum, and arbitrary ones.

use std::cell::OnceCell;
use std::ptr;
use std::thread::LocalKey;

use arbitrary::{Arbitrary, Unstructured};

use uuid::Uuid;

use super::fmu::{CHECKSUM, Fmu, MAX_STEPS, OK, Site, checked, patch_sites, show, sites};
use super::number::Number;

/// A byte string and the steps that follow.
#[derive(Debug, Arbitrary)]
struct Case {
    /// Index of the valid state to begin with.
    base: u8,
    content: Content,
    /// Whether the checksum is corrected, so that the content is read.
    sealed: bool,
    steps: Vec<(Number, Number, Number)>,
}

#[derive(Debug, Arbitrary)]
enum Content {
    /// The base with changes.
    Changed(Vec<Change>),
    /// The head of the base, then arbitrary bytes.
    Body(Vec<u8>),
    /// Arbitrary bytes.
    Any(Vec<u8>),
}

#[derive(Debug, Arbitrary)]
enum Change {
    Byte(u16, u8),
    Number(u16, Number),
    CutAt(u16),
    Insert(u16, u8),
}

/// The valid states to begin with and their instances, one set per thread: every case returns to them.
struct Bases {
    fmus: Vec<Fmu>,
    states: Vec<(usize, Vec<u8>)>,
}

thread_local! {
    /// Never freed: a thread ends with its process.
    static LAYERS: OnceCell<&'static Bases> = const { OnceCell::new() };
    static PATCHES: OnceCell<&'static Bases> = const { OnceCell::new() };
}

/// Makes a byte string, restores it if it is accepted, and does some steps: of layers and elements.
pub fn run(bytes: &[u8]) {
    run_on(&LAYERS, sites, bytes);
}

/// The same of patches.
pub fn run_on_patches(bytes: &[u8]) {
    run_on(&PATCHES, patch_sites, bytes);
}

fn run_on(bases: &'static LocalKey<OnceCell<&'static Bases>>, sites: fn() -> &'static [Site], bytes: &[u8]) {
    let Ok(case) = Case::arbitrary_take_rest(Unstructured::new(bytes)) else { return };
    show(&case);
    bases.with(|bases| bases.get_or_init(|| Box::leak(Box::new(Bases::new(sites())))).run(&case));
}

impl Bases {
    fn new(sites: &'static [Site]) -> Self {
        let fmus: Vec<Fmu> = sites.iter().map(|site| Fmu::new(site, site.instantiate(false))).collect();
        let mut states = Vec::new();
        for (i, fmu) in fmus.iter().enumerate() {
            let mut keep = || states.push((i, fmu.frozen().unwrap()));
            keep();
            assert!(fmu.start([0.0, -1.5e-6, 0.1, 0.0]));
            keep();
            // With too much work for the last ones, so that a step that failed is there too.
            for h in [1e-8, 1e-6, 1e-5, 1.0] {
                fmu.step(fmu.time().unwrap(), h);
                keep();
                fmu.set_rates([0.2, -0.1]);
            }
        }
        Self { fmus, states }
    }

    fn run(&self, case: &Case) {
        let (fmu, base) = &self.states[usize::from(case.base) % self.states.len()];
        let fmu = &self.fmus[*fmu];
        let bytes = case.bytes(base);
        // SAFETY: an instance that lives, a slice of the length given.
        let mut state = ptr::null_mut();
        let status =
            unsafe { asperity_fmi::fmi2DeSerializeFMUstate(fmu.c, bytes.as_ptr().cast(), bytes.len(), &mut state) };
        let status = checked(status);
        assert_eq!(status == OK, !state.is_null());
        if status != OK {
            return;
        }
        // What was taken up is written as it was read, if it was written by this FMU.
        let again = fmu.serialised(state).unwrap();
        assert!(again == bytes || case.sealed, "another state than was given");
        // SAFETY: as above.
        assert_eq!(unsafe { asperity_fmi::fmi2SetFMUstate(fmu.c, state) }, OK);
        fmu.forget(state);
        go_on(fmu, &case.steps);
    }
}

/// Reads all outputs and does steps.
fn go_on(fmu: &Fmu, steps: &[(Number, Number, Number)]) {
    fmu.outputs();
    fmu.check_derivatives([1.0, -1.0]);
    // A made-up state may allow for more work than there is time here.
    if fmu.max_steps() > MAX_STEPS {
        return;
    }
    for (u, w, h) in steps.iter().take(2) {
        // SAFETY: as above.
        checked(unsafe {
            asperity_fmi::fmi2SetReal(fmu.c, fmu.site.inputs.as_ptr(), 2, [u.value(), w.value()].as_ptr())
        });
        let point = fmu.time().unwrap_or_default();
        if fmu.checked_step(point, h.value()) == OK {
            fmu.check_derivatives([1.0, 1.0]);
        }
    }
}

impl Case {
    fn bytes(&self, base: &[u8]) -> Vec<u8> {
        let body = base.len() - CHECKSUM;
        let mut bytes = match &self.content {
            Content::Changed(changes) => {
                let mut bytes = base[..body].to_vec();
                changes.iter().take(16).for_each(|change| change.apply(&mut bytes));
                bytes
            }
            Content::Body(any) => [&base[..HEAD], any].concat(),
            Content::Any(any) => any.clone(),
        };
        if self.sealed {
            bytes.extend(Uuid::new_v5(&Uuid::NAMESPACE_URL, &bytes).into_bytes());
        } else {
            bytes.extend(&base[body..]);
        }
        bytes
    }
}

/// The mark, the format and the GUID.
const HEAD: usize = 8 + 4 + 38;

impl Change {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let within = |place: u16, end: usize| usize::from(place) % (end + 1);
        match *self {
            Self::Byte(place, byte) => {
                let place = within(place, bytes.len());
                if let Some(there) = bytes.get_mut(place) {
                    *there = byte;
                }
            }
            Self::Number(place, number) => {
                let place = within(place, bytes.len());
                if let Some(there) = bytes.get_mut(place..place + 8) {
                    there.copy_from_slice(&number.value().to_le_bytes());
                }
            }
            Self::CutAt(place) => bytes.truncate(within(place, bytes.len())),
            Self::Insert(place, byte) => bytes.insert(within(place, bytes.len()), byte),
        }
    }
}
