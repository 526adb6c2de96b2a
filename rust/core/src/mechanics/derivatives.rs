//! Derivatives of a chain: from those by its map to those by bends, twists, phases and points.
//!
//! All motion of shaft `i` depends on `q_i = B_i/A_i` of the map `w → A_i w + B_i w̄` of
//! [`crate::mechanics::chain`]. Given how a value changes with these numbers, one sweep from the
//! last joint to the first finds how it changes with all parameters (derived here).
//!
//! The adjoint of a complex `x` is `x̃` with `dV = Re(x̃* dx)`. Behind a joint, with `(a, b)` before
//! it and `Z = Ã' b + B̃' a`,
//!
//! `ã = Ã' − k B̃'*`, `b̃ = B̃' − k Ã'*`, `k̃ = −Re Z`, `dk = tan(β/2) sec²(β/2) dβ`,
//!
//! and the turn `e^{ip}` of a shaft, `p = δ − τ + 90°`, has `p̃ = −Im(ã* a + b̃* b)`.
//!
//! **By directions.** If a joint's shafts `u` and `v` turn by `du` and `dv`, its bend changes by
//! `dv·e_out − du·e_in`. Its plane turns about `u` by `dμ_u = (dv·m − du·m cos β)/sin β` and about
//! `v` by `dμ_v = dμ_u − tan(β/2) (du·m + dv·m)`. The twists before and behind the joint change by
//! `dμ_u` and `−dμ_v`, which are infinite where the joint is straight. Their effects cancel there:
//! together with that of `k` they are
//!
//! `dV = −h [Re Z (dv·e_out − du·e_in) + Im Z (dv·m cos β − du·m)] − p̃ tan(β/2) (du·m + dv·m)`
//!
//! with `h = tan(β/2) sec²(β/2)`, which is smooth: it differentiates `k e^{2iΦ}` instead of `k` and
//! `Φ`. The plane of joint 0 is also that from which the drive angle counts. That adds `p̃ dμ_u`.

use nalgebra::Complex;

use crate::mechanics::chain::{Transfer, shaft_turn};
use crate::mechanics::geometry::Vector;
use crate::mechanics::joint::Joint;
use crate::number::elementary;

/// The map to a shaft, or its adjoint: the numbers `A` and `B`.
pub(crate) type Map = [Complex<f64>; 2];

/// A chain of joints with the map to each of its shafts.
pub(crate) struct ChainMaps {
    /// One per shaft.
    maps: Vec<Map>,
    /// `e^{ip}` of each intermediate shaft.
    turns: Vec<Complex<f64>>,
    joints: Vec<Bent>,
}

/// Functions of one bend.
#[derive(Clone, Copy)]
struct Bent {
    cosine: f64,
    sine: f64,
    /// `tan²(β/2)`.
    k: f64,
    /// `tan(β/2)`.
    half_tangent: f64,
    /// `tan(β/2) sec²(β/2)`, the derivative of `k`.
    slope: f64,
}

impl Bent {
    fn new(bend: f64, joint: &Joint) -> Self {
        let half_tangent = elementary::tan(0.5 * bend);
        let slope = half_tangent.mul_add(half_tangent, 1.0) * half_tangent;
        Self { cosine: joint.cos, sine: joint.sin, k: joint.k, half_tangent, slope }
    }
}

/// The derivatives of a value by the parameters of a chain.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ChainGradient {
    /// By the bend of each joint.
    pub(crate) bends: Vec<f64>,
    /// By the phase of each intermediate shaft. The derivatives by twists are the opposite.
    pub(crate) phases: Vec<f64>,
}

/// The directions of shafts and the normals of bend planes, from which points are differentiated.
#[derive(Clone, Copy)]
pub(crate) struct Layout<'a> {
    /// Three numbers per shaft.
    pub(crate) directions: &'a [f64],
    /// Three numbers per joint.
    pub(crate) normals: &'a [f64],
    /// One per shaft.
    pub(crate) lengths: &'a [f64],
}

impl ChainMaps {
    /// The first joints of a chain, as many as there are bends.
    pub(crate) fn new(bends: &[f64], twists: &[f64], phases: &[f64]) -> Self {
        Self::folded(bends, twists, phases, |_, _| ())
    }

