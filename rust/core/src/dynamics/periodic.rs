//! Periodic quantities as Fourier series through equally spaced samples.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::dynamics::lanes::{LANES, Lanes, Pack, ZERO, all, make_room};
use crate::number::elementary::{norm, turn};
use crate::number::{reduction, trig};

/// `f(α) = mean + Re Σ amplitudes[n − 1] e^{2niα/h}`, where `h` half turns of the drive are a
/// period.
#[derive(Clone, Debug, Default)]
pub(super) struct FourierSeries {
    pub(super) half_turns: usize,
    pub(super) mean: f64,
    pub(super) amplitudes: Vec<Complex<f64>>,
}

/// `e^{2πik/count}` for all `k`.
pub(super) fn roots_of_unity(count: usize) -> Vec<Complex<f64>> {
    (0..count).map(|k| turn(TAU * k as f64 / count as f64)).collect()
}

impl FourierSeries {
    /// The series through samples at equal distances over a period, a power of two in number.
    pub(super) fn through(
        half_turns: usize,
        samples: impl Fn(usize) -> f64,
        roots: &[Complex<f64>],
    ) -> Self {
        let count = roots.len();
        let values: Vec<f64> = (0..count).map(samples).collect();
        let scale = 1.0 / count as f64;
        let mean = values.iter().sum::<f64>() * scale;
        let amplitude = |n: usize| {
            let sum: Complex<f64> =
                values.iter().enumerate().map(|(k, x)| roots[k * n % count].conj() * *x).sum();
            sum * (2.0 * scale)
        };
        Self { half_turns, mean, amplitudes: (1..count / 2).map(amplitude).collect() }
    }

    /// The largest amplitude in the upper quarter of the orders: what the samples do not resolve is
    /// about as large.
    pub(super) fn tail(&self) -> f64 {
        let from = self.amplitudes.len() * 3 / 4;
        self.amplitudes[from..].iter().fold(0.0, |most, x| norm(*x).max(most))
    }

    /// The amplitude of an order of the drive's rotation.
    pub(super) fn order(&self, order: f64) -> Complex<f64> {
        let place = multiple(order, self.half_turns).and_then(|n| n.checked_sub(1));
        place.and_then(|n| self.amplitudes.get(n)).copied().unwrap_or_default()
    }

    /// The value and the first two derivatives by the drive angle.
    pub(super) fn at(&self, angle: f64) -> [f64; 3] {
        let base = 2.0 / self.half_turns as f64;
        let step = turn(base * angle);
        let mut turn = Complex::new(1.0, 0.0);
        let mut found = [self.mean, 0.0, 0.0];
        for (n, amplitude) in (1..).zip(&self.amplitudes) {
            turn *= step;
            let (order, term) = (base * f64::from(n), amplitude * turn);
            found[0] += term.re;
            found[1] -= order * term.im;
            found[2] -= order * order * term.re;
        }
        found
    }

    /// The largest absolute value among mean and amplitudes.
    pub(super) fn largest(&self) -> f64 {
        self.amplitudes.iter().fold(self.mean.abs(), |most, x| norm(*x).max(most))
    }
}

/// How often an order of the drive's rotation repeats in a period of so many half turns, if that is
/// a whole number.
pub(super) fn multiple(order: f64, half_turns: usize) -> Option<usize> {
    let times = 0.5 * half_turns as f64 * order;
    let whole = times.round();
    ((times - whole).abs() <= 1e-9 * times).then_some(whole as usize)
}

/// Series with the same number of terms, of several runs side by side.
#[derive(Debug, Default)]
pub(super) struct SeriesSideBySide {
    /// Real and imaginary parts of the mean and of the amplitudes, `(series, terms)`.
    terms: Vec<[Pack; 2]>,
    count: usize,
}

