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

impl To {
    /// The number of joints and intermediate shafts before it.
    fn elements(self) -> usize {
        match self {
            Self::Shaft(shaft) => 2 * shaft - 1,
            Self::Joint(joint) => 2 * joint,
        }
    }
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
    /// How many joints and intermediate shafts it passes.
    elements: usize,
}

/// The maps of one driveline: with the fewest words, with twice as many, and so on, each as far as it
/// was needed. Ends that follow each other along the chain pass each of its elements once per number
/// of words.
#[derive(Clone, Debug, Default)]
pub(crate) struct ExactMaps(Vec<ExactMap>);

/// The fewest words and the most, and the digits that a result needs.
const FEWEST: usize = 4;
const MOST: usize = 32;
const ENOUGH: i64 = 128;

impl ExactMaps {
    /// The map to an end, with enough digits.
    pub(crate) fn map(&mut self, chains: Chains<'_>, line: usize, to: To) -> ExactMap {
        let mut words = FEWEST;
        for kept in 0.. {
            if kept == self.0.len() {
                self.0.push(ExactMap::identity(words));
            }
            let map = &mut self.0[kept];
            map.pass(chains, line, to);
            if map.suffices(to) {
                return map.clone();
            }
            if words >= MOST {
                let mut map = map.clone();
                // What is left is smaller than any double.
                if map.b.digits() < ENOUGH {
                    map.b = FixedComplex::zero(words);
                }
                return map;
            }
            words *= 2;
        }
        unreachable!("the words reach the most")
    }
}

impl ExactMap {
    /// The map to an end, with enough digits.
    pub(crate) fn new(chains: Chains<'_>, line: usize, to: To) -> Self {
        ExactMaps::default().map(chains, line, to)
    }

    fn with_words(chains: Chains<'_>, line: usize, to: To, words: usize) -> Self {
        let mut map = Self::identity(words);
        map.pass(chains, line, to);
        map
    }

    fn identity(words: usize) -> Self {
        Self {
            a: FixedComplex::one(words),
            b: FixedComplex::zero(words),
            words,
            complement: DoubleDouble::ONE,
            elements: 0,
        }
    }

    /// Appends the joints and shafts from its end to another one, which is not before it.
    fn pass(&mut self, chains: Chains<'_>, line: usize, to: To) {
        let (first, between) = (line * chains.joints, line * (chains.joints - 1));
        for element in self.elements..to.elements() {
            let j = element / 2;
            if element.is_multiple_of(2) {
                self.pass_joint(chains.bends[first + j]);
            } else {
                self.pass_shaft(chains.phases[between + j], chains.twists[between + j]);
            }
        }
        self.elements = to.elements();
    }

    fn pass_joint(&mut self, bend: f64) {
        let half = FixedComplex::turn(&[0.5 * bend], self.words);
        let (keep, turn_back) = (&half.re * &half.re, &half.im * &half.im);
        (self.a, self.b) = (
            &self.a.times(&keep) - &self.b.conj().times(&turn_back),
            &self.b.times(&keep) - &self.a.conj().times(&turn_back),
        );
        self.complement = self.complement * Joint::of_chain(bend).cos;
    }

    fn pass_shaft(&mut self, phase: f64, twist: f64) {
        let turn = FixedComplex::turn(&[phase, -twist], self.words);
        // A quarter turn ahead of the difference.
        let turn = FixedComplex { re: -&turn.im, im: turn.re };
        (self.a, self.b) = (&self.a * &turn, &self.b * &turn);
    }

