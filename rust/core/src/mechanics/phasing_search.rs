//! The search for the smallest change of the turns of a polygon that closes it.
#![allow(clippy::needless_range_loop, reason = "rows of one length, without checks of bounds")]

use std::f64::consts::FRAC_PI_2;

use nalgebra::Complex;

use crate::mechanics::phasing::{Polygon, is_set, within_half_a_turn};
use crate::number::trig::{self, Angle};

/// The most settings that a search looks at, and the most halvings of a step; most need ten.
const SETTINGS: usize = 120;
const HALVINGS: usize = 12;

/// A polygon with a gap up to this is closed.
pub(crate) const CLOSED: f64 = 1e-12;

/// Sizes of changes that differ by less than this part are equal; the first of them is taken.
pub(crate) const EQUAL: f64 = 1e-9;

/// A polygon that a step up to this, in rad, would close is nearly closed.
const NEARLY: f64 = 1e-2;

/// The longest step, in rad.
const LONGEST: f64 = 1.0;

/// A step up to this, in rad, tells how small the change becomes.
const NEAR: f64 = 0.05;

/// A step of Newton's method up to this, in rad, is the last: what it leaves is its square.
const LAST: f64 = 1e-5;

/// The search for the smallest change that closes a polygon.
///
/// The map `w → A w + B w̄` up to some point of the chain puts that point at the vector `s = 2 Ā B` of
/// length `sinh d`, `d` its distance from the first; `c = |A|² + |B|²` is `cosh d`. A turn moves
/// everything behind it about its vertex, and the last point by `ds = 2i (c S − s C)`, where `S` and
/// `C` belong to the vertex. The polygon is closed where the gap `s/2i` vanishes.
///
/// A change is kept as `y`, the change of each turn over the root of its weight, so that its size is
/// the sum of the squares of `y`. Rows may be longer than the polygon has turns; the others do
/// nothing.
pub(crate) struct ClosingSearch<'a, R, M> {
    polygon: &'a Polygon<'a>,
    turns: R,
    /// Root of each weight, and its inverse; zero where there is no turn.
    roots: R,
    inverse_roots: R,
    /// Hyperbolic cosine of the side behind each turn.
    cosh: R,
    sinh: R,
    cosine: R,
    sine: R,
    /// `S` and `C` of each vertex.
    vertices: [R; 3],
    /// An orthonormal basis of the changes that move the last point.
    across: [R; 2],
    /// The setting looked at, `y`.
    trial: R,
    /// The last setting that was accepted, and the step from there.
    from: R,
    step: R,
    /// The same of the step that closes the polygon.
    open: R,
    closing: R,
    /// `e` and `f` of the second derivatives.
    bent: [R; 2],
    /// Second derivatives times the basis.
    along: [R; 2],
    factors: M,
    pivots: R,
    /// The smallest so far, and its size.
    best: R,
    best_size: f64,
}

/// How the last point follows the changes.
#[derive(Clone, Copy, Default)]
struct Linear {
    gap: Complex<f64>,
    /// The multiplier with which the gap has the slope of half the size.
    multiplier: Complex<f64>,
    /// The smallest change that closes the polygon but for second-order terms, on the basis.
    closing: [f64; 2],
    /// The change itself on the basis.
    own: [f64; 2],
}

impl Linear {
    /// The length of the closing step.
    #[inline(always)]
    fn off(&self) -> f64 {
        let [c0, c1] = self.closing;
        (c0 * c0 + c1 * c1).sqrt()
    }
}

impl<'a, R: AsRef<[f64]> + AsMut<[f64]> + Clone, M: AsMut<[R]>> ClosingSearch<'a, R, M> {
    /// A search with rows like the given one, which is zero and as long as the polygon has turns or
    /// longer.
    #[inline(always)]
    pub(crate) fn new(polygon: &'a Polygon<'a>, row: R, factors: M) -> Self {
        let pair = || [row.clone(), row.clone()];
        let [mut turns, mut roots] = pair();
        let [mut inverse_roots, mut cosh] = pair();
        let [mut sinh, mut cosine] = pair();
        cosh.as_mut().fill(1.0);
        cosine.as_mut().fill(1.0);
        for (j, side) in polygon.sides[1..].iter().enumerate() {
            turns.as_mut()[j] = polygon.turns[j];
            roots.as_mut()[j] = polygon.weights[j].sqrt();
            inverse_roots.as_mut()[j] = 1.0 / roots.as_ref()[j];
            cosh.as_mut()[j] = side.cosh;
            sinh.as_mut()[j] = side.sinh;
        }
        Self {
            polygon,
            turns,
            roots,
            inverse_roots,
            cosh,
            sinh,
            cosine,
            sine: row.clone(),
            vertices: [row.clone(), row.clone(), row.clone()],
            across: pair(),
            trial: row.clone(),
            from: row.clone(),
            step: row.clone(),
            open: row.clone(),
            closing: row.clone(),
            bent: pair(),
            along: pair(),
            factors,
            pivots: row.clone(),
            best: row,
            best_size: f64::INFINITY,
        }
    }