impl SeriesSideBySide {
    /// The series of so many samples each, at equal distances over a period.
    #[inline(always)]
    pub(super) fn through(&mut self, lanes: Lanes, samples: &[Pack], roots: &[Complex<f64>]) {
        let count = roots.len();
        self.count = count / 2;
        self.terms.clear();
        for samples in samples.chunks_exact(count) {
            for n in 0..self.count {
                let (mut re, mut im) = (ZERO, ZERO);
                for (k, x) in samples.iter().enumerate() {
                    let root = roots[(k * n) & (count - 1)];
                    re = lanes.plus_scaled(re, root.re, *x);
                    im = lanes.plus_scaled(im, -root.im, *x);
                }
                let scale = if n == 0 { 1.0 } else { 2.0 } / count as f64;
                self.terms.push([re, im].map(|part| lanes.plus_scaled(ZERO, scale, part)));
            }
        }
    }

    /// A series of a lane, whose period is so many half turns.
    pub(super) fn of(&self, half_turns: usize, series: usize, lane: usize) -> FourierSeries {
        let terms = &self.terms[series * self.count..][..self.count];
        let term = |[re, im]: &[Pack; 2]| Complex::new(re[lane], im[lane]);
        let amplitudes = terms[1..].iter().map(term).collect();
        FourierSeries { half_turns, mean: terms[0][0][lane], amplitudes }
    }

    /// Takes one series of each lane. The last one also fills the lanes that are left. Returns the
    /// number of terms.
    pub(super) fn load(&mut self, series: &[&FourierSeries]) -> usize {
        let lane = |l: usize| series[l.min(series.len() - 1)];
        self.count = lane(0).amplitudes.len() + 1;
        self.terms.clear();
        self.terms.resize(self.count, [ZERO; 2]);
        for l in 0..LANES {
            self.terms[0][0][l] = lane(l).mean;
            for (term, amplitude) in self.terms[1..].iter_mut().zip(&lane(l).amplitudes) {
                (term[0][l], term[1][l]) = (amplitude.re, amplitude.im);
            }
        }
        self.count
    }

    /// Least and largest values. Every extremum of the samples is followed to the extremum of the
    /// series by Newton's method.
    #[inline(always)]
    pub(super) fn extremes(
        &self,
        lanes: Lanes,
        samples: &mut Vec<Pack>,
        roots: &[Complex<f64>],
    ) -> [Pack; 2] {
        let count = roots.len();
        samples.clear();
        make_room(samples, count);
        for k in 0..=count / 2 {
            // The samples at an angle and its opposite differ by the sign of the sines.
            let (mut even, mut odd) = (self.terms[0][0], ZERO);
            for (n, [re, im]) in self.terms.iter().enumerate().skip(1) {
                let root = roots[(k * n) & (count - 1)];
                even = lanes.plus_scaled(even, root.re, *re);
                odd = lanes.plus_scaled(odd, root.im, *im);
            }
            samples[k] = lanes.plus_scaled(even, -1.0, odd);
            samples[(count - k) & (count - 1)] = lanes.plus_scaled(even, 1.0, odd);
        }
        let (mut least, mut most) = (samples[0], samples[0]);
        for sample in samples.iter() {
            for l in lanes.each() {
                least[l] = if sample[l] < least[l] { sample[l] } else { least[l] };
                most[l] = if sample[l] > most[l] { sample[l] } else { most[l] };
            }
        }
        let mut found = [least, most];
        // The extremum beside a sample differs from it by less than the samples differ.
        let mut next = [0; LANES];
        loop {
            let (mut angles, mut active) = (ZERO, [false; LANES]);
            for l in lanes.each() {
                let near = 0.25 * (most[l] - least[l]);
                while next[l] < count && !active[l] {
                    let k = next[l];
                    next[l] += 1;
                    let value = samples[k][l];
                    let before = samples[(k + count - 1) & (count - 1)][l];
                    let after = samples[(k + 1) & (count - 1)][l];
                    let top = value >= before && value >= after && value >= most[l] - near;
                    let bottom = value <= before && value <= after && value <= least[l] + near;
                    if top || bottom {
                        active[l] = true;
                        // The vertex of the parabola through the three samples.
                        let part = 0.5 * (before - after) / (before - 2.0 * value + after);
                        let part = if part.abs() <= 0.5 { part } else { 0.0 };
                        angles[l] = (k as f64 + part) * (PI / count as f64);
                    }
                }
            }
            if active == [false; LANES] {
                return found;
            }
            let values = self.extrema(lanes, &angles, PI / count as f64);
            for l in (lanes.each()).filter(|&l| active[l]) {
                found[0][l] = found[0][l].min(values[l]);
                found[1][l] = found[1][l].max(values[l]);
            }
        }
    }

