//! Uniform sweeps of the drive: angles that need no array.

use std::f64::consts::TAU;

use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::reduce::{self, HALF_PI, ROUNDING};

/// Drive angles at equal steps, exact: sample `i` is at `start + i · step` itself and not at a
/// double beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    start: Pair,
    step: Pair,
    count: usize,
    /// Samples per turn, if a turn is a whole number of steps from 0.
    per_turn: Option<f64>,
}

impl Sweep {
    /// The largest angle, in rad.
    pub const FARTHEST: f64 = 1e12;

    /// The largest number of samples: sample numbers times four are exact doubles.
    pub const LONGEST: usize = 1 << 50;

    /// `count` angles from `start` to `stop`, both included; a single one is `start`.
    ///
    /// # Errors
    /// No angles, or more than [`Sweep::LONGEST`]; an end that is not finite or beyond
    /// [`Sweep::FARTHEST`].
    pub fn new(start: f64, stop: f64, count: usize) -> Result<Self> {
        for (name, end) in [("start", start), ("stop", stop)] {
            // Not `>`, which lets NaN pass.
            if !(end.abs() <= Self::FARTHEST) {
                let problem = format!("is {end} rad; a sweep must end within 1e12 rad of zero");
                return Err(Error::new(name, &[], problem));
            }
        }
        check_count("num", count)?;
        let steps = Pair::exact((count - 1).max(1) as f64);
        let step = Pair::sum(stop, -start) / steps;
        Ok(Self { start: Pair::exact(start), step: step.rounded(), count, per_turn: None })
    }

    /// `count` angles from 0 on, `per_turn` to a turn.
    ///
    /// # Errors
    /// No angles or none to a turn, or more than [`Sweep::LONGEST`].
    pub fn of_turns(count: usize, per_turn: usize) -> Result<Self> {
        check_count("turns", count)?;
        check_count("samples", per_turn)?;
        let step = Pair::new(TAU, 4.0 * HALF_PI[1]) / Pair::exact(per_turn as f64);
        let per_turn = Some(per_turn as f64);
        Ok(Self { start: Pair::default(), step: step.rounded(), count, per_turn })
    }

    /// Number of angles.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Angle of sample `i`, the nearest double.
    pub fn at(&self, i: usize) -> f64 {
        self.angle(i as f64).value()
    }

    /// After how many samples the pins stand as before: up to their sense, or with it.
    pub(crate) fn period(&self, sensed: bool) -> Option<usize> {
        let per_turn = self.per_turn? as usize;
        Some(if sensed || per_turn % 2 == 1 { per_turn } else { per_turn / 2 })
    }

    /// Sample `i`, a whole number.
    #[inline(always)]
    pub(crate) fn angle(&self, i: f64) -> Pair {
        let Pair { high, low } = Pair::product(i, self.step.high);
        let turned = Pair { high, low: i.mul_add(self.step.low, low) };
        if self.per_turn.is_some() { turned } else { self.start + turned }
    }

    /// The remainder of sample `i` to the nearest multiple of π/2, and the multiple.
    #[inline(always)]
    pub(crate) fn reduced(&self, i: f64) -> (Pair, u64) {
        let Some(per_turn) = self.per_turn else {
            return reduce::reduce_in_two(self.angle(i));
        };
        // In whole steps of a quarter of one, so that nothing is rounded.
        let quarters = 4.0 * i;
        let shifted = quarters.mul_add(1.0 / per_turn, ROUNDING);
        let steps = (shifted - ROUNDING).mul_add(-per_turn, quarters);
        let quarter = self.step.scaled(0.25);
        let Pair { high, low } = Pair::product(steps, quarter.high);
        (Pair { high, low: steps.mul_add(quarter.low, low) }, shifted.to_bits())
    }
}

fn check_count(argument: &'static str, count: usize) -> Result<()> {
    if (1..=Sweep::LONGEST).contains(&count) {
        return Ok(());
    }
    let problem = format!("makes {count} samples; a sweep has 1 to {}", Sweep::LONGEST);
    Err(Error::new(argument, &[], problem))
}
