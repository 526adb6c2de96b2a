//! Reductions of a row of samples to one number.

use crate::error::{Error, Result};
use crate::plan::steps::Plan;

/// A reduction of a row of samples. NaN among the samples gives NaN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// The smallest sample.
    Min,
    /// The largest sample.
    Max,
    /// The mean.
    Mean,
    /// The root mean square.
    Rms,
    /// The largest magnitude; for a vector, its largest length.
    Peak,
}

impl Reduction {
    /// Whether the result is the value or the magnitude of a single sample.
    pub(crate) fn is_extreme(self) -> bool {
        matches!(self, Self::Min | Self::Max | Self::Peak)
    }

    /// All reductions.
    pub const ALL: [Self; 5] = [Self::Min, Self::Max, Self::Mean, Self::Rms, Self::Peak];

    /// The name used in the Python interface.
    pub fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Max => "max",
            Self::Mean => "mean",
            Self::Rms => "rms",
            Self::Peak => "peak",
        }
    }

    /// The reduction with this name.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|reduction| reduction.name() == name);
        found.ok_or_else(|| Error::new("reduce", &[], format!("is {name:?}, which is unknown")))
    }

    /// The number of the plan's planes that each result combines: one, or three for the peak of a
    /// vector.
    pub(crate) fn groups(self, plan: &Plan) -> Vec<usize> {
        let whole = self == Self::Peak;
        let of = |size: usize| if whole { vec![size] } else { vec![1; size] };
        plan.outputs.iter().map(|output| output.components()).flat_map(of).collect()
    }

    /// The number of results for a plan, and so of the planes that [`Plan::reduce`] fills.
    pub fn results(self, plan: &Plan) -> usize {
        self.groups(plan).len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_reduction_has_a_name() {
        for reduction in Reduction::ALL {
            assert_eq!(Reduction::named(reduction.name()), Ok(reduction));
        }
        let error = Reduction::named("most").unwrap_err();
        assert_eq!(error.to_string(), "reduce is \"most\", which is unknown");
    }
}
