//! A driveline with compliant shafts as a chain of rigid pieces between springs.

use std::sync::OnceLock;

use crate::dynamics::coupling::{Coupling, Law};
use crate::dynamics::periodic::multiple;
use crate::dynamics::rigid_piece::{Harmonic, RigidPiece};
use crate::error::{Error, Result};
use crate::mechanics::chain::Transfer;

/// A driveline with compliant shafts, inertias, dampings and a load.
///
/// Shaft `i` has an inertia at its input end and one at its output end, a torsional stiffness
/// between them and a damping. The input end of shaft 0 turns at constant speed or is free, and the
/// output end of the last shaft carries the load. Each compliant shaft adds one unknown, the angle of
/// its output end, and a free drive adds its own; the rigid shafts and joints behind are one piece
/// that follows this angle.
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
    pub(super) drive: Drive,
    /// Half turns of the drive in the common period of joints and harmonic torques.
    pub(super) half_turns: usize,
    shafts: usize,
    /// The highest natural frequency in rad/s, once it is known.
    highest: OnceLock<f64>,
}

/// Boundary condition of the input end of shaft 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Drive {
    /// It turns at constant speed, and an inertia there has no effect.
    #[default]
    Held,
    /// A torque drives it whose mean keeps the mean speed, and which falls by `slope` in N m s/rad
    /// with its speed.
    Free {
        /// In N m s/rad.
        slope: f64,
    },
}

/// A torque on a shaft end that varies with the angle `ψ` of this end:
/// `cos · cos(order ψ) + sin · sin(order ψ)` in N m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueHarmonic {
    /// Twice the number of the shaft, plus 1 for its output end.
    pub end: usize,
    /// How often it repeats in a turn of the shaft.
    pub order: f64,
    /// In N m.
    pub cos: f64,
    /// In N m.
    pub sin: f64,
}

/// A compliant shaft.
#[derive(Clone, Debug)]
pub(super) struct Spring {
    /// The number of the shaft.
    pub(super) shaft: usize,
    pub(super) law: Law,
    /// Damping in N m s/rad.
    pub(super) damping: f64,
}

impl Spring {
    /// The torque in N m at a twist in rad and its rate in rad/s.
    pub(super) fn torque(&self, twist: f64, rate: f64) -> f64 {
        let branch = self.law.branch(twist);
        branch.stiffness * twist + (self.damping * branch.damping * rate + branch.preload)
    }
}

/// The most turns in a common period.
const TURNS: usize = 8;

/// The highest order of a harmonic torque; higher ones would need more points than are allowed.
const MOST_ORDER: f64 = 256.0;

