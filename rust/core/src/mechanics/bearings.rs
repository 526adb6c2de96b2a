//! Which bearings and joints carry the transverse forces of each shaft.
//!
//! A shaft needs two supports. Two bearings are its own. A shaft with one bearing has one of its
//! joints as the second support, and an intermediate shaft without bearings, which floats, has both
//! of its joints. A joint supports one of its shafts at most, and its force is a load on the other.
//! A first or last shaft without bearings is held by the machine of which it is a part.

/// One of the two supports of a shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Carrier {
    /// The joint at its upstream end.
    UpstreamJoint,
    /// The joint at its downstream end.
    DownstreamJoint,
    /// The bearing with this number.
    Bearing(usize),
}

/// Support of a shaft.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Carried {
    /// The machine of which it is a part.
    ByMachine,
    /// Two supports.
    By([Carrier; 2]),
    /// Supports whose forces are not determinate, with the reason.
    Unknown(String),
}

/// Supports of each shaft of a driveline, and the shaft that each joint supports.
#[derive(Clone, Debug)]
pub(crate) struct Statics {
    pub(crate) shafts: Vec<Carried>,
    /// The shaft whose balance determines the force of each joint. Without one the joint transmits
    /// no force.
    pub(crate) supported: Vec<Option<usize>>,
}

impl Statics {
    /// Statics of a driveline with `joints` joints and with bearings on these shafts.
    pub(crate) fn new(joints: usize, bearings: &[usize]) -> Self {
        let mut own: Vec<Vec<usize>> = vec![vec![]; joints + 1];
        for (bearing, &shaft) in bearings.iter().enumerate() {
            own[shaft].push(bearing);
        }
        let floats = |shaft: usize| shaft > 0 && shaft < joints && own[shaft].is_empty();
        let shafts = vec![Carried::ByMachine; joints + 1];
        let mut statics = Self { shafts, supported: vec![None; joints] };
        for (shaft, own) in own.iter().enumerate() {
            match own[..] {
                [] if floats(shaft) => {
                    statics.shafts[shaft] =
                        Carried::By([Carrier::UpstreamJoint, Carrier::DownstreamJoint]);
                    statics.supported[shaft - 1] = Some(shaft);
                    statics.supported[shaft] = Some(shaft);
                }
                [] | [_] => {}
                [a, b] => {
                    statics.shafts[shaft] = Carried::By([Carrier::Bearing(a), Carrier::Bearing(b)]);
                }
                [..] => {
                    statics.shafts[shaft] = Carried::Unknown(format!(
                        "shaft {shaft} has {} bearings; forces are determinate with two",
                        own.len()
                    ));
                }
            }
        }
        for joint in (0..joints).filter(|&joint| floats(joint) && floats(joint + 1)) {
            let next = joint + 1;
            let reason = format!(
                "shafts {joint} and {next} both float, and joint {joint} cannot support both"
            );
            statics.refuse(&[joint, next], &reason);
        }
        statics.support_single_bearings(&own);
        statics
    }

    /// Finds the second support of each shaft with one bearing: the only joint that supports no
    /// other shaft. Each one found can leave a neighbour with only one such joint.
    fn support_single_bearings(&mut self, own: &[Vec<usize>]) {
        let mut open: Vec<bool> = own.iter().map(|own| own.len() == 1).collect();
        let mut queue: Vec<usize> = (0..own.len()).collect();
        while let Some(shaft) = queue.pop() {
            let free = self.free_joints(shaft);
            if !open[shaft] || free.len() > 1 {
                continue;
            }
            open[shaft] = false;
            if let [joint] = free[..] {
                let bearing = Carrier::Bearing(own[shaft][0]);
                self.supported[joint] = Some(shaft);
                self.shafts[shaft] = Carried::By(if joint == shaft {
                    [bearing, Carrier::DownstreamJoint]
                } else {
                    [Carrier::UpstreamJoint, bearing]
                });
            } else {
                let joints = self.joints(shaft);
                let mut shafts: Vec<usize> =
                    joints.iter().filter_map(|&joint| self.supported[joint]).collect();
                shafts.push(shaft);
                let (joint, next) = (joints[0], joints[0] + 1);
                let reason =
                    format!("joint {joint} cannot support both its shafts, {joint} and {next}");
                self.refuse(&shafts, &reason);
            }
            queue.extend(shaft.checked_sub(1));
            queue.extend(Some(shaft + 1).filter(|&next| next < own.len()));
        }
        for shaft in (0..own.len()).filter(|&shaft| open[shaft]) {
            let (bearing, before) = (own[shaft][0], shaft - 1);
            let reason = format!(
                "shaft {shaft} has three supports, bearing {bearing} and joints {before} and \
                 {shaft}; forces are determinate with two"
            );
            self.refuse(&[shaft], &reason);
        }
    }

    /// The joints at the ends of a shaft.
    fn joints(&self, shaft: usize) -> Vec<usize> {
        let joints = self.supported.len();
        [shaft.checked_sub(1), Some(shaft)].into_iter().flatten().filter(|&j| j < joints).collect()
    }

    /// The joints of a shaft that support no shaft.
    fn free_joints(&self, shaft: usize) -> Vec<usize> {
        let mut joints = self.joints(shaft);
        joints.retain(|&joint| self.supported[joint].is_none());
        joints
    }

    /// Leaves the supports of shafts, and the forces of their joints, unknown.
    fn refuse(&mut self, shafts: &[usize], reason: &str) {
        for &shaft in shafts {
            self.shafts[shaft] = Carried::Unknown(reason.into());
            for joint in self.joints(shaft) {
                self.supported[joint] = Some(shaft);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_support_floating_shafts_first() {
        let truck = Statics::new(3, &[0, 0, 1, 3, 3]);
        assert_eq!(truck.supported, [Some(1), Some(2), Some(2)]);
        assert_eq!(truck.shafts[0], Carried::By([Carrier::Bearing(0), Carrier::Bearing(1)]));
        assert_eq!(truck.shafts[1], Carried::By([Carrier::UpstreamJoint, Carrier::Bearing(2)]));
        let both = [Carrier::UpstreamJoint, Carrier::DownstreamJoint];
        assert_eq!(truck.shafts[2], Carried::By(both));
    }

    #[test]
    fn one_support_after_another_is_found() {
        // Shaft 3 floats, so that shaft 2 has joint 1 only, and then shaft 1 joint 0.
        let chain = Statics::new(4, &[1, 2]);
        assert_eq!(chain.supported, [Some(1), Some(2), Some(3), Some(3)]);
        // The other way round.
        let chain = Statics::new(4, &[2, 3]);
        assert_eq!(chain.supported, [Some(1), Some(1), Some(2), Some(3)]);
    }

    #[test]
    fn what_is_not_determinate_has_a_reason() {
        let reason =
            |joints: usize, bearings: &[usize], shaft: usize| match &Statics::new(joints, bearings)
                .shafts[shaft]
            {
                Carried::Unknown(reason) => reason.clone(),
                other => panic!("{other:?}"),
            };
        assert!(reason(3, &[], 1).starts_with("shafts 1 and 2 both float, and joint 1"));
        assert!(reason(1, &[0, 1], 0).starts_with("joint 0 cannot support both its shafts, 0 and"));
        assert!(
            reason(2, &[1], 1).starts_with("shaft 1 has three supports, bearing 0 and joints 0")
        );
        assert!(reason(1, &[1, 1, 1], 1).starts_with("shaft 1 has 3 bearings"));
    }
}
