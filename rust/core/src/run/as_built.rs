//! Drivelines of joints as built, for one chunk: joint by joint over the samples.
//!
//! A chain of such joints has no equivalent joint. Each joint adds its angle error to those of the
//! joints before it, multiplies the rates, and turns the pins for the next joint.
//!
//! The loops are long. So each is compiled once per number type and instruction set: it stores in
//! columns, which short loops copy to planes of any kind, and a part of a chunk has one geometry.

use crate::mechanics::as_built::JointAsBuilt;
use crate::mechanics::moment::Pose;
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::float::Float;
use crate::number::storage::{Column, View, views, views_mut};
use crate::number::strips::{At, Same, Strips};
use crate::plan::output::Output;
use crate::plan::steps::{JointStep, Plan};
use crate::run::as_built_constants::{
    BuffersAsBuilt, FoldedAsBuilt, JointStage, MotionNeeds, has_angle,
};
use crate::run::constants::{GeometryIndex, with_constants};
use crate::run::kernels::Chunk;
use crate::run::map;
use crate::run::motion::run_drive_shaft;
use crate::run::scratch::Scratch;
use crate::run::sink::{Outputs, Sink};
use crate::sincos::array::{self, DriveAngles, PlainSinCos, SinCos};

/// Motion, tilts and unit moments of every joint, for one chunk.
#[inline(always)]
pub(crate) fn find_motion<T: Number>(
    plan: &Plan,
    drive: DriveAngles<'_>,
    folded: &FoldedAsBuilt<T>,
    geometry: GeometryIndex,
    buffers: &mut BuffersAsBuilt<T>,
    size: usize,
) {
    let needs = MotionNeeds::of::<T>(plan);
    let [sine, cosine] = views_mut(&mut buffers.pins[0], 0, size);
    array::fill_sin_cos::<PlainSinCos, T>(drive, false, sine, cosine);
    let (parts, length) = match geometry {
        GeometryIndex::Shared(_) => (1, size),
        GeometryIndex::PerSample => (size, 1),
    };
    for joint in 0..folded.stages.len() {
        for part in 0..parts {
            let index = if let GeometryIndex::Shared(index) = geometry { index } else { part };
            let stage = &folded.stages[joint][index];
            run_joint(joint, stage, needs, &plan.joints[joint], buffers, part * length, length);
        }
    }
}

/// One joint, over samples that share its constants.
#[inline(always)]
fn run_joint<T: Number>(
    joint: usize,
    stage: &JointStage<T>,
    needs: MotionNeeds,
    step: &JointStep,
    buffers: &mut BuffersAsBuilt<T>,
    first: usize,
    length: usize,
) {
    let BuffersAsBuilt { pins, errors, rates, moments, tilts, .. } = buffers;
    let at = Same(stage.joint);
    let (before, after) = pins.split_at_mut(joint + 1);
    let [sine, cosine] = &before[joint];
    let pins = SinCos { sine: sine.part(first, length), cosine: cosine.part(first, length) };
    let (before, own) = errors.split_at_mut(joint + 1);
    let errors = (&before[joint], &mut own[0]);
    let (before, own) = rates.split_at_mut(joint + 1);
    run_motion(stage, needs, pins, errors, (&before[joint], &mut own[0]), first);
    if let Some(next) = after.first_mut() {
        let [turn_cos, turn_sin] = stage.turn;
        let [sine, cosine] = views_mut(next, first, length);
        map::over_sin_cos(
            pins,
            at,
            (sine, cosine),
            #[inline(always)]
            |joint, s, c| {
                let (sine, cosine) = joint.driven(s, c);
                (
                    sine.mul_add(turn_cos, cosine * turn_sin),
                    cosine.mul_add(turn_cos, -(sine * turn_sin)),
                )
            },
        );
    }
    if step.needs_cross {
        let [driving, driven] = views_mut(&mut tilts[joint], first, length);
        map::formula(JointAsBuilt::tilt_driving, at, pins, driving);
        map::formula(JointAsBuilt::tilt_driven, at, pins, driven);
    }
    if step.needs_load() {
        let out = views_mut(&mut moments[joint], first, length);
        map::formula(JointAsBuilt::moments, at, pins, out);
    }
}

