//! Sinks: the destinations of the kernels' results.

use std::ops::Range;

use cardan_memory::{Plane, Stores};

use crate::number::float::{Float, Real};
use crate::number::storage::ViewMut;
use crate::sincos::array::DriveAngles;

/// The samples of a strip, whose results leave the registers together: some cache lines of words.
/// The compiler unrolls shorter loops before it looks for vectors, and finds fewer then.
pub(crate) const STRIP: usize = 32;

/// The destination of a loop's results: a column of numbers, words of a plane, or several of these.
pub(crate) trait Sink<T> {
    /// The sink for a part of the results, stored one by one.
    type Plain<'a>: PlainSink<T>
    where
        Self: 'a;

    /// The results of one strip on their way to the sink.
    type Strip: SinkStrip<T>;

    /// The number of results.
    fn length(&self) -> usize;

    /// Whether results are to be stored in strips, which bypass the caches.
    fn takes_strips(&self) -> bool;

    /// The sink for `length` results from `start` on.
    fn plain(&mut self, start: usize, length: usize) -> Self::Plain<'_>;

    /// Requests the drive angles that the next chunk reads where this one stores the strip from
    /// `first` on.
    fn request_angles(&self, first: usize);

    /// An empty strip for the results from `first` on.
    fn strip(&self, first: usize) -> Self::Strip;

    /// Stores a strip.
    fn put(&mut self, first: usize, strip: &Self::Strip);
}

/// A sink that stores results one by one.
pub(crate) trait PlainSink<T> {
    /// Stores result `i`.
    fn store(&mut self, i: usize, number: T);
}

/// The results of one strip.
pub(crate) trait SinkStrip<T> {
    /// Sets result `i` of the strip.
    fn set(&mut self, i: usize, number: T);
}

impl<T: Real> PlainSink<T> for ViewMut<'_, T> {
    #[inline(always)]
    fn store(&mut self, i: usize, number: T) {
        self.set(i, number);
    }
}

impl<T: Real> Sink<T> for ViewMut<'_, T> {
    type Plain<'a>
        = ViewMut<'a, T>
    where
        Self: 'a;

    type Strip = NumberStrip<T>;

    #[inline(always)]
    fn length(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn takes_strips(&self) -> bool {
        false
    }

    #[inline(always)]
    fn plain(&mut self, start: usize, length: usize) -> ViewMut<'_, T> {
        self.window(start, length)
    }

    #[inline(always)]
    fn request_angles(&self, _: usize) {}

    #[inline(always)]
    fn strip(&self, _: usize) -> NumberStrip<T> {
        NumberStrip { high: [T::Float::default(); STRIP], low: [T::Float::default(); STRIP] }
    }

    #[inline(always)]
    fn put(&mut self, first: usize, strip: &NumberStrip<T>) {
        self.set_strip(first, &strip.high, &strip.low);
    }
}

/// Numbers of a strip, as words.
pub(crate) struct NumberStrip<T: Real> {
    high: [T::Float; STRIP],
    low: [T::Float; STRIP],
}

impl<T: Real> SinkStrip<T> for NumberStrip<T> {
    #[inline(always)]
    fn set(&mut self, i: usize, number: T) {
        let [high, low] = number.words();
        self.high[i] = high;
        if T::LOW {
            self.low[i] = low;
        }
    }
}

/// Whether loops over this number type may work strip by strip: not if no store bypasses the caches.
/// Numbers with error terms take more time than memory does, and so do two registers of
/// single-precision numbers per cache line.
#[inline(always)]
fn suits_strips<T: Real>(stores: Stores) -> bool {
    let is_single = size_of::<T>() == size_of::<f32>();
    let is_fast = !is_single || stores.has_wide_registers();
    !T::LOW && is_fast && stores.can_bypass_caches()
}

/// The planes of a chunk's results, and how the function's instruction set stores strips in them.
pub(crate) struct Outputs<'a, 'b, W> {
    planes: &'a mut [Plane<'b, W>],
    first: usize,
    size: usize,
    stores: Stores,
    angles: &'a [f64],
    asks: bool,
}

