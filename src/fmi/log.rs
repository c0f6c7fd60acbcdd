//! What the FMU tells its master: messages by category, collected during a call and delivered at its end.

use super::fault::{Fault, Status};

/// The categories of messages, as the model description lists them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// Why a call failed.
    Error,
    /// What is worth telling though the call succeeded.
    Warning,
    /// Why a step was discarded.
    Discard,
    /// Mode changes of the masses.
    Events,
    /// The integrator's work, a line a step, and each handover between its drivers.
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

    /// What is told in it.
    pub fn description(self) -> &'static str {
        match self {
            Self::Error => "Why a call failed; always told",
            Self::Warning => "What is worth telling though nothing failed; always told",
            Self::Discard => "Why a step was discarded; always told",
            Self::Events => "Every change of a mass between free, slipping and sticking",
            Self::Solver => "The integrator's work, one line a communication step, and handovers of the method auto",
        }
    }

    fn of(status: Status) -> Self {
        match status {
            Status::Ok => Self::Events,
            Status::Warning => Self::Warning,
            Status::Discard => Self::Discard,
            Status::Error | Status::Fatal => Self::Error,
        }
    }
}

/// A message to the master.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Message {
    pub(super) status: Status,
    pub(super) category: Category,
    pub(super) text: String,
}

impl Message {
    /// Tells of a fault or a warning.
    pub(super) fn of_status(status: Status, text: String) -> Self {
        Self { status, category: Category::of(status), text }
    }
}

/// The messages of one instance.
#[derive(Clone, Debug, Default)]
pub(super) struct Log {
    events: bool,
    solver: bool,
    waiting: Vec<Message>,
}

impl Log {
    /// A log that tells everything, or errors, warnings and discarded steps alone.
    pub(super) fn new(everything: bool) -> Self {
        Self { events: everything, solver: everything, waiting: Vec::new() }
    }

    /// Asks for the categories named (all, where none is), or for none of those that are not always told.
    pub(super) fn ask_for(&mut self, on: bool, names: &[&str]) -> Result<(), Fault> {
        let known = |name: &str| Category::ALL.iter().any(|category| category.name() == name);
        if let Some(&name) = names.iter().find(|name| !known(name)) {
            return Err(Fault::UnknownCategory(name.into()));
        }
        let asked = |category: Category| on && (names.is_empty() || names.contains(&category.name()));
        self.events = asked(Category::Events);
        self.solver = asked(Category::Solver);
        Ok(())
    }

    /// Whether messages of `category` are told.
    pub(super) fn tells(&self, category: Category) -> bool {
        match category {
            Category::Error | Category::Warning | Category::Discard => true,
            Category::Events => self.events,
            Category::Solver => self.solver,
        }
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
    fn errors_warnings_and_discards_are_always_told() {
        let log = Log::new(false);
        let told: Vec<_> = Category::ALL.into_iter().filter(|&category| log.tells(category)).collect();
        assert_eq!(told, [Category::Error, Category::Warning, Category::Discard]);
    }

    #[test]
    fn categories_are_asked_for_by_name_or_all_at_once() {
        let mut log = Log::new(false);
        log.ask_for(true, &["logSolver"]).unwrap();
        assert!(log.tells(Category::Solver) && !log.tells(Category::Events));
        log.ask_for(true, &[]).unwrap();
        assert!(log.tells(Category::Solver) && log.tells(Category::Events));
        log.ask_for(false, &[]).unwrap();
        assert!(!log.tells(Category::Solver) && !log.tells(Category::Events));
    }

    #[test]
    fn an_unknown_category_is_refused_and_changes_nothing() {
        let mut log = Log::new(true);
        let fault = log.ask_for(false, &["logEvents", "logAll"]).unwrap_err();
        assert_eq!(fault.to_string(), "unknown log category \"logAll\"");
        assert!(log.tells(Category::Events));
    }
}
