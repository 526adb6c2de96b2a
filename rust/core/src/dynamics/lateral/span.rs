//! A piece of a shaft that bends, without a mesh: what it makes of displacement, slope, shear force
//! and bending moment at one end.
//!
//! In either direction of rotation the equations are, for `e^{iωt}`,
//!
//! `w′ = ψ + a V`, `ψ′ = b M`, `V′ = −m w`, `M′ = −V − r ψ`
//!
//! with `a = 1/κGA` (0 by Euler and Bernoulli), `b = 1/EI`, `m = ρA ω²` and, for a drive that turns
//! at `Ω`, `r = ρI ω² ∓ 2ρI ω Ω` of a vibration that turns with the shaft or against it. `V` and `M`
//! act on the upstream part. The matrix `X` of these equations times the length satisfies
//! `X⁴ + p X² + q = 0`, so its exponential is `c₀ + c₁ X + c₂ X² + c₃ X³` with power series in `p`
//! and `q`, and no difference of large numbers appears for slow vibrations.

use nalgebra::{Complex, Matrix2, Vector2};

type C = Complex<f64>;

/// The properties of a section at one frequency, for one direction of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section {
    /// `1/κGA` in 1/N.
    pub(super) shear: C,
    /// `1/EI` in 1/(N m²).
    pub(super) bending: C,
    /// `ρA ω²` in N/m².
    pub(super) mass: f64,
    /// `r` in N.
    pub(super) rotary: f64,
}

/// The end of a piece by its start: `(w, ψ)` and `(V, M)`, with what forces within it add.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transfer {
    blocks: [[Matrix2<C>; 2]; 2],
    added: [Vector2<C>; 2],
}

/// The forces that nodes must exert on the ends of a piece: `stiffness` times the displacements and
/// slopes of both ends, less `load`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stiffness {
    pub(super) blocks: [[Matrix2<C>; 2]; 2],
    pub(super) load: [Vector2<C>; 2],
}

impl Stiffness {
    pub(super) const NONE: Self = {
        let zero = Matrix2::new(C::ZERO, C::ZERO, C::ZERO, C::ZERO);
        let none = Vector2::new(C::ZERO, C::ZERO);
        Self { blocks: [[zero; 2]; 2], load: [none; 2] }
    };
}

impl Section {
    /// The largest wavenumber in 1/m, without damping.
    pub(super) fn wavenumber(&self) -> f64 {
        let [p, q] = self.polynomial().map(|x| x.re.abs());
        (0.5 * p + (0.25 * p * p + q).sqrt()).sqrt()
    }

    /// `p` and `q` of a piece of unit length.
    fn polynomial(&self) -> [C; 2] {
        let Self { shear, bending, mass, rotary } = *self;
        let p = bending * rotary + shear * mass;
        [p, bending * mass * (shear * rotary - 1.0)]
    }

    /// A piece of this length in m.
    pub(super) fn transfer(&self, length: f64) -> Transfer {
        let Self { shear: a, bending: b, mass: m, rotary: r } = *self;
        let [p, q] = self.polynomial();
        let [c0, c1, c2, c3] = coefficients(p * length.powi(2), q * length.powi(4));
        let (c1, c2, c3) = (c1 * length, c2 * length.powi(2), c3 * length.powi(3));
        // Products of these constants in the entries of the square and the cube of the matrix.
        let (am, br) = (a * m, b * r);
        let (square, cube) = (am * m, br * r);
        let moved = Matrix2::new(c0 - am * c2, c1 - p * c3, b * c3 * m, c0 - br * c2);
        let by_force =
            Matrix2::new(a * c1 - (a * am + b) * c3, b * c2, -b * c2, b * c1 - b * br * c3);
        let force = Matrix2::new(square * c3 - c1 * m, -c2 * m, c2 * m, (cube + m) * c3 - c1 * r);
        let passed = Matrix2::new(c0 - am * c2, -b * c3 * m, p * c3 - c1, c0 - br * c2);
        Transfer { blocks: [[moved, by_force], [force, passed]], added: [Vector2::zeros(); 2] }
    }
}

/// `c₀` to `c₃` of the exponential of a matrix with `X⁴ = −p X² − q`.
fn coefficients(p: C, q: C) -> [C; 4] {
    let scale = p.norm_sqr().max(q.norm_sqr()).max(1.0);
    // X²ⁿ = square X² + one.
    let (mut square, mut one) = (C::ZERO, C::ONE);
    let mut sums = [C::ONE, C::ONE, C::ZERO, C::ZERO];
    let mut factorial = 1.0;
    for n in 1..100 {
        (square, one) = (one - p * square, -q * square);
        let even = f64::from(2 * n);
        factorial *= even - 1.0;
        factorial *= even;
        let (inverse, next) = (1.0 / factorial, 1.0 / (factorial * (even + 1.0)));
        sums[0] += one * inverse;
        sums[1] += one * next;
        sums[2] += square * inverse;
        sums[3] += square * next;
        // The next two terms are smaller than the last bits of the sums, which are near 1.
        let size = square.norm_sqr().max(one.norm_sqr()) * scale;
        if size * inverse * inverse < 1e-36 {
            break;
        }
    }
    sums
}

