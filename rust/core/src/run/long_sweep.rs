//! Long sweeps: what their blocks share, so that samples need no sine each, or that they repeat themselves.

use crate::input::sweep::Sweep;
use crate::input::table::{GeometryVariation, Table};
use crate::number::trig::Angle;
use crate::plan::steps::Plan;
use crate::run::level::{Level, compiled_for};
use crate::sincos::rotation::Rotations;
use crate::sincos::tangent_sum::TangentSum;

/// Samples in a row that repay a table of its steps.
const LONG: usize = 4096;

/// The longest period that is kept and repeated.
const REPEATED: usize = 8192;

/// How to find sines and cosines of a sweep whose rows are long and do not just repeat themselves.
pub(crate) struct LongSweep<T: Angle> {
    /// SinCos, where steep bends or poses need them.
    pub(crate) pins: Option<TangentSum<T>>,
    /// Sine and cosine of twice the angles, where moderate bends need them.
    pub(crate) twice: Option<Rotations<T>>,
}

impl<T: Angle> LongSweep<T> {
    /// What serves neither.
    pub(crate) const NONE: Self = Self { pins: None, twice: None };

    /// What serves the plan; groups of pins hold at most `longest` samples.
    pub(crate) fn new(plan: &Plan, table: &Table<'_>, longest: usize, level: Level) -> Self {
        let Some(sweep) = long_sweep(plan, table) else { return Self::NONE };
        let one = table.geometry_variation() != GeometryVariation::BySample;
        let is_moderate = |shaft: usize| plan.range(shaft).is_moderate();
        let turned = one && plan.moving().any(|step| is_moderate(step.shaft));
        let steep = plan.moving().any(|step| !is_moderate(step.shaft));
        let pinned = plan.needs_poses() || steep || !turned && plan.moving().next().is_some();
        let group = || compiled_for!(level, TangentSum::new(sweep, longest));
        let rotations = || compiled_for!(level, Rotations::new(sweep));
        Self {
            pins: if pinned { group() } else { None },
            twice: if turned { rotations() } else { None },
        }
    }
}

/// After how many samples the pins of a sweep repeat themselves, if that is often enough to copy results.
pub(crate) fn repeated(plan: &Plan, table: &Table<'_>) -> Option<usize> {
    let period = table.sweep.as_ref()?.period(plan.needs_sense())?;
    let length = table.row_length();
    // Where there is another way than sample by sample, two periods do not repay it.
    let fewest = if length < LONG { 2 } else { 4 };
    (period <= REPEATED && fewest * period <= length).then_some(period)
}

/// The sweep, if its rows are long and not to be repeated: sums depend on their middle in the last bit, and a
/// repeated period on where its block begins.
fn long_sweep<'a>(plan: &Plan, table: &'a Table<'_>) -> Option<&'a Sweep> {
    let long = table.row_length() >= LONG && repeated(plan, table).is_none();
    table.sweep.as_ref().filter(|_| long)
}
