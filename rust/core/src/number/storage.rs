//! Columns of numbers: one slice of words, or one slice of high words and one of low words.

use std::ops::Range;

use crate::number::float::Real;

/// Bytes of a cache line. Loading or storing a vector that crosses one takes twice as long.
const CACHE_LINE: usize = 64;

/// Cache lines between high and low words. They keep the two from being whole pages apart: a load
/// waits for an earlier store to the same offset in another page.
const PADDING_LINES: usize = 20;

/// Columns up to this number of cache lines are much shorter than a page and need no padding.
const SHORT_LINES: usize = 4;

/// A column that owns its words.
#[derive(Clone, Debug)]
pub(crate) struct Column<T: Real> {
    /// High words from the first cache-line boundary on, then low words from another boundary.
    words: Vec<T::Float>,
    first: usize,
    length: usize,
}

impl<T: Real> Column<T> {
    const EMPTY: Self = Self { words: vec![], first: 0, length: 0 };

    #[inline(always)]
    pub(crate) fn new(length: usize) -> Self {
        if length == 0 { Self::EMPTY } else { Self::allocated(length) }
    }

    /// It is not inlined, because a block has dozens of columns.
    #[inline(never)]
    fn allocated(length: usize) -> Self {
        let line = CACHE_LINE / size_of::<T::Float>();
        let count = Self::low_offset(length) + length + line;
        // Not `vec![0.0; count]`: memory that the allocator has to clear does not come from its
        // cache of freed pieces (glibc before 2.41), which costs a small call a tenth of its time.
        let mut words = Vec::with_capacity(count);
        words.resize(count, T::Float::default());
        let first = words.as_ptr().align_offset(CACHE_LINE).min(line);
        Self { words, first, length }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.length == 0
    }

    pub(crate) fn len(&self) -> usize {
        self.length
    }

    /// Offset of the first low word from the first high word.
    fn low_offset(length: usize) -> usize {
        let line = CACHE_LINE / size_of::<T::Float>();
        let lines = length.div_ceil(line);
        let between = if lines <= SHORT_LINES { 0 } else { PADDING_LINES };
        if T::LOW { (lines + between) * line } else { 0 }
    }

    /// The first `length` numbers, for reading.
    #[inline(always)]
    pub(crate) fn view(&self, length: usize) -> View<'_, T> {
        self.part(0, length)
    }

    /// The first `length` numbers, for writing.
    #[inline(always)]
    pub(crate) fn view_mut(&mut self, length: usize) -> ViewMut<'_, T> {
        self.part_mut(0, length)
    }

    /// `length` numbers from `start` on, for writing; a column that is too short gives all it has.
    #[inline(always)]
    pub(crate) fn window_mut(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        let start = if start + length <= self.length { start } else { 0 };
        let length = length.min(self.length);
        self.part_mut(start, length)
    }

    /// `length` numbers from `start` on, for reading.
    #[inline(always)]
    pub(crate) fn part(&self, start: usize, length: usize) -> View<'_, T> {
        let first = self.first + start;
        let from = first + Self::low_offset(self.length);
        let low = low::<T>(from..from + length);
        View { high: &self.words[first..first + length], low: &self.words[low] }
    }

    /// `length` numbers from `start` on, for writing.
    #[inline(always)]
    pub(crate) fn part_mut(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        let first = self.first + start;
        let (high, rest) = self.words[first..].split_at_mut(length);
        let from = Self::low_offset(self.length).saturating_sub(length);
        ViewMut { high, low: &mut rest[low::<T>(from..from + length)] }
    }
}

/// `N` columns of the same length.
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

// The compiler removes the bounds checks of a loop if it sees that every slice is as long as the
// loop. `map` on an array is a function call that hides this, so these functions loop over the
// views. Each loop cuts its output to the length of its input.

/// The first `length` numbers of several columns, for reading.
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

/// A part of several columns, for reading.
#[inline(always)]
pub(crate) fn parts<'a, T: Real, const N: usize>(
    columns: &[View<'a, T>; N],
    start: usize,
    length: usize,
) -> [View<'a, T>; N] {
    let mut parts = [View::EMPTY; N];
    for (part, column) in parts.iter_mut().zip(columns) {
        *part = column.part(start, length);
    }
    parts
}

/// `length` numbers of several columns from `start` on, for writing.
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

/// The given range if the type has low words, else an empty one.
#[inline(always)]
fn low<T: Real>(range: Range<usize>) -> Range<usize> {
    if T::LOW { range } else { 0..0 }
}

/// A read-only part of a column.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, T: Real> {
    high: &'a [T::Float],
    low: &'a [T::Float],
}

impl<'a, T: Real> View<'a, T> {
    pub(crate) const EMPTY: Self = Self { high: &[], low: &[] };

    /// The first `length` numbers. Loops cut their inputs to the length of their output.
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

/// A writable part of a column.
pub(crate) struct ViewMut<'a, T: Real> {
    high: &'a mut [T::Float],
    low: &'a mut [T::Float],
}

impl<T: Real> ViewMut<'_, T> {
    /// The first `length` numbers.
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

    /// The same part, for reading.
    #[inline(always)]
    pub(crate) fn view(&self) -> View<'_, T> {
        View { high: self.high, low: self.low }
    }

    /// The same part, borrowed again.
    #[inline(always)]
    pub(crate) fn reborrow(&mut self) -> ViewMut<'_, T> {
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

    /// Sets a strip of numbers, given their words.
    #[inline(always)]
    pub(crate) fn set_strip(&mut self, first: usize, high: &[T::Float], low: &[T::Float]) {
        self.high[first..first + high.len()].copy_from_slice(high);
        if T::LOW {
            self.low[first..first + low.len()].copy_from_slice(low);
        }
    }

    /// Sets the high word and leaves the low word unchanged.
    #[inline(always)]
    pub(crate) fn set_high(&mut self, i: usize, number: T) {
        let [high, _] = number.words();
        self.high[i] = high;
    }

    /// The high word alone.
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
