//! The steps that compute the requested outputs, planned once per call.
//!
//! A plan does not depend on angles or on particular bends. It lists the shafts and joints that are
//! needed, the plane of the result for each quantity, and the order in which a load travels along
//! the driveline. [`crate::run`] runs it.

use crate::error::{Error, Result};
use crate::input::Drivelines;
use crate::input::batch::check_length;
use crate::number::Precision;
use crate::number::atan::AtanRange;
use crate::plan::forces::ForceStep;
use crate::plan::output::{Output, OutputPlanes};
use crate::plan::request::{Axes, End};

/// The steps for one request. The planes of the result are numbered by output, then by shaft or
/// joint, then by component.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(crate) joint_count: usize,
    /// The largest bend of each joint; a joint with zero is straight in every driveline.
    pub(crate) largest_bends: Vec<f64>,
    /// A lower bound on the cosine of the bend equivalent to the joints before each shaft. It holds
    /// for the aligned chain, whose cosines multiply.
    pub(super) least_cosines: Vec<f64>,
    /// Whether the equivalent bend of the whole chain is moderate.
    pub(crate) moderate: bool,
    /// Whether forces are sums over the torsion parts of the drive shaft: the chain is moderate, and
    /// one power passes all joints.
    pub(crate) refers_forces: bool,
    pub(crate) planes: usize,
    /// The output of each shaft, joint or bearing that has planes, in their order.
    pub(crate) outputs: Vec<Output>,
    /// In ascending order.
    pub(crate) shafts: Vec<ShaftStep>,
    /// One step per joint, needed or not.
    pub(crate) joints: Vec<JointStep>,
    pub(crate) any_joint: JointNeeds,
    pub(super) first_bent: usize,
    pub(crate) load: Option<LoadStep>,
    /// The balances behind the requested forces, if there are any.
    pub(crate) forces: Option<ForceStep>,
    /// Whether the drivelines are evaluated joint by joint.
    pub(crate) as_built: bool,
    /// The axes of vectors; those of space if none is requested.
    pub(crate) axes: Axes,
}

/// Computation of one shaft: the plane of each output, and the rates that the load needs.
#[derive(Clone, Debug, Default)]
pub(crate) struct ShaftStep {
    pub(crate) shaft: usize,
    pub(crate) planes: OutputPlanes,
    /// Whether the load, or the cross of the joint behind the shaft, needs the speed ratio, and
    /// whether the load needs the acceleration ratio.
    pub(crate) keep_ratio: bool,
    pub(crate) keep_acceleration: bool,
}

impl ShaftStep {
    /// The planes of rotation, speed ratio and acceleration ratio, if one loop computes all three:
    /// the angle or the angle error but not both, and no rates for the load.
    pub(crate) fn combined_planes(&self) -> Option<[usize; 3]> {
        let [rotation, ratio] = self.combined_pair()?;
        Some([rotation, ratio, self.planes.get(Output::AccelerationRatio)?])
    }

    /// The planes of rotation and speed ratio, if one loop may compute both.
    pub(crate) fn combined_pair(&self) -> Option<[usize; 2]> {
        let plane = |output| self.planes.get(output);
        let ((Some(rotation), None) | (None, Some(rotation))) =
            (plane(Output::Angle), plane(Output::AngleError))
        else {
            return None;
        };
        let both = [rotation, plane(Output::SpeedRatio)?];
        (!self.keep_ratio).then_some(both)
    }

    /// The planes of speed ratio and acceleration ratio.
    pub(crate) fn rates(&self) -> (Option<usize>, Option<usize>) {
        (self.planes.get(Output::SpeedRatio), self.planes.get(Output::AccelerationRatio))
    }

    /// Whether the angle or the angle error is needed.
    pub(crate) fn rotates(&self) -> bool {
        [Output::Angle, Output::AngleError].iter().any(|&output| self.planes.get(output).is_some())
    }