/// The half turns of the drive after which all orders repeat, shortest period first.
fn periods(orders: &[f64]) -> impl Iterator<Item = usize> {
    let repeat = |period: &usize| orders.iter().all(|order| multiple(*order, *period).is_some());
    std::iter::once(1).chain((2..=2 * TURNS).step_by(2)).filter(repeat)
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
            .map(|shaft| {
                let law = Law::linear(stiffnesses[shaft]);
                Spring { shaft, law, damping: dampings[shaft] }
            })
            .collect();
        if springs.is_empty() {
            let problem = "are all infinite; at least one shaft must be compliant";
            return Err(Error::new("stiffnesses", &[], problem));
        }
        // A piece begins at the output end of a shaft and ends at the input end of the next
        // compliant one.
        let (mut pieces, mut from_drive) = (Vec::<RigidPiece>::new(), Transfer::default());
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
            let piece =
                RigidPiece::new(&mut from_drive, pieces.last(), geometry, at(first), &behind);
            pieces.push(piece);
            if let (Some(shaft), true) = (start, pieces[number].has_no_inertia()) {
                let problem = "is 0.0, and so is every inertia that is rigidly connected to it; \
                               the output end of a compliant shaft needs an inertia";
                return Err(Error::new("inertias", &[shaft, 1], problem));
            }
        }
        Ok(Self {
            pieces,
            springs,
            load_torque,
            load_damping,
            drive: Drive::Held,
            half_turns: 1,
            shafts,
            highest: OnceLock::new(),
        })
    }

    /// The system with another drive.
    ///
    /// # Errors
    /// A free drive without an inertia, neither itself nor by what is fixed to it; a slope that is
    /// negative or not finite.
    pub fn with_drive(mut self, drive: Drive) -> Result<Self> {
        if let Drive::Free { slope } = drive {
            if self.pieces[0].has_no_inertia() {
                let problem = "is 0.0, and so is every inertia that is rigidly connected to it; \
                               a free drive needs an inertia";
                return Err(Error::new("inertias", &[0, 0], problem));
            }
            if !(0.0..f64::INFINITY).contains(&slope) {
                let problem = format!(
                    "is {slope:?}; it says how much the torque of the drive falls with rising speed, \
                     so it must be 0 or more, and finite"
                );
                return Err(Error::new("drive_slope", &[], problem));
            }
        }
        self.drive = drive;
        self.highest = OnceLock::new();
        Ok(self)
    }

    /// The system with torques that vary with the angles of shaft ends, in place of those it has.
    ///
    /// # Errors
    /// A shaft end that does not exist, an order that is not positive, amplitudes that are not
    /// finite, orders without a common divisor with 2, the joints' order, of at least 1/8.
    pub fn with_harmonics(mut self, harmonics: &[TorqueHarmonic]) -> Result<Self> {
        self.pieces.iter_mut().for_each(|piece| piece.harmonics.clear());
        let ends: Vec<_> = self.ends_of_curves();
        for (i, &TorqueHarmonic { end, order, cos, sin }) in harmonics.iter().enumerate() {
            let refused = |problem: String| Err(Error::new("harmonics", &[i], problem));
            if !(order > 0.0 && order <= MOST_ORDER) {
                return refused(format!(
                    "has the order {order:?}; it must be positive and at most {MOST_ORDER}"
                ));
            }
            if !(cos.is_finite() && sin.is_finite()) {
                return refused(format!("has the amplitudes {cos:?} and {sin:?}, not finite ones"));
            }
            let Some(mut curve) = ends.iter().position(|ends| ends.contains(&Some(end))) else {
                let last = self.shafts - 1;
                return refused(format!("acts on shaft {}; the last one is {last}", end / 2));
            };
            for piece in &mut self.pieces {
                if let Some(behind) = curve.checked_sub(1 + piece.followers.len()) {
                    curve = behind;
                    continue;
                }
                let follower = curve.checked_sub(1);
                piece.harmonics.push(Harmonic { follower, order, parts: [cos, sin] });
                break;
            }
        }
        // Torques are added in the order of the shafts.
        self.pieces.iter_mut().for_each(|piece| piece.harmonics.sort_by_key(|own| own.follower));
        let orders: Vec<f64> = harmonics.iter().map(|harmonic| harmonic.order).collect();
        let mut fitting = orders.len();
        while periods(&orders[..fitting]).next().is_none() {
            fitting -= 1;
        }
        if let Some(order) = orders.get(fitting) {
            // Its neighbours in the longest period of those before it.
            let turns =
                periods(&orders[..fitting]).last().map_or(1.0, |longest| 0.5 * longest as f64);
            let below = (order * turns).floor();
            let (lower, upper) = (below / turns, (below + 1.0) / turns);
            let near =
                if below > 0.0 { format!("{lower:?} or {upper:?}") } else { format!("{upper:?}") };
            let problem = format!(
                "have the orders {orders:?}, which with the joints' order 2 repeat after more than \
                 {TURNS} turns; they need a common divisor of at least 1/{TURNS}, so take {near} \
                 instead of {order:?}"
            );
            return Err(Error::new("harmonics", &[], problem));
        }
        self.half_turns = periods(&orders).next().unwrap_or(1);
        Ok(self)
    }

    /// The system with couplings in place of the springs of compliant shafts.
    ///
    /// # Errors
    /// A shaft that is not compliant, a table that does not rise, a law that is not the only one, a
    /// loss factor beside a stiffness that varies with the twist.
    pub fn with_couplings(mut self, couplings: &[Coupling]) -> Result<Self> {
        for coupling in couplings {
            let found = self.springs.iter_mut().find(|spring| spring.shaft == coupling.shaft);
            let Some(spring) = found else {
                let problem = format!("are at shaft {}, which is rigid", coupling.shaft);
                return Err(Error::new("couplings", &[coupling.shaft], problem));
            };
            let law = Law::of(coupling)?;
            spring.law = law.at_mean(self.load_torque).unwrap_or(law);
        }
        if let Some(spring) = self.springs.iter().find(|spring| spring.law.loss_factor > 0.0)
            && self.has_kinks()
        {
            let problem = "has a loss factor beside a coupling whose stiffness varies with its \
                           twist; constant loss factors need linear couplings in all shafts";
            return Err(Error::new("couplings", &[spring.shaft], problem));
        }
        self.highest = OnceLock::new();
        Ok(self)
    }

    /// The system with the stiffnesses that belong to these mean torques of the compliant shafts in
    /// N m, if any of them differs.
    pub(super) fn at_means(&self, torques: impl Iterator<Item = f64>) -> Option<Self> {
        let mut settled = None;
        for (s, (spring, torque)) in self.springs.iter().zip(torques).enumerate() {
            if let Some(law) = spring.law.at_mean(torque) {
                let copy = || Self { highest: OnceLock::new(), ..self.clone() };
                settled.get_or_insert_with(copy).springs[s].law = law;
            }
        }
        settled
    }

    /// The torque in N m that brakes the last shaft at a speed in rad/s.
    pub(super) fn static_load(&self, speed: f64) -> f64 {
        self.load_damping.mul_add(speed, self.load_torque)
    }

    /// The highest order of a harmonic torque; 0 without one.
    pub(super) fn highest_order(&self) -> f64 {
        let all = self.pieces.iter().flat_map(|piece| &piece.harmonics);
        all.fold(0.0, |most, harmonic| harmonic.order.max(most))
    }

    /// The turns of the drive in one period.
    pub fn period_turns(&self) -> f64 {
        0.5 * self.half_turns as f64
    }

    /// Whether the drive is free.
    pub fn is_free(&self) -> bool {
        self.drive != Drive::Held
    }

    /// The system with this share of every bend and every harmonic torque; 0 is the straight
    /// driveline.
    pub(super) fn bent(&self, share: f64) -> Self {
        let mut from_drive = Transfer::default();
        let mut pieces = Vec::<RigidPiece>::new();
        for piece in &self.pieces {
            pieces.push(piece.bent(share, &mut from_drive, pieces.last()));
        }
        let (springs, highest) = (self.springs.clone(), OnceLock::new());
        Self { pieces, springs, highest, ..*self }
    }

    /// The highest natural frequency in rad/s.
    pub(super) fn highest_frequency(&self) -> f64 {
        *self.highest.get_or_init(|| self.natural_frequencies().last().copied().unwrap_or(f64::NAN))
    }

    /// Whether the stiffness of a coupling varies with its twist.
    pub(super) fn has_kinks(&self) -> bool {
        self.springs.iter().any(|spring| !spring.law.is_linear())
    }

    /// The number of compliant shafts.
    pub fn compliant(&self) -> usize {
        self.springs.len()
    }

    /// The number of unknown angles.
    pub(super) fn unknowns(&self) -> usize {
        self.springs.len() + usize::from(self.is_free())
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
