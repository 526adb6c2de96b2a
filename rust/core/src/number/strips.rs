//! Inputs of the loops: one value per sample, of which parts can be taken.

use std::hint::black_box;

use crate::number::float::Real;
use crate::number::storage::View;

/// One value per sample.
pub(crate) trait At: Copy {
    type Value;

    fn at(&self, i: usize) -> Self::Value;
}

/// Values of which strips can be taken.
pub(crate) trait Strips: At {
    type Strip: At<Value = Self::Value>;

    /// Whether loops take one value after the other.
    const ONE_BY_ONE: bool = false;

    /// Whether all samples share one value.
    const SHARED: bool = false;

    /// `length` values from `first` on. Bounds are checked here and not value by value.
    fn strip(&self, first: usize, length: usize) -> Self::Strip;
}

/// One value that all samples share.
#[derive(Clone, Copy)]
pub(crate) struct Same<V>(pub(crate) V);

impl<V: Copy> At for Same<V> {
    type Value = V;

    #[inline(always)]
    fn at(&self, _: usize) -> V {
        self.0
    }
}

impl<V: Copy> Strips for Same<V> {
    type Strip = Self;

    const SHARED: bool = true;

    #[inline(always)]
    fn strip(&self, _: usize, _: usize) -> Self {
        *self
    }
}

impl<T: Real> At for View<'_, T> {
    type Value = T;

    #[inline(always)]
    fn at(&self, i: usize) -> T {
        self.get(i)
    }
}

impl<T: Real> Strips for View<'_, T> {
    type Strip = Self;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self {
        self.part(first, length)
    }
}

impl<V: Copy> At for &[V] {
    type Value = V;

    #[inline(always)]
    fn at(&self, i: usize) -> V {
        self[i]
    }
}

impl<V: Copy> Strips for &[V] {
    type Strip = Self;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self {
        &self[first..first + length]
    }
}

/// Values of which each belongs to a driveline that is folded for one sample. Folding takes many times
/// as long as a loop over the samples, so the loop is not vectorised, which makes it short.
#[derive(Clone, Copy)]
pub(crate) struct OneByOne<A>(pub(crate) A);

impl<A: At> At for OneByOne<A> {
    type Value = A::Value;

    #[inline(always)]
    fn at(&self, i: usize) -> A::Value {
        // An index that the compiler does not know keeps it from loading several values at once.
        self.0.at(black_box(i))
    }
}

impl<A: Strips> Strips for OneByOne<A> {
    type Strip = OneByOne<A::Strip>;

    const ONE_BY_ONE: bool = true;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self::Strip {
        OneByOne(self.0.strip(first, length))
    }
}

/// Values computed from others.
#[derive(Clone, Copy)]
pub(crate) struct Mapped<A, F>(A, F);

/// Each value of `values`, changed by `change`.
#[inline(always)]
pub(crate) fn mapped<A: At, V, F: Fn(A::Value) -> V + Copy>(values: A, change: F) -> Mapped<A, F> {
    Mapped(values, change)
}

impl<A: At, V, F: Fn(A::Value) -> V + Copy> At for Mapped<A, F> {
    type Value = V;

    #[inline(always)]
    fn at(&self, i: usize) -> V {
        self.1(self.0.at(i))
    }
}

impl<A: Strips, V, F: Fn(A::Value) -> V + Copy> Strips for Mapped<A, F> {
    type Strip = Mapped<A::Strip, F>;

    const ONE_BY_ONE: bool = A::ONE_BY_ONE;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self::Strip {
        Mapped(self.0.strip(first, length), self.1)
    }
}

impl<A: At, const N: usize> At for [A; N] {
    type Value = [A::Value; N];

    #[inline(always)]
    fn at(&self, i: usize) -> Self::Value {
        std::array::from_fn(
            #[inline(always)]
            |k| self[k].at(i),
        )
    }
}

impl<A: Strips, const N: usize> Strips for [A; N] {
    type Strip = [A::Strip; N];

    const ONE_BY_ONE: bool = A::ONE_BY_ONE;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self::Strip {
        std::array::from_fn(
            #[inline(always)]
            |k| self[k].strip(first, length),
        )
    }
}

/// Implements the traits for tuples of values.
macro_rules! tuples {
    ($(($($values:ident $number:tt),*))*) => {$(
        impl<$($values: At),*> At for ($($values,)*) {
            type Value = ($($values::Value,)*);

            #[inline(always)]
            fn at(&self, i: usize) -> Self::Value {
                ($(self.$number.at(i),)*)
            }
        }

        impl<$($values: Strips),*> Strips for ($($values,)*) {
            type Strip = ($($values::Strip,)*);

            const ONE_BY_ONE: bool = false $(|| $values::ONE_BY_ONE)*;

            #[inline(always)]
            fn strip(&self, first: usize, length: usize) -> Self::Strip {
                ($(self.$number.strip(first, length),)*)
            }
        }
    )*};
}

tuples! {
    (A 0, B 1)
    (A 0, B 1, C 2)
    (A 0, B 1, C 2, D 3, E 4)
}
