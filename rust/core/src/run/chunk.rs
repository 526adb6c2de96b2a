//! One chunk of samples: the steps of a plan over slices that fit in the first-level cache.

use crate::input::table::{ACCELERATION, SPEED, TORQUE, Table};
use crate::mechanics::moment::Pose;
use crate::number::Number;
use crate::number::atan::AtanRange;
use crate::number::float::Float;
use crate::number::storage::{Column, View, ViewMut, views, views_mut};
use crate::plan::output::{Needs, Output};
use crate::plan::route::{Route, Routes};
use crate::plan::steps::{End, JointStep, LoadStep, Plan, ShaftStep, Support};
use crate::run::fold::{Folded, GeometryIndex};
use crate::run::map::{self, MotionFormula};
use crate::run::scratch::Scratch;
use crate::run::sink::{ArrayAngleSink, SteppedAngleSink, SweepAngleSink};
use crate::sincos::array::{
    self, DoubleAngleSinCos, DriveAngles, PinLine, PinSense, SinCos, SinCosBlocks,
};
use crate::sincos::rotation::{RotatedSinCos, Rotations};
use crate::sincos::tangent_sum::TangentSum;

/// Runs the body with `at(i)`, the constants of sample `i`. The body is compiled twice: for
/// constants that all samples share, which stay in registers, and for constants per sample.
macro_rules! with_constants {
    ($geometry:expr, $constants:expr, $at:ident => $body:expr) => {{
        let constants = $constants;
        match $geometry {
            GeometryIndex::Shared(index) => {
                let shared = constants(index);
                let $at = move |_: usize| shared;
                $body
            }
            GeometryIndex::PerSample => {
                let $at = constants;
                $body
            }
        }
    }};
}

/// Computes the pins of the drive for a chunk.
#[inline(always)]
pub(crate) fn find_pins<T: Number>(
    plan: &Plan,
    drive: DriveAngles<'_>,
    group: Option<&TangentSum<T>>,
    scratch: &mut Scratch<T>,
    size: usize,
) {
    let [sine, cosine] = views_mut(&mut scratch.pins, 0, size);
    let coarse = plan.moderate;
    match (drive, group) {
        (DriveAngles::Sweep(sweep, first), Some(group)) => group.pins(sweep, first, sine, cosine),
        _ if plan.needs_sense() => array::fill_sin_cos::<PinSense, T>(drive, coarse, sine, cosine),
        _ => array::fill_sin_cos::<PinLine, T>(drive, coarse, sine, cosine),
    }
}

/// Computes sine and cosine of twice the drive angle for a chunk, or the groups that replace them.
#[inline(always)]
pub(crate) fn find_double_angles<T: Number>(
    drive: DriveAngles<'_>,
    rotations: Option<&Rotations<T>>,
    scratch: &mut Scratch<T>,
    size: usize,
) {
    let [sine, cosine] = &mut scratch.double_sin_cos;
    let (sine, cosine) = (sine.window_mut(0, size), cosine.window_mut(0, size));
    let Some(rotations) = rotations else {
        return array::fill_sin_cos::<DoubleAngleSinCos, T>(drive, false, sine, cosine);
    };
    let groups = &mut scratch.groups;
    groups.clear();
    match drive {
        DriveAngles::Sweep(sweep, first) => rotations.group(sweep, first, size, 0, groups),
        DriveAngles::Selected(sweep, samples) => {
            for (i, &sample) in samples.iter().enumerate() {
                rotations.group(sweep, sample as usize, 1, i, groups);
            }
        }
        DriveAngles::Array(_) => {}
    }
    if T::PRECISION.costs().double_angle {
        rotations.sin_cos(groups, sine, cosine);
    }
}

/// Whether any route of the chunk needs pins, and whether any needs twice the drive angle.
#[inline(always)]
pub(crate) fn sines_needed<T: Number>(
    plan: &Plan,
    routes: &Routes,
    folded: &Folded<T>,
    geometry: GeometryIndex,
) -> [bool; 2] {
    let mut needed = [plan.needs_poses(), false];
    for step in &plan.shafts {
        match folded.route(routes, step.shaft, geometry).0 {
            Route::Drive => {}
            Route::Tangent => needed[0] = true,
            Route::DoubleAngle | Route::Rotation => needed[1] = true,
        }
    }
    needed
}

