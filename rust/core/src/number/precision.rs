//! The arithmetic of a run, and how exact it is.

/// The arithmetic of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Single precision after a reduction in double.
    Single,
    /// Double.
    #[default]
    Double,
    /// Double with error terms: results are within one ulp.
    DoubleDouble,
}

impl Precision {
    /// The errors of results relative to the largest over a turn, with room above what is measured.
    pub(crate) const SINGLE_ERROR: f64 = 1e-6;
    pub(crate) const DOUBLE_ERROR: f64 = 4e-15;
}
