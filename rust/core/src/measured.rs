//! The motion of a measured drive: angles from its speed, speed and acceleration from a filter.
//!
//! The filter is a parabola, fitted by least squares to the samples around each one: Savitzky and
//! Golay, Analytical Chemistry 36 (1964) 1627, with unequal steps and missing samples allowed. A
//! sample is missing if its time or its value is NaN.

use std::ops::Range;

use crate::run::level::{Level, compiled_for};

/// Rows whose sums are in the first-level cache together.
const ROWS: usize = 128;

/// The sums of a parabola: of weight times `u^n` up to the fourth power, and of weight times value
/// times `u^n` up to the second.
const SUMS: usize = 8;

/// The integral of a signal over time by the trapezoidal rule, which is exact for a ramp.
///
/// It takes samples in pieces, and its bits are the same for any pieces. The sum of the steps has
/// an error term, so that rounding does not grow with the number of samples. Missing samples are
/// bridged.
#[derive(Clone, Copy, Debug)]
pub struct Integral {
    last: Option<(f64, f64)>,
    sum: f64,
    rest: f64,
}

impl Integral {
    /// Begins with the integral at the first sample.
    pub fn new(start: f64) -> Self {
        Self { last: None, sum: start, rest: 0.0 }
    }

    /// The integral at the samples of the next piece; NaN where one is missing.
    pub fn extend(&mut self, time: &[f64], values: &[f64], integral: &mut [f64]) {
        for ((&time, &value), integral) in time.iter().zip(values).zip(integral) {
            if time.is_nan() || value.is_nan() {
                *integral = f64::NAN;
                continue;
            }
            let (last_time, last_value) = self.last.unwrap_or((time, value));
            self.last = Some((time, value));
            self.add(0.5 * (time - last_time) * (value + last_value));
            *integral = self.sum + self.rest;
        }
    }

    /// Adds a step with its rounding error (Knuth's two-sum).
    #[inline(always)]
    fn add(&mut self, step: f64) {
        let total = self.sum + step;
        let part = total - self.sum;
        self.rest += (self.sum - (total - part)) + (step - part);
        self.sum = total;
    }
}

/// First and second derivative of a signal over time at some rows, from a parabola at each.
///
/// The parabola of a sample fits those of the `2 reach + 1` rows around it that are not missing, and
/// fewer at the ends of the signal. The derivatives are NaN where the sample is missing, and where
/// less than three are known around it.
///
/// # Panics
/// If `rows` are not rows of both signals, or if the results are not as long as `rows`.
pub fn derivatives(
    level: Level,
    time: &[f64],
    values: &[f64],
    reach: usize,
    rows: Range<usize>,
    [first, second]: [&mut [f64]; 2],
) {
    let pieces = first.chunks_mut(ROWS).zip(second.chunks_mut(ROWS));
    for (begin, (first, second)) in rows.step_by(ROWS).zip(pieces) {
        compiled_for!(level, fit([time, values], reach, begin, [first, second]));
    }
}

/// Fits `c0 + c1 u + c2 u²` around the rows from `begin` on, with times and values taken from each.
#[inline(always)]
fn fit([time, values]: [&[f64]; 2], reach: usize, begin: usize, [first, second]: [&mut [f64]; 2]) {
    let count = first.len().min(ROWS);
    let mut sums = [[0.0; ROWS]; SUMS];
    let (here, rows) = (begin..begin + count, time.len());
    // Row `here + back − reach` is added to the sums of row `here`.
    for back in 0..=reach.saturating_mul(2) {
        let from = here.start.max(reach.saturating_sub(back));
        let to = here.end.min((rows + reach).saturating_sub(back));
        if from < to {
            let there = from + back - reach..to + back - reach;
            let (here, at) = (from..to, from - here.start);
            let times = [&time[here.clone()], &time[there.clone()]];
            add(times, [&values[here], &values[there]], &mut sums, at);
        }
    }
    let [s0, s1, s2, s3, s4, y0, y1, y2] = &sums;
    for i in 0..count {
        let (s0, s1, s2, s3, s4) = (s0[i], s1[i], s2[i], s3[i], s4[i]);
        let (minor, middle, last) = (s1 * s4 - s2 * s3, s0 * s4 - s2 * s2, s1 * s3 - s2 * s2);
        let (mixed, spread) = (s0 * s3 - s1 * s2, s0 * s2 - s1 * s1);
        let determinant = s0 * (s2 * s4 - s3 * s3) - s1 * minor + s2 * last;
        let scale = if s0 >= 3.0 { 1.0 / determinant } else { f64::NAN };
        first[i] = scale * (y1[i] * middle - y0[i] * minor - y2[i] * mixed);
        second[i] = 2.0 * scale * (y0[i] * last - y1[i] * mixed + y2[i] * spread);
    }
}

/// Adds a row at an offset to the sums of each row, those of the first at the index `at`.
#[inline(always)]
fn add(
    [time, other_time]: [&[f64]; 2],
    [values, other_values]: [&[f64]; 2],
    sums: &mut [[f64; ROWS]; SUMS],
    at: usize,
) {
    let length = time.len();
    let (values, other_time) = (&values[..length], &other_time[..length]);
    let other_values = &other_values[..length];
    let [s0, s1, s2, s3, s4, y0, y1, y2] = sums.each_mut().map(|sum| &mut sum[at..at + length]);
    for i in 0..length {
        let (u, y) = (other_time[i] - time[i], other_values[i] - values[i]);
        // A product with what is missing would be NaN.
        let known = !(u + y).is_nan();
        let (u, y) = if known { (u, y) } else { (0.0, 0.0) };
        let square = u * u;
        s0[i] += if known { 1.0 } else { 0.0 };
        s1[i] += u;
        s2[i] += square;
        s3[i] += square * u;
        s4[i] += square * u * u;
        y0[i] += y;
        y1[i] += u * y;
        y2[i] += square * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_samples_are_bridged() {
        let (time, values) = ([0.0, 1.0, f64::NAN, 4.0], [2.0, 4.0, 0.0, f64::NAN]);
        let (mut integral, mut got) = (Integral::new(1.0), [0.0; 4]);
        integral.extend(&time, &values, &mut got);
        assert_eq!(got[..2], [1.0, 4.0]);
        assert!(got[2].is_nan() && got[3].is_nan());
        integral.extend(&[5.0], &[8.0], &mut got[..1]);
        assert_eq!(got[0], 28.0);
    }

    #[test]
    fn derivatives_of_a_parabola_with_gaps() {
        let time: Vec<f64> =
            (0..1000).map(|i| 0.01 * f64::from(i) + 1e-5 * f64::from(i % 7)).collect();
        let mut values: Vec<f64> = time.iter().map(|t| 1.0 + 2.0 * t - 3.0 * t * t).collect();
        for i in (0..1000).step_by(5) {
            values[i] = f64::NAN;
        }
        let rows = 100..1000;
        let (mut first, mut second) = (vec![0.0; 900], vec![0.0; 900]);
        for (_, level) in crate::level::available() {
            derivatives(level, &time, &values, 3, rows.clone(), [&mut first, &mut second]);
            for (i, row) in rows.clone().enumerate() {
                if row % 5 == 0 {
                    assert!(first[i].is_nan() && second[i].is_nan());
                } else {
                    assert!((first[i] - 2.0 + 6.0 * time[row]).abs() < 1e-9);
                    assert!((second[i] + 6.0).abs() < 1e-6);
                }
            }
        }
    }
}
