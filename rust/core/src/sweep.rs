//! Uniform sweeps of the drive: angles that need no array.

use std::f64::consts::TAU;
use std::slice::from_ref;

use crate::column::ViewMut;
use crate::error::{Error, Result};
use crate::pair::Pair;
use crate::real::Word;
use crate::reduce::{self, HALF_PI, ROUNDING};
use crate::trig::{self, Angle};

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
            if end.is_nan() || end.abs() > Self::FARTHEST {
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
    /// ```
    /// let sweep = cardan::Sweep::of_turns(1440, 720)?;
    /// assert_eq!(sweep.at(180), std::f64::consts::FRAC_PI_2);
    /// # Ok::<(), cardan::Error>(())
    /// ```
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

    /// The first angle, an exact double.
    pub(crate) fn first(&self) -> &[f64] {
        from_ref(&self.start.high)
    }

    /// The step, the nearest double.
    pub(crate) fn step(&self) -> f64 {
        self.step.value()
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
        self.start + self.turned(i)
    }

    #[inline(always)]
    pub(crate) fn starts_at_zero(&self) -> bool {
        self.start.high == 0.0
    }

    /// What the drive has turned from the start to sample `i`.
    #[inline(always)]
    pub(crate) fn turned(&self, i: f64) -> Pair {
        let Pair { high, low } = Pair::product(i, self.step.high);
        Pair { high, low: i.mul_add(self.step.low, low) }
    }

    /// The samples in a quarter turn, and the number of the sample at zero, both with their fractions.
    #[inline(always)]
    pub(crate) fn quarter_and_zero(&self) -> [Pair; 2] {
        [Pair::new(HALF_PI[0], HALF_PI[1]) / self.step, -self.start / self.step]
    }

    /// The sweep of twice the angles.
    #[inline(always)]
    pub(crate) fn twice(&self) -> Self {
        Self {
            start: self.start.scaled(2.0),
            step: self.step.scaled(2.0),
            count: self.count,
            per_turn: self.per_turn.map(|per_turn| 0.5 * per_turn),
        }
    }

    /// How to find the remainder of sample `i` to the nearest multiple of π/2, and the multiple.
    #[inline(always)]
    pub(crate) fn reduction(&self) -> Reduction {
        match self.per_turn {
            Some(per_turn) => Reduction::OfTurns {
                per_turn,
                inverse: 1.0 / per_turn,
                quarter: self.step.scaled(0.25),
            },
            None => Reduction::OfAngles(*self),
        }
    }
}

/// A way from sample numbers to remainders.
#[derive(Clone, Copy)]
pub(crate) enum Reduction {
    /// In halves of a quarter of a step at the least, so that nothing is rounded before the end.
    OfTurns { per_turn: f64, inverse: f64, quarter: Pair },
    /// By way of the angle.
    OfAngles(Sweep),
}

impl Reduction {
    #[inline(always)]
    pub(crate) fn of_turns(per_turn: f64, inverse: f64, quarter: Pair, i: f64) -> (Pair, u64) {
        let quarters = 4.0 * i;
        let shifted = quarters.mul_add(inverse, ROUNDING);
        let steps = (shifted - ROUNDING).mul_add(-per_turn, quarters);
        let Pair { high, low } = Pair::product(steps, quarter.high);
        (Pair { high, low: steps.mul_add(quarter.low, low) }, shifted.to_bits())
    }

    #[inline(always)]
    pub(crate) fn of_angles(sweep: &Sweep, i: f64) -> (Pair, u64) {
        reduce::reduce_in_two(sweep.angle(i))
    }

    /// The same for one sample, whichever way.
    #[inline(always)]
    pub(crate) fn of(&self, i: f64) -> (Pair, u64) {
        match *self {
            Self::OfTurns { per_turn, inverse, quarter } => {
                Self::of_turns(per_turn, inverse, quarter, i)
            }
            Self::OfAngles(ref sweep) => Self::of_angles(sweep, i),
        }
    }
}

/// Tangents of whole steps about the middle of a group of samples. The samples of a group take
/// theirs from that of the middle by the addition theorem, `(a + b)/(1 − a b)`: no sine each.
#[derive(Clone, Debug)]
pub(crate) struct Group<T: Angle> {
    tangents: [Vec<T::Word>; 2],
}

impl<T: Angle> Group<T> {
    /// The widest turn from the middle: with the eighth of a turn that its remainder may have, the
    /// cosine of the sum stays away from zero.
    const WIDEST: f64 = 0.39;

    /// Samples that are nearer to a quarter turn than this part of their middle have a sum that
    /// cancels more than its error terms make good.
    const CANCELLED: f64 = 1.0 / 1024.0;

    /// The fewest samples that repay a group.
    const FEWEST: usize = 32;

    /// A group of at most so many samples of a sweep, if its steps are short enough to repay one.
    #[inline(always)]
    pub(crate) fn new(sweep: &Sweep, longest: usize) -> Option<Self> {
        let half = (Self::WIDEST / sweep.step.high.abs()).min(longest as f64 / 2.0) as usize;
        let length = 2 * half / 16 * 16;
        if length < Self::FEWEST {
            return None;
        }
        let mut tangents = [vec![T::Word::default(); length], vec![T::Word::default(); length]];
        let [high, low] = &mut tangents;
        for (i, (high, low)) in high.iter_mut().zip(low).enumerate() {
            let steps = Pair::exact(i as f64 - (length / 2) as f64);
            let (numerator, denominator) = Pair::tangent(steps * sweep.step);
            [*high, *low] = words::<T>(numerator / denominator);
        }
        Some(Self { tangents })
    }

