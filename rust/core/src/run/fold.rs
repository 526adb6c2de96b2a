//! Folding: the constants that a plan needs of its drivelines.
//!
//! Many drivelines are folded together, joint by joint over all of them, so that folding vectorises
//! like the kernels. This serves batches, and geometries that change with the angle.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use crate::error::Result;
use crate::input::drivelines::Drivelines;
use crate::mechanics::chain::{self, Complex, Equivalent, Transfer};
use crate::mechanics::double_angle::DoubleAngle;
use crate::mechanics::extremes::ExtremaLocator;
use crate::mechanics::geometry::Vector;
use crate::mechanics::joint::{Joint, JointConstants};
use crate::mechanics::moment::Pose;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::storage::{Column, View, columns, views, views_mut};
use crate::number::trig::{self, Angle};
use crate::number::{Number, Precision};
use crate::plan::route::{Route, Routes};
use crate::plan::steps::Plan;
use crate::run::level::{Level, compiled_for};

/// The number of drivelines that are folded together: their maps stay in the first-level cache.
const LANES: usize = 64;

/// The constants of a series of drivelines.
#[derive(Clone, Debug)]
pub(crate) struct Folded<T: Angle> {
    /// Per shaft, if the plan needs it; shaft 0 needs none.
    pub(crate) shafts: Vec<Option<FoldedShaft<T>>>,
    /// Per joint; empty if the plan does not need it.
    pub(crate) poses: Vec<Vec<Pose<T>>>,
    maps: Maps,
    turns: Turns,
}

/// The constants of one shaft, one set per driveline: its equivalent joint, or constants in twice
/// the drive angle while bends are moderate.
#[derive(Clone, Debug)]
pub(crate) struct FoldedShaft<T: Angle> {
    /// The range of the tangents of the angle error over all drivelines.
    bound: AtanRange,
    double_angles: [Column<T>; 5],
    equivalents: [Column<T>; 7],
}

impl<T: Angle> FoldedShaft<T> {
    /// Allocates the constants of `length` drivelines. If `splits`, moderate bends have their own
    /// constants. A geometry `by_sample` has one kind of constants for all samples.
    fn new(bound: AtanRange, length: usize, by_sample: bool, splits: bool) -> Self {
        let moderate = bound.is_moderate();
        let steep = !splits || !moderate;
        let double_angle = splits && (moderate || !by_sample);
        let size = |needed: bool| if needed { length } else { 0 };
        Self {
            bound,
            double_angles: columns(size(double_angle)),
            equivalents: columns(size(steep)),
        }
    }

    /// The range of the tangents in a chunk.
    #[inline(always)]
    fn range(&self, geometry: GeometryIndex) -> AtanRange {
        match geometry {
            GeometryIndex::Shared(index) if self.has_double_angles() => {
                self.double_angles(geometry, 0).get(index).range().min(self.bound)
            }
            GeometryIndex::Shared(index) => self.equivalents(geometry, 0).get(index).0.range(),
            GeometryIndex::PerSample => self.bound,
        }
    }

    /// Whether there are constants in twice the drive angle.
    #[inline(always)]
    fn has_double_angles(&self) -> bool {
        !self.double_angles[0].is_empty()
    }

