//! Judgement by limits: ranks, the figures of a machine in all of its states, and the single
//! changes that bring everything within.

pub mod figures;
pub mod machine;
pub mod suggest;
mod turned;

use crate::error::{Error, Result};
use crate::plan::output::Per;

pub use figures::{Figure, Variable};
pub use machine::{CaseLoads, Cases, LimitOf, Machine, Parts, SlidingShaft};
pub use suggest::{Change, Search, Searching};

/// Share of a limit, or of the size of the figure judged, that counts as rounding.
///
/// A bend that is entered as 3° comes back with a rounding error, and limits have two digits.
pub const ROUNDING: f64 = 1e-9;

/// Whether a limit is the most that a figure may be, or the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The most.
    Most,
    /// The least.
    Least,
}

/// How a figure stands to its limits, from the best to the worst.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// There is no limit, or the figure is not a number.
    #[default]
    NotJudged,
    /// It keeps its limit.
    Within,
    /// It is past its limit, but not past its maximum.
    Tolerable,
    /// It is past its maximum.
    Beyond,
}

/// A limit, how far past it a figure is tolerable, and the side on which both are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Up to here a figure is within; NaN if there is no limit.
    pub limit: f64,
    /// Up to here it is tolerable; the limit itself where there is nothing between.
    pub maximum: f64,
    /// On which side.
    pub side: Side,
    /// The size of what is judged, of which rounding is a part where the limit is nearer to 0.
    pub size: f64,
}

impl Limit {
    /// No limit.
    pub const NONE: Self = Self { limit: f64::NAN, maximum: f64::NAN, side: Side::Most, size: 0.0 };

    /// The rank of a figure.
    ///
    /// ```
    /// use cardan::judge::{Limit, Rank, Side};
    ///
    /// let limit = Limit { limit: 3.0, maximum: 4.0, side: Side::Most, size: 0.0 };
    /// assert_eq!(limit.rank(3.0 + 1e-12), Rank::Within);
    /// assert_eq!(limit.rank(3.1), Rank::Tolerable);
    /// assert_eq!(limit.rank(4.1), Rank::Beyond);
    /// assert_eq!(limit.rank(f64::NAN), Rank::NotJudged);
    /// ```
    pub fn rank(&self, value: f64) -> Rank {
        if value.is_nan() || self.limit.is_nan() {
            Rank::NotJudged
        } else if self.keeps(value, self.limit) {
            Rank::Within
        } else if self.keeps(value, self.maximum) {
            Rank::Tolerable
        } else {
            Rank::Beyond
        }
    }

    /// By how much a figure is past its limit, over the limit or the size; negative within, and
    /// `−∞` where it is not judged.
    pub fn excess(&self, value: f64) -> f64 {
        let past = match self.side {
            Side::Most => value - self.limit,
            Side::Least => self.limit - value,
        };
        if past.is_nan() { f64::NEG_INFINITY } else { past / self.limit.abs().max(self.size) }
    }

    fn keeps(&self, value: f64, bound: f64) -> bool {
        let rounding = ROUNDING * bound.abs().max(self.size);
        // A bound that is infinite keeps what is infinite.
        match self.side {
            Side::Most => value <= bound || value <= bound + rounding,
            Side::Least => value >= bound || value >= bound - rounding,
        }
    }
}

/// Where a figure has values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// In each state.
    States,
    /// In each state, and in each step of the duty cycle.
    Cases,
    /// One over all states or steps.
    Once,
}

/// Computation of a figure, from the least effort to the most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// Closed forms.
    Closed,
    /// The fatigue of the pins over a turn.
    Fatigue,
    /// Their friction.
    Friction,
    /// The largest torque over a turn.
    Torque,
    /// The motion on both flanks of the play.
    Play,
    /// The largest forces over a turn.
    Forces,
}

/// How many places of the turn are looked at for what is largest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// A few: what is found is at most the largest.
    Brief,
    /// As many as the largest needs.
    Full,
}

impl Stage {
    pub(crate) const ALL: [Self; 6] =
        [Self::Closed, Self::Fatigue, Self::Friction, Self::Torque, Self::Play, Self::Forces];
}

/// The properties of a kind of figure.
#[derive(Clone, Copy, Debug)]
pub struct KindRow {
    /// The name in requests.
    pub name: &'static str,
    /// Its unit, `"1"` for a ratio.
    pub unit: &'static str,
    /// Whether it is of each shaft, joint or bearing, or of the whole driveline.
    pub per: Option<Per>,
    /// Whether its limit is the most or the least.
    pub side: Side,
    /// Where it has values.
    pub scope: Scope,
    pub(crate) stage: Stage,
}

