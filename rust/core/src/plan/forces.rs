//! The balances of shafts that determine the requested forces.

use std::ops::Range;

use crate::mechanics::bearings::{Carried, Carrier, Statics};
use crate::mechanics::forces::PARTS;
use crate::plan::output::Per;

/// A value, or the reason why it is not determinate.
type Determinate<T> = Result<T, String>;

/// How the requested forces follow from the torsion parts of the joints.
#[derive(Clone, Debug)]
pub(crate) struct ForceStep {
    statics: Statics,
    /// The number of bearings of each driveline.
    pub(crate) bearings: usize,
    /// The number of coefficients of all balances and targets.
    terms: usize,
    /// In an order in which each needs only earlier ones.
    pub(crate) balances: Vec<Balance>,
    /// The index of each shaft's balance, if it is planned.
    balance_of: Vec<Option<usize>>,
    pub(crate) targets: Vec<ForceTarget>,
}

/// The balance of one shaft, which gives the forces of its two supports.
#[derive(Clone, Debug)]
pub(crate) struct Balance {
    pub(crate) shaft: usize,
    pub(crate) carriers: [Carrier; 2],
    /// The forces of the shaft's other joints.
    pub(crate) loads: Vec<JointLoad>,
    /// The joints whose torsion parts the forces depend on.
    pub(crate) joints: Range<usize>,
}

/// The force of a joint on a shaft that it does not support.
#[derive(Clone, Copy, Debug)]
pub(crate) struct JointLoad {
    /// The joint's place on the shaft that feels it.
    pub(crate) at: Carrier,
    /// The force on that shaft.
    pub(crate) force: ForceOf,
}

/// One of the two forces of a balance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ForceOf {
    pub(crate) balance: usize,
    pub(crate) carrier: usize,
    /// Whether it is the opposite of the force on the shaft.
    pub(crate) reversed: bool,
}

/// A requested force.
#[derive(Clone, Debug)]
pub(crate) struct ForceTarget {
    /// Its source: a joint or a bearing.
    pub(crate) of: (Per, usize),
    /// The shaft on which it acts.
    pub(crate) shaft: usize,
    /// First plane of the result.
    pub(crate) plane: usize,
    /// The force; none where a joint transmits no force.
    pub(crate) force: Option<ForceOf>,
    /// The joints whose torsion parts it is a sum of.
    pub(crate) joints: Range<usize>,
    /// The joints whose torsion parts, or those of the drive shaft under their power, it is computed
    /// from.
    pub(crate) sources: Vec<usize>,
    /// First plane of an earlier target whose force is equal or opposite, and the sign.
    pub(crate) twin: Option<(usize, f64)>,
}

impl ForceStep {
    /// Without any force, for drivelines with `joints` joints and with bearings on these shafts.
    pub(crate) fn new(joints: usize, bearings: &[usize]) -> Self {
        let statics = Statics::new(joints, bearings);
        let balance_of = vec![None; joints + 1];
        Self {
            statics,
            bearings: bearings.len(),
            terms: 0,
            balances: vec![],
            balance_of,
            targets: vec![],
        }
    }

    /// Adds the force that a joint exerts on its driven shaft.
    ///
    /// # Errors
    /// The reason why it is not determinate.
    pub(crate) fn add_joint(&mut self, joint: usize, plane: usize) -> Determinate<()> {
        let force = self.of_joint(joint)?;
        self.add((Per::Joint, joint), joint + 1, plane, force);
        Ok(())
    }

    /// Adds the force that a bearing exerts on its shaft.
    ///
    /// # Errors
    /// The reason why it is not determinate.
    pub(crate) fn add_bearing(
        &mut self,
        bearing: usize,
        shaft: usize,
        plane: usize,
    ) -> Determinate<()> {
        let force = self.of_carrier(shaft, Carrier::Bearing(bearing))?;
        self.add((Per::Bearing, bearing), shaft, plane, Some(force));
        Ok(())
    }

    /// Target of the force of a joint or a bearing.
    pub(crate) fn target(&self, of: (Per, usize)) -> Option<&ForceTarget> {
        self.targets.iter().find(|target| target.of == of)
    }

    /// The number of shafts of each driveline.
    pub(crate) fn shafts(&self) -> usize {
        self.statics.shafts.len()
    }

    fn add(&mut self, of: (Per, usize), shaft: usize, plane: usize, force: Option<ForceOf>) {
        let joints = match force {
            Some(ForceOf { balance, .. }) => self.balances[balance].joints.clone(),
            // Of a joint: a sum whose coefficients are zero, which is NaN where the torsion is.
            None => shaft - 1..shaft,
        };
        self.terms += PARTS * joints.len();
        let twin = force.and_then(|force| self.twin(force));
        self.targets.push(ForceTarget { of, shaft, plane, force, joints, sources: vec![], twin });
    }