    /// The same; `each` is called with the map to every shaft behind a joint.
    pub(crate) fn folded(
        bends: &[f64],
        twists: &[f64],
        phases: &[f64],
        mut each: impl FnMut(usize, &Transfer),
    ) -> Self {
        let mut transfer = Transfer::default();
        let mut chain = Self {
            maps: Vec::with_capacity(bends.len() + 1),
            turns: Vec::with_capacity(bends.len()),
            joints: Vec::with_capacity(bends.len()),
        };
        chain.maps.push(map(&transfer));
        for (j, &bend) in bends.iter().enumerate() {
            if j > 0 {
                let turn = shaft_turn(phases[j - 1], twists[j - 1]);
                transfer.pass_shaft(turn);
                chain.turns.push(Complex::new(turn.re.value(), turn.im.value()));
            }
            let joint = Joint::with_error_terms(bend);
            transfer.pass_joint(&joint);
            each(j + 1, &transfer);
            chain.maps.push(map(&transfer));
            chain.joints.push(Bent::new(bend, &Joint::nearest(&joint)));
        }
        chain
    }

    /// `q` of a shaft.
    pub(crate) fn q(&self, shaft: usize) -> Complex<f64> {
        let [a, b] = self.maps[shaft];
        b / a
    }

    /// The map to a shaft.
    pub(crate) fn map(&self, shaft: usize) -> Map {
        self.maps[shaft]
    }

    /// The map to the driving yoke of a joint, whose shaft has turned by its phase.
    pub(crate) fn map_to_joint(&self, joint: usize) -> Map {
        let turn = if joint > 0 { self.turns[joint - 1] } else { Complex::new(1.0, 0.0) };
        self.maps[joint].map(|x| x * turn)
    }

    /// The adjoint of a shaft's map for a value that changes by `Re(weight dq)`.
    pub(crate) fn adjoint_of_q(&self, shaft: usize, weight: Complex<f64>) -> Map {
        let share = (weight / self.maps[shaft][0]).conj();
        [-(share * self.q(shaft).conj()), share]
    }

    /// The derivatives by all parameters, from the adjoints of the maps to all shafts.
    pub(crate) fn gradient(&self, adjoints: &[Map]) -> ChainGradient {
        let mut gradient = ChainGradient {
            bends: vec![0.0; self.joints.len()],
            phases: vec![0.0; self.turns.len()],
        };
        self.pull_back(adjoints, |j, pulled| {
            gradient.bends[j] = -self.joints[j].slope * pulled.coupling.re;
            if j > 0 {
                gradient.phases[j - 1] = pulled.turn;
            }
        });
        gradient
    }

    /// The derivatives by the directions of all shafts, across each of them.
    pub(crate) fn by_directions(&self, adjoints: &[Map], layout: Layout<'_>) -> Vec<Vector> {
        let mut directions = vec![Vector::zeros(); self.maps.len()];
        self.pull_back(adjoints, |j, Pulled { coupling, turn }| {
            let Bent { cosine, sine, half_tangent, slope, .. } = self.joints[j];
            let [u, v] = [j, j + 1].map(|shaft| vector(layout.directions, shaft));
            let normal = vector(layout.normals, j);
            let [inward, outward] = [u, v].map(|shaft| normal.cross(&shaft));
            let Complex { re, im } = coupling * slope;
            let transported = turn * half_tangent;
            // The plane of a straight first joint is arbitrary, and is held.
            let plane = if j == 0 && sine > 0.0 { turn / sine } else { 0.0 };
            directions[j] += inward * re + normal * (im - transported - plane * cosine);
            directions[j + 1] += normal * (plane - im * cosine - transported) - outward * re;
        });
        directions
    }

    /// Calls `each` with every joint, from the last to the first.
    fn pull_back(&self, adjoints: &[Map], mut each: impl FnMut(usize, Pulled)) {
        let mut adjoint = [Complex::default(); 2];
        for j in (0..self.joints.len()).rev() {
            let [of_a, of_b]: Map = [0, 1].map(|i| adjoint[i] + adjoints[j + 1][i]);
            let turn = if j > 0 { self.turns[j - 1] } else { Complex::new(1.0, 0.0) };
            let [a, b] = self.map_to_joint(j);
            let k = self.joints[j].k;
            let coupling = of_a * b + of_b * a;
            let before = [of_a - of_b.conj() * k, of_b - of_a.conj() * k];
            let turned = -(before[0].conj() * a + before[1].conj() * b).im;
            each(j, Pulled { coupling, turn: turned });
            adjoint = before.map(|x| x * turn.conj());
        }
    }
}

