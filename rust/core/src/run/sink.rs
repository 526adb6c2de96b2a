//! Sinks: the destinations of the kernels' results.

use crate::input::sweep::Sweep;
use crate::number::Number;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::storage::{View, ViewMut};
use crate::sincos::array::sample_number;

/// The destination of a loop's results: a column of numbers, words of a plane, or several of these.
pub(crate) trait Sink<T> {
    /// The sink for a part of the results.
    type Slice<'a>: Sink<T>
    where
        Self: 'a;

    /// The number of results.
    fn length(&self) -> usize;

    /// The sink for `length` results from `start` on.
    fn slice(&mut self, start: usize, length: usize) -> Self::Slice<'_>;

    /// Stores result `i`.
    fn store(&mut self, i: usize, number: T);
}

impl<T: Real> Sink<T> for ViewMut<'_, T> {
    type Slice<'a>
        = ViewMut<'a, T>
    where
        Self: 'a;

    #[inline(always)]
    fn length(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        self.window(start, length)
    }

    #[inline(always)]
    fn store(&mut self, i: usize, number: T) {
        self.set(i, number);
    }
}

impl<T: Real, W: Float> Sink<T> for &mut [W] {
    type Slice<'a>
        = &'a mut [W]
    where
        Self: 'a;

    #[inline(always)]
    fn length(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> &mut [W] {
        &mut self[start..start + length]
    }

    #[inline(always)]
    fn store(&mut self, i: usize, number: T) {
        self[i] = W::near(number.value().into());
    }
}

impl<V, U, A: Sink<V>, B: Sink<U>> Sink<(V, U)> for (A, B) {
    type Slice<'a>
        = (A::Slice<'a>, B::Slice<'a>)
    where
        Self: 'a;

    #[inline(always)]
    fn length(&self) -> usize {
        self.0.length()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> Self::Slice<'_> {
        (self.0.slice(start, length), self.1.slice(start, length))
    }

    #[inline(always)]
    fn store(&mut self, i: usize, (first, second): (V, U)) {
        self.0.store(i, first);
        self.1.store(i, second);
    }
}

impl<V, S: Sink<V>> Sink<[V; 3]> for [S; 3] {
    type Slice<'a>
        = [S::Slice<'a>; 3]
    where
        Self: 'a;

    #[inline(always)]
    fn length(&self) -> usize {
        self[0].length()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> Self::Slice<'_> {
        let [x, y, z] = self;
        [x.slice(start, length), y.slice(start, length), z.slice(start, length)]
    }

    #[inline(always)]
    fn store(&mut self, i: usize, [along_x, along_y, along_z]: [V; 3]) {
        let [x, y, z] = self;
        x.store(i, along_x);
        y.store(i, along_y);
        z.store(i, along_z);
    }
}

/// Adds drive angles from an array to angle errors.
pub(crate) struct ArrayAngleSink<'a, 'b, W>(pub(crate) &'a [f64], pub(crate) &'b mut [W]);

impl<'a, T: Number, W: Float> Sink<T> for ArrayAngleSink<'a, '_, W> {
    type Slice<'c>
        = ArrayAngleSink<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn length(&self) -> usize {
        self.1.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> ArrayAngleSink<'a, '_, W> {
        ArrayAngleSink(&self.0[start..start + length], &mut self.1[start..start + length])
    }

    #[inline(always)]
    fn store(&mut self, i: usize, error: T) {
        self.1[i] = error.after(DoubleDouble::exact(self.0[i]));
    }
}

/// Adds the drive angles of a sweep, from this sample on, to angle errors.
pub(crate) struct SweepAngleSink<'a, 'b, W>(
    pub(crate) &'a Sweep,
    pub(crate) usize,
    pub(crate) &'b mut [W],
);

impl<'a, T: Number, W: Float> Sink<T> for SweepAngleSink<'a, '_, W> {
    type Slice<'c>
        = SweepAngleSink<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn length(&self) -> usize {
        self.2.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> SweepAngleSink<'a, '_, W> {
        SweepAngleSink(self.0, self.1 + start, &mut self.2[start..start + length])
    }

    #[inline(always)]
    fn store(&mut self, i: usize, error: T) {
        self.2[i] = error.after(self.0.angle(sample_number(self.1, i)));
    }
}

/// The same from one angle of the sweep and a table of the angles of whole steps.
pub(crate) struct SteppedAngleSink<'a, 'b, W> {
    sweep: &'a Sweep,
    first: usize,
    begin: DoubleDouble,
    turns: View<'a, DoubleDouble>,
    out: &'b mut [W],
}

impl<'a, 'b, W> SteppedAngleSink<'a, 'b, W> {
    /// Begins at sample `first`; slices may be as long as `turns`.
    #[inline(always)]
    pub(crate) fn new(
        sweep: &'a Sweep,
        first: usize,
        turns: View<'a, DoubleDouble>,
        out: &'b mut [W],
    ) -> Self {
        Self { sweep, first, begin: sweep.angle(first as f64), turns, out }
    }
}

impl<'a, T: Number, W: Float> Sink<T> for SteppedAngleSink<'a, '_, W> {
    type Slice<'c>
        = SteppedAngleSink<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn length(&self) -> usize {
        self.out.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> SteppedAngleSink<'a, '_, W> {
        let out = &mut self.out[start..start + length];
        SteppedAngleSink::new(self.sweep, self.first + start, self.turns.cut(length), out)
    }

    #[inline(always)]
    fn store(&mut self, i: usize, error: T) {
        self.out[i] = error.after(self.begin + self.turns.get(i));
    }
}
