//! Forces of joints as built at one sample, from the balance of each shaft in
//! [`crate::mechanics::forces`]. Dual numbers carry their derivatives, those by the places of joints
//! and bearings as well.

use crate::mechanics::bearings::Carrier;
use crate::mechanics::forces::across;
use crate::number::dual::Dual;
use crate::plan::forces::{Balance, ForceOf, ForceStep, JointLoad};
use crate::run::gradient::{Carried, Direction};

/// The places of joints and bearings along their shafts.
pub(super) struct PlacesAsBuilt {
    pub(super) lengths: Vec<Carried>,
    pub(super) positions: Vec<Carried>,
}

impl PlacesAsBuilt {
    fn of(&self, shaft: usize, carrier: Carrier) -> Carried {
        match carrier {
            Carrier::UpstreamJoint => Dual::constant(0.0),
            Carrier::DownstreamJoint => self.lengths[shaft],
            Carrier::Bearing(bearing) => self.positions[bearing],
        }
    }
}

/// The forces of both supports of each balanced shaft, from the direction of each shaft and its
/// support moment.
pub(super) fn solve_as_built(
    step: &ForceStep,
    places: &PlacesAsBuilt,
    axis: impl Fn(usize) -> Direction,
    support: impl Fn(usize) -> Direction,
) -> Vec<[Direction; 2]> {
    let mut forces = Vec::with_capacity(step.balances.len());
    for Balance { shaft, carriers, loads, .. } in &step.balances {
        let direction = axis(*shaft);
        let [first, second] = carriers.map(|carrier| places.of(*shaft, carrier));
        let turned = cross(support(*shaft), direction);
        let (mut at_first, mut at_second) = (turned.map(|x| -x), turned);
        for JointLoad { at, force } in loads {
            let (place, force) = (places.of(*shaft, *at), across(of(&forces, *force), direction));
            for i in 0..3 {
                at_first[i] = at_first[i] - force[i] * (second - place);
                at_second[i] = at_second[i] - force[i] * (place - first);
            }
        }
        forces.push([at_first, at_second].map(|force| force.map(|x| x / (second - first))));
    }
    forces
}

/// A force among those of the balances.
pub(super) fn of(forces: &[[Direction; 2]], force: ForceOf) -> Direction {
    let found = forces[force.balance][force.carrier];
    if force.reversed { found.map(|x| -x) } else { found }
}

fn cross(a: Direction, b: Direction) -> Direction {
    [(1, 2), (2, 0), (0, 1)].map(|(j, k)| a[j] * b[k] - a[k] * b[j])
}