impl Transfer {
    /// A piece without length.
    pub(super) fn nothing() -> Self {
        let (one, zero) = (Matrix2::identity(), Matrix2::zeros());
        Self { blocks: [[one, zero], [zero, one]], added: [Vector2::zeros(); 2] }
    }

    /// This piece and one behind it.
    pub(super) fn and(&self, next: &Self) -> Self {
        let [[a, b], [c, d]] = next.blocks;
        let product = |[x, y]: [Matrix2<C>; 2]| [a * x + b * y, c * x + d * y];
        let column = |j: usize| product([self.blocks[0][j], self.blocks[1][j]]);
        let ([first, third], [second, fourth]) = (column(0), column(1));
        let [w, v] = self.added;
        Self {
            blocks: [[first, second], [third, fourth]],
            added: [a * w + b * v + next.added[0], c * w + d * v + next.added[1]],
        }
    }

    /// A point of which displacement and slope take these forces.
    pub(super) fn point(per_displacement: f64, per_slope: f64, force: C) -> Self {
        let mut own = Self::nothing();
        own.blocks[1][0] =
            -Matrix2::new(C::from(per_displacement), C::ZERO, C::ZERO, C::from(per_slope));
        own.added[1][0] = -force;
        own
    }

    /// Displacement and slope at the end, from those at the start and the forces there.
    pub(super) fn at_end(&self, start: Vector2<C>, forces: Vector2<C>) -> Vector2<C> {
        self.blocks[0][0] * start + self.blocks[0][1] * forces + self.added[0]
    }

    /// The forces by the displacements and slopes of both ends.
    pub(super) fn stiffness(&self) -> Stiffness {
        let [[a, b], [_, d]] = self.blocks;
        let inverse = Matrix2::new(b[(1, 1)], -b[(0, 1)], -b[(1, 0)], b[(0, 0)])
            * (b[(0, 0)] * b[(1, 1)] - b[(0, 1)] * b[(1, 0)]).inv();
        let [w, v] = self.added;
        Stiffness {
            blocks: [[inverse * a, -inverse], [-inverse.transpose(), d * inverse]],
            load: [-inverse * w, d * inverse * w - v],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECTION: Section = Section {
        shear: Complex::new(3e-8, -1e-9),
        bending: Complex::new(6e-6, -2e-7),
        mass: 4e6,
        rotary: 900.0,
    };

    /// Steps of Runge and Kutta through the equations.
    fn integrated(section: Section, length: f64, mut state: [C; 4]) -> [C; 4] {
        let rates = |[w, slope, force, moment]: [C; 4]| {
            [
                slope + section.shear * force,
                section.bending * moment,
                -w * section.mass,
                -force - slope * section.rotary,
            ]
        };
        let steps = 2000;
        let h = length / f64::from(steps);
        let moved =
            |state: [C; 4], by: f64, rate: [C; 4]| [0, 1, 2, 3].map(|i| state[i] + rate[i] * by);
        for _ in 0..steps {
            let first = rates(state);
            let second = rates(moved(state, h / 2.0, first));
            let third = rates(moved(state, h / 2.0, second));
            let fourth = rates(moved(state, h, third));
            let sum = [0, 1, 2, 3].map(|i| first[i] + (second[i] + third[i]) * 2.0 + fourth[i]);
            state = moved(state, h / 6.0, sum);
        }
        state
    }

    #[test]
    fn the_exponential_is_the_solution_of_the_equations() {
        let transfer = SECTION.transfer(0.7);
        let scale = [1.0, 1.0, 1e5, 1e5];
        for start in 0..4 {
            let mut state = [C::ZERO; 4];
            state[start] = C::from(scale[start]);
            let end = integrated(SECTION, 0.7, state);
            let [moved, forces] = [0, 2].map(|i| Vector2::new(state[i], state[i + 1]));
            let found = [0, 1]
                .map(|row| transfer.blocks[row][0] * moved + transfer.blocks[row][1] * forces);
            for i in 0..4 {
                let error = (found[i / 2][i % 2] - end[i]).norm() / scale[i];
                assert!(error < 1e-10, "{start} {i}: {error}");
            }
        }
    }

    #[test]
    fn two_halves_are_the_whole() {
        let point = Transfer::point(7e4, 20.0, Complex::new(5.0, 1.0));
        let half = SECTION.transfer(0.35);
        let whole = half.and(&point).and(&half).stiffness();
        // The middle node, eliminated.
        let part = half.stiffness();
        let middle = part.blocks[1][1] + part.blocks[0][0] + point.blocks[1][0];
        let inverse = middle.try_inverse().unwrap();
        let own = part.blocks[0][0] - part.blocks[0][1] * inverse * part.blocks[1][0];
        let load = -part.blocks[0][1] * inverse * Vector2::new(Complex::new(5.0, 1.0), C::ZERO);
        assert!((own - whole.blocks[0][0]).norm() < 1e-10 * own.norm());
        assert!((load - whole.load[0]).norm() < 1e-12 * load.norm());
    }
}
