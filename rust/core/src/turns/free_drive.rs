//! How far the speed of a drive of finite inertia varies where no torque holds it.
//!
//! Unevenly turning shafts take kinetic energy from the drive and give it back twice a turn. Without
//! a torque the energy `J ω²/2` with `J = I_0 + Σ I_i r_i²` stays the same, where `r_i` is the speed
//! ratio of shaft `i`. So the speed of the drive goes as `1/√J`, and over its mean in time it is `√J`
//! averaged over the turn, over `√J` (D. Thoma, Das Kräftespiel im Kreuzgelenk, Schweizerische
//! Bauzeitung 75, 1920, asks how large the drive's inertia must be).

use std::f64::consts::PI;

use crate::error::Result;
use crate::input::batch::check_length;
use crate::mechanics::chain::Equivalent;
use crate::number::DoubleDouble;
use crate::number::elementary::ln;
use crate::plan::output::Output;
use crate::plan::request::{Axes, Request};
use crate::plan::steps::Plan;
use crate::run::execution::Execution;
use crate::turns::rows::{Rows, each_piece};

/// Samples of half a turn: enough for the mean of a periodic analytic function to be exact to
/// rounding, whose Fourier series falls like the powers of `k`. Bends above 89.9° get fewer.
const DIGITS: f64 = 60.0;
const FEWEST: usize = 64;
const MOST: f64 = 65_536.0;

/// Steps of Newton's method from the extremes of the samples, and of the search for an inertia.
const ROUNDS: usize = 3;
const BISECTIONS: usize = 80;

/// The speed of a drive that runs freely, over its mean in time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FreeDrive {
    /// The least speed.
    pub least: f64,
    /// The largest speed.
    pub largest: f64,
    /// Their difference.
    pub variation: f64,
    /// The mean of `√J` over the drive angle, in the root of the unit of the inertias.
    pub root: f64,
}

/// The speed of the drive for each row, which needs no load and has ideal joints. `inertias` are
/// those of every shaft about its axis, shaft 0 first and row by row, in any unit.
///
/// # Errors
/// Arrays whose lengths do not fit together.
pub fn free_drives(
    rows: &Rows<'_>,
    largest_bends: &[f64],
    inertias: &[f64],
    execution: Execution<'_>,
) -> Result<Vec<FreeDrive>> {
    let drives = Drives::new(rows, largest_bends, inertias)?;
    let mut found = vec![FreeDrive::default(); rows.count()];
    each_piece(&mut found, 1, execution, |first, found| {
        drives.each_turn(first, found.len(), |i, turn| found[i] = turn.drive())
    })?;
    Ok(found)
}

/// The least inertia of the drive with which its speed varies by no more than `variations` from peak
/// to peak, over its mean, one for each row. Infinite if it is beyond the largest double.
///
/// The inertias of the other shafts are as for [`free_drives`], with 0 for the drive.
///
/// # Errors
/// Arrays whose lengths do not fit together.
pub fn least_drive_inertias(
    rows: &Rows<'_>,
    largest_bends: &[f64],
    inertias: &[f64],
    variations: &[f64],
    execution: Execution<'_>,
) -> Result<Vec<f64>> {
    let drives = Drives::new(rows, largest_bends, inertias)?;
    check_length("variations", variations.len(), rows.count(), 1)?;
    let mut found = vec![0.0; rows.count()];
    each_piece(&mut found, 1, execution, |first, found| {
        drives.each_turn(first, found.len(), |i, turn| {
            found[i] = turn.least_inertia(variations[first + i]);
        })
    })?;
    Ok(found)
}

/// Rows with the inertias of their shafts, and the plans of the speed ratio alone and of the motion
/// of all shafts but the drive.
struct Drives<'a> {
    rows: &'a Rows<'a>,
    inertias: &'a [f64],
    joints: usize,
    ratio: Plan,
    motion: Plan,
}

impl<'a> Drives<'a> {
    fn new(rows: &'a Rows<'a>, largest_bends: &[f64], inertias: &'a [f64]) -> Result<Self> {
        let joints = largest_bends.len();
        check_length("inertias", inertias.len(), rows.count(), joints + 1)?;
        let moving: Vec<usize> = (1..=joints).collect();
        let of = |outputs: &[Output]| {
            Plan::new(&Request {
                largest_bends,
                outputs,
                shafts: &moving,
                joints: &[],
                load: None,
                inertias: &[],
                bearings: None,
                as_built: false,
                axes: Axes::Space,
            })
        };
        let ratio = of(&[Output::SpeedRatio])?;
        let motion = of(&[Output::SpeedRatio, Output::AccelerationRatio, Output::JerkRatio])?;
        rows.check(&ratio)?;
        Ok(Self { rows, inertias, joints, ratio, motion })
    }