    /// The constants that determine the extremes for one driveline.
    pub(crate) fn extrema_locator(&self, index: usize) -> ExtremaLocator {
        let geometry = GeometryIndex::Shared(index);
        if self.has_double_angles() {
            let [re, im]: [f64; 2] =
                self.double_angles(geometry, 0).get(index).q.map(|x| x.value().into());
            return ExtremaLocator { double_offset: -im.atan2(re), k: re.hypot(im) };
        }
        let (joint, turn) = self.equivalents(geometry, 0).get(index);
        let [cos, sin]: [f64; 2] = turn.map(|x| x.value().into());
        let [versine, cosine]: [f64; 2] = [joint.versine, joint.cos].map(|x| x.value().into());
        ExtremaLocator { double_offset: 2.0 * sin.atan2(cos), k: versine / (1.0 + cosine) }
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
    fn set_moderate(&mut self, start: usize, bends: &[f64]) {
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

    #[inline(always)]
    fn set<L>(&mut self, start: usize, length: usize, source: &L)
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

/// The constants of one driveline, prepared for any number of runs over arrays of angles.
#[derive(Clone, Debug)]
pub struct FoldedDriveline(pub(crate) FoldedAs);

/// The constants, by the arithmetic of the runs.
#[derive(Clone, Debug)]
pub(crate) enum FoldedAs {
    Single(Folded<f32>),
    Double(Folded<f64>),
    DoubleDouble(Folded<DoubleDouble>),
}

impl Plan {
    /// Folds the first of the drivelines, once for all runs.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together, or no driveline.
    pub fn fold(&self, lines: &Drivelines<'_>, precision: Precision) -> Result<FoldedDriveline> {
        lines.check(self.joint_count)?;
        Ok(FoldedDriveline(match precision {
            Precision::Single => FoldedAs::Single(fold_first(self, lines)),
            Precision::Double => FoldedAs::Double(fold_first(self, lines)),
            Precision::DoubleDouble => FoldedAs::DoubleDouble(fold_first(self, lines)),
        }))
    }
}

/// Folds the first driveline for arrays of angles.
pub(crate) fn fold_first<T: Number>(plan: &Plan, lines: &Drivelines<'_>) -> Folded<T> {
    let mut folded = Folded::new(plan, 1, false, &Routes::of_arrays(plan, T::PRECISION));
    compiled_for!(Level::new(), folded.fold(plan, lines, 1, |_| 0));
    folded
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

/// A read-only series of constants in twice the drive angle.
#[derive(Clone, Copy)]
pub(crate) struct DoubleAngleColumns<'a, T: Real>([View<'a, T>; 5]);

impl<T: Real> DoubleAngleColumns<'_, T> {
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> DoubleAngle<T> {
        let [re, im, mean, complement, gain] = self.0.each_ref().map(|view| view.get(i));
        DoubleAngle { q: [re, im], mean, complement, gain }
    }
}

/// A read-only series of equivalent joints.
#[derive(Clone, Copy)]
pub(crate) struct EquivalentColumns<'a, T: Real>([View<'a, T>; 7]);

impl<T: Real> EquivalentColumns<'_, T> {
    /// The constants of the joint, and cosine and sine of its offset.
    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> (JointConstants<T>, [T; 2]) {
        let [cos, cos2, sin2, versine, inverse_exsecant, turn_cos, turn_sin] =
            self.0.each_ref().map(|view| view.get(i));
        (JointConstants { cos, cos2, sin2, versine, inverse_exsecant }, [turn_cos, turn_sin])
    }
}

/// The maps of the drivelines that are folded together, up to the current joint.
#[derive(Clone, Debug)]
struct Maps {
    a: [Column<DoubleDouble>; 2],
    b: [Column<DoubleDouble>; 2],
    complement: Column<DoubleDouble>,
}

impl Maps {
    fn new(lanes: usize) -> Self {
        Self { a: columns(lanes), b: columns(lanes), complement: Column::new(lanes) }
    }

    #[inline(always)]
    fn read(&self, length: usize) -> MapsView<'_> {
        let [a_re, a_im] = views(&self.a, length);
        let [b_re, b_im] = views(&self.b, length);
        MapsView([a_re, a_im, b_re, b_im, self.complement.view(length)])
    }

    /// Applies a step to each map.
    #[inline(always)]
    fn update(&mut self, length: usize, step: &impl Step) {
        let ([a_re, a_im], [b_re, b_im]) =
            (views_mut(&mut self.a, 0, length), views_mut(&mut self.b, 0, length));
        let (mut a_re, mut a_im) = (a_re.cut(length), a_im.cut(length));
        let (mut b_re, mut b_im) = (b_re.cut(length), b_im.cut(length));
        let mut complement = self.complement.view_mut(length).cut(length);
        for i in 0..length {
            let mut transfer = Transfer {
                a: Complex::new(a_re.get(i), a_im.get(i)),
                b: Complex::new(b_re.get(i), b_im.get(i)),
                complement: complement.get(i),
            };
            step.take(i, &mut transfer);
            a_re.set(i, transfer.a.re);
            a_im.set(i, transfer.a.im);
            b_re.set(i, transfer.b.re);
            b_im.set(i, transfer.b.im);
            complement.set(i, transfer.complement);
        }
    }
}

