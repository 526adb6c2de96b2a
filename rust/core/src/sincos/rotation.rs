//! Sine and cosine of twice the angles of a long sweep: turned from the middle of a group of samples by
//! whole steps, so that no sample has a sine of its own.

use std::f64::consts::FRAC_PI_2;

use crate::input::sweep::Sweep;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::reduction::{ROUNDING, reduce_double_double};
use crate::number::storage::{Column, View, ViewMut, columns, views, views_mut};
use crate::number::trig::{self, Angle};
use crate::sincos::array::{self, SinCos, SinCosBlock, SinCosBlocks};

/// Groups begin at multiples of so many samples: at vectors.
const ALIGNED: f64 = 8.0;

/// Sines and cosines of twice the turn of whole steps, about the middle of a group.
///
/// Wherever the sine of twice the angle vanishes, at each multiple of a quarter turn, the sample beside it is
/// the middle of a group, and the others follow from there by the length of a group: no sine is the difference
/// of much larger numbers, so each keeps its digits.
#[derive(Clone, Debug)]
pub(crate) struct Rotations<T: Angle> {
    /// Sine and cosine of twice the turn from `-half` steps on.
    steps: [Column<T>; 2],
    /// Steps from the middle of a group to where the next begins, but for vectors.
    half: usize,
    /// Sine and cosine of twice the turn of so many groups.
    groups: Vec<[T; 2]>,
    /// The turn of so many steps.
    turns: Column<DoubleDouble>,
    /// The samples in a quarter turn, and where angle zero would be.
    quarter: DoubleDouble,
    zero: DoubleDouble,
}

/// Samples of a chunk that turn from the same middle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RotationGroup<T> {
    /// The first of them, counted from the chunk's.
    start: usize,
    length: usize,
    /// Its steps in the table.
    step: usize,
    /// Sine and cosine of twice the angle of the middle.
    middle: [T; 2],
}

impl<T: Angle> Rotations<T> {
    /// The longest group; its table should leave the first-level cache to the results.
    const LONGEST: f64 = 320.0;

    /// The most groups on either side of a multiple of a quarter turn that are turned from there.
    const BESIDE: f64 = 8.0;

    /// A table for the steps of a sweep.
    #[inline(always)]
    pub(crate) fn new(sweep: &Sweep) -> Self {
        let quarter = FRAC_PI_2 / sweep.step().abs();
        // An odd number of groups to a quarter turn: one in its middle and as many on both sides.
        let beside = (0.5 * quarter / Self::LONGEST - 0.5).ceil().max(0.0);
        let half = (0.5 * quarter / (2.0 * beside + 1.0)).ceil() as usize + 1;
        let twice = sweep.twice();
        let turn = |steps: usize| {
            let (s, c) =
                trig::turned::<DoubleDouble>(reduce_double_double(twice.turned(steps as f64)));
            [s, c].map(T::from_double_double)
        };
        let length = 2 * half + ALIGNED as usize;
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
        let beside = beside.min(Self::BESIDE) as usize;
        // Not collected: that would be compiled without the instruction set.
        let mut groups = vec![];
        for group in 0..=beside {
            groups.push(turn(2 * half * group));
        }
        let mut turns = Column::new(length);
        let mut each = turns.view_mut(length);
        for i in 0..length {
            each.set(i, sweep.turned(f64::from(i as u32)));
        }
        let [quarter, zero] = sweep.quarter_and_zero();
        Self { steps, half, groups, turns, quarter, zero }
    }

    /// Adds the groups of so many samples from `first` on; the first of them stands at `start` in the chunk.
    #[inline(always)]
    pub(crate) fn group(
        &self,
        sweep: &Sweep,
        first: usize,
        count: usize,
        start: usize,
        groups: &mut Vec<RotationGroup<T>>,
    ) {
        let reduction = sweep.twice().reduction();
        let find = |sample: f64| {
            let (s, c) = trig::turned::<DoubleDouble>(reduction.of(sample));
            [s, c].map(T::from_double_double)
        };
        let half = self.half as f64;
        let stop = first + count;
        let mut at = first;
        let mut quarter = self.quarter_of(sweep, first);
        while at < stop {
            let crossing = find(quarter.sample);
            let end = stop.min(quarter.end as usize);
            // By the vector that the sample is in, so that it does not matter where a chunk begins.
            let vector = ALIGNED * (at as f64 / ALIGNED).floor();
            let mut beside = ((vector - quarter.sample + half) / (2.0 * half)).floor();
            let mut middle = quarter.sample + 2.0 * half * beside;
            while at < end {
                let next = end.min(up_to_vector(middle + half) as usize);
                groups.push(RotationGroup {
                    start: start + at - first,
                    length: next - at,
                    step: (at as f64 - middle + half) as usize,
                    middle: match self.groups.get(beside.abs() as usize) {
                        Some(&[s, c]) => turned(crossing, [if beside < 0.0 { -s } else { s }, c]),
                        None => find(middle),
                    },
                });
                at = next;
                beside += 1.0;
                middle += 2.0 * half;
            }
            quarter = self.quarter(quarter.number + quarter.sense);
        }
    }