    /// Takes a change to the smallest nearby that closes the polygon, but for the rounding of plain
    /// sines.
    ///
    /// A step of Newton's method closes the polygon and goes along the closed ones at once. It is
    /// halved until what closing it leaves is smaller than before. Where the closing step shrinks
    /// fast, this comparison lacks digits, and the step holds.
    ///
    /// Returns whether the change may be smaller than the best one: a search that leads to that one
    /// or to a larger one ends before.
    #[inline(always)]
    pub(crate) fn descend(&mut self, change: &mut [f64]) -> bool {
        self.start(change);
        let (mut size, mut off) = (f64::INFINITY, f64::INFINITY);
        let (mut part, mut convex, mut halvings) = (1.0, false, 0);
        for _ in 0..SETTINGS {
            if is_set(self.polygon.stop) {
                break;
            }
            let linear = self.close(usize::MAX, plain_sin_cos, nearly_closed);
            let (new_size, new_off) = (self.size_when_closed(&linear), linear.off());
            let unknown = 10.0 * (off * off + new_off * new_off);
            let smaller = new_size <= size + unknown || convex && new_off <= 0.1 * off;
            if smaller && (new_off <= NEARLY || size == f64::INFINITY) {
                self.from.as_mut().copy_from_slice(self.trial.as_ref());
                (size, off) = (new_size, new_off);
                convex = self.find_step(&linear);
                let length = self.step.as_ref().iter().map(|x| x * x).sum::<f64>().sqrt();
                part = if length > LONGEST { LONGEST / length } else { 1.0 };
                halvings = 0;
                if convex && length < NEAR && self.leads_no_lower(&linear, size, length) {
                    return false;
                }
                if convex && length < LAST {
                    self.advance(part);
                    self.from.as_mut().copy_from_slice(self.trial.as_ref());
                    if !self.wrap() {
                        break;
                    }
                    (size, off, convex) = (f64::INFINITY, f64::INFINITY, false);
                    continue;
                }
            } else if halvings == HALVINGS {
                break;
            } else {
                part *= 0.5;
                halvings += 1;
            }
            self.advance(part);
        }
        let size: f64 = self.from.as_ref().iter().map(|y| y * y).sum();
        let found = self.from.as_ref().iter().zip(self.roots.as_ref());
        for (x, (y, root)) in change.iter_mut().zip(found) {
            *x = y * root;
        }
        size < self.best_size * (1.0 - EQUAL)
    }

    /// Remembers the last setting as the best one, unless its polygon is open.
    #[inline(always)]
    pub(crate) fn remember(&mut self, open: bool) {
        if !open {
            self.best.as_mut().copy_from_slice(self.trial.as_ref());
            self.best_size = self.trial.as_ref().iter().map(|y| y * y).sum();
        }
    }

    /// Whether a step so short that its square tells where it leads goes to the best change so far or
    /// to a larger one.
    #[inline(always)]
    fn leads_no_lower(&self, linear: &Linear, size: f64, length: f64) -> bool {
        let Linear { closing, own, .. } = linear;
        let settings = self.trial.as_ref().iter().zip(self.best.as_ref());
        let (mut gained, mut apart) = (closing[0] * own[0] + closing[1] * own[1], 0.0);
        let mut within = true;
        for (((y, best), step), root) in settings.zip(self.step.as_ref()).zip(self.roots.as_ref()) {
            gained -= y * step;
            apart += (y + step - best) * (y + step - best);
            within &= (y * root).abs() <= FRAC_PI_2;
        }
        let same = self.best_size < f64::INFINITY && apart < 0.25 * length * length;
        same || within && size - gained > self.best_size + length * length
    }

