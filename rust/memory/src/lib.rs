//! This crate gives the core safe access to three abilities of the machine. It stores past the caches,
//! requests memory ahead of its use, and lends work to threads.
//!
//! An ordinary store first reads the cache line that it writes into, and later writes it back. Where
//! the results of a call exceed the caches, that doubles their traffic, and the store waits. A store
//! of a whole cache line from vector registers needs neither. [`write_strips`] lends planes of words
//! that are written in this way, and completes the stores before it returns. [`ask`] requests a
//! cache line of an input before it is read. [`lend`] lends work to threads that may come late.
//!
//! This crate contains the only unsafe code beside the binding. Where the machine has no such
//! stores, the functions copy.

mod lend;

use std::ops::Range;

#[cfg(target_arch = "x86")]
use core::arch::x86 as intel;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64 as intel;

pub use lend::{Ticket, lend};

/// Bytes of a strip: one cache line.
pub const STRIP_BYTES: usize = 64;

/// Words of planes: `f32` or `f64`. Any bits are a valid value.
pub trait Word: Copy + sealed::Sealed + 'static {}

impl Word for f32 {}
impl Word for f64 {}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// How whole cache lines leave the registers of a function, by its instruction set.
///
/// A constant in such a function: the compiler then keeps a strip in registers until it is stored.
#[derive(Clone, Copy, Debug)]
pub struct Stores(Vectors);

#[derive(Clone, Copy, Debug)]
enum Vectors {
    Ordinary,
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx2,
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    Avx512,
}

impl Stores {
    /// Ordinary stores, for every machine.
    #[inline(always)]
    pub const fn ordinary() -> Self {
        Self(Vectors::Ordinary)
    }

    /// Stores of a machine with AVX2, which the token proves.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline(always)]
    pub fn avx2(_: fearless_simd::Avx2) -> Self {
        Self(Vectors::Avx2)
    }

    /// Stores of a machine with AVX-512, which the token proves.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline(always)]
    pub fn avx512(_: fearless_simd::Avx512) -> Self {
        Self(Vectors::Avx512)
    }

    /// Whether there are stores past the caches.
    #[inline(always)]
    pub fn can_bypass_caches(self) -> bool {
        !matches!(self.0, Vectors::Ordinary)
    }

    /// Whether a cache line is one register, of which there are then 32.
    #[inline(always)]
    pub fn has_wide_registers(self) -> bool {
        match self.0 {
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Vectors::Avx512 => true,
            _ => false,
        }
    }

    /// Writes a strip past the caches, if there are stores for that and `out` begins at a cache
    /// line. Returns whether it did.
    ///
    /// # Safety
    /// `out` and `strip` must have [`STRIP_BYTES`], and the caller must call [`complete`] before
    /// anyone reads `out`.
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    #[inline(always)]
    #[expect(unsafe_code, reason = "vector stores past the caches")]
    unsafe fn stream(self, out: *mut u8, strip: *const u8) -> bool {
        // Found before the match, which makes loops over strips faster.
        let aligned = out.addr().is_multiple_of(STRIP_BYTES);
        match self.0 {
            Vectors::Ordinary => return false,
            // SAFETY: a token has proved that the machine has the instructions.
            Vectors::Avx2 if aligned => unsafe { stream_avx2(out, strip) },
            Vectors::Avx512 if aligned => unsafe { stream_avx512(out, strip) },
            _ => {}
        }
        aligned
    }

    /// The same where no store bypasses the caches.
    ///
    /// # Safety
    /// None is needed.
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
    #[expect(unsafe_code, reason = "declared like the other")]
    unsafe fn stream(self, _: *mut u8, _: *const u8) -> bool {
        false
    }
}

/// Stores a strip past the caches, given as many bytes from a cache line on.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[inline]
#[target_feature(enable = "avx512f")]
#[expect(unsafe_code, reason = "vector stores past the caches")]
unsafe fn stream_avx512(out: *mut u8, strip: *const u8) {
    // SAFETY: both have the bytes of a vector, and `out` is aligned to it.
    unsafe { intel::_mm512_stream_si512(out.cast(), intel::_mm512_loadu_si512(strip.cast())) };
}

/// The same by two vectors.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[inline]
#[target_feature(enable = "avx")]
#[expect(unsafe_code, reason = "vector stores past the caches")]
unsafe fn stream_avx2(out: *mut u8, strip: *const u8) {
    // SAFETY: both have the bytes of two vectors, and `out` is aligned to them.
    unsafe {
        let half = STRIP_BYTES / 2;
        intel::_mm256_stream_si256(out.cast(), intel::_mm256_loadu_si256(strip.cast()));
        let (out, strip) = (out.add(half), strip.add(half));
        intel::_mm256_stream_si256(out.cast(), intel::_mm256_loadu_si256(strip.cast()));
    }
}

/// A part of a plane of results, written in strips.
#[derive(Debug)]
pub struct Plane<'a, W> {
    words: &'a mut [W],
    past_caches: bool,
}

impl<'a, W: Word> Plane<'a, W> {
    /// The words of a strip.
    pub const STRIP: usize = STRIP_BYTES / size_of::<W>();

    /// A plane whose strips pass through the caches.
    #[inline(always)]
    pub fn cached(words: &'a mut [W]) -> Self {
        Self { words, past_caches: false }
    }

    /// The number of words.
    #[inline(always)]
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// Whether there are no words.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Whether strips bypass the caches.
    #[inline(always)]
    pub fn bypasses_caches(&self) -> bool {
        cfg!(target_arch = "x86_64") && self.past_caches
    }

    /// Words from the start to the first cache line.
    pub fn words_before_cache_line(&self) -> usize {
        self.words.as_ptr().align_offset(STRIP_BYTES)
    }

