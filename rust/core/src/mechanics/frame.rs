//! The frames of a driveline's joints, with error terms.
//!
//! The unit vectors that a driveline stores are rounded, and each bears the roundings of all before
//! it. Vectors with error terms need more. They begin with the direction of the first shaft and
//! the first normal, which place the driveline in space, and follow from bends and twists.

use crate::mechanics::geometry::Vector;
use crate::mechanics::joint::Joint;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::{reduction, series};

type Wide = [DoubleDouble; 3];

/// A shaft and the bend plane of a joint at one of its ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    /// `u`, the direction of the shaft.
    pub(crate) shaft: Wide,
    /// `m × u`, in the bend plane.
    pub(crate) in_plane: Wide,
    /// `m`, the normal of the bend plane.
    pub(crate) normal: Wide,
}

impl Frame {
    /// From vectors as they are stored.
    #[inline(always)]
    pub(crate) fn stored(shaft: Vector, normal: Vector) -> Self {
        let in_plane = cross(normal, shaft);
        let exact = |v: Vector| [v.x, v.y, v.z].map(DoubleDouble::exact);
        Self { shaft: exact(shaft), in_plane, normal: exact(normal) }
    }

    /// Unit vectors at right angles: the shaft keeps its direction, the normal its plane with it.
    #[inline(always)]
    pub(crate) fn orthonormal(self) -> Self {
        let (shaft, in_plane) = (unit(self.shaft), unit(self.in_plane));
        let part = |i: usize, j: usize| sum(shaft[i] * in_plane[j], -(shaft[j] * in_plane[i]));
        Self { shaft, in_plane, normal: [part(1, 2), part(2, 0), part(0, 1)] }
    }

    /// Turns to the next joint of the same shaft.
    #[inline(always)]
    pub(crate) fn pass_shaft(&mut self, twist: f64) {
        let (sine, cosine) = series::sin_cos(reduction::reduce_any(twist));
        (self.in_plane, self.normal) = rotated(self.in_plane, self.normal, sine, cosine);
    }

    /// Goes on to the joint's driven shaft.
    #[inline(always)]
    pub(crate) fn pass_joint(&mut self, joint: &Joint<DoubleDouble>) {
        (self.shaft, self.in_plane) = rotated(self.shaft, self.in_plane, joint.sin, joint.cos);
    }
}

/// Rotates two perpendicular vectors in their plane, from the first towards the second.
#[inline(always)]
fn rotated(a: Wide, b: Wide, sine: DoubleDouble, cosine: DoubleDouble) -> (Wide, Wide) {
    let part = |i: usize| (sum(a[i] * cosine, b[i] * sine), sum(b[i] * cosine, -(a[i] * sine)));
    let [x, y, z] = [part(0), part(1), part(2)];
    ([x.0, y.0, z.0], [x.1, y.1, z.1])
}

/// A sum in words that do not overlap, whose products are as accurate as it is.
#[inline(always)]
fn sum(a: DoubleDouble, b: DoubleDouble) -> DoubleDouble {
    let DoubleDouble { high, low } = a + b;
    DoubleDouble::two_sum(high, low)
}

#[inline(always)]
fn unit(v: Wide) -> Wide {
    let square = v[0].square() + v[1].square() + v[2].square();
    let inverse = square.sqrt().recip();
    v.map(|x| x * inverse)
}

/// The cross product of two vectors of doubles.
#[inline(always)]
fn cross(a: Vector, b: Vector) -> Wide {
    let part = |i: usize, j: usize| {
        DoubleDouble::two_product(a[i], b[j]) - DoubleDouble::two_product(a[j], b[i])
    };
    [part(1, 2), part(2, 0), part(0, 1)]
}
