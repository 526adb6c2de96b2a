//! The motion of shafts for one chunk, over slices that fit in the first-level cache.

use std::cell::Cell;

use crate::mechanics::cross::Cross;
use crate::mechanics::double_angle::DoubleAngle;
use crate::mechanics::joint::JointConstants;
use crate::number::atan::AtanRange;
use crate::number::float::Float;
use crate::number::reduction::LargeAngleFlag;
use crate::number::storage::{Column, ViewMut, views_mut};
use crate::number::strips::{At, OneByOne, Same, Strips, mapped};
use crate::number::{Number, Precision};
use crate::plan::output::{self, Needs, Output};
use crate::plan::route::{Pins, Route};
use crate::plan::steps::{JointStep, ShaftStep};
use crate::run::angle_sink::{AngleSink, ArrayAngle, SteppedAngle, SweepAngle};
use crate::run::by_strips::{self, strip_length};
use crate::run::constants::{GeometryIndex, run_for_geometry, with_constants};
use crate::run::formula::MotionFormula;
use crate::run::kernels::Chunk;
use crate::run::level::Compiled;
use crate::run::map;
use crate::run::scratch::Scratch;
use crate::run::sines::pins_of;
use crate::run::sink::Outputs;
use crate::run::turned::{self, ChunkLines};
use crate::sincos::array::{self, DriveAngles, SinCos, SinCosBlocks};
use crate::sincos::fresh::FreshPins;
use crate::sincos::rotation::RotatedSinCos;

