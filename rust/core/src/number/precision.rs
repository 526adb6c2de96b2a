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

/// What decides between routes and loops for a number type, as measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costs {
    /// Moderate bends are cheaper by sine and cosine of twice the angle: that saves numbers with
    /// error terms a fifth of the time, and costs others an eighth.
    pub(crate) double_angle: bool,
    /// Angles of moderate bends are cheaper to reduce to fractions of a turn in fixed point: numbers
    /// are shorter than the angles they come from.
    pub(crate) turn_fractions: bool,
    /// Reduction and tangent are cheaper as two loops: vectors hold more short numbers than angles,
    /// and with error terms one loop is too long for a core to overlap.
    pub(crate) separate_reduction: bool,
}

impl Precision {
    /// The costs of the number type of this arithmetic.
    pub(crate) const fn costs(self) -> Costs {
        match self {
            Self::Single => {
                Costs { double_angle: false, turn_fractions: true, separate_reduction: true }
            }
            Self::Double => {
                Costs { double_angle: false, turn_fractions: false, separate_reduction: false }
            }
            Self::DoubleDouble => {
                Costs { double_angle: true, turn_fractions: false, separate_reduction: true }
            }
        }
    }
}
