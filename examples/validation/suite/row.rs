//! What a comparison is.

use super::picture::Picture;

/// A comparison of the page, to be made.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    pub title: &'static str,
    /// With whom, and the year.
    pub reference: &'static str,
    /// Where that is published.
    pub source: &'static str,
    /// The file that computes it, in the repository.
    pub file: &'static str,
    /// Whether it is checked whenever something changes.
    pub quick: bool,
    pub compare: fn() -> Comparison,
}

/// What came out of it.
#[derive(Clone, Debug, Default)]
pub struct Comparison {
    /// What was computed, and how.
    pub about: String,
    pub rows: Vec<Row>,
    pub pictures: Vec<Picture>,
    /// What an engineer should know of it.
    pub remark: String,
}

/// One value beside another.
#[derive(Clone, Debug)]
pub struct Row {
    pub quantity: String,
    pub expected: f64,
    pub found: f64,
    pub unit: &'static str,
    pub claim: Claim,
}

/// How near a value is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Claim {
    /// Within this part of what is expected.
    Share(f64),
    /// Within this part of some whole.
    Of(f64, f64),
    /// Between these.
    Between(f64, f64),
}

impl Row {
    pub fn new(quantity: impl Into<String>, [expected, found]: [f64; 2], unit: &'static str, claim: Claim) -> Self {
        Self { quantity: quantity.into(), expected, found, unit, claim }
    }

    /// A value that is to lie between two.
    pub fn between(quantity: impl Into<String>, bounds: [f64; 2], found: f64, unit: &'static str) -> Self {
        let claim = Claim::Between(bounds[0], bounds[1]);
        Self { quantity: quantity.into(), expected: 0.5 * (bounds[0] + bounds[1]), found, unit, claim }
    }

    /// The difference over what the claim is of.
    pub fn error(&self) -> f64 {
        let off = (self.found - self.expected).abs();
        match self.claim {
            Claim::Share(_) => off / self.expected.abs(),
            Claim::Of(whole, _) => off / whole,
            Claim::Between(low, high) => (low - self.found).max(self.found - high).max(0.0),
        }
    }

    /// Not where the value is no number.
    pub fn agrees(&self) -> bool {
        self.error() <= self.allowed()
    }

    pub fn allowed(&self) -> f64 {
        match self.claim {
            Claim::Share(part) | Claim::Of(_, part) => part,
            Claim::Between(..) => 0.0,
        }
    }
}

impl Comparison {
    pub fn agrees(&self) -> bool {
        !self.rows.is_empty() && self.rows.iter().all(Row::agrees)
    }

    /// Of the rows with an error the one that uses most of its claim.
    pub fn worst(&self) -> Option<&Row> {
        let used = |row: &Row| row.error() / row.allowed();
        let rows = self.rows.iter().filter(|row| !matches!(row.claim, Claim::Between(..)));
        rows.max_by(|a, b| used(a).total_cmp(&used(b)))
    }
}
