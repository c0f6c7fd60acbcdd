//! A Prony series as it stands in a file, and its moduli of tension in Pa.

use asperity::scene::ElasticConstants;
use asperity::tables::{ContentError, Dimension, NOT_NEGATIVE, ReadColumn, ReadTable, ReadingNote, Unit};

use crate::text::{Line, number, plain};

/// What the moduli of a file are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ModulusKind {
    /// E_j, Pa.
    Tension,
    /// G_j, Pa.
    Shear,
    /// e_j = E_j/E_0 or g_j = G_j/G_0.
    Relative,
}

/// A term as it stands in the file, in SI units.
#[derive(Clone, Copy, Debug)]
pub(super) struct WrittenTerm {
    pub(super) line: usize,
    pub(super) time: f64,
    pub(super) modulus: f64,
    /// k_j = K_j/K_0.
    pub(super) bulk: Option<f64>,
}

/// A series as it stands in the file.
#[derive(Debug)]
pub(super) struct WrittenSeries<'a> {
    pub(super) terms: Vec<WrittenTerm>,
    pub(super) kind: ModulusKind,
    /// Whether the file says in which unit they are.
    pub(super) names_unit: bool,
    /// The line of its names.
    pub(super) line: Option<usize>,
    /// Lines that may hold E_0, without the signs of comments.
    pub(super) header: Vec<Line<'a>>,
    /// Begins a comment.
    pub(super) comment: &'static str,
    pub(super) notes: Vec<ReadingNote>,
}

pub(super) fn note(text: impl Into<String>, assumed: bool) -> ReadingNote {
    ReadingNote { text: text.into(), assumed }
}

impl WrittenSeries<'_> {
    /// The terms: moduli of tension in Pa.
    pub(super) fn convert(mut self, elastic: ElasticConstants) -> Result<ReadTable, ContentError> {
        let sum: f64 = self.terms.iter().map(|term| term.modulus).sum();
        if self.kind != ModulusKind::Relative && !self.names_unit {
            self.check_assumed_unit(sum, elastic)?;
        }
        let factor = match self.kind {
            ModulusKind::Relative => self.instantaneous_modulus(sum, elastic)?,
            ModulusKind::Shear => {
                let text = format!("moduli of shear: E = 2(1 + ν) G with the scene's ν = {}", elastic.poisson_ratio);
                self.notes.push(note(text, false));
                2.0 * (1.0 + elastic.poisson_ratio)
            }
            ModulusKind::Tension => 1.0,
        };
        if self.terms.iter().any(|term| term.bulk.is_some_and(|bulk| bulk != term.modulus)) {
            let text = "bulk moduli (k_i) are not used: the model's Poisson's ratio does not relax";
            self.notes.push(note(text, true));
        }
        let mut columns: Vec<ReadColumn> = Vec::new();
        for (index, role) in asperity::scene::SERIES.roles.iter().enumerate() {
            columns.push(ReadColumn::new(role, index, Unit::si(role.dimension)));
        }
        for term in &self.terms {
            let modulus = term.modulus * factor;
            if !NOT_NEGATIVE.holds(modulus) {
                let given = format!("{modulus:?} Pa");
                return Err(ContentError::value(Some(term.line), "modulus", &given, &NOT_NEGATIVE.to_string()));
            }
            columns[0].values.push(term.time);
            columns[1].values.push(modulus);
        }
        let lines = self.terms.iter().map(|term| term.line).collect();
        Ok(ReadTable { columns, lines, notes: self.notes, line: self.line })
    }

    /// Moduli without a unit may be relative to an E_0 of the header. Others that look relative, or are no share of the
    /// scene's modulus, are not in Pa.
    fn check_assumed_unit(&mut self, sum: f64, elastic: ElasticConstants) -> Result<(), ContentError> {
        /// Of E_∞: terms of less in all would hardly relax it.
        const LEAST: f64 = 1e-3;
        let is_relative = sum > 0.0 && sum <= 1.0;
        if is_relative && self.header.iter().any(|&line| Setting::read(line).is_some()) {
            self.kind = ModulusKind::Relative;
            self.notes.push(note("moduli without a unit are taken as relative, for an E_0 is given", true));
            return Ok(());
        }
        if !is_relative && sum >= LEAST * elastic.equilibrium_modulus {
            return Ok(());
        }
        let expected = "moduli in Pa with a header that says so, modulus [Pa] or [MPa]; relative ones beside \
                        # E0 = … MPa";
        let line = self.line.or(self.terms.first().map(|term| term.line));
        let given = format!("at most {sum} in all, without a unit");
        Err(ContentError::value(line, "modulus", &given, expected))
    }

    /// E_0 of relative moduli, from the header: nothing else says it well enough.
    fn instantaneous_modulus(&mut self, sum: f64, elastic: ElasticConstants) -> Result<f64, ContentError> {
        let relaxed = elastic.equilibrium_modulus;
        if !(0.0..=1.0).contains(&sum) {
            let expected = "relative moduli whose sum is at most 1: what relaxes of E_0";
            return Err(ContentError::value(self.line, "relative moduli", &format!("a sum of {sum}"), expected));
        }
        let Some(setting) = self.header.iter().find_map(|&line| Setting::read(line)) else {
            let follows = if sum < 1.0 {
                let modulus = relaxed / (1.0 - sum);
                format!(
                    "; equilibrium_modulus/(1 - Σ) would be {modulus:.3e} Pa, as exact as the digits of 1 - {sum:.6}"
                )
            } else {
                String::new()
            };
            let comment = self.comment;
            let expected = format!(
                "E_0 with its unit, to which relative moduli refer, in a comment: {comment} E0 = 64 MPa{follows}"
            );
            return Err(ContentError::value(self.line, "E0", "not given", &expected));
        };
        let Setting { line, name, value, .. } = &setting;
        let Some(unit) = setting.unit else {
            let expected = format!("a unit: one of {}", Dimension::Pressure.units());
            return Err(ContentError::value(Some(*line), name, &value.to_string(), &expected));
        };
        let modulus = unit.to_si(*value) * if setting.is_shear { 2.0 * (1.0 + elastic.poisson_ratio) } else { 1.0 };
        self.notes.push(note(format!("moduli are relative to {name} = {value} {unit} of line {line}"), false));
        /// Share of E_0 that rounded relative moduli leave open.
        const ROUNDING: f64 = 0.01;
        let left = modulus * (1.0 - sum);
        if (left - relaxed).abs() > ROUNDING * modulus {
            let text =
                format!("{name} and the relative moduli leave E_inf = {left:.4e} Pa, the scene has {relaxed:.4e} Pa");
            self.notes.push(note(text, true));
        }
        Ok(modulus)
    }
}

