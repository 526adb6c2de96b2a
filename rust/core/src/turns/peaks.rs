//! The largest magnitudes of outputs over a turn, and where they are.
//!
//! At a constant load every magnitude repeats after half a turn, because each joint and each shaft
//! has then made half a turn too; with deviations of the joints, after a whole turn. This period is
//! sampled at equal steps of the drive and, where a shaft turns steeply, also at equal steps of that
//! shaft: as functions of the angles of the two shafts of a joint, torques, moments and tilts are
//! smooth, however narrow they are over the drive angle. Every peak of the samples is then searched
//! between its neighbours.

use std::f64::consts::PI;

use crate::error::Result;
use crate::mechanics::chain::Equivalent;
use crate::number::elementary::{atan2, hypot};
use crate::number::trig;
use crate::plan::reduction::Reduction;
use crate::run::execution::Execution;
use crate::turns::Turns;
use crate::turns::rows::each_row;

/// Steps of half a turn. The quantities have at most some four periods in it, so a peak and the
/// sample next to it differ by less than a thirtieth, and no peak below [`NEAR`] is the largest.
const STEPS: usize = 60;
const NEAR: f64 = 0.9;

/// Where a shaft turns faster than this share of the drive's speed, steps are so many times smaller.
const UNEVEN: f64 = 1.25;
const FINER: usize = 3;

/// Shafts that never turn faster than this share of the drive's speed need no steps of their own.
const STEEP: f64 = 2.0;

/// A search tries places around the top of the parabola through a peak and its neighbours, this part
/// of the interval apart, and leaves twice that. Near its peak every magnitude is a parabola but for
/// a part that falls faster than the interval.
const APART: f64 = 1.0 / 32.0;

/// A round that leaves more than half of the interval is followed by one with so many equal parts.
const PARTS: usize = 16;

/// Rounds of a search at most: with equal parts alone, from 3 degrees to 3e-9 rad. Off the peak by
/// that much, a magnitude is less by a part of 1e-17.
const ROUNDS: usize = 9;

/// A search ends where the parabola is flatter than this part of the magnitude: its top is then known
/// to a part of 1e-16.
const SETTLED: f64 = 1e-13;

/// A place of the first samples stays if the search finds only roundings more.
const ROUNDING: f64 = 1e-15;

/// The part of a magnitude that its rounding may be.
const FLAT: f64 = 1e-12;

/// Magnitudes that differ by a smaller part are equal.
const ALIKE: f64 = 1e-9;

/// Extreme to search for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sought {
    /// The largest magnitude; of a vector, the largest length.
    Largest,
    /// The least magnitude, of what does not vanish.
    Least,
}

/// The largest or the least magnitude of an output over a turn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Peak {
    /// The magnitude. Its relative error is that of [`crate::Plan::run`], and below 1e-12 in any case where
    /// the drive angle as a double resolves the peak.
    pub value: f64,
    /// Drive angles in rad within the period at which it occurs, each again a period later; none
    /// where it is the same at every angle.
    pub places: Vec<f64>,
}

impl Turns<'_> {
    /// The largest or the least magnitudes of the outputs over a turn, for each row and of each row
    /// one for each shaft, joint or bearing: of a vector, its length.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together, a plan with a load without one in the rows.
    pub fn peaks(&self, sought: Sought, execution: Execution<'_>) -> Result<Vec<Peak>> {
        let groups = Reduction::Peak.groups(self.plan);
        let mut found = vec![Peak::default(); self.rows.count() * groups.len()];
        self.rows.check(self.plan)?;
        each_row(&mut found, groups.len(), execution, |row, found| {
            Search { turns: self, row, groups: &groups, sought }.run(found)
        })?;
        Ok(found)
    }
}

/// The search in one row.
struct Search<'a> {
    turns: &'a Turns<'a>,
    row: usize,
    /// The planes of each output of a shaft, joint or bearing.
    groups: &'a [usize],
    sought: Sought,
}

/// A drive angle and the size there.
type Sample = [f64; 2];

/// A peak of the samples.
struct Candidate {
    group: usize,
    /// The sample before it, the largest one and the sample after it.
    around: [Sample; 3],
    /// Where the peak is, of all that is known.
    top: Sample,
    /// Whether the last round has left more than half of the interval.
    is_slow: bool,
}

