//! The kinds of links.

/// The four kinds of link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LinkKind {
    /// Carrier to mass, along z: elongation ζ_i - w.
    Vertical,
    /// Carrier to mass, along x: elongation ξ_i - u.
    Horizontal,
    /// Mass i to mass i+1, along x: elongation ξ_{i+1} - ξ_i.
    LateralX,
    /// Mass i to mass i+1, along z: elongation ζ_{i+1} - ζ_i.
    LateralZ,
}

impl LinkKind {
    /// The kinds in the order of the scene's keys; `kind as usize` counts them.
    pub const ALL: [Self; 4] = [Self::Vertical, Self::Horizontal, Self::LateralX, Self::LateralZ];

    /// The name of the link's table in `[layer]`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertical => "vertical",
            Self::Horizontal => "horizontal",
            Self::LateralX => "lateral_x",
            Self::LateralZ => "lateral_z",
        }
    }

    /// What the link joins, in a few words.
    pub fn description(self) -> &'static str {
        match self {
            Self::Vertical => "vertical link (carrier to mass)",
            Self::Horizontal => "horizontal link (carrier to mass)",
            Self::LateralX => "lateral link along x (mass to mass)",
            Self::LateralZ => "lateral link along z (mass to mass)",
        }
    }

    /// Whether the link joins two masses.
    pub fn is_lateral(self) -> bool {
        matches!(self, Self::LateralX | Self::LateralZ)
    }

    /// Whether the link's elongation lies along x.
    pub fn is_along_x(self) -> bool {
        matches!(self, Self::Horizontal | Self::LateralX)
    }

    /// How many links of this kind a layer of `masses` ≥ 1 masses has.
    pub fn count(self, masses: usize) -> usize {
        masses - usize::from(self.is_lateral())
    }
}
