//! Folding: the constants that a plan needs of its drivelines.
//!
//! Many drivelines are folded together, joint by joint over all of them, so that folding vectorises
//! like the kernels. This serves batches, and geometries that change with the angle.

use crate::error::Result;
use crate::input::drivelines::Drivelines;
use crate::mechanics::chain::Transfer;
use crate::mechanics::cross::Cross;
use crate::mechanics::exact::{ExactMap, ExactMaps, To};
use crate::mechanics::frame::Frame;
use crate::mechanics::geometry::Vector;
use crate::mechanics::joint::Joint;
use crate::mechanics::moment::Pose;
use crate::mechanics::turning::{TurnMatrix, Turning};
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::trig::Angle;
use crate::number::{Number, Precision, reduction, series};
use crate::plan::request::Axes;
use crate::plan::route::{Route, Routes};
use crate::plan::steps::{JointStep, Plan};
use crate::run::as_built_constants::FoldedAsBuilt;
use crate::run::constants::{FoldedShaft, GeometryIndex};
use crate::run::forces::FoldedForces;
use crate::run::lanes::{FirstJoint, LANES, Lane, Maps, PassJoint, Reset, Turns};
use crate::run::level::{Level, compiled_for, compiled_up_to_avx2};

/// The constants of a series of drivelines.
#[derive(Clone, Debug)]
pub(crate) struct Folded<T: Angle> {
    /// Per shaft, if the plan needs it; shaft 0 needs none.
    pub(crate) shafts: Vec<Option<FoldedShaft<T>>>,
    /// Per joint, for its moments and for its cross; empty if the plan does not need them.
    pub(crate) poses: Vec<Vec<Pose<T>>>,
    pub(crate) crosses: Vec<Vec<Cross<T>>>,
    /// Per joint: cosine and sine of its driving shaft's phase, if support moments turn with it.
    pub(crate) phases: Vec<Vec<[T; 2]>>,
    /// The number of each driveline in the batch, if numbers have error terms.
    pub(crate) lines: Vec<usize>,
    /// Per shaft; empty unless the load needs its speed with all digits of a double-double.
    pub(crate) turnings: Vec<Vec<Turning<T>>>,
    /// The coefficients of forces, if any are requested.
    pub(crate) forces: FoldedForces<T>,
    /// The constants of joints as built, if the drivelines have deviations.
    pub(crate) as_built: FoldedAsBuilt<T>,
    /// The frames of the drivelines that are folded together, if vectors need their error terms.
    frames: Vec<Frame>,
    maps: Maps,
    turns: Turns,
}

/// The constants of one driveline, prepared for any number of runs over arrays of angles.
#[derive(Clone, Debug)]
pub struct FoldedDriveline(pub(crate) FoldedAs);

/// The constants, by the arithmetic of the runs.
#[derive(Clone, Debug)]
pub(crate) enum FoldedAs {
    #[cfg(feature = "single")]
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
        self.check_lines(lines)?;
        Ok(FoldedDriveline(match self.computed_in(precision) {
            #[cfg(feature = "single")]
            Precision::Single => FoldedAs::Single(fold_first(self, lines)),
            Precision::DoubleDouble => FoldedAs::DoubleDouble(fold_first(self, lines)),
            _ => FoldedAs::Double(fold_first(self, lines)),
        }))
    }
}

/// Folds the first driveline for arrays of angles.
pub(crate) fn fold_first<T: Number>(plan: &Plan, lines: &Drivelines<'_>) -> Folded<T> {
    let mut folded = Folded::new(plan, 1, false, &Routes::of_arrays(plan, T::PRECISION));
    folded.fold(Level::new(), plan, lines, &[0]);
    folded
}

