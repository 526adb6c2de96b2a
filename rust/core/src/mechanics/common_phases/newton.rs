//! Newton's method in the phases of all free shafts at once.

use std::sync::atomic::AtomicBool;

use nalgebra::{DVector, SymmetricEigen};

use crate::mechanics::common_phases::chain::{Derivatives, StateChains};
use crate::mechanics::phasing::is_set;

/// The most steps and the most lengths of a step; a handful suffices unless the least is flat.
const STEPS: usize = 60;
const LENGTHS: i32 = 8;

/// The longest step in rad.
const LONGEST: f64 = 0.5;

/// The next step after one this short, in rad, or from a mean of `|q|²` this small is rounding.
const SHORT: f64 = 1e-9;
const SMALL: f64 = 1e-30;

/// The least nearby, with its mean of `|q|²`; the best so far when `stop` is set.
pub(super) fn refined(
    chains: &StateChains,
    mut change: Vec<f64>,
    free: &[usize],
    stop: Option<&AtomicBool>,
) -> (f64, Vec<f64>) {
    let mut here = chains.derivatives(&change, free);
    for _ in 0..STEPS {
        if is_set(stop) {
            break;
        }
        let step = here.downhill();
        let found = (0..LENGTHS).map(|shorter| 0.25_f64.powi(shorter)).find_map(|part| {
            let mut trial = change.clone();
            for (&shaft, x) in free.iter().zip(&step) {
                trial[shaft] += part * x;
            }
            let there = chains.derivatives(&trial, free);
            let as_good = there.value <= here.value * (1.0 + 1e-14);
            as_good.then_some((part, trial, there))
        });
        let Some((part, trial, there)) = found else { break };
        (change, here) = (trial, there);
        if part * step.amax() < SHORT || here.value < SMALL {
            break;
        }
    }
    (here.value, change)
}

impl Derivatives {
    /// Newton's step, but downhill along every axis. Where the mean is flat there is nothing to
    /// gain, and a bound on the curvature keeps the step short.
    fn downhill(&self) -> DVector<f64> {
        let curves = SymmetricEigen::new(self.hessian.clone());
        let least = 1e-9 * curves.eigenvalues.amax() + f64::MIN_POSITIVE;
        let mut step = DVector::zeros(self.gradient.len());
        for (curve, axis) in curves.eigenvalues.iter().zip(curves.eigenvectors.column_iter()) {
            step.axpy(-axis.dot(&self.gradient) / curve.abs().max(least), &axis, 1.0);
        }
        let longest = step.amax();
        if longest > LONGEST { step * (LONGEST / longest) } else { step }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_goes_downhill_along_every_axis() {
        // Along the axis of negative curvature Newton's step would go uphill.
        let [gradient, curves, step] = [[0.2, 0.1, 0.0], [2.0, -1.0, 0.0], [-0.1, -0.1, 0.0]]
            .map(|numbers| DVector::from_row_slice(&numbers));
        let hessian = nalgebra::DMatrix::from_diagonal(&curves);
        let found = Derivatives { value: 1.0, gradient, hessian };
        assert!((found.downhill() - &step).amax() < 1e-15);
        let steep = Derivatives { gradient: 20.0 * &found.gradient, ..found };
        assert!((steep.downhill() - 5.0 * step).amax() < 1e-15);
    }
}
