//! Where the loops of the kernels put their results.

use crate::input::sweep::Sweep;
use crate::number::Number;
use crate::number::double_double::Pair;
use crate::number::float::{Real, Word};
use crate::number::storage::{View, ViewMut};
use crate::sincos::array::number;

/// Where a loop puts its results: a column of numbers, or words of a plane.
pub(crate) trait Out<T> {
    /// Where a part of them goes.
    type Part<'a>: Out<T>
    where
        Self: 'a;

    /// How many there are.
    fn room(&self) -> usize;

    /// A part of them.
    fn part(&mut self, start: usize, length: usize) -> Self::Part<'_>;

    /// Puts result `i`.
    fn put(&mut self, i: usize, number: T);
}

impl<T: Real> Out<T> for ViewMut<'_, T> {
    type Part<'a>
        = ViewMut<'a, T>
    where
        Self: 'a;

    #[inline(always)]
    fn room(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn part(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        self.window(start, length)
    }

    #[inline(always)]
    fn put(&mut self, i: usize, number: T) {
        self.set(i, number);
    }
}

impl<T: Real, W: Word> Out<T> for &mut [W] {
    type Part<'a>
        = &'a mut [W]
    where
        Self: 'a;

    #[inline(always)]
    fn room(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn part(&mut self, start: usize, length: usize) -> &mut [W] {
        &mut self[start..start + length]
    }

    #[inline(always)]
    fn put(&mut self, i: usize, number: T) {
        self[i] = W::near(number.value().into());
    }
}

/// Takes angle errors and puts angles: drive angle plus error.
pub(crate) struct AfterArray<'a, 'b, W>(pub(crate) &'a [f64], pub(crate) &'b mut [W]);

impl<'a, T: Number, W: Word> Out<T> for AfterArray<'a, '_, W> {
    type Part<'c>
        = AfterArray<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn room(&self) -> usize {
        self.1.len()
    }

    #[inline(always)]
    fn part(&mut self, start: usize, length: usize) -> AfterArray<'a, '_, W> {
        AfterArray(&self.0[start..start + length], &mut self.1[start..start + length])
    }

    #[inline(always)]
    fn put(&mut self, i: usize, error: T) {
        self.1[i] = error.after(Pair::exact(self.0[i]));
    }
}

/// The same for a sweep from this sample on.
pub(crate) struct AfterSweep<'a, 'b, W>(
    pub(crate) &'a Sweep,
    pub(crate) usize,
    pub(crate) &'b mut [W],
);

impl<'a, T: Number, W: Word> Out<T> for AfterSweep<'a, '_, W> {
    type Part<'c>
        = AfterSweep<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn room(&self) -> usize {
        self.2.len()
    }

    #[inline(always)]
    fn part(&mut self, start: usize, length: usize) -> AfterSweep<'a, '_, W> {
        AfterSweep(self.0, self.1 + start, &mut self.2[start..start + length])
    }

    #[inline(always)]
    fn put(&mut self, i: usize, error: T) {
        self.2[i] = error.after(self.0.angle(number(self.1, i)));
    }
}

/// The same from one angle of the sweep on, by the turns of whole steps.
pub(crate) struct AfterSteps<'a, 'b, W> {
    sweep: &'a Sweep,
    first: usize,
    begin: Pair,
    turns: View<'a, Pair>,
    out: &'b mut [W],
}

impl<'a, 'b, W> AfterSteps<'a, 'b, W> {
    /// From this sample on; parts may be as long as there are turns.
    #[inline(always)]
    pub(crate) fn new(
        sweep: &'a Sweep,
        first: usize,
        turns: View<'a, Pair>,
        out: &'b mut [W],
    ) -> Self {
        Self { sweep, first, begin: sweep.angle(first as f64), turns, out }
    }
}

impl<'a, T: Number, W: Word> Out<T> for AfterSteps<'a, '_, W> {
    type Part<'c>
        = AfterSteps<'a, 'c, W>
    where
        Self: 'c;

    #[inline(always)]
    fn room(&self) -> usize {
        self.out.len()
    }

    #[inline(always)]
    fn part(&mut self, start: usize, length: usize) -> AfterSteps<'a, '_, W> {
        let out = &mut self.out[start..start + length];
        AfterSteps::new(self.sweep, self.first + start, self.turns.cut(length), out)
    }

    #[inline(always)]
    fn put(&mut self, i: usize, error: T) {
        self.out[i] = error.after(self.begin + self.turns.get(i));
    }
}
