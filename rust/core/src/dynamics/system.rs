//! A driveline with compliant shafts as a chain of rigid pieces between springs.

use std::sync::OnceLock;

use crate::dynamics::rigid_piece::RigidPiece;
use crate::error::{Error, Result};
use crate::mechanics::chain::Transfer;

/// A driveline with compliant shafts, inertias, dampings and a load.
///
/// Shaft `i` has an inertia at its input end and one at its output end, a torsional stiffness
/// between them and a damping. The input end of shaft 0 turns at constant speed, and the output
/// end of the last shaft carries the load. Each compliant shaft adds one unknown, the angle of its
/// output end; the rigid shafts and joints behind it are one piece that follows this angle.
#[derive(Clone, Debug)]
pub struct TorsionalSystem {
    /// The piece that follows the drive, then the one behind each compliant shaft.
    pub(super) pieces: Vec<RigidPiece>,
    /// The shaft before each piece but the first.
    pub(super) springs: Vec<Spring>,
    /// Constant braking torque on the last shaft in N m.
    pub(super) load_torque: f64,
    /// Viscous load on the last shaft in N m s/rad.
    pub(super) load_damping: f64,
    shafts: usize,
    /// The highest natural frequency in rad/s, once it is known.
    highest: OnceLock<f64>,
}

/// A compliant shaft.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    /// The number of the shaft.
    pub(super) shaft: usize,
    /// Stiffness in N m/rad.
    pub(super) stiffness: f64,
    /// Damping in N m s/rad.
    pub(super) damping: f64,
}

/// The properties of the shafts of one driveline with `n` joints.
#[derive(Clone, Copy, Debug)]
pub struct ShaftEnds<'a> {
    /// Inertias at the input end and the output end of each shaft in kg m², `2 (n + 1)`.
    pub inertias: &'a [f64],
    /// Stiffnesses in N m/rad, `n + 1`; infinite for a rigid shaft.
    pub stiffnesses: &'a [f64],
    /// Dampings in N m s/rad, `n + 1`; those of rigid shafts have no effect.
    pub dampings: &'a [f64],
}

impl TorsionalSystem {
    /// The system of a driveline with `n` bends, `n − 1` twists and `n − 1` phases in rad. The
    /// load torque in N m brakes the last shaft; the viscous load is in N m s/rad.
    ///
    /// ```
    /// use cardan::{ShaftEnds, TorsionalSystem};
    ///
    /// let shafts = ShaftEnds {
    ///     inertias: &[0.0, 0.0, 0.0, 0.02],
    ///     stiffnesses: &[f64::INFINITY, 4000.0],
    ///     dampings: &[0.0, 0.4],
    /// };
    /// let system = TorsionalSystem::new(&[0.35], &[], &[], shafts, [30.0, 0.0]).unwrap();
    /// assert!((system.natural_frequencies()[0] - (4000.0_f64 / 0.02).sqrt()).abs() < 1e-9);
    /// ```
    ///
    /// # Errors
    /// Arrays whose lengths do not fit the number of joints, no compliant shaft, a compliant shaft
    /// whose output end has no inertia, neither itself nor by what is fixed to it.
    pub fn new(
        bends: &[f64],
        twists: &[f64],
        phases: &[f64],
        of_shafts: ShaftEnds<'_>,
        [load_torque, load_damping]: [f64; 2],
    ) -> Result<Self> {
        let ShaftEnds { inertias, stiffnesses, dampings } = of_shafts;
        let shafts = bends.len() + 1;
        for (name, array, needed) in [
            ("twists", twists, shafts.saturating_sub(2)),
            ("phases", phases, shafts.saturating_sub(2)),
            ("inertias", inertias, 2 * shafts),
            ("stiffnesses", stiffnesses, shafts),
            ("dampings", dampings, shafts),
        ] {
            if array.len() != needed {
                let problem = format!("has {} values; {shafts} shafts need {needed}", array.len());
                return Err(Error::new(name, &[], problem));
            }
        }
        let compliant = |shaft: &usize| stiffnesses[*shaft] < f64::INFINITY;
        let springs: Vec<Spring> = (0..shafts)
            .filter(compliant)
            .map(|shaft| Spring { shaft, stiffness: stiffnesses[shaft], damping: dampings[shaft] })
            .collect();
        if springs.is_empty() {
            let problem = "are all infinite; at least one shaft must be compliant";
            return Err(Error::new("stiffnesses", &[], problem));
        }
        // A piece begins at the output end of a shaft and ends at the input end of the next
        // compliant one.
        let (mut pieces, mut from_drive) = (vec![], Transfer::default());
        let starts = std::iter::once(None).chain(springs.iter().map(|spring| Some(spring.shaft)));
        for (number, start) in starts.enumerate() {
            let next = springs.get(number).map(|spring| spring.shaft);
            let first = start.unwrap_or(0);
            let end = next.unwrap_or(shafts - 1);
            // The ends of a shaft that belong to the piece.
            let at = |shaft: usize| {
                let input = if start == Some(shaft) { 0.0 } else { inertias[2 * shaft] };
                let output = if next == Some(shaft) { 0.0 } else { inertias[2 * shaft + 1] };
                input + output
            };
            let behind: Vec<f64> = (first + 1..=end).map(at).collect();
            let last = end.min(twists.len());
            let between = first.min(last)..last;
            let geometry = [&bends[first..end], &twists[between.clone()], &phases[between]]
                .map(<[f64]>::to_vec);
            pieces.push(RigidPiece::new(&mut from_drive, geometry, at(first), &behind));
            if let (Some(shaft), true) = (start, pieces[number].has_no_inertia()) {
                let problem = "is 0.0, and so is every inertia that is rigidly connected to it; \
                               the output end of a compliant shaft needs an inertia";
                return Err(Error::new("inertias", &[shaft, 1], problem));
            }
        }
        Ok(Self { pieces, springs, load_torque, load_damping, shafts, highest: OnceLock::new() })
    }

