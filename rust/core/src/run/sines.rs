//! The sines and cosines that one chunk needs.

use crate::input::table::{ANGLE, Table, contiguous};
use crate::number::storage::{Column, views_mut};
use crate::number::{Number, Precision};
use crate::plan::route::{Pins, Route, Routes};
use crate::plan::steps::Plan;
use crate::run::by_strips::strip_length;
use crate::run::constants::{FoldedShaft, GeometryIndex};
use crate::run::fold::Folded;
use crate::run::level::{Level, has_wide_registers, is_compact};
use crate::run::scratch::Scratch;
use crate::sincos::array::{
    self, DoubleAngleSinCos, DriveAngles, PinLine, PinSense, SinCos, WideSinCos,
};
use crate::sincos::rotation::Rotations;
use crate::sincos::tangent_sum::TangentSum;

/// The angles of a chunk, which begin at the first element of `place`, follow in steps of the second,
/// and are as many as the third; gathered in the buffers if they are not contiguous.
pub(crate) fn drive_angles<'d>(
    table: &'d Table<'_>,
    selected: Option<&'d [f64]>,
    place: [usize; 3],
    [angles, error_terms]: &'d mut [Vec<f64>; 2],
) -> DriveAngles<'d> {
    match (&table.sweep, selected) {
        (Some(sweep), Some(selected)) => DriveAngles::Selected(sweep, selected),
        (Some(sweep), None) => DriveAngles::Sweep(sweep, place[0]),
        (None, _) => {
            let angles = contiguous(table.columns[ANGLE].data, place, angles);
            match table.error_terms {
                Some(terms) => DriveAngles::Sums(angles, contiguous(terms, place, error_terms)),
                None => DriveAngles::Array(angles),
            }
        }
    }
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
    scratch.allocate_pins();
    let [sine, cosine] = views_mut(&mut scratch.pins, 0, size);
    let coarse = plan.moderate;
    match (drive, group) {
        (DriveAngles::Sweep(sweep, first), Some(group)) => group.pins(sweep, first, sine, cosine),
        _ if plan.needs_sense() => array::fill_sin_cos::<PinSense, T>(drive, coarse, sine, cosine),
        _ => array::fill_sin_cos::<PinLine, T>(drive, coarse, sine, cosine),
    }
}

/// Computes the pins that the load reads with all their digits.
#[inline(always)]
pub(crate) fn find_wide_pins<T: Number>(
    drive: DriveAngles<'_>,
    scratch: &mut Scratch<T>,
    size: usize,
) {
    if T::LOW {
        let [sine, cosine] = views_mut(&mut scratch.wide_pins, 0, size);
        array::fill_sin_cos::<WideSinCos, T>(drive, false, sine, cosine);
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
        DriveAngles::Array(_) | DriveAngles::Sums(..) => {}
    }
    if T::PRECISION.costs().double_angle {
        rotations.sin_cos(groups, sine, cosine);
    }
}

/// Where the loops of a chunk take their pins from. A torque that all samples share is `even`.
///
/// Loops that find pins themselves are short, so that a core overlaps their iterations. A longer one
/// is worth its instructions where registers are wide. Numbers with error terms take more time than
/// storing pins does.
#[inline(always)]
pub(crate) fn pins<T: Number>(
    level: Level,
    plan: &Plan,
    routes: &Routes,
    folded: &Folded<T>,
    geometry: GeometryIndex,
    size: usize,
    even: bool,
) -> Pins {
    if !routes.one_use || plan.is_as_built() || is_compact(level) || T::LOW {
        return Pins::Stored;
    }
    let is_single = T::PRECISION == Precision::Single;
    let has_strips = size >= strip_length(T::PRECISION) && (plan.moderate || !is_single);
    let mut moving = plan.moving();
    match (moving.next(), moving.next(), plan.any_joint.pin_loops) {
        (None, _, 1) if !plan.needs_sense() => {
            let short = even && plan.joints[0].is_moment();
            match is_single {
                true if short && has_strips => Pins::Strips,
                false if short || has_wide_registers(level) => Pins::Fresh,
                _ => Pins::Stored,
            }
        }
        (Some(step), None, 0) => {
            let (route, range) = folded.route(routes, step.shaft, geometry);
            let by_strips = step.rotates() || is_single;
            if route != Route::Tangent || !step.has_one_loop(range.is_moderate()) {
                Pins::Stored
            } else if !by_strips {
                Pins::Fresh
            } else if has_strips {
                Pins::Strips
            } else {
                Pins::Stored
            }
        }
        _ => Pins::Stored,
    }
}

/// Which sines and cosines of the drive a chunk needs.
pub(crate) struct NeededSines {
    pub(crate) pins: bool,
    pub(crate) wide_pins: bool,
    pub(crate) double_angles: bool,
}

/// The sines and cosines that crosses, load and routes of the chunk need. Motion and crosses read
/// the same pins with a load as without it, so that their bits do not depend on it.
#[inline(always)]
pub(crate) fn sines_needed<T: Number>(
    plan: &Plan,
    routes: &Routes,
    folded: &Folded<T>,
    geometry: GeometryIndex,
) -> NeededSines {
    if plan.is_as_built() {
        return NeededSines { pins: false, wide_pins: false, double_angles: false };
    }
    let wide_pins = T::LOW && plan.needs_wide_pins();
    let poses = if wide_pins { plan.needs_first_cross() } else { plan.needs_poses() };
    let mut needed = NeededSines { pins: poses, wide_pins, double_angles: false };
    for step in &plan.shafts {
        let own = folded.shafts[step.shaft].as_ref().is_some_and(FoldedShaft::has_offsets);
        match folded.route(routes, step.shaft, geometry).0 {
            _ if own => {}
            Route::Drive => {}
            Route::Tangent => needed.pins = true,
            Route::DoubleAngle | Route::Rotation => needed.double_angles = true,
        }
    }
    needed
}

/// The first `size` sines and cosines of two columns; none if the columns are empty.
#[inline(always)]
pub(super) fn pins_of<T: Number>([sine, cosine]: &[Column<T>; 2], size: usize) -> SinCos<'_, T> {
    let size = if sine.is_empty() { 0 } else { size };
    SinCos { sine: sine.view(size).cut(size), cosine: cosine.view(size).cut(size) }
}