    /// Whether one loop or its strips compute everything, at moderate bends or at steep ones. That of
    /// the jerk is so long that it does not count: with fresh pins it is slower.
    pub(crate) fn has_one_loop(&self, moderate: bool) -> bool {
        let count = |outputs: &[Output]| {
            outputs.iter().filter(|&&output| self.planes.get(output).is_some()).count()
        };
        let rotations = count(&[Output::Angle, Output::AngleError]);
        let rates = count(&[Output::SpeedRatio, Output::AccelerationRatio]);
        !self.keep_ratio
            && self.planes.get(Output::JerkRatio).is_none()
            && match (rotations, rates) {
                (1, 0) | (0, 1..=2) => true,
                (1, 1..=2) => moderate && self.combined_pair().is_some(),
                _ => false,
            }
    }
}

/// Computation of one joint.
#[derive(Clone, Debug, Default)]
#[allow(clippy::struct_excessive_bools, reason = "independent facts")]
pub(crate) struct JointStep {
    pub(crate) planes: OutputPlanes,
    /// Whether any output needs the cross, and whether any needs the torsion.
    pub(crate) needs_cross: bool,
    pub(super) needs_moment: bool,
    /// Whether any force depends on the joint's torsion.
    pub(crate) needs_force: bool,
    /// Whether the cross turns with the axes of any force.
    pub(crate) turns_force: bool,
    /// The joint from which those forces are computed: itself, or the first one on the path of the
    /// load if forces are referred to the drive shaft.
    pub(crate) force_source: usize,
    /// The joint's contributions to the support moments of the shaft that the load leaves here and
    /// of the shaft that it enters.
    pub(crate) support: [Option<Support>; 2],
}

/// Needs of any joint. They are found once, because looking at all joints of a long chain takes a
/// tenth of the time of a chunk.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointNeeds {
    pub(crate) cross: bool,
    pub(crate) torsion: bool,
    /// The number of loops over pins, for all joints.
    pub(crate) pin_loops: usize,
}

/// A joint's contribution to the support moment of one of its shafts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Support {
    /// First plane of the shaft's support moment.
    pub(crate) plane: usize,
    /// Whether the shaft is the joint's driving shaft.
    pub(crate) driving: bool,
    /// Whether it is the shaft's first contribution along the path of the load.
    pub(crate) first: bool,
    /// Whether it is the last.
    pub(crate) last: bool,
}

impl JointStep {
    /// Whether the joint contributes to a support moment.
    pub(crate) fn needs_support(&self) -> bool {
        self.support.iter().any(Option::is_some)
    }

    /// Whether its moment is needed.
    pub(crate) fn is_moment(&self) -> bool {
        self.planes.get(Output::Moment).is_some()
    }

    /// The number of loops over pins for the joint with the number `joint`. Those of the cross need
    /// the sense of the pins as well.
    pub(super) fn pin_loops(&self, joint: usize) -> usize {
        let planes = Output::ALL.iter().filter(|&&output| self.planes.get(output).is_some());
        let others = [self.is_source(joint), self.needs_support()];
        planes.count() + others.into_iter().filter(|&needed| needed).count()
    }

    /// Whether forces are computed from this joint, which has the number `joint`.
    pub(crate) fn is_source(&self, joint: usize) -> bool {
        self.needs_force && self.force_source == joint
    }

    /// Whether anything depends on the joint's torsion.
    pub(crate) fn needs_load(&self) -> bool {
        self.needs_moment || self.needs_support() || self.needs_force
    }

    /// Whether the torsion itself is needed, not only the power, which suffices for forces of ideal
    /// joints.
    pub(crate) fn needs_torsion(&self, as_built: bool) -> bool {
        self.needs_moment || self.needs_support() || self.needs_force && as_built
    }
}

