//! What the numbers of a table rest on.

/// What the numbers of a table rest on, in words; a line of the header each, where there is something to say.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Basis {
    /// How steady sliding was found.
    pub method: Option<String>,
    /// What the links stand for.
    pub foundation: Option<String>,
    /// The way that rubber has slid of the temperature that a point has, in m; `None`: its surface has that.
    pub way: Option<String>,
    /// The roughness below the profile's.
    pub fine: Option<String>,
    /// What a study of convergence found; `None` without one.
    pub convergence: Option<String>,
    /// What was held at each point instead of the displacement w; `None` where that was.
    pub held: Option<String>,
    /// Which sample of which table it is; `None` of what the scene says.
    pub sample: Option<String>,
}

/// What [`Basis::convergence`] begins with where all is within the error of the study.
pub const CONVERGED: &str = "converged";

impl Basis {
    pub(super) fn lines(&self) -> impl Iterator<Item = String> {
        let Self { method, foundation, way, fine, convergence, held, sample } = self;
        let texts = [method, foundation, way, fine, convergence, held, sample];
        let named = BASIS_KEYS.into_iter().zip(texts);
        named.filter_map(|(key, text)| Some(format!("# {key} = {}", one_line(text.as_ref()?))))
    }

    /// That of a header, whose values by key are `value`.
    pub(super) fn read(value: impl Fn(&str) -> Option<String>) -> Self {
        let [method, foundation, way, fine, convergence, held, sample] = BASIS_KEYS.map(value);
        Self { method, foundation, way, fine, convergence, held, sample }
    }

    /// Whether a study found friction and area converged.
    pub fn is_converged(&self) -> bool {
        self.convergence.as_ref().is_some_and(|text| text.starts_with(CONVERGED))
    }
}

const BASIS_KEYS: [&str; 7] = ["method", "foundation", "way", "fine", "convergence", "held", "sample"];

pub(super) fn one_line(text: &str) -> String {
    text.replace(['\n', '\r'], " ")
}