    /// Calls `take` with each of some rows and what the drive feels over half a turn. Rows with
    /// equally many samples are evaluated together.
    fn each_turn(
        &self,
        first: usize,
        count: usize,
        mut take: impl FnMut(usize, &Turn<'_>),
    ) -> Result<()> {
        let mut order: Vec<(usize, usize)> =
            (0..count).map(|i| (self.samples(first + i), i)).collect();
        order.sort_unstable();
        for group in order.chunk_by(|a, b| a.0 == b.0) {
            let samples = group[0].0;
            let own: Vec<usize> = group.iter().map(|(_, i)| first + i).collect();
            let step = PI / samples as f64;
            let angles: Vec<f64> = (0..samples).map(|i| i as f64 * step).collect();
            let [inertia] = self.felt(&self.ratio, &own, &angles.repeat(own.len()))?;
            let mut turns: Vec<Turn<'_>> = inertia.chunks(samples).map(Turn::new).collect();
            self.refine(&own, &angles, step, &mut turns)?;
            for (&(_, i), turn) in group.iter().zip(&turns) {
                take(i, turn);
            }
        }
        Ok(())
    }

    /// The number of samples that a row needs.
    fn samples(&self, row: usize) -> usize {
        let k = (1..=self.joints).fold(0.0_f64, |steepest, shaft| {
            let [bends, twists, phases] = self.rows.chain(row, self.joints, shaft);
            steepest.max(Equivalent::of_chain(bends, twists, phases).joint.k)
        });
        let decay = (-ln(k.max(f64::MIN_POSITIVE))).max(DIGITS / MOST);
        FEWEST.max((DIGITS / decay).ceil() as usize)
    }

    /// Moves the least and the largest inertia of the samples to those between them, from every
    /// extreme of the samples. What lands on no extreme is a sample more.
    fn refine(
        &self,
        rows: &[usize],
        angles: &[f64],
        step: f64,
        turns: &mut [Turn<'_>],
    ) -> Result<()> {
        let starts: Vec<Vec<usize>> = turns.iter().map(Turn::extremes).collect();
        // Each row has equally many places, of which some repeat.
        let each = starts.iter().map(Vec::len).max().unwrap_or(0);
        if each == 0 {
            return Ok(());
        }
        let padded = |own: &Vec<usize>| {
            let own: Vec<f64> = own.iter().map(|&i| angles[i]).collect();
            let last = own.last().copied().unwrap_or(0.0);
            (0..each).map(|i| own.get(i).copied().unwrap_or(last)).collect::<Vec<f64>>()
        };
        let mut places: Vec<f64> = starts.iter().flat_map(padded).collect();
        for round in 0..=ROUNDS {
            let [inertia, slope, curvature] = self.felt(&self.motion, rows, &places)?;
            for (turn, tried) in turns.iter_mut().zip(inertia.chunks(each)) {
                turn.low = tried.iter().fold(turn.low, |low, &x| low.min(x));
                turn.high = tried.iter().fold(turn.high, |high, &x| high.max(x));
            }
            for (i, place) in places.iter_mut().enumerate().filter(|_| round < ROUNDS) {
                let move_by = if curvature[i] == 0.0 { 0.0 } else { -slope[i] / curvature[i] };
                *place += move_by.clamp(-step, step);
            }
        }
        Ok(())
    }

    /// The inertia that the drive feels and as many derivatives by its angle as the plan has outputs
    /// beyond the speed ratio, at drive angles of some rows, the same number in each.
    fn felt<const N: usize>(
        &self,
        plan: &Plan,
        rows: &[usize],
        angles: &[f64],
    ) -> Result<[Vec<f64>; N]> {
        let count = angles.len();
        let gathered = self.rows.gathered(rows, self.joints);
        let planes = gathered.run(plan, plan.precision(None, false), angles)?;
        let mut felt = [(); N].map(|()| vec![0.0; count]);
        let each = count / rows.len();
        for i in 0..count {
            let own = &self.inertias[rows[i / each] * (self.joints + 1)..][..=self.joints];
            felt[0][i] = own[0];
            for (shaft, inertia) in own[1..].iter().enumerate() {
                let of = |output: usize| planes[(output * self.joints + shaft) * count + i];
                let ratio = of(0);
                felt[0][i] += inertia * ratio * ratio;
                if N > 2 {
                    let [first, second] = [of(1), of(2)];
                    felt[1][i] += 2.0 * inertia * ratio * first;
                    felt[2][i] += 2.0 * inertia * first.mul_add(first, ratio * second);
                }
            }
        }
        Ok(felt)
    }
}

/// The inertia that the drive feels over half a turn: samples at equal steps, and its ends.
struct Turn<'a> {
    inertia: &'a [f64],
    low: f64,
    high: f64,
}

impl<'a> Turn<'a> {
    fn new(inertia: &'a [f64]) -> Self {
        let low = inertia.iter().copied().fold(f64::INFINITY, f64::min);
        let high = inertia.iter().copied().fold(0.0, f64::max);
        Self { inertia, low, high }
    }

