//! Which columns of a table make its curves: one, or one for each temperature or frequency.

use std::f64::consts::TAU;

use asperity::tables::{ContentError, Dimension};
use asperity_formats::text::Block;

use super::columns::{Column, Columns, Quantity};
use super::heading::Condition;
use super::reading::Reading;
use super::stated_temperature::conditions_above;

/// One curve of a table: its columns. A table has one, or one for each temperature or frequency.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Frequency or time; `None` where there is no such column.
    pub(super) at: Option<Column>,
    pub(super) modulus: Column,
    pub(super) loss: Option<Column>,
    /// K.
    pub(super) temperature: Option<f64>,
    /// rad/s.
    pub(super) frequency: Option<f64>,
}

impl Curve {
    /// Its columns.
    pub(super) fn columns(&self) -> impl Iterator<Item = &Column> {
        [self.at.as_ref(), Some(&self.modulus), self.loss.as_ref()].into_iter().flatten()
    }

    /// With what holds for all of it.
    fn under(self, condition: Option<Condition>) -> Self {
        let of = |dimension| condition.filter(|found| found.dimension == dimension).map(|found| found.value);
        Self { temperature: of(Dimension::Temperature), frequency: of(Dimension::Frequency), ..self }
    }
}

/// The columns by what they are for: frequencies or times, moduli, losses.
#[derive(Debug)]
pub(super) struct Chosen {
    at: Vec<Column>,
    moduli: Vec<Column>,
    pub(super) losses: Vec<Column>,
}

impl Chosen {
    /// `None` where there are no moduli.
    pub(super) fn of(columns: &Columns) -> Result<Option<Self>, ContentError> {
        use Quantity::{
            Complex, Frequency, Loss, LossTangent, Phase, Relaxation, ShearComplex, ShearLoss, ShearRelaxation,
            ShearStorage, Storage, Time,
        };
        let (at, times) = (columns.first(&[&[Frequency]]), columns.first(&[&[Time]]));
        let relaxed = columns.first(&[&[Relaxation], &[ShearRelaxation]]);
        if at.is_empty() && !times.is_empty() && !relaxed.is_empty() {
            return Ok(Some(Self { at: times, moduli: relaxed, losses: Vec::new() }));
        }
        let moduli = columns.first(&[&[Storage], &[ShearStorage], &[Complex], &[ShearComplex]]);
        let kind = moduli.first().map(|column| column.quantity);
        let losses = columns.first(match kind {
            Some(Storage) => &[&[Loss], &[LossTangent], &[Phase]],
            Some(ShearStorage) => &[&[ShearLoss], &[Loss], &[LossTangent], &[Phase]],
            Some(_) => &[&[Phase], &[LossTangent]],
            None => &[&[Loss], &[ShearLoss], &[LossTangent], &[Phase]],
        });
        let missing = |expected: &str| Err(ContentError::value(Some(columns.line), "", "", expected));
        match (kind, losses.is_empty()) {
            (None, true) => Ok(None),
            (None, false) => missing("a column of the storage modulus: E' [MPa]"),
            (Some(Complex | ShearComplex), true) => {
                missing("a column of the phase beside |E*|: delta [°] or tan delta")
            }
            (Some(_), true) => missing("a column of the loss: E'' [MPa] or tan delta"),
            _ => Ok(Some(Self { at, moduli, losses })),
        }
    }

    /// A second column of frequencies beside one of moduli.
    pub(super) fn take_other_frequency(&mut self) -> Option<Column> {
        let has_two = self.at.len() == 2 && self.moduli.len() == 1 && self.at[0].quantity == Quantity::Frequency;
        if has_two { self.at.pop() } else { None }
    }

    /// One curve, or a pair of columns for each temperature, or for each frequency where there is no column of these.
    pub(super) fn curves(
        &self,
        block: &Block<'_>,
        columns: &Columns,
        reading: &Reading<'_>,
    ) -> Result<Vec<Curve>, ContentError> {
        let Self { at, moduli, losses } = self;
        let curves = if let [modulus] = &moduli[..] {
            match twin(columns.line, at).or_else(|| twin(columns.line, losses)) {
                Some(error) => Err(error),
                None => {
                    let (at, modulus, loss) = (at.first().cloned(), modulus.clone(), losses.first().cloned());
                    let condition = modulus.condition;
                    Ok(vec![Curve { at, modulus, loss, temperature: None, frequency: None }.under(condition)])
                }
            }
        } else {
            self.check_counts(columns.line)?;
            self.pairs(block, columns, reading)
        }?;
        let has_none = |curve: &Curve| curve.at.is_none() && curve.frequency.or(reading.frequency).is_none();
        if curves.iter().any(has_none) {
            let expected = "a frequency column, f [Hz] or omega [rad/s]; or `frequency` 10Hz for all rows";
            return Err(ContentError::value(Some(columns.line), "", "", expected));
        }
        Ok(curves)
    }

