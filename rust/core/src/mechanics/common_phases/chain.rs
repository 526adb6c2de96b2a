//! The weighted mean of `|q|²` over the chains of all states as a function of the phases, with its
//! first and second derivatives.
//!
//! A chain makes `A w + B w̄` of `w = e^{iα}`. A joint takes `(B, Ā)` to `(B − k Ā, Ā − k B)`, and a
//! shaft with `p = phase − twist + 90°` to `(B e^{2ip}, Ā)`, up to a common factor (from Thoma 4).
//! `|A|² − |B|² = c`, the product of all `1 − k²`, does not depend on the phases: `|q|² =
//! |B|²/(|B|² + c)` follows from `B` alone.

use nalgebra::{Complex, DMatrix, DVector};

use crate::mechanics::common_phases::States;
use crate::mechanics::joint::Joint;
use crate::number::elementary;

/// `2i`, which a change of a phase brings down from `e^{2ip}`.
const RATE: Complex<f64> = Complex::new(0.0, 2.0);

const START: [Complex<f64>; 2] = [Complex::new(0.0, 0.0), Complex::new(1.0, 0.0)];

/// The chains of all states.
pub(super) struct StateChains(Vec<Chain>);

/// The chain of one state.
pub(super) struct Chain {
    /// `k` of each joint.
    k: Vec<f64>,
    /// `e^{2ip}` of each intermediate shaft at its present phase.
    turns: Vec<Complex<f64>>,
    complement: f64,
    weight: f64,
}

/// The mean with its gradient and Hessian.
pub(super) struct Derivatives {
    pub(super) value: f64,
    pub(super) gradient: DVector<f64>,
    pub(super) hessian: DMatrix<f64>,
}

impl StateChains {
    pub(super) fn new(states: &States<'_>) -> Self {
        let between = states.between();
        // Doubling an angle could overflow.
        let square = |angle: f64| {
            let turn = elementary::turn(angle);
            turn * turn
        };
        let now: Vec<_> = states.phases[..between].iter().map(|&now| square(now)).collect();
        let of_state = |(state, &weight): (usize, &f64)| {
            let bends = &states.bends[state * states.joints..][..states.joints];
            let twists = &states.twists[state * between..][..between];
            let joints = || bends.iter().map(|&bend| Joint::new(bend));
            Chain {
                k: joints().map(|joint| joint.k).collect(),
                turns: twists.iter().zip(&now).map(|(&twist, now)| -now * square(-twist)).collect(),
                complement: joints().map(|joint| joint.complement()).product(),
                weight,
            }
        };
        Self(states.weights.iter().enumerate().map(of_state).collect())
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = &Chain> {
        self.0.iter()
    }

    /// The mean after a change of each phase.
    pub(super) fn mean_square(&self, change: &[f64]) -> f64 {
        let turns = turns_of(change);
        let square = |chain: &Chain| chain.share(chain.before(&turns, turns.len())[0]);
        self.iter().map(square).sum()
    }

    /// The mean and its derivatives with respect to the phases of the `free` shafts.
    pub(super) fn derivatives(&self, change: &[f64], free: &[usize]) -> Derivatives {
        let turns = turns_of(change);
        let mut sums = Derivatives {
            value: 0.0,
            gradient: DVector::zeros(free.len()),
            hessian: DMatrix::zeros(free.len(), free.len()),
        };
        for chain in self.iter() {
            chain.add_derivatives(&turns, free, &mut sums);
        }
        sums.hessian.fill_upper_triangle_with_lower_triangle();
        sums
    }
}

impl Chain {
    /// The weighted `|q|²` of a chain with this `B`.
    #[inline(always)]
    pub(super) fn share(&self, b: Complex<f64>) -> f64 {
        let size = b.norm_sqr();
        self.weight * size / (size + self.complement)
    }

    /// `(B, Ā)` behind a joint.
    #[inline(always)]
    pub(super) fn past(&self, joint: usize, [b, a]: [Complex<f64>; 2]) -> [Complex<f64>; 2] {
        let k = self.k[joint];
        [b - a * k, a - b * k]
    }

    /// `e^{2ip}` of a shaft after its change.
    #[inline(always)]
    pub(super) fn turn(&self, shaft: usize, turn: Complex<f64>) -> Complex<f64> {
        self.turns[shaft] * turn
    }

    /// `(B, Ā)` before the turn of an intermediate shaft; at the end, if there is no such shaft.
    pub(super) fn before(&self, turns: &[Complex<f64>], shaft: usize) -> [Complex<f64>; 2] {
        (0..shaft).fold(self.past(0, START), |[b, a], i| {
            self.past(i + 1, [b * self.turn(i, turns[i]), a])
        })
    }

