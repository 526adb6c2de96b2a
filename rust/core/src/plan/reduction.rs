//! Reductions of a row of samples to one number.

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
