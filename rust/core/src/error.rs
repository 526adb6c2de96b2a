//! Errors in the input: the argument, the position in it, and the rule it breaks.

use std::fmt;

/// The result of an operation that checks its input.
pub type Result<T> = std::result::Result<T, Error>;

/// The rule for bends, as error messages quote it.
pub(crate) const BEND_RULE: &str = "a bend must lie in [0, pi/2)";

/// An input that breaks a rule: the argument, the position in it, its value and the rule.
///
/// ```
/// let error = cardan::Geometry::from_bends(&[0.1, 1.6], &[0.0], &[0.0]).unwrap_err();
/// assert_eq!(error.to_string(), "bends[1] is 1.6 rad; a bend must lie in [0, pi/2)");
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{argument}{place} {problem}")]
pub struct Error {
    /// The name of the argument.
    pub argument: &'static str,
    /// The position within the argument, outermost index first.
    pub place: Place,
    /// The offending value and the rule.
    pub problem: String,
}

/// A position within an array argument.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place(pub Vec<usize>);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_empty() {
            return Ok(());
        }
        let indices: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        write!(f, "[{}]", indices.join(", "))
    }
}

impl Error {
    /// An error at `place` of `argument`.
    pub fn new(argument: &'static str, place: &[usize], problem: impl Into<String>) -> Self {
        Self { argument, place: Place(place.to_vec()), problem: problem.into() }
    }

    /// The same error for an array of drivelines, of which the one at `index` is at fault.
    #[must_use]
    pub fn within(mut self, index: &[usize]) -> Self {
        self.place.0.splice(0..0, index.iter().copied());
        self
    }
}
