//! Contributions of the joints to the support moments of their shafts.

use crate::mechanics::moment::Pose;
use crate::number::Number;
use crate::number::float::{Float, Real};
use crate::number::storage::{Column, View, views, views_mut};
use crate::number::strips::{Same, Strips, mapped};
use crate::plan::steps::{JointStep, Support};
use crate::run::map::{self, over_samples};
use crate::run::sink::{Outputs, Sink};

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

/// The same in axes that turn with the shafts, from [`torsion_parts::turning_supports`].
///
/// [`torsion_parts::turning_supports`]: crate::run::torsion_parts::turning_supports
#[inline(always)]
pub(super) fn run_turning_supports<T: Number, W: Float>(
    step: &JointStep,
    parts: &[Column<T>; 3],
    support: &mut [Column<T>; 3],
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
) {
    let none = Same([T::from_f64(0.0); 3]);
    for &Support { driving, plane, first, last } in step.support.iter().flatten() {
        let planes = [plane, plane + 1, plane + 2];
        let parts = views(parts, size);
        match (first, last) {
            (true, true) => turning_support(driving, parts, none, outputs.several(planes)),
            (true, false) => turning_support(driving, parts, none, views_mut(support, 0, size)),
            (false, _) => {
                let previous = views(support, size);
                turning_support(driving, parts, previous, outputs.several(planes));
            }
        }
    }
}

/// A support moment, from what one joint adds to `previous`.
#[inline(always)]
fn turning_support<T: Real>(
    driving: bool,
    [along_y, along_z, driven]: [View<'_, T>; 3],
    previous: impl Strips<Value = [T; 3]>,
    out: [impl Sink<T>; 3],
) {
    let zero = T::from_f64(0.0);
    let (share, numbers) =
        if driving { (T::from_f64(1.0), [along_y, along_z]) } else { (zero, [driven, driven]) };
    // Where the angle is NaN, so is what is zero elsewhere.
    over_samples(
        driven.len(),
        (numbers, previous),
        out,
        #[inline(always)]
        |([y, z], previous)| {
            [zero.mul_add(z, previous[0]), share.mul_add(y, previous[1]), z + previous[2]]
        },
    );
}