impl<T: Angle> Folded<T> {
    /// Allocates the constants of `longest` drivelines, of different rows or of different samples.
    pub(crate) fn new(plan: &Plan, longest: usize, by_sample: bool, routes: &Routes) -> Self {
        let lanes = if plan.is_joint() { 0 } else { LANES.min(longest) };
        let (maps, turns) = (Maps::new(lanes), Turns::new(lanes));
        let mut shafts: Vec<_> = (0..=plan.joint_count).map(|_| None).collect();
        for step in plan.shafts.iter().filter(|step| step.shaft > 0) {
            let bound = plan.range(step.shaft);
            shafts[step.shaft] = Some(FoldedShaft::new(
                bound,
                longest,
                by_sample,
                routes.splits(),
                T::LOW && step.shaft > 1,
            ));
        }
        let (poses, crosses) = (vec![vec![]; plan.joint_count], vec![vec![]; plan.joint_count]);
        let phases = vec![vec![]; plan.joint_count];
        let turnings = vec![vec![]; plan.joint_count + 1];
        let forces = FoldedForces::new(plan);
        Self {
            shafts,
            poses,
            crosses,
            phases,
            turnings,
            lines: vec![],
            forces,
            as_built: FoldedAsBuilt::new(plan),
            frames: vec![],
            maps,
            turns,
        }
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
        let may_be_straight = constants.filter(|_| range == AtanRange::Hundredth);
        if may_be_straight.is_some_and(|shaft| shaft.is_straight(geometry)) {
            return (Route::Drive, range);
        }
        (routes.of(shaft, range), range)
    }

    /// Folds the drivelines with these numbers in the batch. Each is folded once, up to the last
    /// shaft that the plan needs.
    #[inline(never)]
    pub(crate) fn fold(
        &mut self,
        level: Level,
        plan: &Plan,
        lines: &Drivelines<'_>,
        numbers: &[usize],
    ) {
        if plan.is_as_built() {
            return self.fold_as_built(plan, lines, numbers);
        }
        if T::LOW {
            // Mostly sequences of dependent operations on few numbers.
            compiled_up_to_avx2!(level, self.fold_all(plan, lines, numbers));
        } else {
            compiled_for!(level, self.fold_all(plan, lines, numbers));
        }
    }

    fn fold_as_built(&mut self, plan: &Plan, lines: &Drivelines<'_>, numbers: &[usize]) {
        let n = plan.joint_count;
        self.as_built.fold(plan, lines, numbers);
        self.poses.iter_mut().for_each(Vec::clear);
        self.forces.clear();
        for &line in numbers.iter().filter(|_| plan.needs_poses()) {
            let mut frame = stored_frame(lines, n, line, 0).orthonormal();
            for j in 0..plan.reach() {
                if j > 0 {
                    frame.pass_shaft(lines.twists[line * (n - 1) + j - 1]);
                }
                let joint = Joint::of_chain(lines.bends[line * n + j]);
                if plan.needs_pose(j) {
                    self.poses[j].push(Pose::of_unit_vectors(&joint, frame));
                }
                frame.pass_joint(&joint);
            }
        }
        self.push_forces(plan, lines, numbers);
    }

    /// Appends the coefficients of the forces, if there are any, from the poses.
    #[inline(always)]
    fn push_forces(&mut self, plan: &Plan, lines: &Drivelines<'_>, numbers: &[usize]) {
        let Some(step) = &plan.forces else { return };
        for (i, &line) in numbers.iter().enumerate() {
            self.forces.push(plan, step, lines, (line, i), |joint| self.poses[joint][i]);
            if plan.axes == Axes::Shaft {
                self.forces.turn(step, i, |joint| self.crosses[joint][i]);
            }
        }
    }

    #[inline(always)]
    fn fold_all(&mut self, plan: &Plan, lines: &Drivelines<'_>, numbers: &[usize]) {
        self.poses.iter_mut().for_each(Vec::clear);
        self.crosses.iter_mut().for_each(Vec::clear);
        self.phases.iter_mut().for_each(Vec::clear);
        self.turnings.iter_mut().for_each(Vec::clear);
        self.lines.clear();
        self.forces.clear();
        for (group, numbers) in numbers.chunks(LANES).enumerate() {
            self.fold_lanes(plan, lines, group * LANES, numbers);
        }
        if plan.axes == Axes::Shaft {
            self.push_phases(plan, lines, numbers);
        }
        self.push_forces(plan, lines, numbers);
    }

    /// Appends the phases by which support moments turn; shaft 0 has none.
    #[inline(always)]
    fn push_phases(&mut self, plan: &Plan, lines: &Drivelines<'_>, numbers: &[usize]) {
        let between = plan.joint_count - 1;
        let steps = plan.joints.iter().zip(&mut self.phases).enumerate();
        for (joint, (_, phases)) in steps.filter(|(_, (step, _))| step.needs_support()) {
            let of = |line: usize| match joint.checked_sub(1) {
                Some(before) => lines.phases[line * between + before],
                None => 0.0,
            };
            phases.extend(numbers.iter().map(|&line| cos_sin(of(line))));
        }
    }

