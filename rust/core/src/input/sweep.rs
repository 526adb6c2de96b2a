//! Uniform sweeps of the drive angle, which need no array.

use std::f64::consts::TAU;
use std::slice::from_ref;

use crate::error::{Error, Result, Rule};
use crate::number::double_double::DoubleDouble;
use crate::number::reduction::{self, HALF_PI, ROUNDING};

/// Drive angles at equal steps. Sample `i` is at exactly `start + i · step`, not at the nearest
/// double.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    start: DoubleDouble,
    pub(crate) step: DoubleDouble,
    count: usize,
    /// Samples per turn, if a turn is a whole number of steps from 0.
    per_turn: Option<f64>,
}

impl Sweep {
    /// The largest angle at either end, in rad.
    pub const FARTHEST: f64 = 1e12;

    /// The largest number of samples; four times a sample number is still an exact double and a
    /// `usize`.
    pub const LONGEST: usize = 1 << if usize::BITS > 50 { 50 } else { usize::BITS - 2 };

    /// `count` angles in rad from `start` to `stop`, both included; a single angle is `start`.
    ///
    /// # Errors
    /// `count` is zero or exceeds [`Sweep::LONGEST`]; an end is not finite or exceeds
    /// [`Sweep::FARTHEST`].
    pub fn new(start: f64, stop: f64, count: usize) -> Result<Self> {
        for (name, end) in [("start", start), ("stop", stop)] {
            if end.is_nan() || end.abs() > Self::FARTHEST {
                let rule = Rule::new("rad", "a sweep must end within 1e12 rad of zero");
                return Err(Error::of_value(name, &[], end, rule));
            }
        }
        check_count("num", count)?;
        let steps = DoubleDouble::exact((count - 1).max(1) as f64);
        let step = DoubleDouble::two_sum(stop, -start) / steps;
        Ok(Self { start: DoubleDouble::exact(start), step: step.rounded(), count, per_turn: None })
    }

    /// `count` angles from 0 on, `per_turn` of them to a turn.
    ///
    /// ```
    /// let sweep = cardan::Sweep::of_turns(1440, 720)?;
    /// assert_eq!(sweep.at(180), std::f64::consts::FRAC_PI_2);
    /// # Ok::<(), cardan::Error>(())
    /// ```
    ///
    /// # Errors
    /// `count` or `per_turn` is zero or exceeds [`Sweep::LONGEST`].
    pub fn of_turns(count: usize, per_turn: usize) -> Result<Self> {
        check_count("turns", count)?;
        check_count("samples", per_turn)?;
        let step = DoubleDouble::new(TAU, 4.0 * HALF_PI[1]) / DoubleDouble::exact(per_turn as f64);
        let per_turn = Some(per_turn as f64);
        Ok(Self { start: DoubleDouble::default(), step: step.rounded(), count, per_turn })
    }

    /// Number of angles.
    pub fn count(&self) -> usize {
        self.count
    }

    /// The first angle, an exact double.
    pub(crate) fn first(&self) -> &[f64] {
        from_ref(&self.start.high)
    }

    /// The step, rounded to a double.
    pub(crate) fn step(&self) -> f64 {
        self.step.value()
    }

    /// Angle of sample `i` in rad, rounded to a double.
    pub fn at(&self, i: usize) -> f64 {
        self.angle(i as f64).value()
    }

    /// The number of samples after which the pins repeat, with their sense or up to it.
    pub(crate) fn period(&self, sensed: bool) -> Option<usize> {
        let per_turn = self.per_turn? as usize;
        Some(if sensed || per_turn % 2 == 1 { per_turn } else { per_turn / 2 })
    }

    /// Angle of sample `i`, a whole number.
    #[inline(always)]
    pub(crate) fn angle(&self, i: f64) -> DoubleDouble {
        self.start + self.turn_after(i)
    }

    #[inline(always)]
    pub(crate) fn starts_at_zero(&self) -> bool {
        self.start.high == 0.0
    }

    /// The rotation of the drive from the first sample to sample `i`.
    #[inline(always)]
    pub(crate) fn turn_after(&self, i: f64) -> DoubleDouble {
        let DoubleDouble { high, low } = DoubleDouble::two_product(i, self.step.high);
        DoubleDouble { high, low: i.mul_add(self.step.low, low) }
    }

