//! Derivatives of the motion of chains by bends, phases and the drive angle, of each sample and summed
//! with weights, in the units of `rust/stress/derivatives.md`.
//!
//! The oracle has no derivative: it takes differences of the exact chain at six steps `h`, which are
//! wrong by `h⁶/140` of the seventh derivative, and by `2/h` of the digits of the oracle.

use cardan::{Axes, Differentiated, Execution, Output, Spread, SpreadAngles, Wanted};

use crate::chains::{ChainAngles, ChainShape};
use crate::error_table::{ErrorTable, RowLimits};
use crate::exact::{ChainParameter, ExactChain, ExactMotion, Turn};
use crate::judge;
use crate::samples::{Kind, Random};
use crate::shape_errors::ShapeErrors;
use crate::wide::Wide;

/// What the report says above the table.
const ABOUT: &str = r"The derivatives of the motion of chains by bends, phases and the drive angle are judged for each sample,
those by bends and phases also as sums with weights. They are computed in double precision. Each is the
derivative of the output by `q = B/A`, times that of `q`. The first is at most `c/(1 − |q|)ᵐ` in size:
`c` and `m` are 1 and 1 for the angle and the angle error, 4 and 2 for the speed ratio, 32 and 3 for the
acceleration ratio, and 384 and 4 for the jerk ratio. A rounding of `q` changes it by up to
`1 + 4 |q|/(1 − |q|)` of that. The unit is therefore the ulp of the derivative and
`n 2⁻⁵³ D c/(1 − |q|)ᵐ (1 + 4 |q|/(1 − |q|))`, where `n` is the number of joints, and `D` is the size of
the derivative of `q`, at least twice the sum of `tan²(β/2)` and at least 2 where that sum exceeds 1. The
unit of a sum is the sum of the units, multiplied by the sizes of the weights. The oracle takes
differences of the exact chain at six steps `h`, and its digits, `2⁻¹⁰⁰ |f|/h`, are allowed for.
";

/// Angles for each chain.
const ANGLES: usize = 20;

/// Bends and phases of each chain by which it is differentiated.
const PARAMETERS: usize = 3;

/// The outputs, with `c` and `m` of their bounds `c/(1 − |q|)ᵐ` of `|∂f/∂q|`.
const OUTPUTS: [(Output, f64, i32); 5] = [
    (Output::Angle, 1.0, 1),
    (Output::AngleError, 1.0, 1),
    (Output::SpeedRatio, 4.0, 2),
    (Output::AccelerationRatio, 32.0, 3),
    (Output::JerkRatio, 384.0, 4),
];

/// The names of the outputs.
fn names() -> [&'static str; 5] {
    OUTPUTS.map(|(output, ..)| output.row().name)
}

/// What is judged: the derivatives of every sample, and those of their weighted sum.
const BY: [&str; 3] = ["drive angle", "bends and phases", "bends and phases, sums"];

/// The largest errors of these, of any output.
fn rows() -> [RowLimits<5>; 3] {
    BY.map(|name| {
        let limit = judge::limit("derivative", name, "worst").expect("the table has it");
        RowLimits { name, single: false, limits: [limit; 5] }
    })
}

/// The worst errors of the derivatives of a kind of chain, by what they are by and by output.
type DerivativeErrors = ShapeErrors<ChainShape, 3, 5>;

/// Judges at least so many samples of each kind.
pub(crate) fn table(seed: u64, samples: u64) -> ErrorTable {
    let head = ("Derivatives", ABOUT);
    ErrorTable::of(head, names(), &rows(), &run(seed, samples), ChainShape::name)
}

/// At least so many samples of each kind.
fn run(seed: u64, samples: u64) -> Vec<DerivativeErrors> {
    let mut random = Random::new(seed ^ 0xde71);
    ShapeErrors::of_each(&ChainShape::ALL, samples, |shape, found| {
        judge(&shape.line(&mut random), &mut random, found);
    })
}

/// By what a result is differentiated, and the column of its derivative in the core's.
#[derive(Clone, Copy, Debug)]
enum DerivativeBy {
    Chain(ChainParameter),
    Angle,
}

impl DerivativeBy {
    fn column(self, joints: usize) -> usize {
        match self {
            Self::Chain(ChainParameter::Bend(joint)) => joint,
            Self::Chain(ChainParameter::Phase(shaft)) => joints + shaft,
            Self::Angle => 2 * joints - 1,
        }
    }
}

const WANTED: Wanted = Wanted {
    value: false,
    bends: true,
    twists: false,
    phases: true,
    points: false,
    angle: true,
    torque: false,
    inertias: false,
    lengths: false,
    positions: false,
    deviations: false,
};

/// The derivatives by all parameters, of each output and sample, and of the weighted sum of each
/// output.
fn differentiated(
    line: &ChainAngles,
    angles: &[f64],
    weights: &[f64],
) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = line.bends.len();
    let zero_directions = line.zero_directions();
    let task = |outputs: &[Output]| Differentiated {
        joints: n,
        lines: line.drivelines(&zero_directions),
        bearings: &[],
        samples: angles.len(),
        outputs: outputs.iter().map(|&output| (output, vec![n])).collect(),
        axes: Axes::Space,
        angle: SpreadAngles::Array(Spread { data: angles, per_line: 0, per_sample: 1 }),
        driven: false,
        load: None,
    };
    let all = task(&OUTPUTS.map(|(output, ..)| output));
    assert!(all.is_complete());
    let columns = WANTED.count(all.counts());
    let mut each = vec![f64::NAN; OUTPUTS.len() * angles.len() * columns];
    all.derivatives(WANTED, &mut each, Execution::default());
    let summed = OUTPUTS.iter().map(|&(output, ..)| {
        let mut sums = vec![f64::NAN; columns];
        task(&[output]).gradient(&[weights], WANTED, &mut sums, Execution::default());
        sums
    });
    let summed = summed.collect();
    (each, summed)
}

