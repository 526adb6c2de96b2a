//! What the joints contribute to the support moments of their shafts.

use crate::mechanics::moment::Pose;
use crate::number::Number;
use crate::number::float::Float;
use crate::number::storage::{Column, View, views};
use crate::number::strips::{Same, Strips, mapped};
use crate::plan::steps::{JointStep, Support};
use crate::run::map;
use crate::run::sink::Outputs;

/// The joint's contribution to the support moments of its shafts, from the parts of its torsion.
#[inline(always)]
pub(super) fn run_supports<const PLANAR: bool, T: Number, W: Float>(
    step: &JointStep,
    at: impl Strips<Value = Pose<T>>,
    axes: [usize; 3],
    parts: &[Column<T>; 3],
    support: &mut [Column<T>; 3],
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
) {
    // The shaft that the load leaves is completed before the contribution to the next is stored.
    for step in step.support.iter().flatten() {
        let [sine2, cosine2, product] = views(parts, size);
        let numbers = [if step.driving { sine2 } else { cosine2 }, product];
        let [x, y, z] = axes;
        run_support::<PLANAR, 0, T, W>(step, at, x, numbers, &mut support[x], outputs);
        run_support::<PLANAR, 1, T, W>(step, at, y, numbers, &mut support[y], outputs);
        run_support::<PLANAR, 2, T, W>(step, at, z, numbers, &mut support[z], outputs);
    }
}

/// One component of that contribution, along the axis `axis` of space.
#[inline(always)]
fn run_support<const PLANAR: bool, const COMPONENT: usize, T: Number, W: Float>(
    step: &Support,
    at: impl Strips<Value = Pose<T>>,
    axis: usize,
    numbers: [View<'_, T>; 2],
    stored: &mut Column<T>,
    outputs: &mut Outputs<'_, '_, W>,
) {
    let &Support { driving, plane, first, last } = step;
    let (size, none) = (numbers[0].len(), Same(None));
    match (first, last) {
        (true, true) => {
            let out = outputs.plane(plane + axis);
            map::support::<PLANAR, COMPONENT, T>(at, driving, numbers, none, out);
        }
        (true, false) => {
            let stored = stored.view_mut(size);
            map::support::<PLANAR, COMPONENT, T>(at, driving, numbers, none, stored);
        }
        (false, _) => {
            let previous = mapped(stored.view(size), Some);
            let out = outputs.plane(plane + axis);
            map::support::<PLANAR, COMPONENT, T>(at, driving, numbers, previous, out);
        }
    }
}
