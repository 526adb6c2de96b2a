//! A driveline whose shafts move across their axes, and what it consists of.

use nalgebra::Complex;

use crate::dynamics::lateral::bearing::ElasticBearing;
use crate::dynamics::lateral::check::{check_axis, check_each};
use crate::error::{Error, Result};
use crate::mechanics::geometry::Vector;

type C = Complex<f64>;

/// Items closer to an end of a shaft than this share of its length are at that end.
const SAME_PLACE: f64 = 1e-9;

/// Role of a shaft in lateral vibration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LateralShaft {
    /// Part of a machine: it does not move across its axis.
    Held,
    /// It moves and does not bend.
    Rigid(RigidShaft),
    /// It moves and bends.
    Bending(BendingShaft),
}

/// A shaft that does not bend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidShaft {
    /// In kg.
    pub mass: f64,
    /// Distance of the centre of mass from the upstream end in m.
    pub centre: f64,
    /// Moment of inertia about an axis across the shaft through its centre of mass in kg m².
    pub across: f64,
    /// Moment of inertia about the shaft's axis in kg m².
    pub along: f64,
}

/// A shaft of constant round section that bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BendingShaft {
    /// `EI` in N m².
    pub stiffness: f64,
    /// `ρA` in kg/m.
    pub mass: f64,
    /// `κGA` in N by Timoshenko, infinite by Euler and Bernoulli.
    pub shear_stiffness: f64,
    /// `ρI` in kg m by Timoshenko, 0 by Euler and Bernoulli.
    pub rotary_inertia: f64,
    /// Loss factor of the material, for orders from 2 on: it turns with the shaft and sees an order
    /// less by 1.
    pub loss_factor: f64,
}

/// A yoke, flange or disc on a shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// The shaft that carries it.
    pub shaft: usize,
    /// Distance from the shaft's upstream end in m.
    pub position: f64,
    /// In kg.
    pub mass: f64,
    /// Moment of inertia about an axis across the shaft in kg m².
    pub across: f64,
    /// Moment of inertia about the shaft's axis in kg m².
    pub along: f64,
}

/// A force `mass_arm · Ω²` that turns with the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unbalance {
    /// The shaft on which it acts.
    pub shaft: usize,
    /// Distance from the shaft's upstream end in m.
    pub position: f64,
    /// Mass times distance from the axis in kg m.
    pub mass_arm: f64,
    /// The part of it across the shaft is where the force points at drive angle 0.
    pub direction: Vector,
}

/// Items attached to the shafts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attached {
    /// Elastic bearings.
    pub bearings: Vec<ElasticBearing>,
    /// Point masses.
    pub masses: Vec<PointMass>,
    /// Unbalances.
    pub unbalances: Vec<Unbalance>,
}

/// A driveline whose shafts move across their axes on elastic bearings.
///
/// Every joint passes on forces across one of its shafts, which slides along its own axis without
/// force.
#[derive(Clone, Debug)]
pub struct LateralSystem {
    pub(super) directions: Vec<Vector>,
    pub(super) lengths: Vec<f64>,
    pub(super) shafts: Vec<LateralShaft>,
    pub(super) attached: Attached,
    pub(super) sliding: Vec<usize>,
    /// For each shaft two unit vectors across it, of which the second is `u ×` the first.
    pub(super) pairs: Vec<[Vector; 2]>,
}