/// Motion of every shaft of the plan and tilts of every joint, for one chunk.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what one chunk reads and writes")]
pub(crate) fn run_motion<T: Number, W: Float>(
    plan: &Plan,
    routes: &Routes,
    drive: DriveAngles<'_>,
    rotations: Option<&Rotations<T>>,
    folded: &Folded<T>,
    geometry: GeometryIndex,
    scratch: &mut Scratch<T>,
    planes: &mut [&mut [W]],
    size: usize,
    row_offset: usize,
) {
    let Scratch { pins, double_sin_cos, groups, rotated_pins, rates, errors, .. } = scratch;
    let pins = pins_of(pins, size);
    let double_sin_cos = pins_of(double_sin_cos, size);
    let mut errors = errors.iter_mut();
    for step in &plan.shafts {
        let mut none = Column::new(0);
        let errors =
            step.planes.get(Output::Angle).and_then(|_| errors.next()).unwrap_or(&mut none);
        let errors = errors.window_mut(row_offset, size);
        let rates = rates[step.shaft].each_mut();
        let (route, range) = folded.route(routes, step.shaft, geometry);
        #[cfg(test)]
        crate::run::taken::note(step.shaft, route, range);
        let Some(shaft) = folded.shafts[step.shaft].as_ref().filter(|_| route != Route::Drive)
        else {
            run_drive_shaft::<T, W>(step, drive, rates, planes, size);
            continue;
        };
        if route == Route::Tangent {
            let equivalents = shaft.equivalents(geometry, size);
            with_constants!(geometry, |i| equivalents.get(i), at => {
                let mut pins = pins;
                if step.shaft > 1 {
                    let [sine, cosine] = views_mut(rotated_pins, 0, size);
                    array::rotate(|i| at(i).1, pins, sine, cosine);
                    pins = pins_of(rotated_pins, size);
                }
                let at = |i| at(i).0;
                run_shaft(step, range, at, drive, pins, rates, errors, planes, size);
            });
            continue;
        }
        let double_angles = shaft.double_angles(geometry, size);
        // Each number type uses one of the two routes, so only that one is compiled for it.
        if T::PRECISION.costs().double_angle {
            if step.shaft == 1 {
                with_constants!(geometry, |i| double_angles.get(i).with_parts::<1>(), at => {
                    run_shaft(step, range, at, drive, double_sin_cos, rates, errors, planes, size);
                });
            } else {
                with_constants!(geometry, |i| double_angles.get(i), at => {
                    run_shaft(step, range, at, drive, double_sin_cos, rates, errors, planes, size);
                });
            }
        } else if let (Some(rotations), GeometryIndex::Shared(index)) = (rotations, geometry) {
            let double_angle = double_angles.get(index);
            let swept = RotatedSinCos::new(rotations, groups, double_angle.q);
            let at = |_| double_angle.with_parts::<0>();
            run_shaft(step, range, at, drive, swept, rates, errors, planes, size);
        }
    }
    for (step, poses) in plan.joints.iter().zip(&folded.poses) {
        if !step.needs_tilt {
            continue;
        }
        let poses = &poses[..geometry.count(size)];
        with_constants!(geometry, |i: usize| poses[i], at => {
            if let Some(plane) = step.planes.get(Output::TiltDriving) {
                map::formula(Pose::tilt_driving, at, pins, &mut *planes[plane]);
            }
            if let Some(plane) = step.planes.get(Output::TiltDriven) {
                map::formula(Pose::tilt_driven, at, pins, &mut *planes[plane]);
            }
        });
    }
}

#[inline(always)]
fn pins_of<T: Number>([sine, cosine]: &[Column<T>; 2], size: usize) -> SinCos<'_, T> {
    let size = if sine.is_empty() { 0 } else { size };
    SinCos { sine: sine.view(size).cut(size), cosine: cosine.view(size).cut(size) }
}