    /// Whether it has enough digits for what follows from it at this end.
    fn suffices(&self, to: To) -> bool {
        match to {
            // Zero is no exception: a small number is zero in few words.
            To::Shaft(_) => [&self.a, &self.b].iter().all(|x| x.digits() >= ENOUGH),
            To::Joint(_) => self.rows().iter().all(|row| row.digits() >= ENOUGH),
        }
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

    /// The parts of a complex number that `product` makes of the map and the pin. Each part has its
    /// digits, or is smaller than any double and therefore zero.
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
            let enough = |x: &Fixed| x.digits() >= ENOUGH;
            if words < MOST && !(enough(&number.re) && enough(&number.im)) {
                let longer = ExactMap::with_words(self.chains, line, self.to, 2 * words);
                self.map = Some((line, longer));
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
        if length.high == 0.0 {
            // The joint does nothing at any angle.
            return [DoubleDouble::ONE, DoubleDouble::default()];
        }
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
            assert_eq!(map.b.digits(), 0);
        }
    }

    #[test]
    fn small_numbers_are_not_taken_for_zero() {
        for exponent in [-30, -45, -100, -160] {
            let bends = [0.0, 10_f64.powi(exponent)];
            let mut samples = ExactSamples::new(chains(&bends, &[0.4], &[0.4]), To::Shaft(2));
            let angle = ExactAngle { parts: [1e-12, 0.0], quarters: 0 };
            let [x, y] = samples.double_angle(0, angle).map(DoubleDouble::value);
            assert!(x.abs() == 1.0 && (y.abs() - 2e-12).abs() < 1e-26, "{bends:?}: {x} {y:e}");
        }
    }

    #[test]
    fn a_bend_without_any_effect_has_a_direction() {
        let bends = [0.0, f64::from_bits(1)];
        let mut samples = ExactSamples::new(chains(&bends, &[0.4], &[0.4]), To::Shaft(2));
        let angle = ExactAngle { parts: [1e-12, 0.0], quarters: 0 };
        assert_eq!(samples.double_angle(0, angle), [DoubleDouble::ONE, DoubleDouble::default()]);
    }

    /// Ends of a chain of so many joints, in order.
    fn ends(joints: usize) -> impl Iterator<Item = To> {
        (1..joints).flat_map(|j| [To::Joint(j), To::Shaft(j + 1)])
    }

    #[test]
    fn maps_that_are_kept_are_those_that_begin_at_the_drive() {
        // Each pair of the first 72 joints compensates itself and divides the map by 3000.
        let bends: Vec<f64> = (0..78).map(|j| if j < 72 { 1.5705 } else { 0.3 }).collect();
        let turned = |j: i32| if j < 72 { 0.4 } else { f64::from(j).sin() };
        let twists: Vec<f64> = (0..77).map(turned).collect();
        let chains = chains(&bends, &twists, &[0.4; 77]);
        let mut maps = ExactMaps::default();
        for to in ends(78) {
            let (kept, new) = (maps.map(chains, 0, to), ExactMap::new(chains, 0, to));
            assert_eq!(kept.words, new.words, "{to:?}");
            assert_eq!(kept.matrix(), new.matrix(), "{to:?}");
            let [kept, new] = [kept, new].map(|map| map.transfer());
            assert_eq!((kept.a, kept.b, kept.complement), (new.a, new.b, new.complement));
        }
        assert!(maps.0.len() > 2);
    }

    #[test]
    fn a_map_that_is_kept_does_not_pass_a_joint_again() {
        let (bends, shafts) = ([0.3, 1.2, 0.7, 0.4], [0.4, -2.0, 0.9]);
        let wanted = ExactMap::new(chains(&bends, &shafts, &shafts), 0, To::Shaft(4)).transfer();
        let mut maps = ExactMaps::default();
        for to in ends(4) {
            // Whatever lies two joints before the end is not looked at.
            let (mut bends, mut shafts) = (bends, shafts);
            let passed = (to.elements() / 2).saturating_sub(2);
            bends[..passed].fill(f64::NAN);
            shafts[..passed].fill(f64::NAN);
            let found = maps.map(chains(&bends, &shafts, &shafts), 0, to).transfer();
            if to == To::Shaft(4) {
                assert_eq!((found.a, found.b), (wanted.a, wanted.b));
            }
        }
        assert_eq!(maps.0.len(), 1);
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
