//! The map of a chain with as many digits as it takes.
//!
//! Steep joints, and joints that compensate each other, leave few of a double-double's digits, and
//! next to a zero the drive angle leaves few of the sum with the chain's offset. The few
//! drivelines and samples concerned are computed here.

use crate::mechanics::chain::{Complex, Transfer};
use crate::mechanics::joint::Joint;
use crate::number::double_double::DoubleDouble;
use crate::number::fixed::{Fixed, FixedComplex};
use crate::number::float::Real;

/// The joints and the intermediate shafts of a batch of drivelines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chains<'a> {
    pub(crate) joints: usize,
    pub(crate) bends: &'a [f64],
    pub(crate) twists: &'a [f64],
    pub(crate) phases: &'a [f64],
}

/// The end of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum To {
    /// A shaft, behind the joint before it.
    Shaft(usize),
    /// The driving yoke of a joint.
    Joint(usize),
}

/// The map `w → A w + B w̄` of a chain, multiplied by the squares of the cosines of half its bends,
/// which spares divisions.
#[derive(Clone, Debug)]
pub(crate) struct ExactMap {
    a: FixedComplex,
    b: FixedComplex,
    words: usize,
    /// `|A|² − |B|²`.
    complement: DoubleDouble,
}

/// The fewest words and the most, and the digits that a result needs.
const FEWEST: usize = 4;
const MOST: usize = 32;
const ENOUGH: i64 = 128;

impl ExactMap {
    /// The map, with enough digits.
    pub(crate) fn new(chains: Chains<'_>, line: usize, to: To) -> Self {
        Self::longer(chains, line, to, FEWEST, |map| {
            let [cosine, sine] = map.rows();
            match to {
                To::Shaft(_) => {
                    [&map.a, &map.b].iter().all(|x| x.is_zero() || x.digits() >= ENOUGH)
                }
                To::Joint(_) => [cosine, sine].iter().all(|row| row.digits() >= ENOUGH),
            }
        })
    }

    /// The map with at least `words` words, and as many as `suffices` asks for.
    fn longer(
        chains: Chains<'_>,
        line: usize,
        to: To,
        mut words: usize,
        suffices: impl Fn(&Self) -> bool,
    ) -> Self {
        loop {
            let mut map = Self::with_words(chains, line, to, words);
            if suffices(&map) {
                return map;
            }
            if words >= MOST {
                // What is left is smaller than any double.
                if map.b.digits() < ENOUGH {
                    map.b = FixedComplex::zero(words);
                }
                return map;
            }
            words *= 2;
        }
    }

    fn with_words(chains: Chains<'_>, line: usize, to: To, words: usize) -> Self {
        let (first, between) = (line * chains.joints, line * (chains.joints - 1));
        let (mut a, mut b) = (FixedComplex::one(words), FixedComplex::zero(words));
        let mut complement = DoubleDouble::ONE;
        let (joints, shafts) = match to {
            To::Shaft(shaft) => (shaft, shaft - 1),
            To::Joint(joint) => (joint, joint),
        };
        for j in 0..joints {
            let bend = chains.bends[first + j];
            let half = FixedComplex::turn(&[0.5 * bend], words);
            let (keep, turn_back) = (&half.re * &half.re, &half.im * &half.im);
            (a, b) = (
                &a.times(&keep) - &b.conj().times(&turn_back),
                &b.times(&keep) - &a.conj().times(&turn_back),
            );
            complement = complement * Joint::of_chain(bend).cos;
            if j < shafts {
                let (phase, twist) = (chains.phases[between + j], chains.twists[between + j]);
                let turn = FixedComplex::turn(&[phase, -twist], words);
                // A quarter turn ahead of the difference.
                let turn = FixedComplex { re: -&turn.im, im: turn.re };
                (a, b) = (&a * &turn, &b * &turn);
            }
        }
        Self { a, b, words, complement }
    }

    /// The vectors whose products with `(cos α, sin α)` are cosine and sine behind the map.
    fn rows(&self) -> [FixedComplex; 2] {
        let (a, b) = (&self.a, &self.b);
        [
            FixedComplex { re: &a.re + &b.re, im: &b.im - &a.im },
            FixedComplex { re: &a.im + &b.im, im: &a.re - &b.re },
        ]
    }

    /// The power of two that makes `|A|` about 1.
    fn power(&self) -> i64 {
        64 * self.words as i64 - self.a.digits()
    }

    /// The map in double-double numbers.
    pub(crate) fn transfer(&self) -> Transfer {
        let power = self.power();
        let [a, b] =
            [&self.a, &self.b].map(|x| Complex::new(x.re.scaled(power), x.im.scaled(power)));
        let square = 2_f64.powi(power as i32);
        Transfer { a, b, complement: self.complement.scaled(square).scaled(square) }
    }

    /// The rows of the map as a matrix, in double-double numbers.
    pub(crate) fn matrix(&self) -> [DoubleDouble; 4] {
        let [cosine, sine] = self.rows();
        [cosine.re, cosine.im, sine.re, sine.im].map(|x| x.scaled(self.power()))
    }
}

/// The angle of one sample: a sum of doubles, and a number of quarter turns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExactAngle {
    pub(crate) parts: [f64; 2],
    pub(crate) quarters: u64,
}

impl ExactAngle {
    fn pin(self, words: usize) -> FixedComplex {
        let mut w = FixedComplex::turn(&self.parts, words);
        for _ in 0..self.quarters & 3 {
            w = FixedComplex { re: -&w.im, im: w.re };
        }
        w
    }
}

