//! What a scene or a patch says of its FMU's model description, for importers that read less than the standard has.

use super::values::Word;

/// `[fmu]` without the groups of outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FmuOptions {
    /// The type of outputs that are whole numbers.
    pub integers: IntegerType,
    /// The dependencies of outputs on inputs.
    pub dependencies: DependencyList,
}

/// The type of outputs that are whole numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IntegerType {
    /// Integer.
    #[default]
    Integer,
    /// Real.
    Real,
}

impl Word for IntegerType {
    const WORDS: &'static [(&'static str, Self)] = &[("integer", Self::Integer), ("real", Self::Real)];
}

/// Which dependencies of outputs on inputs the model description lists.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DependencyList {
    /// Those with all states held, which directional derivatives go with.
    #[default]
    Direct,
    /// None: outputs change with steps alone.
    None,
}

impl Word for DependencyList {
    const WORDS: &'static [(&'static str, Self)] = &[("direct", Self::Direct), ("none", Self::None)];
}
