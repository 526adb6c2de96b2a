//! Axes that turn with a shaft: x along the shaft, y along its pin, z perpendicular to both.
//!
//! The pin of a driven shaft is at the angle `α₂ + 90°` from `e_out`, so with `tan α₂ = tan α/cos β`
//! (D. Thoma 1920) it is along `cos β cos α m − sin α e_out`. The pin of the drive shaft is along
//! `cos α e_in + sin α m`. In both the third axis is the pin a quarter turn later.

use crate::mechanics::chain::Transfer;
use crate::mechanics::frame::Frame;
use crate::mechanics::joint::Joint;
use crate::mechanics::turning::turned;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;

/// A shaft in space, and the map from the drive angle to the angle of its pin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShaftAxes<T> {
    /// The map from `(cos α, sin α)` of the drive to cosine and sine of the pin's angle, multiplied
    /// by a positive length.
    matrix: [T; 4],
    /// The direction of the shaft, the pin at angle 0, and the pin a quarter turn later.
    vectors: [[T; 3]; 3],
}

impl<T: Real> ShaftAxes<T> {
    /// Of the drive shaft, from the frame of the first joint.
    pub(crate) fn of_drive(transfer: &Transfer, Frame { shaft, in_plane, normal }: Frame) -> Self {
        let vectors = [shaft, in_plane, normal].map(|v| v.map(T::from_double_double));
        Self { matrix: transfer.matrix().map(T::from_double_double), vectors }
    }

    /// Of the shaft that a joint drives, from the frame of the joint's driving shaft.
    pub(crate) fn behind(
        transfer: &Transfer,
        joint: &Joint<DoubleDouble>,
        mut frame: Frame,
    ) -> Self {
        let [cc, cs, sc, ss] = transfer.matrix();
        let matrix = [cc * joint.cos, cs * joint.cos, sc, ss].map(T::from_double_double);
        frame.pass_joint(joint);
        let Frame { shaft, in_plane, normal } = frame;
        let vectors = [shaft, normal, in_plane.map(|x| -x)];
        Self { matrix, vectors: vectors.map(|v| v.map(T::from_double_double)) }
    }

    /// The components of a vector, from unnormalised sine and cosine of the drive angle.
    #[inline(always)]
    pub(crate) fn components(&self, [x, y, z]: [T; 3], s: T, c: T) -> [T; 3] {
        let [along, first, later] =
            self.vectors.map(|v| v[2].mul_add(z, v[1].mul_add(y, v[0] * x)));
        let (sine, cosine) = turned(self.matrix, s, c);
        let inverse = sine.mul_add(sine, cosine.square()).sqrt().recip();
        let (sine, cosine) = (sine * inverse, cosine * inverse);
        [along, sine.mul_add(later, cosine * first), cosine.mul_add(later, -(sine * first))]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::geometry::{Geometry, Vector};

    #[test]
    fn pins_of_a_joint_are_the_second_axes() {
        let (bend, angle) = (0.7_f64, 2.3_f64);
        let line = Geometry::from_bends(&[bend], &[], &[]).unwrap();
        let (u, v, m) = (line.directions[0], line.directions[1], line.normals[0]);
        let driving = m.cross(&u) * angle.cos() + m * angle.sin();
        let driven = v.cross(&driving).normalize();
        let frame = || Frame::stored(u, m);
        let transfer = Transfer::default();
        let drive = ShaftAxes::<f64>::of_drive(&transfer, frame());
        let behind = ShaftAxes::<f64>::behind(&transfer, &Joint::of_chain(bend), frame());
        for (axes, shaft, pin) in [(drive, u, driving), (behind, v, driven)] {
            let vectors: [Vector; 3] = [shaft, pin, shaft.cross(&pin)];
            for (i, vector) in vectors.into_iter().enumerate() {
                let parts = [vector.x, vector.y, vector.z];
                let found = axes.components(parts, 3.0 * angle.sin(), 3.0 * angle.cos());
                for (j, component) in found.into_iter().enumerate() {
                    let expected = f64::from(u8::from(i == j));
                    assert!((component - expected).abs() < 1e-15, "{i} {j}: {component}");
                }
            }
        }
    }
}