    /// The values at the extrema within a distance from angles.
    #[inline(always)]
    fn extrema(&self, lanes: Lanes, starts: &Pack, distance: f64) -> Pack {
        let mut angles = *starts;
        let mut values = self.terms[0][0];
        let mut ended = [true; LANES];
        ended[lanes.each()].fill(false);
        for _ in 0..8 {
            let [here, slopes, curvatures] = self.at(lanes, &angles);
            for l in lanes.each() {
                if ended[l] {
                    continue;
                }
                let step = -slopes[l] / curvatures[l];
                if step.abs() < 1e-6 {
                    values[l] = (0.5 * step).mul_add(slopes[l], here[l]);
                    ended[l] = true;
                } else {
                    values[l] = here[l];
                    ended[l] = !step.is_finite();
                    angles[l] =
                        (angles[l] + step).clamp(starts[l] - distance, starts[l] + distance);
                }
            }
            if ended == [true; LANES] {
                break;
            }
        }
        values
    }

    /// Values and the first two derivatives by an angle that is `π` at the end of the period, with an
    /// angle for each lane.
    #[inline(always)]
    fn at(&self, lanes: Lanes, angles: &Pack) -> [Pack; 3] {
        let [mut sines, mut cosines] = [ZERO; 2];
        for l in lanes.each() {
            let (s, c) = trig::sin_cos_reduced::<f64>(reduction::reduce(2.0 * angles[l]));
            (sines[l], cosines[l]) = (s, c);
        }
        let (mut s, mut c) = (ZERO, all(1.0));
        let mut found = [self.terms[0][0], ZERO, ZERO];
        for (n, [re, im]) in self.terms.iter().enumerate().skip(1) {
            let order = 2.0 * n as f64;
            for l in lanes.each() {
                let turned = s[l].mul_add(cosines[l], c[l] * sines[l]);
                c[l] = c[l].mul_add(cosines[l], -(s[l] * sines[l]));
                s[l] = turned;
                let real = re[l].mul_add(c[l], -(im[l] * s[l]));
                let imaginary = re[l].mul_add(s[l], im[l] * c[l]);
                found[0][l] += real;
                found[1][l] = (-order).mul_add(imaginary, found[1][l]);
                found[2][l] = (-order * order).mul_add(real, found[2][l]);
            }
        }
        found
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
        FourierSeries::through(1, |k| wave(PI * k as f64 / count as f64), &roots)
    }

    #[test]
    fn a_series_has_the_orders_of_its_samples() {
        let series = series();
        assert!((series.mean - 3.0).abs() < 1e-14);
        let close = |order, amplitude, phase| {
            (series.order(order) - Complex::from_polar(amplitude, phase)).norm() < 1e-14
        };
        assert!(close(2.0, 2.0, -0.3) && close(4.0, 0.5, 1.0));
        assert!(close(3.0, 0.0, 0.0) && close(6.0, 0.0, 0.0) && close(200.0, 0.0, 0.0));
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
        let mut side_by_side = SeriesSideBySide::default();
        let count = side_by_side.load(&[&series()]);
        let [low, high] =
            side_by_side.extremes(Lanes::of(false, 1), &mut vec![], &roots_of_unity(8 * count));
        assert!((low[0] - least).abs() < 1e-9 && (high[7] - most).abs() < 1e-9);
    }
}
