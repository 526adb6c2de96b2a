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
    weights: [f64; STAGES],
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
    const EMPTY: Self = Self {
        nodes: [0.0; STAGES],
        weights: [0.0; STAGES],
        speed: [[0.0; STAGES]; STAGES],
        position: [[0.0; STAGES]; STAGES],
        end_speed: [0.0; STAGES],
        end_position: [0.0; STAGES],
        middle_speed: [0.0; STAGES],
        middle_position: [0.0; STAGES],
        halves: [[[0.0; STAGES]; STAGES]; 2],
    };

    fn new() -> Self {
        // Zeros of the Legendre polynomial of degree 4, and their weights, moved to [0, 1].
        let root = (6.0_f64 / 5.0).sqrt();
        let outer = (3.0 / 7.0 + 2.0 / 7.0 * root).sqrt();
        let inner = (3.0 / 7.0 - 2.0 / 7.0 * root).sqrt();
        let nodes = [-outer, -inner, inner, outer].map(|x| 0.5 + 0.5 * x);
        let thirty = 30.0_f64.sqrt();
        let (heavy, light) = ((18.0 + thirty) / 72.0, (18.0 - thirty) / 72.0);
        let weights = [light, heavy, heavy, light];
        let mut rule = Self { nodes, weights, ..Self::EMPTY };
        let speed = nodes.map(|end| rule.speed_to(end));
        rule.speed = speed;
        let half = |start: f64| {
            nodes.map(|node| std::array::from_fn(|j| rule.basis(j, start + 0.5 * node)))
        };
        let [end_position, end_speed] = rule.to(1.0);
        let [middle_position, middle_speed] = rule.to(0.5);
        Self {
            position: speed.map(|of_speeds| rule.position_to(of_speeds)),
            end_speed,
            end_position,
            middle_speed,
            middle_position,
            halves: [half(0.0), half(0.5)],
            ..rule
        }
    }

    /// The Lagrange polynomial of a node.
    fn basis(&self, j: usize, x: f64) -> f64 {
        let others = (0..STAGES).filter(|&i| i != j);
        others.map(|i| (x - self.nodes[i]) / (self.nodes[j] - self.nodes[i])).product()
    }

    /// Contributions of the accelerations to the speed at a time. The quadrature itself integrates
    /// polynomials of degree 2 · STAGES − 1 exactly.
    fn speed_to(&self, end: f64) -> [f64; STAGES] {
        let nodes = || self.nodes.iter().zip(self.weights);
        std::array::from_fn(|j| nodes().map(|(x, w)| end * w * self.basis(j, end * x)).sum())
    }

    /// The position is the integral of the polynomial through the speeds at the nodes: the method of
    /// Gauss for the system of first order, which is stable on intervals of any length. With the
    /// integral of the integral of the accelerations, free vibrations whose period is shorter than
    /// an interval would grow.
    fn position_to(&self, of_speeds: [f64; STAGES]) -> [f64; STAGES] {
        std::array::from_fn(|j| (0..STAGES).map(|k| of_speeds[k] * self.speed[k][j]).sum())
    }

    /// Contributions of the accelerations to position and speed at a time.
    pub(super) fn to(&self, time: f64) -> [[f64; STAGES]; 2] {
        let of_speeds = self.speed_to(time);
        [self.position_to(of_speeds), of_speeds]
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