    #[inline(always)]
    fn fold_lanes(&mut self, plan: &Plan, lines: &Drivelines<'_>, start: usize, numbers: &[usize]) {
        let (n, length) = (plan.joint_count, numbers.len());
        let Self { shafts, poses, crosses, turnings, forces, .. } = self;
        let Self { lines: own, frames, maps, turns, .. } = self;
        let mut kept = vec![ExactMaps::default(); if T::LOW { length } else { 0 }];
        let mut bends = [0.0; LANES];
        let (mut sums, mut products) = ([0.0; LANES], [1.0; LANES]);
        own.extend(numbers.iter().filter(|_| T::LOW));
        let (mut phases, mut twists) = ([0.0; LANES], [0.0; LANES]);
        let apart = numbers.iter().enumerate().filter(|&(i, &line)| line != numbers[0] + i).count();
        let gather = |data: &[f64], each: usize, j: usize, out: &mut [f64]| {
            gather(data, (each, j), numbers, apart == 0, out);
        };
        let stored = |i: usize, j: usize| stored_frame(lines, n, numbers[i], j);
        for j in 0..plan.reach() {
            gather(lines.bends, n, j, &mut bends[..length]);
            let bends = &bends[..length];
            if j == 0 && !plan.is_joint() {
                maps.update(length, &Reset);
            } else if j > 0 {
                gather(lines.phases, n - 1, j - 1, &mut phases[..length]);
                gather(lines.twists, n - 1, j - 1, &mut twists[..length]);
                turns.find(&phases[..length], &twists[..length], T::LOW);
                if T::LOW {
                    maps.update(length, &turns.read::<true>(length));
                } else {
                    maps.update(length, &turns.read::<false>(length));
                }
            }
            if T::LOW && plan.needs_frames() {
                let first = || (0..length).map(|i| stored(i, 0).orthonormal());
                pass_shafts(frames, j, first, &twists[..length]);
            }
            if plan.needs_pose(j) {
                let maps = maps.read(length);
                let place = |i: usize| {
                    let frame = frames.get(i).copied().unwrap_or_else(|| stored(i, j));
                    (maps.at(i), joint::<T>(bends[i]), frame)
                };
                let places = (0..length).map(place);
                push_places(&plan.joints[j], places, &mut poses[j], &mut crosses[j]);
            }
            if plan.joints[j].needs_force {
                let maps = maps.read(length);
                forces.push_determinants(j, (0..length).map(|i| maps.complement(i)));
            }
            if T::LOW && j > 0 && plan.needs_pose(j) {
                let (maps, to) = (maps.read(length), To::Joint(j));
                for i in (0..length).filter(|&i| maps.row_loses_digits(i, products[i])) {
                    let exact = kept[i].map(lines.chains(n), numbers[i], to);
                    set_exact(&exact, (j, start + i), &mut poses[j], &mut crosses[j], forces);
                }
            }
            if j == 0
                && let Some(shaft) = &mut shafts[1]
            {
                set_first(shaft, start, bends);
            }
            let turns_load = T::LOW && plan.has_wide_loads() && plan.needs_rates(j + 1);
            if turns_load && j == 0 {
                turnings[1].extend(bends.iter().map(|&bend| Turning::of_joint(bend)));
            }
            if plan.reach() == 1 {
                return;
            }
            if T::LOW {
                for i in 0..length {
                    // A bound on tan²(β/2).
                    let bound = 0.41 * bends[i] * bends[i];
                    sums[i] += bound;
                    products[i] *= 1.0 + bound;
                }
                maps.update(length, &PassJoint::<true>(bends));
            } else {
                maps.update(length, &PassJoint::<false>(bends));
            }
            for (frame, &bend) in frames.iter_mut().zip(bends) {
                frame.pass_joint(&Joint::of_chain(bend));
            }
            if j == 0 {
                continue;
            }
            let (maps, shaft) = (maps.read(length), &mut shafts[j + 1]);
            let mut exact = |i: usize| kept[i].map(lines.chains(n), numbers[i], To::Shaft(j + 1));
            let lost = |i: usize| Transfer::loses_digits(&maps.at(i), sums[i], products[i]);
            if turns_load {
                turnings[j + 1].extend((0..length).map(|i| {
                    Turning::new(&if lost(i) { exact(i).transfer() } else { maps.at(i) })
                }));
            }
            match shaft {
                Some(shaft) if T::LOW => {
                    shaft.set_with_offsets(start, length, &maps);
                    for i in (0..length).filter(|&i| lost(i)) {
                        shaft.set_with_offsets(start + i, 1, &exact(i).transfer());
                    }
                }
                Some(shaft) => shaft.set(start, length, &maps),
                None => {}
            }
        }
    }
}

