//! Columns of numbers: a slice of words, or one of high and one of low words.

use std::ops::Range;

use crate::real::Real;

/// A column of its own.
#[derive(Clone, Debug)]
pub(crate) struct Column<T: Real> {
    high: Vec<T::Word>,
    low: Vec<T::Word>,
}

impl<T: Real> Column<T> {
    pub(crate) fn new(length: usize) -> Self {
        let words = |length| vec![T::Word::default(); length];
        Self { high: words(length), low: words(low::<T>(0..length).len()) }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.high.is_empty()
    }

    /// The first numbers, to read.
    #[inline(always)]
    pub(crate) fn view(&self, length: usize) -> View<'_, T> {
        self.part(0, length)
    }

    /// The first numbers, to write.
    #[inline(always)]
    pub(crate) fn view_mut(&mut self, length: usize) -> ViewMut<'_, T> {
        self.part_mut(0, length)
    }

    /// Numbers from `start` on, or the first ones of a column that is too short to hold them.
    #[inline(always)]
    pub(crate) fn window_mut(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        let start = if start + length <= self.high.len() { start } else { 0 };
        let length = length.min(self.high.len());
        self.part_mut(start, length)
    }

    /// Numbers from `start` on, to read.
    #[inline(always)]
    pub(crate) fn part(&self, start: usize, length: usize) -> View<'_, T> {
        let low = low::<T>(start..start + length);
        View { high: &self.high[start..start + length], low: &self.low[low] }
    }

    /// Numbers from `start` on, to write.
    #[inline(always)]
    pub(crate) fn part_mut(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        let low = low::<T>(start..start + length);
        ViewMut { high: &mut self.high[start..start + length], low: &mut self.low[low] }
    }
}

/// The range of the low words.
#[inline(always)]
fn low<T: Real>(range: Range<usize>) -> Range<usize> {
    if T::LOW { range } else { 0..0 }
}

/// A part of a column to read.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, T: Real> {
    high: &'a [T::Word],
    low: &'a [T::Word],
}

impl<T: Real> View<'_, T> {
    /// The first numbers: loops cut what they read to the length of what they write.
    #[inline(always)]
    pub(crate) fn cut(self, length: usize) -> Self {
        Self { high: &self.high[..length], low: &self.low[low::<T>(0..length)] }
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> T {
        T::from_words(self.high[i], if T::LOW { self.low[i] } else { T::Word::default() })
    }
}

/// A part of a column to write.
pub(crate) struct ViewMut<'a, T: Real> {
    high: &'a mut [T::Word],
    low: &'a mut [T::Word],
}

impl<T: Real> ViewMut<'_, T> {
    /// A part of it.
    #[inline(always)]
    pub(crate) fn window(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        let low = low::<T>(start..start + length);
        ViewMut { high: &mut self.high[start..start + length], low: &mut self.low[low] }
    }

    /// The same part to read.
    #[inline(always)]
    pub(crate) fn view(&self) -> View<'_, T> {
        View { high: self.high, low: self.low }
    }

    /// The same part once more.
    #[inline(always)]
    pub(crate) fn again(&mut self) -> ViewMut<'_, T> {
        ViewMut { high: self.high, low: self.low }
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> T {
        T::from_words(self.high[i], if T::LOW { self.low[i] } else { T::Word::default() })
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, number: T) {
        let [high, low] = number.words();
        self.high[i] = high;
        if T::LOW {
            self.low[i] = low;
        }
    }

    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.high.len()
    }
}
