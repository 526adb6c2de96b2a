//! The kernels of a chunk, compiled for each instruction set.
//!
//! Each is a separate function, generic only over what its loops depend on, so that callers
//! that differ in other types share it. They are the larger part of the library.

use std::ops::Range;

use cardan_memory::{Plane, Stores};

use crate::input::table::Table;
use crate::mechanics::exact::Chains;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::number::{Number, Precision};
use crate::plan::reduction::Reduction;
use crate::plan::route::Routes;
use crate::plan::steps::LoadStep;
use crate::plan::steps::Plan;
use crate::run::as_built_constants::{BuffersAsBuilt, FoldedAsBuilt};
use crate::run::constants::GeometryIndex;
use crate::run::fold::Folded;
use crate::run::level::{Compiled, Level, compiled_for, compiled_up_to_avx2};
use crate::run::scratch::Scratch;
use crate::run::sink::Outputs;
use crate::run::{as_built, load, motion, sines};
use crate::sincos::array::DriveAngles;
use crate::sincos::rotation::Rotations;
use crate::sincos::tangent_sum::TangentSum;

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

/// [`motion::run_motion`].
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one chunk")]
pub(crate) fn run_motion<T: Number + Compiled, W: Float>(
    level: Level,
    plan: &Plan,
    routes: &Routes,
    drive: DriveAngles<'_>,
    rotations: Option<&Rotations<T>>,
    folded: &Folded<T>,
    chains: Chains<'_>,
    geometry: GeometryIndex,
    scratch: &mut Scratch<T>,
    planes: &mut [Plane<'_, W>],
    window: Range<usize>,
    row_offset: usize,
    fresh: bool,
) -> bool {
    let outputs = &mut Outputs::new(planes, &window, Stores::ordinary(), drive);
    motion::run_motion(
        level,
        plan,
        routes,
        drive,
        rotations,
        folded,
        chains,
        geometry,
        scratch,
        outputs,
        window.len(),
        row_offset,
        fresh,
    )
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
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one chunk")]
pub(crate) fn store_motion_as_built<T: Number + Compiled, W: Float>(
    level: Level,
    plan: &Plan,
    drive: DriveAngles<'_>,
    folded: &FoldedAsBuilt<T>,
    geometry: GeometryIndex,
    scratch: &mut Scratch<T>,
    planes: &mut [Plane<'_, W>],
    window: Range<usize>,
    row_offset: usize,
) {
    if T::PRECISION != Precision::Single {
        T::run(
            level,
            #[inline(always)]
            |compact, stores| {
                let size = window.len();
                let outputs = &mut Outputs::new(planes, &window, stores, drive);
                as_built::store_motion(
                    plan, drive, folded, geometry, scratch, row_offset, outputs, size, compact,
                );
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

/// [`load::run_load`].
#[allow(clippy::too_many_arguments, reason = "inputs and outputs of one chunk")]
pub(crate) fn run_load<T: Number + Compiled, W: Float>(
    level: Level,
    plan: &Plan,
    load: &LoadStep,
    table: &Table<'_>,
    drive: DriveAngles<'_>,
    folded: &Folded<T>,
    chains: Chains<'_>,
    geometry: GeometryIndex,
    scratch: &mut Scratch<T>,
    planes: &mut [Plane<'_, W>],
    window: Range<usize>,
    fresh: bool,
) -> bool {
    let outputs = &mut Outputs::new(planes, &window, Stores::ordinary(), drive);
    let size = window.len();
    load::run_load(
        level, plan, load, table, drive, folded, chains, geometry, scratch, outputs, size, fresh,
    )
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