impl Candidate {
    fn new(group: usize, around: [Sample; 3]) -> Self {
        Self { group, around, top: around[1], is_slow: false }
    }

    /// The places that the next round tries; none where nothing more is found.
    fn trials(&self) -> Vec<f64> {
        let [[left, before], [place, size], [right, after]] = self.around;
        let (back, ahead) = (place - left, right - place);
        let (rise, fall) = (size - before, size - after);
        let curve = fall * back + rise * ahead;
        if curve <= SETTLED * size * (right - left) {
            return vec![];
        }
        if self.is_slow {
            let part = (right - left) / PARTS as f64;
            return (1..PARTS).map(|i| left + i as f64 * part).collect();
        }
        let top = place + (rise * ahead * ahead - fall * back * back) / (2.0 * curve);
        let apart = APART * (right - left);
        [top - apart, top, top + apart].into_iter().filter(|&x| left < x && x < right).collect()
    }

    /// Takes the sizes at the places that were tried.
    fn narrow(&mut self, tried: impl Iterator<Item = Sample>) {
        let [left, _, right] = self.around;
        let mut known: Vec<Sample> = self.around.into_iter().chain(tried).collect();
        known.sort_by(|a, b| a[0].total_cmp(&b[0]));
        known.dedup_by_key(|sample| sample[0]);
        let last = known.len() - 1;
        let best = (1..last).fold(1, |best, i| if known[i][1] > known[best][1] { i } else { best });
        self.around = [known[best - 1], known[best], known[best + 1]];
        if known[best][1] > (1.0 + ROUNDING) * self.top[1] {
            self.top = known[best];
        }
        let [before, _, after] = self.around;
        self.is_slow = after[0] - before[0] > 0.5 * (right[0] - left[0]);
    }
}

impl Search<'_> {
    fn run(&self, found: &mut [Peak]) -> Result<()> {
        let angles = self.angles();
        let period = if self.turns.plan.is_as_built() { 2.0 * PI } else { PI };
        let sizes = self.sizes(&angles)?;
        let mut candidates = vec![];
        for (group, sizes) in sizes.chunks(angles.len()).enumerate() {
            // NaN is passed on, unless a factor that is too large for doubles has made it beside a size
            // that is too large as well.
            let larger = |a: f64, b: f64| if b.is_nan() || b > a { b } else { a };
            let infinite = sizes.iter().any(|size| size.is_infinite());
            let top = if infinite {
                f64::INFINITY
            } else {
                sizes.iter().copied().fold(f64::NEG_INFINITY, larger)
            };
            let low = sizes.iter().copied().fold(f64::INFINITY, f64::min);
            if top - low > ALIKE * top && top.is_finite() {
                candidates.extend(peaks_of(group, &angles, sizes, top, period));
            } else {
                found[group].value = top;
            }
        }
        for _ in 0..ROUNDS {
            self.narrow(&mut candidates)?;
        }
        for candidates in candidates.chunk_by(|a, b| a.group == b.group) {
            let top = candidates.iter().fold(0.0_f64, |top, one| top.max(one.top[1]));
            let alike = candidates.iter().filter(|one| one.top[1] >= (1.0 - ALIKE) * top);
            let mut places: Vec<f64> = alike.map(|one| one.top[0].rem_euclid(period)).collect();
            places.sort_by(f64::total_cmp);
            places.dedup();
            found[candidates[0].group] = Peak { value: top, places };
        }
        if self.sought == Sought::Least {
            for peak in found {
                peak.value = peak.value.recip();
            }
        }
        Ok(())
    }

    /// Drive angles of the period in order, from 0 on, between which nothing is narrow.
    fn angles(&self) -> Vec<f64> {
        let joints = self.turns.plan.joint_count;
        let shafts = (1..=joints).map(|shaft| {
            let [bends, twists, phases] = self.turns.rows.chain(self.row, joints, shaft);
            Equivalent::of_chain(bends, twists, phases)
        });
        let shafts: Vec<Equivalent> = shafts.collect();
        let fastest = |one: &&Equivalent| one.joint.max_speed_ratio();
        let is_uneven = shafts.iter().any(|one| fastest(&one) > UNEVEN);
        let count = if is_uneven { STEPS * FINER } else { STEPS };
        // Halves and quarters of the half turn are exact.
        let steps = (0..count).map(|i| i as f64 / count as f64 * PI);
        let mut angles: Vec<f64> = steps.clone().collect();
        for equivalent in shafts.iter().filter(|one| fastest(one) > STEEP) {
            // From equal steps of this shaft to its equivalent joint's driving angle.
            angles.extend(steps.clone().map(|step| {
                let (sine, cosine) = trig::sin_cos(step);
                let driving = atan2(equivalent.joint.cos * sine, cosine);
                (driving - equivalent.angle_offset()).rem_euclid(PI)
            }));
        }
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        if self.turns.plan.is_as_built() {
            angles.extend(angles.clone().iter().map(|angle| angle + PI));
        }
        angles
    }

    /// The sizes of every group at drive angles, one group after another.
    fn sizes(&self, angles: &[f64]) -> Result<Vec<f64>> {
        let mut values = self.turns.values(&[self.row], angles)?;
        let count = angles.len();
        let mut first = 0;
        for (group, &planes) in self.groups.iter().enumerate() {
            for i in 0..count {
                let component = |plane: usize| values[(first + plane) * count + i];
                let size = if planes == 1 {
                    component(0).abs()
                } else {
                    // Unlike the root of a sum of squares this is infinite only where the length is.
                    hypot(hypot(component(0), component(1)), component(2))
                };
                // No later group reads what is written here.
                values[group * count + i] =
                    if self.sought == Sought::Least { size.recip() } else { size };
            }
            first += planes;
        }
        values.truncate(self.groups.len() * count);
        Ok(values)
    }

    /// One round of the search of every candidate.
    fn narrow(&self, candidates: &mut [Candidate]) -> Result<()> {
        let trials: Vec<Vec<f64>> = candidates.iter().map(Candidate::trials).collect();
        let angles = trials.concat();
        if angles.is_empty() {
            return Ok(());
        }
        let sizes = self.sizes(&angles)?;
        let mut first = 0;
        for (one, tried) in candidates.iter_mut().zip(trials) {
            let own = &sizes[one.group * angles.len() + first..][..tried.len()];
            first += tried.len();
            one.narrow(tried.iter().zip(own).map(|(&angle, &size)| [angle, size]));
        }
        Ok(())
    }
}

