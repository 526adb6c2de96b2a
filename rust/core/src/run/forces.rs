//! Forces of joints and bearings: their coefficients, and the sums of torsion parts over a chunk.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use crate::input::drivelines::Drivelines;
use crate::mechanics::bearings::Carrier;
use crate::mechanics::cross::{Cross, TurningPin};
use crate::mechanics::forces::{self, LinearForce, Neighbour, PARTS};
use crate::mechanics::moment::Pose;
use crate::number::Number;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::storage::{Column, View, ViewMut, columns, views, views_mut};
use crate::number::strips::{At, OneByOne, Same, Strips, mapped};
use crate::plan::forces::{Balance, ForceOf, ForceStep, ForceTarget, JointLoad};
use crate::plan::request::Axes;
use crate::plan::steps::Plan;
use crate::run::constants::{GeometryIndex, with_constants};
use crate::run::level::{Compiled, Level};
use crate::run::map::{over_samples, over_sin_cos};
use crate::run::sink::{Outputs, Sink};
use crate::sincos::array::SinCos;

/// The number of terms that one loop adds up.
const GROUP: usize = 4;

/// A vector for each torsion part of a joint or of the drive shaft.
type Coefficients<T> = [[T; 3]; PARTS];

/// The coefficients of the forces of a series of drivelines.
#[derive(Clone, Debug)]
pub(crate) struct FoldedForces<T> {
    /// For each target and each of its sources: those of each driveline.
    coefficients: Vec<Vec<Vec<Coefficients<T>>>>,
    /// For each target: the pins of the drivelines with which its axes turn, if they do.
    turning_pins: Vec<Vec<TurningPin<T>>>,
    /// The forces of each balance, for one driveline.
    balances: Vec<[LinearForce<T>; 2]>,
    /// For each joint: the inverse determinants of the drivelines' maps before it; empty for joints
    /// as built.
    inverse_determinants: Vec<Vec<T>>,
}

impl<T: Real> FoldedForces<T> {
    pub(crate) fn new(plan: &Plan) -> Self {
        let zero = [T::from_f64(0.0); 3];
        let step = plan.forces.as_ref();
        let (targets, balances) = step.map_or((&[][..], &[][..]), |s| (&s.targets, &s.balances));
        let of = |balance: &Balance| {
            let force = vec![zero; PARTS * balance.joints.len()];
            [force.clone(), force]
        };
        Self {
            coefficients: targets.iter().map(|target| vec![vec![]; target.sources.len()]).collect(),
            turning_pins: vec![vec![]; targets.len()],
            balances: balances.iter().map(of).collect(),
            inverse_determinants: vec![vec![]; if step.is_some() { plan.joint_count } else { 0 }],
        }
    }

    pub(crate) fn clear(&mut self) {
        self.coefficients.iter_mut().flatten().for_each(Vec::clear);
        self.turning_pins.iter_mut().for_each(Vec::clear);
        self.inverse_determinants.iter_mut().for_each(Vec::clear);
    }

    /// Appends the determinants of the maps before a joint.
    #[inline(always)]
    pub(crate) fn push_determinants(
        &mut self,
        joint: usize,
        determinants: impl Iterator<Item = DoubleDouble>,
    ) {
        let inverses = determinants.map(|determinant| DoubleDouble::ONE / determinant);
        self.inverse_determinants[joint].extend(inverses.map(T::from_double_double));
    }

    /// Replaces the determinant of a driveline's map before a joint, if any force needs it.
    pub(crate) fn set_determinant(
        &mut self,
        joint: usize,
        index: usize,
        determinant: DoubleDouble,
    ) {
        let own = self.inverse_determinants.get_mut(joint).and_then(|own| own.get_mut(index));
        if let Some(inverse) = own {
            *inverse = T::from_double_double(DoubleDouble::ONE / determinant);
        }
    }