    pub(crate) fn length(&self) -> usize {
        self.tangents[0].len()
    }

    /// Sine and cosine up to a positive factor of the samples from `first` on.
    #[inline(always)]
    pub(crate) fn pins(
        &self,
        sweep: &Sweep,
        first: usize,
        mut sine: ViewMut<'_, T>,
        mut cosine: ViewMut<'_, T>,
    ) {
        const MOST: usize = 64;
        let length = self.length();
        let reduction = sweep.reduction();
        let count = sine.len();
        let mut middles = [([T::Word::default(); 2], 0_u64, 0.0); MOST];
        let mut at = 0;
        while at < count {
            // The middles of the next groups side by side, then group by group.
            let group = (first + at) / length;
            let groups = ((first + count).div_ceil(length) - group).min(MOST);
            for (i, middle) in middles[..groups].iter_mut().enumerate() {
                let sample = ((group + i) * length + length / 2) as f64;
                let (remainder, quadrant) = reduction.of(sample);
                let (numerator, denominator) = Pair::tangent(remainder);
                let tangent = words::<T>(numerator / denominator);
                *middle = (tangent, quadrant, remainder.high / sweep.step.high);
            }
            for (i, &(middle, quadrant, steps)) in middles[..groups].iter().enumerate() {
                let begin = (group + i) * length;
                let from = (first + at) - begin;
                let size = (length - from).min(count - at);
                let [high, low] = self.tangents.each_ref().map(|t| &t[from..from + size]);
                let (odd, half) = (quadrant & 1, quadrant >> 1 & 1);
                let (mut s, mut c) = (sine.window(at, size), cosine.window(at, size));
                let tangent = |j: usize| {
                    let (y, x) = T::tangent_of_sum(middle, [high[j], low[j]]);
                    (y.turned_if(half), x.turned_if(half))
                };
                if odd == 1 {
                    for j in 0..size {
                        let (y, x) = tangent(j);
                        s.set(j, x);
                        c.set(j, -y);
                    }
                } else {
                    for j in 0..size {
                        let (y, x) = tangent(j);
                        s.set(j, y);
                        c.set(j, x);
                    }
                }
                // Beside a quarter turn hardly anything is left of the sum but its rounding.
                let crossing = (length / 2) as f64 - steps - from as f64;
                let beside = 1.0 + Self::CANCELLED * steps.abs();
                let near = (crossing - beside).max(0.0) as usize..size;
                for j in near.take_while(|&j| j as f64 <= crossing + beside) {
                    let (r, quadrant) = reduction.of((begin + from + j) as f64);
                    let (y, x) = trig::sensed_pin((T::from_pair(r), quadrant));
                    s.set(j, y);
                    c.set(j, x);
                }
                at += size;
            }
        }
    }
}

/// A number's high word and what is missing to it.
#[inline(always)]
fn words<T: Angle>(number: Pair) -> [T::Word; 2] {
    let high = T::Word::near(number.value());
    [high, T::Word::near((number.high - high.into()) + number.low)]
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
    use crate::column::{Column, columns, views, views_mut};

    #[test]
    fn high_word_and_rest_make_the_number() {
        let third = Pair::exact(1.0) / Pair::exact(3.0);
        assert_eq!(words::<Pair>(third), [third.high, third.low]);
        let [high, rest] = words::<f32>(third).map(f64::from);
        assert!((high + rest - third.value()).abs() < 1e-15);
        assert_ne!(rest, 0.0);
    }

    #[test]
    fn sweeps_have_samples() {
        for count in [0, Sweep::LONGEST + 1] {
            let error = Sweep::new(0.0, 1.0, count).unwrap_err().to_string();
            assert!(error.contains(&format!("makes {count} samples; a sweep has 1 to")), "{error}");
        }
    }

    #[test]
    fn sums_of_tangents_keep_their_digits_beside_quarter_turns() {
        for (start, stop, count) in [(-0.3, 0.2, 5000), (1.0, 20.0, 20_000), (9.7, -5.3, 8191)] {
            let sweep = Sweep::new(start, stop, count).unwrap();
            let group = Group::<Pair>::new(&sweep, 512).unwrap();
            let mut pins: [Column<Pair>; 2] = columns(count);
            let [sine, cosine] = views_mut(&mut pins, 0, count);
            group.pins(&sweep, 0, sine, cosine);
            let [sine, cosine] = views(&pins, count);
            for i in 0..count {
                let (s, c) = trig::sin_cos_in_two(sweep.reduction().of(i as f64));
                let (y, x) = (sine.get(i), cosine.get(i));
                let length = (y * s + x * c).value();
                let least = s.value().abs().min(c.value().abs());
                let error = (y * c - x * s).value() / length;
                assert!(error.abs() < 2_f64.powi(-54) * least, "{i}: {error:e} of {least:e}");
            }
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
