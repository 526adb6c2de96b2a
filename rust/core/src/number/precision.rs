//! The arithmetic of a run, its error bounds and its costs.

/// The arithmetic of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// Single precision; angles are reduced in double precision.
    Single,
    /// Double precision.
    #[default]
    Double,
    /// Double precision with error terms (double-double): results are within one ulp.
    DoubleDouble,
}

impl Precision {
    /// Bounds on the errors of results, relative to the largest result over a turn. They exceed the
    /// measured errors by a margin.
    pub(crate) const SINGLE_ERROR: f64 = 1e-6;
    pub(crate) const DOUBLE_ERROR: f64 = 4e-15;

    /// By how much a chain may amplify the errors of double precision by default: 2.5 where the
    /// cosines of its bends multiply to 1/10, as with one joint at 84°. Beyond, its errors near the
    /// fastest position exceed the limits of one joint, and error terms are carried.
    pub(crate) const STEEPEST: f64 = 2.5;
}

/// The measured facts that decide between routes and loops for a number type.
#[derive(Clone, Copy, Debug)]
#[allow(clippy::struct_excessive_bools, reason = "independent facts")]
pub(crate) struct Costs {
    /// Moderate bends are cheaper from sine and cosine of twice the drive angle. That saves
    /// double-double arithmetic a fifth of the time and costs the other types an eighth more.
    /// Behind more than one joint these are of the equivalent joint's input angle.
    pub(crate) double_angle: bool,
    /// At moderate bends, angles are cheaper to reduce to fixed-point fractions of a turn, because
    /// the numbers are shorter than the angles.
    pub(crate) turn_fractions: bool,
    /// Reduction and tangent are cheaper in two loops. A vector holds more single-precision numbers
    /// than angles, and one double-double loop is too long for a core to overlap its iterations.
    pub(crate) separate_reduction: bool,
}

impl Precision {
    /// The costs of the number type of this arithmetic.
    pub(crate) const fn costs(self) -> Costs {
        let none = Costs { double_angle: false, turn_fractions: false, separate_reduction: false };
        match self {
            Self::Single => Costs { turn_fractions: true, separate_reduction: true, ..none },
            Self::Double => none,
            Self::DoubleDouble => Costs { double_angle: true, separate_reduction: true, ..none },
        }
    }
}
