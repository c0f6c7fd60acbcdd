//! Where the value of a key is in a scene.

use crate::scene::values::{Value, Word};
use crate::scene::{Axis, LinkKind, Scene};

/// Which of several equal tables a key is in.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct At {
    pub(in crate::scene) link: LinkKind,
    pub(in crate::scene) axis: Axis,
    /// The element of a list, counted from 0.
    pub(in crate::scene) index: usize,
}

/// Where what does not care stands, too.
impl Default for At {
    fn default() -> Self {
        Self::FIRST
    }
}

impl At {
    pub(in crate::scene) const FIRST: Self = Self { link: LinkKind::Vertical, axis: Axis::X, index: 0 };

    pub(in crate::scene) const fn link(link: LinkKind) -> Self {
        Self { link, ..Self::FIRST }
    }

    pub(in crate::scene) const fn axis(axis: Axis) -> Self {
        Self { axis, ..Self::FIRST }
    }

    pub(in crate::scene) const fn element(self, index: usize) -> Self {
        Self { index, ..self }
    }
}

/// How the value of a key is read from a scene and written into it.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene) struct Field {
    /// The value; `None` where the scene does not have it.
    pub(in crate::scene) get: fn(&Scene, At) -> Option<Value>,
    /// Writes a value in the range of the key; `None` where there is no place for it, or it is no word to choose from.
    pub(in crate::scene) set: fn(&mut Scene, At, &Value) -> Option<()>,
    /// What is done anew after the value has been changed.
    pub(in crate::scene) then: fn(&mut Scene),
}

impl Field {
    pub(super) const fn new(
        get: fn(&Scene, At) -> Option<Value>,
        set: fn(&mut Scene, At, &Value) -> Option<()>,
    ) -> Self {
        Self { get, set, then: |_| () }
    }

    /// A field whose value follows from others until it is written.
    pub(super) const fn counting_as(self, get: fn(&Scene, At) -> Option<Value>) -> Self {
        Self { get, ..self }
    }

    pub(super) const fn then(self, then: fn(&mut Scene)) -> Self {
        Self { then, ..self }
    }
}

/// The field at a path, `?` behind what a scene may not have: `field!(|scene, at| scene.layer.links[at.link]?.damping)`.
macro_rules! field {
    (|$scene:ident, $at:pat_param| $($path:tt)+) => {
        $crate::scene::keys::field::Field::new(
            |$scene, $at| $crate::scene::keys::field::reach!([as_ref get] [] $($path)+).value(),
            |$scene, $at, value| $crate::scene::keys::field::reach!([as_mut get_mut] [] $($path)+).set(value),
        )
    };
}

/// The path as an expression, to be read (`[as_ref get]`) or written (`[as_mut get_mut]`).
macro_rules! reach {
    ($ways:tt [$($done:tt)*]) => { $($done)* };
    ([$as:ident $get:ident] [$($done:tt)*] [$index:expr] ? $($rest:tt)*) => {
        $crate::scene::keys::field::reach!([$as $get] [$($done)* .$get($index)?] $($rest)*)
    };
    ([$as:ident $get:ident] [$($done:tt)*] ? $($rest:tt)*) => {
        $crate::scene::keys::field::reach!([$as $get] [$($done)* .$as()?] $($rest)*)
    };
    ($ways:tt [$($done:tt)*] $next:tt $($rest:tt)*) => {
        $crate::scene::keys::field::reach!($ways [$($done)* $next] $($rest)*)
    };
}

pub(super) use {field, reach};

/// What a field may hold.
pub(super) trait FieldValue {
    /// `None` of what the scene does not name.
    fn value(&self) -> Option<Value>;

    /// `None` if it cannot hold the value.
    fn set(&mut self, value: &Value) -> Option<()>;
}

impl FieldValue for f64 {
    fn value(&self) -> Option<Value> {
        Some(Value::Real(*self))
    }

    fn set(&mut self, value: &Value) -> Option<()> {
        let Value::Real(number) = value else { return None };
        *self = *number;
        Some(())
    }
}

impl FieldValue for usize {
    fn value(&self) -> Option<Value> {
        Some(Value::Integer(i32::try_from(*self).unwrap_or(i32::MAX)))
    }

    fn set(&mut self, value: &Value) -> Option<()> {
        let Value::Integer(number) = value else { return None };
        *self = usize::try_from(*number).ok()?;
        Some(())
    }
}

impl FieldValue for u64 {
    fn value(&self) -> Option<Value> {
        Some(Value::Integer(i32::try_from(*self).unwrap_or(i32::MAX)))
    }

    fn set(&mut self, value: &Value) -> Option<()> {
        let Value::Integer(number) = value else { return None };
        *self = u64::try_from(*number).ok()?;
        Some(())
    }
}

impl<T: Word> FieldValue for T {
    fn value(&self) -> Option<Value> {
        Some(Value::Text(self.as_word().into()))
    }

    fn set(&mut self, value: &Value) -> Option<()> {
        let Value::Text(word) = value else { return None };
        *self = T::parse(word)?;
        Some(())
    }
}

impl<T: FieldValue + Default> FieldValue for Option<T> {
    fn value(&self) -> Option<Value> {
        self.as_ref()?.value()
    }

    fn set(&mut self, value: &Value) -> Option<()> {
        self.get_or_insert_default().set(value)
    }
}