    /// The system with this share of every bend; 0 is the straight driveline.
    pub(super) fn bent(&self, share: f64) -> Self {
        let mut from_drive = Transfer::default();
        let pieces = self.pieces.iter().map(|piece| piece.bent(share, &mut from_drive)).collect();
        let (springs, highest) = (self.springs.clone(), OnceLock::new());
        Self { pieces, springs, highest, ..*self }
    }

    /// The highest natural frequency in rad/s.
    pub(super) fn highest_frequency(&self) -> f64 {
        *self.highest.get_or_init(|| self.natural_frequencies().last().copied().unwrap_or(f64::NAN))
    }

    /// The number of compliant shafts.
    pub fn unknowns(&self) -> usize {
        self.springs.len()
    }

    /// The number of shafts.
    pub fn shafts(&self) -> usize {
        self.shafts
    }

    /// The shaft ends, as in `shaft_ends`, that turn with every piece and with every shaft behind a
    /// joint of it, in order.
    pub(super) fn ends_of_curves(&self) -> Vec<[Option<usize>; 2]> {
        let starts = std::iter::once(0).chain(self.springs.iter().map(|spring| spring.shaft));
        let mut found = vec![];
        for (number, (piece, first)) in self.pieces.iter().zip(starts).enumerate() {
            let next = self.springs.get(number).map(|spring| spring.shaft);
            let output = |shaft: usize| (next != Some(shaft)).then_some(2 * shaft + 1);
            let own = if number == 0 { output(first) } else { Some(2 * first + 1) };
            found.push([(number == 0).then_some(0), own]);
            let behind = first + 1..=first + piece.followers.len();
            found.extend(behind.map(|shaft| [Some(2 * shaft), output(shaft)]));
        }
        found
    }

    /// Calls `put` with every shaft end (twice the shaft, plus 1 for the output end), its angle
    /// error relative to the drive in rad and the first two derivatives of its angle.
    pub(super) fn shaft_ends(&self, pieces: &[PieceState], mut put: impl FnMut(usize, [f64; 3])) {
        let mut ends = self.ends_of_curves().into_iter();
        for (piece, state) in self.pieces.iter().zip(pieces) {
            let &PieceState { angle, error, slope, curvature } = state;
            let followers = piece.followers(angle).map(|[own_error, ratio, ratio_slope]| {
                let curve = ratio.mul_add(curvature, ratio_slope * slope * slope);
                [error + own_error, ratio * slope, curve]
            });
            let curves = std::iter::once([error, slope, curvature]).chain(followers);
            for (curve, ends) in curves.zip(&mut ends) {
                ends.into_iter().flatten().for_each(|end| put(end, curve));
            }
        }
    }
}

/// Where a piece is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PieceState {
    /// The angle at which its first joint is entered.
    pub(super) angle: f64,
    /// The same relative to the drive angle and the constant offset.
    pub(super) error: f64,
    /// The first derivative of its angle by the drive angle or by time.
    pub(super) slope: f64,
    /// The second derivative.
    pub(super) curvature: f64,
}