    /// Of several columns of moduli there are as many of losses, and one of frequencies or as many.
    fn check_counts(&self, line: usize) -> Result<(), ContentError> {
        let Self { at, moduli, losses } = self;
        let fits = |count: usize| count == moduli.len();
        if (losses.is_empty() || fits(losses.len())) && (at.len() <= 1 || fits(at.len())) {
            return Ok(());
        }
        let given =
            format!("{} columns of moduli, {} of losses, {} of frequencies", moduli.len(), losses.len(), at.len());
        let expected = "a pair of moduli a temperature or frequency, and one frequency or one for each";
        Err(ContentError::value(Some(line), "", &given, expected))
    }

    fn pairs(&self, block: &Block<'_>, columns: &Columns, reading: &Reading<'_>) -> Result<Vec<Curve>, ContentError> {
        let Self { at, moduli, losses } = self;
        let of_frequency = |column: &Column| column.condition.is_some_and(|it| it.dimension == Dimension::Frequency);
        let has_temperatures = !columns.all(&[Quantity::Temperature, Quantity::SetTemperature]).is_empty();
        let by_frequency = at.is_empty() && (has_temperatures || moduli.iter().all(of_frequency));
        let dimension = if by_frequency { Dimension::Frequency } else { Dimension::Temperature };
        let above = conditions_above(block, columns.line, reading.units, dimension)?;
        let pairs = Pairs { above: &above, line: columns.line, dimension };
        let curve = |(i, modulus): (usize, &Column)| {
            let value = pairs.condition(modulus).ok_or_else(|| {
                let expected = match dimension {
                    Dimension::Frequency => {
                        "its frequency, in its name (E' [MPa] 1 Hz) or in the line above; or one column of a kind: \
                         `ignore` NAME"
                    }
                    _ => {
                        "its temperature, in its name (E' [MPa] 20 °C) or in the line above; or one column of a kind: \
                         `ignore` NAME"
                    }
                };
                modulus.refuse(columns.line, "", expected)
            })?;
            let at = if at.len() == 1 { at.first().cloned() } else { pairs.partner(at, i, value)? };
            let loss = pairs.partner(losses, i, value)?;
            let curve = Curve { at, modulus: modulus.clone(), loss, temperature: None, frequency: None };
            Ok(curve.under(Some(Condition { dimension, value })))
        };
        moduli.iter().enumerate().map(curve).collect()
    }
}

/// Finds which columns belong together.
struct Pairs<'c> {
    /// What the line above the names says, in SI units.
    above: &'c [Option<f64>],
    line: usize,
    /// Of what tells them apart.
    dimension: Dimension,
}

impl Pairs<'_> {
    fn condition(&self, column: &Column) -> Option<f64> {
        let own = column.condition.filter(|condition| condition.dimension == self.dimension);
        own.map(|condition| condition.value).or_else(|| self.above.get(column.index).copied().flatten())
    }

    /// The column for place `i`, where its condition is this `value` or none is named; else the only one of that value.
    fn partner(&self, columns: &[Column], i: usize, value: f64) -> Result<Option<Column>, ContentError> {
        let Some(own) = columns.get(i) else { return Ok(None) };
        if self.condition(own).is_none_or(|other| other == value) {
            return Ok(Some(own.clone()));
        }
        let mut alike = columns.iter().filter(|column| self.condition(column) == Some(value));
        match (alike.next(), alike.next()) {
            (Some(found), None) => Ok(Some(found.clone())),
            _ => {
                let expected = match self.dimension {
                    Dimension::Frequency => format!("one column of its kind at {:.4} Hz", value / TAU),
                    _ => format!("one column of its kind at {value:.2} K"),
                };
                Err(own.refuse(self.line, "", &expected))
            }
        }
    }
}

/// Two columns of one kind, where one is used, are one too many.
pub(super) fn twin(line: usize, columns: &[Column]) -> Option<ContentError> {
    let [first, second, ..] = columns else { return None };
    let expected = format!("one column of a kind: {} is there already; ignore one by `ignore` NAME", first.text);
    Some(second.refuse(line, "", &expected))
}
