//! Routes: how a run computes the motion of each shaft. They are decided here, once per run.

use std::f64::consts::FRAC_PI_2;

use crate::input::sweep::Sweep;
use crate::input::table::{GeometryVariation, Table};
use crate::number::Precision;
use crate::number::atan::AtanRange;
use crate::plan::steps::Plan;

/// How the motion of one shaft is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Route {
    /// The shaft turns with the drive, because no joint before it is bent.
    Drive,
    /// From unnormalised sine and cosine (tangent form) of the equivalent joint's input angle.
    Tangent,
    /// From sine and cosine of twice the drive angle.
    DoubleAngle,
    /// From sine and cosine of twice the drive angle, rotated from sample to sample of a long
    /// sweep.
    Rotation,
}

/// Where the loops of a chunk take sine and cosine of the drive angle from, up to a common factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pins {
    /// From columns, which are filled first.
    Stored,
    /// The only loop that needs them computes them itself.
    Fresh,
    /// The strips of the only shaft or joint that needs them compute them.
    Strips,
}

/// The routes of one run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Routes {
    first_bent: usize,
    /// Whether pins need not be stored: no other row or driveline of an array of angles uses the same
    /// ones.
    pub(crate) one_use: bool,
    /// The route of moderate bends; steep bends always take [`Route::Tangent`].
    moderate: Route,
    /// Whether sine and cosine of twice the sweep's angles are computed by rotations.
    rotations: bool,
    /// The length of the groups of samples within which the pins of a sweep follow by the addition
    /// theorem of the tangent, if they do.
    pub(crate) tangent_sum: Option<usize>,
    /// The number of samples after which the results of a sweep repeat, if they are copied.
    pub(crate) period: Option<usize>,
}

/// The shortest row of a sweep for which a table of its steps saves time.
const LONG_ROW: usize = 4096;

/// The longest period whose results are stored and copied.
const LONGEST_PERIOD: usize = 8192;

/// Samples in a quarter turn for which rotations are used: with fewer they save no time, with more
/// the sample number is not exact enough.
const ROTATION_QUARTERS: std::ops::Range<f64> = 32.0..(1_u64 << 40) as f64;

/// The largest angle from the middle of a group of tangent sums, in rad. The remainder of the
/// middle may be an eighth of a turn; together the two keep the cosine of the sum away from zero.
const TANGENT_SUM_WIDEST: f64 = 0.39;

/// The fewest samples for which a group of tangent sums saves time, and the most in one group.
const TANGENT_SUM_FEWEST: usize = 32;
const TANGENT_SUM_LONGEST: f64 = 512.0;

impl Routes {
    /// The routes of a run over the samples of a table.
    pub(crate) fn of_run(plan: &Plan, table: &Table<'_>, precision: Precision) -> Self {
        let per_sample = table.geometry_variation() == GeometryVariation::BySample;
        let period = period(plan, table);
        let one_use = table.geometry_variation() == GeometryVariation::One
            && table.rows() == 1
            && table.sweep.is_none()
            && table.error_terms.is_none();
        let mut routes = Self { one_use, period, ..Self::of_arrays(plan, precision) };
        if plan.is_as_built() {
            return routes;
        }
        // The last bit of a tangent sum depends on the middle of its group, and that of a repeated
        // period on the start of its block. A sweep may use only one of the two.
        let long = table.row_length() >= LONG_ROW && period.is_none();
        let Some(sweep) = table.sweep.as_ref().filter(|_| long) else { return routes };
        let is_moderate = |shaft: usize| plan.range(shaft).is_moderate();
        // Behind more than one joint, numbers with error terms use separate sines.
        let shared =
            || plan.moving().filter(|step| step.shaft == 1 || !precision.costs().double_angle);
        let moderate = !per_sample && shared().any(|step| is_moderate(step.shaft));
        let steep = shared().any(|step| !is_moderate(step.shaft));
        let needs_pins = plan.needs_poses() || steep || !moderate && shared().next().is_some();
        if moderate && has_rotations(sweep) {
            routes.rotations = true;
            if routes.moderate == Route::Tangent {
                routes.moderate = Route::Rotation;
            }
        }
        routes.tangent_sum = if needs_pins { tangent_sum_length(sweep) } else { None };
        routes
    }

    /// The routes of a run over arrays of angles.
    pub(crate) fn of_arrays(plan: &Plan, precision: Precision) -> Self {
        let double_angle = precision.costs().double_angle;
        Self {
            first_bent: plan.first_bent(),
            one_use: false,
            moderate: if double_angle { Route::DoubleAngle } else { Route::Tangent },
            rotations: false,
            tangent_sum: None,
            period: None,
        }
    }

    /// The route of a shaft whose tangent of the angle error stays within `range`.
    #[inline(always)]
    pub(crate) fn of(&self, shaft: usize, range: AtanRange) -> Route {
        if !self.is_bent(shaft) {
            Route::Drive
        } else if range.is_moderate() {
            self.moderate
        } else {
            Route::Tangent
        }
    }

    /// Whether a joint before the shaft is bent.
    #[inline(always)]
    pub(crate) fn is_bent(&self, shaft: usize) -> bool {
        shaft > self.first_bent
    }

    /// Whether moderate and steep bends have different routes and so different constants.
    pub(crate) fn splits(&self) -> bool {
        self.moderate != Route::Tangent
    }

    /// Whether the loops for moderate bends rotate sine and cosine from sample to sample.
    pub(crate) fn has_rotation(&self) -> bool {
        self.moderate == Route::Rotation
    }

    /// Whether moderate bends use stored sines and cosines of twice the drive angle.
    pub(crate) fn has_double_angle(&self) -> bool {
        self.moderate == Route::DoubleAngle
    }

    /// Whether the run needs a table of rotations.
    pub(crate) fn needs_rotations(&self) -> bool {
        self.rotations
    }
}

/// The number of samples after which the pins of a sweep repeat, if they repeat often enough for
/// copying results.
fn period(plan: &Plan, table: &Table<'_>) -> Option<usize> {
    let period = table.sweep.as_ref()?.period(plan.needs_sense())?;
    let changes = table.geometry_variation() == GeometryVariation::BySample || table.load_varies();
    let length = table.row_length();
    // A long sweep has faster routes, and computing two periods sample by sample costs more than
    // they do.
    let fewest = if length < LONG_ROW { 2 } else { 4 };
    (!changes && period <= LONGEST_PERIOD && fewest * period <= length).then_some(period)
}

/// Whether the steps of a sweep suit rotations.
fn has_rotations(sweep: &Sweep) -> bool {
    ROTATION_QUARTERS.contains(&(FRAC_PI_2 / sweep.step().abs()))
}

/// The length of a group of tangent sums, if the steps of a sweep are short enough for one.
fn tangent_sum_length(sweep: &Sweep) -> Option<usize> {
    let half = (TANGENT_SUM_WIDEST / sweep.step.high.abs()).min(TANGENT_SUM_LONGEST / 2.0);
    let length = 2 * half as usize / 16 * 16;
    (length >= TANGENT_SUM_FEWEST).then_some(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_that_are_too_long_or_too_short_have_no_rotations() {
        let has = |stop: f64, count: usize| {
            let sweep = Sweep::new(0.0, stop, count).unwrap();
            [has_rotations(&sweep), tangent_sum_length(&sweep).is_some()]
        };
        assert_eq!(has(20.0, 5000), [true, true]);
        assert_eq!(has(1e3, 5000), [false, false]);
        assert!(!has(1e-9, 10_000)[0]);
        assert!(!has(0.0, 5000)[0]);
    }
}