/// The angle of a shaft in a later period, from the errors that the first period stored in `slot`.
#[inline(always)]
pub(crate) fn repeat_angle<T: Number, W: Float>(
    scratch: &Scratch<T>,
    slot: usize,
    first: usize,
    drive: DriveAngles<'_>,
    out: &mut [W],
) {
    map::add_drive(drive, scratch.errors[slot].part(first, out.len()), out);
}

/// Outputs of a shaft without a bent joint before it, which turns with the drive.
#[inline(always)]
fn run_drive_shaft<T: Number, W: Float>(
    step: &ShaftStep,
    drive: DriveAngles<'_>,
    [ratio, acceleration]: [&mut Column<T>; 2],
    planes: &mut [&mut [W]],
    size: usize,
) {
    for output in Output::ALL {
        let Some(plane) = step.planes.get(output) else { continue };
        match output.row().needs {
            Needs::Motion(Some(value)) => map::constant::<T>(value, drive, &mut *planes[plane]),
            _ => map::drive_angle::<T, W>(drive, &mut *planes[plane]),
        }
    }
    if step.keep_ratio {
        map::constant::<T>(1.0, drive, ratio.view_mut(size));
    }
    if step.keep_acceleration {
        map::constant::<T>(0.0, drive, acceleration.view_mut(size));
    }
}

/// Outputs of one shaft. Each is stored directly in its plane; values that the load or a later
/// period needs as well pass through a buffer.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what one shaft reads and writes")]
fn run_shaft<T: Number, W: Float, S: MotionFormula<T>, P: SinCosBlocks<T>>(
    step: &ShaftStep,
    range: AtanRange,
    at: impl Fn(usize) -> S + Copy,
    drive: DriveAngles<'_>,
    pins: P,
    [ratio, acceleration]: [&mut Column<T>; 2],
    mut errors: ViewMut<'_, T>,
    planes: &mut [&mut [W]],
    size: usize,
) {
    if let Some(plane) = step.planes.get(Output::JerkRatio) {
        map::formula(S::jerk_ratio, at, pins, &mut *planes[plane]);
    }
    let together = step.combined_planes().filter(|_| S::MODERATE && range.is_moderate());
    if let Some([rotation, ratio, acceleration]) = together {
        let [rotation, ratio, acceleration] = planes
            .get_disjoint_mut([rotation, ratio, acceleration])
            .expect("a plan gives every output planes of its own");
        let rates: (&mut [W], &mut [W]) = (ratio, acceleration);
        match drive {
            _ if step.planes.get(Output::Angle).is_none() => {
                map::motion(range, at, pins, &mut **rotation, rates);
            }
            DriveAngles::Array(angle) => {
                let out = ArrayAngleSink(&angle[..size], rotation);
                map::motion(range, at, pins, out, rates);
            }
            DriveAngles::Sweep(sweep, first) if P::FROM_SWEEP => {
                let out = SteppedAngleSink::new(sweep, first, pins.turns(), rotation);
                map::motion(range, at, pins, out, rates);
            }
            DriveAngles::Sweep(sweep, first) if errors.is_empty() => {
                let out = SweepAngleSink(sweep, first, rotation);
                map::motion(range, at, pins, out, rates);
            }
            _ => {
                map::motion(range, at, pins, errors.reborrow(), rates);
                map::add_drive(drive, errors.view(), rotation);
            }
        }
        return;
    }
    if let Some(plane) = step.planes.get(Output::AngleError) {
        map::angle_error(range, at, pins, &mut *planes[plane]);
    }
    if let Some(plane) = step.planes.get(Output::Angle) {
        let out = &mut *planes[plane];
        match drive {
            DriveAngles::Array(angle) => {
                map::angle_error(range, at, pins, ArrayAngleSink(&angle[..size], out));
            }
            DriveAngles::Sweep(sweep, first) if P::FROM_SWEEP => {
                let out = SteppedAngleSink::new(sweep, first, pins.turns(), out);
                map::angle_error(range, at, pins, out);
            }
            DriveAngles::Sweep(sweep, first) if errors.is_empty() => {
                map::angle_error(range, at, pins, SweepAngleSink(sweep, first, out));
            }
            _ => {
                map::angle_error(range, at, pins, errors.reborrow());
                map::add_drive(drive, errors.view(), out);
            }
        }
    }
    let mut remaining =
        (step.planes.get(Output::SpeedRatio), step.planes.get(Output::AccelerationRatio));
    if step.keep_acceleration {
        map::formula(S::rates, at, pins, (ratio.view_mut(size), acceleration.view_mut(size)));
        if let Some(plane) = remaining.1.take() {
            map::copy::<T>(acceleration.view(size), &mut *planes[plane]);
        }
    } else if step.keep_ratio {
        map::formula(S::speed_ratio, at, pins, ratio.view_mut(size));
    }
    if step.keep_ratio
        && let Some(plane) = remaining.0.take()
    {
        map::copy::<T>(ratio.view(size), &mut *planes[plane]);
    }
    match remaining {
        (Some(ratio), None) => map::formula(S::speed_ratio, at, pins, &mut *planes[ratio]),
        (None, Some(acceleration)) => {
            map::formula(S::acceleration_ratio, at, pins, &mut *planes[acceleration]);
        }
        (Some(ratio), Some(acceleration)) => {
            let [ratio, acceleration] = planes
                .get_disjoint_mut([ratio, acceleration])
                .expect("a plan gives every output planes of its own");
            map::formula(S::rates, at, pins, (&mut **ratio, &mut **acceleration));
        }
        (None, None) => {}
    }
}