    /// Appends the coefficients of a driveline with the number `line`, which has the index `index`
    /// here, and whose joints have the poses `pose_of(joint)`.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        plan: &Plan,
        step: &ForceStep,
        lines: &Drivelines<'_>,
        (line, index): (usize, usize),
        pose_of: impl Fn(usize) -> Pose<T>,
    ) {
        let shafts = step.shafts();
        let lengths = &lines.lengths[line * shafts..(line + 1) * shafts];
        let positions = &lines.positions[line * step.bearings..(line + 1) * step.bearings];
        for (i, balance) in step.balances.iter().enumerate() {
            let (known, own) = self.balances.split_at_mut(i);
            let places = (lengths, positions);
            solve(balance, step, known, places, &pose_of, plan.is_as_built(), &mut own[0]);
        }
        let zero = [[T::from_f64(0.0); 3]; PARTS];
        for (target, columns) in step.targets.iter().zip(&mut self.coefficients) {
            for column in &mut *columns {
                column.push(zero);
            }
            let Some(force) = target.force else { continue };
            let mut place = 0;
            for joint in target.joints.clone() {
                let own = coefficients(step, &self.balances, force, joint);
                if target.sources[place] != plan.joints[joint].force_source {
                    place += 1;
                }
                // The parts of a joint as built need no map.
                if plan.is_as_built() {
                    columns[place][index] = own;
                    continue;
                }
                let inverse = self.inverse_determinants[joint][index];
                if plan.refers_forces {
                    let forms = pose_of(joint).parts_of_drive(inverse);
                    add_referred(own, forms, &mut columns[place][index]);
                } else {
                    columns[place][index] = own.map(|vector| vector.map(|x| x * inverse));
                }
            }
        }
    }

    /// Gives the coefficients of the driveline that was pushed last, which has the index `index`, the
    /// axes at rest in which the pins turn.
    #[inline(always)]
    pub(crate) fn turn(
        &mut self,
        step: &ForceStep,
        index: usize,
        cross_of: impl Fn(usize) -> Cross<T>,
    ) {
        let targets = step.targets.iter().zip(&mut self.coefficients).zip(&mut self.turning_pins);
        for ((target, columns), pins) in targets {
            let (joint, driving) = target.turns_with();
            let (axes, pin) = cross_of(joint).turning_pin(driving);
            pins.push(pin);
            for column in columns {
                column[index] = column[index].map(|vector| axes.map(|axis| dot(axis, vector)));
            }
        }
    }
}

#[inline(always)]
fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The coefficients of a force for a joint's torsion parts.
#[inline(always)]
fn coefficients<T: Real>(
    step: &ForceStep,
    balances: &[[LinearForce<T>; 2]],
    ForceOf { balance, carrier, reversed }: ForceOf,
    joint: usize,
) -> Coefficients<T> {
    [0, 1, 2].map(|part| {
        let force = balances[balance][carrier][step.balances[balance].index(joint, part)];
        if reversed { force.map(|x| -x) } else { force }
    })
}

/// Adds the coefficients for the torsion parts of the drive shaft, of which those of the joint are
/// linear forms.
#[inline(always)]
fn add_referred<T: Real>(
    own: Coefficients<T>,
    forms: [[T; 3]; PARTS],
    total: &mut Coefficients<T>,
) {
    for (vector, form) in own.into_iter().zip(forms) {
        for (factor, total) in form.into_iter().zip(&mut *total) {
            for (x, total) in vector.into_iter().zip(total) {
                *total = x.mul_add(factor, *total);
            }
        }
    }
}