impl Plan {
    /// Checks the arrays of a batch and returns the number of its drivelines. The arrays must have
    /// matching lengths and everything that the plan needs.
    pub(crate) fn check_lines(&self, lines: &Drivelines<'_>) -> Result<usize> {
        let count = lines.check(self.joint_count)?;
        if self.is_as_built() == lines.deviations.is_empty() {
            let (has, needs) = if self.is_as_built() { ("no", "some") } else { ("some", "none") };
            let problem = format!("has {has} deviations; the plan is for drivelines with {needs}");
            return Err(Error::new("deviations", &[], problem));
        }
        let Some(forces) = &self.forces else { return Ok(count) };
        check_length("lengths", lines.lengths.len(), count, self.joint_count + 1)?;
        check_length("positions", lines.positions.len(), count, forces.bearings)?;
        Ok(count)
    }

    /// The cheapest arithmetic whose errors are within a tolerance, relative to the largest value
    /// of each output over a turn. Without a tolerance it is that of the results, unless the chain
    /// is so steep that it would exceed the limits of that arithmetic.
    ///
    /// The arithmetic rounds the turn between the drive shaft and a chain's equivalent joint. A
    /// steep chain amplifies that error by the reciprocal of its cosine. Error terms are exempt:
    /// with them the sum of the two angles is reduced instead.
    pub fn precision(&self, tolerance: Option<f64>, single: bool) -> Precision {
        let reach = self.reach();
        let stretch = if reach > 1 { (0.25 / self.least_cosines[reach]).max(1.0) } else { 1.0 };
        let double = Precision::DOUBLE_ERROR * Precision::STEEPEST;
        let tolerance = tolerance.unwrap_or(if single { Precision::SINGLE_ERROR } else { double });
        if tolerance >= Precision::SINGLE_ERROR * stretch {
            self.computed_in(Precision::Single)
        } else if tolerance >= Precision::DOUBLE_ERROR * stretch {
            Precision::Double
        } else {
            Precision::DoubleDouble
        }
    }

    /// The arithmetic in which the plan is computed if this one is asked for. Joints as built have no
    /// loops in single precision, which would save little of their time.
    pub(crate) fn computed_in(&self, asked: Precision) -> Precision {
        let has_single = cfg!(feature = "single") && !self.is_as_built();
        if asked == Precision::Single && !has_single { Precision::Double } else { asked }
    }

    /// Whether its drivelines have deviations. Builds without these leave out all that they need.
    pub(crate) fn is_as_built(&self) -> bool {
        cfg!(feature = "as_built") && self.as_built
    }

    /// Number of planes of the result.
    pub fn planes(&self) -> usize {
        self.planes
    }

    /// The number of joints to fold for the last shaft or joint that is needed.
    pub(crate) fn reach(&self) -> usize {
        let shafts = self.shafts.last().map_or(0, |step| step.shaft);
        let joints = (0..self.joint_count).rev().find(|&joint| self.needs_pose(joint));
        shafts.max(joints.map_or(0, |joint| joint + 1))
    }

    /// Whether only the motion behind the first joint is needed, and so no map of a chain.
    pub(crate) fn is_joint(&self) -> bool {
        self.reach() == 1 && !self.needs_pose(0)
    }

    /// Whether any output needs the pose of the joint.
    pub(crate) fn needs_pose(&self, joint: usize) -> bool {
        let step = &self.joints[joint];
        step.needs_cross || step.turns_force || step.needs_load()
    }

    /// Whether the angle of any shaft is requested.
    pub(crate) fn needs_angle(&self) -> bool {
        self.shafts.iter().any(|step| step.planes.get(Output::Angle).is_some())
    }

    /// The steps of the shafts behind the first bent joint.
    pub(crate) fn moving(&self) -> impl Iterator<Item = &ShaftStep> {
        let bent = self.first_bent();
        self.shafts.iter().filter(move |step| step.shaft > bent)
    }

    /// Whether the plane contains angles.
    pub(crate) fn is_angle(&self, plane: usize) -> bool {
        self.shafts.iter().any(|step| step.planes.get(Output::Angle) == Some(plane))
    }

    /// Whether any output needs the pose of a joint.
    pub(crate) fn needs_poses(&self) -> bool {
        self.any_joint.cross || self.any_joint.torsion
    }

