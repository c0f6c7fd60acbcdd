//! Messages to the master: by category, collected during a call and delivered at its end; warnings of runs that the scene
//! does not cover.

use super::definition::Definition;
use super::error::{Error, Status};
use super::model::InstanceModel;
use crate::model::{Reduction, Replacement};
use crate::scene::Scene;

/// The categories of messages, as the model description lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// Why a call failed.
    Error,
    /// Warnings of a call that succeeded.
    Warning,
    /// Why a step was discarded.
    Discard,
    /// Mode changes of the masses.
    Events,
    /// The integrator's work, one line per communication step, and each switch between the methods of *auto*.
    Solver,
}

impl Category {
    /// All categories, in the order of the model description.
    pub const ALL: [Self; 5] = [Self::Error, Self::Warning, Self::Discard, Self::Events, Self::Solver];

    /// The category's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "logStatusError",
            Self::Warning => "logStatusWarning",
            Self::Discard => "logStatusDiscard",
            Self::Events => "logEvents",
            Self::Solver => "logSolver",
        }
    }

    /// What its messages are, for the model description.
    pub fn description(self) -> &'static str {
        match self {
            Self::Error => "Why a call failed; always on",
            Self::Warning => "Warnings of calls that succeeded; always on",
            Self::Discard => "Why a step was discarded; always on",
            Self::Events => "Every mode change of a mass: free, slipping, sticking",
            Self::Solver => "The integrator's work, one line per communication step, and switches of the method auto",
        }
    }

    fn new(status: Status) -> Self {
        match status {
            Status::Ok => Self::Events,
            Status::Warning => Self::Warning,
            Status::Discard => Self::Discard,
            Status::Error | Status::Fatal => Self::Error,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) status: Status,
    pub(super) category: Category,
    pub(super) text: String,
}

impl Message {
    /// A message of a call that returns `status`, or a warning.
    pub(super) fn from_status(status: Status, text: String) -> Self {
        Self { status, category: Category::new(status), text }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Log {
    events: bool,
    solver: bool,
    waiting: Vec<Message>,
}

impl Log {
    /// A log of all categories, or of errors, warnings and discarded steps alone.
    pub(super) fn new(everything: bool) -> Self {
        Self { events: everything, solver: everything, waiting: Vec::new() }
    }

    /// Switches on the categories named (all where none is) and off all others, except those that are always on.
    pub(super) fn select(&mut self, on: bool, names: &[&str]) -> Result<(), Error> {
        let known = |name: &str| Category::ALL.iter().any(|category| category.name() == name);
        if let Some(&name) = names.iter().find(|name| !known(name)) {
            return Err(Error::UnknownCategory(name.into()));
        }
        let asked = |category: Category| on && (names.is_empty() || names.contains(&category.name()));
        self.events = asked(Category::Events);
        self.solver = asked(Category::Solver);
        Ok(())
    }

    pub(super) fn includes(&self, category: Category) -> bool {
        match category {
            Category::Error | Category::Warning | Category::Discard => true,
            Category::Events => self.events,
            Category::Solver => self.solver,
        }
    }

    /// Keeps messages for the end of the call.
    pub(super) fn extend(&mut self, messages: impl IntoIterator<Item = Message>) {
        self.waiting.extend(messages);
    }

    /// Keeps a message for the end of the call.
    pub(super) fn add(&mut self, message: Message) {
        self.waiting.push(message);
    }

    /// The messages since the last call.
    pub(super) fn take(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.waiting)
    }
}

/// Warnings that the forces do not show, each given once per run: the layer has left its profile; the run is longer than
/// the reduction of links assumes.
#[derive(Clone, Debug, Default)]
pub(super) struct RunWarnings {
    /// The time at which the run began, s; `None` where it is not known.
    pub(super) start: Option<f64>,
    left_profile: bool,
    exceeded_reduction: bool,
}

impl RunWarnings {
    /// New warnings of a run of `definition` that has reached `time` (s).
    pub(super) fn new_ones(&mut self, definition: &Definition, model: &InstanceModel, time: f64) -> Vec<String> {
        let Definition::Layer(scene) = definition else { return Vec::new() };
        let texts = [self.profile(scene, model.carrier().0), self.reduction(scene, time)];
        texts.into_iter().flatten().map(|text| format!("t = {time} s: {text}")).collect()
    }

    fn profile(&mut self, scene: &Scene, u: f64) -> Option<String> {
        let text = if self.left_profile { None } else { scene.off_profile(u) };
        self.left_profile |= text.is_some();
        text
    }

