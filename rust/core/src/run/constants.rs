//! The constants of one shaft for a series of drivelines, and which of them a chunk uses.
//!
//! Loops read them one column after the other: `map` on an array of columns may become a function
//! call, which keeps the loop from being vectorised.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use cardan_memory::Stores;

use crate::mechanics::chain::{Equivalent, Offset};
use crate::mechanics::double_angle::DoubleAngle;
use crate::mechanics::extremes::ExtremaLocator;
use crate::mechanics::joint::JointConstants;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::elementary::{atan2, hypot};
use crate::number::float::Real;
use crate::number::storage::{Column, View, columns, parts, views, views_mut};
use crate::number::strips::{At, Strips};
use crate::number::trig::Angle;
use crate::run::lanes::Lane;
use crate::run::level::{Compiled, Level, is_compact};

/// Runs the body with `at`, the constants of the samples. The body is compiled twice: for constants
/// that all samples share, which stay in registers, and for constants per sample. If `compact`, it is
/// compiled once and loads them for each sample.
macro_rules! with_constants {
    ($compact:expr, $geometry:expr, $constants:expr, $at:ident => $body:expr) => {{
        let constants = $constants;
        match $geometry {
            geometry if $compact => {
                let $at = $crate::run::constants::PerSample::new(constants, geometry);
                $body
            }
            GeometryIndex::Shared(index) => {
                let $at = Same(constants.at(index));
                $body
            }
            GeometryIndex::PerSample => {
                let $at = constants;
                $body
            }
        }
    }};
}

pub(crate) use with_constants;

/// Runs the kernel, compiled for the level. Copies for shared constants, for constants per sample and
/// for compact loops are separate functions, in which the geometry is a constant: what the compiler
/// takes to allocate registers grows faster than a function does.
#[inline(always)]
pub(crate) fn run_for_geometry<T: Compiled, R: Default>(
    level: Level,
    geometry: GeometryIndex,
    mut kernel: impl FnMut(GeometryIndex, bool, Stores) -> R,
) -> R {
    match geometry {
        _ if is_compact(level) => T::run(
            level,
            #[inline(always)]
            |compact, stores| {
                if compact { kernel(geometry, compact, stores) } else { R::default() }
            },
        ),
        GeometryIndex::Shared(index) => T::run(
            level,
            #[inline(always)]
            |compact, stores| {
                let geometry = GeometryIndex::Shared(index);
                if compact { R::default() } else { kernel(geometry, compact, stores) }
            },
        ),
        GeometryIndex::PerSample => T::run(
            level,
            #[inline(always)]
            |compact, stores| {
                let geometry = GeometryIndex::PerSample;
                if compact { R::default() } else { kernel(geometry, compact, stores) }
            },
        ),
    }
}

/// Which of the folded drivelines a chunk uses.
#[derive(Clone, Copy)]
pub(crate) enum GeometryIndex {
    /// All samples share the driveline with this index.
    Shared(usize),
    /// Each sample has its own.
    PerSample,
}

impl GeometryIndex {
    /// The number of folded drivelines that a chunk of `size` samples reads, counted from the
    /// first.
    #[inline(always)]
    pub(crate) fn count(self, size: usize) -> usize {
        match self {
            Self::Shared(index) => index + 1,
            Self::PerSample => size,
        }
    }
}

/// Constants that are loaded for each sample, even if all samples share them.
#[derive(Clone, Copy)]
pub(crate) struct PerSample<A> {
    constants: A,
    first: usize,
    step: usize,
}

impl<A> PerSample<A> {
    #[inline(always)]
    pub(crate) fn new(constants: A, geometry: GeometryIndex) -> Self {
        let (first, step) = match geometry {
            GeometryIndex::Shared(index) => (index, 0),
            GeometryIndex::PerSample => (0, 1),
        };
        Self { constants, first, step }
    }
}

impl<A: At> At for PerSample<A> {
    type Value = A::Value;

    #[inline(always)]
    fn at(&self, i: usize) -> A::Value {
        self.constants.at(self.first + self.step * i)
    }
}