    /// The row `(x, y)` with which `B = x b + y ā` at the end, from `(b, ā)` behind the turn of an
    /// intermediate shaft. Joints are symmetric.
    pub(super) fn rest(&self, turns: &[Complex<f64>], shaft: usize) -> [Complex<f64>; 2] {
        let end = [START[1], START[0]];
        (shaft + 1..turns.len()).rev().fold(self.past(turns.len(), end), |row, i| {
            self.past(i, [row[0] * self.turn(i, turns[i]), row[1]])
        })
    }

    fn add_derivatives(&self, turns: &[Complex<f64>], free: &[usize], sums: &mut Derivatives) {
        let mut point = self.past(0, START);
        // The derivatives of (B, Ā) by the phases of the free shafts that have been passed, and of
        // `B` at the end by those of two of them.
        let mut slopes: Vec<[Complex<f64>; 2]> = Vec::with_capacity(free.len());
        let mut mixed = Vec::with_capacity(free.len() * (free.len() + 1) / 2);
        for (shaft, &change) in turns.iter().enumerate() {
            let turn = self.turn(shaft, change);
            point[0] *= turn;
            for slope in &mut slopes {
                slope[0] *= turn;
            }
            if free.get(slopes.len()) == Some(&shaft) {
                slopes.push([RATE * point[0], START[0]]);
                let onward = RATE * self.rest(turns, shaft)[0];
                mixed.extend(slopes.iter().map(|slope| onward * slope[0]));
            }
            point = self.past(shaft + 1, point);
            for slope in &mut slopes {
                *slope = self.past(shaft + 1, *slope);
            }
        }
        let b = point[0];
        sums.value += self.share(b);
        let whole = b.norm_sqr() + self.complement;
        let scale = self.weight * self.complement / (whole * whole);
        let product = |x: Complex<f64>, y: Complex<f64>| 2.0 * (x.re * y.re + x.im * y.im);
        let mut mixed = mixed.into_iter();
        for (i, [own, _]) in slopes.iter().enumerate() {
            let slope = product(b, *own);
            sums.gradient[i] += scale * slope;
            for (j, ([other, _], both)) in slopes[..=i].iter().zip(&mut mixed).enumerate() {
                let curve = product(*own, *other) + product(b, both);
                sums.hessian[(i, j)] += scale * (curve - 2.0 * slope * product(b, *other) / whole);
            }
        }
    }
}

/// `e^{2ix}` of each change.
fn turns_of(change: &[f64]) -> Vec<Complex<f64>> {
    change.iter().map(|&x| elementary::turn(2.0 * x)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::chain::Equivalent;

    const BENDS: [f64; 10] = [0.3, 0.9, 0.0, 1.4, 0.6, 0.2, 0.1, 0.05, 0.3, 1.2];
    const TWISTS: [f64; 8] = [0.4, -1.7e308, 2.0, 0.3, 0.0, 1.0, -0.5, 0.7];
    const PHASES: [f64; 4] = [0.3, 1e15, -0.8, 1.1];
    const WEIGHTS: [f64; 2] = [0.25, 0.75];
    const CHANGE: [f64; 4] = [0.2, -0.4, 0.9, 0.1];

    fn chains() -> StateChains {
        StateChains::new(&States {
            joints: 5,
            bends: &BENDS,
            twists: &TWISTS,
            phases: &PHASES,
            weights: &WEIGHTS,
            held: &[false; 4],
            teeth: &[],
        })
    }

    #[test]
    fn the_mean_is_that_of_equivalent_joints() {
        let phases: Vec<f64> = PHASES.iter().zip(CHANGE).map(|(now, x)| now + x).collect();
        // The sum of a phase of 1e15 and a change is rounded.
        let change: Vec<f64> = phases.iter().zip(PHASES).map(|(x, now)| x - now).collect();
        let square = |((bends, twists), weight): ((&[f64], &[f64]), &f64)| {
            weight * Equivalent::of_chain(bends, twists, &phases).joint.k.powi(2)
        };
        let mean: f64 = BENDS.chunks(5).zip(TWISTS.chunks(4)).zip(&WEIGHTS).map(square).sum();
        assert!((chains().mean_square(&change) - mean).abs() < 1e-15);
    }

    #[test]
    fn derivatives_are_differences() {
        let (chains, free) = (chains(), [0, 2, 3]);
        let found = chains.derivatives(&CHANGE, &free);
        assert!((found.value - chains.mean_square(&CHANGE)).abs() < 1e-15);
        for (i, &shaft) in free.iter().enumerate() {
            let step = 1e-5;
            let at = |x: f64| {
                let mut change = CHANGE;
                change[shaft] += x;
                chains.derivatives(&change, &free)
            };
            let (ahead, behind) = (at(step), at(-step));
            let slope = (ahead.value - behind.value) / (2.0 * step);
            assert!((found.gradient[i] - slope).abs() < 1e-8);
            let curve = (ahead.gradient - behind.gradient) / (2.0 * step);
            assert!((found.hessian.column(i) - curve).amax() < 1e-7);
        }
    }
}
