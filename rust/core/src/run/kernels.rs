//! The kernels of a chunk, compiled for each instruction set.
//!
//! Each is a separate function, generic only over what its loops depend on, so that callers
//! that differ in other types share it. They are the larger part of the library.

use crate::mechanics::exact::Chains;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::number::{Number, Precision};
use crate::plan::reduction::Reduction;
use crate::plan::route::{Pins, Routes};
use crate::plan::steps::Plan;
use crate::run::as_built_constants::{BuffersAsBuilt, FoldedAsBuilt};
use crate::run::constants::GeometryIndex;
use crate::run::fold::Folded;
use crate::run::level::{Compiled, Level, compiled_for, compiled_up_to_avx2};
use crate::run::scratch::Scratch;
use crate::run::sink::Outputs;
use crate::run::{as_built, motion, sines};
use crate::sincos::array::DriveAngles;
use crate::sincos::rotation::Rotations;
use crate::sincos::tangent_sum::TangentSum;

/// A chunk of samples, and what all loops over it read.
pub(crate) struct Chunk<'a, T: Number> {
    pub(crate) level: Level,
    pub(crate) plan: &'a Plan,
    pub(crate) routes: &'a Routes,
    pub(crate) drive: DriveAngles<'a>,
    pub(crate) rotations: Option<&'a Rotations<T>>,
    pub(crate) folded: &'a Folded<T>,
    pub(crate) chains: Chains<'a>,
    pub(crate) geometry: GeometryIndex,
    pub(crate) size: usize,
    /// The first sample, counted from that of the part of the row.
    pub(crate) row_offset: usize,
    pub(crate) pins: Pins,
}

/// [`sines::find_pins`].
pub(crate) fn find_pins<T: Number + Compiled>(
    level: Level,
    plan: &Plan,
    drive: DriveAngles<'_>,
    group: Option<&TangentSum<T>>,
    scratch: &mut Scratch<T>,
    size: usize,
) {
    T::run(
        level,
        #[inline(always)]
        |_, _| sines::find_pins(plan, drive, group, scratch, size),
    );
}

/// [`sines::find_wide_pins`].
pub(crate) fn find_wide_pins<T: Number + Compiled>(
    level: Level,
    drive: DriveAngles<'_>,
    scratch: &mut Scratch<T>,
    size: usize,
) {
    T::run(
        level,
        #[inline(always)]
        |_, _| sines::find_wide_pins(drive, scratch, size),
    );
}

/// [`sines::find_double_angles`].
pub(crate) fn find_double_angles<T: Number + Compiled>(
    level: Level,
    drive: DriveAngles<'_>,
    rotations: Option<&Rotations<T>>,
    scratch: &mut Scratch<T>,
    size: usize,
) {
    T::run(
        level,
        #[inline(always)]
        |_, _| sines::find_double_angles(drive, rotations, scratch, size),
    );
}

/// [`as_built::find_motion`]. There is none in single precision.
pub(crate) fn find_motion_as_built<T: Number + Compiled>(
    level: Level,
    plan: &Plan,
    drive: DriveAngles<'_>,
    folded: &FoldedAsBuilt<T>,
    geometry: GeometryIndex,
    buffers: &mut BuffersAsBuilt<T>,
    size: usize,
) {
    match T::PRECISION {
        Precision::Single => {}
        Precision::Double => T::run(
            level,
            #[inline(always)]
            |_, _| as_built::find_motion(plan, drive, folded, geometry, buffers, size),
        ),
        // Its divisions and square roots take as long in either width.
        Precision::DoubleDouble => compiled_up_to_avx2!(
            level,
            as_built::find_motion(plan, drive, folded, geometry, buffers, size)
        ),
    }
}

/// [`as_built::store_motion`]. There is none in single precision.
pub(crate) fn store_motion_as_built<T: Number + Compiled, W: Float>(
    chunk: &Chunk<'_, T>,
    scratch: &mut Scratch<T>,
    outputs: &mut Outputs<'_, '_, W>,
) {
    if T::PRECISION != Precision::Single {
        T::run(
            chunk.level,
            #[inline(always)]
            |compact, stores| {
                as_built::store_motion(chunk, scratch, &mut outputs.by(stores), compact);
            },
        );
    }
}

/// [`motion::repeat_angle`].
pub(crate) fn repeat_angle<T: Number + Compiled, W: Float>(
    level: Level,
    scratch: &Scratch<T>,
    slot: usize,
    first: usize,
    drive: DriveAngles<'_>,
    out: &mut [W],
) {
    T::run(
        level,
        #[inline(always)]
        |_, _| motion::repeat_angle(scratch, slot, first, drive, out),
    );
}

/// [`Reduction::take`].
#[inline(never)]
pub(crate) fn reduce<W: Float>(
    level: Level,
    reduction: Reduction,
    partial: &mut DoubleDouble,
    planes: &[Vec<W>],
    size: usize,
) {
    compiled_for!(level, reduction.take(partial, planes, size));
}

/// Converts words to another type.
#[inline(never)]
pub(crate) fn convert<V: Float, W: Float>(level: Level, words: &[V], out: &mut [W]) {
    compiled_for!(level, convert_words(words, out));
}

#[inline(always)]
fn convert_words<V: Float, W: Float>(words: &[V], out: &mut [W]) {
    for (out, &word) in out.iter_mut().zip(words) {
        *out = W::near(word.into());
    }
}
