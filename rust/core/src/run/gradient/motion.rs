//! Sums over the samples of the motion of one shaft, in vectorised loops.
//!
//! The formulas are those of [`super::sample`] for an unnormalised sine `s` and cosine `c` of the
//! equivalent joint's input angle, as [`crate::number::trig::pin`] returns them. With `n = s² + c²`,
//! `D = e² c² + s²`, `P = e² c² − s²`, `p = s c` and weights `a` of the speed ratio and `b = β D` of
//! the acceleration ratio, a sample adds (derived here)
//!
//! `e (n/D) (a − 2 sin² β p β)`
//!
//! to the value, and to the real and imaginary part of the derivative by `q`
//!
//! `−2 ((1 + e)/2)² (n/D²) (a P − p β [e² (6 − 2 e²) c² + (6 e² − 2) s²])`,
//! `4 e ((1 + e)/2)² (n/D²) (a p + β [n P − 2 sin² β p²])`.
//!
//! A loop adds up in registers what depends on the sample. The factors before it follow at the end.
#![allow(clippy::needless_range_loop, reason = "an iterator hides that its count is constant")]

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
pub(super) const LANES: usize = 8;

/// A number for each sample of a chunk.
pub(super) type Samples = [f64; CHUNK];

/// Weights of outputs that have none.
pub(super) const ZEROS: Samples = [0.0; CHUNK];

/// Fills in the angles of a chunk of a sweep.
pub(super) fn sweep_angles(sweep: &Sweep, first: usize, angles: &mut [f64], level: Level) {
    compiled_for!(level, {
        for (i, angle) in angles.iter_mut().enumerate() {
            *angle = sweep.angle(sample_number(first, i)).value();
        }
    });
}

/// The pins of a chunk, whose last row of [`LANES`] is filled up.
pub(super) struct ChunkPins {
    sines: Samples,
    cosines: Samples,
    length: usize,
}

impl ChunkPins {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self { sines: ZEROS, cosines: ZEROS, length: 0 })
    }

    /// Computes the pins of a chunk of angles.
    pub(super) fn turn(&mut self, angles: &[f64], level: Level) {
        self.length = angles.len();
        let Self { sines, cosines, .. } = self;
        find_sines(trig::pin, angles, sines, cosines, level);
    }

    /// The weighted sum of speed and acceleration ratios, and its derivative by `q`.
    pub(super) fn rates(
        &self,
        shaft: &ShaftConstants,
        weights: [Option<&[f64]>; 2],
        level: Level,
    ) -> [f64; 3] {
        let ShaftConstants { cosine: e, mean, .. } = *shaft;
        let sums = self.sum(
            weights,
            |rows| compiled_for!(level, (compact, _stores) => rate_sums(shaft, rows, compact)),
        );
        scaled(sums, [e, -2.0 * (mean * mean), 4.0 * e * (mean * mean)])
    }

    /// The same for jerk ratios.
    pub(super) fn jerks(&self, shaft: &ShaftConstants, weights: &[f64], level: Level) -> [f64; 3] {
        let ShaftConstants { sine2, mean, .. } = *shaft;
        let weights = [Some(weights), None];
        let sums = self.sum(
            weights,
            |rows| compiled_for!(level, (compact, _stores) => jerk_sums(shaft, rows, compact)),
        );
        let by_q = 4.0 * (mean * mean);
        scaled(sums, [-2.0 * sine2, by_q, by_q])
    }

    /// The same for angle errors, or for angles if there are drive angles.
    pub(super) fn errors(
        &self,
        shaft: &ShaftConstants,
        weights: &[f64],
        drive: Option<&[f64]>,
        level: Level,
    ) -> [f64; 3] {
        let ShaftConstants { cosine: e, mean, .. } = *shaft;
        let columns = [Some(weights), drive];
        let sums = self.sum(
            columns,
            |rows| compiled_for!(level, (compact, _stores) => error_sums(shaft, rows, compact)),
        );
        scaled(sums, [1.0, -mean * (1.0 + e), -mean])
    }

    /// The sums over whole rows of [`LANES`] samples, and over the row that the last samples begin.
    fn sum(
        &self,
        columns: [Option<&[f64]>; 2],
        over: impl Fn(PinRows<'_>) -> [f64; 3],
    ) -> [f64; 3] {
        let whole = self.length - self.length % LANES;
        let columns = columns.map(|column| column.unwrap_or(&ZEROS[..self.length]));
        let rows = |at: std::ops::Range<usize>, columns| {
            over(PinRows { sines: &self.sines[at.clone()], cosines: &self.cosines[at], columns })
        };
        let sums = rows(0..whole, columns.map(|column| &column[..whole]));
        if whole == self.length {
            return sums;
        }
        let last = columns.map(|column| filled(&column[whole..], 0.0));
        let rest = rows(whole..whole + LANES, last.each_ref().map(|column| &column[..]));
        [0, 1, 2].map(|i| sums[i] + rest[i])
    }
}

