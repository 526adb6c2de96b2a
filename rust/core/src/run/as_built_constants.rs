//! Constants and buffers of drivelines of joints as built.

use crate::input::Drivelines;
use crate::mechanics::as_built::{DEVIATIONS, JointAsBuilt};
use crate::mechanics::chain::wide_shaft_turn;
use crate::mechanics::general::General;
use crate::number::atan::AtanRange;
use crate::number::float::Real;
use crate::number::storage::{Column, columns};
use crate::plan::output::Output;
use crate::plan::steps::{Plan, ShaftStep};

/// The constants of one joint of one driveline.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointStage<T> {
    pub(super) joint: JointAsBuilt<T>,
    /// The range of the tangents of its angle error.
    pub(super) range: AtanRange,
    /// Cosine and sine of the turn of the shaft behind it, if another joint follows.
    pub(super) turn: [T; 2],
}

/// The constants of a series of drivelines of joints as built; empty for ideal ones.
#[derive(Clone, Debug)]
pub(crate) struct FoldedAsBuilt<T> {
    /// Per joint.
    pub(super) stages: Vec<Vec<JointStage<T>>>,
    /// Per shaft: the mean of the sum of the angle errors before it, if its angle is needed.
    pub(super) means: Vec<Vec<T>>,
}

impl<T: Real> FoldedAsBuilt<T> {
    pub(crate) fn new(plan: &Plan) -> Self {
        let joints = if plan.is_as_built() { plan.reach() } else { 0 };
        let shafts = if plan.is_as_built() { joints + 1 } else { 0 };
        Self { stages: vec![vec![]; joints], means: vec![vec![]; shafts] }
    }

    /// Replaces the constants by those of the drivelines with these numbers in the batch.
    pub(crate) fn fold(&mut self, plan: &Plan, lines: &Drivelines<'_>, numbers: &[usize]) {
        let n = plan.joint_count;
        self.stages.iter_mut().for_each(Vec::clear);
        self.means.iter_mut().for_each(Vec::clear);
        for &line in numbers {
            let (bends, between) = (&lines.bends[line * n..][..n], line * (n - 1));
            let (twists, phases) = (&lines.twists[between..], &lines.phases[between..]);
            let deviations = lines.deviations[line * n * DEVIATIONS..].as_chunks().0;
            for (joint, stages) in self.stages.iter_mut().enumerate() {
                let own = JointAsBuilt::with_error_terms(bends[joint], deviations[joint]);
                let turn = if joint + 1 < n {
                    let turn = wide_shaft_turn(phases[joint], twists[joint]);
                    [turn.re, turn.im].map(T::from_double_double)
                } else {
                    [1.0, 0.0].map(T::from_f64)
                };
                let (joint, range) = (JointAsBuilt::nearest(&own), own.range());
                stages.push(JointStage { joint, range, turn });
            }
            for step in plan.shafts.iter().filter(|step| step.shaft > 0 && has_angle(step)) {
                let (bends, between) = (&bends[..step.shaft], step.shaft - 1);
                let (twists, phases) = (&twists[..between], &phases[..between]);
                let general = General::of_joints(bends, twists, phases, deviations);
                self.means[step.shaft].push(T::from_f64(general.mean()));
            }
        }
    }
}

/// Whether the step has an output for which angle errors are summed.
pub(super) fn has_angle(step: &ShaftStep) -> bool {
    [Output::Angle, Output::AngleError].iter().any(|&o| step.planes.get(o).is_some())
}

/// Motion to compute behind every joint of a driveline.
#[derive(Clone, Copy)]
pub(super) struct MotionNeeds {
    /// Whether angle errors are summed.
    pub(super) angle: bool,
    /// The order of the highest derivative of the angle: 1 for the speed ratio, 0 for none.
    pub(super) rates: usize,
}

impl MotionNeeds {
    /// With error terms the loop of the third order serves all: the others would save little.
    pub(super) fn of<T: Real>(plan: &Plan) -> Self {
        let any = |output| plan.shafts.iter().any(|step| step.planes.get(output).is_some());
        let accelerates = plan.shafts.iter().any(|step| step.keep_acceleration);
        let turns = plan.shafts.iter().any(|step| step.keep_ratio);
        let rates = if any(Output::JerkRatio) {
            3
        } else if any(Output::AccelerationRatio) || accelerates {
            2
        } else {
            usize::from(any(Output::SpeedRatio) || turns)
        };
        let rates = if T::LOW && rates > 0 { 3 } else { rates };
        Self { angle: plan.shafts.iter().any(has_angle), rates }
    }
}

/// The buffers of one block; empty for drivelines of ideal joints.
pub(crate) struct BuffersAsBuilt<T: Real> {
    /// Sine and cosine of each joint's input angle.
    pub(super) pins: Vec<[Column<T>; 2]>,
    /// Per shaft, the first for the drive: sums of angle errors, and rates up to the needed order.
    pub(super) errors: Vec<Column<T>>,
    pub(super) rates: Vec<[Column<T>; 3]>,
    /// Per joint, if they are needed: the tilts, and the factors of [`JointAsBuilt::moments`].
    pub(super) tilts: Vec<[Column<T>; 2]>,
    pub(super) moments: Vec<[Column<T>; 3]>,
    /// Angle errors without their mean.
    pub(super) centred: Column<T>,
}

impl<T: Real> BuffersAsBuilt<T> {
    pub(crate) fn new(plan: &Plan, longest: usize) -> Self {
        if !plan.is_as_built() {
            return Self {
                pins: vec![],
                errors: vec![],
                rates: vec![],
                tilts: vec![],
                moments: vec![],
                centred: Column::new(0),
            };
        }
        let (needs, joints) = (MotionNeeds::of::<T>(plan), plan.reach());
        let size = |needed: bool| if needed { longest } else { 0 };
        let steps = &plan.joints[..joints];
        let rates = || [1, 2, 3].map(|order| Column::new(size(order <= needs.rates)));
        let mut buffers = Self {
            pins: (0..joints.max(1)).map(|_| columns(longest)).collect(),
            errors: (0..=joints).map(|_| Column::new(size(needs.angle))).collect(),
            rates: (0..=joints).map(|_| rates()).collect(),
            tilts: steps.iter().map(|step| columns(size(step.needs_cross))).collect(),
            moments: steps.iter().map(|step| columns(size(step.needs_load()))).collect(),
            centred: Column::new(size(needs.angle)),
        };
        // The drive's own motion; columns start with zeros.
        let [ratio, ..] = &mut buffers.rates[0];
        let mut ratio = ratio.view_mut(size(needs.rates > 0));
        for i in 0..ratio.len() {
            ratio.set(i, T::from_f64(1.0));
        }
        buffers
    }
}