/// The forces of one balance, from those of earlier ones.
#[inline(always)]
fn solve<T: Real>(
    balance: &Balance,
    step: &ForceStep,
    known: &[[LinearForce<T>; 2]],
    (lengths, positions): (&[f64], &[f64]),
    pose_of: impl Fn(usize) -> Pose<T>,
    as_built: bool,
    forces: &mut [LinearForce<T>; 2],
) {
    let shaft = balance.shaft;
    let place = |carrier: Carrier| match carrier {
        Carrier::UpstreamJoint => 0.0,
        Carrier::DownstreamJoint => lengths[shaft],
        Carrier::Bearing(bearing) => positions[bearing],
    };
    let (before, after) = (shaft.checked_sub(1), Some(shaft).filter(|&j| j + 1 < lengths.len()));
    let direction = match (before, after) {
        (_, Some(joint)) => pose_of(joint).shaft_axis,
        (Some(joint), None) if as_built => pose_of(joint).driven_axis_as_built(),
        (Some(joint), None) => pose_of(joint).driven_axis(),
        (None, None) => return,
    };
    let driven = before.map(|joint| (joint, pose_of(joint).turned_support_driven()));
    let driving = after.map(|joint| (joint, pose_of(joint).turned_support_driving()));
    let own = driven.into_iter().chain(driving).flat_map(|(joint, terms)| {
        terms.into_iter().map(move |(part, term)| (balance.index(joint, part), term))
    });
    let neighbour = |load: &JointLoad| {
        let ForceOf { balance: other, carrier, reversed } = load.force;
        Neighbour {
            position: place(load.at),
            force: &known[other][carrier][..],
            reversed,
            first: balance.index(step.balances[other].joints.start, 0),
        }
    };
    let neighbours: Vec<_> = balance.loads.iter().map(neighbour).collect();
    forces::balance(direction, balance.carriers.map(place), own, &neighbours, forces);
}

/// The buffers of one block.
pub(crate) struct ForceBuffers<T: Real> {
    /// The torsion parts of each joint that a force depends on: of ideal joints multiplied by the
    /// determinant of the map before it, or those of the drive shaft under the power of the joint; of
    /// joints as built as they are. Without a load there are none.
    pub(crate) parts: Vec<[Column<T>; PARTS]>,
    /// The inverse of each pin's squared length, if the parts of several joints need it.
    pub(crate) inverse_squares: Column<T>,
    /// Sums of some of the terms of a force.
    sums: [Column<T>; 2],
    /// A force along axes at rest, and the same with one source more; empty unless axes turn.
    at_rest: Vec<[Column<T>; 3]>,
    /// The terms of a component that do not vanish.
    terms: Vec<usize>,
}

impl<T: Real> ForceBuffers<T> {
    /// For chunks of up to `longest` samples.
    pub(crate) fn new(plan: &Plan, longest: usize) -> Self {
        let size = |needed: bool| if needed { longest } else { 0 };
        let mut targets = plan.forces.iter().flat_map(|step| &step.targets);
        let long = targets.any(|target| PARTS * target.sources.len() > GROUP);
        let turns = plan.forces.is_some() && plan.axes == Axes::Shaft;
        let loaded =
            plan.joints.iter().take(if plan.load.is_some() { plan.joint_count } else { 0 });
        let sources = loaded.enumerate().map(|(joint, step)| step.is_source(joint));
        Self {
            parts: sources.map(|is_source| columns(size(is_source))).collect(),
            inverse_squares: Column::new(size(plan.needs_inverse_squares())),
            sums: columns(size(long)),
            at_rest: (0..if turns { 2 } else { 0 }).map(|_| columns(longest)).collect(),
            terms: vec![],
        }
    }
}

/// The forces of a chunk, from the torsion parts of its joints or of the drive shaft.
#[inline(always)]
pub(crate) fn run_forces<T: Real, W: Float>(
    step: &ForceStep,
    folded: &FoldedForces<T>,
    geometry: GeometryIndex,
    ForceBuffers { parts, sums, terms, .. }: &mut ForceBuffers<T>,
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
) {
    for (target, coefficients) in step.targets.iter().zip(&folded.coefficients) {
        if let Some((twin, sign)) = target.twin
            && !outputs.bypass_caches()
        {
            for axis in 0..3 {
                outputs.copy(twin + axis, target.plane + axis, sign);
            }
            continue;
        }
        for axis in 0..3 {
            terms.clear();
            terms.extend((0..PARTS * target.sources.len()).filter(|&term| match geometry {
                GeometryIndex::Shared(index) => {
                    coefficients[term / PARTS][index][term % PARTS][axis] != T::from_f64(0.0)
                }
                GeometryIndex::PerSample => true,
            }));
            if terms.is_empty() {
                // A sum is NaN where its terms are, even if all coefficients vanish.
                terms.push(0);
            }
            let column = |term: usize| parts[target.sources[term / PARTS]][term % PARTS].view(size);
            let groups = terms.chunks(match geometry {
                GeometryIndex::Shared(_) => GROUP,
                // Folding takes most of the time, so that one loop for all groups suffices.
                GeometryIndex::PerSample => PARTS,
            });
            let last = groups.len() - 1;
            for (i, group) in groups.enumerate() {
                let weighted = Terms { coefficients, group, axis, geometry };
                let [out, previous] = &mut *sums;
                let previous = (i > 0).then(|| previous.view(size));
                if i == last {
                    weighted.sum(column, previous, size, outputs.plane(target.plane + axis));
                } else {
                    weighted.sum_whole(column, previous, size, out.view_mut(size));
                    sums.swap(0, 1);
                }
            }
        }
    }
}

