//! Derivatives of the motion of chains by bends, phases and the drive angle, of each sample and summed
//! with weights, in the units of `rust/stress/derivatives.md`.
//!
//! The oracle has no derivative: it takes differences of the exact chain at six steps `h`, which are
//! wrong by `h⁶/140` of the seventh derivative, and by `2/h` of the digits of the oracle.

use cardan::{Differentiated, Drivelines, Execution, Output, Spread, SpreadAngles, Wanted};

use crate::chains::{ChainAngles, ChainShape};
use crate::exact::{ChainParameter, ExactChain, ExactMotion, Turn};
use crate::judge;
use crate::samples::{Kind, Random};
use crate::wide::Wide;

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
pub(crate) fn names() -> [&'static str; 5] {
    OUTPUTS.map(|(output, ..)| output.row().name)
}

/// What is judged: the derivatives of every sample, and those of their weighted sum.
pub(crate) const BY: [&str; 3] = ["drive angle", "bends and phases", "bends and phases, sums"];

/// The largest errors of these, of any output.
pub(crate) fn limits() -> [f64; 3] {
    BY.map(|by| judge::limit("derivative", by, "worst").expect("the table has it"))
}

/// The worst errors of the derivatives of a kind of chain, by what they are by and by output.
#[derive(Clone, Debug)]
pub(crate) struct DerivativeErrors {
    pub(crate) shape: ChainShape,
    pub(crate) judged: u64,
    pub(crate) off: [[f64; 5]; 3],
    pub(crate) place: [[String; 5]; 3],
}

/// At least so many samples of each kind.
pub(crate) fn run(seed: u64, samples: u64) -> Vec<DerivativeErrors> {
    let mut random = Random::new(seed ^ 0xde71);
    ChainShape::ALL
        .into_iter()
        .map(|shape| {
            let (off, place) = ([[0.0; 5]; 3], Default::default());
            let mut found = DerivativeErrors { shape, judged: 0, off, place };
            while found.judged < samples {
                let line = shape.line(&mut random);
                judge(&line, &mut random, &mut found);
            }
            found
        })
        .collect()
}

/// By what a result is differentiated, and the column of its derivative in the core's.
#[derive(Clone, Copy, Debug)]
enum By {
    Chain(ChainParameter),
    Angle,
}

impl By {
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
    let (directions, normals) = (vec![0.0; 3 * (n + 1)], vec![0.0; 3 * n]);
    let task = |outputs: &[Output]| Differentiated {
        joints: n,
        lines: Drivelines {
            bends: &line.bends,
            twists: &line.twists,
            phases: &line.phases,
            directions: &directions,
            normals: &normals,
            ..Drivelines::default()
        },
        bearings: &[],
        samples: angles.len(),
        outputs: outputs.iter().map(|&output| (output, vec![n])).collect(),
        shaft_axes: false,
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
    let h = 2_f64.powi(gap.min(1.0).log2().floor() as i32 - 14);
    let mut by = vec![By::Angle];
    for _ in 0..PARAMETERS {
        by.push(By::Chain(ChainParameter::Bend(random.below(n))));
        by.push(By::Chain(ChainParameter::Phase(random.below(n - 1))));
    }
    for by in by {
        let after = |change: f64| match by {
            By::Chain(parameter) => {
                ExactChain::moved(bends, twists, phases, Some((parameter, change)))
            }
            By::Angle => chain,
        };
        let chains = STEPS.map(|count| [after(count * h), after(-count * h)]);
        let of_q = (chains[0][0].q() - chains[0][1].q()).norm_squared().high.sqrt() / (2.0 * h);
        let size = of_q.max(2.0 * total);
        let (column, is_angle) = (by.column(n), matches!(by, By::Angle));
        let mut sums = [[Wide::ZERO; 2]; 5];
        for (i, (&angle, &weight)) in angles.iter().zip(&weights).enumerate() {
            let motions = std::array::from_fn::<_, 3, _>(|step| {
                std::array::from_fn::<_, 2, _>(|side| {
                    let change = if side == 0 { STEPS[step] * h } else { -STEPS[step] * h };
                    let turn = match by {
                        By::Angle => Turn::by(&[angle, change]),
                        By::Chain(_) => Turn::by(&[angle]),
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
                    format!("{by:?} {line:?}, angle {angle:?}: {got:e} instead of {:e}", want.high)
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
                format!("the sum, {by:?} {line:?}: {got:e} instead of {:e}", want.high)
            });
        }
    }
    found.judged += ANGLES as u64;
}

impl DerivativeErrors {
    fn take(&mut self, which: usize, q: usize, off: f64, place: impl Fn() -> String) {
        let off = if off.is_nan() { f64::INFINITY } else { off };
        if off > self.off[which][q] {
            self.off[which][q] = off;
            self.place[which][q] = format!("{} {}", names()[q], place());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_within_their_limits() {
        for found in run(7, 400) {
            for ((off, place), limit) in found.off.iter().zip(&found.place).zip(limits()) {
                for (off, place) in off.iter().zip(place) {
                    assert!(*off > 0.0 && *off <= limit, "{off} of {limit}: {place}");
                }
            }
        }
    }
}
