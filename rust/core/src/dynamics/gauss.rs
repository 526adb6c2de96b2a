//! Gauss-Legendre collocation on one interval: nodes, weights, and integrals of the Lagrange
//! polynomials.

use std::sync::LazyLock;

/// The number of collocation points of an interval. At the ends of the intervals the error is of
/// the order `2 · STAGES` in their length.
pub(super) const STAGES: usize = 4;

/// One number per pair of stages.
pub(super) type Square = [[f64; STAGES]; STAGES];

/// The collocation of an acceleration that is a polynomial over the unit interval.
pub(super) struct Collocation {
    /// The nodes.
    pub(super) nodes: [f64; STAGES],
    /// `speed[i][j]`: contribution of acceleration `j` to the speed at node `i`.
    pub(super) speed: Square,
    /// The same for the position.
    pub(super) position: Square,
    /// Contributions to the speed at the end of the interval.
    pub(super) end_speed: [f64; STAGES],
    /// Contributions to the position at the end.
    pub(super) end_position: [f64; STAGES],
    /// Contributions to the speed in the middle.
    pub(super) middle_speed: [f64; STAGES],
    /// Contributions to the position in the middle.
    pub(super) middle_position: [f64; STAGES],
    /// For both halves: contributions to the accelerations at the nodes of the half.
    pub(super) halves: [Square; 2],
}

/// The only instance.
pub(super) static COLLOCATION: LazyLock<Collocation> = LazyLock::new(Collocation::new);

impl Collocation {
    fn new() -> Self {
        // Zeros of the Legendre polynomial of degree 4, and their weights, moved to [0, 1].
        let root = (6.0_f64 / 5.0).sqrt();
        let outer = (3.0 / 7.0 + 2.0 / 7.0 * root).sqrt();
        let inner = (3.0 / 7.0 - 2.0 / 7.0 * root).sqrt();
        let nodes = [-outer, -inner, inner, outer].map(|x| 0.5 + 0.5 * x);
        let thirty = 30.0_f64.sqrt();
        let (heavy, light) = ((18.0 + thirty) / 72.0, (18.0 - thirty) / 72.0);
        let weights = [light, heavy, heavy, light];
        let basis = |j: usize, x: f64| -> f64 {
            let others = (0..STAGES).filter(|&i| i != j);
            others.map(|i| (x - nodes[i]) / (nodes[j] - nodes[i])).product()
        };
        // The quadrature itself integrates polynomials of degree 2 · STAGES − 1 exactly.
        let integral = |end: f64, of: &dyn Fn(f64) -> f64| -> f64 {
            nodes.iter().zip(weights).map(|(node, weight)| end * weight * of(end * node)).sum()
        };
        let speed_to = |end: f64| -> [f64; STAGES] {
            std::array::from_fn(|j| integral(end, &|x| basis(j, x)))
        };
        let speed = nodes.map(speed_to);
        // The position is the integral of the polynomial through the speeds at the nodes: the
        // method of Gauss for the system of first order, which is stable on intervals of any
        // length. With the integral of the integral of the accelerations, free vibrations whose
        // period is shorter than an interval would grow.
        let position_to = |of_speeds: [f64; STAGES]| -> [f64; STAGES] {
            std::array::from_fn(|j| (0..STAGES).map(|k| of_speeds[k] * speed[k][j]).sum())
        };
        let half =
            |start: f64| nodes.map(|node| std::array::from_fn(|j| basis(j, start + 0.5 * node)));
        Self {
            nodes,
            speed,
            position: speed.map(position_to),
            end_speed: speed_to(1.0),
            end_position: position_to(speed_to(1.0)),
            middle_speed: speed_to(0.5),
            middle_position: position_to(speed_to(0.5)),
            halves: [half(0.0), half(0.5)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        let rule = &*COLLOCATION;
        for power in 0..8 {
            let sum = |weights: &[f64; STAGES], most: i32| -> Option<f64> {
                (power <= most)
                    .then(|| rule.nodes.iter().zip(weights).map(|(x, w)| w * x.powi(power)).sum())
            };
            let n = f64::from(power);
            let check = |found: Option<f64>, expected: f64| {
                if let Some(found) = found {
                    assert!((found - expected).abs() < 1e-15, "{power}: {found} {expected}");
                }
            };
            check(sum(&rule.end_speed, 7), 1.0 / (n + 1.0));
            check(sum(&rule.end_position, 6), 1.0 / ((n + 1.0) * (n + 2.0)));
            check(sum(&rule.middle_speed, 3), 0.5_f64.powi(power + 1) / (n + 1.0));
            let scale = 0.5_f64.powi(power + 2) / ((n + 1.0) * (n + 2.0));
            check(sum(&rule.middle_position, 2), scale);
            for (i, &node) in rule.nodes.iter().enumerate() {
                check(sum(&rule.speed[i], 3), node.powi(power + 1) / (n + 1.0));
                let position = node.powi(power + 2) / ((n + 1.0) * (n + 2.0));
                check(sum(&rule.position[i], 2), position);
                check(sum(&rule.halves[0][i], 3), (0.5 * node).powi(power));
                check(sum(&rule.halves[1][i], 3), (0.5 + 0.5 * node).powi(power));
            }
        }
    }
}