/// Appends the constants of a joint for its moments and its cross.
#[inline(always)]
fn push_places<T: Angle>(
    step: &JointStep,
    places: impl Iterator<Item = (Transfer, Joint<DoubleDouble>, Frame)> + Clone,
    poses: &mut Vec<Pose<T>>,
    crosses: &mut Vec<Cross<T>>,
) {
    if step.needs_load() {
        let new = |(map, joint, frame): (Transfer, _, _)| Pose::new(&map, &joint, frame);
        poses.extend(places.clone().map(new));
    }
    if step.needs_cross || step.turns_force {
        let new = |(map, joint, frame): (Transfer, _, _)| Cross::new(&map, &joint, frame);
        crosses.extend(places.map(new));
    }
}

/// Replaces the map of the driveline with the index `index` before a joint.
fn set_exact<T: Angle>(
    exact: &ExactMap,
    (joint, index): (usize, usize),
    poses: &mut [Pose<T>],
    crosses: &mut [Cross<T>],
    forces: &mut FoldedForces<T>,
) {
    let matrix = TurnMatrix::new(exact.matrix());
    if let Some(pose) = poses.get_mut(index) {
        pose.matrix = matrix;
    }
    if let Some(cross) = crosses.get_mut(index) {
        cross.matrix = matrix;
    }
    forces.set_determinant(joint, index, exact.transfer().complement);
}

/// Parameter `j` of the drivelines with these numbers, each of which has `each`.
#[inline(always)]
fn gather(
    data: &[f64],
    (each, j): (usize, usize),
    numbers: &[usize],
    contiguous: bool,
    out: &mut [f64],
) {
    if each == 1 && contiguous {
        out.copy_from_slice(&data[numbers[0]..numbers[0] + out.len()]);
        return;
    }
    for (x, line) in out.iter_mut().zip(numbers) {
        *x = data[line * each + j];
    }
}

/// A joint with the digits that poses of this number type need.
#[inline(always)]
fn joint<T: Angle>(bend: f64) -> Joint<DoubleDouble> {
    if T::LOW { Joint::of_chain(bend) } else { Joint::with_error_terms(bend) }
}

/// Cosine and sine of a phase.
#[inline(always)]
fn cos_sin<T: Real>(phase: f64) -> [T; 2] {
    let (sine, cosine) = series::sin_cos(reduction::reduce_any(phase));
    [cosine, sine].map(T::from_double_double)
}

/// Takes the frames of a series of drivelines from one joint to the next, or to the first.
#[inline(always)]
fn pass_shafts<I: Iterator<Item = Frame>>(
    frames: &mut Vec<Frame>,
    joint: usize,
    first: impl Fn() -> I,
    twists: &[f64],
) {
    if joint == 0 {
        frames.clear();
        frames.extend(first());
    } else {
        for (frame, &twist) in frames.iter_mut().zip(twists) {
            frame.pass_shaft(twist);
        }
    }
}

/// Sets the constants of the shafts behind first joints.
#[inline(always)]
fn set_first<T: Angle>(shaft: &mut FoldedShaft<T>, start: usize, bends: &[f64]) {
    if shaft.bound.is_moderate() && !shaft.has_double_angles() {
        shaft.set_moderate(start, bends);
    } else {
        shaft.set(start, bends.len(), &FirstJoint(bends));
    }
}

/// The frame of a joint, from the vectors that a driveline of `joints` joints stores.
#[inline(always)]
fn stored_frame(lines: &Drivelines<'_>, joints: usize, line: usize, joint: usize) -> Frame {
    let shaft = vector(lines.directions, line * (joints + 1) + joint);
    Frame::stored(shaft, vector(lines.normals, line * joints + joint))
}

fn vector(flat: &[f64], index: usize) -> Vector {
    Vector::from_column_slice(&flat[3 * index..3 * index + 3])
}
