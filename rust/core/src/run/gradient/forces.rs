//! Forces of joints and bearings at one sample, and how they change.
//!
//! With the span `h⁻¹ = x₂ − x₁` of the supports, the forces of [`crate::mechanics::forces`] are
//!
//! `F₂ = h [S × u − Σ (x_k − x₁) R_k⊥]`, `F₁ = h [u × S − Σ (x₂ − x_k) R_k⊥]`.
//!
//! A value that changes by `f₁·dF₁ + f₂·dF₂` changes, with `δ = f₂ − f₁`, by
//!
//! `h (u × δ)·dS + Σ a_k·dR_k⊥ − h δ·(F₁ dx₁ + F₂ dx₂ + Σ R_k⊥ dx_k) + h (δ × S)·du`,
//!
//! `a_k = −h [(x_k − x₁) f₂ + (x₂ − x_k) f₁]`, because `F₁ + F₂ + Σ R_k⊥ = 0` (derived here).

use crate::mechanics::bearings::Carrier;
use crate::mechanics::geometry::Vector;
use crate::plan::forces::{Balance, ForceOf, ForceStep, JointLoad};
use crate::run::gradient::line::{LineConstants, Sums};

/// The forces of both supports of each balanced shaft, or how a value changes with them.
pub(super) type Supports = Vec<[Vector; 2]>;

/// A balance in space: its shaft's direction, the places of its supports, and the forces of its
/// other joints with their places.
struct Placed {
    axis: Vector,
    places: [f64; 2],
    inverse_span: f64,
    loads: Vec<(f64, Vector)>,
}

impl Placed {
    fn new(line: &LineConstants<'_>, balance: &Balance, known: &[[Vector; 2]]) -> Self {
        let shaft = balance.shaft;
        let places = balance.carriers.map(|carrier| line.place(shaft, carrier));
        let load = |load: &JointLoad| (line.place(shaft, load.at), of(known, load.force));
        Self {
            axis: line.axis(shaft),
            places,
            inverse_span: (places[1] - places[0]).recip(),
            loads: balance.loads.iter().map(load).collect(),
        }
    }

    fn across(&self, v: Vector) -> Vector {
        v - self.axis * self.axis.dot(&v)
    }
}

/// A force among those of the balances.
pub(super) fn of(forces: &[[Vector; 2]], force: ForceOf) -> Vector {
    let found = forces[force.balance][force.carrier];
    if force.reversed { -found } else { found }
}

/// Adds a change of one of them.
pub(super) fn pull(forces: &mut [[Vector; 2]], force: ForceOf, weight: Vector) {
    forces[force.balance][force.carrier] += if force.reversed { -weight } else { weight };
}

/// All forces, from the support moments of the shafts.
pub(super) fn solve(
    step: &ForceStep,
    line: &LineConstants<'_>,
    support: impl Fn(usize) -> Vector,
) -> Supports {
    let mut forces = Supports::with_capacity(step.balances.len());
    for balance in &step.balances {
        let placed = Placed::new(line, balance, &forces);
        let [first, second] = placed.places;
        let turned = support(balance.shaft).cross(&placed.axis);
        let (mut at_first, mut at_second) = (-turned, turned);
        for &(place, force) in &placed.loads {
            let across = placed.across(force);
            at_first -= across * (second - place);
            at_second -= across * (place - first);
        }
        forces.push([at_first, at_second].map(|force| force * placed.inverse_span));
    }
    forces
}

/// Passes a change of one balance's forces on: to the forces of its neighbours, to the sums, and to
/// the support moment of its shaft, whose weight is returned.
pub(super) fn pull_balance(
    line: &LineConstants<'_>,
    balance: &Balance,
    forces: &[[Vector; 2]],
    support: Vector,
    pulled: &mut [[Vector; 2]],
    sums: &mut Sums,
    index: usize,
) -> Vector {
    let shaft = balance.shaft;
    let placed = Placed::new(line, balance, forces);
    let (u, inverse, [first, second]) = (placed.axis, placed.inverse_span, placed.places);
    let [of_first, of_second] = std::mem::take(&mut pulled[index]);
    let difference = of_second - of_first;
    let mut by_axis = difference.cross(&support) * inverse;
    let mut by_place = |carrier: Carrier, force: &Vector| {
        sums.pull_place(shaft, carrier, -inverse * difference.dot(force));
    };
    for (&carrier, force) in balance.carriers.iter().zip(&forces[index]) {
        by_place(carrier, force);
    }
    for (load, &(place, force)) in balance.loads.iter().zip(&placed.loads) {
        by_place(load.at, &placed.across(force));
        let weight = (of_second * (place - first) + of_first * (second - place)) * -inverse;
        by_axis -= weight * u.dot(&force) + force * u.dot(&weight);
        pull(pulled, load.force, placed.across(weight));
    }
    sums.frames[shaft] += u.cross(&by_axis);
    u.cross(&difference) * inverse
}
