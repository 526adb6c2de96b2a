//! Sine and cosine of twice the angles of a long sweep, rotated by whole steps from the middle of a
//! group of samples, so that no sine is computed per sample.

use std::f64::consts::FRAC_PI_2;

use crate::input::sweep::Sweep;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::reduction::{ROUNDING, reduce_double_double};
use crate::number::storage::{Column, View, ViewMut, columns, views, views_mut};
use crate::number::strips::Same;
use crate::number::trig::{self, Angle};
use crate::sincos::array::{self, SinCos, SinCosBlock, SinCosBlocks};

/// Groups begin at multiples of this number of samples, where vectors begin.
const ALIGNMENT: f64 = 8.0;

/// Sines and cosines of twice the angle of whole steps from the middle of a group.
///
/// The sine of twice the angle vanishes at each multiple of a quarter turn. The sample nearest to
/// it is the middle of a group, and further groups follow on both sides at the distance of their
/// length. No sine is therefore the difference of much larger numbers, and each keeps its digits.
#[derive(Clone, Debug)]
pub(crate) struct Rotations<T: Angle> {
    /// Sine and cosine of twice the angle of whole steps, from `-half` on.
    steps: [Column<T>; 2],
    /// Steps from the middle of a group to the start of the next, before alignment.
    half: usize,
    /// Sine and cosine of twice the angle of whole groups, from 0 on.
    groups: Vec<[T; 2]>,
    /// The angle of whole steps, from 0 on.
    turns: Column<DoubleDouble>,
    /// The number of samples in a quarter turn, and the sample number of angle zero.
    quarter: DoubleDouble,
    zero: DoubleDouble,
}

/// Samples of a chunk that are rotated from the same middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RotationGroup<T> {
    /// The first sample, counted from the start of the chunk.
    start: usize,
    length: usize,
    /// The table index of the first sample's step.
    step: usize,
    /// Sine and cosine of twice the angle of the middle.
    middle: [T; 2],
}

impl<T: Angle> Rotations<T> {
    /// The longest group. Its table should leave room in the first-level cache for the results.
    const MAX_LENGTH: f64 = 320.0;

    /// The most groups on either side of a multiple of a quarter turn that are rotated from there.
    const MAX_OFFSET: f64 = 8.0;

    /// A table for the steps of a sweep.
    #[inline(always)]
    pub(crate) fn new(sweep: &Sweep) -> Self {
        let quarter = FRAC_PI_2 / sweep.step().abs();
        // A quarter turn has an odd number of groups: one in the middle and equally many on both
        // sides.
        let beside = (0.5 * quarter / Self::MAX_LENGTH - 0.5).ceil().max(0.0);
        let half = (0.5 * quarter / (2.0 * beside + 1.0)).ceil() as usize + 1;
        let double_angle = sweep.double_angle();
        let turn = |steps: usize| {
            let (s, c) = trig::sin_cos_reduced::<DoubleDouble>(reduce_double_double(
                double_angle.turn_after(steps as f64),
            ));
            [s, c].map(T::from_double_double)
        };
        let length = 2 * half + ALIGNMENT as usize;
        let mut steps = columns(length);
        let [mut sine, mut cosine] = views_mut(&mut steps, 0, length);
        for i in half..length {
            let [s, c] = turn(i - half);
            sine.set(i, s);
            cosine.set(i, c);
        }
        for i in 0..half {
            sine.set(i, -sine.get(2 * half - i));
            cosine.set(i, cosine.get(2 * half - i));
        }
        let beside = beside.min(Self::MAX_OFFSET) as usize;
        // `collect` would be compiled without the instruction set of the caller.
        let mut groups = vec![];
        for group in 0..=beside {
            groups.push(turn(2 * half * group));
        }
        let mut turns = Column::new(length);
        let mut each = turns.view_mut(length);
        for i in 0..length {
            each.set(i, sweep.turn_after(f64::from(i as u32)));
        }
        let [quarter, zero] = sweep.quarter_and_zero();
        Self { steps, half, groups, turns, quarter, zero }
    }

