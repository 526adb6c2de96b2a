//! How the motion of each shaft is found: decided once per run, here, and read by everything else.

use std::f64::consts::FRAC_PI_2;

use crate::input::sweep::Sweep;
use crate::input::table::{GeometryVariation, Table};
use crate::number::Precision;
use crate::number::atan::AtanRange;
use crate::plan::steps::Plan;

/// How the motion of one shaft is found at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Route {
    /// No joint before the shaft is bent: it turns with the drive.
    Drive,
    /// From sine and cosine of the equivalent joint's driving angle, up to a common factor.
    Tangent,
    /// From sine and cosine of twice the drive angle.
    DoubleAngle,
    /// From those of a long sweep, turned from sample to sample by whole steps.
    Rotation,
}

/// The routes of one run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Routes {
    first_bent: usize,
    /// The route of moderate bends; steep ones always take [`Route::Tangent`].
    moderate: Route,
    /// Whether the sines and cosines of a sweep are turned by whole steps.
    rotations: bool,
    /// The length of the groups within which pins of a sweep follow by the addition theorem of the
    /// tangent, if they do.
    pub(crate) tangent_sum: Option<usize>,
    /// The number of samples after which a sweep repeats itself, if its results are copied.
    pub(crate) period: Option<usize>,
}

/// The shortest rows of a sweep for which a table of its steps saves time.
const LONG_ROW: usize = 4096;

/// The longest period whose results are kept and copied.
const LONGEST_PERIOD: usize = 8192;

/// The fewest samples in a quarter turn for which rotations save time, and the most whose number is
/// exact enough.
const ROTATION_QUARTERS: std::ops::Range<f64> = 32.0..(1_u64 << 40) as f64;

/// The widest turn from the middle of a group of tangent sums, in rad: with the eighth of a turn that
/// the remainder of the middle may have, the cosine of the sum stays away from zero.
const TANGENT_SUM_WIDEST: f64 = 0.39;

/// The fewest samples for which a group of tangent sums saves time, and the most in one.
const TANGENT_SUM_FEWEST: usize = 32;
const TANGENT_SUM_LONGEST: f64 = 512.0;

impl Routes {
    /// The routes of a run over these samples.
    pub(crate) fn of_run(plan: &Plan, table: &Table<'_>, precision: Precision) -> Self {
        let per_sample = table.geometry_variation() == GeometryVariation::BySample;
        let period = period(plan, table);
        let mut routes = Self { period, ..Self::of_arrays(plan, precision) };
        // Sums depend on the middle of their group in the last bit, a repeated period on where its
        // block begins: only one of them may serve a sweep.
        let long = table.row_length() >= LONG_ROW && period.is_none();
        let Some(sweep) = table.sweep.as_ref().filter(|_| long) else { return routes };
        let is_moderate = |shaft: usize| plan.range(shaft).is_moderate();
        let moderate = !per_sample && plan.moving().any(|step| is_moderate(step.shaft));
        let steep = plan.moving().any(|step| !is_moderate(step.shaft));
        let pinned = plan.needs_poses() || steep || !moderate && plan.moving().next().is_some();
        if moderate && has_rotations(sweep) {
            routes.rotations = true;
            if routes.moderate == Route::Tangent {
                routes.moderate = Route::Rotation;
            }
        }
        routes.tangent_sum = if pinned { tangent_sum_length(sweep) } else { None };
        routes
    }

    /// The routes of runs over arrays of angles.
    pub(crate) fn of_arrays(plan: &Plan, precision: Precision) -> Self {
        let double_angle = precision.costs().double_angle;
        Self {
            first_bent: plan.first_bent(),
            moderate: if double_angle { Route::DoubleAngle } else { Route::Tangent },
            rotations: false,
            tangent_sum: None,
            period: None,
        }
    }

    /// The route of a shaft whose tangents of the angle error stay within `range`.
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

    /// Whether any joint before the shaft is bent.
    #[inline(always)]
    pub(crate) fn is_bent(&self, shaft: usize) -> bool {
        shaft > self.first_bent
    }

    /// Whether moderate bends go another way than steep ones, from constants of their own.
    pub(crate) fn splits(&self) -> bool {
        self.moderate != Route::Tangent
    }

    /// Whether moderate bends take sines that a sweep turns within their own loop.
    pub(crate) fn has_rotation(&self) -> bool {
        self.moderate == Route::Rotation
    }

    /// Whether moderate bends read stored sines and cosines of twice the drive angle.
    pub(crate) fn has_double_angle(&self) -> bool {
        self.moderate == Route::DoubleAngle
    }

    /// Whether the sweep's sines and cosines of twice the angle follow by rotations.
    pub(crate) fn needs_rotations(&self) -> bool {
        self.rotations
    }
}

/// The number of samples after which the pins of a sweep repeat themselves, if that is often enough to
/// copy results.
fn period(plan: &Plan, table: &Table<'_>) -> Option<usize> {
    let period = table.sweep.as_ref()?.period(plan.needs_sense())?;
    let changes = table.geometry_variation() == GeometryVariation::BySample || table.load_varies();
    let length = table.row_length();
    // A long sweep has another way than sample by sample, and two periods cost more than it.
    let fewest = if length < LONG_ROW { 2 } else { 4 };
    (!changes && period <= LONGEST_PERIOD && fewest * period <= length).then_some(period)
}

/// Whether the steps of a sweep are short enough for rotations and not too short.
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