    /// The same plane or a part of it, borrowed again.
    #[inline(always)]
    pub fn part(&mut self, range: Range<usize>) -> Plane<'_, W> {
        Plane { words: &mut self.words[range], past_caches: self.past_caches }
    }

    /// The words themselves, after all stores to them.
    #[inline(always)]
    pub fn words(&mut self) -> &mut [W] {
        if self.past_caches {
            complete();
        }
        self.words
    }

    /// Writes one word, after all stores of strips.
    #[inline(always)]
    pub fn set(&mut self, i: usize, word: W) {
        if self.past_caches {
            complete();
        }
        self.words[i] = word;
    }

    /// Writes strips from word `first` on; their words must fill whole cache lines.
    ///
    /// # Panics
    /// If the strips do not fit, or do not fill cache lines past the caches.
    #[inline(always)]
    pub fn put(&mut self, stores: Stores, first: usize, strips: &[W]) {
        let out = &mut self.words[first..first + strips.len()];
        if !self.past_caches {
            out.copy_from_slice(strips);
            return;
        }
        assert!(strips.len().is_multiple_of(Self::STRIP), "strips must fill cache lines");
        // Iterators of pieces are functions that the compiler may call here, for which all vector
        // registers are saved.
        for line in 0..strips.len() / Self::STRIP {
            let line = line * Self::STRIP..(line + 1) * Self::STRIP;
            let (out, strip) = (&mut out[line.clone()], &strips[line]);
            // SAFETY: both have the bytes of a strip. Only `write_strips` creates planes past the
            // caches; it borrows their words until it has completed the stores, and `words` does
            // so before it lends them.
            #[expect(unsafe_code, reason = "a store that the caches do not delay")]
            let streamed = unsafe { stores.stream(out.as_mut_ptr().cast(), strip.as_ptr().cast()) };
            if !streamed {
                out.copy_from_slice(strip);
            }
        }
    }
}

/// Lends `planes` to `body`, for writing in strips: past the caches, or through them. All stores are
/// complete when it returns or unwinds.
pub fn write_strips<W: Word, R>(
    planes: &mut [&mut [W]],
    past_caches: bool,
    body: impl FnOnce(&mut [Plane<'_, W>]) -> R,
) -> R {
    struct Completed(bool);
    impl Drop for Completed {
        fn drop(&mut self) {
            if self.0 {
                complete();
            }
        }
    }
    let _completed = Completed(past_caches);
    let mut lent: Vec<Plane<'_, W>> =
        planes.iter_mut().map(|words| Plane { words, past_caches }).collect();
    body(&mut lent)
}

/// Waits until all stores of this thread past the caches are visible to every thread.
#[inline(always)]
fn complete() {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: every x86-64 machine has the instruction, which has no other effect.
    #[expect(unsafe_code, reason = "orders the stores that bypass the caches")]
    #[allow(unused_unsafe, reason = "safe from some version of the compiler on")]
    unsafe {
        intel::_mm_sfence();
    }
}

/// Requests the cache line that contains element `i`, which may lie beyond the end.
#[inline(always)]
pub fn ask<W: Word>(words: &[W], i: usize) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: the instruction is a hint. It reads nothing that the program sees, and an address
    // without memory has no effect.
    #[expect(unsafe_code, reason = "the machine's own requests come too late")]
    unsafe {
        intel::_mm_prefetch::<{ intel::_MM_HINT_T0 }>(words.as_ptr().wrapping_add(i).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (words, i);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels() -> Vec<Stores> {
        #[allow(unused_mut, reason = "other machines have one kind")]
        let mut kinds = vec![Stores::ordinary()];
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        {
            let level = fearless_simd::Level::new();
            kinds.extend(level.as_avx512().map(Stores::avx512));
            kinds.extend(level.as_avx2().map(Stores::avx2));
        }
        kinds
    }

    #[test]
    fn strips_arrive_whatever_the_alignment() {
        for stores in levels() {
            for past_caches in [false, true] {
                for offset in 0..9 {
                    let mut memory = vec![-1.0; 41];
                    let words = &mut memory[offset..offset + 24];
                    write_strips(&mut [words], past_caches, |planes| {
                        let strips: Vec<f64> = (0..16).map(f64::from).collect();
                        planes[0].part(3..24).put(stores, 5, &strips);
                    });
                    let expected = |i: usize| match i.checked_sub(offset + 8) {
                        Some(word @ 0..16) => word as f64,
                        _ => -1.0,
                    };
                    assert!((0..41).all(|i| memory[i] == expected(i)), "{offset}");
                }
            }
        }
    }

    #[test]
    #[should_panic(expected = "range end")]
    fn a_strip_must_fit() {
        let mut words = [0.0; 10];
        Plane::cached(&mut words).put(Stores::ordinary(), 3, &[1.0; 8]);
    }

    #[test]
    #[should_panic(expected = "strips must fill cache lines")]
    fn a_strip_must_be_whole() {
        let strip = [1.0; 7];
        write_strips(&mut [&mut [0.0; 8]], true, |planes| {
            planes[0].put(Stores::ordinary(), 0, &strip);
        });
    }

    #[test]
    fn words_are_found_after_the_stores() {
        for stores in levels() {
            let mut memory = [0.0; 32];
            let read = write_strips(&mut [&mut memory], true, |planes| {
                let first = planes[0].words_before_cache_line();
                planes[0].put(stores, first, &[2.5; 8]);
                planes[0].words()[first + 7]
            });
            assert_eq!(read, 2.5);
        }
    }

    #[test]
    fn any_element_may_be_asked_for() {
        ask(&[1.0_f64], 1 << 40);
        ask::<f32>(&[], usize::MAX);
    }
}