    /// Whether torques or moments may be sums of several terms, which may cancel, or belong to joints
    /// whose pins a chain has turned. Numbers with error terms then need all their digits. It does
    /// not depend on which torques and moments are requested, so neither do their bits.
    pub(crate) fn has_wide_loads(&self) -> bool {
        self.load.as_ref().is_some_and(|load| self.joint_count > 1 || load.has_inertias)
    }

    /// Whether the torsion parts of several joints need the length of the pins.
    pub(crate) fn needs_inverse_squares(&self) -> bool {
        self.forces.is_some() && !self.refers_forces && !self.is_as_built()
    }

    /// Whether the load or the cross of a joint behind the first reads pins with all digits of numbers
    /// with error terms.
    pub(crate) fn needs_wide_pins(&self) -> bool {
        let loads = self.any_joint.torsion || self.shafts.iter().any(|step| step.keep_ratio);
        let crosses = || self.joints.iter().skip(1).any(|step| step.needs_cross);
        self.has_wide_loads() && loads || self.any_joint.cross && crosses()
    }

    /// Whether the cross of the first joint is needed. Only its pins are those of the drive.
    pub(crate) fn needs_first_cross(&self) -> bool {
        self.joints.first().is_some_and(|step| step.needs_cross)
    }

    /// Whether the load needs the speed of the shaft.
    pub(crate) fn needs_rates(&self, shaft: usize) -> bool {
        self.shafts.iter().any(|step| step.shaft == shaft && step.keep_ratio)
    }

    /// Whether any output is a vector, which needs the frames of the joints.
    pub(crate) fn needs_frames(&self) -> bool {
        let vector = |step: &JointStep| {
            let vectors = [Output::Moment, Output::DrivingPin, Output::DrivenPin];
            vectors.iter().any(|&output| step.planes.get(output).is_some())
        };
        self.joints.iter().any(|step| vector(step) || step.needs_support() || step.needs_force)
    }

    /// Whether every output has its extremes at known angles.
    pub(crate) fn has_closed_extremes(&self) -> bool {
        !self.is_as_built() && self.load.is_none() && !self.needs_poses() && !self.needs_angle()
    }

    /// Whether the sense of a pin matters, not only its line. Half a turn reverses the pins, and with
    /// them the axes of shafts, and a joint as built distinguishes the two positions.
    pub(crate) fn needs_sense(&self) -> bool {
        self.is_as_built() || self.any_joint.cross || self.axes == Axes::Shaft
    }

    /// The first joint that is bent in any driveline; the shafts before it turn with the drive.
    pub(crate) fn first_bent(&self) -> usize {
        self.first_bent
    }

    /// The range of the inverse tangent for a shaft, over all drivelines.
    pub(crate) fn range(&self, shaft: usize) -> AtanRange {
        range(self.least_cosines[shaft])
    }
}

/// The range of the inverse tangent for bends with at least this cosine.
pub(super) fn range(cos: f64) -> AtanRange {
    // An upper bound on the tangent, with a margin for rounding.
    AtanRange::holding((1.0 + 1e-12 - cos) / (2.0 * cos.sqrt()) * (1.0 + 1e-12))
}

/// How the power is computed along the driveline, from the end where the torque is given.
#[derive(Clone, Debug)]
pub(crate) struct LoadStep {
    pub(crate) end: End,
    /// Whether any shaft has an inertia, needed or not.
    pub(crate) has_inertias: bool,
    /// In the order of computation.
    pub(crate) stations: Vec<Station>,
}

impl LoadStep {
    /// Whether any shaft on the path of the load absorbs power.
    pub(crate) fn absorbs(&self) -> bool {
        self.stations.iter().any(|station| station.absorbs)
    }
}

/// One shaft on the path of the load.
#[derive(Clone, Debug)]
pub(crate) struct Station {
    pub(crate) shaft: usize,
    pub(crate) absorbs: bool,
    /// Plane of the torque entering this shaft.
    pub(crate) torque: Option<usize>,
    /// Whether the torsion entering the joint before this shaft is needed.
    pub(crate) torsion: bool,
    /// Whether forces are computed from the power entering that joint.
    pub(crate) force_power: bool,
}
