//! Planning: which steps a request needs, and in which order.

use crate::error::{Error, Result};
use crate::input::batch::check_shafts;
use crate::mechanics::geometry::check_count;
use crate::mechanics::joint::Joint;
use crate::plan::forces::ForceStep;
use crate::plan::output::{Needs, OfCross, Output, Per};
use crate::plan::request::{Axes, End, Request};
use crate::plan::steps::{JointNeeds, JointStep, Plan, ShaftStep, Support, range};
use crate::plan::steps::{LoadStep, Station};

impl Plan {
    /// Plans a request.
    ///
    /// # Errors
    /// No joint or too many, a shaft or joint that does not exist or is repeated, a repeated output, an output that needs a
    /// load where the request has none, or one that is not known in the axes of shafts.
    pub fn new(request: &Request<'_>) -> Result<Self> {
        let n = request.largest_bends.len();
        check_count("largest_bends", n)?;
        check_items("shafts", request.shafts, n + 1)?;
        check_items("joints", request.joints, n)?;
        check_items("inertias", request.inertias, n + 1)?;
        check_shafts(n, request.bearings.unwrap_or_default())?;
        if request.as_built && cfg!(not(feature = "as_built")) {
            let problem = "has joints with deviations, which this build leaves out";
            return Err(Error::new("driveline", &[], problem));
        }
        let joints = vec![JointStep::default(); n];
        let least_cosines = least_cosines(request.largest_bends);
        let has_vectors = request.outputs.iter().any(|output| output.is_vector());
        let mut plan = Self {
            joint_count: n,
            largest_bends: request.largest_bends.to_vec(),
            moderate: range(least_cosines[n]).is_moderate(),
            refers_forces: false,
            least_cosines,
            planes: 0,
            outputs: vec![],
            shafts: vec![],
            joints,
            any_joint: JointNeeds::default(),
            first_bent: first_bent(request),
            load: None,
            forces: None,
            as_built: request.as_built,
            axes: if has_vectors { request.axes } else { Axes::Space },
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
            if output.is_ideal() && request.as_built {
                let why = "; drivelines with deviations do not have it, only ideal joints do";
                return Err(refused(output, i, why));
            }
            let row = output.row();
            let of_cross = matches!(row.needs, Needs::Cross(_));
            if plan.axes == Axes::Shaft && output.is_vector() && (of_cross || request.as_built) {
                let problem = format!("is 'shaft'; {} is known in 'space' only", row.name);
                return Err(Error::new("axes", &[], problem));
            }
            let items = match row.per {
                Per::Shaft => request.shafts,
                Per::Joint => request.joints,
                Per::Bearing => &bearings,
            };
            if row.needs == Needs::Force {
                plan.start_forces(request, output, i)?;
            }
            for &item in items {
                let plane = plan.planes;
                plan.planes += row.components.len();
                plan.outputs.push(output);
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
                    Needs::Cross(of) => {
                        plan.joints[item].planes.set(output, plane);
                        plan.joints[item].needs_cross = true;
                        if of == OfCross::Swing {
                            plan.step(item).keep_ratio = true;
                        }
                    }
                    Needs::Force => plan.plan_force(request, output, item, plane, i)?,
                }
            }
        }
        for joint in plan.forces.iter().flat_map(ForceStep::joints) {
            plan.joints[joint].needs_force = true;
        }
        if plan.axes == Axes::Shaft {
            for target in plan.forces.iter().flat_map(|forces| &forces.targets) {
                plan.joints[target.turns_with().0].turns_force = true;
            }
        }
        if let Some(end) = request.load {
            plan.plan_load(end, request.inertias, &torque);
        }
        plan.shafts.sort_by_key(|step| step.shaft);
        plan.any_joint = plan.needs_of_any_joint();
        Ok(plan)
    }

    fn needs_of_any_joint(&self) -> JointNeeds {
        let steps = self.joints.iter().enumerate();
        let pin_loops: usize = steps.map(|(joint, step)| step.pin_loops(joint)).sum();
        JointNeeds {
            cross: self.joints.iter().any(|step| step.needs_cross),
            torsion: self.joints.iter().any(JointStep::needs_load),
            pin_loops: pin_loops + usize::from(self.needs_inverse_squares()),
        }
    }

    pub(super) fn step(&mut self, shaft: usize) -> &mut ShaftStep {
        let index = self.shafts.iter().position(|step| step.shaft == shaft);
        let index = index.unwrap_or_else(|| {
            self.shafts.push(ShaftStep { shaft, ..ShaftStep::default() });
            self.shafts.len() - 1
        });
        &mut self.shafts[index]
    }

    /// Plans the contributions of its joints to one shaft's support moment.
    pub(super) fn plan_support(&mut self, end: End, shaft: usize, plane: usize) {
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
    pub(super) fn plan_load(&mut self, end: End, inertias: &[usize], torque: &[Option<usize>]) {
        let (n, bent) = (self.joint_count, self.first_bent());
        // In steep chains the terms of the drive shaft cancel, and so do those of different powers.
        // It does not depend on which forces are requested, so neither do their bits.
        let one_power = !inertias.iter().any(|&shaft| shaft > 0 && shaft < n);
        self.refers_forces = self.moderate && one_power && !self.is_as_built();
        let joint_before = |shaft: usize| shaft.checked_sub(1).map(|joint| &self.joints[joint]);
        let needed = |shaft: &usize| {
            torque[*shaft].is_some() || joint_before(*shaft).is_some_and(JointStep::needs_load)
        };
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
        let mut stations: Vec<Station> = range
            .into_iter()
            .map(|shaft| {
                let passed = end == End::Output || shaft != last;
                let absorbs = passed && inertias.contains(&shaft);
                let step = joint_before(shaft);
                let torsion = step.is_some_and(|step| step.needs_torsion(self.is_as_built()));
                Station { shaft, absorbs, torque: torque[shaft], torsion, force_power: false }
            })
            .collect();
        self.find_force_sources(&mut stations);
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

    /// Begins with the forces of a request, of which output `place` is one.
    ///
    /// # Errors
    /// Unknown lengths, and forces of bearings without a bearing.
    pub(crate) fn start_forces(
        &mut self,
        request: &Request<'_>,
        output: Output,
        place: usize,
    ) -> Result<()> {
        let Some(bearings) = request.bearings else {
            let rule = "the lengths of the shafts; drivelines from points have them, others get \
                        them with their bearings";
            return Err(refused(output, place, &format!(", which needs {rule}")));
        };
        if output.row().per == Per::Bearing && bearings.is_empty() {
            return Err(refused(output, place, "; the driveline has no bearings"));
        }
        self.forces.get_or_insert_with(|| ForceStep::new(self.joint_count, bearings));
        Ok(())
    }

    /// Plans the force of one joint or bearing.
    ///
    /// # Errors
    /// A force that is not determinate.
    pub(crate) fn plan_force(
        &mut self,
        request: &Request<'_>,
        output: Output,
        item: usize,
        plane: usize,
        place: usize,
    ) -> Result<()> {
        let (Some(forces), Some(bearings)) = (&mut self.forces, request.bearings) else {
            return Ok(());
        };
        let planned = match output.row().per {
            Per::Bearing => forces.add_bearing(item, bearings[item], plane),
            _ => forces.add_joint(item, plane),
        };
        planned.map_err(|reason| refused(output, place, &format!("; {reason}")))
    }

    /// Finds the joints from which forces are computed: the first station's for all of them, or each
    /// joint for itself.
    pub(super) fn find_force_sources(&mut self, stations: &mut [Station]) {
        let as_built = self.is_as_built();
        let Some(forces) = &mut self.forces else { return };
        let mut source = None;
        for station in stations {
            if let Some(joint) = station.shaft.checked_sub(1)
                && self.joints[joint].needs_force
            {
                source = source.filter(|_| self.refers_forces).or(Some(joint));
                self.joints[joint].force_source = source.unwrap_or(joint);
                station.force_power = source == Some(joint) && !as_built;
            }
        }
        forces.set_sources(|joint| self.joints[joint].force_source);
    }
}

/// The first joint that is bent in any driveline. A straight joint as built counts as bent.
fn first_bent(request: &Request<'_>) -> usize {
    let bends = request.largest_bends;
    let is_bent = |&bend: &f64| request.as_built || bend != 0.0;
    bends.iter().position(is_bent).unwrap_or(bends.len())
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

fn refused(output: Output, place: usize, why: &str) -> Error {
    Error::new("outputs", &[place], format!("is {:?}{why}", output.row().name))
}
