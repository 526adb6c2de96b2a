//! Forces of joints and bearings: their coefficients, and the sums of torsion parts over a chunk.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use crate::input::drivelines::Drivelines;
use crate::mechanics::bearings::Carrier;
use crate::mechanics::forces::{self, LinearForce, Neighbour, PARTS};
use crate::mechanics::moment::Pose;
use crate::number::float::{Float, Real};
use crate::number::storage::{Column, View, columns};
use crate::number::strips::{Same, Strips, mapped};
use crate::plan::forces::{Balance, ForceOf, ForceStep, JointLoad};
use crate::plan::steps::Plan;
use crate::run::constants::GeometryIndex;
use crate::run::map::over_samples;
use crate::run::sink::{Outputs, Sink};

/// The number of terms that one loop adds up.
const GROUP: usize = 4;

/// The coefficients of the forces of a series of drivelines.
#[derive(Clone, Debug)]
pub(crate) struct FoldedForces<T> {
    /// For each target and each of its terms: a vector per driveline.
    coefficients: Vec<Vec<Vec<[T; 3]>>>,
    /// The forces of each balance, for one driveline.
    balances: Vec<[LinearForce<T>; 2]>,
}

impl<T: Real> FoldedForces<T> {
    pub(crate) fn new(step: Option<&ForceStep>) -> Self {
        let zero = [T::from_f64(0.0); 3];
        let (targets, balances) = step.map_or((&[][..], &[][..]), |s| (&s.targets, &s.balances));
        let of = |balance: &Balance| {
            let force = vec![zero; PARTS * balance.joints.len()];
            [force.clone(), force]
        };
        Self {
            coefficients: targets.iter().map(|target| vec![vec![]; target.terms.len()]).collect(),
            balances: balances.iter().map(of).collect(),
        }
    }

    pub(crate) fn clear(&mut self) {
        self.coefficients.iter_mut().flatten().for_each(Vec::clear);
    }

    /// Appends the coefficients of a driveline with the number `line`, whose joints have the poses
    /// `pose_of(joint)`.
    #[inline(always)]
    pub(crate) fn push(
        &mut self,
        step: &ForceStep,
        lines: &Drivelines<'_>,
        line: usize,
        pose_of: impl Fn(usize) -> Pose<T>,
    ) {
        let shafts = step.shafts();
        let lengths = &lines.lengths[line * shafts..(line + 1) * shafts];
        let positions = &lines.positions[line * step.bearings..(line + 1) * step.bearings];
        for (i, balance) in step.balances.iter().enumerate() {
            let (known, own) = self.balances.split_at_mut(i);
            solve(balance, step, known, lengths, positions, &pose_of, &mut own[0]);
        }
        for (target, coefficients) in step.targets.iter().zip(&mut self.coefficients) {
            for (&(joint, part), column) in target.terms.iter().zip(coefficients) {
                column.push(match target.force {
                    Some(ForceOf { balance, carrier, reversed }) => {
                        let index = step.balances[balance].index(joint, part);
                        let force = self.balances[balance][carrier][index];
                        if reversed { force.map(|x| -x) } else { force }
                    }
                    None => [T::from_f64(0.0); 3],
                });
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
    lengths: &[f64],
    positions: &[f64],
    pose_of: impl Fn(usize) -> Pose<T>,
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
    /// The torsion parts of each joint that a force depends on.
    pub(crate) parts: Vec<[Column<T>; PARTS]>,
    /// Sums of some of the terms of a force.
    sums: [Column<T>; 2],
    /// The terms of a component that do not vanish.
    terms: Vec<usize>,
}

impl<T: Real> ForceBuffers<T> {
    /// For chunks of up to `longest` samples.
    pub(crate) fn new(plan: &Plan, longest: usize) -> Self {
        let size = |needed: bool| if needed { longest } else { 0 };
        let many = plan.forces.iter().flat_map(|step| &step.targets);
        Self {
            parts: plan.joints.iter().map(|step| columns(size(step.needs_force))).collect(),
            sums: columns(size(many.into_iter().any(|target| target.terms.len() > GROUP))),
            terms: vec![],
        }
    }
}

/// The forces of a chunk, from the torsion parts of its joints.
#[inline(always)]
pub(crate) fn run_forces<T: Real, W: Float>(
    step: &ForceStep,
    folded: &FoldedForces<T>,
    geometry: GeometryIndex,
    ForceBuffers { parts, sums, terms }: &mut ForceBuffers<T>,
    outputs: &mut Outputs<'_, '_, W>,
    size: usize,
) {
    for (target, coefficients) in step.targets.iter().zip(&folded.coefficients) {
        for axis in 0..3 {
            terms.clear();
            terms.extend((0..target.terms.len()).filter(|&term| match geometry {
                GeometryIndex::Shared(index) => coefficients[term][index][axis] != T::from_f64(0.0),
                GeometryIndex::PerSample => true,
            }));
            if terms.is_empty() {
                // A sum is NaN where its terms are, even if all coefficients vanish.
                terms.push(0);
            }
            let column = |term: usize| {
                let (joint, part) = target.terms[term];
                parts[joint][part].view(size)
            };
            let groups = terms.chunks(GROUP);
            let last = groups.len() - 1;
            for (i, group) in groups.enumerate() {
                let weighted = Terms { coefficients, group, axis, geometry };
                let [out, previous] = &mut *sums;
                let previous = (i > 0).then(|| previous.view(size));
                if i == last {
                    weighted.sum(column, previous, size, outputs.plane(target.plane + axis));
                } else {
                    weighted.sum(column, previous, size, out.view_mut(size));
                    sums.swap(0, 1);
                }
            }
        }
    }
}

/// Some terms of one component of a force.
#[derive(Clone, Copy)]
struct Terms<'a, T> {
    coefficients: &'a [Vec<[T; 3]>],
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
        match self.group.len() {
            1 => self.sum_of::<1>(column, previous, size, out),
            2 => self.sum_of::<2>(column, previous, size, out),
            3 => self.sum_of::<3>(column, previous, size, out),
            _ => self.sum_of::<GROUP>(column, previous, size, out),
        }
    }

    #[inline(always)]
    fn sum_of<'a, const N: usize>(
        self,
        column: impl Fn(usize) -> View<'a, T>,
        previous: Option<View<'_, T>>,
        size: usize,
        out: impl Sink<T>,
    ) {
        let mut columns = [View::EMPTY; N];
        for (view, &term) in columns.iter_mut().zip(self.group) {
            *view = column(term).cut(size);
        }
        match self.geometry {
            GeometryIndex::Shared(index) => {
                let mut factors = [T::from_f64(0.0); N];
                for (factor, &term) in factors.iter_mut().zip(self.group) {
                    *factor = self.coefficients[term][index][self.axis];
                }
                sum((columns, Same(factors)), previous, size, out);
            }
            GeometryIndex::PerSample => {
                let factors: [_; N] = std::array::from_fn(|k| {
                    let vectors = &self.coefficients[self.group[k]][..size];
                    mapped(vectors, move |vector: [T; 3]| vector[self.axis])
                });
                sum((columns, factors), previous, size, out);
            }
        }
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
