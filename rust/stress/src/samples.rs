//! Where the samples come from: at random, and where it is hard.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::LazyLock;

use crate::angle;

/// The last bend below a right angle.
const LAST: f64 = FRAC_PI_2.next_down();

/// Numbers at random (S. Vigna's splitmix64).
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    pub(crate) fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * ((self.bits() >> 11) as f64 * 0.5_f64.powi(53))
    }

    /// A power of ten, spread evenly over the exponents.
    pub(crate) fn power(&mut self, least: f64, most: f64) -> f64 {
        10_f64.powf(self.between(least, most))
    }

    pub(crate) fn pick<T: Copy>(&mut self, of: &[T]) -> T {
        of[self.below(of.len())]
    }

    pub(crate) fn sign(&mut self) -> f64 {
        if self.bits() & 1 == 0 { 1.0 } else { -1.0 }
    }

    /// A neighbour of a double, at most so many steps away.
    pub(crate) fn beside(&mut self, x: f64, steps: usize) -> f64 {
        let step = self.below(2 * steps + 1) as i64 - steps as i64;
        let near = f64::from_bits(x.to_bits().wrapping_add_signed(step));
        // Beyond the largest double nothing is a number.
        if near.is_finite() { near } else { x }
    }
}

/// How the samples of a block are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Random,
    Spread,
    Reduction,
    Quarters,
    Steep,
    Switches,
    Search,
    Apart,
    Sweep,
}

impl Kind {
    pub(crate) const ALL: [Self; 9] = [
        Self::Random,
        Self::Spread,
        Self::Reduction,
        Self::Quarters,
        Self::Steep,
        Self::Switches,
        Self::Search,
        Self::Apart,
        Self::Sweep,
    ];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Random => "random bends, angles to ±8, ±1e3 and ±1e6 rad",
            Self::Spread => "bends and angles spread over all orders of magnitude",
            Self::Reduction => "the doubles nearest to multiples of π/2, and their neighbours",
            Self::Quarters => "neighbours of multiples of π/4, to 1.7e12 and beyond",
            Self::Steep => "bends near 90°, angles where the shaft turns fastest",
            Self::Switches => "where another polynomial or formula takes over",
            Self::Search => "around the worst samples so far",
            Self::Apart => "all of these, with a bend for each sample",
            Self::Sweep => "exact sweeps, from end to end and by whole turns",
        }
    }
}

/// A sample of one joint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct JointSample {
    pub(crate) bend: f64,
    pub(crate) angle: f64,
    /// Torque in N·m; also the inertia of a flywheel.
    pub(crate) torque: f64,
}

impl JointSample {
    /// Of the bend.
    pub(crate) fn cosine(&self) -> f64 {
        self.bend.cos()
    }
}

/// The doubles nearest to multiples of π/2 for each exponent: the convergents of `2ᵉ·2/π` and what
/// lies between the last of them.
pub(crate) static HARDEST: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let mut found = vec![];
    for exponent in -60..=971 {
        let unit = 2_f64.powi(exponent);
        let (mut a, mut b) = (1_u128 << 127, angle::fraction_of_quarter(unit));
        let (mut before, mut m) = (0_u64, 1_u64);
        while b != 0 {
            let digit = a / b;
            (a, b) = (b, a % b);
            // The last ones that fit, if not all do.
            let room = u128::from(((1_u64 << 53) - before) / m);
            for digit in digit.min(room).saturating_sub(1)..=digit.min(room) {
                let between = before + digit as u64 * m;
                if between > 1 << 30 && between as f64 * unit < f64::MAX {
                    found.push(between as f64 * unit);
                }
            }
            if digit > room {
                break;
            }
            (before, m) = (m, before + digit as u64 * m);
        }
    }
    found
});

/// Bends whose largest tangents of the angle error are the ends of the polynomials' ranges.
static SWITCHES: LazyLock<Vec<f64>> = LazyLock::new(|| {
    let tangents = [0.008, 0.1004, 0.32, 0.414_213_562_373_095_03, 1.0, 2.414_213_562_373_095];
    let bend = |t: &f64| {
        let root = t.hypot(1.0) - t;
        (root * root).acos()
    };
    tangents.iter().map(bend).chain([0.25 * TAU / 2.0]).collect()
});

fn any_bend(random: &mut Random) -> f64 {
    match random.below(8) {
        0..=2 => random.between(0.0, LAST),
        3 => random.between(0.0, 0.6),
        4 => random.power(-14.0, 0.19),
        5 => steep_bend(random),
        6 => {
            let switch = random.pick(&SWITCHES);
            random.beside(switch, 3)
        }
        _ => random.between(0.0, 90.0).floor().to_radians(),
    }
}

fn steep_bend(random: &mut Random) -> f64 {
    let steep = match random.below(4) {
        0 => LAST.to_bits() as i64 - random.power(0.0, 7.0) as i64,
        1 => return random.between(1.4, LAST),
        _ => return FRAC_PI_2 - random.power(-16.0, -0.3).max(3e-16),
    };
    f64::from_bits(steep as u64)
}

fn random_angle(random: &mut Random) -> f64 {
    let size = random.pick(&[8.0, 8.0, 8.0, 1e3, 1e6]);
    random.between(-size, size)
}

/// An angle beside a multiple of π/4, up to where each way of reduction ends and beyond.
fn quarter_angle(random: &mut Random) -> f64 {
    let power = random.pick(&[1.0, 2.0, 4.0, 8.0, 12.0, 12.4, 13.0, 15.0]);
    let count = random.power(0.0, power).floor();
    let angle = count * FRAC_PI_2 * random.pick(&[1.0, 1.0, 0.5]);
    random.beside(angle, 4) * random.sign()
}