/// The changes of the differences, in steps; each has an opposite one.
const STEPS: [f64; 3] = [1.0, 2.0, 3.0];

/// The slope of a function from its values after both changes of each number of steps `h`.
fn slope(h: f64, [one, two, three]: [[Wide; 2]; 3]) -> Wide {
    let pair = |[after, before]: [Wide; 2]| after - before;
    let sum = pair(one) * 45.0 - pair(two) * 9.0 + pair(three);
    sum * (1.0 / h) / Wide::from(60.0)
}

fn judge(line: &ChainAngles, random: &mut Random, found: &mut DerivativeErrors) {
    let n = line.bends.len();
    let ChainAngles { bends, twists, phases } = line;
    let angles: Vec<f64> = (0..ANGLES).map(|_| Kind::Random.angle(random, 0.0, &[])).collect();
    let weights: Vec<f64> = angles.iter().map(|_| random.between(-1.0, 1.0)).collect();
    let (each, summed) = differentiated(line, &angles, &weights);
    let columns = each.len() / (OUTPUTS.len() * ANGLES);
    let chain = ExactChain::of(bends, twists, phases);
    let (gap, k, total) = (chain.gap(), chain.k, chain.total.min(1.0));
    // A result changes its course over a change of `q` by the gap, and `q` over a change by the distance
    // of the steepest bend from 90°.
    let steepest = bends.iter().fold(1.0, |least, bend| f64::min(least, bend.cos()));
    let h = 2_f64.powi((gap.min(1.0) * steepest).log2().floor() as i32 - 14);
    let mut by = vec![DerivativeBy::Angle];
    for _ in 0..PARAMETERS {
        by.push(DerivativeBy::Chain(ChainParameter::Bend(random.below(n))));
        by.push(DerivativeBy::Chain(ChainParameter::Phase(random.below(n - 1))));
    }
    for by in by {
        let after = |change: f64| match by {
            DerivativeBy::Chain(parameter) => {
                ExactChain::moved(bends, twists, phases, Some((parameter, change)))
            }
            DerivativeBy::Angle => chain,
        };
        let chains = STEPS.map(|count| [after(count * h), after(-count * h)]);
        let of_q = (chains[0][0].q() - chains[0][1].q()).norm_squared().high.sqrt() / (2.0 * h);
        let size = of_q.max(2.0 * total);
        let (column, is_angle) = (by.column(n), matches!(by, DerivativeBy::Angle));
        let mut sums = [[Wide::ZERO; 2]; 5];
        for (i, (&angle, &weight)) in angles.iter().zip(&weights).enumerate() {
            let motions = std::array::from_fn::<_, 3, _>(|step| {
                std::array::from_fn::<_, 2, _>(|side| {
                    let change = if side == 0 { STEPS[step] * h } else { -STEPS[step] * h };
                    let turn = match by {
                        DerivativeBy::Angle => Turn::by(&[angle, change]),
                        DerivativeBy::Chain(_) => Turn::by(&[angle]),
                    };
                    chains[step][side].motion(&turn).0
                })
            });
            for (q, (output, c, m)) in OUTPUTS.into_iter().enumerate() {
                let own = |motion: ExactMotion| match output {
                    // The drive angle has fewer digits.
                    Output::Angle => motion.error,
                    _ => motion.all()[q],
                };
                let drive = is_angle && output == Output::Angle;
                let values = motions.map(|pair| pair.map(own));
                let want = slope(h, values) + if drive { Wide::ONE } else { Wide::ZERO };
                let digits = 2_f64.powi(-100) / h * values[0][0].high.abs();
                let bound = c / gap.powi(m) * (1.0 + 4.0 * k / gap);
                let unit = want.ulp() + 2_f64.powi(-53) * n as f64 * size * bound + digits;
                let got = each[(q * ANGLES + i) * columns + column];
                found.take(usize::from(!is_angle), q, want.distance(got) / unit, || {
                    let name = output.row().name;
                    let place = format!("{name} by {by:?} {line:?}, angle {angle:?}");
                    format!("{place}: {got:e} instead of {:e}", want.high)
                });
                sums[q][0] = sums[q][0] + want * weight;
                sums[q][1] = sums[q][1] + Wide::from(weight.abs() * unit);
            }
        }
        // Sums are not differentiated by the angle, of which each sample has its own.
        let sums = if is_angle { vec![] } else { sums.to_vec() };
        for (q, [want, unit]) in sums.into_iter().enumerate() {
            let got = summed[q][column];
            found.take(2, q, want.distance(got) / unit.high, || {
                let place = format!("{}, the sum, by {by:?} {line:?}", names()[q]);
                format!("{place}: {got:e} instead of {:e}", want.high)
            });
        }
    }
    found.judged += ANGLES as u64;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain over whose change of the phase by 1e-3 everything changes.
    fn steep() -> DerivativeErrors {
        let line = ChainAngles {
            bends: vec![1.564_841_350_242_924_4, 1.569_033_678_683_677],
            twists: vec![-0.110_842_716_663_128_1],
            phases: vec![3.035_154_007_055_259],
        };
        let mut found = run(7, 0).remove(0);
        judge(&line, &mut Random::new(29), &mut found);
        found
    }

    #[test]
    fn derivatives_are_within_their_limits() {
        for found in run(7, 400).into_iter().chain([steep()]) {
            for ((off, place), row) in found.off.iter().zip(&found.place).zip(rows()) {
                for ((off, place), limit) in off.iter().zip(place).zip(row.limits) {
                    assert!(*off > 0.0 && *off <= limit, "{off} of {limit}: {place}");
                }
            }
        }
    }
}
