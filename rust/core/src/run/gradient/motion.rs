//! Sums over the samples of the motion of one shaft, in vectorised loops.
//!
//! The formulas are those of [`super::sample`] for unnormalised sine and cosine, as
//! [`crate::number::trig::pin`] returns them.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is in range")]

use crate::input::Sweep;
use crate::number::atan::Atan;
use crate::number::reduction::LargeAngleFlag;
use crate::number::trig::{self, Angle};
use crate::run::gradient::line::ShaftConstants;
use crate::run::level::{Level, compiled_for};
use crate::sincos::array::sample_number;

/// Samples per chunk, whose buffers stay in the first-level cache.
pub(super) const CHUNK: usize = 512;

/// Sums in a fixed order, whatever the instruction set.
const LANES: usize = 8;

/// The buffers of a thread.
pub(super) struct Buffers {
    angles: [f64; CHUNK],
    sines: [f64; CHUNK],
    cosines: [f64; CHUNK],
    terms: [[f64; CHUNK]; 3],
    zeros: [f64; CHUNK],
}

impl Buffers {
    pub(super) fn new() -> Box<Self> {
        let zeros = [0.0; CHUNK];
        Box::new(Self { angles: zeros, sines: zeros, cosines: zeros, terms: [zeros; 3], zeros })
    }

    /// Computes the pins of a chunk of angles.
    pub(super) fn load(&mut self, angles: &[f64], level: Level) {
        let length = angles.len();
        self.angles[..length].copy_from_slice(angles);
        self.turn(length, level);
    }

    /// Computes the pins of a chunk of a sweep.
    pub(super) fn load_sweep(&mut self, sweep: &Sweep, first: usize, length: usize, level: Level) {
        let angles = &mut self.angles[..length];
        compiled_for!(level, {
            for (i, angle) in angles.iter_mut().enumerate() {
                *angle = sweep.angle(sample_number(first, i)).value();
            }
        });
        self.turn(length, level);
    }

    fn turn(&mut self, length: usize, level: Level) {
        let angles = &self.angles[..length];
        let (sines, cosines) = (&mut self.sines[..length], &mut self.cosines[..length]);
        let too_large = compiled_for!(level, pins(angles, sines, cosines));
        if too_large {
            let (sines, cosines) = (&mut self.sines[..length], &mut self.cosines[..length]);
            for ((&angle, s), c) in angles.iter().zip(sines).zip(cosines) {
                (*s, *c) = trig::sin_cos(angle);
            }
        }
    }

    /// The weighted sum of speed, acceleration and jerk ratios, and its derivative by `q`.
    pub(super) fn rates(
        &mut self,
        shaft: &ShaftConstants,
        [ratio, acceleration, jerk]: [Option<&[f64]>; 3],
        length: usize,
        level: Level,
    ) -> [f64; 3] {
        let zeros = &self.zeros[..length];
        let input = Pins { sines: &self.sines[..length], cosines: &self.cosines[..length] };
        let weights = [ratio, acceleration, jerk].map(|weights| weights.unwrap_or(zeros));
        let terms = self.terms.each_mut().map(|terms| &mut terms[..length]);
        if jerk.is_some() {
            compiled_for!(level, rate_terms::<true>(shaft, input, weights, terms));
        } else {
            compiled_for!(level, rate_terms::<false>(shaft, input, weights, terms));
        }
        self.sum(length, level)
    }

    /// The weighted sum of angle errors, or of angles, and its derivative by `q`.
    pub(super) fn errors(
        &mut self,
        shaft: &ShaftConstants,
        weights: &[f64],
        with_drive: bool,
        level: Level,
    ) -> [f64; 3] {
        let length = weights.len();
        let drive = if with_drive { &self.angles } else { &self.zeros };
        let input = Pins { sines: &self.sines[..length], cosines: &self.cosines[..length] };
        let terms = self.terms.each_mut().map(|terms| &mut terms[..length]);
        compiled_for!(level, error_terms(shaft, input, &drive[..length], weights, terms));
        self.sum(length, level)
    }

    fn sum(&self, length: usize, level: Level) -> [f64; 3] {
        let terms = self.terms.each_ref().map(|terms| &terms[..length]);
        compiled_for!(level, terms.map(total))
    }
}

#[derive(Clone, Copy)]
struct Pins<'a> {
    sines: &'a [f64],
    cosines: &'a [f64],
}

