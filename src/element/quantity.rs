//! The columns of numbers of a sweep's table.

use super::grid::Load;
use crate::scene::{SMALLEST, is_possible};
use crate::table::Column;

/// The values that a column may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Range {
    Any,
    NonNegative,
    Positive,
}

/// What an element makes of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    Required,
    Optional,
    Ignored,
}

/// What is known of a column; `{load}` and `{unit}` stand for those of a table's [`Load`].
struct QuantityColumn {
    name: &'static str,
    unit: &'static str,
    range: Range,
    need: Need,
}

macro_rules! columns {
    ($($(#[$doc:meta])* $quantity:ident: $name:literal, $unit:literal, $range:ident, $need:ident;)*) => {
        /// The columns of numbers of a table.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Quantity {
            $($(#[$doc])* $quantity,)*
        }

        const COLUMNS: [QuantityColumn; Quantity::ALL.len()] =
            [$(QuantityColumn { name: $name, unit: $unit, range: Range::$range, need: Need::$need },)*];

        impl Quantity {
            /// All of them, in their order in a file.
            pub const ALL: [Self; [$(Self::$quantity),*].len()] = [$(Self::$quantity),*];
        }
    };
}

columns! {
    /// Friction coefficient, 1.
    Friction: "friction", "1", NonNegative, Required;
    /// Standard error of the friction coefficient, 1.
    FrictionStandardError: "friction_standard_error", "1", NonNegative, Ignored;
    /// Part of the friction coefficient that is hysteresis, 1.
    Hysteresis: "friction_hysteresis", "1", Any, Optional;
    /// Part of the friction coefficient that is hysteresis of the waves that the profile lacks, 1; a part of the former.
    FineHysteresis: "friction_fine", "1", Any, Ignored;
    /// Part of the friction coefficient that is adhesion, 1.
    Adhesion: "friction_adhesion", "1", Any, Ignored;
    /// Mean load over the window, Pa or N.
    MeanLoad: "mean_{load}", "{unit}", Positive, Ignored;
    /// Masses in contact over all masses, 1.
    ContactRatio: "contact_ratio", "1", NonNegative, Optional;
    /// Area that touches with the roughness below the profile's over the nominal area, 1.
    RealArea: "area_real", "1", NonNegative, Ignored;
    /// Mean flash temperature of what is in contact, above the mean of the surface, K.
    FlashMean: "flash_mean", "K", Any, Ignored;
    /// How much warmer than the rubber was the surface is after the way of the sweep, K.
    SurfaceRise: "surface_rise", "K", Any, Ignored;
    /// Power lost in dampers, W.
    DamperPower: "P_damper", "W", NonNegative, Optional;
    /// Power lost in Maxwell elements, W.
    MaxwellPower: "P_maxwell", "W", NonNegative, Optional;
    /// Power lost in friction, W.
    FrictionPower: "P_friction", "W", NonNegative, Optional;
    /// Power lost in impacts, W.
    ImpactPower: "P_impact", "W", NonNegative, Optional;
    /// Mean separation of the carrier's rest line and the profile's mean line, m.
    Separation: "separation", "m", Any, Required;
    /// Smooth plates at this distance let as much fluid through along the sliding, m.
    LeakGap: "leak_gap", "m", NonNegative, Optional;
    /// Smooth plates at this distance carry as much fluid along, m.
    DragGap: "drag_gap", "m", NonNegative, Optional;
    /// The leak gap across the sliding, m; of maps.
    LeakGapAcross: "leak_gap_across", "m", NonNegative, Ignored;
    /// The leak gap by the effective medium beside the one solved for, m; of maps.
    LeakGapMedium: "leak_gap_medium", "m", NonNegative, Ignored;
    /// The drag gap likewise, m.
    DragGapMedium: "drag_gap_medium", "m", NonNegative, Ignored;
    /// Tangential stiffness at the start of motion, N/m.
    Stiffness: "tangential_stiffness", "N/m", Positive, Required;
    /// Displacement w of the carrier, m.
    Displacement: "w", "m", Any, Ignored;
    /// Number of displacements w that were tried, 1.
    Runs: "runs", "1", Positive, Ignored;
    /// Simulated time of the last run, s.
    Time: "time", "s", Positive, Ignored;
}

impl Quantity {
    /// The powers lost, by channel.
    pub const CHANNELS: [Self; 4] = [Self::DamperPower, Self::MaxwellPower, Self::FrictionPower, Self::ImpactPower];

    /// Whether it tells how a fluid passes: only tables that were asked for it have its column.
    pub fn is_of_gaps(self) -> bool {
        matches!(self, Self::LeakGap | Self::DragGap | Self::LeakGapAcross | Self::LeakGapMedium | Self::DragGapMedium)
    }

    /// Its column in a table of such loads, empty.
    pub fn column(self, load: Load) -> Column {
        Column::numbers(self.name(load), self.unit(load))
    }

    fn known(self) -> &'static QuantityColumn {
        &COLUMNS[self as usize]
    }

    pub(super) fn need(self) -> Need {
        self.known().need
    }

    /// The name of its column in a table of such loads.
    pub fn name(self, load: Load) -> String {
        self.known().name.replace("{load}", load.name())
    }

    /// The unit of its column.
    pub fn unit(self, load: Load) -> &'static str {
        match self.known().unit {
            "{unit}" => load.unit(),
            unit => unit,
        }
    }

    pub(super) fn expected(self) -> &'static str {
        match self.known().range {
            Range::Any => "a number",
            Range::NonNegative => "a number, 0 or more",
            Range::Positive => "a number above 0",
        }
    }

    pub(super) fn allows(self, value: f64) -> bool {
        is_possible(value)
            && match self.known().range {
                Range::Any => true,
                Range::NonNegative => value >= 0.0,
                Range::Positive => value >= SMALLEST,
            }
    }
}
