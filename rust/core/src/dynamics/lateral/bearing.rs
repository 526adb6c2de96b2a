//! Elastic bearings: their numbers, what these must be, and the dynamic stiffness that follows.

use nalgebra::Complex;

use crate::dynamics::lateral::check::{check_axis, check_each};
use crate::dynamics::lateral::rate::Rate;
use crate::mechanics::geometry::Vector;

/// A bearing with the dynamic stiffness `k (1 + i η sign ω) + iωc` in two directions across a shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticBearing {
    /// The shaft that it holds.
    pub shaft: usize,
    /// Distance from the shaft's upstream end in m.
    pub position: f64,
    /// `k` along the part of `axis` across the shaft and at right angles to it in N/m.
    pub stiffness: [f64; 2],
    /// Needed where the two directions differ.
    pub axis: Option<Vector>,
    /// `η` in both directions.
    pub loss_factor: [f64; 2],
    /// `c` in both directions in N s/m.
    pub damping: [f64; 2],
}

impl ElasticBearing {
    /// How many numbers describe one beside its shaft.
    pub(super) const FIELDS: usize = 10;

    /// The bearing of these numbers, in the order of the fields; without an axis its numbers are NaN.
    pub(super) fn of(shaft: usize, fields: &[f64; Self::FIELDS]) -> Self {
        let &[position, k1, k2, x, y, z, eta1, eta2, c1, c2] = fields;
        Self {
            shaft,
            position,
            stiffness: [k1, k2],
            axis: (!x.is_nan()).then(|| Vector::new(x, y, z)),
            loss_factor: [eta1, eta2],
            damping: [c1, c2],
        }
    }

    /// Checks the numbers, on a shaft with this direction.
    pub(super) fn check(&self, direction: Vector) -> std::result::Result<(), String> {
        let given = [("stiffness", self.stiffness), ("damping", self.damping)];
        for (name, pair) in given {
            check_each(&pair.map(|value| (name, value)))?;
        }
        if let Some(loss) = self.loss_factor.iter().find(|loss| !(0.0..=1.0).contains(*loss)) {
            return Err(format!("has the loss factor {loss:?}; it must lie in [0, 1]"));
        }
        if let Some(axis) = self.axis {
            return check_axis("axis", axis, direction);
        }
        let pairs = [self.stiffness, self.damping, self.loss_factor];
        if pairs.iter().all(|[first, second]| first == second) {
            return Ok(());
        }
        Err("differs in its two directions; it needs an axis for the first".into())
    }

    /// The dynamic stiffness in both directions.
    pub(super) fn dynamic_stiffness(&self, at: Rate) -> [Complex<f64>; 2] {
        [0, 1].map(|i| {
            let stiffness = self.stiffness[i];
            if !at.damped {
                return Complex::from(stiffness);
            }
            let loss = stiffness * self.loss_factor[i] * at.sign();
            Complex::new(stiffness, loss + at.omega * self.damping[i])
        })
    }
}
