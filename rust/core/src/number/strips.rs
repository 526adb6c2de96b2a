//! Inputs of the loops: one value per sample, of which parts can be taken.

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
