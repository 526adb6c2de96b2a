//! The constants that a plan needs of its drivelines: one set for a row of samples, or one per
//! sample where the geometry changes with the angle.

use crate::chain::{Equivalent, Transfer};
use crate::geometry::Vector;
use crate::joint::Joint;
use crate::moment::Pose;
use crate::plan::Plan;
use crate::samples::Drivelines;
use crate::trig::AtanRange;

/// The folded drivelines of a row or chunk.
pub(crate) struct Folded {
    /// Per shaft, where the plan needs it; shaft 0 needs nothing.
    pub(crate) shafts: Vec<Option<FoldedShaft>>,
    /// Per joint, empty where the plan does not need it.
    pub(crate) poses: Vec<Vec<Pose>>,
}

/// The equivalent joints of one shaft.
#[derive(Clone)]
pub(crate) struct FoldedShaft {
    /// One for all samples, or one per sample.
    pub(crate) equivalents: Vec<Equivalent>,
    /// Whether any of them turns the drive angle.
    pub(crate) turned: bool,
    /// The inverse tangent that serves them all.
    pub(crate) range: AtanRange,
}

impl Folded {
    pub(crate) fn new(plan: &Plan) -> Self {
        let mut shafts = vec![None; plan.joint_count + 1];
        for step in plan.shafts.iter().filter(|step| step.shaft > 0) {
            let empty =
                FoldedShaft { equivalents: vec![], turned: false, range: AtanRange::Hundredth };
            shafts[step.shaft] = Some(empty);
        }
        Self { shafts, poses: vec![vec![]; plan.joint_count] }
    }

    /// Folds the drivelines at `indices`, each once up to the last shaft that the plan needs.
    pub(crate) fn fold(
        &mut self,
        plan: &Plan,
        lines: &Drivelines<'_>,
        indices: impl IntoIterator<Item = usize>,
    ) {
        self.poses.iter_mut().for_each(Vec::clear);
        self.shafts.iter_mut().flatten().for_each(|shaft| shaft.equivalents.clear());
        let n = plan.joint_count;
        for line in indices {
            let mut transfer = Transfer::default();
            for j in 0..plan.reach() {
                if j > 0 {
                    let between = line * (n - 1) + j - 1;
                    transfer.pass_shaft(lines.phases[between], lines.twists[between]);
                }
                let joint = Joint::new(lines.bends[line * n + j]);
                if plan.needs_pose(j) {
                    let shaft = line * (n + 1) + j;
                    let u_in = vector(lines.directions, shaft);
                    let u_out = vector(lines.directions, shaft + 1);
                    let normal = vector(lines.normals, line * n + j);
                    self.poses[j].push(Pose::new(&transfer, joint, u_in, u_out, normal));
                }
                transfer.pass_joint(joint);
                if let Some(shaft) = &mut self.shafts[j + 1] {
                    shaft.equivalents.push(transfer.equivalent());
                }
            }
        }
        for shaft in self.shafts.iter_mut().flatten() {
            let tangents = shaft.equivalents.iter().map(|e| e.joint.max_error_tangent());
            shaft.range = AtanRange::holding(tangents.fold(0.0, f64::max));
            shaft.turned = shaft.equivalents.iter().any(|e| e.turn_sin != 0.0);
        }
    }
}

fn vector(flat: &[f64], index: usize) -> Vector {
    Vector::from_column_slice(&flat[3 * index..3 * index + 3])
}

/// Runs the body with `at(i)`, the constants of sample `i`: compiled once for constants that all
/// samples share, so that they stay in registers, and once for constants of their own.
macro_rules! with_constants {
    ($constants:expr, $at:ident => $body:expr) => {
        if let [shared] = $constants.as_slice() {
            let shared = *shared;
            let $at = move |_: usize| shared;
            $body
        } else {
            let each = $constants.as_slice();
            let $at = move |i: usize| each[i];
            $body
        }
    };
}
pub(crate) use with_constants;
