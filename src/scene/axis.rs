//! The axes of the plane that the model lies in, and the kinds of link along them.

use std::ops::{Add, Index, IndexMut, Range, Sub};
use std::slice;

use serde::{Deserialize, Serialize, Serializer};

/// The two axes of the carrier.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Axis {
    /// Along x: u.
    X,
    /// Along z: w.
    Z,
}

impl Axis {
    /// Both.
    pub const ALL: [Self; 2] = [Self::X, Self::Z];

    /// The name of the axis's table in `[carrier]`.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Z => "z",
        }
    }

    /// The name of the force of the layer on the carrier.
    pub fn force_name(self) -> &'static str {
        match self {
            Self::X => "F_x",
            Self::Z => "F_z",
        }
    }

    /// The lateral links along the axis.
    pub fn lateral(self) -> LinkKind {
        match self {
            Self::X => LinkKind::LateralX,
            Self::Z => LinkKind::LateralZ,
        }
    }

    /// The links to the carrier along the axis.
    pub fn link(self) -> LinkKind {
        match self {
            Self::X => LinkKind::Horizontal,
            Self::Z => LinkKind::Vertical,
        }
    }
}

/// One value for each axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ByAxis<T> {
    /// Along x.
    pub x: T,
    /// Along z.
    pub z: T,
}

impl<T> ByAxis<T> {
    /// The values that `value` gives for the axes.
    #[inline(always)]
    pub fn from_fn(mut value: impl FnMut(Axis) -> T) -> Self {
        Self { x: value(Axis::X), z: value(Axis::Z) }
    }

    /// What `change` makes of the values.
    #[inline(always)]
    pub fn map<U>(self, mut change: impl FnMut(T) -> U) -> ByAxis<U> {
        ByAxis { x: change(self.x), z: change(self.z) }
    }

    /// The value along x and that along z.
    pub fn iter(&self) -> impl Iterator<Item = &T> {
        [&self.x, &self.z].into_iter()
    }

    /// The value along x and that along z, open to changes.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        [&mut self.x, &mut self.z].into_iter()
    }
}

impl<T> ByAxis<Option<T>> {
    /// Whether there is one along any axis.
    pub fn any(&self) -> bool {
        self.x.is_some() || self.z.is_some()
    }

    /// The value of an axis, if there is one.
    pub fn get(&self, axis: Axis) -> Option<&T> {
        self[axis].as_ref()
    }

    /// The value of an axis, if there is one.
    pub fn get_mut(&mut self, axis: Axis) -> Option<&mut T> {
        self[axis].as_mut()
    }
}

impl<T: Add<Output = T>> Add for ByAxis<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, z: self.z + other.z }
    }
}

impl<T: Sub<Output = T>> Sub for ByAxis<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, z: self.z - other.z }
    }
}

impl<T> Index<Axis> for ByAxis<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, axis: Axis) -> &T {
        match axis {
            Axis::X => &self.x,
            Axis::Z => &self.z,
        }
    }
}

impl<T> IndexMut<Axis> for ByAxis<T> {
    #[inline(always)]
    fn index_mut(&mut self, axis: Axis) -> &mut T {
        match axis {
            Axis::X => &mut self.x,
            Axis::Z => &mut self.z,
        }
    }
}

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
    /// The kinds in the order of the scene's keys.
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

    /// The axis that the link's elongation lies along.
    pub fn axis(self) -> Axis {
        if self.is_along_x() { Axis::X } else { Axis::Z }
    }

    /// How many links of this kind a layer of `masses` ≥ 1 masses has.
    pub fn count(self, masses: usize) -> usize {
        masses - usize::from(self.is_lateral())
    }

    /// The links of this kind on mass `i` of a layer of `masses`.
    pub fn links_on(self, i: usize, masses: usize) -> Range<usize> {
        if self.is_lateral() { i.saturating_sub(1)..(i + 1).min(masses - 1) } else { i..i + 1 }
    }

    /// The difference between the ends of a link: of `values` of two masses, or of one and the `carrier`.
    #[inline(always)]
    pub fn difference(self, values: &[f64], carrier: f64, link: usize) -> f64 {
        if self.is_lateral() { values[link + 1] - values[link] } else { values[link] - carrier }
    }
}

/// One value for each kind of link, in the order of [`LinkKind::ALL`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ByLink<T>(pub [T; 4]);

impl<T> ByLink<T> {
    /// The values that `value` gives for the kinds.
    pub fn from_fn(value: impl FnMut(LinkKind) -> T) -> Self {
        Self(LinkKind::ALL.map(value))
    }

    /// What `change` makes of the values.
    #[inline(always)]
    pub fn map<U>(self, change: impl FnMut(T) -> U) -> ByLink<U> {
        ByLink(self.0.map(change))
    }

    /// The values in the order of the kinds.
    pub fn iter(&self) -> slice::Iter<'_, T> {
        self.0.iter()
    }

    /// The values in the order of the kinds, open to changes.
    pub fn iter_mut(&mut self) -> slice::IterMut<'_, T> {
        self.0.iter_mut()
    }
}

impl<T> ByLink<Option<T>> {
    /// The value of a kind, if there is one.
    pub fn get(&self, kind: LinkKind) -> Option<&T> {
        self[kind].as_ref()
    }

    /// The value of a kind, if there is one.
    pub fn get_mut(&mut self, kind: LinkKind) -> Option<&mut T> {
        self[kind].as_mut()
    }
}

impl<'a, T> IntoIterator for &'a ByLink<T> {
    type Item = &'a T;
    type IntoIter = slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter()
    }
}

impl<'a, T> IntoIterator for &'a mut ByLink<T> {
    type Item = &'a mut T;
    type IntoIter = slice::IterMut<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.iter_mut()
    }
}

/// Serialises the values under the names of the kinds.
pub(super) fn by_name<T: Serialize, S: Serializer>(values: &ByLink<T>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(LinkKind::ALL.map(|kind| (kind.name(), &values[kind])))
}

impl<T> Index<LinkKind> for ByLink<T> {
    type Output = T;

    #[inline(always)]
    fn index(&self, kind: LinkKind) -> &T {
        &self.0[kind as usize]
    }
}

impl<T> IndexMut<LinkKind> for ByLink<T> {
    #[inline(always)]
    fn index_mut(&mut self, kind: LinkKind) -> &mut T {
        &mut self.0[kind as usize]
    }
}