/// The same in axes that turn with the shafts.
pub(crate) fn run_turning_forces<T: Number + Compiled, W: Float>(
    level: Level,
    step: &ForceStep,
    folded: &FoldedForces<T>,
    geometry: GeometryIndex,
    pins: SinCos<'_, T>,
    buffers: &mut ForceBuffers<T>,
    outputs: &mut Outputs<'_, '_, W>,
) {
    let size = pins.len();
    let constants = folded.coefficients.iter().zip(&folded.turning_pins);
    for (target, (coefficients, turning)) in step.targets.iter().zip(constants) {
        sum_at_rest(level, target, coefficients, geometry, buffers, size);
        let turning = OneByOne(&turning[..geometry.count(size)]);
        let force = views(&buffers.at_rest[0], size);
        T::run(
            level,
            #[inline(always)]
            |compact, stores| {
                let planes = [target.plane, target.plane + 1, target.plane + 2];
                let mut outputs = outputs.by(stores);
                let out = outputs.several(planes);
                with_constants!(compact, geometry, turning, at => {
                    over_sin_cos(
                        pins,
                        (at, force),
                        out,
                        #[inline(always)]
                        |(pin, force), s, c| pin.components(force, s, c),
                    );
                });
            },
        );
    }
}

/// The sums of one force along the axes at rest in which its shaft's pin turns.
fn sum_at_rest<T: Number + Compiled>(
    level: Level,
    target: &ForceTarget,
    coefficients: &[Vec<Coefficients<T>>],
    geometry: GeometryIndex,
    ForceBuffers { parts, at_rest, .. }: &mut ForceBuffers<T>,
    size: usize,
) {
    let [total, next] = &mut at_rest[..] else { return };
    T::run(
        level,
        #[inline(always)]
        |compact, _| {
            let zero = Same([T::from_f64(0.0); 3]);
            over_samples(
                size,
                zero,
                views_mut(total, 0, size),
                #[inline(always)]
                |zero| zero,
            );
            for (&source, coefficients) in target.sources.iter().zip(coefficients) {
                let coefficients = OneByOne(&coefficients[..geometry.count(size)]);
                let (parts, previous) = (views(&parts[source], size), views(total, size));
                with_constants!(compact, geometry, coefficients, at => {
                    add_parts(at, parts, previous, views_mut(next, 0, size));
                });
                std::mem::swap(total, next);
            }
        },
    );
}