    /// The target whose force is equal or opposite, if there is one: its plane, and the sign. Both
    /// forces of a balance without loads are opposite.
    fn twin(&self, force: ForceOf) -> Option<(usize, f64)> {
        if !self.balances[force.balance].loads.is_empty() {
            return None;
        }
        self.targets.iter().find_map(|target| {
            let other = target.force.filter(|other| other.balance == force.balance)?;
            let sign = if other.reversed == force.reversed { -1.0 } else { 1.0 };
            Some((target.plane, sign))
        })
    }

    /// The number of coefficients of all balances and targets.
    pub(crate) fn terms(&self) -> usize {
        self.terms
    }

    /// The joints whose torsion parts are needed.
    pub(crate) fn joints(&self) -> impl Iterator<Item = usize> {
        self.targets.iter().flat_map(|target| target.joints.clone())
    }

    /// Sets the sources of all targets, given that of each joint.
    pub(crate) fn set_sources(&mut self, source_of: impl Fn(usize) -> usize) {
        for target in &mut self.targets {
            target.sources = target.joints.clone().map(&source_of).collect();
            // Joints with the same power follow each other.
            target.sources.dedup();
        }
    }

    /// The force of a joint on its driven shaft.
    fn of_joint(&mut self, joint: usize) -> Determinate<Option<ForceOf>> {
        let Some(shaft) = self.statics.supported[joint] else { return Ok(None) };
        let driving = shaft == joint;
        let carrier = if driving { Carrier::DownstreamJoint } else { Carrier::UpstreamJoint };
        let force = self.of_carrier(shaft, carrier)?;
        Ok(Some(ForceOf { reversed: driving, ..force }))
    }

    /// The force of one of a shaft's supports on it.
    fn of_carrier(&mut self, shaft: usize, carrier: Carrier) -> Determinate<ForceOf> {
        let balance = if let Some(known) = self.balance_of[shaft] {
            known
        } else {
            // Each of these needs only those before it.
            for other in self.neighbours(shaft) {
                if self.balance_of[other].is_none() {
                    self.plan_balance(other)?;
                }
            }
            self.plan_balance(shaft)?
        };
        let carriers = &self.balances[balance].carriers;
        match carriers.iter().position(|&other| other == carrier) {
            Some(carrier) => Ok(ForceOf { balance, carrier, reversed: false }),
            None => Err(format!("shaft {shaft} is not carried there")),
        }
    }

    /// The shafts whose balances a shaft's balance depends on, the farthest first.
    fn neighbours(&self, shaft: usize) -> Vec<usize> {
        let upstream = (0..shaft).rev().take_while(|&s| self.statics.supported[s] == Some(s));
        let downstream = (shaft + 1..=self.statics.supported.len())
            .take_while(|&s| self.statics.supported[s - 1] == Some(s));
        let mut shafts: Vec<usize> = upstream.collect();
        shafts.reverse();
        let mut others: Vec<usize> = downstream.collect();
        others.reverse();
        shafts.extend(others);
        shafts
    }

    fn plan_balance(&mut self, shaft: usize) -> Determinate<usize> {
        let carriers = match &self.statics.shafts[shaft] {
            Carried::By(carriers) => *carriers,
            Carried::Unknown(reason) => return Err(reason.clone()),
            Carried::ByMachine => return Err(format!("shaft {shaft} has no bearings")),
        };
        let n = self.statics.supported.len();
        let mut joints = shaft.saturating_sub(1)..n.min(shaft + 1);
        let mut loads = vec![];
        for (at, joint) in [
            (Carrier::UpstreamJoint, shaft.checked_sub(1)),
            (Carrier::DownstreamJoint, Some(shaft)),
        ] {
            let Some(joint) = joint.filter(|&joint| joint < n && !carriers.contains(&at)) else {
                continue;
            };
            if let Some(mut force) = self.of_joint(joint)? {
                // The driving shaft feels the opposite.
                force.reversed ^= joint == shaft;
                let others = &self.balances[force.balance].joints;
                joints = joints.start.min(others.start)..joints.end.max(others.end);
                loads.push(JointLoad { at, force });
            }
        }
        self.terms += PARTS * joints.len();
        self.balances.push(Balance { shaft, carriers, loads, joints });
        let balance = self.balances.len() - 1;
        self.balance_of[shaft] = Some(balance);
        Ok(balance)
    }
}

impl ForceTarget {
    /// The joint whose cross turns with the shaft's axes, and whether the shaft drives that joint.
    pub(crate) fn turns_with(&self) -> (usize, bool) {
        (self.shaft.saturating_sub(1), self.shaft == 0)
    }
}

impl Balance {
    /// The index of a joint's part among the coefficients of its forces.
    pub(crate) fn index(&self, joint: usize, part: usize) -> usize {
        (joint - self.joints.start) * PARTS + part
    }
}
