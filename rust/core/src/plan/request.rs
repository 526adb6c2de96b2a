//! Requests for plans.

use crate::error::{Error, Result};
use crate::plan::output::Output;

/// The end of the driveline at which the load's torque is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The torque enters shaft 0.
    Drive,
    /// The torque leaves the last shaft.
    Output,
}

impl End {
    /// The end with this name, `"drive"` or `"output"`.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        match name {
            "drive" => Ok(Self::Drive),
            "output" => Ok(Self::Output),
            _ => Err(Error::new("load", &[], format!("is {name:?}; it is of drive or output"))),
        }
    }

    /// The name of its torque in messages.
    pub fn torque_name(self) -> &'static str {
        match self {
            Self::Drive => "drive_torque",
            Self::Output => "output_torque",
        }
    }
}

/// The axes along which vectors have their components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// The axes at rest in which the driveline was given.
    Space,
    /// Axes that turn with the shaft on which a vector acts: x along the shaft, y along its
    /// input-side pin (of shaft 0, its output-side pin), z across both.
    Shaft,
}

impl Axes {
    /// The axes with this name, `"space"` or `"shaft"`.
    ///
    /// # Errors
    /// An unknown name.
    pub fn named(name: &str) -> Result<Self> {
        match name {
            "space" => Ok(Self::Space),
            "shaft" => Ok(Self::Shaft),
            _ => Err(Error::new("axes", &[], format!("is {name:?}; they are of space or shaft"))),
        }
    }
}

/// Outputs to compute for a driveline.
#[derive(Clone, Copy, Debug)]
pub struct Request<'a> {
    /// The largest bend of each joint in rad, from [`crate::Drivelines::largest_bends`], or an
    /// upper bound.
    pub largest_bends: &'a [f64],
    /// The outputs, each at most once.
    pub outputs: &'a [Output],
    /// The shafts, `0..=n`, each at most once.
    pub shafts: &'a [usize],
    /// The joints, `0..n`, each at most once.
    pub joints: &'a [usize],
    /// The end at which the load's torque is given, if there is a load.
    pub load: Option<End>,
    /// The shafts with an inertia.
    pub inertias: &'a [usize],
    /// The shaft of each bearing, if the lengths of the shafts are known.
    pub bearings: Option<&'a [usize]>,
    /// Whether the drivelines have deviations, so that they are evaluated joint by joint.
    pub as_built: bool,
    /// The axes of vectors.
    pub axes: Axes,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_have_a_name() {
        assert_eq!(End::named("drive").map(End::torque_name), Ok("drive_torque"));
        assert_eq!(End::named("output").map(End::torque_name), Ok("output_torque"));
        let error = End::named("middle").unwrap_err();
        assert_eq!(error.to_string(), "load is \"middle\"; it is of drive or output");
    }
}
