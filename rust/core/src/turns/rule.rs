//! Gauss–Legendre rules, with the last coefficients of the polynomial through their values.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::number::elementary::log10;
use crate::number::trig;

/// The orders that a turn chooses from: the first that its drivelines' steepness allows.
const ORDERS: [usize; 4] = [8, 12, 16, 24];

/// The decimal digits that a rule is chosen for, and the orders that products of several ratios
/// need beyond those of one.
const DIGITS: f64 = 17.0;
const SPARE: f64 = 2.0;

/// The rules of [`ORDERS`].
pub(crate) static RULES: LazyLock<[Rule; ORDERS.len()]> = LazyLock::new(|| ORDERS.map(Rule::new));

/// A rule for functions on an interval.
#[derive(Debug)]
pub(crate) struct Rule {
    /// The nodes as parts of the interval, in ascending order.
    pub(crate) nodes: Vec<f64>,
    /// The weights of the mean over the interval.
    weights: Vec<f64>,
    /// The weights of the last two coefficients of the series in Legendre polynomials.
    last: [Vec<f64>; 2],
}

/// What a rule finds.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found {
    /// The mean over the interval.
    pub(crate) mean: f64,
    /// The size of the last coefficients. That of the mean's error is its square, because a rule
    /// integrates twice as many polynomials exactly as it has nodes.
    pub(crate) tail: f64,
}

impl Rule {
    fn new(order: usize) -> Self {
        let mut nodes = vec![0.0; order];
        let mut weights = vec![0.0; order];
        let mut last =
            [const { Vec::new() }; 2].map(|row: Vec<f64>| [row, vec![0.0; order]].concat());
        for i in 0..order {
            // Newton's method from the zeros' asymptotes.
            let mut x = -trig::sin_cos(PI * (i as f64 + 0.75) / (order as f64 + 0.5)).1;
            let mut slope = 0.0;
            for _ in 0..8 {
                let [before, polynomial] = legendre(order, x);
                slope = order as f64 * (x * polynomial - before) / (x * x - 1.0);
                x -= polynomial / slope;
            }
            nodes[i] = 0.5 + 0.5 * x;
            weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
            let [lower, upper] = legendre(order - 1, x);
            last[0][i] = (2 * order - 3) as f64 * weights[i] * lower;
            last[1][i] = (2 * order - 1) as f64 * weights[i] * upper;
        }
        Self { nodes, weights, last }
    }

    /// The mean and the last coefficients of a function with these values at the nodes.
    pub(crate) fn of(&self, values: &[f64]) -> Found {
        let dot = |weights: &[f64]| -> f64 { weights.iter().zip(values).map(|(w, x)| w * x).sum() };
        let [lower, upper] = &self.last;
        Found { mean: dot(&self.weights), tail: dot(lower).abs() + dot(upper).abs() }
    }
}

/// The Legendre polynomials of degree `n − 1` and `n`.
fn legendre(n: usize, x: f64) -> [f64; 2] {
    let (mut before, mut polynomial) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        let next = ((2.0 * k + 1.0) * x * polynomial - k * before) / (k + 1.0);
        (before, polynomial) = (polynomial, next);
    }
    [before, polynomial]
}

/// The index in [`RULES`] of the rule for intervals of a width, of functions whose poles are at this
/// distance from the real axis or farther: their errors decrease like `ρ^(−2m)` with the order `m`,
/// where `ρ` is the sum of the half axes of the largest ellipse about the interval that has no pole
/// inside, over half the interval.
pub(crate) fn choose(width: f64, distance: f64) -> usize {
    let axis = 2.0 * distance / width;
    let growth = 2.0 * log10(axis + (axis * axis + 1.0).sqrt());
    let wanted = DIGITS / growth + SPARE;
    ORDERS.iter().position(|&order| order as f64 >= wanted).unwrap_or(ORDERS.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for rule in &*RULES {
            let order = rule.nodes.len();
            for power in 0..2 * order {
                let values: Vec<f64> = rule.nodes.iter().map(|x| x.powi(power as i32)).collect();
                let mean = rule.of(&values).mean;
                assert!((mean * (power + 1) as f64 - 1.0).abs() < 1e-14, "{order} {power}: {mean}");
            }
        }
    }

    #[test]
    fn last_coefficients_are_those_of_the_series() {
        for rule in &*RULES {
            let order = rule.nodes.len();
            let of = |degree: usize| -> Vec<f64> {
                rule.nodes.iter().map(|x| legendre(degree, 2.0 * x - 1.0)[1]).collect()
            };
            for degree in 0..order {
                let tail = rule.of(&of(degree)).tail;
                let expected = if degree + 2 >= order { 1.0 } else { 0.0 };
                assert!((tail - expected).abs() < 1e-13, "{order} {degree}: {tail}");
            }
        }
    }

    #[test]
    fn steep_functions_and_wide_intervals_take_high_orders() {
        assert_eq!(choose(0.1, 2.0), 0);
        assert_eq!(choose(PI, 0.1), ORDERS.len() - 1);
        assert!(choose(1.5, 2.0) <= choose(1.5, 1.0));
    }
}