    /// `solver.reduce` replaces slow elements by springs by the duration of the excitation.
    fn reduction(&mut self, scene: &Scene, time: f64) -> Option<String> {
        /// Relative rounding of times.
        const ROUNDING: f64 = 1e-9;
        if self.exceeded_reduction || scene.solver.reduce == 0.0 {
            return None;
        }
        let duration = scene.duration();
        if time - self.start? <= duration * (1.0 + ROUNDING) {
            return None;
        }
        self.exceeded_reduction = true;
        let springs = Reduction::new(scene)?.replaced.into_iter().any(|one| one.by == Replacement::Spring);
        springs.then(|| {
            let bound = scene.solver.reduce;
            format!(
                "longer than the scene's excitation of {duration} s: solver.reduce = {bound} takes elements for springs that \
                 relax in longer runs, and its bound grows with time"
            )
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::fmi::instance::Instance;
    use crate::fmi::instance::tests::instance_of;

    #[test]
    fn errors_warnings_and_discards_are_always_on() {
        let log = Log::new(false);
        let on: Vec<_> = Category::ALL.into_iter().filter(|&category| log.includes(category)).collect();
        assert_eq!(on, [Category::Error, Category::Warning, Category::Discard]);
    }

    #[test]
    fn categories_are_selected_by_name_or_all_at_once() {
        let mut log = Log::new(false);
        log.select(true, &["logSolver"]).unwrap();
        assert!(log.includes(Category::Solver) && !log.includes(Category::Events));
        log.select(true, &[]).unwrap();
        assert!(log.includes(Category::Solver) && log.includes(Category::Events));
        log.select(false, &[]).unwrap();
        assert!(!log.includes(Category::Solver) && !log.includes(Category::Events));
    }

    #[test]
    fn an_unknown_category_is_refused_and_changes_nothing() {
        let mut log = Log::new(true);
        let error = log.select(false, &["logEvents", "logAll"]).unwrap_err();
        assert_eq!(error.to_string(), "unknown log category \"logAll\"");
        assert!(log.includes(Category::Events));
    }

    /// One mass, moved at 1 m/s in steps of 0.25 s: the warnings.
    fn warnings(surface: &str, rest: &str) -> Vec<String> {
        let text = format!(
            "name = 'a'\nlayer = {{ masses = 1, spacing = 1.0, mass = 1.0, clearance = 9.0, vertical = {{ stiffness = 1.0, \
             maxwell = [{{ stiffness = 1.0, relaxation_time = 1e6 }}] }} }}\nsurface = {{ {surface} }}\n{rest}"
        );
        let mut instance = instance_of(&text);
        instance.take_messages();
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        (0..8).for_each(|i| step(&mut instance, 0.25 * f64::from(i)));
        instance.take_messages().into_iter().map(|message| message.text).collect()
    }

    fn step(instance: &mut Instance, time: f64) {
        instance.state.inputs.set_input(crate::fmi::Input::U, time);
        instance.do_step(time, 0.25).unwrap();
    }

    #[test]
    fn a_layer_that_leaves_its_profile_is_warned_of_once() {
        // Values without rates run on as they came, from the second step on: at 1.25 s the carrier has come beyond 1 m.
        let text = "t = 1.25 s: the profile reaches from -1.0 m to 1.0 m, but the layer has come to 1.25 m: \
                    beyond its ends the profile goes on straight, along its end tangents";
        assert_eq!(warnings("kind = 'points', x = [-1, 1], z = [0, 1]", ""), [text]);
        assert!(warnings("kind = 'flat'", "").is_empty());
    }

    #[test]
    fn a_run_longer_than_its_reduction_is_warned_of_once() {
        let solver = |reduce: f64, duration: f64| {
            format!("solver = {{ reduce = {reduce} }}\nexcitation = [{{ duration = {duration} }}]")
        };
        let warned = |reduce, duration| warnings("kind = 'flat'", &solver(reduce, duration));
        let text = warned(1e-3, 1.0);
        assert!(
            text.len() == 1 && text[0].starts_with("t = 1.25 s: longer than the scene's excitation of 1 s"),
            "{text:?}"
        );
        assert!(warned(1e-3, 2.0).is_empty());
        assert!(warned(0.0, 1.0).is_empty());
        // Nothing is replaced: the bound is too tight.
        assert!(warned(1e-9, 1.0).is_empty());
    }

    #[test]
    fn a_run_that_does_not_converge_is_warned_of_at_its_end() {
        let mut instance = instance_of(crate::simulation::tests::STICK_SLIP);
        instance.enter_initialization_mode().unwrap();
        instance.exit_initialization_mode().unwrap();
        let h = 1e-3;
        for i in 0..30 {
            instance.state.inputs.set_input(crate::fmi::Input::U, 0.02 * h * f64::from(i));
            instance.do_step(h * f64::from(i), h).unwrap();
        }
        assert!(instance.take_messages().is_empty());
        instance.terminate().unwrap();
        let messages = instance.take_messages();
        assert!(messages.len() == 1 && messages[0].text.contains("do not converge"), "{messages:?}");
    }
}
