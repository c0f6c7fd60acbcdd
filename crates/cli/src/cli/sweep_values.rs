//! Shards of a sweep, as the command line gives them.

fn wrong(found: &str, expected: &str) -> String {
    format!("expected {expected}, found {found:?}")
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shard {
    /// Counted from 1.
    index: usize,
    count: usize,
}

impl Shard {
    /// `I/N`, I from 1 to N.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(wrong(text, "I/N with I from 1 to N, such as 3/8")),
        }
    }

    /// Whether the point of this index is in it: every `count`th is, so that all shards have slow and quick points.
    pub(crate) fn has(self, index: usize) -> bool {
        index % self.count == self.index - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_points() {
        let shards: Vec<Shard> = ["1/3", "2/3", "3/3"].map(|text| Shard::parse(text).unwrap()).into();
        assert!((0..10).all(|number| shards.iter().filter(|shard| shard.has(number)).count() == 1));
        assert!(["0/3", "4/3", "1", "a/2", "1/0"].iter().all(|text| Shard::parse(text).is_err()));
    }
}
