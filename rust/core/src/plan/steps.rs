//! The steps that compute the requested outputs, planned once per call.
//!
//! A plan does not depend on angles or on particular bends. It lists the shafts and joints that are
//! needed, the plane of the result for each quantity, and the order in which a load travels along
//! the driveline. [`crate::run`] runs it.

use crate::error::{Error, Result};
use crate::mechanics::joint::Joint;
use crate::number::Precision;
use crate::number::atan::AtanRange;
use crate::plan::forces::ForceStep;
use crate::plan::output::{Needs, Output, OutputPlanes, Per};

/// The end of the driveline at which the load's torque is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The torque enters shaft 0.
    Drive,
    /// The torque leaves the last shaft.
    Output,
}

/// What to compute for a driveline.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The largest bend of each joint in rad, from [`crate::Drivelines::largest_bends`], or an
    /// upper bound.
    pub largest_bends: &'a [f64],
    /// The outputs, each at most once.
    pub outputs: &'a [Output],
    /// The shafts, `0..=n`, each at most once.
    pub shafts: &'a [usize],
    /// The joints, `0..n`, each at most once.
    pub joints: &'a [usize],
    /// The end at which the load's torque is given, if there is a load.
    pub load: Option<End>,
    /// The shafts with an inertia.
    pub inertias: &'a [usize],
    /// The shaft of each bearing, if the lengths of the shafts are known.
    pub bearings: Option<&'a [usize]>,
    /// Whether the drivelines have deviations, so that they are evaluated joint by joint.
    pub as_built: bool,
}

/// The steps for one request. The planes of the result are numbered by output, then by shaft or
/// joint, then by component.
#[derive(Clone, Debug)]
pub struct Plan {
    pub(crate) joint_count: usize,
    /// The largest bend of each joint; a joint with zero is straight in every driveline.
    pub(crate) largest_bends: Vec<f64>,
    /// A lower bound on the cosine of the bend equivalent to the joints before each shaft. It holds
    /// for the aligned chain, whose cosines multiply.
    least_cosines: Vec<f64>,
    /// Whether the equivalent bend of the whole chain is moderate.
    pub(crate) moderate: bool,
    pub(crate) planes: usize,
    /// The number of planes of each shaft or joint of each output, in order.
    pub(crate) components: Vec<usize>,
    /// In ascending order.
    pub(crate) shafts: Vec<ShaftStep>,
    /// One step per joint, needed or not.
    pub(crate) joints: Vec<JointStep>,
    pub(crate) any_joint: JointNeeds,
    first_bent: usize,
    pub(crate) load: Option<LoadStep>,
    /// The balances behind the requested forces, if there are any.
    pub(crate) forces: Option<ForceStep>,
    /// Whether the drivelines are evaluated joint by joint.
    pub(crate) as_built: bool,
}

/// What to compute for one shaft: the plane of each output, and the rates that the load needs.
#[derive(Clone, Debug, Default)]
pub(crate) struct ShaftStep {
    pub(crate) shaft: usize,
    pub(crate) planes: OutputPlanes,
    /// Whether the load needs the speed ratio and the acceleration ratio.
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

    /// Whether one loop computes everything, at moderate bends or at steep ones. That of the jerk is
    /// so long that it does not count: with fresh pins it is slower.
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

/// What to compute for one joint.
#[derive(Clone, Debug, Default)]
pub(crate) struct JointStep {
    pub(crate) planes: OutputPlanes,
    /// Whether any output is a tilt, and whether any needs the torsion.
    pub(crate) needs_tilt: bool,
    needs_moment: bool,
    /// Whether any force depends on the joint's torsion.
    pub(crate) needs_force: bool,
    /// The joint's contributions to the support moments of the shaft that the load leaves here and
    /// of the shaft that it enters.
    pub(crate) support: [Option<Support>; 2],
}

/// What any joint needs. It is found once, because looking at all joints of a long chain takes a
/// tenth of the time of a chunk.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct JointNeeds {
    pub(crate) tilt: bool,
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

