//! The transverse forces that carry a shaft.
//!
//! The joints leave the shaft with direction `u` the moment `−S` across it, so its supports must
//! give it the moment `S`. With supports at the distances `x₁` and `x₂` from its upstream end, and
//! with the forces `R_k` that its neighbours exert on it at `x_k`, moments about either support give
//!
//! `F₂ = [S × u − Σ (x_k − x₁) R_k⊥]/(x₂ − x₁)`, `F₁ = [u × S − Σ (x₂ − x_k) R_k⊥]/(x₂ − x₁)`,
//!
//! where `⊥` is the part across `u`; the shaft takes the rest as thrust. A floating shaft of length
//! `L` between two joints has `F₂ = −F₁ = (S × u)/L`.
//!
//! `S × u` is a linear form in the torsion parts of the joints at both ends of the shaft. So is each
//! force, and its coefficients are constants of the driveline.
//!
//! The torsion of a joint is the power divided by the speed of its driving shaft. Let the map of the
//! chain before the joint take `(cos φ, sin φ)` of the drive to `ℓ (cos α, sin α)`. The shaft then has
//! the speed ratio `d/ℓ²` with the map's determinant `d`, and with the power `P` divided by the
//! drive's speed
//!
//! `D sin² α = P (ℓ sin α)²/d`,
//!
//! where `ℓ sin α` is a linear form in `cos φ` and `sin φ`. The torsion parts of all joints with the
//! same power are therefore linear forms in `P sin² φ`, `P cos² φ` and `P sin φ cos φ`. Where a chain
//! is steep their terms cancel.

use crate::mechanics::moment::Pose;
use crate::mechanics::turning::TurnMatrix;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;

/// The number of torsion parts of a joint: the fields of [`crate::mechanics::moment::TorsionParts`].
pub(crate) const PARTS: usize = 3;

/// The index of `D sin² α` among them, of `D cos² α`, and of `D sin α cos α`.
pub(crate) const SINE2: usize = 0;
pub(crate) const COSINE2: usize = 1;
pub(crate) const PRODUCT: usize = 2;

/// A force as a linear form: a vector for each torsion part of a series of joints.
pub(crate) type LinearForce<T> = Vec<[T; 3]>;

/// A force that a neighbour exerts on a shaft.
pub(crate) struct Neighbour<'a, T> {
    /// Distance from the shaft's upstream end.
    pub(crate) position: f64,
    pub(crate) force: &'a [[T; 3]],
    /// Whether the shaft feels the opposite of it.
    pub(crate) reversed: bool,
    /// Index of its first coefficient among those of the shaft's forces.
    pub(crate) first: usize,
}

/// The forces of a shaft's two supports at these positions. Their coefficients are zero where neither
/// `own_terms` nor `neighbours` have any.
#[inline(always)]
pub(crate) fn balance<T: Real>(
    direction: [T; 3],
    [first, second]: [f64; 2],
    own_terms: impl Iterator<Item = (usize, [T; 3])>,
    neighbours: &[Neighbour<'_, T>],
    [at_first, at_second]: &mut [LinearForce<T>; 2],
) {
    let span = DoubleDouble::two_sum(second, -first);
    let part_of_span =
        |from: f64, to: f64| T::from_double_double(DoubleDouble::two_sum(to, -from) / span);
    let inverse = T::from_double_double(DoubleDouble::ONE / span);
    let zero = [T::from_f64(0.0); 3];
    at_first.fill(zero);
    at_second.fill(zero);
    for (index, term) in own_terms {
        at_second[index] = term.map(|x| x * inverse);
        at_first[index] = term.map(|x| -(x * inverse));
    }
    for neighbour in neighbours {
        let sign = T::from_f64(if neighbour.reversed { 1.0 } else { -1.0 });
        let shares = [
            sign * part_of_span(neighbour.position, second),
            sign * part_of_span(first, neighbour.position),
        ];
        for (i, &force) in neighbour.force.iter().enumerate() {
            let across = across(force, direction);
            let index = neighbour.first + i;
            for (total, share) in
                [&mut at_first[index], &mut at_second[index]].into_iter().zip(shares)
            {
                for (x, part) in total.iter_mut().zip(across) {
                    *x = part.mul_add(share, *x);
                }
            }
        }
    }
}

/// The part of a vector across a unit vector.
#[inline(always)]
pub(crate) fn across<T: Real>(v: [T; 3], u: [T; 3]) -> [T; 3] {
    let along = v[0].mul_add(u[0], v[1].mul_add(u[1], v[2] * u[2]));
    [0, 1, 2].map(|i| (-along).mul_add(u[i], v[i]))
}

impl<T: Real> Pose<T> {
    /// The joint's contribution to `S × u` of its driving shaft: the coefficients of `D sin² α` and
    /// of `D sin α cos α`.
    #[inline(always)]
    pub(crate) fn turned_support_driving(&self) -> [(usize, [T; 3]); 2] {
        [(SINE2, self.plane_normal), (PRODUCT, self.in_plane.map(|x| -x))]
    }

    /// Its contribution to `S × u` of its driven shaft: the coefficients of `D cos² α` and of
    /// `D sin α cos α`.
    #[inline(always)]
    pub(crate) fn turned_support_driven(&self) -> [(usize, [T; 3]); 2] {
        let inverse = self.cosine.recip();
        [
            (COSINE2, self.plane_normal.map(|x| x * self.cosine)),
            (PRODUCT, self.out_plane.map(|x| x * inverse)),
        ]
    }

    /// The torsion parts as linear forms in those of the drive shaft under the same power, given the
    /// inverse determinant of the map before the joint.
    #[inline(always)]
    pub(crate) fn parts_of_drive(&self, inverse: T) -> [[T; 3]; PARTS] {
        let TurnMatrix([cc, cs, sc, ss]) = self.matrix;
        let product = |[xc, xs]: [T; 2], [yc, ys]: [T; 2]| {
            [xs * ys, xc * yc, xs.mul_add(yc, xc * ys)].map(|x| x * inverse)
        };
        let (sine, cosine) = ([sc, ss], [cc, cs]);
        [product(sine, sine), product(cosine, cosine), product(sine, cosine)]
    }

    /// `u_out`.
    #[inline(always)]
    pub(crate) fn driven_axis(&self) -> [T; 3] {
        [0, 1, 2].map(|i| (self.shaft_axis[i] + self.in_plane[i]) * self.cosine)
    }

    /// `u_out = e_out × m`, of a joint as built.
    #[inline(always)]
    pub(crate) fn driven_axis_as_built(&self) -> [T; 3] {
        let (a, b) = (self.plane_normal, self.out_plane);
        [(1, 2), (2, 0), (0, 1)].map(|(j, k)| a[j].mul_add(b[k], -(a[k] * b[j])))
    }
}
