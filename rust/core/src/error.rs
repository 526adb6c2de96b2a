//! Errors in the input: the argument, the position in it, and the rule it breaks.

use std::fmt;

/// The result of an operation that checks its input.
pub type Result<T> = std::result::Result<T, Error>;

/// The rule for bends.
pub(crate) const BEND_RULE: Rule = Rule {
    unit: "rad",
    text: "a bend must lie in [0, pi/2), with pi/2 as a double",
    in_degrees: "a bend must lie in [0, 90) deg",
};

/// The rule for angles that may be any.
pub(crate) const FINITE: Rule = Rule::new("", "it must be finite");

/// A rule for one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rule {
    /// The unit of the value; empty if messages show none.
    pub unit: &'static str,
    /// The rule as messages quote it.
    pub text: &'static str,
    /// The same for a value in degrees.
    pub in_degrees: &'static str,
}

impl Rule {
    /// A rule that reads the same in all units.
    pub const fn new(unit: &'static str, text: &'static str) -> Self {
        Self { unit, text, in_degrees: text }
    }
}

/// An input that breaks a rule: the argument, the position in it, its value and the rule.
///
/// ```
/// let error = cardan::Geometry::from_bends(&[0.1, 1.6], &[0.0], &[0.0]).unwrap_err();
/// let said = "bends[1] is 1.6 rad; a bend must lie in [0, pi/2), with pi/2 as a double";
/// assert_eq!(error.to_string(), said);
/// ```
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{argument}{place} {problem}")]
pub struct Error {
    /// The name of the argument.
    pub argument: &'static str,
    /// The position within the argument, outermost index first.
    pub place: Place,
    /// The problem.
    pub problem: Problem,
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

/// Problem of an argument.
#[derive(Clone, Debug, PartialEq)]
pub enum Problem {
    /// A value that breaks a rule.
    Value {
        /// The value, in the unit of the rule.
        value: f64,
        /// The rule.
        rule: Rule,
    },
    /// Anything else, in words.
    Words(String),
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value { value, rule: Rule { unit, text, .. } } => {
                let gap = if unit.is_empty() { "" } else { " " };
                write!(f, "is {}{gap}{unit}; {text}", Shown(*value))
            }
            Self::Words(words) => f.write_str(words),
        }
    }
}

/// A number as Python shows it, so that messages look alike whoever finds the fault.
pub(crate) struct Shown(pub(crate) f64);

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_nan() { f.write_str("nan") } else { write!(f, "{:?}", self.0) }
    }
}

impl From<String> for Problem {
    fn from(words: String) -> Self {
        Self::Words(words)
    }
}

impl From<&str> for Problem {
    fn from(words: &str) -> Self {
        Self::Words(words.to_owned())
    }
}

impl Error {
    /// An error at `place` of `argument`.
    pub fn new(argument: &'static str, place: &[usize], problem: impl Into<Problem>) -> Self {
        Self { argument, place: Place(place.to_vec()), problem: problem.into() }
    }

    /// An error at `place` of `argument`, where a value breaks a rule.
    pub fn of_value(argument: &'static str, place: &[usize], value: f64, rule: Rule) -> Self {
        Self::new(argument, place, Problem::Value { value, rule })
    }

    /// The same error for an array of drivelines, of which the one at `index` is at fault.
    #[must_use]
    pub fn within(mut self, index: &[usize]) -> Self {
        self.place.0.splice(0..0, index.iter().copied());
        self
    }

    /// The same error at `index` of what it is about.
    #[must_use]
    pub(crate) fn behind(mut self, index: &[usize]) -> Self {
        self.place.0.extend(index);
        self
    }

    /// The same error for a caller who gave degrees: a value in rad is shown in degrees.
    ///
    /// ```
    /// let error = cardan::Geometry::from_bends(&[95_f64.to_radians()], &[], &[]).unwrap_err();
    /// let problem = error.in_degrees().problem.to_string();
    /// assert_eq!(problem, "is 95.0 deg; a bend must lie in [0, 90) deg");
    /// ```
    #[must_use]
    pub fn in_degrees(mut self) -> Self {
        if let Problem::Value { value, rule } = &mut self.problem
            && rule.unit == "rad"
        {
            *value = shown_in_degrees(*value);
            *rule = Rule::new("deg", rule.in_degrees);
        }
        self
    }
}

/// An angle in degrees, without the digits that the conversion from degrees and back adds.
pub(crate) fn shown_in_degrees(angle: f64) -> f64 {
    let degrees = angle.to_degrees();
    format!("{degrees:.12e}").parse().unwrap_or(degrees)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_angles_are_shown_in_degrees() {
        let error = Error::of_value("bends", &[2], -1e-300_f64.to_radians(), BEND_RULE);
        let shown = error.clone().in_degrees();
        let rule = "; a bend must lie in [0, 90) deg";
        assert_eq!(shown.to_string(), format!("bends[2] is -1e-300 deg{rule}"));
        assert_eq!(shown, shown.clone().in_degrees());
        let length = Error::of_value("lengths", &[], 0.0, Rule::new("m", "it must be positive"));
        assert_eq!(length.to_string(), "lengths is 0.0 m; it must be positive");
        assert_eq!(length.clone().in_degrees(), length);
        let words = Error::new("axis", &[], "is missing");
        assert_eq!(words.clone().in_degrees(), words);
    }

    #[test]
    fn degrees_are_those_that_were_given() {
        for degrees in [95.0, 90.0, -1.0, 0.1, 123.456_789, 1e300, f64::INFINITY] {
            assert_eq!(shown_in_degrees(f64::to_radians(degrees)), degrees);
        }
        assert!(shown_in_degrees(f64::NAN).is_nan());
    }
}