    /// Closes the polygon with all digits, and returns the gap, `sinh(L_E/2)`.
    #[inline(always)]
    pub(crate) fn close_exactly(&mut self, change: &mut [f64]) -> f64 {
        self.start(change);
        let linear = self.close(change.len(), trig::inlined_sin_cos, exactly_closed);
        let found = self.trial.as_ref().iter().zip(self.roots.as_ref());
        for (x, (y, root)) in change.iter_mut().zip(found) {
            *x = within_half_a_turn(y * root);
        }
        linear.gap.norm_sqr().sqrt()
    }

    /// Begins at a change.
    #[inline(always)]
    fn start(&mut self, change: &[f64]) {
        let inverse_roots = self.inverse_roots.as_ref();
        for (j, x) in change.iter().enumerate() {
            self.trial.as_mut()[j] = x * inverse_roots[j];
        }
        self.from.as_mut().copy_from_slice(self.trial.as_ref());
    }

    /// Goes part of the step.
    #[inline(always)]
    fn advance(&mut self, part: f64) {
        let steps = self.from.as_ref().iter().zip(self.step.as_ref());
        for (x, (from, step)) in self.trial.as_mut().iter_mut().zip(steps) {
            *x = from + part * step;
        }
    }

    /// Turns yokes that have turned past 90° half a turn back, which is nearer to the given ones.
    /// Returns whether there were any.
    #[inline(always)]
    fn wrap(&mut self) -> bool {
        let mut any = false;
        let roots = self.roots.as_ref().iter().zip(self.inverse_roots.as_ref());
        for (x, (root, inverse)) in self.trial.as_mut().iter_mut().zip(roots) {
            let turned = within_half_a_turn(*x * root) * inverse;
            any |= turned.abs() < x.abs() * (1.0 - EQUAL);
            *x = turned;
        }
        any
    }

    /// The size that a closing step would leave.
    #[inline(always)]
    fn size_when_closed(&self, linear: &Linear) -> f64 {
        let [c0, c1] = linear.closing;
        let (trial, [q0, q1]) = (self.trial.as_ref(), self.across.each_ref().map(AsRef::as_ref));
        let count = trial.len();
        let (q0, q1) = (&q0[..count], &q1[..count]);
        let mut size = 0.0;
        for j in 0..count {
            let x = trial[j] + q0[j] * c0 + q1[j] * c1;
            size += x * x;
        }
        size
    }

    /// Closes the polygon by Newton's method. Each step is the smallest that solves the linear
    /// equations, or a fraction of it.
    #[inline(always)]
    fn close(
        &mut self,
        most: usize,
        sin_cos: impl Fn(f64) -> (f64, f64) + Copy,
        enough: impl Fn(&Linear) -> bool,
    ) -> Linear {
        let mut linear = Linear { closing: [f64::INFINITY; 2], ..Linear::default() };
        let (mut gap, mut part, mut halvings) = (f64::INFINITY, 1.0, 0);
        for _ in 0..SETTINGS {
            let trial = self.look(most, sin_cos);
            let trial_gap = trial.gap.norm_sqr();
            if trial_gap < gap {
                (linear, gap, part, halvings) = (trial, trial_gap, 1.0, 0);
                if enough(&linear) {
                    return linear;
                }
                self.open.as_mut().copy_from_slice(self.trial.as_ref());
                let [c0, c1] = linear.closing;
                let [q0, q1] = self.across.each_ref().map(AsRef::as_ref);
                for (x, (q0, q1)) in self.closing.as_mut().iter_mut().zip(q0.iter().zip(q1)) {
                    *x = q0 * c0 + q1 * c1;
                }
            } else if halvings == HALVINGS || gap < CLOSED * CLOSED {
                // Rounding does not become smaller with the step.
                break;
            } else {
                part *= 0.5;
                halvings += 1;
            }
            let steps = self.open.as_ref().iter().zip(self.closing.as_ref());
            for (x, (open, step)) in self.trial.as_mut().iter_mut().zip(steps) {
                *x = open + part * step;
            }
        }
        self.trial.as_mut().copy_from_slice(self.open.as_ref());
        linear
    }