// The work of a lane is a method and not a closure: a closure of this size would be compiled as a
// separate function, without the instruction set of the loop that calls it.

/// A value for each lane.
trait Lane<T> {
    fn at(&self, i: usize) -> T;
}

/// A change of the map of each lane.
trait Step {
    fn take(&self, i: usize, transfer: &mut Transfer);
}

/// A read-only view of the maps.
struct MapsView<'a>([View<'a, DoubleDouble>; 5]);

impl Lane<Transfer> for MapsView<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> Transfer {
        let [a_re, a_im, b_re, b_im, complement] = self.0.each_ref().map(|view| view.get(i));
        Transfer { a: Complex::new(a_re, a_im), b: Complex::new(b_re, b_im), complement }
    }
}

impl Lane<DoubleAngle<DoubleDouble>> for MapsView<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> DoubleAngle<DoubleDouble> {
        let transfer: Transfer = self.at(i);
        transfer.double_angle()
    }
}

impl Lane<Equivalent<DoubleDouble>> for MapsView<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> Equivalent<DoubleDouble> {
        let transfer: Transfer = self.at(i);
        transfer.equivalent()
    }
}

/// First joints, from their bends.
struct FirstJoint<'a>(&'a [f64]);

impl Lane<DoubleAngle<DoubleDouble>> for FirstJoint<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> DoubleAngle<DoubleDouble> {
        DoubleAngle::of_joint(self.0[i])
    }
}

impl Lane<Equivalent<DoubleDouble>> for FirstJoint<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> Equivalent<DoubleDouble> {
        Equivalent::of_joint(Joint::with_error_terms(self.0[i]))
    }
}

/// Returns to the drive shaft.
struct Reset;

impl Step for Reset {
    #[inline(always)]
    fn take(&self, _: usize, transfer: &mut Transfer) {
        *transfer = Transfer::default();
    }
}

/// Appends a joint, given its bend.
struct PassJoint<'a>(&'a [f64]);

impl Step for PassJoint<'_> {
    #[inline(always)]
    fn take(&self, i: usize, transfer: &mut Transfer) {
        transfer.pass_joint(&Joint::with_error_terms(self.0[i]));
    }
}

/// Appends a shaft, given its turn.
struct PassShaft<'a>([View<'a, DoubleDouble>; 2]);

impl Step for PassShaft<'_> {
    #[inline(always)]
    fn take(&self, i: usize, transfer: &mut Transfer) {
        let [re, im] = self.0.each_ref().map(|view| view.get(i));
        transfer.pass_shaft(Complex::new(re, im));
    }
}

/// The turns of one intermediate shaft, one per driveline.
#[derive(Clone, Debug)]
struct Turns([Column<DoubleDouble>; 2]);

impl Turns {
    #[inline(always)]
    fn find(&mut self, phases: &[f64], twists: &[f64]) {
        let length = phases.len();
        let (phases, twists) = (&phases[..length], &twists[..length]);
        let [re, im] = views_mut(&mut self.0, 0, length);
        let (mut re, mut im) = (re.cut(length), im.cut(length));
        let far = trig::any_too_large(phases.iter().chain(twists).copied());
        for i in 0..length {
            let turn = chain::near_shaft_turn(phases[i], twists[i]);
            re.set(i, turn.re);
            im.set(i, turn.im);
        }
        if far {
            for i in 0..length {
                let turn = chain::shaft_turn(phases[i], twists[i]);
                re.set(i, turn.re);
                im.set(i, turn.im);
            }
        }
    }

    #[inline(always)]
    fn read(&self, length: usize) -> PassShaft<'_> {
        PassShaft(views(&self.0, length))
    }
}

