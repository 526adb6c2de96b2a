//! The steps that carry a load along the driveline.

use crate::plan::steps::{End, JointStep, Plan, Support};

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
    /// Whether forces need the power entering that joint, because they are sums over the parts of the
    /// drive shaft.
    pub(crate) force_power: bool,
}

impl Plan {
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
        // In steep chains the terms of the drive shaft cancel, and so do those of different powers.
        let one_power = !inertias.iter().any(|&shaft| shaft > 0 && shaft < n);
        self.refers_forces = self.moderate && one_power;
        let mut stations: Vec<Station> = range
            .into_iter()
            .map(|shaft| {
                let passed = end == End::Output || shaft != last;
                let absorbs = passed && inertias.contains(&shaft);
                let step = joint_before(shaft);
                let torsion = step.is_some_and(|step| step.needs_torsion(self.refers_forces));
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
}