/// An angle at which a steep joint hastens: within a few times `cos β` of a multiple of π/2.
fn hastening_angle(random: &mut Random, bend: f64) -> f64 {
    let cosine = (FRAC_PI_2 - bend).max(1e-17);
    let count = random.power(0.0, 3.0).floor() - 1.0;
    let aside = cosine * random.power(-3.0, 3.0) * random.sign();
    random.sign() * (count * FRAC_PI_2 + aside)
}

/// An angle where the error or the acceleration is largest.
fn extreme_angle(random: &mut Random, bend: f64) -> f64 {
    let cosine = bend.cos();
    let sine2 = bend.sin().powi(2);
    let p = (2.0 - sine2) / sine2;
    let angle = match random.below(3) {
        0 => cosine.sqrt().atan(),
        1 => 0.5 * (4.0 / (p + (p * p + 8.0).sqrt())).acos(),
        // Where the tangent of the error passes that of 22.5° or 67.5°: the versine over twice
        // the tangent, plus and minus a root.
        _ => {
            let tangent = random.pick(&[0.414_213_562_373_095_03, 2.414_213_562_373_095]);
            let half = (1.0 - cosine) / (2.0 * tangent);
            (half + random.sign() * (half * half - cosine).max(0.0).sqrt()).atan()
        }
    };
    let near = angle * (1.0 + random.sign() * random.power(-16.0, -2.0));
    random.sign() * (near + FRAC_PI_2 * random.below(9) as f64)
}

fn spread_angle(random: &mut Random) -> f64 {
    let (least, most) = random.pick(&[(-270.0, 308.0), (-12.0, 12.0), (-12.0, 2.0)]);
    random.power(least, most).min(f64::MAX) * random.sign()
}

fn hard_angle(random: &mut Random) -> f64 {
    let angle = random.pick(&HARDEST);
    let steps = random.pick(&[0, 0, 1, 4]);
    random.beside(angle, steps).min(f64::MAX) * random.sign()
}

fn any_angle(random: &mut Random, bend: f64) -> f64 {
    match random.below(8) {
        0 | 1 => random_angle(random),
        2 | 3 => spread_angle(random),
        4 => hard_angle(random),
        5 => quarter_angle(random),
        6 => hastening_angle(random, bend),
        _ => extreme_angle(random, bend),
    }
}

/// Another number beside `x`: some steps away, or by a random part of its distance from `centre`.
fn moved(random: &mut Random, x: f64, centre: f64) -> f64 {
    match random.below(3) {
        0 => random.beside(x, 64),
        1 => x * (1.0 + random.sign() * random.power(-16.0, -1.0)),
        _ => centre + (x - centre) * (1.0 + random.sign() * random.power(-16.0, -1.0)),
    }
}

impl Kind {
    /// A bend for a row of samples.
    pub(crate) fn bend(self, random: &mut Random, worst: &[JointSample]) -> f64 {
        let bend = match self {
            Self::Random => {
                let most = random.pick(&[LAST, 0.6]);
                random.between(0.0, most)
            }
            Self::Spread => match random.below(2) {
                0 => random.power(-14.0, 0.19),
                _ => FRAC_PI_2 - random.power(-16.0, 0.0),
            },
            Self::Reduction | Self::Quarters | Self::Apart | Self::Sweep => any_bend(random),
            Self::Steep => steep_bend(random),
            Self::Switches => {
                let switch = random.pick(&SWITCHES);
                let steps = random.pick(&[2, 1 << 20, 1 << 45]);
                random.beside(switch, steps)
            }
            Self::Search if worst.is_empty() => any_bend(random),
            Self::Search => {
                let found = random.pick(worst).bend;
                if random.below(4) == 0 { found } else { moved(random, found, FRAC_PI_2) }
            }
        };
        bend.clamp(1e-14, LAST)
    }

    /// An angle for a sample with this bend.
    pub(crate) fn angle(self, random: &mut Random, bend: f64, worst: &[JointSample]) -> f64 {
        let angle = match self {
            Self::Random => random_angle(random),
            Self::Spread => spread_angle(random),
            Self::Reduction => hard_angle(random),
            Self::Quarters => quarter_angle(random),
            Self::Steep => match random.below(4) {
                0 => any_angle(random, bend),
                1 => extreme_angle(random, bend),
                _ => hastening_angle(random, bend),
            },
            Self::Switches => extreme_angle(random, bend),
            Self::Apart | Self::Sweep => any_angle(random, bend),
            Self::Search => {
                let near: Vec<_> =
                    worst.iter().filter(|s| (s.bend / bend).ln().abs() < 0.2).collect();
                if near.is_empty() {
                    any_angle(random, bend)
                } else {
                    let found = near[random.below(near.len())].angle;
                    moved(random, found, (found / FRAC_PI_2).round() * FRAC_PI_2)
                }
            }
        };
        angle.clamp(-f64::MAX, f64::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hardest_doubles_are_found() {
        // The nearest of all, and the nearest below 2⁶⁰ (Muller et al., Handbook of Floating-Point
        // Arithmetic, 2018, section 10.2).
        for known in [6_381_956_970_095_103.0 * 2_f64.powi(797), 45.553_093_477_052] {
            assert!(HARDEST.contains(&known));
        }
        // Each comes so near to a multiple of π/2 as few do by chance.
        for &angle in HARDEST.iter().filter(|&&angle| angle > 1.0) {
            let (remainder, _) = angle::reduce(&[angle]);
            assert!(remainder.high.abs() < 1e-7, "{angle:e} {:e}", remainder.high);
        }
    }
}