/// Torques and moments for one chunk, in order from the end where the torque is given.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "what one chunk reads and writes")]
pub(crate) fn run_load<T: Number, W: Float>(
    plan: &Plan,
    load: &LoadStep,
    table: &Table<'_>,
    folded: &Folded<T>,
    geometry: GeometryIndex,
    scratch: &mut Scratch<T>,
    planes: &mut [&mut [W]],
    size: usize,
) {
    let Scratch { gathered, pins, rates, power, torsion, parts, support, .. } = scratch;
    let column = |index: usize| &gathered[index][..size];
    let pins = pins_of(pins, size);
    let ratio = |shaft: usize| rates[shaft][0].view(size);
    let bent = plan.first_bent();
    let first = match load.end {
        End::Drive => None,
        End::Output => Some(load.stations[0].shaft).filter(|&shaft| shaft > bent).map(ratio),
    };
    map::spread(column(TORQUE), first, power.view_mut(size));
    for station in &load.stations {
        let absorb = |sign: f64, power: ViewMut<'_, T>| {
            if let (true, Some(inertia)) = (station.absorbs, table.inertia[station.shaft]) {
                let drive = [column(inertia), column(SPEED), column(ACCELERATION)];
                let acceleration = rates[station.shaft][1].view(size);
                map::absorb(sign, drive, ratio(station.shaft), acceleration, power);
            }
        };
        if load.end == End::Output {
            absorb(1.0, power.view_mut(size));
        }
        if let Some(plane) = station.torque {
            let torque = &mut *planes[plane];
            if station.shaft > bent {
                map::divide::<T>(power.view(size), ratio(station.shaft), torque);
            } else {
                map::copy::<T>(power.view(size), torque);
            }
        }
        if station.torsion {
            let joint = station.shaft - 1;
            let torsion = if joint > bent {
                map::divide(power.view(size), ratio(joint), torsion.view_mut(size));
                torsion.view(size)
            } else {
                power.view(size)
            };
            let step = &plan.joints[joint];
            let poses = &folded.poses[joint][..geometry.count(size)];
            with_constants!(geometry, |i: usize| poses[i], at => {
                run_bending(step, at, pins, torsion, planes);
                if step.needs_support() {
                    map::parts(at, pins, torsion, views_mut(parts, 0, size));
                }
            });
            let plane = match geometry {
                GeometryIndex::Shared(index) => poses[index].plane_axes(),
                GeometryIndex::PerSample => None,
            };
            if let Some(axes) = plane {
                let at = |i: usize| poses[i].with_axes(axes);
                with_constants!(geometry, at, at => {
                    run_moment::<true, T, W>(step, at, axes, pins, torsion, planes);
                    run_supports::<true, T, W>(step, at, axes, parts, support, planes, size);
                });
            } else {
                with_constants!(geometry, |i: usize| poses[i], at => {
                    run_moment::<false, T, W>(step, at, AXES, pins, torsion, planes);
                    run_supports::<false, T, W>(step, at, AXES, parts, support, planes, size);
                });
            }
        }
        if load.end == End::Drive {
            absorb(-1.0, power.view_mut(size));
        }
    }
}

