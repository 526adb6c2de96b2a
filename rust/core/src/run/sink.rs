//! Where the loops of the kernels put their results.

use crate::input::sweep::Sweep;
use crate::number::Number;
use crate::number::double_double::DoubleDouble;
use crate::number::float::{Float, Real};
use crate::number::storage::{View, ViewMut};
use crate::sincos::array::number;

/// Where a loop puts its results: a column of numbers, words of a plane, or several of these.
pub(crate) trait Sink<T> {
    /// Where a part of them goes.
    type Slice<'a>: Sink<T>
    where
        Self: 'a;

    /// How many there are.
    fn length(&self) -> usize;

    /// A part of them.
    fn slice(&mut self, start: usize, length: usize) -> Self::Slice<'_>;

    /// Puts result `i`.
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

/// Takes angle errors and puts angles: drive angle plus error.
pub(crate) struct AfterArray<'a, 'b, W>(pub(crate) &'a [f64], pub(crate) &'b mut [W]);

impl<'a, T: Number, W: Float> Sink<T> for AfterArray<'a, '_, W> {
    type Slice<'c>
        = AfterArray<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn length(&self) -> usize {
        self.1.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> AfterArray<'a, '_, W> {
        AfterArray(&self.0[start..start + length], &mut self.1[start..start + length])
    }

    #[inline(always)]
    fn store(&mut self, i: usize, error: T) {
        self.1[i] = error.after(DoubleDouble::exact(self.0[i]));
    }
}

/// The same for a sweep from this sample on.
pub(crate) struct AfterSweep<'a, 'b, W>(
    pub(crate) &'a Sweep,
    pub(crate) usize,
    pub(crate) &'b mut [W],
);

impl<'a, T: Number, W: Float> Sink<T> for AfterSweep<'a, '_, W> {
    type Slice<'c>
        = AfterSweep<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn length(&self) -> usize {
        self.2.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> AfterSweep<'a, '_, W> {
        AfterSweep(self.0, self.1 + start, &mut self.2[start..start + length])
    }

    #[inline(always)]
    fn store(&mut self, i: usize, error: T) {
        self.2[i] = error.after(self.0.angle(number(self.1, i)));
    }
}

/// The same from one angle of the sweep on, by the turns of whole steps.
pub(crate) struct AfterSteps<'a, 'b, W> {
    sweep: &'a Sweep,
    first: usize,
    begin: DoubleDouble,
    turns: View<'a, DoubleDouble>,
    out: &'b mut [W],
}

impl<'a, 'b, W> AfterSteps<'a, 'b, W> {
    /// From this sample on; parts may be as long as there are turns.
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

impl<'a, T: Number, W: Float> Sink<T> for AfterSteps<'a, '_, W> {
    type Slice<'c>
        = AfterSteps<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn length(&self) -> usize {
        self.out.len()
    }

    #[inline(always)]
    fn slice(&mut self, start: usize, length: usize) -> AfterSteps<'a, '_, W> {
        let out = &mut self.out[start..start + length];
        AfterSteps::new(self.sweep, self.first + start, self.turns.cut(length), out)
    }

    #[inline(always)]
    fn store(&mut self, i: usize, error: T) {
        self.out[i] = error.after(self.begin + self.turns.get(i));
    }
}
