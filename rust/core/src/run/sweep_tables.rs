//! The tables that relate the samples of a long sweep to each other; all blocks share them.

use crate::input::sweep::Sweep;
use crate::number::trig::Angle;
use crate::plan::route::Routes;
use crate::run::level::{Level, compiled_for};
use crate::sincos::rotation::Rotations;
use crate::sincos::tangent_sum::TangentSum;

/// The tables that the routes of a run need.
pub(crate) struct SweepTables<T: Angle> {
    /// For sine and cosine of the drive angle, up to a common factor.
    pub(crate) tangent_sum: Option<TangentSum<T>>,
    /// For sine and cosine of twice the drive angle.
    pub(crate) rotations: Option<Rotations<T>>,
}

impl<T: Angle> SweepTables<T> {
    pub(crate) fn new(routes: &Routes, sweep: Option<&Sweep>, level: Level) -> Self {
        let Some(sweep) = sweep else { return Self { tangent_sum: None, rotations: None } };
        let sum = |length| compiled_for!(level, TangentSum::new(sweep, length));
        let rotations = || compiled_for!(level, Rotations::new(sweep));
        Self {
            tangent_sum: routes.tangent_sum.map(sum),
            rotations: routes.needs_rotations().then(rotations),
        }
    }
}