impl LateralSystem {
    /// The system of shafts with these unit directions and lengths in m. `sliding` names for each
    /// joint one of its two shafts; by default the one that it must support, and where that is
    /// neither, the driven one.
    ///
    /// # Errors
    /// Numbers of lengths, shafts or sliding shafts that do not fit; a property that is negative or
    /// not finite, a loss factor above 1; what is attached to a shaft that does not exist, does not
    /// move or is too short; two directions that differ without an axis across the shaft; a joint
    /// between two shafts that do not move; a shaft without support.
    pub fn new(
        directions: &[Vector],
        lengths: &[f64],
        shafts: &[LateralShaft],
        attached: Attached,
        sliding: Option<&[usize]>,
    ) -> Result<Self> {
        let count = directions.len();
        for (name, found) in [("lengths", lengths.len()), ("shafts", shafts.len())] {
            if found != count {
                let problem = format!("has {found} values; the driveline has {count} shafts");
                return Err(Error::new(name, &[], problem));
            }
        }
        for (i, shaft) in shafts.iter().enumerate() {
            check_shaft(*shaft).map_err(|problem| Error::new("shafts", &[i], problem))?;
        }
        for (joint, pair) in shafts.windows(2).enumerate() {
            if pair == [LateralShaft::Held; 2] {
                let problem =
                    format!("does not move, nor does shaft {joint}; one side of a joint must");
                return Err(Error::new("shafts", &[joint + 1], problem));
            }
        }
        let mut own = Self {
            pairs: directions.iter().map(|&u| pair_across(u, any_axis(u))).collect(),
            directions: directions.to_vec(),
            lengths: lengths.to_vec(),
            shafts: shafts.to_vec(),
            attached,
            sliding: vec![],
        };
        own.check_attached()?;
        own.sliding = match sliding {
            None => own.default_sliding(),
            Some(given) => {
                if given.len() + 1 != count {
                    let problem = format!("has {} values for {} joints", given.len(), count - 1);
                    return Err(Error::new("sliding", &[], problem));
                }
                for (joint, &shaft) in given.iter().enumerate() {
                    if shaft != joint && shaft != joint + 1 {
                        let problem = format!(
                            "is shaft {shaft}; the joint joins shafts {joint} and {}",
                            joint + 1
                        );
                        return Err(Error::new("sliding", &[joint], problem));
                    }
                }
                given.to_vec()
            }
        };
        own.check_support()?;
        Ok(own)
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.sliding.len()
    }

    /// Number of elastic bearings.
    pub fn bearings(&self) -> usize {
        self.attached.bearings.len()
    }

    /// For each joint the shaft that slides along its own axis.
    pub fn sliding(&self) -> &[usize] {
        &self.sliding
    }

    /// A place on a shaft, which only rounding may separate from an end.
    ///
    /// # Errors
    /// A shaft that does not exist, a position beyond it.
    pub fn place(
        &self,
        name: &'static str,
        item: usize,
        shaft: usize,
        position: f64,
    ) -> Result<f64> {
        let Some(&length) = self.lengths.get(shaft) else {
            let problem = format!("has shaft {shaft}; there are {} shafts", self.lengths.len());
            return Err(Error::new(name, &[item], problem));
        };
        let place = self.snapped(shaft, position);
        if (0.0..=length).contains(&place) {
            return Ok(place);
        }
        let problem =
            format!("has the position {position:?} m; shaft {shaft} is {length:?} m long");
        Err(Error::new(name, &[item], problem))
    }

    /// A position, or the end of the shaft from which only rounding separates it.
    pub(super) fn snapped(&self, shaft: usize, position: f64) -> f64 {
        let length = self.lengths[shaft];
        let near = |end: f64| (position - end).abs() <= SAME_PLACE * length;
        [0.0, length].into_iter().find(|&end| near(end)).unwrap_or(position)
    }

    /// The two complex unit vectors across a shaft in which a vibration turns with the shaft and
    /// against it.
    pub(super) fn turning(&self, shaft: usize) -> [[C; 3]; 2] {
        let [first, second] = self.pairs[shaft];
        [-1.0, 1.0].map(|sign| {
            [0, 1, 2]
                .map(|i| Complex::new(first[i], sign * second[i]) * std::f64::consts::FRAC_1_SQRT_2)
        })
    }

