//! Natural frequencies of the mean system: the inertia of every piece is its mean over a turn, and
//! joints transmit with a ratio of one.

use std::f64::consts::PI;

use nalgebra::{DMatrix, SymmetricEigen};

use crate::dynamics::rigid_piece::RigidPiece;
use crate::dynamics::system::{Spring, TorsionalSystem};

/// A natural frequency and what moves in it.
#[derive(Clone, Debug)]
pub struct Mode {
    /// In rad/s.
    pub frequency: f64,
    /// The amplitudes of the angles of input end and output end of every shaft, of which the largest
    /// is 1.
    pub shape: Vec<f64>,
    /// The share of each compliant shaft in the energy of twist.
    pub shares: Vec<f64>,
    /// The shaft with the largest share.
    pub shaft: usize,
}

/// Critical speeds, and how far a range of drive speeds is from each of them. A speed is critical
/// where an order of the drive's rotation has a natural frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalSpeeds {
    /// In rad/s: those of the first order for every natural frequency, then those of the next order.
    pub speeds: Vec<f64>,
    /// The distance of the range from each critical speed in shares of this speed; 0 if the speed is
    /// in the range.
    pub away: Vec<f64>,
    /// The place of the critical speed that is nearest to the range among those of excited orders;
    /// `None` without excited orders.
    pub nearest: Option<usize>,
}

impl CriticalSpeeds {
    /// The critical speeds of natural frequencies in rad/s and of orders, each of which is excited or
    /// not, beside a range of drive speeds in rad/s.
    ///
    /// ```
    /// use cardan::dynamics::CriticalSpeeds;
    ///
    /// let found = CriticalSpeeds::new(&[400.0], &[(2.0, true), (4.0, true)], [120.0, 180.0]);
    /// assert_eq!(found.speeds, [200.0, 100.0]);
    /// assert_eq!((found.away, found.nearest), (vec![0.1, 0.2], Some(0)));
    /// ```
    pub fn new(frequencies: &[f64], orders: &[(f64, bool)], [low, high]: [f64; 2]) -> Self {
        let of = |&(order, _): &(f64, bool)| frequencies.iter().map(move |one| one / order);
        let speeds: Vec<f64> = orders.iter().flat_map(of).collect();
        let beside = |speed: &f64| (low - speed).max(speed - high).max(0.0) / speed;
        let away: Vec<f64> = speeds.iter().map(beside).collect();
        let is_excited = |place: &usize| orders[place / frequencies.len()].1;
        let nearest = (0..speeds.len())
            .filter(is_excited)
            .min_by(|&one, &other| away[one].total_cmp(&away[other]));
        Self { speeds, away, nearest }
    }
}

impl TorsionalSystem {
    /// Undamped natural frequencies in rad/s, lowest first, one per compliant shaft. A held drive
    /// turns at constant speed; the rotation of a free one with all shafts is not among them. The
    /// stiffness of a coupling is that at the load torque.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        self.modes().into_iter().map(|mode| mode.frequency).collect()
    }

    /// The natural frequencies and what moves in them, lowest first.
    pub fn modes(&self) -> Vec<Mode> {
        let free = usize::from(self.is_free());
        let m = self.unknowns();
        let inertias: Vec<f64> = self.pieces[1 - free..].iter().map(mean_inertia).collect();
        let scale = |s: usize, u: usize| 1.0 / (inertias[s] * inertias[u]).sqrt();
        let mut matrix = DMatrix::<f64>::zeros(m, m);
        for (place, spring) in self.springs.iter().enumerate() {
            let stiffness = spring.law.stiffness_at(self.load_torque);
            let s = place + free;
            matrix[(s, s)] += stiffness * scale(s, s);
            if s > 0 {
                matrix[(s - 1, s - 1)] += stiffness * scale(s - 1, s - 1);
                matrix[(s, s - 1)] = -stiffness * scale(s, s - 1);
                matrix[(s - 1, s)] = matrix[(s, s - 1)];
            }
        }
        let found = SymmetricEigen::new(matrix);
        let mut order: Vec<usize> = (0..m).collect();
        order.sort_by(|&i, &j| found.eigenvalues[i].total_cmp(&found.eigenvalues[j]));
        let ends = self.ends_of_curves();
        let mode = |&i: &usize| {
            let mut shape = vec![0.0; 2 * self.shafts()];
            let mut curves = ends.iter();
            for (p, piece) in self.pieces.iter().enumerate() {
                let own = (p + free).checked_sub(1);
                let turned = own.map_or(0.0, |u| found.eigenvectors[(u, i)] / inertias[u].sqrt());
                for ends in curves.by_ref().take(1 + piece.followers.len()) {
                    ends.iter().flatten().for_each(|&end| shape[end] = turned);
                }
            }
            let larger = |most: f64, x: &f64| if x.abs() > most.abs() { *x } else { most };
            let largest = shape.iter().fold(0.0, larger);
            for x in &mut shape {
                *x /= largest;
            }
            let twist = |spring: &Spring| {
                let stiffness = spring.law.stiffness_at(self.load_torque);
                let twisted = shape[2 * spring.shaft + 1] - shape[2 * spring.shaft];
                stiffness * twisted * twisted
            };
            let energies: Vec<f64> = self.springs.iter().map(twist).collect();
            let total: f64 = energies.iter().sum();
            let most = energies.iter().copied().fold(0.0, f64::max);
            let first = energies.iter().position(|&energy| energy == most).unwrap_or(0);
            Mode {
                frequency: found.eigenvalues[i].max(0.0).sqrt(),
                shares: energies.iter().map(|energy| energy / total).collect(),
                shaft: self.springs[first].shaft,
                shape,
            }
        };
        order[free..].iter().map(mode).collect()
    }

    /// The sum of the mean inertias in kg m².
    pub(super) fn total_inertia(&self) -> f64 {
        self.pieces.iter().map(mean_inertia).sum()
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