impl<A: At> Strips for PerSample<A> {
    type Strip = Self;

    #[inline(always)]
    fn strip(&self, first: usize, _: usize) -> Self {
        Self { first: self.first + self.step * first, ..*self }
    }
}

/// A read-only series of constants in twice the drive angle.
#[derive(Clone, Copy)]
pub(crate) struct DoubleAngleColumns<'a, T: Real>([View<'a, T>; 5]);

impl<T: Real> At for DoubleAngleColumns<'_, T> {
    type Value = DoubleAngle<T>;

    #[inline(always)]
    fn at(&self, i: usize) -> DoubleAngle<T> {
        let [re, im, mean, complement, gain] = &self.0;
        DoubleAngle {
            q: [re.get(i), im.get(i)],
            mean: mean.get(i),
            complement: complement.get(i),
            gain: gain.get(i),
        }
    }
}

impl<T: Real> Strips for DoubleAngleColumns<'_, T> {
    type Strip = Self;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self {
        Self(parts(&self.0, first, length))
    }
}

/// A read-only series of equivalent joints: constants, and cosine and sine of the offset.
#[derive(Clone, Copy)]
pub(crate) struct EquivalentColumns<'a, T: Real>([View<'a, T>; 7]);

impl<T: Real> At for EquivalentColumns<'_, T> {
    type Value = (JointConstants<T>, [T; 2]);

    #[inline(always)]
    fn at(&self, i: usize) -> (JointConstants<T>, [T; 2]) {
        let [cos, cos2, sin2, versine, inverse_exsecant, turn_cos, turn_sin] = &self.0;
        let joint = JointConstants {
            cos: cos.get(i),
            cos2: cos2.get(i),
            sin2: sin2.get(i),
            versine: versine.get(i),
            inverse_exsecant: inverse_exsecant.get(i),
        };
        (joint, [turn_cos.get(i), turn_sin.get(i)])
    }
}

impl<T: Real> Strips for EquivalentColumns<'_, T> {
    type Strip = Self;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self {
        Self(parts(&self.0, first, length))
    }
}

/// The constants of one shaft, one set per driveline: its equivalent joint, or constants in twice
/// the drive angle while bends are moderate.
#[derive(Clone, Debug)]
pub(crate) struct FoldedShaft<T: Angle> {
    /// The range of the tangents of the angle error over all drivelines.
    pub(super) bound: AtanRange,
    double_angles: [Column<T>; 5],
    equivalents: [Column<T>; 7],
    /// Remainder and quarters of the equivalent joint's offset, for shafts with separate sines.
    offsets: [Column<DoubleDouble>; 2],
}

/// A read-only series of offsets.
#[derive(Clone, Copy)]
pub(crate) struct OffsetColumns<'a>([View<'a, DoubleDouble>; 2]);

impl At for OffsetColumns<'_> {
    type Value = Offset;

    #[inline(always)]
    fn at(&self, i: usize) -> Offset {
        let [remainder, quarters] = &self.0;
        Offset { remainder: remainder.get(i), quarters: quarters.get(i).high }
    }
}

impl Strips for OffsetColumns<'_> {
    type Strip = Self;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self {
        Self(parts(&self.0, first, length))
    }
}

impl<T: Angle> FoldedShaft<T> {
    /// Allocates the constants of `length` drivelines. If `splits`, moderate bends have their own
    /// constants. A geometry `by_sample` has one kind of constants for all samples.
    pub(super) fn new(
        bound: AtanRange,
        length: usize,
        by_sample: bool,
        splits: bool,
        has_offsets: bool,
    ) -> Self {
        let moderate = bound.is_moderate();
        let steep = !splits || !moderate;
        let double_angle = splits && (moderate || !by_sample);
        let size = |needed: bool| if needed { length } else { 0 };
        Self {
            bound,
            double_angles: columns(size(double_angle)),
            equivalents: columns(size(steep)),
            offsets: columns(size(has_offsets)),
        }
    }