    /// Adds the groups of `count` samples from `first` on. The first of them has the index `start`
    /// in the chunk.
    #[inline(always)]
    pub(crate) fn group(
        &self,
        sweep: &Sweep,
        first: usize,
        count: usize,
        start: usize,
        groups: &mut Vec<RotationGroup<T>>,
    ) {
        let reduction = sweep.double_angle().reduction();
        let sin_cos = |sample: f64| {
            let (s, c) = trig::sin_cos_reduced::<DoubleDouble>(reduction.of(sample));
            [s, c].map(T::from_double_double)
        };
        let half = self.half as f64;
        let stop = first + count;
        let mut at = first;
        let mut quarter = self.quarter_of(sweep, first);
        while at < stop {
            let crossing = sin_cos(quarter.sample);
            let end = stop.min(quarter.end as usize);
            // The vector that contains the sample decides, so the start of a chunk does not matter.
            let vector = ALIGNMENT * (at as f64 / ALIGNMENT).floor();
            let mut beside = ((vector - quarter.sample + half) / (2.0 * half)).floor();
            let mut middle = quarter.sample + 2.0 * half * beside;
            while at < end {
                let next = end.min(align_up(middle + half) as usize);
                groups.push(RotationGroup {
                    start: start + at - first,
                    length: next - at,
                    step: (at as f64 - middle + half) as usize,
                    middle: match self.groups.get(beside.abs() as usize) {
                        Some(&[s, c]) => rotate(crossing, [if beside < 0.0 { -s } else { s }, c]),
                        None => sin_cos(middle),
                    },
                });
                at = next;
                beside += 1.0;
                middle += 2.0 * half;
            }
            quarter = self.quarter(quarter.number + quarter.sense);
        }
    }

    /// Sine and cosine of twice the angle of each sample of the groups. Double-double arithmetic is
    /// faster with this loop separate from the next.
    #[inline(always)]
    pub(crate) fn sin_cos(
        &self,
        groups: &[RotationGroup<T>],
        mut sine: ViewMut<'_, T>,
        mut cosine: ViewMut<'_, T>,
    ) {
        for group in groups {
            let [s, c] = &self.steps;
            let (s, c) = (s.part(group.step, group.length), c.part(group.step, group.length));
            let (to_sine, to_cosine) =
                (sine.window(group.start, group.length), cosine.window(group.start, group.length));
            let [by_s, by_c] = group.middle;
            array::rotate(Same([by_c, by_s]), SinCos { sine: s, cosine: c }, to_sine, to_cosine);
        }
    }

    /// The sample number of a multiple of a quarter turn, with its fraction.
    #[inline(always)]
    fn sample_at(&self, number: f64) -> f64 {
        let DoubleDouble { high, low } = DoubleDouble::two_product(number, self.quarter.high);
        (DoubleDouble { high, low: number.mul_add(self.quarter.low, low) } + self.zero).value()
    }

    /// The first sample after the quarter with this number.
    #[inline(always)]
    fn end(&self, number: f64) -> f64 {
        align_up(self.sample_at(number + 0.5_f64.copysign(self.quarter.high)))
    }

    #[inline(always)]
    fn quarter(&self, number: f64) -> Quarter {
        let sense = 1.0_f64.copysign(self.quarter.high);
        Quarter { number, sense, sample: self.sample_at(number).round(), end: self.end(number) }
    }

    /// The quarter that contains a sample.
    #[inline(always)]
    fn quarter_of(&self, sweep: &Sweep, sample: usize) -> Quarter {
        let sample = sample as f64;
        let (_, nearest) = sweep.reduction().of(sample);
        let nearest = self.quarter(f64::from_bits(nearest) - ROUNDING);
        // A vector that begins in the previous quarter belongs to it as a whole. A sample halfway
        // between two quarters may belong to either.
        if sample < self.end(nearest.number - nearest.sense) {
            self.quarter(nearest.number - nearest.sense)
        } else if sample >= nearest.end {
            self.quarter(nearest.number + nearest.sense)
        } else {
            nearest
        }
    }
}

/// Sine and cosine of a sum of angles.
#[inline(always)]
fn rotate<T: Real>([s, c]: [T; 2], [by_s, by_c]: [T; 2]) -> [T; 2] {
    [s.mul_add(by_c, c * by_s), c.mul_add(by_c, -(s * by_s))]
}

/// The samples nearest to one multiple of a quarter turn, before alignment to vectors.
#[derive(Clone, Copy)]
struct Quarter {
    /// The multiple, and the difference to the next quarter's.
    number: f64,
    sense: f64,
    /// The nearest sample, which may lie outside the sweep.
    sample: f64,
    /// The start of the next quarter.
    end: f64,
}

/// Rounds a sample number up to the start of a vector.
#[inline(always)]
fn align_up(sample: f64) -> f64 {
    ALIGNMENT * (sample / ALIGNMENT).ceil()
}