/// A line such as `E0 = 64 MPa`, `E_0: 64 MPa`, `G0 [MPa] = 21`.
#[derive(Debug)]
struct Setting {
    line: usize,
    name: String,
    is_shear: bool,
    value: f64,
    unit: Option<Unit>,
}

impl Setting {
    fn read((line, text): Line<'_>) -> Option<Self> {
        const TENSION: [&str; 5] = ["e0", "instantaneousmodulus", "glassymodulus", "einst", "eglassy"];
        const SHEAR: [&str; 2] = ["g0", "instantaneousshearmodulus"];
        let text = plain(text);
        let (name, value) = text.split_once(['=', ':', ';', ',', '\t'])?;
        let (bare, bracketed) = match name.rsplit_once(['[', '(']) {
            Some((bare, unit)) => (bare, Unit::parse(unit)),
            None => (name, None),
        };
        let bare: String = bare.to_lowercase().chars().filter(|letter| letter.is_alphanumeric()).collect();
        let is_shear = SHEAR.contains(&bare.as_str());
        if !is_shear && !TENSION.contains(&bare.as_str()) {
            return None;
        }
        let value = value.trim();
        let is_end = |letter: char| letter.is_whitespace() || letter.is_alphabetic() && !"eE".contains(letter);
        let (digits, rest) = value.split_at(value.find(is_end).unwrap_or(value.len()));
        let unit = rest.split([',', ';', '(']).next().and_then(|unit| Unit::parse(unit.trim())).or(bracketed);
        Some(Self {
            line,
            name: name.trim().to_owned(),
            is_shear,
            value: number(digits.trim())?,
            unit: unit.filter(|unit| unit.dimension == Dimension::Pressure),
        })
    }
}
