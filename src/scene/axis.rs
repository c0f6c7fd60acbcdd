//! The axes of the plane that the model lies in.

use std::ops::{Add, Index, IndexMut, Sub};

use serde::{Deserialize, Serialize};

use super::LinkKind;

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
