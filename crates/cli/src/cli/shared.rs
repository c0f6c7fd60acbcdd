//! Options that several commands have.

use std::ops::Deref;

use asperity::scene::Setting;
use clap::Args;

// Not a doc comment: that would be the description of the commands that have it.
#[derive(Debug, Args)]
pub(crate) struct Set {
    /// Overrides a key of the scene or patch file: solver.relative_tolerance=1e-9,
    /// layer.vertical.maxwell[1].stiffness=0, friction.coulomb=0.5, surface="{ kind = 'flat' }". What the file does not
    /// have is added. May be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<Setting>,
}

impl Deref for Set {
    type Target = [Setting];

    fn deref(&self) -> &Self::Target {
        &self.set
    }
}