impl<'a, 'b, W: Float> Outputs<'a, 'b, W> {
    /// The chunk's window of these planes. With each strip, the drive angles that follow those of
    /// the chunk by its length are requested, if they lie in an array; and if it `asks`, so is the
    /// memory of results that will pass through the caches.
    #[inline(always)]
    pub(crate) fn new(
        planes: &'a mut [Plane<'b, W>],
        window: &Range<usize>,
        stores: Stores,
        drive: DriveAngles<'a>,
        asks: bool,
    ) -> Self {
        let angles = if let DriveAngles::Array(angles) = drive { angles } else { &[] };
        Self { planes, first: window.start, size: window.len(), stores, angles, asks }
    }

    /// The same planes in a function that stores strips in another way.
    #[inline(always)]
    pub(crate) fn by(&mut self, stores: Stores) -> Outputs<'_, 'b, W> {
        let Self { planes, first, size, angles, asks, .. } = self;
        Outputs { planes, first: *first, size: *size, stores, angles, asks: *asks }
    }

    /// Whether a cache line of results is one register.
    #[inline(always)]
    pub(crate) fn has_wide_registers(&self) -> bool {
        self.stores.has_wide_registers()
    }

    /// Whether the memory of results is requested before they are stored.
    #[inline(always)]
    pub(crate) fn asks(&self) -> bool {
        self.asks
    }

    /// Whether results bypass the caches.
    #[inline(always)]
    pub(crate) fn bypass_caches(&self) -> bool {
        self.planes.iter().any(Plane::bypasses_caches)
    }

    /// Copies the words of a plane to another one, multiplied by a sign.
    #[inline(always)]
    pub(crate) fn copy(&mut self, from: usize, to: usize, sign: f64) {
        let window = self.first..self.first + self.size;
        let planes = self.planes.get_disjoint_mut([from, to]);
        let [from, to] = planes.expect("no two outputs share a plane");
        let (from, to) = (&from.words()[window.clone()], &mut to.words()[window]);
        for (to, &from) in to.iter_mut().zip(from) {
            *to = W::near(sign * from.into());
        }
    }

    /// A plane, for writing in strips.
    #[inline(always)]
    pub(crate) fn plane(&mut self, plane: usize) -> Words<'_, W> {
        let window = self.first..self.first + self.size;
        Words { plane: self.planes[plane].part(window), stores: self.stores, angles: self.angles }
    }

    /// Several planes, for writing in strips.
    #[inline(always)]
    pub(crate) fn several<const N: usize>(&mut self, planes: [usize; N]) -> [Words<'_, W>; N] {
        let Self { first, size, stores, angles, .. } = *self;
        let planes = self.planes.get_disjoint_mut(planes);
        let planes = planes.expect("no two outputs share a plane");
        let mut several = planes.map(
            #[inline(always)]
            move |plane| {
                let plane = plane.part(first..first + size);
                Words { plane, stores: Stores::ordinary(), angles }
            },
        );
        // `map` may be a function call, after which the stores would no longer be a constant.
        for words in &mut several {
            words.stores = stores;
        }
        several
    }

    /// The chosen planes, for writing in strips.
    #[inline(always)]
    pub(crate) fn chosen<const N: usize>(
        &mut self,
        chosen: [Option<usize>; N],
    ) -> [Option<Words<'_, W>>; N] {
        let window = self.first..self.first + self.size;
        let mut words = [const { None }; N];
        for (i, plane) in self.planes.iter_mut().enumerate() {
            if let Some(place) = chosen.iter().position(|&chosen| chosen == Some(i)) {
                let plane = plane.part(window.clone());
                words[place] = Some(Words { plane, stores: self.stores, angles: self.angles });
            }
        }
        words
    }

    /// The words of a plane.
    #[inline(always)]
    pub(crate) fn words(&mut self, plane: usize) -> &mut [W] {
        &mut self.planes[plane].words()[self.first..self.first + self.size]
    }
}

/// Words of a plane, which are written in strips.
pub(crate) struct Words<'a, W> {
    plane: Plane<'a, W>,
    stores: Stores,
    /// The drive angles of the chunk, if the next ones are to be requested.
    angles: &'a [f64],
}

impl<W: Float> Words<'_, W> {
    /// The words themselves.
    #[inline(always)]
    pub(crate) fn words(&mut self) -> &mut [W] {
        self.plane.words()
    }

    /// Requests the memory of so many words, which will pass through the caches.
    #[inline(always)]
    pub(crate) fn ask(&mut self, first: usize, length: usize) {
        let words = self.plane.words();
        for line in (0..length).step_by(Plane::<W>::STRIP) {
            cardan_memory::ask(words, first + line);
        }
    }

    /// Stores words that fill cache lines, from word `first` on.
    #[inline(always)]
    pub(crate) fn put_words(&mut self, first: usize, words: &[W]) {
        self.plane.put(self.stores, first, words);
    }

    #[inline(always)]
    fn part(&mut self, start: usize, length: usize) -> &mut [W] {
        &mut self.plane.words()[start..start + length]
    }
}

/// Words of a strip.
pub(crate) struct WordStrip<W>(pub(super) [W; STRIP]);

impl<T: Real, W: Float> SinkStrip<T> for WordStrip<W> {
    #[inline(always)]
    fn set(&mut self, i: usize, number: T) {
        self.0[i] = W::near(number.value().into());
    }
}

impl<T: Real, W: Float> PlainSink<T> for &mut [W] {
    #[inline(always)]
    fn store(&mut self, i: usize, number: T) {
        self[i] = W::near(number.value().into());
    }
}

