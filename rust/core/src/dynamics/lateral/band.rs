//! Linear equations whose matrix is zero away from its diagonal, by elimination with pivots.

use nalgebra::Complex;

type C = Complex<f64>;

/// How far from the diagonal the matrix has entries.
pub(super) const REACH: usize = 7;

/// The entries of a row: those below the diagonal, and those above it, to which pivots add as many.
const WIDTH: usize = 3 * REACH + 1;

/// A square matrix whose entries lie within [`REACH`] of the diagonal.
#[derive(Debug, Default)]
pub(super) struct Band {
    rows: Vec<[C; WIDTH]>,
    /// By how many rows below the diagonal each pivot was found.
    pivots: Vec<usize>,
}

impl Band {
    /// Makes the matrix one of zeros of this size.
    pub(super) fn clear(&mut self, size: usize) {
        self.rows.clear();
        self.rows.resize(size, [C::ZERO; WIDTH]);
        self.pivots.clear();
        self.pivots.resize(size, 0);
    }

    pub(super) fn add(&mut self, row: usize, column: usize, value: C) {
        self.rows[row][column + REACH - row] += value;
    }

    pub(super) fn get(&self, row: usize, column: usize) -> C {
        if row.abs_diff(column) > REACH { C::ZERO } else { self.rows[row][column + REACH - row] }
    }

    /// Replaces the matrix by its factors. A matrix without an inverse has factors that are not
    /// finite.
    pub(super) fn factor(&mut self) {
        for k in 0..self.rows.len() {
            let (own, below) = self.rows[k..].split_at_mut(1);
            let own = &mut own[0];
            let below = &mut below[..REACH.min(self.pivots.len() - 1 - k)];
            let mut largest = (own[REACH].norm_sqr(), 0);
            for (i, row) in below.iter().enumerate() {
                let size = row[REACH - 1 - i].norm_sqr();
                if size > largest.0 {
                    largest = (size, i + 1);
                }
            }
            self.pivots[k] = largest.1;
            if let Some(i) = largest.1.checked_sub(1) {
                own[REACH..].swap_with_slice(&mut below[i][REACH - 1 - i..][..=2 * REACH]);
            }
            let inverse = own[REACH].inv();
            for (i, row) in below.iter_mut().enumerate() {
                let row = &mut row[REACH - 1 - i..][..=2 * REACH];
                if row[0] == C::ZERO {
                    continue;
                }
                let factor = row[0] * inverse;
                row[0] = factor;
                for (x, pivot) in row[1..].iter_mut().zip(&own[REACH + 1..]) {
                    *x -= factor * pivot;
                }
            }
        }
    }

    /// Replaces the right-hand side by the solution, once the matrix is factored.
    pub(super) fn solve(&self, x: &mut [C]) {
        let size = self.rows.len();
        for k in 0..size {
            x.swap(k, k + self.pivots[k]);
            let own = x[k];
            for i in 1..=REACH.min(size - 1 - k) {
                x[k + i] -= self.rows[k + i][REACH - i] * own;
            }
        }
        for k in (0..size).rev() {
            let row = &self.rows[k][REACH..];
            let above = x[k + 1..].iter().zip(&row[1..]).map(|(x, entry)| x * entry);
            x[k] = (x[k] - above.sum::<C>()) / row[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A matrix whose diagonal is small, so that pivots are needed in every column.
    #[test]
    fn the_solution_solves_the_equations() {
        for size in [1, 2, 7, 8, 9, 40] {
            let mut seed = 1_u32;
            let mut number = || {
                seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                f64::from(seed) / f64::from(u32::MAX) - 0.5
            };
            let mut band = Band::default();
            band.clear(size);
            for row in 0..size {
                for column in row.saturating_sub(REACH)..(row + REACH + 1).min(size) {
                    let scale = if row == column { 1e-9 } else { 1.0 };
                    band.add(row, column, scale * Complex::new(number(), number()));
                }
            }
            let wanted: Vec<C> = (0..size).map(|_| Complex::new(number(), number())).collect();
            let mut x: Vec<C> = (0..size)
                .map(|row| (0..size).map(|column| band.get(row, column) * wanted[column]).sum())
                .collect();
            band.factor();
            band.solve(&mut x);
            for (x, wanted) in x.iter().zip(&wanted) {
                assert!((x - wanted).norm() < 1e-7, "{size}: {x} for {wanted}");
            }
        }
    }
}
