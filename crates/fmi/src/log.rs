//! Messages to the master: by category, collected during a call and delivered at its end.

use super::error::{Error, Status};
use asperity::simulation::ModeChange;

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
pub struct Message {
    pub(super) status: Status,
    pub(super) category: Category,
    pub(super) text: String,
}

impl Message {
    /// A message of a call that returns `status`, or a warning.
    pub(super) fn from_status(status: Status, text: String) -> Self {
        Self { status, category: Category::new(status), text }
    }

    /// A record of a call that succeeds.
    pub(super) fn record(category: Category, text: String) -> Self {
        Self { status: Status::Ok, category, text }
    }

    /// A mode change of `what`.
    pub(super) fn from_mode_change(change: &ModeChange, what: &str) -> Self {
        let (time, from, to) = (change.time, mode(change.from), mode(change.to));
        Self::record(Category::Events, format!("t = {time} s: {what} from {from} to {to}"))
    }
}

fn mode(number: i8) -> &'static str {
    match number {
        0 => "free",
        1 => "slipping forwards",
        -1 => "slipping backwards",
        _ => "sticking",
    }
}

/// The name that the standard has for all categories.
const ALL: &str = "logAll";

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

    /// Switches on the categories named (all where none is, or by the name `logAll`) and off all others, except those
    /// that are always on.
    pub(super) fn select(&mut self, on: bool, names: &[&str]) -> Result<(), Error> {
        let known = |name: &str| name == ALL || Category::ALL.iter().any(|category| category.name() == name);
        if let Some(&name) = names.iter().find(|name| !known(name)) {
            return Err(Error::UnknownCategory(name.into()));
        }
        let all = names.is_empty() || names.contains(&ALL);
        let asked = |category: Category| on && (all || names.contains(&category.name()));
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

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn mode_changes_are_logged_in_words() {
        let change = ModeChange { time: 0.5, mass: 2, from: 0, to: -1 };
        let message = Message::from_mode_change(&change, "mass 3");
        assert_eq!(message.text, "t = 0.5 s: mass 3 from free to slipping backwards");
    }

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
        for names in [&[][..], &["logAll"], &["logSolver", "logAll"]] {
            log.select(true, names).unwrap();
            assert!(log.includes(Category::Solver) && log.includes(Category::Events));
        }
        log.select(false, &["logAll"]).unwrap();
        assert!(!log.includes(Category::Solver) && !log.includes(Category::Events));
    }

    #[test]
    fn an_unknown_category_is_refused_and_changes_nothing() {
        let mut log = Log::new(true);
        let error = log.select(false, &["logEvents", "logNone"]).unwrap_err();
        assert_eq!(error.to_string(), "unknown log category \"logNone\"");
        assert!(log.includes(Category::Events));
    }
}