/// The row that the last samples begin.
fn filled(samples: &[f64], rest: f64) -> [f64; LANES] {
    let mut row = [rest; LANES];
    row[..samples.len()].copy_from_slice(samples);
    row
}

fn scaled(sums: [f64; 3], factors: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| sums[i] * factors[i])
}

/// Fills in sines and cosines in the form that `of_reduced` gives them, by whole rows of [`LANES`].
#[inline(always)]
pub(super) fn find_sines(
    of_reduced: impl Fn((f64, u64)) -> (f64, f64),
    angles: &[f64],
    sines: &mut [f64],
    cosines: &mut [f64],
    level: Level,
) {
    let whole = angles.len() - angles.len() % LANES;
    let mut rows = |at: usize, angles: &[f64]| {
        let out = at..at + angles.len();
        let (sines, cosines) = (&mut sines[out.clone()], &mut cosines[out]);
        let too_large = compiled_for!(level, (compact, _stores) => {
            fill_sines(&of_reduced, angles, sines, cosines, compact)
        });
        if too_large {
            for ((&angle, s), c) in angles.iter().zip(sines).zip(cosines) {
                (*s, *c) = trig::sin_cos(angle);
            }
        }
    };
    rows(0, &angles[..whole]);
    if let Some(&last) = angles[whole..].last() {
        rows(whole, &filled(&angles[whole..], last));
    }
}

/// Fills in sines and cosines of whole rows; returns whether an angle is too large for that, or not a
/// number.
#[inline(always)]
fn fill_sines(
    of_reduced: impl Fn((f64, u64)) -> (f64, f64),
    angles: &[f64],
    sines: &mut [f64],
    cosines: &mut [f64],
    compact: bool,
) -> bool {
    let mut too_large = [LargeAngleFlag::for_quadrants(); LANES];
    if compact {
        for i in 0..angles.len() {
            let reduced = <f64 as Angle>::reduce(angles[i]);
            too_large[0].accumulate(reduced.1);
            (sines[i], cosines[i]) = of_reduced(reduced);
        }
        return too_large[0].any();
    }
    for row in 0..angles.len() / LANES {
        let first = row * LANES;
        let at = first..first + LANES;
        cardan_memory::ask(angles, first + CHUNK);
        let angles = &angles[at.clone()];
        // Local numbers stay in registers: the compiler knows that nothing else reads them.
        let (mut s, mut c) = ([0.0; LANES], [0.0; LANES]);
        for i in 0..LANES {
            let reduced = <f64 as Angle>::reduce(angles[i]);
            too_large[i].accumulate(reduced.1);
            (s[i], c[i]) = of_reduced(reduced);
        }
        sines[at.clone()].copy_from_slice(&s);
        cosines[at].copy_from_slice(&c);
    }
    too_large.into_iter().any(LargeAngleFlag::any)
}

/// Sine and cosine of an equivalent joint's input angle.
#[inline(always)]
pub(super) fn turned(s: f64, c: f64, [turn_cos, turn_sin]: [f64; 2]) -> (f64, f64) {
    (s.mul_add(turn_cos, c * turn_sin), c.mul_add(turn_cos, -(s * turn_sin)))
}

#[inline(always)]
fn rate_sums(shaft: &ShaftConstants, rows: PinRows<'_>, compact: bool) -> [f64; 3] {
    let ShaftConstants { cosine: e, sine2, turn, .. } = *shaft;
    let (e2, twice) = (e * e, 2.0 * sine2);
    let (by_c2, by_s2) = (e2 * (-2.0_f64).mul_add(e2, 6.0), 6.0_f64.mul_add(e2, -2.0));
    rows.sum(
        compact,
        #[inline(always)]
        |s, c, [a, b]| {
            let (s, c) = turned(s, c, turn);
            let (s2, c2, product) = (s * s, c * c, s * c);
            let inverse = e2.mul_add(c2, s2).recip();
            let (length, difference) = (s2 + c2, e2.mul_add(c2, -s2));
            let (beta, scale) = (b * inverse, length * inverse);
            let (scale_of_q, loss) = (scale * inverse, twice * product);
            let coupled = product * beta;
            let value = (-twice).mul_add(coupled, a);
            let re = a.mul_add(difference, -(coupled * by_c2.mul_add(c2, by_s2 * s2)));
            let bracket = length.mul_add(difference, -(loss * product));
            let im = a.mul_add(product, beta * bracket);
            [(scale, value), (scale_of_q, re), (scale_of_q, im)]
        },
    )
}

