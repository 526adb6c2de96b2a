//! Drivelines of joints as built, for one chunk: joint by joint over the samples.
//!
//! A chain of such joints has no equivalent joint. Each joint adds its angle error to those of the
//! joints before it, multiplies the rates, and turns the pins for the next joint.

use crate::mechanics::as_built::JointAsBuilt;
use crate::mechanics::moment::Pose;
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::float::Float;
use crate::number::storage::{Column, View, views, views_mut};
use crate::number::strips::{At, Same, Strips};
use crate::plan::output::Output;
use crate::plan::steps::{JointStep, Plan};
use crate::run::as_built_constants::{BuffersAsBuilt, FoldedAsBuilt, Needs, has_angle};
use crate::run::constants::{GeometryIndex, with_constants};
use crate::run::fold::Folded;
use crate::run::map;
use crate::run::motion::run_drive_shaft;
use crate::run::scratch::Scratch;
use crate::run::sines::pins_of;
use crate::run::sink::Outputs;
use crate::run::supports::run_supports;
use crate::sincos::array::{self, DriveAngles, PlainSinCos, SinCos};

/// Motion of every shaft of the plan and tilts of every joint, for one chunk.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one chunk")]
pub(crate) fn run_motion<T: Number, W: Float>(
    plan: &Plan,
    drive: DriveAngles<'_>,
    folded: &Folded<T>,
    geometry: GeometryIndex,
    scratch: &mut Scratch<T>,
    row_offset: usize,
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
    compact: bool,
) {
    let (needs, folded) = (Needs::of(plan), &folded.as_built);
    let Scratch { as_built: buffers, rates: kept_rates, errors: kept_errors, .. } = scratch;
    let [sine, cosine] = views_mut(&mut buffers.pins[0], 0, size);
    array::fill_sin_cos::<PlainSinCos, T>(drive, false, sine, cosine);
    for (joint, joints) in folded.joints.iter().enumerate() {
        let (before, after) = buffers.pins.split_at_mut(joint + 1);
        let pins = pins_of(&before[joint], size);
        let (errors, own_errors) = buffers.errors.split_at_mut(joint + 1);
        let (rates, own_rates) = buffers.rates.split_at_mut(joint + 1);
        let joints = &joints[..geometry.count(size)];
        with_constants!(compact, geometry, joints, at => {
            if needs.angle {
                let sum = errors[joint].view(size);
                add_errors(folded.ranges[joint], at, pins, sum, &mut own_errors[0]);
            }
            run_rates(needs.rates, at, pins, &rates[joint], &mut own_rates[0]);
        });
        if let (Some(next), Some(turns)) = (after.first_mut(), folded.turns.get(joint + 1)) {
            let turns = &turns[..geometry.count(size)];
            let [sine, cosine] = views_mut(next, 0, size);
            with_constants!(compact, geometry, (joints, turns), at => {
                map::over_sin_cos(
                    pins,
                    at,
                    (sine, cosine),
                    #[inline(always)]
                    |(joint, [turn_cos, turn_sin]), s, c| {
                        let (sine, cosine) = joint.driven(s, c);
                        (
                            sine.mul_add(turn_cos, cosine * turn_sin),
                            cosine.mul_add(turn_cos, -(sine * turn_sin)),
                        )
                    },
                );
            });
        }
        run_tilts(&plan.joints[joint], joints, geometry, pins, outputs, compact);
    }
    let mut kept = kept_errors.iter_mut();
    for step in &plan.shafts {
        let mut none = Column::new(0);
        let kept = step.planes.get(Output::Angle).and_then(|_| kept.next()).unwrap_or(&mut none);
        if step.shaft == 0 {
            run_drive_shaft::<T, W>(step, drive, kept_rates[0].each_mut(), outputs, size);
            continue;
        }
        let means = &folded.means[step.shaft];
        if has_angle(step) {
            let means = &means[..geometry.count(size)];
            let mut centred = if kept.is_empty() {
                buffers.centred.window_mut(0, size)
            } else {
                kept.window_mut(row_offset, size)
            };
            let errors = buffers.errors[step.shaft].view(size);
            with_constants!(compact, geometry, means, at => {
                map::over_samples(
                    size,
                    (errors, at),
                    centred.reborrow(),
                    #[inline(always)]
                    |(error, mean)| error - mean,
                );
            });
            if let Some(plane) = step.planes.get(Output::AngleError) {
                map::copy::<T>(centred.view(), outputs.plane(plane));
            }
            if let Some(plane) = step.planes.get(Output::Angle) {
                map::add_drive(drive, centred.view(), outputs.words(plane));
            }
        }
        let rates = &buffers.rates[step.shaft];
        let kept = [step.keep_ratio, step.keep_acceleration];
        for ((column, kept), out) in rates.iter().zip(kept).zip(&mut kept_rates[step.shaft]) {
            if kept {
                map::copy::<T>(column.view(size), out.view_mut(size));
            }
        }
        let outputs_of_rates = [Output::SpeedRatio, Output::AccelerationRatio, Output::JerkRatio];
        for (column, output) in rates.iter().zip(outputs_of_rates) {
            if let Some(plane) = step.planes.get(output) {
                map::copy::<T>(column.view(size), outputs.plane(plane));
            }
        }
    }
}

