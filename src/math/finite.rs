//! The search for a number that is not finite, through all that a value serialises.

use std::fmt;

use serde::ser::{self, Serialize, Serializer};

/// The first number of `value` that is not finite, and the name of the innermost field that holds it.
pub fn not_finite(value: &impl Serialize) -> Option<(&'static str, f64)> {
    value.serialize(&mut NonFiniteSearch { field: "value" }).err().and_then(|found| found.0)
}

/// Serialises to nothing and fails at the first such number; each method that does not returns the search itself.
struct NonFiniteSearch {
    field: &'static str,
}

/// The number found; `None` where a value cannot be serialised.
#[derive(Debug, thiserror::Error)]
#[error("{0:?}")]
struct NonFinite(Option<(&'static str, f64)>);

impl ser::Error for NonFinite {
    fn custom<T: fmt::Display>(_: T) -> Self {
        Self(None)
    }
}

/// Methods for what is no such number, or holds values that come to their turn.
macro_rules! go_on {
    ($($method:ident($($type:ty),*);)*) => {
        $(fn $method(self $(, _: $type)*) -> Result<Self, NonFinite> { Ok(self) })*
    };
}

impl Serializer for &mut NonFiniteSearch {
    type Ok = Self;
    type Error = NonFinite;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Self;
    type SerializeMap = Self;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    go_on! {
        serialize_bool(bool); serialize_char(char); serialize_str(&str); serialize_bytes(&[u8]);
        serialize_i8(i8); serialize_i16(i16); serialize_i32(i32); serialize_i64(i64);
        serialize_u8(u8); serialize_u16(u16); serialize_u32(u32); serialize_u64(u64);
        serialize_none(); serialize_unit(); serialize_unit_struct(&'static str);
        serialize_unit_variant(&'static str, u32, &'static str);
        serialize_seq(Option<usize>); serialize_tuple(usize); serialize_map(Option<usize>);
        serialize_tuple_struct(&'static str, usize); serialize_struct(&'static str, usize);
        serialize_tuple_variant(&'static str, u32, &'static str, usize);
        serialize_struct_variant(&'static str, u32, &'static str, usize);
    }

    fn serialize_f32(self, value: f32) -> Result<Self, NonFinite> {
        self.serialize_f64(f64::from(value))
    }

    fn serialize_f64(self, value: f64) -> Result<Self, NonFinite> {
        if value.is_finite() { Ok(self) } else { Err(NonFinite(Some((self.field, value)))) }
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<Self, NonFinite> {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<Self, NonFinite> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        value: &T,
    ) -> Result<Self, NonFinite> {
        value.serialize(self)
    }
}

/// What holds other values. Where these have no names, that of the field around them stands.
macro_rules! compounds {
    ($($compound:ident: $($method:ident($($field:ident)?)),*;)*) => {
        $(impl<'a> ser::$compound for &'a mut NonFiniteSearch {
            type Ok = &'a mut NonFiniteSearch;
            type Error = NonFinite;

            $(fn $method<T: Serialize + ?Sized>(
                &mut self,
                $($field: &'static str,)?
                value: &T,
            ) -> Result<(), NonFinite> {
                $(self.field = $field;)?
                value.serialize(&mut **self).map(|_| ())
            })*

            fn end(self) -> Result<Self, NonFinite> {
                Ok(self)
            }
        })*
    };
}

compounds! {
    SerializeSeq: serialize_element();
    SerializeTuple: serialize_element();
    SerializeTupleStruct: serialize_field();
    SerializeTupleVariant: serialize_field();
    SerializeMap: serialize_key(), serialize_value();
    SerializeStruct: serialize_field(field);
    SerializeStructVariant: serialize_field(field);
}

#[cfg(test)]
mod tests {
    use serde::Serialize;

    use super::not_finite;

    #[derive(Serialize)]
    struct Inner {
        speeds: Vec<f64>,
        named: Option<(u64, f64)>,
    }

    #[derive(Serialize)]
    enum Outer {
        Empty,
        Unnamed(f64, Inner),
        Named { place: f64 },
    }

    #[test]
    fn the_first_number_that_is_not_finite_is_found_with_its_field() {
        let inner = |speed, named| Inner { speeds: vec![1.0, speed], named };
        assert_eq!(not_finite(&Outer::Empty), None);
        assert_eq!(not_finite(&Outer::Unnamed(f64::MAX, inner(2.0, Some((u64::MAX, -0.0))))), None);
        assert_eq!(
            not_finite(&Outer::Unnamed(1.0, inner(f64::INFINITY, Some((1, f64::NAN))))),
            Some(("speeds", f64::INFINITY))
        );
        assert!(not_finite(&inner(0.0, Some((1, f64::NAN)))).is_some_and(|(field, _)| field == "named"));
        assert_eq!(not_finite(&Outer::Named { place: f64::NEG_INFINITY }), Some(("place", f64::NEG_INFINITY)));
        assert_eq!(not_finite(&[f64::INFINITY]), Some(("value", f64::INFINITY)));
    }
}