    /// The number of loops over pins. Those of the tilts need the sense of the pins as well.
    pub(crate) fn pin_loops(&self) -> usize {
        let outputs = [
            Output::TiltDriving,
            Output::TiltDriven,
            Output::BendingDriving,
            Output::BendingDriven,
            Output::Moment,
        ];
        let planes = outputs.iter().filter(|&&output| self.planes.get(output).is_some());
        planes.count() + usize::from(self.needs_force) + usize::from(self.needs_support())
    }

    pub(crate) fn needs_torsion(&self) -> bool {
        self.needs_moment || self.needs_support() || self.needs_force
    }
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

/// One shaft on the path of the load.
#[derive(Clone, Debug)]
pub(crate) struct Station {
    pub(crate) shaft: usize,
    pub(crate) absorbs: bool,
    /// Plane of the torque entering this shaft.
    pub(crate) torque: Option<usize>,
    /// Whether the torsion entering the joint before this shaft is needed.
    pub(crate) torsion: bool,
}

impl Plan {
    /// Plans a request.
    ///
    /// # Errors
    /// A shaft or joint that does not exist or is repeated, a repeated output, or an output that
    /// needs a load where the request has none.
    pub fn new(request: &Request<'_>) -> Result<Self> {
        let n = request.largest_bends.len();
        check_items("shafts", request.shafts, n + 1)?;
        check_items("joints", request.joints, n)?;
        check_items("inertias", request.inertias, n + 1)?;
        let joints = vec![JointStep::default(); n];
        let least_cosines = least_cosines(request.largest_bends);
        let mut plan = Self {
            joint_count: n,
            largest_bends: request.largest_bends.to_vec(),
            moderate: range(least_cosines[n]).is_moderate(),
            least_cosines,
            planes: 0,
            components: vec![],
            shafts: vec![],
            joints,
            any_joint: JointNeeds::default(),
            first_bent: first_bent(request),
            load: None,
            forces: None,
            as_built: request.as_built,
        };
        let bearings: Vec<usize> = (0..request.bearings.map_or(0, <[usize]>::len)).collect();
        let mut torque = vec![None; n + 1];
        for (i, &output) in request.outputs.iter().enumerate() {
            if request.outputs[..i].contains(&output) {
                let problem = format!("is {:?} again; name each output once", output.row().name);
                return Err(Error::new("outputs", &[i], problem));
            }
            if output.needs_load() && request.load.is_none() {
                let problem = format!("is {:?}, which needs a load", output.row().name);
                return Err(Error::new("outputs", &[i], problem));
            }
            let row = output.row();
            let items = match row.per {
                Per::Shaft => request.shafts,
                Per::Joint => request.joints,
                Per::Bearing => &bearings,
            };
            if row.needs == Needs::Force && request.as_built {
                let problem = format!(
                    "is {:?}, which joints as built do not have; the moments and support moments \
                     that cause it are available",
                    row.name
                );
                return Err(Error::new("outputs", &[i], problem));
            }
            if row.needs == Needs::Force {
                plan.start_forces(request, output, i)?;
            }
            for &item in items {
                let plane = plan.planes;
                plan.planes += row.components.len();
                plan.components.push(row.components.len());
                match row.needs {
                    Needs::Motion(_) => plan.step(item).planes.set(output, plane),
                    Needs::Power => torque[item] = Some(plane),
                    Needs::Support => {
                        if let Some(end) = request.load {
                            plan.plan_support(end, item, plane);
                        }
                    }
                    Needs::Torsion => {
                        plan.joints[item].planes.set(output, plane);
                        plan.joints[item].needs_moment = true;
                    }
                    Needs::Tilt => {
                        plan.joints[item].planes.set(output, plane);
                        plan.joints[item].needs_tilt = true;
                    }
                    Needs::Force => plan.plan_force(request, output, item, plane, i)?,
                }
            }
        }
        for joint in plan.forces.iter().flat_map(ForceStep::joints) {
            plan.joints[joint].needs_force = true;
        }
        if let Some(end) = request.load {
            plan.plan_load(end, request.inertias, &torque);
        }
        plan.shafts.sort_by_key(|step| step.shaft);
        plan.any_joint = JointNeeds {
            tilt: plan.joints.iter().any(|step| step.needs_tilt),
            torsion: plan.joints.iter().any(JointStep::needs_torsion),
            pin_loops: plan.joints.iter().map(JointStep::pin_loops).sum(),
        };
        Ok(plan)
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
        // Joints as built have no loops in single precision, which would save little of their time.
        if tolerance >= Precision::SINGLE_ERROR * stretch && !self.as_built {
            Precision::Single
        } else if tolerance >= Precision::DOUBLE_ERROR * stretch {
            Precision::Double
        } else {
            Precision::DoubleDouble
        }
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
        self.joints[joint].needs_tilt || self.joints[joint].needs_torsion()
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
        self.any_joint.tilt || self.any_joint.torsion
    }

