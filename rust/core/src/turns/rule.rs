//! Lobatto's rules, with the last coefficients of the polynomial through their values.
//!
//! They are Gauss's with both ends of the interval among the nodes. Between an end and the first node
//! of a rule without it, a kink would not be seen.

use std::f64::consts::PI;
use std::sync::LazyLock;

use crate::number::elementary::log10;
use crate::number::trig;

/// The orders that a turn chooses from: the first that its drivelines' steepness allows.
const ORDERS: [usize; 4] = [8, 12, 16, 24];

/// The decimal digits that a rule is chosen for, and the orders that products of several ratios
/// need beyond those of one.
const DIGITS: f64 = 20.0;
const SPARE: f64 = 2.0;

/// The part of the largest value that rounding may leave of a coefficient, for each node.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The rules of [`ORDERS`].
pub(crate) static RULES: LazyLock<[LobattoRule; ORDERS.len()]> =
    LazyLock::new(|| ORDERS.map(LobattoRule::new));

/// A rule for functions on an interval.
#[derive(Debug)]
pub(crate) struct LobattoRule {
    /// The nodes as parts of the interval, in ascending order.
    pub(crate) nodes: Vec<f64>,
    /// The weights of the mean over the interval.
    weights: Vec<f64>,
    /// The weights of four coefficients of the series in Legendre polynomials: two in the middle and
    /// the last two.
    coefficients: [Vec<f64>; 4],
}

/// Result of a rule.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PanelMean {
    /// The mean over the interval.
    pub(crate) mean: f64,
    /// An estimate of its error.
    pub(crate) error: f64,
    /// The largest magnitude at the nodes.
    pub(crate) largest: f64,
}

impl PanelMean {
    /// By how much the error may exceed its estimate where a function has a kink.
    pub(crate) const LARGER: f64 = 32.0;
}

impl LobattoRule {
    fn new(order: usize) -> Self {
        let mut rule =
            Self { nodes: vec![], weights: vec![], coefficients: [const { Vec::new() }; 4] };
        let (n, top) = (order as f64, (order - 1) as f64);
        for i in 0..order {
            // Newton's method for the extremes of the Legendre polynomial, from Chebyshev's.
            let mut x = -trig::sin_cos(PI * i as f64 / top).1;
            for _ in 0..12 {
                let [before, polynomial] = legendre(order - 1, x);
                x -= (x * polynomial - before) / (n * polynomial);
            }
            let [lower, upper] = legendre(order - 1, x);
            let [middle, above] = legendre(order / 2 + 1, x);
            let weight = 1.0 / (n * top * upper * upper);
            // The rule gives the square of the last polynomial another norm than the integral.
            let terms =
                [(n + 1.0) * middle, (n + 3.0) * above, (2.0 * n - 3.0) * lower, top * upper];
            for (row, term) in rule.coefficients.iter_mut().zip(terms) {
                row.push(weight * term);
            }
            rule.nodes.push(0.5 + 0.5 * x);
            rule.weights.push(weight);
        }
        rule
    }

    /// The mean of a function with these values at the nodes.
    ///
    /// The coefficients of a smooth function fall like the powers of a number: from the last ones to
    /// the first that the rule does not integrate, which are twice as high, by more than from the
    /// middle to the last. Those of a function with a kink fall little; the estimate is at least a
    /// thirty-second of the error then.
    pub(crate) fn of(&self, values: &[f64]) -> PanelMean {
        let dot = |weights: &[f64]| -> f64 { weights.iter().zip(values).map(|(w, x)| w * x).sum() };
        let [middle, above, lower, upper] = self.coefficients.each_ref().map(|row| dot(row).abs());
        let (middle, last) = (middle + above, lower + upper);
        let fall = if middle > last { last / middle } else { 1.0 };
        let largest = values.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let rounding = ROUNDING * values.len() as f64 * largest;
        let error = if last > rounding { last * fall } else { 0.0 };
        PanelMean { mean: dot(&self.weights), error, largest }
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
            for power in 0..2 * order - 2 {
                let values: Vec<f64> = rule.nodes.iter().map(|x| x.powi(power as i32)).collect();
                let mean = rule.of(&values).mean;
                assert!((mean * (power + 1) as f64 - 1.0).abs() < 1e-14, "{order} {power}: {mean}");
            }
        }
    }

    #[test]
    fn errors_of_smooth_functions_and_of_kinks_are_seen() {
        for rule in &*RULES {
            let of = |f: &dyn Fn(f64) -> f64| {
                rule.of(&rule.nodes.iter().map(|&x| f(x)).collect::<Vec<_>>())
            };
            assert_eq!(of(&|_| 3.0).error, 0.0);
            for pole in [0.3, 1.0, 3.0] {
                let found = of(&|x: f64| 1.0 / (x + pole));
                let off = (found.mean - (1.0 / pole).ln_1p()).abs();
                assert!(
                    off <= PanelMean::LARGER * found.error + 1e-15,
                    "{pole}: {off:e} of {:e}",
                    found.error
                );
            }
            for i in 0..200 {
                let kink = f64::from(i) * 0.005;
                let found = of(&|x: f64| (x - kink).abs());
                let off = (found.mean - 0.5 + kink * (1.0 - kink)).abs();
                assert!(
                    off <= PanelMean::LARGER * found.error + 1e-15,
                    "{kink}: {off:e} of {:e}",
                    found.error
                );
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