/// The peaks of the samples that may be the largest, with the nearest samples on both sides that are
/// lower by more than rounding. Steps of two shafts nearly meet, and which of two such samples is
/// larger does not tell on which side of them the peak is.
fn peaks_of(
    group: usize,
    angles: &[f64],
    sizes: &[f64],
    top: f64,
    period: f64,
) -> impl Iterator<Item = Candidate> {
    let count = angles.len();
    (0..count).filter(move |&i| sizes[i] >= NEAR * top).filter_map(move |i| {
        let size = sizes[i];
        let low = (1.0 - FLAT) * size;
        let is_apart = |&j: &usize| sizes[j] > size || sizes[j] < low;
        let after = (1..count).map(|n| (i + n) % count).find(is_apart)?;
        // The first of equal samples stands for all of them.
        let stops = |j: &usize| sizes[*j] == size || is_apart(j);
        let before = (1..count).map(|n| (i + count - n) % count).find(stops)?;
        (sizes[before] < size && sizes[after] < size).then(|| {
            let left = if before > i { angles[before] - period } else { angles[before] };
            let right = if after < i { angles[after] + period } else { angles[after] };
            Candidate::new(group, [[left, sizes[before]], [angles[i], size], [right, sizes[after]]])
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_that_nearly_meet_hide_no_peak_beside_them() {
        for peak in [-0.003, 0.003] {
            for rounding in [-1e-15, 0.0, 1e-15] {
                let angles = [-1.0, -0.02, 0.0, 1e-16, 0.02, 1.0];
                let mut sizes = angles.map(|angle: f64| 1.0 - (angle - peak).powi(2));
                sizes[2] += rounding;
                let found: Vec<Candidate> = peaks_of(0, &angles, &sizes, 1.0, PI).collect();
                assert_eq!(found.len(), 1);
                let [before, _, after] = found[0].around;
                assert_eq!([before[0], after[0]], [-0.02, 0.02]);
            }
        }
    }
}
