//! Reductions: one number for a row of samples.

use crate::plan::steps::Plan;

/// What a row of samples is reduced to. NaN among the samples gives NaN.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reduction {
    /// The smallest sample.
    Min,
    /// The largest sample.
    Max,
    /// The mean.
    Mean,
    /// The root of the mean square.
    Rms,
    /// The largest size; of a vector its largest length.
    Peak,
}

impl Reduction {
    /// Whether it is one of the samples' own values or its size.
    pub(crate) fn is_extreme(self) -> bool {
        matches!(self, Self::Min | Self::Max | Self::Peak)
    }

    /// All of them.
    pub const ALL: [Self; 5] = [Self::Min, Self::Max, Self::Mean, Self::Rms, Self::Peak];

    /// The name by which users ask for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Min => "min",
            Self::Max => "max",
            Self::Mean => "mean",
            Self::Rms => "rms",
            Self::Peak => "peak",
        }
    }

    /// How many planes of the plan each result takes: one, or the three of a vector's peak.
    pub(crate) fn groups(self, plan: &Plan) -> Vec<usize> {
        let whole = self == Self::Peak;
        let of = |&size: &usize| if whole { vec![size] } else { vec![1; size] };
        plan.components.iter().flat_map(of).collect()
    }

    /// Number of results of a plan.
    pub fn results(self, plan: &Plan) -> usize {
        self.groups(plan).len()
    }
}