/// Sine and cosine of twice the drive angle, multiplied by `q`, for the samples of a chunk.
#[derive(Clone, Copy)]
pub(crate) struct RotatedSinCos<'a, T: Real> {
    steps: [View<'a, T>; 2],
    groups: &'a [RotationGroup<T>],
    q: [T; 2],
    turns: View<'a, DoubleDouble>,
}

impl<'a, T: Angle> RotatedSinCos<'a, T> {
    #[inline(always)]
    pub(crate) fn new(
        rotations: &'a Rotations<T>,
        groups: &'a [RotationGroup<T>],
        q: [T; 2],
    ) -> Self {
        let length = rotations.turns.len();
        let turns = rotations.turns.view(length);
        Self { steps: views(&rotations.steps, length), groups, q, turns }
    }
}

impl<'a, T: Real> SinCosBlocks<T> for RotatedSinCos<'a, T> {
    type SinCosBlock = RotatedGroup<'a, T>;
    type Unsigned = Self;

    const FROM_SWEEP: bool = true;

    #[inline(always)]
    fn unsigned(self) -> Self {
        self
    }

    #[inline(always)]
    fn turns(&self) -> View<'_, DoubleDouble> {
        self.turns
    }

    #[inline(always)]
    fn parts(self) -> impl Iterator<Item = (usize, RotatedGroup<'a, T>)> {
        let Self { steps: [sine, cosine], groups, q: [re, im], .. } = self;
        groups.iter().map(move |group| {
            let middle = rotate(group.middle, [-im, re]);
            let sine = sine.part(group.step, group.length);
            let cosine = cosine.part(group.step, group.length);
            (group.start, RotatedGroup { steps: SinCos { sine, cosine }, middle })
        })
    }
}

/// The same for one group.
#[derive(Clone, Copy)]
pub(crate) struct RotatedGroup<'a, T: Real> {
    steps: SinCos<'a, T>,
    middle: [T; 2],
}

impl<T: Real> SinCosBlock<T> for RotatedGroup<'_, T> {
    #[inline(always)]
    fn part(&self, start: usize, length: usize) -> Self {
        Self { steps: self.steps.part(start, length), middle: self.middle }
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.steps.len()
    }

    #[inline(always)]
    fn get(&self, i: usize) -> (T, T) {
        let (s, c) = self.steps.get(i);
        let [s, c] = rotate(self.middle, [s, c]);
        (s, c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SWEEPS: [(f64, f64, usize); 6] = [
        (0.0, 19.0, 10_000),
        (-0.3, 0.2, 4096),
        (9.7, -5.3, 8191),
        (1e9, 1e9 + 40.0, 5000),
        // Quarter turns of many more groups than are rotated from their middle, and of one group
        // only.
        (0.7, 3.1, 100_000),
        (3.0, -200.0, 4500),
    ];

    fn groups(sweep: &Sweep, first: usize, count: usize) -> Vec<(usize, [f64; 2])> {
        let rotations = Rotations::<f64>::new(sweep);
        let mut groups = vec![];
        rotations.group(sweep, first, count, 0, &mut groups);
        let swept = RotatedSinCos::new(&rotations, &groups, [1.0, 0.0]);
        let mut samples = vec![];
        for (start, part) in swept.parts() {
            assert_eq!(start, samples.len());
            samples.extend((0..part.len()).map(|i| (first + start + i, part.get(i).into())));
        }
        assert_eq!(samples.len(), count);
        samples
    }

    #[test]
    fn sines_of_twice_the_angles_keep_their_digits() {
        for (start, stop, count) in SWEEPS {
            let sweep = Sweep::new(start, stop, count).unwrap();
            let double_angle = sweep.double_angle();
            for (i, [sine, cosine]) in groups(&sweep, 0, count) {
                let (s, c) =
                    trig::sin_cos_double_double(reduce_double_double(double_angle.angle(i as f64)));
                assert!(
                    (DoubleDouble::exact(sine) - s).value().abs() <= 6e-16 * s.value().abs(),
                    "{i}"
                );
                assert!((DoubleDouble::exact(cosine) - c).value().abs() <= 5e-16, "{i}");
            }
        }
    }

    #[test]
    fn it_does_not_matter_where_a_chunk_begins() {
        for (start, stop, count) in SWEEPS {
            let sweep = Sweep::new(start, stop, count).unwrap();
            let all = groups(&sweep, 0, count);
            for first in [1, 7, 8, 277, 1024, 2050, 4001] {
                for count in [1, 30, count - first] {
                    assert_eq!(groups(&sweep, first, count), all[first..first + count]);
                }
            }
        }
    }
}
