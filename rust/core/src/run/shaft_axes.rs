//! Vectors of a chunk turned into the axes of their shafts.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use crate::mechanics::shaft_axes::ShaftAxes;
use crate::number::Number;
use crate::number::float::Float;
use crate::plan::steps::TurnedVector;
use crate::run::constants::{GeometryIndex, with_constants};
use crate::sincos::array::{SinCos, SinCosBlocks};

/// Replaces the components in space of each vector by those along the axes of its shaft.
#[inline(always)]
pub(crate) fn turn_vectors<T: Number, W: Float>(
    vectors: &[TurnedVector],
    axes: &[Vec<ShaftAxes<T>>],
    geometry: GeometryIndex,
    pins: SinCos<'_, T>,
    planes: &mut [&mut [W]],
    size: usize,
) {
    for vector in vectors {
        let axes = &axes[vector.shaft][..geometry.count(size)];
        let Ok([x, y, z]) = planes.get_disjoint_mut([0, 1, 2].map(|axis| vector.plane + axis))
        else {
            continue;
        };
        let components: [&mut [W]; 3] = [x, y, z].map(|plane| &mut plane[..size]);
        with_constants!(geometry, |i: usize| axes[i], at => turn(at, pins, components));
        if let Some(axis) = vector.vanishing {
            // NaN remains NaN.
            for word in &mut planes[vector.plane + axis][..size] {
                *word = W::near(0.0 * (*word).into());
            }
        }
    }
}

#[inline(always)]
fn turn<T: Number, W: Float>(
    at: impl Fn(usize) -> ShaftAxes<T>,
    pins: SinCos<'_, T>,
    [x, y, z]: [&mut [W]; 3],
) {
    for (start, block) in pins.parts() {
        let length = block.len();
        let part = start..start + length;
        let (x, y, z) = (&mut x[part.clone()], &mut y[part.clone()], &mut z[part]);
        for i in 0..length {
            let (s, c) = block.get(i);
            let in_space = [x[i], y[i], z[i]].map(|word| T::from_f64(word.into()));
            let turned = at(start + i).components(in_space, s, c);
            [x[i], y[i], z[i]] = turned.map(|number| W::near(number.value().into()));
        }
    }
}
