//! Systems as arrays of numbers, which is how other languages give them.

use crate::dynamics::lateral::bearing::ElasticBearing;
use crate::dynamics::lateral::system::{
    Attached, BendingShaft, LateralShaft, LateralSystem, PointMass, RigidShaft, Unbalance,
};
use crate::error::{Error, Result};
use crate::input::batch::check_length;
use crate::mechanics::geometry::Vector;

/// Shafts or items of one kind: whole numbers, of shafts what they are (0 held, 1 rigid, 2 bending),
/// of items their shafts, and the other fields of each in the order of its type. An axis that is
/// missing is given as no numbers.
#[derive(Clone, Copy, Debug)]
pub struct Numbers<'a> {
    /// One for each.
    pub whole: &'a [usize],
    /// As many for each as the type has fields.
    pub fields: &'a [f64],
}

/// A system as arrays.
#[derive(Clone, Copy, Debug)]
pub struct Described<'a> {
    /// Fields of [`RigidShaft`] or [`BendingShaft`], filled up to 5.
    pub shafts: Numbers<'a>,
    /// Fields of [`ElasticBearing`] behind the shaft.
    pub bearings: Numbers<'a>,
    /// Fields of [`PointMass`] behind the shaft.
    pub masses: Numbers<'a>,
    /// Fields of [`Unbalance`] behind the shaft.
    pub unbalances: Numbers<'a>,
}

impl<'a> Numbers<'a> {
    /// Numbers of fields of a shaft, a bearing, a mass and an unbalance.
    pub const COUNTS: [usize; 4] = [5, ElasticBearing::FIELDS, 4, 5];

    fn each<const N: usize, T>(
        self,
        name: &'static str,
        make: impl Fn(usize, &'a [f64; N]) -> T,
    ) -> Result<Vec<T>> {
        check_length(name, self.fields.len(), self.whole.len(), N)?;
        let fields = self.fields.as_chunks::<N>().0;
        Ok(self.whole.iter().zip(fields).map(|(&whole, fields)| make(whole, fields)).collect())
    }
}

impl Described<'_> {
    /// The system of shafts with these unit directions and lengths in m.
    ///
    /// # Errors
    /// Numbers of values that do not fit, and as of [`LateralSystem::new`].
    pub fn system(
        &self,
        directions: &[Vector],
        lengths: &[f64],
        sliding: Option<&[usize]>,
    ) -> Result<LateralSystem> {
        if let Some(i) = self.shafts.whole.iter().position(|&kind| kind > 2) {
            let problem = format!("has the kind {}; there are 3", self.shafts.whole[i]);
            return Err(Error::new("shafts", &[i], problem));
        }
        let shafts = self.shafts.each("shafts", |kind, &[a, b, c, d, loss_factor]| match kind {
            0 => LateralShaft::Held,
            1 => LateralShaft::Rigid(RigidShaft { mass: a, centre: b, across: c, along: d }),
            _ => LateralShaft::Bending(BendingShaft {
                stiffness: a,
                mass: b,
                shear_stiffness: c,
                rotary_inertia: d,
                loss_factor,
            }),
        })?;
        let mass = |shaft, &[position, mass, across, along]: &[f64; 4]| PointMass {
            shaft,
            position,
            mass,
            across,
            along,
        };
        let unbalance = |shaft, &[position, mass_arm, x, y, z]: &[f64; 5]| Unbalance {
            shaft,
            position,
            mass_arm,
            direction: Vector::new(x, y, z),
        };
        let attached = Attached {
            bearings: self.bearings.each("bearings", ElasticBearing::of)?,
            masses: self.masses.each("masses", mass)?,
            unbalances: self.unbalances.each("unbalance", unbalance)?,
        };
        LateralSystem::new(directions, lengths, &shafts, attached, sliding)
    }
}