/// The torsion parts of one source with their coefficients, added to `previous`.
#[inline(always)]
fn add_parts<T: Real>(
    at: impl Strips<Value = Coefficients<T>>,
    parts: [View<'_, T>; PARTS],
    previous: [View<'_, T>; 3],
    out: [ViewMut<'_, T>; 3],
) {
    over_samples(
        parts[0].len(),
        (at, parts, previous),
        out,
        #[inline(always)]
        |(coefficients, parts, mut total)| {
            for axis in 0..3 {
                for part in 0..PARTS {
                    total[axis] = parts[part].mul_add(coefficients[part][axis], total[axis]);
                }
            }
            total
        },
    );
}

/// Some terms of one component of a force.
#[derive(Clone, Copy)]
struct Terms<'a, T> {
    coefficients: &'a [Vec<Coefficients<T>>],
    group: &'a [usize],
    axis: usize,
    geometry: GeometryIndex,
}

impl<T: Real> Terms<'_, T> {
    /// Adds the terms to `previous`.
    #[inline(always)]
    fn sum<'a>(
        self,
        column: impl Fn(usize) -> View<'a, T>,
        previous: Option<View<'_, T>>,
        size: usize,
        out: impl Sink<T>,
    ) {
        let GeometryIndex::Shared(index) = self.geometry else {
            return self.sum_per_sample(column, previous, size, out);
        };
        match self.group.len() {
            1 => self.sum_of::<1>(index, column, previous, size, out),
            2 => self.sum_of::<2>(index, column, previous, size, out),
            3 => self.sum_of::<3>(index, column, previous, size, out),
            _ => self.sum_of::<GROUP>(index, column, previous, size, out),
        }
    }

    /// The same for a group that is followed by others, and so is whole.
    #[inline(always)]
    fn sum_whole<'a>(
        self,
        column: impl Fn(usize) -> View<'a, T>,
        previous: Option<View<'_, T>>,
        size: usize,
        out: impl Sink<T>,
    ) {
        match self.geometry {
            GeometryIndex::Shared(index) => {
                self.sum_of::<GROUP>(index, column, previous, size, out);
            }
            GeometryIndex::PerSample => self.sum_per_sample(column, previous, size, out),
        }
    }

    #[inline(always)]
    fn sum_of<'a, const N: usize>(
        self,
        index: usize,
        column: impl Fn(usize) -> View<'a, T>,
        previous: Option<View<'_, T>>,
        size: usize,
        out: impl Sink<T>,
    ) {
        let mut factors = [T::from_f64(0.0); N];
        for (factor, &term) in factors.iter_mut().zip(self.group) {
            *factor = self.coefficients[term / PARTS][index][term % PARTS][self.axis];
        }
        sum((self.columns::<N>(column, size), Same(factors)), previous, size, out);
    }

    /// The terms of one source, each sample with its own factors.
    #[inline(always)]
    fn sum_per_sample<'a>(
        self,
        column: impl Fn(usize) -> View<'a, T>,
        previous: Option<View<'_, T>>,
        size: usize,
        out: impl Sink<T>,
    ) {
        let Some(&first) = self.group.first() else { return };
        let axis = self.axis;
        let factors = mapped(
            OneByOne(&self.coefficients[first / PARTS][..size]),
            #[inline(always)]
            move |all: Coefficients<T>| all.map(|vector| vector[axis]),
        );
        sum((self.columns::<PARTS>(column, size), factors), previous, size, out);
    }

    #[inline(always)]
    fn columns<'a, const N: usize>(
        self,
        column: impl Fn(usize) -> View<'a, T>,
        size: usize,
    ) -> [View<'a, T>; N] {
        let mut columns = [View::EMPTY; N];
        for (view, &term) in columns.iter_mut().zip(self.group) {
            *view = column(term).cut(size);
        }
        columns
    }
}

/// `previous` plus the sum of columns times factors.
#[inline(always)]
fn sum<T: Real, const N: usize>(
    inputs: impl Strips<Value = ([T; N], [T; N])>,
    previous: Option<View<'_, T>>,
    size: usize,
    out: impl Sink<T>,
) {
    match previous {
        Some(previous) => over_samples(
            size,
            (inputs, previous),
            out,
            #[inline(always)]
            |((numbers, factors), mut total)| {
                for k in 0..N {
                    total = numbers[k].mul_add(factors[k], total);
                }
                total
            },
        ),
        None => over_samples(
            size,
            inputs,
            out,
            #[inline(always)]
            |(numbers, factors)| {
                let mut total = numbers[0].times(factors[0]);
                for k in 1..N {
                    total = numbers[k].mul_add(factors[k], total);
                }
                total
            },
        ),
    }
}
