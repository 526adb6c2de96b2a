//! Natural frequencies of the mean system: the inertia of every piece is its mean over a turn, and
//! joints transmit with a ratio of one.

use std::f64::consts::PI;

use nalgebra::{DMatrix, SymmetricEigen};

use crate::dynamics::rigid_piece::RigidPiece;
use crate::dynamics::system::TorsionalSystem;

impl TorsionalSystem {
    /// Undamped natural frequencies in rad/s, lowest first, one per compliant shaft. The drive is
    /// held at constant speed.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        let m = self.unknowns();
        let inertias: Vec<f64> = self.pieces[1..].iter().map(mean_inertia).collect();
        let scale = |s: usize, u: usize| 1.0 / (inertias[s] * inertias[u]).sqrt();
        let mut matrix = DMatrix::<f64>::zeros(m, m);
        for (s, spring) in self.springs.iter().enumerate() {
            matrix[(s, s)] += spring.stiffness * scale(s, s);
            if s > 0 {
                matrix[(s - 1, s - 1)] += spring.stiffness * scale(s - 1, s - 1);
                matrix[(s, s - 1)] = -spring.stiffness * scale(s, s - 1);
                matrix[(s - 1, s)] = matrix[(s, s - 1)];
            }
        }
        let squares = SymmetricEigen::new(matrix).eigenvalues;
        let mut found: Vec<f64> = squares.iter().map(|square| square.max(0.0).sqrt()).collect();
        found.sort_by(f64::total_cmp);
        found
    }
}

/// The mean of the inertia over a turn by the trapezoidal rule, whose error decreases
/// geometrically.
fn mean_inertia(piece: &RigidPiece) -> f64 {
    const MOST: u32 = 1 << 14;
    let sum = |count: u32, first: u32, step: usize| -> f64 {
        let angles = (first..count).step_by(step).map(|i| PI * f64::from(i) / f64::from(count));
        angles.map(|angle| piece.motion(angle).inertia).sum()
    };
    let mut count = 16;
    let mut total = sum(count, 0, 1);
    loop {
        let before = total / f64::from(count);
        count *= 2;
        // The samples halfway between the previous ones.
        total += sum(count, 1, 2);
        let mean = total / f64::from(count);
        if (mean - before).abs() <= 1e-14 * mean || count >= MOST {
            return mean;
        }
    }
}
