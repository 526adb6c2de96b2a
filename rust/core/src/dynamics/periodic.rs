//! Quantities with a period of half a turn, as Fourier series through equally spaced samples.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::number::elementary::{norm, turn};

/// `f(α) = mean + Re Σ amplitudes[n − 1] e^{2niα}`.
#[derive(Clone, Debug, Default)]
pub(super) struct FourierSeries {
    pub(super) mean: f64,
    pub(super) amplitudes: Vec<Complex<f64>>,
}

/// `e^{2πik/count}` for all `k`.
pub(super) fn roots_of_unity(count: usize) -> Vec<Complex<f64>> {
    (0..count).map(|k| turn(TAU * k as f64 / count as f64)).collect()
}

impl FourierSeries {
    /// The series through samples at equal distances over half a turn, a power of two in number.
    pub(super) fn through(samples: impl Fn(usize) -> f64, roots: &[Complex<f64>]) -> Self {
        let count = roots.len();
        let values: Vec<f64> = (0..count).map(samples).collect();
        let scale = 1.0 / count as f64;
        let mean = values.iter().sum::<f64>() * scale;
        let amplitude = |n: usize| {
            let sum: Complex<f64> =
                values.iter().enumerate().map(|(k, x)| roots[k * n % count].conj() * *x).sum();
            sum * (2.0 * scale)
        };
        Self { mean, amplitudes: (1..count / 2).map(amplitude).collect() }
    }

    /// The largest amplitude in the upper quarter of the orders: what the samples do not resolve is
    /// about as large.
    pub(super) fn tail(&self) -> f64 {
        let from = self.amplitudes.len() * 3 / 4;
        self.amplitudes[from..].iter().fold(0.0, |most, x| norm(*x).max(most))
    }

    /// The amplitude of an order of the drive's rotation.
    pub(super) fn order(&self, order: usize) -> Complex<f64> {
        let found = if order.is_multiple_of(2) { (order / 2).checked_sub(1) } else { None };
        found.and_then(|n| self.amplitudes.get(n)).copied().unwrap_or_default()
    }

    /// The value and the first two derivatives by the drive angle.
    pub(super) fn at(&self, angle: f64) -> [f64; 3] {
        let step = turn(2.0 * angle);
        let mut turn = Complex::new(1.0, 0.0);
        let mut found = [self.mean, 0.0, 0.0];
        for (n, amplitude) in (1..).zip(&self.amplitudes) {
            turn *= step;
            let (order, term) = (2.0 * f64::from(n), amplitude * turn);
            found[0] += term.re;
            found[1] -= order * term.im;
            found[2] -= order * order * term.re;
        }
        found
    }

    /// Least and largest value. Every extremum of the samples is followed to the extremum of the
    /// series by Newton's method.
    pub(super) fn extremes(&self) -> [f64; 2] {
        let count = 8 * (self.amplitudes.len() + 1);
        let width = PI / count as f64;
        let roots = roots_of_unity(count);
        let sample = |k: usize| -> f64 {
            let term = |(n, x): (usize, &Complex<f64>)| (x * roots[k * (n + 1) % count]).re;
            self.mean + self.amplitudes.iter().enumerate().map(term).sum::<f64>()
        };
        let samples: Vec<f64> = (0..count).map(sample).collect();
        let most = samples.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = samples.iter().copied().fold(f64::INFINITY, f64::min);
        // The extremum beside a sample differs from it by less than the samples differ.
        let near = 0.25 * (most - least);
        let mut found = [least, most];
        for (k, &value) in samples.iter().enumerate() {
            let (before, after) = (samples[(k + count - 1) % count], samples[(k + 1) % count]);
            let top = value >= before && value >= after && value >= most - near;
            let bottom = value <= before && value <= after && value <= least + near;
            if top || bottom {
                let value = self.extremum(width * k as f64, width);
                found = [found[0].min(value), found[1].max(value)];
            }
        }
        found
    }

    /// The value at the extremum within a distance from an angle.
    fn extremum(&self, start: f64, distance: f64) -> f64 {
        let mut angle = start;
        let mut value = self.mean;
        for _ in 0..8 {
            let [here, slope, curvature] = self.at(angle);
            value = here;
            let step = -slope / curvature;
            if !step.is_finite() || step.abs() < 1e-9 {
                break;
            }
            angle = (angle + step).clamp(start - distance, start + distance);
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `3 + 2 cos(2α − 0.3) + ½ cos(4α + 1)`.
    fn wave(angle: f64) -> f64 {
        3.0 + 2.0 * (2.0 * angle - 0.3).cos() + 0.5 * (4.0 * angle + 1.0).cos()
    }

    fn series() -> FourierSeries {
        let count = 16;
        let roots = roots_of_unity(count);
        FourierSeries::through(|k| wave(PI * k as f64 / count as f64), &roots)
    }

    #[test]
    fn a_series_has_the_orders_of_its_samples() {
        let series = series();
        assert!((series.mean - 3.0).abs() < 1e-14);
        let close = |order, amplitude, phase| {
            (series.order(order) - Complex::from_polar(amplitude, phase)).norm() < 1e-14
        };
        assert!(close(2, 2.0, -0.3) && close(4, 0.5, 1.0));
        assert!(close(3, 0.0, 0.0) && close(6, 0.0, 0.0) && close(200, 0.0, 0.0));
        assert!(series.tail() < 1e-14);
        assert!((series.at(0.77)[0] - wave(0.77)).abs() < 1e-13);
        let slope = (wave(0.77 + 1e-5) - wave(0.77 - 1e-5)) / 2e-5;
        assert!((series.at(0.77)[1] - slope).abs() < 1e-8);
    }

    #[test]
    fn extremes_are_those_of_the_curve() {
        let dense: Vec<f64> = (0..400_000).map(|i| wave(PI * f64::from(i) / 4e5)).collect();
        let least = dense.iter().copied().fold(f64::INFINITY, f64::min);
        let most = dense.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let [low, high] = series().extremes();
        assert!((low - least).abs() < 1e-9 && (high - most).abs() < 1e-9);
    }
}