/// Magnitudes of a joint's bending moments.
#[inline(always)]
fn run_bending<T: Number, W: Float>(
    step: &JointStep,
    at: impl Fn(usize) -> Pose<T> + Copy,
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    planes: &mut [&mut [W]],
) {
    if let Some(plane) = step.planes.get(Output::BendingDriving) {
        let out = &mut *planes[plane];
        map::size::<T>(at, Pose::bending_driving, pins, torsion, out);
    }
    if let Some(plane) = step.planes.get(Output::BendingDriven) {
        let out = &mut *planes[plane];
        map::size::<T>(at, Pose::bending_driven, pins, torsion, out);
    }
}

const AXES: [usize; 3] = [0, 1, 2];

/// The moment vector that a joint transmits, from a pose with its components in the order `axes`.
#[inline(always)]
fn run_moment<const PLANAR: bool, T: Number, W: Float>(
    step: &JointStep,
    at: impl Fn(usize) -> Pose<T>,
    axes: [usize; 3],
    pins: SinCos<'_, T>,
    torsion: View<'_, T>,
    planes: &mut [&mut [W]],
) {
    if let Some(plane) = step.planes.get(Output::Moment) {
        let out = vector(planes, plane, axes);
        map::moment::<PLANAR, T>(at, pins, torsion, out);
    }
}

/// The joint's contribution to the support moments of its shafts, from the parts of its torsion.
#[inline(always)]
fn run_supports<const PLANAR: bool, T: Number, W: Float>(
    step: &JointStep,
    at: impl Fn(usize) -> Pose<T> + Copy,
    axes: [usize; 3],
    parts: &[Column<T>; 3],
    support: &mut [Column<T>; 3],
    planes: &mut [&mut [W]],
    size: usize,
) {
    // The shaft that the load leaves is completed before the contribution to the next is stored.
    for step in step.support.iter().flatten() {
        let [sine2, cosine2, product] = views(parts, size);
        let numbers = [if step.driving { sine2 } else { cosine2 }, product];
        let [x, y, z] = axes;
        run_support::<PLANAR, 0, T, W>(step, at, x, numbers, &mut support[x], planes);
        run_support::<PLANAR, 1, T, W>(step, at, y, numbers, &mut support[y], planes);
        run_support::<PLANAR, 2, T, W>(step, at, z, numbers, &mut support[z], planes);
    }
}

/// One component of that contribution, along the axis `axis` of space.
#[inline(always)]
fn run_support<const PLANAR: bool, const COMPONENT: usize, T: Number, W: Float>(
    step: &Support,
    at: impl Fn(usize) -> Pose<T>,
    axis: usize,
    numbers: [View<'_, T>; 2],
    stored: &mut Column<T>,
    planes: &mut [&mut [W]],
) {
    let &Support { driving, plane, first, last } = step;
    let (size, none) = (numbers[0].len(), |_: usize| None);
    let out = &mut *planes[plane + axis];
    match (first, last) {
        (true, true) => map::support::<PLANAR, COMPONENT, T>(at, driving, numbers, none, out),
        (true, false) => {
            let stored = stored.view_mut(size);
            map::support::<PLANAR, COMPONENT, T>(at, driving, numbers, none, stored);
        }
        (false, _) => {
            let stored = stored.view(size).cut(size);
            let previous = |i: usize| Some(stored.get(i));
            map::support::<PLANAR, COMPONENT, T>(at, driving, numbers, previous, out);
        }
    }
}

/// The planes of a vector's components, in the order of these axes.
#[inline(always)]
fn vector<'a, W>(planes: &'a mut [&mut [W]], plane: usize, axes: [usize; 3]) -> [&'a mut [W]; 3] {
    let views = planes.get_disjoint_mut(axes.map(|axis| plane + axis));
    views.expect("a plan gives every output planes of its own").map(|plane| &mut **plane)
}