/// Result of the sweep at one joint: `Z` and `p̃`.
struct Pulled {
    coupling: Complex<f64>,
    turn: f64,
}

/// The derivatives by points from those by the directions between them, which may be fewer.
pub(crate) fn by_points(directions: &[Vector], layout: Layout<'_>) -> Vec<Vector> {
    let mut points = vec![Vector::zeros(); layout.lengths.len() + 1];
    for (shaft, gradient) in directions.iter().enumerate() {
        let axis = vector(layout.directions, shaft);
        let across = (gradient - axis * axis.dot(gradient)) / layout.lengths[shaft];
        points[shaft] -= across;
        points[shaft + 1] += across;
    }
    points
}

fn map(transfer: &Transfer) -> Map {
    [transfer.a, transfer.b].map(|x| Complex::new(x.re.value(), x.im.value()))
}

/// Vector `i` of a flat array.
pub(crate) fn vector(flat: &[f64], i: usize) -> Vector {
    Vector::from_column_slice(&flat[3 * i..3 * i + 3])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::Geometry;

    const STEP: f64 = 1e-6;

    fn q(line: &Geometry) -> Complex<f64> {
        let chain = ChainMaps::new(&line.bends, &line.twists, &line.phases);
        chain.q(line.bends.len())
    }

    /// The derivatives of `Re(weight q)` of the last shaft.
    fn adjoints(chain: &ChainMaps, joints: usize, weight: Complex<f64>) -> Vec<Map> {
        let mut adjoints = vec![Map::default(); joints + 1];
        adjoints[joints] = chain.adjoint_of_q(joints, weight);
        adjoints
    }

    #[test]
    fn the_gradient_of_a_chain_is_the_slope_of_q() {
        let (bends, twists, phases) = ([0.4, 0.9, 0.2], [0.3, -1.0], [0.5, 2.0]);
        let weight = Complex::new(0.7, -0.4);
        let chain = ChainMaps::new(&bends, &twists, &phases);
        let found = chain.gradient(&adjoints(&chain, 3, weight));
        // Bends, twists and phases in one list.
        let parts = [&bends[..], &twists, &phases].concat();
        let slope = |changed: usize| {
            let at = |step: f64| {
                let mut all = parts.clone();
                all[changed] += step;
                (weight * ChainMaps::new(&all[..3], &all[3..5], &all[5..]).q(3)).re
            };
            (at(STEP) - at(-STEP)) / (2.0 * STEP)
        };
        for j in 0..3 {
            assert!((found.bends[j] - slope(j)).abs() < 1e-9, "bend {j}");
        }
        for i in 0..2 {
            assert!((found.phases[i] - slope(5 + i)).abs() < 1e-9, "phase {i}");
            assert!((found.phases[i] + slope(3 + i)).abs() < 1e-9, "twist {i}");
        }
    }

    #[test]
    fn points_are_differentiated_through_a_straight_joint() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.25, 0.0], [2.0, 0.25, 0.5], [3.0, 0.25, 1.0]];
        let points = points.map(|[x, y, z]| Vector::new(x, y, z));
        let weight = Complex::new(-0.3, 0.8);
        let line = Geometry::from_points(&points, &[0.7]).unwrap();
        assert_eq!(line.bends[1], 0.0);
        let flat = |vectors: &[Vector]| -> Vec<f64> {
            vectors.iter().flat_map(|v| v.iter().copied()).collect()
        };
        let (directions, normals) = (flat(&line.directions), flat(&line.normals));
        let lengths: Vec<f64> = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).collect();
        let layout = Layout { directions: &directions, normals: &normals, lengths: &lengths };
        let chain = ChainMaps::new(&line.bends, &line.twists, &line.phases);
        let adjoints = adjoints(&chain, 2, weight);
        let found = by_points(&chain.by_directions(&adjoints, layout), layout);
        for (i, axis) in (0..4).flat_map(|i| (0..3).map(move |axis| (i, axis))) {
            let at = |step: f64| {
                let mut moved = points;
                moved[i][axis] += step;
                (weight * q(&Geometry::from_points(&moved, &[0.7]).unwrap())).re
            };
            let expected = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            assert!((found[i][axis] - expected).abs() < 1e-9, "point {i}, axis {axis}");
        }
    }
}