impl Pins<'_> {
    /// The first pins, whose number the loops then know.
    #[inline(always)]
    fn first(&self, length: usize) -> Self {
        Self { sines: &self.sines[..length], cosines: &self.cosines[..length] }
    }

    /// Sine and cosine of the equivalent joint's input angle.
    #[inline(always)]
    fn turned(&self, i: usize, [turn_cos, turn_sin]: [f64; 2]) -> (f64, f64) {
        let (s, c) = (self.sines[i], self.cosines[i]);
        (s.mul_add(turn_cos, c * turn_sin), c.mul_add(turn_cos, -(s * turn_sin)))
    }
}

/// Fills in the pins; returns whether an angle is too large for that, or not a number.
#[inline(always)]
fn pins(angles: &[f64], sines: &mut [f64], cosines: &mut [f64]) -> bool {
    let mut too_large = LargeAngleFlag::for_quadrants();
    for ((&angle, s), c) in angles.iter().zip(sines).zip(cosines) {
        let reduced = <f64 as Angle>::reduce(angle);
        too_large.accumulate(reduced.1);
        (*s, *c) = trig::pin::<f64>(reduced);
    }
    too_large.any()
}

#[inline(always)]
fn rate_terms<const JERK: bool>(
    shaft: &ShaftConstants,
    pins: Pins<'_>,
    [ratios, accelerations, jerks]: [&[f64]; 3],
    [values, reals, imaginaries]: [&mut [f64]; 3],
) {
    let ShaftConstants { cosine: e, sine2, mean, turn, .. } = *shaft;
    let length = values.len();
    let pins = pins.first(length);
    let (ratios, accelerations) = (&ratios[..length], &accelerations[..length]);
    let (jerks, reals) = (&jerks[..length], &mut reals[..length]);
    let imaginaries = &mut imaginaries[..length];
    for i in 0..length {
        let (s, c) = pins.turned(i, turn);
        let (s2, product, ec) = (s * s, s * c, e * c);
        let inverse = ec.mul_add(ec, s2).recip();
        let scale = c.mul_add(c, s2) * inverse;
        let (x, y) = (e * scale, -(sine2 * product) * inverse);
        // W, up to the factor ((1 + e)/2)² that follows below.
        let w = scale * inverse;
        let (w_re, w_im) = (w * ec.mul_add(ec, -s2), w * (-2.0 * e * product));
        let (weight, by_square) = (ratios[i], accelerations[i]);
        let mut value = weight.mul_add(x, by_square * (2.0 * x * y));
        // −2 ratio weight + 4i ρ acceleration weight.
        let mut re = (-4.0 * y).mul_add(by_square, -2.0 * weight);
        let mut im = (4.0 * x) * by_square;
        if JERK {
            let (square_re, square_im) = (x.mul_add(x, -(y * y)), 2.0 * x * y);
            // 2 Re ρ (1 − ρ²) with 1 − ρ² = −sin² β ψ².
            let jerk = -2.0 * sine2 * x.mul_add(w_re, -(y * w_im));
            value = jerks[i].mul_add(jerk, value);
            re = (4.0 * jerks[i]).mul_add(square_re.mul_add(3.0, -1.0), re);
            im = (12.0 * jerks[i]).mul_add(square_im, im);
        }
        let factor = mean * mean;
        values[i] = value;
        reals[i] = factor * re.mul_add(w_re, -(im * w_im));
        imaginaries[i] = factor * re.mul_add(w_im, im * w_re);
    }
}

#[inline(always)]
fn error_terms(
    shaft: &ShaftConstants,
    pins: Pins<'_>,
    drive: &[f64],
    weights: &[f64],
    [values, reals, imaginaries]: [&mut [f64]; 3],
) {
    let ShaftConstants { cosine: e, versine, mean, turn, .. } = *shaft;
    let length = values.len();
    let pins = pins.first(length);
    let (drive, weights) = (&drive[..length], &weights[..length]);
    let (reals, imaginaries) = (&mut reals[..length], &mut imaginaries[..length]);
    for i in 0..length {
        let (s, c) = pins.turned(i, turn);
        let (s2, product, ec) = (s * s, s * c, e * c);
        let norm = ec.mul_add(ec, s2);
        let along = ec.mul_add(c, s2);
        values[i] = weights[i] * (drive[i] + f64::atan_any(versine * product, along));
        // −i (1 + e)/2 (c − i s)(e c − i s)/norm.
        let scale = mean * weights[i] / norm;
        reals[i] = -scale * ((1.0 + e) * product);
        imaginaries[i] = -scale * ec.mul_add(c, -s2);
    }
}

/// The sum of the terms, in an order that depends on their number only.
#[inline(always)]
fn total(terms: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    let (blocks, rest) = terms.as_chunks::<LANES>();
    for block in blocks {
        for (lane, term) in lanes.iter_mut().zip(block) {
            *lane += term;
        }
    }
    for (lane, term) in lanes.iter_mut().zip(rest) {
        *lane += term;
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
