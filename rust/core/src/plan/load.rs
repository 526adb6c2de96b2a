//! The steps that carry a load along the driveline.

use crate::plan::request::End;

/// How the power is computed along the driveline, from the end where the torque is given.
#[derive(Clone, Debug)]
pub(crate) struct LoadStep {
    pub(crate) end: End,
    /// Whether any shaft has an inertia, needed or not.
    pub(crate) has_inertias: bool,
    /// In the order of computation.
    pub(crate) stations: Vec<Station>,
}

impl LoadStep {
    /// Whether any shaft on the path of the load absorbs power.
    pub(crate) fn absorbs(&self) -> bool {
        self.stations.iter().any(|station| station.absorbs)
    }
}

/// One shaft on the path of the load.
#[derive(Clone, Debug)]
pub(crate) struct Station {
    pub(crate) shaft: usize,
    pub(crate) absorbs: bool,
    /// Plane of the torque entering this shaft.
    pub(crate) torque: Option<usize>,
    /// Whether the torsion entering the joint before this shaft is needed.
    pub(crate) torsion: bool,
    /// Whether forces are computed from the power entering that joint.
    pub(crate) force_power: bool,
}