    /// The number of samples in a quarter turn, and the number of the sample at angle zero, both
    /// with their fractions.
    #[inline(always)]
    pub(crate) fn quarter_and_zero(&self) -> [DoubleDouble; 2] {
        [DoubleDouble::new(HALF_PI[0], HALF_PI[1]) / self.step, -self.start / self.step]
    }

    /// The sweep over twice the angles.
    #[inline(always)]
    pub(crate) fn double_angle(&self) -> Self {
        Self {
            start: self.start.scaled(2.0),
            step: self.step.scaled(2.0),
            count: self.count,
            per_turn: self.per_turn.map(|per_turn| 0.5 * per_turn),
        }
    }

    /// The reduction of the sweep's angles to multiples of π/2.
    #[inline(always)]
    pub(crate) fn reduction(&self) -> AngleReduction {
        match self.per_turn {
            Some(per_turn) => AngleReduction::OfTurns {
                per_turn,
                inverse: 1.0 / per_turn,
                quarter: self.step.scaled(0.25),
            },
            None => AngleReduction::OfAngles(*self),
        }
    }
}

/// How the remainder of a sample is computed from its number.
#[derive(Clone, Copy)]
pub(crate) enum AngleReduction {
    /// In units of a quarter step, counted exactly, so that only the end result is rounded.
    OfTurns { per_turn: f64, inverse: f64, quarter: DoubleDouble },
    /// From the angle.
    OfAngles(Sweep),
}

impl AngleReduction {
    #[inline(always)]
    pub(crate) fn of_turns(
        per_turn: f64,
        inverse: f64,
        quarter: DoubleDouble,
        i: f64,
    ) -> (DoubleDouble, u64) {
        let quarters = 4.0 * i;
        let shifted = quarters.mul_add(inverse, ROUNDING);
        let steps = (shifted - ROUNDING).mul_add(-per_turn, quarters);
        let DoubleDouble { high, low } = DoubleDouble::two_product(steps, quarter.high);
        (DoubleDouble { high, low: steps.mul_add(quarter.low, low) }, shifted.to_bits())
    }

    #[inline(always)]
    pub(crate) fn of_angles(sweep: &Sweep, i: f64) -> (DoubleDouble, u64) {
        reduction::reduce_double_double(sweep.angle(i))
    }

    /// Remainder and multiple for sample `i`, with either reduction.
    #[inline(always)]
    pub(crate) fn of(&self, i: f64) -> (DoubleDouble, u64) {
        match *self {
            Self::OfTurns { per_turn, inverse, quarter } => {
                Self::of_turns(per_turn, inverse, quarter, i)
            }
            Self::OfAngles(ref sweep) => Self::of_angles(sweep, i),
        }
    }
}

fn check_count(argument: &'static str, count: usize) -> Result<()> {
    if (1..=Sweep::LONGEST).contains(&count) {
        return Ok(());
    }
    let problem = format!("makes {count} samples; a sweep has 1 to {}", Sweep::LONGEST);
    Err(Error::new(argument, &[], problem))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_have_samples() {
        for count in [0, Sweep::LONGEST + 1] {
            let error = Sweep::new(0.0, 1.0, count).unwrap_err().to_string();
            assert!(error.contains(&format!("makes {count} samples; a sweep has 1 to")), "{error}");
        }
    }

    #[test]
    fn pins_stand_as_before_after_a_period() {
        for per_turn in [720, 721, 722, 9, 2, 1] {
            let sweep = Sweep::of_turns(10, per_turn).unwrap();
            let reduction = sweep.reduction();
            for (sensed, sense) in [(false, 1), (true, 3)] {
                let period = sweep.period(sensed).unwrap();
                for i in [0, 1, 100, 12_345] {
                    let [(r, n), (again, later)] = [i, i + period].map(|i| reduction.of(i as f64));
                    assert_eq!(r, again);
                    assert_eq!(later.wrapping_sub(n) & sense, 0);
                }
            }
        }
        assert_eq!(Sweep::new(0.0, TAU, 100).unwrap().period(false), None);
    }
}
