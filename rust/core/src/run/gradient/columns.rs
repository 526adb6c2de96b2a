//! Columns of a chunk of samples, and the loops over them.
//!
//! A chunk always has the same number of samples, so that no loop needs a second copy for those that
//! are left over. A chunk with fewer repeats its last sample with weights of zero.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is constant")]

use crate::mechanics::geometry::Vector;
use crate::run::gradient::motion::{LANES, total};
use crate::run::level::{Level, compiled_up_to_avx2};

/// Samples per chunk: its columns stay in the caches.
pub(super) const COLUMN: usize = 128;

/// A number per sample.
pub(super) type ChunkColumn = [f64; COLUMN];

/// A vector per sample.
pub(super) type Vectors = [ChunkColumn; 3];

pub(super) const ZEROS: ChunkColumn = [0.0; COLUMN];

/// Columns, or arrays of them.
#[inline(never)]
pub(super) fn repeated<T: Copy>(zeros: &T, count: usize) -> Vec<T> {
    vec![*zeros; count]
}

/// Samples that are computed together. Fewer would be summed one by one in the largest formulas, and
/// the sums of more would leave the registers.
const ROW: usize = 2 * LANES;

/// Replaces the numbers of some columns and returns sums of others, by a formula of sample and old
/// numbers. The order of the sums is always the same.
#[inline(always)]
pub(super) fn each<const N: usize, const M: usize>(
    level: Level,
    columns: [&mut ChunkColumn; N],
    formula: impl Fn(usize, [f64; N]) -> ([f64; N], [f64; M]),
) -> [f64; M] {
    // Their time is that of divisions and loads, which wider registers do not shorten.
    let sums = compiled_up_to_avx2!(level, (compact, _stores) => if compact {
        one_by_one(columns, &formula)
    } else {
        rows(columns, formula)
    });
    sums.each_ref().map(total_of_row)
}

#[inline(always)]
fn rows<const N: usize, const M: usize>(
    mut columns: [&mut ChunkColumn; N],
    formula: impl Fn(usize, [f64; N]) -> ([f64; N], [f64; M]),
) -> [[f64; ROW]; M] {
    let mut sums = [[0.0; ROW]; M];
    for row in 0..COLUMN / ROW {
        let first = row * ROW;
        // Local numbers stay in registers: the compiler knows that nothing else reads them.
        let mut results = [[0.0; ROW]; N];
        for i in 0..ROW {
            let (new, terms) = formula(first + i, columns.each_ref().map(|x| x[first + i]));
            results.iter_mut().zip(new).for_each(|(results, new)| results[i] = new);
            sums.iter_mut().zip(terms).for_each(|(sum, term)| sum[i] += term);
        }
        for (column, results) in columns.iter_mut().zip(&results) {
            column[first..first + ROW].copy_from_slice(results);
        }
    }
    sums
}

/// The same one sample after the other, where a product-sum is a function call. Formulas with as many
/// columns and sums share the code.
#[inline(never)]
fn one_by_one<const N: usize, const M: usize>(
    mut columns: [&mut ChunkColumn; N],
    formula: &dyn Fn(usize, [f64; N]) -> ([f64; N], [f64; M]),
) -> [[f64; ROW]; M] {
    let mut sums = [[0.0; ROW]; M];
    for i in 0..COLUMN {
        let (new, terms) = formula(i, columns.each_ref().map(|column| column[i]));
        columns.iter_mut().zip(new).for_each(|(column, new)| column[i] = new);
        sums.iter_mut().zip(terms).for_each(|(sum, term)| sum[i % ROW] += term);
    }
    sums
}

/// The sum of a row, outside the loops, whose shape it would change.
#[inline(never)]
fn total_of_row(row: &[f64; ROW]) -> f64 {
    total(std::array::from_fn(|i| row[i] + row[i + LANES]))
}

/// `out += scale a`.
#[inline(never)]
pub(super) fn add(level: Level, scale: f64, a: &Vectors, out: &mut Vectors) {
    let [x, y, z] = a;
    each(
        level,
        out.each_mut(),
        #[inline(always)]
        |i, [u, v, w]| {
            let sum = [x[i].mul_add(scale, u), y[i].mul_add(scale, v), z[i].mul_add(scale, w)];
            (sum, [])
        },
    );
}

/// `out += u × a` with a constant vector.
#[inline(never)]
pub(super) fn add_cross(level: Level, u: &Vector, a: &Vectors, out: &mut Vectors) {
    let [x, y, z] = a;
    each(
        level,
        out.each_mut(),
        #[inline(always)]
        |i, old| (plus_cross(old, [u.x, u.y, u.z], [x[i], y[i], z[i]]), []),
    );
}

/// The sum of `a × b`.
#[inline(never)]
pub(super) fn sum_of_crosses(level: Level, a: &Vectors, b: &Vectors) -> Vector {
    let ([x, y, z], [u, v, w]) = (a, b);
    let sums = each(
        level,
        [],
        #[inline(always)]
        |i, []| ([], plus_cross([0.0; 3], [x[i], y[i], z[i]], [u[i], v[i], w[i]])),
    );
    sums.into()
}

#[inline(always)]
fn plus_cross(sum: [f64; 3], [x, y, z]: [f64; 3], [u, v, w]: [f64; 3]) -> [f64; 3] {
    [
        y.mul_add(w, (-z).mul_add(v, sum[0])),
        z.mul_add(u, (-x).mul_add(w, sum[1])),
        x.mul_add(v, (-y).mul_add(u, sum[2])),
    ]
}

/// The sum of `a·b`.
#[inline(never)]
pub(super) fn sum_of_dots(level: Level, a: &Vectors, b: &Vectors) -> f64 {
    let ([x, y, z], [u, v, w]) = (a, b);
    let [sum] = each(
        level,
        [],
        #[inline(always)]
        |i, []| ([], [x[i].mul_add(u[i], y[i].mul_add(v[i], z[i] * w[i]))]),
    );
    sum
}

/// How `a·b` less its part along a constant unit vector `u` changes with `u`: the sum of
/// `−a (u·b) − b (u·a)`.
#[inline(never)]
pub(super) fn sum_by_axis(level: Level, u: &Vector, a: &Vectors, b: &Vectors) -> Vector {
    let ([x, y, z], [p, q, r]) = (a, b);
    let sums = each(
        level,
        [],
        #[inline(always)]
        |i, []| {
            let (a, b) = ([x[i], y[i], z[i]], [p[i], q[i], r[i]]);
            let (of_a, of_b) = (-dot(a, u), -dot(b, u));
            ([], [0, 1, 2].map(|k| a[k].mul_add(of_b, b[k] * of_a)))
        },
    );
    sums.into()
}

/// The part of `a` across a constant unit vector.
#[inline(never)]
pub(super) fn across(level: Level, a: &Vectors, u: &Vector) -> Vectors {
    let [x, y, z] = a;
    let mut out = [ZEROS; 3];
    each(
        level,
        out.each_mut(),
        #[inline(always)]
        |i, _| {
            let a = [x[i], y[i], z[i]];
            let along = -dot(a, u);
            ([0, 1, 2].map(|k| along.mul_add(u[k], a[k])), [])
        },
    );
    out
}

/// `a·u`.
#[inline(always)]
pub(super) fn dot(a: [f64; 3], u: &Vector) -> f64 {
    a[0].mul_add(u.x, a[1].mul_add(u.y, a[2] * u.z))
}