/// Motion of every shaft of the plan and the cross of every joint, for one chunk. Returns whether all
/// results are valid: those from pins that are not stored are not if an angle is too large for the
/// fast reduction.
#[allow(clippy::too_many_lines, reason = "the loops of a chunk, each a function of its own")]
pub(crate) fn run_motion<T: Number + Compiled, W: Float>(
    chunk: &Chunk<'_, T>,
    scratch: &mut Scratch<T>,
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let &Chunk { level, plan, routes, drive, rotations, folded, chains, geometry, size, .. } =
        chunk;
    let mut valid = true;
    let Scratch {
        pins,
        wide_pins,
        double_sin_cos,
        groups,
        rotated_pins,
        turned_pins,
        rates,
        errors,
        ..
    } = scratch;
    let pins = pins_of(pins, size);
    let double_sin_cos = pins_of(double_sin_cos, size);
    let lines = ChunkLines { chains, numbers: &folded.lines, geometry };
    let mut errors = errors.iter_mut();
    for step in &plan.shafts {
        let mut none = Column::new(0);
        let errors =
            step.planes.get(Output::Angle).and_then(|_| errors.next()).unwrap_or(&mut none);
        let mut errors = errors.window_mut(chunk.row_offset, size);
        let rates = &mut rates[step.shaft];
        let (route, range) = folded.route(routes, step.shaft, geometry);
        #[cfg(test)]
        crate::run::explain::taken::note(step.shaft, route, range);
        let Some(shaft) = folded.shafts[step.shaft].as_ref().filter(|_| route != Route::Drive)
        else {
            T::run(
                level,
                #[inline(always)]
                |_, stores| {
                    let outputs = &mut outputs.by(stores);
                    run_drive_shaft::<T, W>(step, drive, rates, outputs, size);
                },
            );
            continue;
        };
        if let (
            Pins::Fresh | Pins::Strips,
            DriveAngles::Array(angles),
            GeometryIndex::Shared(index),
        ) = (chunk.pins, drive, geometry)
        {
            let constants = shaft.equivalents(geometry, size).at(index);
            valid = T::run(
                level,
                #[inline(always)]
                |compact, stores| {
                    let outputs = &mut outputs.by(stores);
                    match chunk.pins {
                        _ if compact || T::LOW => true,
                        Pins::Strips if T::PRECISION == Precision::Single => {
                            const N: usize = strip_length(Precision::Single);
                            by_strips::run_shaft::<T, W, N>(step, range, constants, angles, outputs)
                        }
                        Pins::Strips => {
                            const N: usize = strip_length(Precision::Double);
                            by_strips::run_shaft::<T, W, N>(step, range, constants, angles, outputs)
                        }
                        _ => run_fresh(step, constants, angles, outputs),
                    }
                },
            );
            continue;
        }
        let has_own = T::LOW && shaft.has_offsets();
        let sin_cos = if has_own {
            let number = step.shaft;
            turned::find_own_pins(level, shaft, number, route, lines, drive, rotated_pins, size);
            pins_of(rotated_pins, size)
        } else if route == Route::Tangent && step.shaft > 1 {
            let equivalents = shaft.equivalents(geometry, size);
            let turns = mapped(equivalents, |(_, turn)| turn);
            run_for_geometry::<T, _>(
                level,
                geometry,
                #[inline(always)]
                |geometry, compact, _| {
                    let [sine, cosine] = views_mut(rotated_pins, 0, size);
                    with_constants!(compact, geometry, turns, at => {
                        array::rotate(at, pins, sine, cosine);
                    });
                },
            );
            pins_of(rotated_pins, size)
        } else if route == Route::Tangent {
            pins
        } else {
            double_sin_cos
        };
        // Each number type uses one of the two routes in twice the drive angle, so only that one is
        // compiled for it.
        if route == Route::Tangent {
            let joints = mapped(shaft.equivalents(geometry, size), |(joint, _)| joint);
            run_for_geometry::<T, _>(
                level,
                geometry,
                #[inline(always)]
                |geometry, compact, stores| {
                    let (errors, outputs) = (errors.reborrow(), &mut outputs.by(stores));
                    with_constants!(compact, geometry, joints, at => run_shaft(
                        step, range, at, drive, sin_cos, rates, errors, outputs, size, compact,
                    ));
                },
            );
        } else if T::PRECISION.costs().double_angle {
            let double_angles = shaft.double_angles(geometry, size);
            let double_angles = mapped(double_angles, DoubleAngle::with_parts::<1>);
            run_for_geometry::<T, _>(
                level,
                geometry,
                #[inline(always)]
                |geometry, compact, stores| {
                    let (errors, outputs) = (errors.reborrow(), &mut outputs.by(stores));
                    with_constants!(compact, geometry, double_angles, at => run_shaft(
                        step, range, at, drive, sin_cos, rates, errors, outputs, size, compact,
                    ));
                },
            );
        } else if let (Some(rotations), GeometryIndex::Shared(index)) = (rotations, geometry) {
            T::run(
                level,
                #[inline(always)]
                |compact, stores| {
                    let (errors, outputs) = (errors.reborrow(), &mut outputs.by(stores));
                    let double_angle = shaft.double_angles(geometry, size).at(index);
                    let swept = RotatedSinCos::new(rotations, groups, double_angle.q);
                    let at = Same(double_angle.with_parts::<0>());
                    run_shaft(step, range, at, drive, swept, rates, errors, outputs, size, compact);
                },
            );
        }
        if has_own && let Some(plane) = step.planes.get(Output::Angle) {
            T::run(
                level,
                #[inline(always)]
                |_, _| {
                    let words = outputs.words(plane);
                    turned::mend_angles(shaft, step.shaft, route, lines, drive, words);
                },
            );
        }
    }
    let crossed = if plan.needs_sense() { plan.joint_count } else { 0 };
    for (joint, (step, crosses)) in plan.joints[..crossed].iter().zip(&folded.crosses).enumerate() {
        if !step.needs_cross {
            continue;
        }
        let crosses = OneByOne(&crosses[..geometry.count(size)]);
        let ratio = &rates[joint][0];
        if T::LOW && joint > 0 {
            let maps = mapped(crosses, |cross| cross.matrix);
            let wide_pins = pins_of(wide_pins, size);
            turned::find_turned(level, maps, joint, lines, drive, wide_pins, turned_pins);
            let (pins, own) = (pins_of(turned_pins, size), mapped(crosses, Cross::by_own_pins));
            run_for_geometry::<T, _>(
                level,
                geometry,
                #[inline(always)]
                |geometry, compact, stores| {
                    let outputs = &mut outputs.by(stores);
                    with_constants!(compact, geometry, own, at => {
                        run_cross(step, at, pins, ratio, outputs);
                    });
                },
            );
            continue;
        }
        run_for_geometry::<T, _>(
            level,
            geometry,
            #[inline(always)]
            |geometry, compact, stores| {
                let outputs = &mut outputs.by(stores);
                with_constants!(compact, geometry, crosses, at => {
                    run_cross(step, at, pins, ratio, outputs);
                });
            },
        );
    }
    valid
}