/// The jerk ratio is `−2 sin² β Re ρψ²`.
#[inline(always)]
fn jerk_sums(shaft: &ShaftConstants, rows: PinRows<'_>, compact: bool) -> [f64; 3] {
    let ShaftConstants { cosine: e, sine2, turn, .. } = *shaft;
    rows.sum(
        compact,
        #[inline(always)]
        |s, c, [weight, _]| {
            let (s, c) = turned(s, c, turn);
            let (s2, product, ec) = (s * s, s * c, e * c);
            let inverse = ec.mul_add(ec, s2).recip();
            let scale = c.mul_add(c, s2) * inverse;
            let (x, y) = (e * scale, -(sine2 * product) * inverse);
            let w = scale * inverse;
            let (w_re, w_im) = (w * ec.mul_add(ec, -s2), w * (-2.0 * e * product));
            let (square_re, square_im) = (x.mul_add(x, -(y * y)), 2.0 * x * y);
            let (re, im) = (3.0_f64.mul_add(square_re, -1.0), 3.0 * square_im);
            let (by_re, by_im) = (re.mul_add(w_re, -(im * w_im)), re.mul_add(w_im, im * w_re));
            [(weight, x.mul_add(w_re, -(y * w_im))), (weight, by_re), (weight, by_im)]
        },
    )
}

/// The derivative of the angle error is `−i (1 + e)/2 (c − i s)(e c − i s)/D`.
#[inline(always)]
fn error_sums(shaft: &ShaftConstants, rows: PinRows<'_>, compact: bool) -> [f64; 3] {
    let ShaftConstants { cosine: e, versine, turn, .. } = *shaft;
    rows.sum(
        compact,
        #[inline(always)]
        |s, c, [weight, drive]| {
            let (s, c) = turned(s, c, turn);
            let (s2, product, ec) = (s * s, s * c, e * c);
            let scale = weight / ec.mul_add(ec, s2);
            let angle = drive + f64::atan_any(versine * product, ec.mul_add(c, s2));
            [(weight, angle), (scale, product), (scale, ec.mul_add(c, -s2))]
        },
    )
}

/// Whole rows of [`LANES`] samples: their pins, and two numbers of each.
#[derive(Clone, Copy)]
struct PinRows<'a> {
    sines: &'a [f64],
    cosines: &'a [f64],
    columns: [&'a [f64]; 2],
}

impl PinRows<'_> {
    /// The sums of three products per sample, whose order depends on the number of samples only.
    #[inline(always)]
    fn sum(self, compact: bool, terms: impl Fn(f64, f64, [f64; 2]) -> [(f64, f64); 3]) -> [f64; 3] {
        let Self { sines, cosines, columns: [first, second] } = self;
        let mut lanes = [[0.0; LANES]; 3];
        if compact {
            for i in 0..sines.len() {
                let products = terms(sines[i], cosines[i], [first[i], second[i]]);
                for (lanes, (a, b)) in lanes.iter_mut().zip(products) {
                    lanes[i % LANES] = a.mul_add(b, lanes[i % LANES]);
                }
            }
            return lanes.map(total);
        }
        for row in 0..sines.len() / LANES {
            let at = row * LANES..(row + 1) * LANES;
            // The machine's own requests come too late for the next chunk.
            cardan_memory::ask(first, at.start + CHUNK);
            cardan_memory::ask(second, at.start + CHUNK);
            let (sines, cosines) = (&sines[at.clone()], &cosines[at.clone()]);
            let (first, second) = (&first[at.clone()], &second[at]);
            for i in 0..LANES {
                let products = terms(sines[i], cosines[i], [first[i], second[i]]);
                for (lanes, (a, b)) in lanes.iter_mut().zip(products) {
                    lanes[i] = a.mul_add(b, lanes[i]);
                }
            }
        }
        lanes.map(total)
    }
}

/// The sum of the lanes.
#[inline(always)]
pub(super) fn total([a, b, c, d, e, f, g, h]: [f64; LANES]) -> f64 {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