    /// Whether torques or moments may be sums of several terms, which may cancel, or belong to joints
    /// whose pins a chain has turned. Numbers with error terms then need all their digits. It does
    /// not depend on which torques and moments are requested, so neither do their bits.
    pub(crate) fn has_wide_loads(&self) -> bool {
        self.load.as_ref().is_some_and(|load| self.joint_count > 1 || load.has_inertias)
    }

    /// Whether any step of the load reads pins.
    pub(crate) fn loads_read_pins(&self) -> bool {
        self.any_joint.torsion || self.shafts.iter().any(|step| step.keep_ratio)
    }

    /// Whether a tilt of the first joint is needed. Only its pins are those of the drive.
    pub(crate) fn needs_first_tilt(&self) -> bool {
        self.joints.first().is_some_and(|step| step.needs_tilt)
    }

    /// Whether the load needs the speed of the shaft.
    pub(crate) fn needs_rates(&self, shaft: usize) -> bool {
        self.shafts.iter().any(|step| step.shaft == shaft && step.keep_ratio)
    }

    /// Whether any output is a vector, which needs the frames of the joints.
    pub(crate) fn needs_frames(&self) -> bool {
        let moment = |step: &JointStep| step.planes.get(Output::Moment).is_some();
        self.joints.iter().any(|step| moment(step) || step.needs_support() || step.needs_force)
    }

    /// Whether every output has its extremes at known angles.
    pub(crate) fn has_closed_extremes(&self) -> bool {
        !self.as_built && self.load.is_none() && !self.needs_poses() && !self.needs_angle()
    }

    /// Whether the sense of a pin matters, not only its line. Half a turn reverses the pins, and a
    /// joint as built distinguishes the two positions.
    pub(crate) fn needs_sense(&self) -> bool {
        self.as_built || self.any_joint.tilt
    }

    /// The first joint that is bent in any driveline; the shafts before it turn with the drive.
    pub(crate) fn first_bent(&self) -> usize {
        self.first_bent
    }

    /// The range of the inverse tangent for a shaft, over all drivelines.
    pub(crate) fn range(&self, shaft: usize) -> AtanRange {
        range(self.least_cosines[shaft])
    }

    fn step(&mut self, shaft: usize) -> &mut ShaftStep {
        let index = self.shafts.iter().position(|step| step.shaft == shaft);
        let index = index.unwrap_or_else(|| {
            self.shafts.push(ShaftStep { shaft, ..ShaftStep::default() });
            self.shafts.len() - 1
        });
        &mut self.shafts[index]
    }

