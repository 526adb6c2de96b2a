//! Chains: many joints, near-straight, compensated, steep.
//!
//! With `tolerance=0` errors are in ulp of the result, of the jerk ratio in ulp of the larger of its
//! two terms. Otherwise a chain turns its equivalent joint by an angle that is rounded, so near a
//! zero an error cannot be held against the result alone. The unit is then what one joint may be off
//! if its drive angle and its `B/A` are only known as well as they are carried:
//!
//! `ulp(f) + e |∂f/∂α| + n d K/|A| |∂f/∂q|`,
//!
//! `n` joints, `K` the sum of their `tan²(β/2)`, at most 1, whose sines and cosines are within
//! `d = 2⁻⁶⁰`, `A` with the lengths of the pins left in, so that `1/|A|` is what steep joints stretch
//! a rounding by, and `|∂f/∂q|` at most `1/(1 − k)`, `4/(1 − k)²`, `32/(1 − k)³` and `384/(1 − k)⁴`
//! for angle, speed ratio, acceleration ratio and jerk ratio. The angle is known to `e = 2⁻⁵²`, in
//! single precision to 2⁻²³. With `tolerance=0` both are 2⁻⁹⁴, as well as the oracle knows them.

use std::f64::consts::{FRAC_PI_2, PI};

use cardan::{Angles, Axes, Drivelines, Output, Plan, Request, Samples, Source};

use crate::error_table::{ErrorTable, RowLimits};
use crate::exact::{ExactChain, Turn};
use crate::judge::{Quantity, Tier};
use crate::loading::planes;
use crate::samples::{Kind, Random};
use crate::shape_errors::ShapeErrors;

/// What the report says above the table.
const ABOUT: &str = r"With `tolerance=0` the errors of chains are in ulp of the result, and those of the jerk ratio in ulp
of the larger of its two terms. The digits of the oracle, 2⁻⁹⁴, are allowed for. Otherwise a chain
turns its equivalent joint by an angle that has a rounding error, so near a zero an error cannot be
compared with the result alone. The unit is then `ulp(f) + e |∂f/∂α| + n 2⁻⁶⁰ K/|A| |∂f/∂q|`. The
drive angle has the precision `e = 2⁻⁵²` (2⁻²³ in single precision). The sine and cosine of each of
the `n` joints and shafts have the precision 2⁻⁶². `K` is the sum of `tan²(β/2)`, at most 1, and `A`
belongs to the map of the chain, in which the lengths of the pins are not normalised. In these units
a chain meets the limits of one joint, unless `tests/data/limits.toml` has a `worst_chain` for the
default.
";

/// Angles for each chain.
const ANGLES: usize = 50;

const MOTION: [Output; 5] = [
    Output::Angle,
    Output::AngleError,
    Output::SpeedRatio,
    Output::AccelerationRatio,
    Output::JerkRatio,
];

/// The largest errors of the outputs in a tier.
fn limits(tier: Tier) -> [f64; 5] {
    MOTION.map(|output| tier.chain_limit(Quantity::Of(output)))
}

/// A driveline's bends, twists and phases.
#[derive(Debug)]
pub(crate) struct ChainAngles {
    pub(crate) bends: Vec<f64>,
    pub(crate) twists: Vec<f64>,
    pub(crate) phases: Vec<f64>,
}

impl ChainAngles {
    /// Directions of shafts for [`ChainAngles::drivelines`]: the motion does not depend on them.
    pub(crate) fn zero_directions(&self) -> Vec<f64> {
        vec![0.0; 3 * (self.bends.len() + 1)]
    }

    pub(crate) fn drivelines<'a>(&'a self, zero_directions: &'a [f64]) -> Drivelines<'a> {
        Drivelines {
            bends: &self.bends,
            twists: &self.twists,
            phases: &self.phases,
            directions: zero_directions,
            normals: &zero_directions[3..],
            ..Drivelines::default()
        }
    }
}

/// A kind of chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ChainShape {
    NearStraight,
    Compensated,
    OneSteep,
    Steep,
    Mixed,
}

impl ChainShape {
    pub(crate) const ALL: [Self; 5] =
        [Self::NearStraight, Self::Compensated, Self::OneSteep, Self::Steep, Self::Mixed];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::NearStraight => "64 joints, bends of 1e-12 to 0.01",
            Self::Compensated => "compensated pairs, in and out of line, 2 to 64 joints",
            Self::OneSteep => "2 or 3 joints, one of them 1e-4° to 3° from 90°",
            Self::Steep => "2 to 4 joints, bends to 1e-9 from 90°",
            Self::Mixed => "2 to 64 joints: straight, near-straight and up to 69°",
        }
    }

    pub(crate) fn line(self, random: &mut Random) -> ChainAngles {
        let n = match self {
            Self::NearStraight => 64,
            Self::Compensated => 2 * (1 + random.below(32)),
            Self::OneSteep => 2 + random.below(2),
            Self::Steep => 2 + random.below(3),
            Self::Mixed => 2 + random.below(63),
        };
        let mut bends: Vec<f64> = (0..n)
            .map(|_| match self {
                Self::NearStraight => random.power(-12.0, -2.0),
                Self::Compensated => random.between(0.0, 0.8),
                Self::OneSteep => random.between(0.0, 1.2),
                Self::Steep => FRAC_PI_2 - random.power(-9.0, 0.0),
                // A few joints are bent at all, so that the whole is not beyond every number.
                Self::Mixed => match random.below(2 * n) {
                    0..6 => random.between(0.0, 1.2),
                    6..20 => random.power(-12.0, -2.0),
                    _ => 0.0,
                },
            })
            .collect();
        if self == Self::OneSteep {
            bends[random.below(n)] = FRAC_PI_2 - random.power(-5.76, -1.281);
        }
        let mut angles = || (1..n).map(|_| random.between(-PI, PI)).collect::<Vec<f64>>();
        let (twists, mut phases) = (angles(), angles());
        if self == Self::Compensated {
            for pair in 0..n / 2 {
                bends[2 * pair + 1] = bends[2 * pair];
                let half = if random.below(2) == 0 { 0.0 } else { PI };
                phases[2 * pair] = twists[2 * pair] - half;
            }
        }
        ChainAngles { bends, twists, phases }
    }
}