    /// The range of the tangents in a chunk.
    #[inline(always)]
    pub(super) fn range(&self, geometry: GeometryIndex) -> AtanRange {
        match geometry {
            GeometryIndex::Shared(index) if self.has_double_angles() => {
                self.double_angles(geometry, 0).at(index).range().min(self.bound)
            }
            GeometryIndex::Shared(index) => self.equivalents(geometry, 0).at(index).0.range(),
            GeometryIndex::PerSample => self.bound,
        }
    }

    /// Whether the shaft turns with the drive in a chunk that shares a driveline: its joints are
    /// straight or compensate each other exactly.
    #[inline(always)]
    pub(super) fn is_straight(&self, geometry: GeometryIndex) -> bool {
        match geometry {
            GeometryIndex::Shared(index) if self.has_double_angles() => {
                let [re, im] = self.double_angles(geometry, 0).at(index).q;
                re.value() == T::Float::default() && im.value() == T::Float::default()
            }
            GeometryIndex::Shared(index) => {
                let (joint, _) = self.equivalents(geometry, 0).at(index);
                joint.versine.value() == T::Float::default()
            }
            GeometryIndex::PerSample => false,
        }
    }

    /// Whether there are constants in twice the drive angle.
    #[inline(always)]
    pub(super) fn has_double_angles(&self) -> bool {
        !self.double_angles[0].is_empty()
    }

    /// Whether the shaft has separate sines, those of the equivalent joint's input angle.
    #[inline(always)]
    pub(crate) fn has_offsets(&self) -> bool {
        !self.offsets[0].is_empty()
    }

    /// `tan²(β/2)` of an equivalent joint.
    pub(crate) fn k(
        &self,
        steep: bool,
        geometry: GeometryIndex,
        index: usize,
        size: usize,
    ) -> DoubleDouble {
        if steep {
            let (joint, _) = self.equivalents(geometry, size).at(index);
            let [versine, cos] = [joint.versine, joint.cos].map(DoubleDouble::of);
            versine / (DoubleDouble::ONE + cos)
        } else {
            DoubleDouble::of(self.double_angles(geometry, size).at(index).q[0])
        }
    }