impl<T: Angle> Folded<T> {
    /// Allocates the constants of `longest` drivelines, of different rows or of different samples.
    pub(crate) fn new(plan: &Plan, longest: usize, by_sample: bool, routes: &Routes) -> Self {
        let lanes = if plan.is_joint() { 0 } else { LANES.min(longest) };
        let (maps, turns) = (Maps::new(lanes), Turns(columns(lanes)));
        let mut shafts: Vec<_> = (0..=plan.joint_count).map(|_| None).collect();
        for step in plan.shafts.iter().filter(|step| step.shaft > 0) {
            let bound = plan.range(step.shaft);
            shafts[step.shaft] = Some(FoldedShaft::new(bound, longest, by_sample, routes.splits()));
        }
        Self { shafts, poses: vec![vec![]; plan.joint_count], maps, turns }
    }

    /// The route of a shaft in a chunk with this geometry, and its range of tangents.
    #[inline(always)]
    pub(crate) fn route(
        &self,
        routes: &Routes,
        shaft: usize,
        geometry: GeometryIndex,
    ) -> (Route, AtanRange) {
        let constants = self.shafts[shaft].as_ref().filter(|_| routes.is_bent(shaft));
        let range = constants.map_or(AtanRange::Hundredth, |shaft| shaft.range(geometry));
        (routes.of(shaft, range), range)
    }

    /// Folds `count` drivelines with the indices `line_of(i)`. Each is folded once, up to the last
    /// shaft that the plan needs.
    #[inline(always)]
    pub(crate) fn fold(
        &mut self,
        plan: &Plan,
        lines: &Drivelines<'_>,
        count: usize,
        line_of: impl Fn(usize) -> usize,
    ) {
        self.poses.iter_mut().for_each(Vec::clear);
        for start in (0..count).step_by(LANES) {
            let length = LANES.min(count - start);
            self.fold_lanes(plan, lines, start, length, |i| line_of(start + i));
        }
    }

    #[inline(always)]
    fn fold_lanes(
        &mut self,
        plan: &Plan,
        lines: &Drivelines<'_>,
        start: usize,
        length: usize,
        line_of: impl Fn(usize) -> usize,
    ) {
        let n = plan.joint_count;
        let Self { shafts, poses, maps, turns } = self;
        let mut bends = [0.0; LANES];
        let (mut phases, mut twists) = ([0.0; LANES], [0.0; LANES]);
        let first = line_of(0);
        let contiguous = (0..length).fold(true, |so, i| so & (line_of(i) == first + i));
        let gather = |data: &[f64], each: usize, j: usize, out: &mut [f64]| {
            if each == 1 && contiguous {
                out.copy_from_slice(&data[first..first + out.len()]);
                return;
            }
            for (i, x) in out.iter_mut().enumerate() {
                *x = data[line_of(i) * each + j];
            }
        };
        for j in 0..plan.reach() {
            gather(lines.bends, n, j, &mut bends[..length]);
            let bends = &bends[..length];
            if j == 0 && !plan.is_joint() {
                maps.update(length, &Reset);
            } else if j > 0 {
                gather(lines.phases, n - 1, j - 1, &mut phases[..length]);
                gather(lines.twists, n - 1, j - 1, &mut twists[..length]);
                turns.find(&phases[..length], &twists[..length]);
                maps.update(length, &turns.read(length));
            }
            if plan.needs_pose(j) {
                let maps = maps.read(length);
                poses[j].extend((0..length).map(|i| {
                    let line = line_of(i);
                    let u_in = vector(lines.directions, line * (n + 1) + j);
                    let normal = vector(lines.normals, line * n + j);
                    let joint = Joint::with_error_terms(bends[i]);
                    Pose::new(&maps.at(i), &joint, u_in, normal)
                }));
            }
            if j == 0
                && let Some(shaft) = &mut shafts[1]
            {
                if shaft.bound.is_moderate() && !shaft.has_double_angles() {
                    shaft.set_moderate(start, bends);
                } else {
                    shaft.set(start, length, &FirstJoint(bends));
                }
            }
            if plan.reach() == 1 {
                return;
            }
            maps.update(length, &PassJoint(bends));
            if j > 0
                && let Some(shaft) = &mut shafts[j + 1]
            {
                shaft.set(start, length, &maps.read(length));
            }
        }
    }
}

fn vector(flat: &[f64], index: usize) -> Vector {
    Vector::from_column_slice(&flat[3 * index..3 * index + 3])
}
