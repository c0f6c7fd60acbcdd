//! What stands below the help of a command.

/// A line that runs in a checkout of the repository.
macro_rules! example {
    ($line:literal) => {
        concat!("Example, in a checkout of the repository:\n  ", $line)
    };
}