/// Samples of one shaft or joint. The map of the last driveline is remembered.
#[derive(Debug)]
pub(crate) struct ExactSamples<'a> {
    chains: Chains<'a>,
    to: To,
    map: Option<(usize, ExactMap)>,
}

impl<'a> ExactSamples<'a> {
    pub(crate) fn new(chains: Chains<'a>, to: To) -> Self {
        Self { chains, to, map: None }
    }

    /// The parts of a complex number that `product` makes of the map and the pin, with the digits
    /// of each part or exactly zero, and at least one of them not.
    fn parts(
        &mut self,
        line: usize,
        angle: ExactAngle,
        product: impl Fn(&ExactMap, &FixedComplex) -> FixedComplex,
    ) -> [DoubleDouble; 2] {
        if self.map.as_ref().is_none_or(|&(of, _)| of != line) {
            self.map = Some((line, ExactMap::new(self.chains, line, self.to)));
        }
        loop {
            let (_, map) = self.map.as_ref().expect("it was made");
            let words = map.words;
            let number = product(map, &angle.pin(words));
            let enough = |x: &Fixed| x.digits() >= ENOUGH || x.is_zero();
            if words < MOST && !(enough(&number.re) && enough(&number.im)) {
                self.map =
                    Some((line, ExactMap::longer(self.chains, line, self.to, 2 * words, |_| true)));
                continue;
            }
            let power = 64 * words as i64 - number.digits();
            let zero = DoubleDouble::default();
            return [number.re, number.im]
                .map(|x| if x.digits() < ENOUGH { zero } else { x.scaled(power) });
        }
    }

    /// Cosine and sine of twice the equivalent joint's input angle.
    pub(crate) fn double_angle(&mut self, line: usize, angle: ExactAngle) -> [DoubleDouble; 2] {
        let [x, y] = self.parts(line, angle, |map, w| {
            let turn = &(w * w) * &(&map.b.conj() * &map.a);
            FixedComplex { re: -&turn.re, im: -&turn.im }
        });
        let length = (x.square() + y.square()).sqrt();
        [x / length, y / length]
    }

    /// Cosine and sine of the equivalent joint's input angle, up to a sign of both.
    pub(crate) fn pin(&mut self, line: usize, angle: ExactAngle) -> [DoubleDouble; 2] {
        let [x, y] = self.double_angle(line, angle);
        let large = (DoubleDouble::ONE + x.abs()).scaled(0.5).sqrt();
        let small = y.scaled(0.5) / large;
        if x.high >= 0.0 { [large, small] } else { [small, large] }
    }

    /// Cosine and sine behind the map, multiplied by a positive length.
    pub(crate) fn turned(&mut self, line: usize, angle: ExactAngle) -> [DoubleDouble; 2] {
        self.parts(line, angle, |map, w| &(&map.a * w) + &(&map.b * &w.conj()))
    }

    /// Cosine and sine of the shaft's angle, multiplied by a positive length.
    pub(crate) fn shaft_angle(&mut self, line: usize, angle: ExactAngle) -> [DoubleDouble; 2] {
        self.parts(line, angle, |map, w| {
            let turned = &(&map.a * w) + &(&map.b * &w.conj());
            &turned * &map.a.conj()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::chain;

    fn chains<'a>(bends: &'a [f64], twists: &'a [f64], phases: &'a [f64]) -> Chains<'a> {
        Chains { joints: bends.len(), bends, twists, phases }
    }

    #[test]
    fn ordinary_chains_have_the_same_map_in_double_doubles() {
        let (bends, twists, phases) = ([0.3, 1.2, 0.7], [0.4, -2.0], [1.1, 3e13]);
        let mut near = Transfer::default();
        for (j, &bend) in bends.iter().enumerate() {
            if j > 0 {
                near.pass_shaft(chain::wide_shaft_turn(phases[j - 1], twists[j - 1]));
            }
            near.pass_joint(&Joint::of_chain(bend));
        }
        let exact = ExactMap::new(chains(&bends, &twists, &phases), 0, To::Shaft(3)).transfer();
        let [near, exact] = [near, exact].map(|map| map.equivalent());
        let pairs = [
            (near.joint.k, exact.joint.k),
            (near.joint.cos, exact.joint.cos),
            (near.turn_cos, exact.turn_cos),
            (near.turn_sin, exact.turn_sin),
        ];
        for (near, exact) in pairs {
            assert!((near - exact).value().abs() < 2_f64.powi(-95));
        }
    }

    #[test]
    fn joints_that_undo_each_other_leave_nothing() {
        let last = std::f64::consts::FRAC_PI_2.next_down();
        for bend in [0.3, last] {
            let map = ExactMap::new(chains(&[bend; 2], &[0.7], &[0.7]), 0, To::Shaft(2));
            assert!(map.b.is_zero());
        }
    }

    #[test]
    fn turns_of_any_size_lie_on_the_circle() {
        for x in [0.0, 1e-300, -0.7, 3.0, 1e5, -7e22, 1e300] {
            let FixedComplex { re, im } = FixedComplex::turn(&[x], 4);
            let (s, c) = crate::number::trig::sin_cos(x);
            assert!((im.scaled(0).value() - s).abs() < 2_f64.powi(-52), "{x:e}");
            assert!((re.scaled(0).value() - c).abs() < 2_f64.powi(-52), "{x:e}");
            let ones = &(&re * &re) + &(&im * &im);
            assert!((ones.scaled(0) - DoubleDouble::ONE).value().abs() < 1e-30, "{x:e}");
        }
    }
}