    /// The vertices, and the linear equations of the trial, with sines of so many turns at most.
    #[inline(always)]
    fn look(&mut self, most: usize, sin_cos: impl Fn(f64) -> (f64, f64)) -> Linear {
        let trial = self.trial.as_ref();
        let count = trial.len();
        let (roots, turns) = (&self.roots.as_ref()[..count], &self.turns.as_ref()[..count]);
        let (cosine, sine) = (&mut self.cosine.as_mut()[..count], &mut self.sine.as_mut()[..count]);
        for j in 0..count.min(most) {
            (sine[j], cosine[j]) = sin_cos(roots[j] * trial[j] + turns[j]);
        }
        let (cosh, sinh) = (&self.cosh.as_ref()[..count], &self.sinh.as_ref()[..count]);
        let [s_re, s_im, c] = self.vertices.each_mut().map(|row| &mut row.as_mut()[..count]);
        let first = &self.polygon.sides[0];
        let mut a = Complex::new(first.cosh, 0.0);
        let mut b = Complex::new(-first.sinh, 0.0);
        for j in 0..count {
            let s = a.conj() * b * 2.0;
            (s_re[j], s_im[j], c[j]) = (s.re, s.im, a.norm_sqr() + b.norm_sqr());
            let rotation = Complex::new(cosine[j], sine[j]);
            (a, b) = (a * rotation, b * rotation);
            (a, b) = (a * cosh[j] - b.conj() * sinh[j], b * cosh[j] - a.conj() * sinh[j]);
        }
        let (end, far) = (a.conj() * b * 2.0, a.norm_sqr() + b.norm_sqr());
        let gap = Complex::new(0.5 * end.im, -0.5 * end.re);
        // An orthonormal basis of the two rows of derivatives, the longer of which comes first.
        let [q0, q1] = self.across.each_mut().map(|row| &mut row.as_mut()[..count]);
        let (mut uu, mut uv, mut vv) = (0.0, 0.0, 0.0);
        for j in 0..count {
            let u = (s_re[j] * far - end.re * c[j]) * roots[j];
            let v = (s_im[j] * far - end.im * c[j]) * roots[j];
            (q0[j], q1[j]) = (u, v);
            uu += u * u;
            uv += u * v;
            vv += v * v;
        }
        let swapped = vv > uu;
        let (long, target) = if swapped { (vv, [gap.im, gap.re]) } else { (uu, [gap.re, gap.im]) };
        let inverse = |square: f64| if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
        let one = inverse(long);
        let along = uv * one * one;
        let (mut short, mut straight, mut turned) = (0.0, 0.0, 0.0);
        for j in 0..count {
            let (u, v) = if swapped { (q1[j], q0[j]) } else { (q0[j], q1[j]) };
            let v = v - along * u;
            (q0[j], q1[j]) = (u, v);
            short += v * v;
            straight += u * trial[j];
            turned += v * trial[j];
        }
        let other = inverse(short);
        for j in 0..count {
            (q0[j], q1[j]) = (q0[j] * one, q1[j] * other);
        }
        let own = [straight * one, turned * other];
        // A folded polygon can move in one direction only; the shift keeps the solution finite
        // there.
        let shifted = short + f64::EPSILON * long;
        let damped = if shifted > 0.0 { short * other / shifted } else { 0.0 };
        let closing = [-target[0] * one, (along * target[0] - target[1]) * damped];
        let last = own[1] * damped;
        let multiplier = [own[0] * one - along * last, last];
        let [re, im] = if swapped { [multiplier[1], multiplier[0]] } else { multiplier };
        Linear { gap, multiplier: Complex::new(re, im), closing, own }
    }

