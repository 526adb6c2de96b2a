//! Shafts of round section, by the textbook formulas for slender bars.

use std::f64::consts::PI;

use crate::number::float::Real;

/// The dimensions of a round shaft and its material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Round<T = f64> {
    /// Outer diameter in m.
    pub diameter: T,
    /// Thickness of the wall in m, half the diameter for a solid shaft.
    pub wall: T,
    /// Length in m.
    pub length: T,
    /// `G` in Pa.
    pub shear_modulus: T,
    /// `E` in Pa.
    pub elastic_modulus: T,
    /// Density in kg/m³.
    pub density: T,
}

/// The figures of a round shaft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube<T = f64> {
    /// Torsional stiffness `G I_p/L` in N·m/rad.
    pub stiffness: T,
    /// Moment of inertia about the axis `ρ I_p L` in kg·m².
    pub inertia: T,
    /// Mass in kg.
    pub mass: T,
    /// First critical bending speed in rad/s, pinned at both ends: `(π/L)² √(E I/(ρ A))`.
    pub critical_speed: T,
    /// Largest shear stress under 1 N·m in Pa, `D/(2 I_p)`, at the outer surface.
    pub shear_per_torque: T,
    /// Bending stiffness `E I` in N·m².
    pub bending_stiffness: T,
    /// Shear coefficient of Timoshenko's theory (G. R. Cowper 1966).
    pub shear_coefficient: T,
}

impl<T: Real> Tube<T> {
    /// The number of fields.
    pub const COUNT: usize = 7;

    /// The figures of a shaft with these dimensions.
    ///
    /// ```
    /// use cardan::design::tube::{Round, Tube};
    ///
    /// let steel: Round = Round {
    ///     diameter: 0.09,
    ///     wall: 0.003,
    ///     length: 1.5,
    ///     shear_modulus: 7.93e10,
    ///     elastic_modulus: 2.06e11,
    ///     density: 7850.0,
    /// };
    /// assert!((Tube::new(steel).stiffness - 82123.4).abs() < 0.05);
    /// ```
    pub fn new(of: Round<T>) -> Self {
        let Round { diameter, wall, length, shear_modulus, elastic_modulus, density } = of;
        // The differences of powers are written as products, which keep the digits of thin walls.
        let radius = diameter.scaled(0.5);
        let inner = radius - wall;
        let area = T::from_f64(PI) * wall * (radius + inner);
        let polar = (area * (radius.square() + inner.square())).scaled(0.5);
        let bending = (elastic_modulus * polar.scaled(0.5) / (density * area)).sqrt();
        Self {
            stiffness: shear_modulus * polar / length,
            inertia: density * polar * length,
            mass: density * area * length,
            critical_speed: (T::from_f64(PI) / length).square() * bending,
            shear_per_torque: radius / polar,
            bending_stiffness: (elastic_modulus * polar).scaled(0.5),
            shear_coefficient: cowper(elastic_modulus / shear_modulus, inner / radius),
        }
    }

    /// The figures, in the order of the fields.
    pub fn fields(self) -> [T; 7] {
        [
            self.stiffness,
            self.inertia,
            self.mass,
            self.critical_speed,
            self.shear_per_torque,
            self.bending_stiffness,
            self.shear_coefficient,
        ]
    }
}

/// `6 (1 + ν)(1 + m²)²/((7 + 6ν)(1 + m²)² + (20 + 12ν) m²)` of a hollow round section with the ratio
/// `m` of its radii, where `E/G = 2 (1 + ν)`.
fn cowper<T: Real>(ratio: T, radii: T) -> T {
    let square = radii.square();
    let sum = (square + T::from_f64(1.0)).square();
    let own = ratio.scaled(3.0);
    let contraction = |constant: f64| own + T::from_f64(constant);
    own * sum / (contraction(1.0) * sum + contraction(4.0).scaled(2.0) * square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::dual::Dual;

    #[test]
    fn figures_differentiate() {
        let length = Dual { value: 1.5, by: [0.0, 1.0] };
        let diameter = Dual { value: 0.09, by: [1.0, 0.0] };
        let constant = Dual::constant;
        let steel = |diameter, wall, length| Round {
            diameter,
            wall,
            length,
            shear_modulus: constant(7.93e10),
            elastic_modulus: constant(2.06e11),
            density: constant(7850.0),
        };
        let found = Tube::new(steel(diameter, constant(0.003), length));
        let near = |x: f64, y: f64| (x / y - 1.0).abs() < 1e-14;
        let slope = |figure: Dual<2>| figure.by[1] / figure.value;
        for (figure, power) in found.fields().into_iter().zip([-1.0, 1.0, 1.0, -2.0]) {
            assert!(near(slope(figure), power / 1.5));
        }
        assert_eq!(found.shear_per_torque.by[1], 0.0);
        // A solid bar: stiffness grows with the fourth power of the diameter.
        let wall = Dual { value: 0.045, by: [0.5, 0.0] };
        let solid = Tube::new(steel(diameter, wall, length)).stiffness;
        assert!(near(solid.by[0] / solid.value, 4.0 / 0.09));
    }
}