    /// Plans the contributions of its joints to one shaft's support moment.
    fn plan_support(&mut self, end: End, shaft: usize, plane: usize) {
        let n = self.joint_count;
        let before = shaft > 0;
        let after = shaft < n;
        // The load enters a shaft at one joint and leaves it at the next.
        let (leaves, comes) = (0, 1);
        let slots = if end == End::Drive { [comes, leaves] } else { [leaves, comes] };
        if before {
            let (first, last) = (end == End::Drive || !after, end == End::Output || !after);
            let support = Support { plane, driving: false, first, last };
            self.joints[shaft - 1].support[slots[0]] = Some(support);
        }
        if after {
            let (first, last) = (end == End::Output || !before, end == End::Drive || !before);
            let support = Support { plane, driving: true, first, last };
            self.joints[shaft].support[slots[1]] = Some(support);
        }
    }

    /// Lists the shafts from the end where the torque is given to the last one whose entering power
    /// is needed; inertias beyond it do not matter.
    fn plan_load(&mut self, end: End, inertias: &[usize], torque: &[Option<usize>]) {
        let (n, bent) = (self.joint_count, self.first_bent());
        let torsion_before = |shaft: usize| shaft > 0 && self.joints[shaft - 1].needs_torsion();
        let needed = |shaft: &usize| torque[*shaft].is_some() || torsion_before(*shaft);
        let range: Vec<usize> = match end {
            End::Drive => match (0..=n).rev().find(needed) {
                Some(last) => (0..=last).collect(),
                None => return,
            },
            End::Output => match (0..=n).find(needed) {
                Some(first) => (first..=n).rev().collect(),
                None => return,
            },
        };
        let last = range[range.len() - 1];
        let stations: Vec<Station> = range
            .into_iter()
            .map(|shaft| {
                let passed = end == End::Output || shaft != last;
                let absorbs = passed && inertias.contains(&shaft);
                Station { shaft, absorbs, torque: torque[shaft], torsion: torsion_before(shaft) }
            })
            .collect();
        for station in &stations {
            let shaft = station.shaft;
            let starts = end == End::Output && shaft == n;
            // A shaft that turns with the drive has the speed ratio 1, which no step needs.
            if station.absorbs || shaft > bent && (station.torque.is_some() || starts) {
                self.step(shaft).keep_ratio = true;
            }
            if station.absorbs {
                self.step(shaft).keep_acceleration = true;
            }
            if station.torsion && shaft - 1 > bent {
                self.step(shaft - 1).keep_ratio = true;
            }
        }
        self.load = Some(LoadStep { end, has_inertias: !inertias.is_empty(), stations });
    }
}

/// The first joint that is bent in any driveline. A straight joint as built counts as bent.
fn first_bent(request: &Request<'_>) -> usize {
    let bends = request.largest_bends;
    let is_bent = |&bend: &f64| request.as_built || bend != 0.0;
    bends.iter().position(is_bent).unwrap_or(bends.len())
}

/// The range of the inverse tangent for bends with at least this cosine.
fn range(cos: f64) -> AtanRange {
    // An upper bound on the tangent, with a margin for rounding.
    AtanRange::holding((1.0 + 1e-12 - cos) / (2.0 * cos.sqrt()) * (1.0 + 1e-12))
}

fn least_cosines(bends: &[f64]) -> Vec<f64> {
    let mut cosine = 1.0;
    let next = |&bend: &f64| {
        cosine *= Joint::new(bend).cos;
        cosine
    };
    std::iter::once(1.0).chain(bends.iter().map(next)).collect()
}

fn check_items(argument: &'static str, items: &[usize], count: usize) -> Result<()> {
    for (i, &item) in items.iter().enumerate() {
        if item >= count {
            let problem = format!("is {item}; there are {count}, counted from 0");
            return Err(Error::new(argument, &[i], problem));
        }
        if items[..i].contains(&item) {
            return Err(Error::new(argument, &[i], format!("is {item} again; name each once")));
        }
    }
    Ok(())
}