/// The table of kinds: each row has a meaning, a variant, a name, a unit, the part described, the
/// side of its limit, where it has values, and what computes it.
macro_rules! kinds {
    ($($(#[$meaning:meta])* $kind:ident: $name:literal, $unit:literal, $per:expr, $side:ident,
        $scope:ident, $stage:ident;)*) => {
        /// Kind of a figure.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum Kind {$($(#[$meaning])* $kind,)*}

        impl Kind {
            /// All kinds.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$kind),*];

            /// The properties of the kind.
            pub const fn row(self) -> KindRow {
                match self {
                    $(Self::$kind => KindRow {
                        name: $name,
                        unit: $unit,
                        per: $per,
                        side: Side::$side,
                        scope: Scope::$scope,
                        stage: Stage::$stage,
                    },)*
                }
            }
        }
    };
}

const JOINT: Option<Per> = Some(Per::Joint);
const SHAFT: Option<Per> = Some(Per::Shaft);

kinds! {
    /// Bend of the joint that moves the last shaft as the driveline does.
    EquivalentBend: "equivalent_bend", "rad", None, Most, States, Closed;
    /// Difference of the bends of a driveline of two joints.
    BendDifference: "bend_difference", "rad", None, Most, States, Closed;
    /// Largest acceleration of the last shaft.
    TorsionalExcitation: "torsional_excitation", "rad/s²", None, Most, States, Closed;
    /// Second order of the accelerations of all intermediate shafts together.
    InertiaDriving: "inertia_excitation_driving", "rad/s²", None, Most, States, Closed;
    /// The same where the output drives.
    InertiaCoasting: "inertia_excitation_coasting", "rad/s²", None, Most, States, Closed;
    /// Bend of a joint.
    Bend: "bend", "rad", JOINT, Most, Cases, Closed;
    /// Speed of the drive times the bend of a joint.
    SpeedBend: "speed_bend", "rad²/s", JOINT, Most, Cases, Closed;
    /// Life that 90 % of the joints reach over the duty cycle.
    Life: "life", "h", JOINT, Least, Once, Fatigue;
    /// Heat of a joint, the mean over a turn.
    Heat: "heat", "W", JOINT, Most, Cases, Friction;
    /// Critical bending speed of a tube over its speed.
    CriticalMargin: "critical_margin", "1", SHAFT, Least, Cases, Closed;
    /// Shear stress of a tube under the largest torque over a turn.
    ShearStress: "shear_stress", "Pa", SHAFT, Most, Cases, Torque;
    /// Longest less shortest length of the shaft with the spline over the states.
    SplineTravel: "spline_travel", "m", SHAFT, Most, Once, Closed;
    /// Engaged length of the spline.
    SplineEngaged: "spline_engaged", "m", SHAFT, Least, States, Closed;
    /// Travel left until the spline bottoms.
    SplinePushIn: "spline_push_in", "m", SHAFT, Least, States, Closed;
    /// Axial force of the spline under the largest torque over a turn.
    SplineForce: "spline_force", "N", SHAFT, Most, Cases, Torque;
    /// Distance of straight ahead from the nearest angle about which a steering column is
    /// symmetric.
    SteeringOffset: "steering_offset", "rad", None, Most, States, Closed;
    /// Largest difference of the ratio after equal turns to the left and to the right.
    SteeringRatio: "steering_ratio", "1", None, Most, States, Closed;
    /// Largest angle by which the last shaft is loose while the drive is held.
    Lash: "lash", "rad", None, Most, States, Play;
    /// Largest force of a joint over a turn.
    JointForce: "joint_force", "N", JOINT, Most, States, Forces;
    /// Largest force of a bearing over a turn.
    BearingForce: "bearing_force", "N", Some(Per::Bearing), Most, States, Forces;
}

impl Kind {
    /// The kind with this name.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|kind| kind.row().name == name);
        found.ok_or_else(|| Error::new("limits", &[], format!("is of {name:?}, which is unknown")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rank(value: f64, [limit, maximum]: [f64; 2], side: Side, size: f64) -> Rank {
        Limit { limit, maximum, side, size }.rank(value)
    }

    #[test]
    fn rounding_is_a_part_of_the_limit_or_of_the_size() {
        let most = |value| rank(value, [3.0, 4.0], Side::Most, 0.0);
        for (value, expected) in [
            (3.0 * (1.0 + 0.9e-9), Rank::Within),
            (3.0 * (1.0 + 1.1e-9), Rank::Tolerable),
            (4.0 * (1.0 + 0.9e-9), Rank::Tolerable),
            (4.0 * (1.0 + 1.1e-9), Rank::Beyond),
            (-f64::INFINITY, Rank::Within),
            (f64::INFINITY, Rank::Beyond),
        ] {
            assert_eq!(most(value), expected, "{value:e}");
        }
        let least = |value, size| rank(value, [0.0; 2], Side::Least, size);
        assert_eq!(least(-0.9e-9, 1.0), Rank::Within);
        assert_eq!(least(-1.1e-9, 1.0), Rank::Beyond);
        assert_eq!(least(-1e-300, 0.0), Rank::Beyond);
        assert_eq!(least(0.0, 0.0), Rank::Within);
        assert_eq!(rank(2.0, [3.0, 2.0], Side::Least, 0.0), Rank::Tolerable);
        let infinite = [f64::INFINITY; 2];
        assert_eq!(rank(f64::INFINITY, infinite, Side::Least, 0.0), Rank::Within);
    }

    #[test]
    fn nothing_is_judged_without_a_limit_or_a_number() {
        assert_eq!(Limit::NONE.rank(1.0), Rank::NotJudged);
        assert_eq!(rank(f64::NAN, [3.0; 2], Side::Most, 0.0), Rank::NotJudged);
        assert_eq!(Limit::NONE.excess(1.0), f64::NEG_INFINITY);
    }

    #[test]
    fn every_kind_has_a_name() {
        for kind in Kind::ALL {
            assert_eq!(Kind::named(kind.row().name), Ok(kind));
        }
        let error = Kind::named("noise").unwrap_err();
        assert_eq!(error.to_string(), "limits is of \"noise\", which is unknown");
    }
}