    /// The samples that are no less or no larger than both neighbours, unless all are the same.
    fn extremes(&self) -> Vec<usize> {
        let (own, count) = (self.inertia, self.inertia.len());
        let is_extreme = |&i: &usize| {
            let [before, after] = [own[(i + count - 1) % count], own[(i + 1) % count]];
            own[i] >= before.max(after) || own[i] <= before.min(after)
        };
        if self.low == self.high { vec![] } else { (0..count).filter(is_extreme).collect() }
    }

    /// The mean of `√(J + added)` over the turn.
    fn root(&self, added: f64) -> f64 {
        let sum = self.inertia.iter().fold(DoubleDouble::default(), |sum, inertia| {
            sum + DoubleDouble::exact((inertia + added).sqrt())
        });
        sum.value() / self.inertia.len() as f64
    }

    /// The difference of the largest and the least speed with an inertia added to the drive's,
    /// without the difference of two quotients near 1.
    fn variation(&self, root: f64, added: f64) -> f64 {
        let [low, high] = [self.low, self.high].map(|inertia| (inertia + added).sqrt());
        root * (self.high - self.low) / (low * high * (low + high))
    }

    fn drive(&self) -> FreeDrive {
        let root = self.root(0.0);
        let [largest, least] = [self.low, self.high].map(|inertia| root / inertia.sqrt());
        FreeDrive { least, largest, variation: self.variation(root, 0.0), root }
    }

    /// The least inertia to add for a variation, by bisection: more inertia varies less.
    fn least_inertia(&self, wanted: f64) -> f64 {
        let suffices = |added: f64| self.variation(self.root(added), added) <= wanted;
        if self.high == self.low || self.low > 0.0 && suffices(0.0) {
            return 0.0;
        }
        // The variation is at most (high − low)/(2 (added + low)).
        let (mut short, mut enough) = (0.0, 0.5 * (self.high - self.low) / wanted);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (short + enough);
            if enough.is_infinite() || middle == short || middle == enough {
                break;
            }
            if suffices(middle) {
                enough = middle;
            } else {
                short = middle;
            }
        }
        enough
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::Drivelines;

    #[test]
    fn the_inertia_for_a_variation_leaves_that_variation() {
        let bends = [0.15, 0.9];
        let lines = Drivelines {
            bends: &bends,
            directions: &[0.0; 12],
            normals: &[0.0; 6],
            ..Drivelines::default()
        };
        let rows = Rows { shape: &[2], lines, line_strides: &[1], load: None };
        let of = |inertias: [f64; 4]| {
            free_drives(&rows, &[0.9], &inertias, Execution::default()).unwrap()
        };
        let wanted = [2e-3, 1e-4];
        let (alone, still) = ([0.0, 1.0, 0.0, 1.0], Execution::default());
        let needed = least_drive_inertias(&rows, &[0.9], &alone, &wanted, still).unwrap();
        let found = of([needed[0], 1.0, needed[1], 1.0]);
        for (drive, wanted) in found.iter().zip(wanted) {
            assert!((drive.variation / wanted - 1.0).abs() < 1e-11, "{drive:?}");
            assert!(drive.least < 1.0 && drive.largest > 1.0);
        }
        // One joint's speed ratio lies between cos β and its reciprocal.
        for (drive, bend) in of(alone).iter().zip(bends) {
            let square = (drive.largest / drive.least).powi(2);
            assert!((square * bend.cos().powi(4) - 1.0).abs() < 1e-14, "{square}");
        }
    }
}
