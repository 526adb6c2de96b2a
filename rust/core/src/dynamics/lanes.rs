//! Numbers of several runs side by side, and linear equations of each of them.
//!
//! Every lane goes through the same operations, whatever its neighbours hold, so its bits depend
//! neither on them nor on the instruction set. Loops over lanes are unrolled by the compiler into
//! operations on whole registers.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use std::ops::{Index, IndexMut, Range};

/// The number of runs that are computed together: doubles in the largest registers.
pub(super) const LANES: usize = 8;

/// The numbers of several runs, one per lane. They fill a cache line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(super) struct Pack([f64; LANES]);

/// A pack of zeros.
pub(super) const ZERO: Pack = all(0.0);

/// The same number in every lane.
#[inline(always)]
pub(super) const fn all(x: f64) -> Pack {
    Pack([x; LANES])
}

impl Index<usize> for Pack {
    type Output = f64;

    #[inline(always)]
    fn index(&self, lane: usize) -> &f64 {
        &self.0[lane]
    }
}

impl IndexMut<usize> for Pack {
    #[inline(always)]
    fn index_mut(&mut self, lane: usize) -> &mut f64 {
        &mut self.0[lane]
    }
}

/// Makes room for so many packs.
#[inline(never)]
pub(super) fn make_room(packs: &mut Vec<Pack>, count: usize) {
    packs.resize(count, ZERO);
}

/// How many lanes are computed: all of them where they fill registers, else those that are in use.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lanes {
    count: usize,
    compact: bool,
}

impl Lanes {
    /// For a level that is compact or not, with so many lanes in use.
    #[inline(always)]
    pub(super) fn of(compact: bool, used: usize) -> Self {
        Self { count: if compact { used.min(LANES) } else { LANES }, compact }
    }

    /// The lanes.
    #[inline(always)]
    pub(super) fn each(self) -> Range<usize> {
        0..self.count
    }

    /// `sum + a · b`.
    #[inline(always)]
    pub(super) fn plus_product(self, sum: Pack, a: Pack, b: Pack) -> Pack {
        let mut out = sum;
        if self.compact {
            add_product(self.count, &mut out, &a, &b);
        } else {
            for l in 0..LANES {
                out[l] = a[l].mul_add(b[l], sum[l]);
            }
        }
        out
    }

    /// `sum + a · b` with the same `a` in every lane.
    #[inline(always)]
    pub(super) fn plus_scaled(self, sum: Pack, a: f64, b: Pack) -> Pack {
        self.plus_product(sum, all(a), b)
    }

    /// Solves linear equations in every lane by elimination. A row of the table has the
    /// coefficients of the unknowns, `rows` in number, and the right sides, which the solutions
    /// replace.
    #[inline(always)]
    pub(super) fn solve(self, table: &mut [Pack], rows: usize, columns: usize) {
        for k in 0..rows {
            self.choose_pivot(table, rows, columns, k);
            let (above, below) = table.split_at_mut((k + 1) * columns);
            let pivots = &mut above[k * columns..];
            let mut inverse = ZERO;
            for l in self.each() {
                inverse[l] = 1.0 / pivots[k][l];
            }
            for entry in &mut pivots[k + 1..] {
                *entry = self.plus_product(ZERO, *entry, inverse);
            }
            for row in below.chunks_exact_mut(columns) {
                self.eliminate(row, pivots, k, k + 1);
            }
        }
        for k in (1..rows).rev() {
            let (above, solved) = table.split_at_mut(k * columns);
            for row in above.chunks_exact_mut(columns) {
                self.eliminate(row, &solved[..columns], k, rows);
            }
        }
    }

    /// Removes an unknown from a row, in its columns from a given one on.
    #[inline(always)]
    fn eliminate(self, row: &mut [Pack], by: &[Pack], unknown: usize, from: usize) {
        let factor = self.plus_scaled(ZERO, -1.0, row[unknown]);
        for (entry, other) in row[from..].iter_mut().zip(&by[from..]) {
            *entry = self.plus_product(*entry, factor, *other);
        }
    }

    /// Exchanges rows in the lanes whose pivot is small beside another entry of its column.
    #[inline(always)]
    fn choose_pivot(self, table: &mut [Pack], rows: usize, columns: usize, k: usize) {
        let mut most = ZERO;
        for i in k + 1..rows {
            let entry = table[i * columns + k];
            for l in self.each() {
                most[l] = if entry[l].abs() > most[l] { entry[l].abs() } else { most[l] };
            }
        }
        let pivot = table[k * columns + k];
        let mut small = false;
        for l in self.each() {
            small |= pivot[l].abs() < ENOUGH * most[l];
        }
        if small {
            exchange(table, columns, k, &most);
        }
    }
}

/// A pivot of at least this share of the largest entry below it is kept.
const ENOUGH: f64 = 0.1;

/// Adds `a · b` where every product-sum is a call: one function instead of many loops.
#[inline(never)]
fn add_product(count: usize, sum: &mut Pack, a: &Pack, b: &Pack) {
    for l in 0..count {
        sum[l] = a[l].mul_add(b[l], sum[l]);
    }
}

/// Brings the largest entry of a column, which is given, to the diagonal where that is small.
#[inline(never)]
fn exchange(table: &mut [Pack], columns: usize, k: usize, most: &Pack) {
    let (above, below) = table.split_at_mut((k + 1) * columns);
    let upper = &mut above[k * columns..];
    for l in 0..LANES {
        let is_largest = |row: &&mut [Pack]| row[k][l].abs() == most[l];
        if upper[k][l].abs() < ENOUGH * most[l]
            && let Some(lower) = below.chunks_exact_mut(columns).find(is_largest)
        {
            for (x, y) in upper.iter_mut().zip(lower) {
                std::mem::swap(&mut x[l], &mut y[l]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Equations whose first pivots vanish in some lanes, and lanes that have no solution beside
    /// those that have one.
    #[test]
    fn every_lane_solves_its_own_equations() {
        const ROWS: usize = 5;
        let entry = |l: usize, i: usize, j: usize| -> f64 {
            if l == 3 && i == j { 0.0 } else { ((7 * l + 3 * i * i + 5 * j + i * j) as f64).sin() }
        };
        let mut table = vec![ZERO; ROWS * (ROWS + 2)];
        for l in 0..LANES {
            for i in 0..ROWS {
                let row = &mut table[i * (ROWS + 2)..][..ROWS + 2];
                for j in 0..ROWS {
                    row[j][l] = if l == 5 { 0.0 } else { entry(l, i, j) };
                    row[ROWS][l] += entry(l, i, j) * (j as f64 + 1.0);
                    row[ROWS + 1][l] -= entry(l, i, j) * (l as f64);
                }
            }
        }
        Lanes::of(false, 1).solve(&mut table, ROWS, ROWS + 2);
        for l in (0..LANES).filter(|&l| l != 5) {
            for i in 0..ROWS {
                let [x, y] = [ROWS, ROWS + 1].map(|c| table[i * (ROWS + 2) + c][l]);
                assert!((x - i as f64 - 1.0).abs() < 1e-12, "{l} {i}: {x}");
                assert!((y + l as f64).abs() < 1e-12, "{l} {i}: {y}");
            }
        }
        assert!(!table[ROWS][5].is_finite());
    }
}