/// Sums of angle errors and products of rates behind a joint.
#[inline(always)]
fn run_motion<T: Number>(
    stage: &JointStage<T>,
    needs: MotionNeeds,
    pins: SinCos<'_, T>,
    (sum, errors): (&Column<T>, &mut Column<T>),
    (before, rates): (&[Column<T>; 3], &mut [Column<T>; 3]),
    first: usize,
) {
    let (length, at) = (pins.len(), Same(stage.joint));
    // Error terms take so long that one range serves all.
    let moderate = !T::LOW && stage.range <= AtanRange::Third;
    let [ratio, acceleration, jerk] = rates.each_mut();
    let before = |order: usize| before[order - 1].part(first, length);
    if needs.angle && moderate && needs.rates == 1 {
        return map::over_sin_cos(
            pins,
            (at, sum.part(first, length), before(1)),
            (errors.window_mut(first, length), ratio.window_mut(first, length)),
            #[inline(always)]
            |(joint, sum, r), s, c| {
                let [error, ratio, _] = joint.motion(s, c);
                (sum + error, ratio * r)
            },
        );
    }
    if needs.angle && moderate && needs.rates == 2 {
        let out = [errors, ratio, acceleration].map(|column| column.window_mut(first, length));
        return map::over_sin_cos(
            pins,
            (at, [sum.part(first, length), before(1), before(2)]),
            out,
            #[inline(always)]
            |(joint, [sum, r, a]), s, c| {
                let [error, ratio, acceleration] = joint.motion(s, c);
                [sum + error, ratio * r, acceleration.mul_add(r * r, ratio * a)]
            },
        );
    }
    if needs.angle {
        let (sum, out) = (sum.part(first, length), errors.window_mut(first, length));
        macro_rules! by {
            ($range:expr) => {
                map::over_sin_cos(
                    pins,
                    (at, sum),
                    out,
                    #[inline(always)]
                    |(joint, sum), s, c| sum + joint.angle_error($range, s, c),
                )
            };
        }
        if moderate {
            by!(AtanRange::Third);
        } else {
            by!(AtanRange::Any);
        }
    }
    match needs.rates {
        0 => {}
        1 if !T::LOW => map::over_sin_cos(
            pins,
            (at, before(1)),
            ratio.window_mut(first, length),
            #[inline(always)]
            |(joint, before), s, c| joint.speed_ratio(s, c) * before,
        ),
        2 if !T::LOW => map::over_sin_cos(
            pins,
            (at, before(1), before(2)),
            (ratio.window_mut(first, length), acceleration.window_mut(first, length)),
            #[inline(always)]
            |(joint, r, a), s, c| {
                let [ratio, acceleration, _] = joint.rates::<false>(s, c);
                (ratio * r, acceleration.mul_add(r * r, ratio * a))
            },
        ),
        _ => map::over_sin_cos(
            pins,
            (at, [before(1), before(2), before(3)]),
            [ratio, acceleration, jerk].map(|column| column.window_mut(first, length)),
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

/// Copies motions and tilts to their planes, and what the load or a later period needs.
#[inline(always)]
pub(crate) fn store_motion<T: Number, W: Float>(
    chunk: &Chunk<'_, T>,
    scratch: &mut Scratch<T>,
    outputs: &mut Outputs<'_, '_, W>,
    compact: bool,
) {
    const RATES: [Output; 3] = [Output::SpeedRatio, Output::AccelerationRatio, Output::JerkRatio];
    let &Chunk { plan, drive, geometry, size, row_offset, .. } = chunk;
    let folded = &chunk.folded.as_built;
    let Scratch { as_built: buffers, rates: kept_rates, errors: kept_errors, .. } = scratch;
    let mut kept = kept_errors.iter_mut();
    for step in &plan.shafts {
        let mut none = Column::new(0);
        let kept = step.planes.get(Output::Angle).and_then(|_| kept.next()).unwrap_or(&mut none);
        if step.shaft == 0 {
            run_drive_shaft::<T, W>(step, drive, &mut kept_rates[0], outputs, size);
            continue;
        }
        if has_angle(step) {
            let means = &folded.means[step.shaft][..geometry.count(size)];
            let errors = buffers.errors[step.shaft].view(size);
            if let Some(plane) = step.planes.get(Output::AngleError) {
                let out = outputs.plane(plane);
                with_constants!(compact, geometry, means, at => subtract(errors, at, out));
            }
            if let Some(plane) = step.planes.get(Output::Angle) {
                let mut centred = if kept.is_empty() {
                    buffers.centred.window_mut(0, size)
                } else {
                    kept.window_mut(row_offset, size)
                };
                with_constants!(compact, geometry, means, at => {
                    subtract(errors, at, centred.reborrow());
                });
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
        for (column, output) in rates.iter().zip(RATES) {
            if let Some(plane) = step.planes.get(output) {
                map::copy::<T>(column.view(size), outputs.plane(plane));
            }
        }
    }
    for (step, tilts) in plan.joints.iter().zip(&buffers.tilts) {
        for (column, output) in tilts.iter().zip([Output::TiltDriving, Output::TiltDriven]) {
            if let Some(plane) = step.planes.get(output) {
                map::copy::<T>(column.view(size), outputs.plane(plane));
            }
        }
    }
}

/// The angle errors without their means.
#[inline(always)]
fn subtract<T: Number>(errors: View<'_, T>, means: impl Strips<Value = T>, out: impl Sink<T>) {
    map::over_samples(
        errors.len(),
        (errors, means),
        out,
        #[inline(always)]
        |(error, mean)| error - mean,
    );
}

/// Bending moments and the moment of one joint, and the parts of its torsion that support moments
/// and forces need.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one joint")]
pub(crate) fn run_moments<T: Number, W: Float>(
    step: &JointStep,
    poses: &[Pose<T>],
    geometry: GeometryIndex,
    moments: &[Column<T>; 3],
    torsion: View<'_, T>,
    (parts, of_forces): (&mut [Column<T>; 3], &mut [Column<T>; 3]),
    outputs: &mut Outputs<'_, '_, W>,
    compact: bool,
) {
    let size = torsion.len();
    let [in_plane, out_plane, normal] = views(moments, size);
    let bending = [(Output::BendingDriving, in_plane), (Output::BendingDriven, out_plane)];
    for (output, across) in bending {
        if let Some(plane) = step.planes.get(output) {
            map::over_samples(
                size,
                (torsion, across, normal),
                outputs.plane(plane),
                #[inline(always)]
                |(torsion, across, normal)| {
                    torsion.abs() * across.mul_add(across, normal.square()).sqrt()
                },
            );
        }
    }
    if let Some(plane) = step.planes.get(Output::Moment) {
        with_constants!(compact, geometry, poses, at => {
            map::over_samples(
                size,
                (at, [torsion, in_plane, normal]),
                outputs.several([plane, plane + 1, plane + 2]),
                #[inline(always)]
                |(pose, [torsion, in_plane, normal])| {
                    pose.with_parts(torsion, in_plane * torsion, normal * torsion)
                },
            );
        });
    }
    let wanted = [(step.needs_support(), parts), (step.needs_force, of_forces)];
    for (_, parts) in wanted.into_iter().filter(|(needed, _)| *needed) {
        map::over_samples(
            size,
            (torsion, [in_plane, out_plane, normal]),
            views_mut(parts, 0, size),
            #[inline(always)]
            |(torsion, unit)| [unit[0] * torsion, unit[1] * torsion, unit[2] * torsion],
        );
    }
}