    fn check_attached(&mut self) -> Result<()> {
        let mut attached = std::mem::take(&mut self.attached);
        for (i, own) in attached.bearings.iter_mut().enumerate() {
            own.position = self.moving_place("bearings", i, own.shaft, own.position)?;
            own.check(self.directions[own.shaft])
                .map_err(|problem| Error::new("bearings", &[i], problem))?;
        }
        for (i, own) in attached.masses.iter_mut().enumerate() {
            own.position = self.moving_place("masses", i, own.shaft, own.position)?;
            let given =
                [("mass", own.mass), ("moment across", own.across), ("moment along", own.along)];
            check_each(&given).map_err(|problem| Error::new("masses", &[i], problem))?;
        }
        for (i, own) in attached.unbalances.iter_mut().enumerate() {
            own.position = self.moving_place("unbalance", i, own.shaft, own.position)?;
            check_each(&[("mass arm", own.mass_arm)])
                .and_then(|()| check_axis("direction", own.direction, self.directions[own.shaft]))
                .map_err(|problem| Error::new("unbalance", &[i], problem))?;
        }
        self.attached = attached;
        Ok(())
    }

    fn moving_place(
        &self,
        name: &'static str,
        item: usize,
        shaft: usize,
        position: f64,
    ) -> Result<f64> {
        let place = self.place(name, item, shaft, position)?;
        if self.shafts[shaft] == LateralShaft::Held {
            let problem = format!("is on shaft {shaft}, which is held and does not move");
            return Err(Error::new(name, &[item], problem));
        }
        Ok(place)
    }

    /// The joint that a shaft lacks as a support slides on it, as in statics.
    fn default_sliding(&self) -> Vec<usize> {
        let joints = self.lengths.len() - 1;
        let mut found: Vec<Option<usize>> = vec![None; joints];
        let lacking: Vec<(usize, usize)> = (0..=joints)
            .filter(|&shaft| self.shafts[shaft] != LateralShaft::Held)
            .map(|shaft| {
                let own = self.attached.bearings.iter().filter(|own| own.shaft == shaft).count();
                (shaft, 2 - own.min(2))
            })
            .collect();
        // Each pass may decide for a neighbour.
        for _ in 0..=joints {
            for &(shaft, needed) in &lacking {
                let own = shaft.saturating_sub(1)..joints.min(shaft + 1);
                let open: Vec<usize> = own.filter(|&joint| found[joint].is_none()).collect();
                if needed >= open.len() {
                    for joint in open {
                        found[joint] = Some(shaft);
                    }
                }
            }
        }
        let driven = |joint: usize| {
            if self.shafts[joint + 1] == LateralShaft::Held { joint } else { joint + 1 }
        };
        (0..joints).map(|joint| found[joint].unwrap_or_else(|| driven(joint))).collect()
    }
}

/// Two unit vectors across a unit vector `u`: along an axis, and `u ×` that.
pub(super) fn pair_across(u: Vector, axis: Vector) -> [Vector; 2] {
    let first = (axis - u * axis.dot(&u)).normalize();
    // Once more, because a part across that is small has lost digits.
    let first = (first - u * first.dot(&u)).normalize();
    [first, u.cross(&first)]
}

/// The axis of space that is farthest from a direction.
fn any_axis(u: Vector) -> Vector {
    Vector::ith(u.iamin(), 1.0)
}

fn check_shaft(shaft: LateralShaft) -> std::result::Result<(), String> {
    match shaft {
        LateralShaft::Held => Ok(()),
        LateralShaft::Rigid(RigidShaft { mass, centre, across, along }) => {
            let given = [("mass", mass), ("moment across", across), ("moment along", along)];
            check_each(&given)?;
            if centre.is_finite() {
                return Ok(());
            }
            Err(format!("has the centre {centre:?}; it must be finite"))
        }
        LateralShaft::Bending(own) => {
            let positive = |value: f64| value > 0.0 && value.is_finite();
            if !(positive(own.stiffness) && positive(own.mass) && own.shear_stiffness > 0.0) {
                return Err("has no stiffness or no mass".into());
            }
            check_each(&[("rotary inertia", own.rotary_inertia)])?;
            if (0.0..=1.0).contains(&own.loss_factor) {
                return Ok(());
            }
            Err(format!("has the loss factor {:?}; it must lie in [0, 1]", own.loss_factor))
        }
    }
}