    /// Finds the step of Newton's method for the smallest change: the closing step, and one along
    /// the closed polygons. Returns whether the size is convex along them; where it is not, its
    /// second derivatives are increased until it is.
    ///
    /// The second derivatives of half the size, less those of the gap times its multiplier `ν`, are
    /// `1 + E` with `E_ij = e_i f_j` for `j ≤ i`, `e = −2 √w Im(ν̄ S)` and `f = √w C`. Projected
    /// along the closed polygons, and completed by the projection across them, they are
    /// `1 + E − q y' − y q'` with the basis `q`.
    #[inline(always)]
    fn find_step(&mut self, linear: &Linear) -> bool {
        let count = self.trial.as_ref().len();
        let Linear { multiplier, closing, own, .. } = *linear;
        let trial = &self.trial.as_ref()[..count];
        let roots = &self.roots.as_ref()[..count];
        let [s_re, s_im, c] = self.vertices.each_ref().map(|row| &row.as_ref()[..count]);
        let [q0, q1] = self.across.each_ref().map(|row| &row.as_ref()[..count]);
        let [e, f] = self.bent.each_mut().map(|row| &mut row.as_mut()[..count]);
        let [y0, y1] = self.along.each_mut().map(|row| &mut row.as_mut()[..count]);
        let step = &mut self.step.as_mut()[..count];
        let pivots = &mut self.pivots.as_mut()[..count];
        let factors = &mut self.factors.as_mut()[..count];
        let mut largest = 1.0;
        for j in 0..count {
            e[j] = -2.0 * roots[j] * (multiplier.re * s_im[j] - multiplier.im * s_re[j]);
            f[j] = roots[j] * c[j];
            largest = f64::max(largest, e[j].abs() * f[j]);
        }
        let mut before = [0.0; 2];
        for j in 0..count {
            before = [before[0] + f[j] * q0[j], before[1] + f[j] * q1[j]];
            (y0[j], y1[j]) = (q0[j] + e[j] * before[0], q1[j] + e[j] * before[1]);
        }
        let mut behind = [0.0; 2];
        let mut inner = [0.0; 3];
        for j in (0..count).rev() {
            (y0[j], y1[j]) = (y0[j] + f[j] * behind[0], y1[j] + f[j] * behind[1]);
            behind = [behind[0] + e[j] * q0[j], behind[1] + e[j] * q1[j]];
            inner[0] += q0[j] * y0[j];
            inner[1] += q1[j] * y0[j];
            inner[2] += q1[j] * y1[j];
        }
        let k0 = inner[0] * closing[0] + inner[1] * closing[1];
        let k1 = inner[1] * closing[0] + inner[2] * closing[1];
        for j in 0..count {
            // What the step along the closed polygons must undo.
            let curved = y0[j] * closing[0] + y1[j] * closing[1] - q0[j] * k0 - q1[j] * k1;
            step[j] = q0[j] * own[0] + q1[j] * own[1] - trial[j] - curved;
            y0[j] -= 0.5 * (inner[0] * q0[j] + inner[1] * q1[j] + q0[j]);
            y1[j] -= 0.5 * (inner[1] * q0[j] + inner[2] * q1[j] + q1[j]);
        }
        let (mut shift, mut more) = (0.0, 0.25 * largest);
        loop {
            let mut least = f64::INFINITY;
            for i in 0..count {
                let (done, rest) = factors.split_at_mut(i);
                let row = &mut rest[0].as_mut()[..count];
                for j in 0..=i {
                    let across = q0[i] * y0[j] + q1[i] * y1[j] + y0[i] * q0[j] + y1[i] * q1[j];
                    row[j] = e[i] * f[j] - across;
                }
                let mut pivot = row[i] + 1.0 + shift;
                for j in 0..i {
                    let other = &done[j].as_ref()[..count];
                    for k in 0..j {
                        row[j] -= row[k] * other[k];
                    }
                }
                for j in 0..i {
                    let scaled = row[j] * pivots[j];
                    pivot -= scaled * row[j];
                    row[j] = scaled;
                }
                least = f64::min(least, pivot);
                pivots[i] = 1.0 / pivot;
            }
            if least >= 1e-3 {
                break;
            }
            // The projection along the closed polygons, times the increase.
            for j in 0..count {
                y0[j] += 0.5 * more * q0[j];
                y1[j] += 0.5 * more * q1[j];
            }
            shift += more;
            more *= 2.0;
        }
        for i in 0..count {
            let row = &factors[i].as_ref()[..count];
            for k in 0..i {
                step[i] -= row[k] * step[k];
            }
        }
        for j in 0..count {
            step[j] *= pivots[j];
        }
        for i in (0..count).rev() {
            let row = &factors[i].as_ref()[..count];
            let scaled = step[i];
            for k in 0..i {
                step[k] -= row[k] * scaled;
            }
        }
        for j in 0..count {
            step[j] += q0[j] * closing[0] + q1[j] * closing[1];
        }
        shift == 0.0
    }
}

#[inline(always)]
fn nearly_closed(linear: &Linear) -> bool {
    linear.off() <= NEARLY
}

#[inline(always)]
fn exactly_closed(linear: &Linear) -> bool {
    linear.gap.norm_sqr() <= 1e-8 * CLOSED * CLOSED
}

/// Sine and cosine within an ulp, for angles up to some 1e12.
#[inline(always)]
fn plain_sin_cos(x: f64) -> (f64, f64) {
    trig::sin_cos_reduced(f64::reduce(x))
}
