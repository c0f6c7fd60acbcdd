//! The element at a point of its table.

use asperity::element::{Element, OperatingPoint, PointContact};
use asperity::scene::{Parameter, Value};
use asperity::simulation::Start;

use crate::error::Error;

/// The element at the temperature of a point.
pub(super) fn element_at(
    contact: &PointContact,
    point: &OperatingPoint,
    start: &Start,
) -> Result<Element, Error> {
    let mut contact = contact.clone();
    if let (Some(kelvin), true) = (point.temperature, contact.table().grid.temperatures.len() > 1) {
        contact.set_parameter(Parameter::TEMPERATURE, Value::Real(kelvin))?;
    }
    Ok(Element::new(&contact, start)?)
}