    /// The offsets of the equivalent joints.
    #[inline(always)]
    pub(crate) fn offsets(&self, geometry: GeometryIndex, size: usize) -> OffsetColumns<'_> {
        OffsetColumns(views(&self.offsets, geometry.count(size)))
    }

    /// The constants that determine the extremes for one driveline.
    pub(crate) fn extrema_locator(&self, index: usize) -> ExtremaLocator {
        let geometry = GeometryIndex::Shared(index);
        if self.has_double_angles() {
            let [re, im]: [f64; 2] =
                self.double_angles(geometry, 0).at(index).q.map(|x| x.value().into());
            let double_offset = if self.has_offsets() {
                2.0 * self.offsets(geometry, 0).at(index).value()
            } else {
                -atan2(im, re)
            };
            return ExtremaLocator { double_offset, k: hypot(re, im) };
        }
        let (joint, turn) = self.equivalents(geometry, 0).at(index);
        let [cos, sin]: [f64; 2] = turn.map(|x| x.value().into());
        let [versine, cosine]: [f64; 2] = [joint.versine, joint.cos].map(|x| x.value().into());
        ExtremaLocator { double_offset: 2.0 * atan2(sin, cos), k: versine / (1.0 + cosine) }
    }

    /// The constants in twice the drive angle.
    #[inline(always)]
    pub(crate) fn double_angles(
        &self,
        geometry: GeometryIndex,
        size: usize,
    ) -> DoubleAngleColumns<'_, T> {
        DoubleAngleColumns(views(&self.double_angles, geometry.count(size)))
    }

    /// The equivalent joints.
    #[inline(always)]
    pub(crate) fn equivalents(
        &self,
        geometry: GeometryIndex,
        size: usize,
    ) -> EquivalentColumns<'_, T> {
        EquivalentColumns(views(&self.equivalents, geometry.count(size)))
    }

    /// Sets moderate joints on the drive shaft, whose pins need no rotation.
    #[inline(always)]
    pub(super) fn set_moderate(&mut self, start: usize, bends: &[f64]) {
        let length = bends.len();
        let [cos, cos2, sin2, versine, ..] = views_mut(&mut self.equivalents, start, length);
        let (mut cos, mut cos2) = (cos.cut(length), cos2.cut(length));
        let (mut sin2, mut versine) = (sin2.cut(length), versine.cut(length));
        for i in 0..length {
            let joint = JointConstants::<T>::of_moderate_bend(bends[i]);
            cos.set(i, joint.cos);
            cos2.set(i, joint.cos2);
            sin2.set(i, joint.sin2);
            versine.set(i, joint.versine);
        }
    }

    /// Sets equivalent joints and their offsets.
    #[inline(always)]
    pub(super) fn set_with_offsets(
        &mut self,
        start: usize,
        length: usize,
        source: &impl Lane<Equivalent<DoubleDouble>>,
    ) {
        self.set(start, length, &OwnAngle(source));
        let [remainders, quarters] = views_mut(&mut self.offsets, start, length);
        let (mut remainders, mut quarters) = (remainders.cut(length), quarters.cut(length));
        for i in 0..length {
            let offset = source.at(i).offset();
            remainders.set(i, offset.remainder);
            quarters.set(i, DoubleDouble::exact(offset.quarters));
        }
    }

    #[inline(always)]
    pub(super) fn set<L>(&mut self, start: usize, length: usize, source: &L)
    where
        L: Lane<DoubleAngle<DoubleDouble>> + Lane<Equivalent<DoubleDouble>>,
    {
        if !self.double_angles[0].is_empty() {
            let [re, im, mean, complement, gain] =
                views_mut(&mut self.double_angles, start, length);
            let (mut re, mut im) = (re.cut(length), im.cut(length));
            let (mut mean, mut complement) = (mean.cut(length), complement.cut(length));
            let mut gain = gain.cut(length);
            for i in 0..length {
                let double_angle: DoubleAngle<DoubleDouble> = source.at(i);
                let double_angle = DoubleAngle::<T>::nearest(&double_angle);
                re.set(i, double_angle.q[0]);
                im.set(i, double_angle.q[1]);
                mean.set(i, double_angle.mean);
                complement.set(i, double_angle.complement);
                gain.set(i, double_angle.gain);
            }
        }
        if self.equivalents[0].is_empty() {
            return;
        }
        let [cos, cos2, sin2, versine, inverse_exsecant, turn_cos, turn_sin] =
            views_mut(&mut self.equivalents, start, length);
        let (mut cos, mut cos2) = (cos.cut(length), cos2.cut(length));
        let (mut sin2, mut versine) = (sin2.cut(length), versine.cut(length));
        let mut inverse_exsecant = inverse_exsecant.cut(length);
        let (mut turn_cos, mut turn_sin) = (turn_cos.cut(length), turn_sin.cut(length));
        for i in 0..length {
            let equivalent: Equivalent<DoubleDouble> = source.at(i);
            let joint = JointConstants::<T>::nearest(&equivalent.joint);
            cos.set(i, joint.cos);
            cos2.set(i, joint.cos2);
            sin2.set(i, joint.sin2);
            versine.set(i, joint.versine);
            inverse_exsecant.set(i, joint.inverse_exsecant);
            turn_cos.set(i, T::from_double_double(equivalent.turn_cos));
            turn_sin.set(i, T::from_double_double(equivalent.turn_sin));
        }
    }
}

/// Equivalent joints without their offsets, for the input angle of each.
struct OwnAngle<'a, L>(&'a L);

impl<L: Lane<Equivalent<DoubleDouble>>> Lane<Equivalent<DoubleDouble>> for OwnAngle<'_, L> {
    #[inline(always)]
    fn at(&self, i: usize) -> Equivalent<DoubleDouble> {
        self.0.at(i)
    }
}

impl<L: Lane<Equivalent<DoubleDouble>>> Lane<DoubleAngle<DoubleDouble>> for OwnAngle<'_, L> {
    #[inline(always)]
    fn at(&self, i: usize) -> DoubleAngle<DoubleDouble> {
        DoubleAngle::of_equivalent(&self.0.at(i).joint)
    }
}