impl<T: Real, W: Float> Sink<T> for Words<'_, W> {
    type Plain<'a>
        = &'a mut [W]
    where
        Self: 'a;

    type Strip = WordStrip<W>;

    #[inline(always)]
    fn length(&self) -> usize {
        self.plane.len()
    }

    #[inline(always)]
    fn takes_strips(&self) -> bool {
        suits_strips::<T>(self.stores) && self.plane.bypasses_caches()
    }

    #[inline(always)]
    fn plain(&mut self, start: usize, length: usize) -> &mut [W] {
        self.part(start, length)
    }

    #[inline(always)]
    fn request_angles(&self, first: usize) {
        if !self.angles.is_empty() {
            for line in (0..STRIP).step_by(8) {
                cardan_memory::ask(self.angles, first + self.angles.len() + line);
            }
        }
    }

    #[inline(always)]
    fn strip(&self, _: usize) -> WordStrip<W> {
        WordStrip([W::default(); STRIP])
    }

    #[inline(always)]
    fn put(&mut self, first: usize, strip: &WordStrip<W>) {
        self.put_words(first, &strip.0);
    }
}

impl<V, U, A: SinkStrip<V>, B: SinkStrip<U>> SinkStrip<(V, U)> for (A, B) {
    #[inline(always)]
    fn set(&mut self, i: usize, (first, second): (V, U)) {
        self.0.set(i, first);
        self.1.set(i, second);
    }
}

impl<V, U, A: PlainSink<V>, B: PlainSink<U>> PlainSink<(V, U)> for (A, B) {
    #[inline(always)]
    fn store(&mut self, i: usize, (first, second): (V, U)) {
        self.0.store(i, first);
        self.1.store(i, second);
    }
}

impl<V, U, A: Sink<V>, B: Sink<U>> Sink<(V, U)> for (A, B) {
    type Plain<'a>
        = (A::Plain<'a>, B::Plain<'a>)
    where
        Self: 'a;

    type Strip = (A::Strip, B::Strip);

    #[inline(always)]
    fn length(&self) -> usize {
        self.0.length()
    }

    #[inline(always)]
    fn takes_strips(&self) -> bool {
        self.0.takes_strips() || self.1.takes_strips()
    }

    #[inline(always)]
    fn plain(&mut self, start: usize, length: usize) -> Self::Plain<'_> {
        (self.0.plain(start, length), self.1.plain(start, length))
    }

    // The angles are those of all planes.
    #[inline(always)]
    fn request_angles(&self, first: usize) {
        self.0.request_angles(first);
    }

    #[inline(always)]
    fn strip(&self, first: usize) -> Self::Strip {
        (self.0.strip(first), self.1.strip(first))
    }

    #[inline(always)]
    fn put(&mut self, first: usize, strip: &Self::Strip) {
        self.0.put(first, &strip.0);
        self.1.put(first, &strip.1);
    }
}

impl<V, S: SinkStrip<V>> SinkStrip<[V; 3]> for [S; 3] {
    #[inline(always)]
    fn set(&mut self, i: usize, [along_x, along_y, along_z]: [V; 3]) {
        let [x, y, z] = self;
        x.set(i, along_x);
        y.set(i, along_y);
        z.set(i, along_z);
    }
}

impl<V, S: PlainSink<V>> PlainSink<[V; 3]> for [S; 3] {
    #[inline(always)]
    fn store(&mut self, i: usize, [along_x, along_y, along_z]: [V; 3]) {
        let [x, y, z] = self;
        x.store(i, along_x);
        y.store(i, along_y);
        z.store(i, along_z);
    }
}

impl<V, S: Sink<V>> Sink<[V; 3]> for [S; 3] {
    type Plain<'a>
        = [S::Plain<'a>; 3]
    where
        Self: 'a;

    type Strip = [S::Strip; 3];

    #[inline(always)]
    fn length(&self) -> usize {
        self[0].length()
    }

    #[inline(always)]
    fn takes_strips(&self) -> bool {
        self[0].takes_strips()
    }

    #[inline(always)]
    fn plain(&mut self, start: usize, length: usize) -> Self::Plain<'_> {
        let [x, y, z] = self;
        [x.plain(start, length), y.plain(start, length), z.plain(start, length)]
    }

    #[inline(always)]
    fn request_angles(&self, first: usize) {
        self[0].request_angles(first);
    }

    #[inline(always)]
    fn strip(&self, first: usize) -> Self::Strip {
        let [x, y, z] = self;
        [x.strip(first), y.strip(first), z.strip(first)]
    }

    #[inline(always)]
    fn put(&mut self, first: usize, [along_x, along_y, along_z]: &Self::Strip) {
        let [x, y, z] = self;
        x.put(first, along_x);
        y.put(first, along_y);
        z.put(first, along_z);
    }
}