    /// Sine and cosine of twice the angle of each sample of the groups: numbers with error terms are better two
    /// loops.
    #[inline(always)]
    pub(crate) fn twice(
        &self,
        groups: &[RotationGroup<T>],
        mut sine: ViewMut<'_, T>,
        mut cosine: ViewMut<'_, T>,
    ) {
        for group in groups {
            let steps = self.steps.each_ref().map(|column| column.part(group.step, group.length));
            let [s, c] = steps;
            let (to_sine, to_cosine) =
                (sine.window(group.start, group.length), cosine.window(group.start, group.length));
            let [by_s, by_c] = group.middle;
            array::turn(|_| [by_c, by_s], SinCos { sine: s, cosine: c }, to_sine, to_cosine);
        }
    }

    /// The number of the sample at a multiple of a quarter turn, with its fraction.
    #[inline(always)]
    fn place(&self, number: f64) -> f64 {
        let DoubleDouble { high, low } = DoubleDouble::two_product(number, self.quarter.high);
        (DoubleDouble { high, low: number.mul_add(self.quarter.low, low) } + self.zero).value()
    }

    /// Where the quarter of this number ends.
    #[inline(always)]
    fn end(&self, number: f64) -> f64 {
        up_to_vector(self.place(number + 0.5_f64.copysign(self.quarter.high)))
    }

    #[inline(always)]
    fn quarter(&self, number: f64) -> Quarter {
        let sense = 1.0_f64.copysign(self.quarter.high);
        Quarter { number, sense, sample: self.place(number).round(), end: self.end(number) }
    }

    /// The quarter that a sample is in.
    #[inline(always)]
    fn quarter_of(&self, sweep: &Sweep, sample: usize) -> Quarter {
        let sample = sample as f64;
        let (_, nearest) = sweep.reduction().of(sample);
        let nearest = self.quarter(f64::from_bits(nearest) - ROUNDING);
        // A sample of a vector that begins in the quarter before is that one's, one halfway may be either's.
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
fn turned<T: Real>([s, c]: [T; 2], [by_s, by_c]: [T; 2]) -> [T; 2] {
    [s.mul_add(by_c, c * by_s), c.mul_add(by_c, -(s * by_s))]
}

/// The samples that are nearer to one multiple of a quarter turn than to others, but for vectors.
#[derive(Clone, Copy)]
struct Quarter {
    /// The multiple, and what is added for the next.
    number: f64,
    sense: f64,
    /// The sample beside it, which the sweep need not hold.
    sample: f64,
    /// Where the next one begins.
    end: f64,
}

/// The first sample of the next vector, or of this one if it is the first.
#[inline(always)]
fn up_to_vector(sample: f64) -> f64 {
    ALIGNED * (sample / ALIGNED).ceil()
}

/// `q` times `e^{2iα}` for the samples of a chunk.
#[derive(Clone, Copy)]
pub(crate) struct Swept<'a, T: Real> {
    steps: [View<'a, T>; 2],
    groups: &'a [RotationGroup<T>],
    q: [T; 2],
    turns: View<'a, DoubleDouble>,
}

impl<'a, T: Angle> Swept<'a, T> {
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

impl<'a, T: Real> SinCosBlocks<T> for Swept<'a, T> {
    type SinCosBlock = Turned<'a, T>;

    const SWEPT: bool = true;

    #[inline(always)]
    fn turns(&self) -> View<'_, DoubleDouble> {
        self.turns
    }

    #[inline(always)]
    fn parts(self) -> impl Iterator<Item = (usize, Turned<'a, T>)> {
        let Self { steps: [sine, cosine], groups, q: [re, im], .. } = self;
        groups.iter().map(move |group| {
            let middle = turned(group.middle, [-im, re]);
            let sine = sine.part(group.step, group.length);
            let cosine = cosine.part(group.step, group.length);
            (group.start, Turned { steps: SinCos { sine, cosine }, middle })
        })
    }
}

/// Those of a group.
#[derive(Clone, Copy)]
pub(crate) struct Turned<'a, T: Real> {
    steps: SinCos<'a, T>,
    middle: [T; 2],
}

impl<T: Real> SinCosBlock<T> for Turned<'_, T> {
    #[inline(always)]
    fn len(&self) -> usize {
        self.steps.len()
    }

    #[inline(always)]
    fn get(&self, i: usize) -> (T, T) {
        let (s, c) = self.steps.get(i);
        let [s, c] = turned(self.middle, [s, c]);
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
        // Quarter turns of many more groups than are turned from their middle, and of one only.
        (0.7, 3.1, 100_000),
        (3.0, -200.0, 4500),
    ];

    fn groups(sweep: &Sweep, first: usize, count: usize) -> Vec<(usize, [f64; 2])> {
        let rotations = Rotations::<f64>::new(sweep);
        let mut groups = vec![];
        rotations.group(sweep, first, count, 0, &mut groups);
        let swept = Swept::new(&rotations, &groups, [1.0, 0.0]);
        let mut found = vec![];
        for (start, part) in swept.parts() {
            assert_eq!(start, found.len());
            found.extend((0..part.len()).map(|i| (first + start + i, part.get(i).into())));
        }
        assert_eq!(found.len(), count);
        found
    }

    #[test]
    fn sines_of_twice_the_angles_keep_their_digits() {
        for (start, stop, count) in SWEEPS {
            let sweep = Sweep::new(start, stop, count).unwrap();
            let twice = sweep.twice();
            for (i, [sine, cosine]) in groups(&sweep, 0, count) {
                let (s, c) =
                    trig::sin_cos_double_double(reduce_double_double(twice.angle(i as f64)));
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