/// The worst errors of a kind of chain, tier by tier, in units and (single) parts of the largest.
type ChainErrors = ShapeErrors<ChainShape, 4, 5>;

/// Judges at least so many samples of each kind.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Chains", ABOUT);
    ErrorTable::of(
        head,
        MOTION.map(|output| output.row().name),
        &RowLimits::of_tiers(limits),
        &run(seed, samples),
        ChainShape::name,
    )
}

/// At least so many samples of each kind.
fn run(seed: u64, samples: u64) -> Vec<ChainErrors> {
    let mut random = Random::new(seed ^ 0xc4a1);
    ShapeErrors::of_each(&ChainShape::ALL, samples, |shape, found| {
        judge(&shape.line(&mut random), &mut random, found);
    })
}

fn evaluate(line: &ChainAngles, angles: &[f64], tier: Tier) -> Vec<Vec<f64>> {
    let n = line.bends.len();
    let zero_directions = line.zero_directions();
    let lines = line.drivelines(&zero_directions);
    let plan = Plan::new(&Request {
        largest_bends: &line.bends,
        outputs: &MOTION,
        shafts: &[n],
        joints: &[],
        load: None,
        inertias: &[],
        bearings: None,
        as_built: false,
        axes: Axes::Space,
    })
    .expect("the request is sound");
    let angle = Angles::Array(Source { data: angles, strides: &[1] });
    let samples = Samples { shape: &[angles.len()], lines, line_strides: &[0], angle, load: None };
    planes(&plan, &samples, tier)
}

fn judge(line: &ChainAngles, random: &mut Random, found: &mut ChainErrors) {
    let chain = ExactChain::of(&line.bends, &line.twists, &line.phases);
    let n = line.bends.len() as f64;
    let angles: Vec<f64> = (0..ANGLES).map(|_| Kind::Random.angle(random, 0.0, &[])).collect();
    let (gap, k) = (chain.gap(), chain.k);
    let fold = n * chain.total.min(1.0) / chain.length();
    let [slow, fast, faster] =
        [(4.0, 2), (32.0, 3), (384.0, 4)].map(|(x, n)| x * fold / gap.powi(n));
    let folds = [fold / gap, fold / gap, slow, fast, faster];
    let (steepest, jerkiest) = (8.0 * k / gap.powi(2), 8.0 * k * (1.0 + k) / gap.powi(3));
    let largest = [2.0 * PI, k.min(1.0).asin(), (1.0 + k) / gap, steepest, jerkiest];
    let exact: Vec<_> = angles.iter().map(|&x| chain.motion(&Turn::by(&[x]))).collect();
    for tier in Tier::ALL {
        if tier == Tier::Float32 {
            continue;
        }
        let planes = evaluate(line, &angles, tier);
        let [turned, folded] = match tier {
            Tier::Faithful => [-94, -94],
            Tier::Default => [-52, -60],
            Tier::Loose | Tier::Float32 => [-23, -60],
        }
        .map(|power| 2_f64.powi(power));
        for (q, plane) in planes.iter().enumerate() {
            for ((&angle, (motion, rates)), &got) in angles.iter().zip(&exact).zip(plane) {
                let want = motion.all()[q];
                // The angle may be small where the drive and the error cancel.
                let ulp = match (q, tier) {
                    (0, Tier::Default) => want.ulp().max(motion.error.ulp()),
                    (4, Tier::Faithful) => {
                        want.ulp().max(chain.jerk_term(&Turn::by(&[angle])).ulp())
                    }
                    _ => want.ulp(),
                };
                let unit = if tier.is_single() {
                    let rounding = turned * rates[q] + folded * folds[q];
                    largest[q].max(if q == 0 { angle.abs() } else { 0.0 }) + rounding * 1e6 + 1e-30
                } else {
                    ulp + turned * rates[q] + folded * folds[q]
                };
                found.take(tier as usize, q, want.distance(got) / unit, || {
                    let ChainAngles { bends, twists, phases } = line;
                    format!(
                        "{} at bends {bends:?}, twists {twists:?}, phases {phases:?}, angle {angle:?}: \
                         {got:e} instead of {:e}",
                        MOTION[q].row().name,
                        want.high
                    )
                });
            }
        }
    }
    found.judged += ANGLES as u64;
}