/// The sum of the angle errors up to a joint.
#[inline(always)]
fn add_errors<T: Number>(
    range: AtanRange,
    at: impl Strips<Value = JointAsBuilt<T>>,
    pins: SinCos<'_, T>,
    sum: View<'_, T>,
    out: &mut Column<T>,
) {
    let out = out.view_mut(pins.len());
    macro_rules! by {
        ($range:expr) => {
            map::over_sin_cos(
                pins,
                (at, sum),
                out,
                #[inline(always)]
                |(joint, sum): (JointAsBuilt<T>, T), s, c| sum + joint.angle_error($range, s, c),
            )
        };
    }
    match range {
        AtanRange::Hundredth | AtanRange::Tenth => by!(AtanRange::Tenth),
        AtanRange::Third => by!(AtanRange::Third),
        AtanRange::One | AtanRange::Any => by!(AtanRange::Any),
    }
}

/// The rates of a joint's driven shaft up to an order, from those of its driving shaft by the chain
/// rule.
#[inline(always)]
fn run_rates<T: Number>(
    order: usize,
    at: impl Strips<Value = JointAsBuilt<T>>,
    pins: SinCos<'_, T>,
    before: &[Column<T>; 3],
    own: &mut [Column<T>; 3],
) {
    let size = pins.len();
    let [ratio, acceleration, jerk] = own.each_mut();
    let [before_ratio, before_acceleration, _] = before;
    match order {
        0 => {}
        1 => map::over_sin_cos(
            pins,
            (at, before_ratio.view(size)),
            ratio.view_mut(size),
            #[inline(always)]
            |(joint, before), s, c| joint.speed_ratio(s, c) * before,
        ),
        2 => map::over_sin_cos(
            pins,
            (at, before_ratio.view(size), before_acceleration.view(size)),
            (ratio.view_mut(size), acceleration.view_mut(size)),
            #[inline(always)]
            |(joint, r, a), s, c| {
                let [ratio, acceleration, _] = joint.rates::<false>(s, c);
                (ratio * r, acceleration.mul_add(r * r, ratio * a))
            },
        ),
        _ => map::over_sin_cos(
            pins,
            (at, views(before, size)),
            [ratio.view_mut(size), acceleration.view_mut(size), jerk.view_mut(size)],
            #[inline(always)]
            |(joint, [r, a, j]), s, c| {
                let [ratio, acceleration, jerk] = joint.rates::<true>(s, c);
                let mixed = T::from_f64(3.0) * acceleration * r * a;
                [
                    ratio * r,
                    acceleration.mul_add(r * r, ratio * a),
                    jerk.mul_add(r * r * r, mixed + ratio * j),
                ]
            },
        ),
    }
}

/// The tilts of one joint.
#[inline(always)]
fn run_tilts<T: Number, W: Float>(
    step: &JointStep,
    joints: &[JointAsBuilt<T>],
    geometry: GeometryIndex,
    pins: SinCos<'_, T>,
    outputs: &mut Outputs<'_, '_, W>,
    compact: bool,
) {
    if !step.needs_tilt {
        return;
    }
    with_constants!(compact, geometry, joints, at => {
        if let Some(plane) = step.planes.get(Output::TiltDriving) {
            map::formula(JointAsBuilt::tilt_driving, at, pins, outputs.plane(plane));
        }
        if let Some(plane) = step.planes.get(Output::TiltDriven) {
            map::formula(JointAsBuilt::tilt_driven, at, pins, outputs.plane(plane));
        }
    });
}

/// The moments of one joint and its contributions to the support moments of its shafts.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one joint")]
pub(crate) fn run_joint<T: Number, W: Float>(
    joint: usize,
    step: &JointStep,
    poses: &[Pose<T>],
    folded: &FoldedAsBuilt<T>,
    geometry: GeometryIndex,
    buffers: &BuffersAsBuilt<T>,
    torsion: View<'_, T>,
    (parts, support): (&mut [Column<T>; 3], &mut [Column<T>; 3]),
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
    compact: bool,
) {
    let pins = pins_of(&buffers.pins[joint], size);
    let joints = &folded.joints[joint][..geometry.count(size)];
    with_constants!(compact, geometry, joints, at => {
        if let Some(plane) = step.planes.get(Output::BendingDriving) {
            map::over_sin_cos(
                pins,
                (at, torsion),
                outputs.plane(plane),
                #[inline(always)]
                |(joint, torsion): (JointAsBuilt<T>, T), s, c| {
                    torsion.abs() * joint.bending_driving(s, c)
                },
            );
        }
        if let Some(plane) = step.planes.get(Output::BendingDriven) {
            map::over_sin_cos(
                pins,
                (at, torsion),
                outputs.plane(plane),
                #[inline(always)]
                |(joint, torsion): (JointAsBuilt<T>, T), s, c| {
                    torsion.abs() * joint.bending_driven(s, c)
                },
            );
        }
        if step.needs_support() {
            map::over_sin_cos(
                pins,
                (at, torsion),
                views_mut(parts, 0, size),
                #[inline(always)]
                |(joint, torsion): (JointAsBuilt<T>, T), s, c| {
                    let [in_plane, out_plane, normal] = joint.moments(s, c);
                    [in_plane * torsion, out_plane * torsion, normal * torsion]
                },
            );
        }
    });
    with_constants!(compact, geometry, (joints, poses), at => {
        if let Some(plane) = step.planes.get(Output::Moment) {
            map::over_sin_cos(
                pins,
                (at, torsion),
                outputs.several([plane, plane + 1, plane + 2]),
                #[inline(always)]
                |((joint, pose), torsion): ((JointAsBuilt<T>, Pose<T>), T), s, c| {
                    let [in_plane, _, normal] = joint.moments(s, c);
                    pose.with_parts(torsion, in_plane * torsion, normal * torsion)
                },
            );
        }
    });
    if step.needs_support() {
        const AXES: [usize; 3] = [0, 1, 2];
        with_constants!(compact, geometry, poses, at => {
            run_supports::<false, T, W>(step, at, AXES, parts, support, outputs, size);
        });
    }
}
