//! Columns of numbers: a slice of words, or one of high and one of low words.

use std::ops::Range;

use crate::number::float::Real;

/// Bytes of a cache line: vectors that cross one take twice as long to load and to store.
const LINE: usize = 64;

/// Lines between high and low words, so that they do not lie whole pages apart: a load that follows a
/// store to the same place of another page waits for it.
const APART: usize = 20;

/// Lines of high words that are nowhere near a page, so that nothing need lie between.
const FEW: usize = 4;

/// A column of its own.
#[derive(Clone, Debug)]
pub(crate) struct Column<T: Real> {
    /// High words from the first cache line on, then low words from another.
    words: Vec<T::Float>,
    first: usize,
    length: usize,
}

impl<T: Real> Column<T> {
    const EMPTY: Self = Self { words: vec![], first: 0, length: 0 };

    pub(crate) fn new(length: usize) -> Self {
        if length == 0 {
            return Self::EMPTY;
        }
        let line = LINE / size_of::<T::Float>();
        let words = vec![T::Float::default(); Self::low_after(length) + length + line];
        let first = words.as_ptr().align_offset(LINE).min(line);
        Self { words, first, length }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.length == 0
    }

    pub(crate) fn len(&self) -> usize {
        self.length
    }

    /// How far behind the first high word the first low word lies.
    fn low_after(length: usize) -> usize {
        let line = LINE / size_of::<T::Float>();
        let lines = length.div_ceil(line);
        let between = if lines <= FEW { 0 } else { APART };
        if T::LOW { (lines + between) * line } else { 0 }
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
        let start = if start + length <= self.length { start } else { 0 };
        let length = length.min(self.length);
        self.part_mut(start, length)
    }

    /// Numbers from `start` on, to read.
    #[inline(always)]
    pub(crate) fn part(&self, start: usize, length: usize) -> View<'_, T> {
        let first = self.first + start;
        let from = first + Self::low_after(self.length);
        let low = low::<T>(from..from + length);
        View { high: &self.words[first..first + length], low: &self.words[low] }
    }

    /// Numbers from `start` on, to write.
    #[inline(always)]
    pub(crate) fn part_mut(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        let first = self.first + start;
        let (high, rest) = self.words[first..].split_at_mut(length);
        let from = Self::low_after(self.length).saturating_sub(length);
        ViewMut { high, low: &mut rest[low::<T>(from..from + length)] }
    }
}

/// Columns of the same length.
#[inline(always)]
pub(crate) fn columns<T: Real, const N: usize>(length: usize) -> [Column<T>; N] {
    let mut columns = [const { Column::EMPTY }; N];
    if length > 0 {
        for column in &mut columns {
            *column = Column::new(length);
        }
    }
    columns
}

// A loop leaves out its checks if it sees that all that it touches is as long as it runs, and the standard
// `map` of an array is a call of its own that hides it: these go view by view, and a loop cuts what it
// writes to the length of what it reads.

/// The first numbers of several columns, to read.
#[inline(always)]
pub(crate) fn views<T: Real, const N: usize>(
    columns: &[Column<T>; N],
    length: usize,
) -> [View<'_, T>; N] {
    let mut views = [View::EMPTY; N];
    for (view, column) in views.iter_mut().zip(columns) {
        *view = column.view(length).cut(length);
    }
    views
}

/// Numbers of several columns from `start` on, to write.
#[inline(always)]
pub(crate) fn views_mut<T: Real, const N: usize>(
    columns: &mut [Column<T>; N],
    start: usize,
    length: usize,
) -> [ViewMut<'_, T>; N] {
    let mut views: [_; N] = std::array::from_fn(|_| ViewMut { high: &mut [], low: &mut [] });
    for (view, column) in views.iter_mut().zip(columns) {
        *view = column.part_mut(start, length);
    }
    views
}

/// The range of the low words.
#[inline(always)]
fn low<T: Real>(range: Range<usize>) -> Range<usize> {
    if T::LOW { range } else { 0..0 }
}

/// A part of a column to read.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, T: Real> {
    high: &'a [T::Float],
    low: &'a [T::Float],
}

impl<'a, T: Real> View<'a, T> {
    pub(crate) const EMPTY: Self = Self { high: &[], low: &[] };

    /// The first numbers: loops cut what they read to the length of what they write.
    #[inline(always)]
    pub(crate) fn cut(self, length: usize) -> Self {
        Self { high: &self.high[..length], low: &self.low[low::<T>(0..length)] }
    }

    /// A part of it.
    #[inline(always)]
    pub(crate) fn part(self, start: usize, length: usize) -> View<'a, T> {
        let low = low::<T>(start..start + length);
        View { high: &self.high[start..start + length], low: &self.low[low] }
    }

    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.high.len()
    }

    #[inline(always)]
    pub(crate) fn get(&self, i: usize) -> T {
        T::from_words(self.high[i], if T::LOW { self.low[i] } else { T::Float::default() })
    }
}

/// A part of a column to write.
pub(crate) struct ViewMut<'a, T: Real> {
    high: &'a mut [T::Float],
    low: &'a mut [T::Float],
}

impl<T: Real> ViewMut<'_, T> {
    /// The first numbers.
    #[inline(always)]
    pub(crate) fn cut(self, length: usize) -> Self {
        Self { high: &mut self.high[..length], low: &mut self.low[low::<T>(0..length)] }
    }

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
        T::from_words(self.high[i], if T::LOW { self.low[i] } else { T::Float::default() })
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, i: usize, number: T) {
        let [high, low] = number.words();
        self.high[i] = high;
        if T::LOW {
            self.low[i] = low;
        }
    }

    /// Only the high word; the low one is left as it is.
    #[inline(always)]
    pub(crate) fn set_high(&mut self, i: usize, number: T) {
        let [high, _] = number.words();
        self.high[i] = high;
    }

    /// The high word by itself.
    #[inline(always)]
    pub(crate) fn get_high(&self, i: usize) -> T {
        T::from_words(self.high[i], T::Float::default())
    }

    #[inline(always)]
    pub(crate) fn is_empty(&self) -> bool {
        self.high.is_empty()
    }

    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.high.len()
    }
}