/// The rates of the only shaft that needs pins, by a loop that finds them itself. Returns whether they
/// are valid.
#[inline(always)]
fn run_fresh<T: Number, W: Float>(
    step: &ShaftStep,
    (joint, turn): (JointConstants<T>, [T; 2]),
    angles: &[f64],
    outputs: &mut Outputs<'_, '_, W>,
) -> bool {
    let too_large = &Cell::new(LargeAngleFlag::for_quadrants());
    if step.shaft > 1 {
        let pins = FreshPins::<T, true> { angles, turn, too_large };
        store_rates(step.rates(), Same(joint), pins, outputs);
    } else {
        let pins = FreshPins::<T, false> { angles, turn, too_large };
        store_rates(step.rates(), Same(joint), pins, outputs);
    }
    !too_large.get().any()
}

/// The tilts, rates and pins of one joint's cross, from the speed ratio of its driving shaft.
#[inline(always)]
fn run_cross<T: Number, W: Float>(
    step: &JointStep,
    at: impl Strips<Value = Cross<T>>,
    pins: SinCos<'_, T>,
    ratio: &Column<T>,
    outputs: &mut Outputs<'_, '_, W>,
) {
    macro_rules! tilts {
        ($($output:ident: $formula:ident),*) => {$(
            if let Some(plane) = step.planes.get(Output::$output) {
                map::formula(Cross::$formula, at, pins, outputs.plane(plane));
            }
        )*};
    }
    macro_rules! swings {
        ($($output:ident: $formula:ident),*) => {$(
            if let Some(plane) = step.planes.get(Output::$output) {
                let ratio = ratio.view(pins.len());
                map::formula_of(Cross::$formula, at, ratio, pins, outputs.plane(plane));
            }
        )*};
    }
    macro_rules! pins_in_space {
        ($($output:ident: $formula:ident),*) => {$(
            if let Some(plane) = step.planes.get(Output::$output) {
                let out = outputs.several([plane, plane + 1, plane + 2]);
                map::formula(Cross::$formula, at, pins, out);
            }
        )*};
    }
    output::tilts!(tilts);
    output::swings!(swings);
    output::pins!(pins_in_space);
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
pub(super) fn run_drive_shaft<T: Number, W: Float>(
    step: &ShaftStep,
    drive: DriveAngles<'_>,
    [ratio, acceleration]: &mut [Column<T>; 2],
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
) {
    for output in Output::ALL {
        let Some(plane) = step.planes.get(output) else { continue };
        match output.row().needs {
            Needs::Motion(Some(value)) => map::constant::<T>(value, drive, outputs.plane(plane)),
            _ => map::drive_angle::<T, W>(drive, outputs.words(plane)),
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
/// period needs as well pass through a buffer. If `compact`, so do most angle errors, to which the
/// drive angles are added afterwards, and so do those of a sweep with a driveline per sample.
#[inline(always)]
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one shaft")]
fn run_shaft<T: Number, W: Float, S: MotionFormula<T>, P: SinCosBlocks<T>, C: Strips<Value = S>>(
    step: &ShaftStep,
    range: AtanRange,
    at: C,
    drive: DriveAngles<'_>,
    pins: P,
    [ratio, acceleration]: &mut [Column<T>; 2],
    mut errors: ViewMut<'_, T>,
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
    compact: bool,
) {
    if let Some(plane) = step.planes.get(Output::JerkRatio) {
        map::formula(S::jerk_ratio, at, pins, outputs.plane(plane));
    }
    let together = step.combined_planes().filter(|_| S::MODERATE && range.is_moderate());
    if let Some([rotation, ratio, acceleration]) = together {
        let [mut rotation, ratio, acceleration] = outputs.several([rotation, ratio, acceleration]);
        let rates = (ratio, acceleration);
        match drive {
            _ if step.planes.get(Output::Angle).is_none() => {
                map::motion(range, at, pins, rotation, rates);
            }
            DriveAngles::Array(angle) if !P::FROM_SWEEP && !compact => {
                let out = AngleSink(ArrayAngle(&angle[..size]), rotation);
                map::motion(range, at, pins, out, rates);
            }
            DriveAngles::Sweep(sweep, first) if P::FROM_SWEEP => {
                let drive = SteppedAngle::new(sweep, first, pins.turns());
                map::motion(range, at, pins, AngleSink(drive, rotation), rates);
            }
            DriveAngles::Sweep(sweep, first) if C::SHARED && errors.is_empty() && !compact => {
                let out = AngleSink(SweepAngle(sweep, first), rotation);
                map::motion(range, at, pins, out, rates);
            }
            _ => {
                map::motion(range, at, pins, errors.reborrow(), rates);
                map::add_drive(drive, errors.view(), rotation.words());
            }
        }
        return;
    }
    if let Some(plane) = step.planes.get(Output::AngleError) {
        map::angle_error(range, at, pins, outputs.plane(plane));
    }
    if let Some(plane) = step.planes.get(Output::Angle) {
        let mut out = outputs.plane(plane);
        match drive {
            DriveAngles::Array(angle) if !P::FROM_SWEEP && !compact => {
                let out = AngleSink(ArrayAngle(&angle[..size]), out);
                map::angle_error(range, at, pins, out);
            }
            DriveAngles::Sweep(sweep, first) if P::FROM_SWEEP => {
                let drive = SteppedAngle::new(sweep, first, pins.turns());
                map::angle_error(range, at, pins, AngleSink(drive, out));
            }
            DriveAngles::Sweep(sweep, first) if C::SHARED && errors.is_empty() && !compact => {
                map::angle_error(range, at, pins, AngleSink(SweepAngle(sweep, first), out));
            }
            _ => {
                map::angle_error(range, at, pins, errors.reborrow());
                map::add_drive(drive, errors.view(), out.words());
            }
        }
    }
    let mut remaining = step.rates();
    if step.keep_acceleration {
        map::formula(S::rates, at, pins, (ratio.view_mut(size), acceleration.view_mut(size)));
        if let Some(plane) = remaining.1.take() {
            map::copy::<T>(acceleration.view(size), outputs.plane(plane));
        }
    } else if step.keep_ratio {
        map::formula(S::speed_ratio, at, pins, ratio.view_mut(size));
    }
    if step.keep_ratio
        && let Some(plane) = remaining.0.take()
    {
        map::copy::<T>(ratio.view(size), outputs.plane(plane));
    }
    store_rates(remaining, at, pins, outputs);
}

/// Speed ratio and acceleration ratio, in the planes that are given.
#[inline(always)]
fn store_rates<T: Number, W: Float, S: MotionFormula<T>>(
    planes: (Option<usize>, Option<usize>),
    at: impl Strips<Value = S>,
    pins: impl SinCosBlocks<T>,
    outputs: &mut Outputs<'_, '_, W>,
) {
    match planes {
        (Some(ratio), None) => {
            map::formula(S::speed_ratio, at, pins.unsigned(), outputs.plane(ratio));
        }
        (None, Some(acceleration)) => {
            map::formula(S::acceleration_ratio, at, pins, outputs.plane(acceleration));
        }
        (Some(ratio), Some(acceleration)) => {
            let [ratio, acceleration] = outputs.several([ratio, acceleration]);
            map::formula(S::rates, at, pins, (ratio, acceleration));
        }
        (None, None) => {}
    }
}
