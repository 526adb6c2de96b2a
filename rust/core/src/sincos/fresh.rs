//! Pins that are not stored, and the reduced angles for such ones.

use std::cell::Cell;
use std::iter::once;
use std::marker::PhantomData;

use crate::number::reduction::LargeAngleFlag;
use crate::number::strips::{At, Strips};
use crate::number::trig::Angle;
use crate::sincos::array::{PinLine, SinCosBlock, SinCosBlocks, SinCosKind, turned_pin};

/// Pins of an array of angles, found by the loop that needs them. `TURNED` ones are of the sum of
/// each angle and that of a chain's turn, as [`crate::sincos::array::rotate`] finds them. Pins that
/// are not `SIGNED` have sines and cosines without their signs, for squares.
#[derive(Clone, Copy)]
pub(crate) struct FreshPins<'a, T, const TURNED: bool, const SIGNED: bool = true> {
    pub(crate) angles: &'a [f64],
    /// Cosine and sine of the turn.
    pub(crate) turn: [T; 2],
    /// Records angles that are too large for the fast reduction. Their pins are meaningless.
    pub(crate) too_large: &'a Cell<LargeAngleFlag>,
}

/// How many samples ahead the angles of fresh pins are requested.
const AHEAD: usize = 512;

impl<'a, T: Angle, const TURNED: bool, const SIGNED: bool> SinCosBlocks<T>
    for FreshPins<'a, T, TURNED, SIGNED>
{
    type SinCosBlock = Self;
    type Unsigned = FreshPins<'a, T, TURNED, false>;

    const FRESH: bool = true;

    #[inline(always)]
    fn unsigned(self) -> Self::Unsigned {
        let Self { angles, turn, too_large } = self;
        FreshPins { angles, turn, too_large }
    }

    #[inline(always)]
    fn parts(self) -> impl Iterator<Item = (usize, Self)> {
        once((0, self))
    }
}

impl<T: Angle, const TURNED: bool, const SIGNED: bool> SinCosBlock<T>
    for FreshPins<'_, T, TURNED, SIGNED>
{
    #[inline(always)]
    fn len(&self) -> usize {
        self.angles.len()
    }

    #[inline(always)]
    fn part(&self, start: usize, length: usize) -> Self {
        Self { angles: &self.angles[start..start + length], ..*self }
    }

    #[inline(always)]
    fn get(&self, i: usize) -> (T, T) {
        let reduced = reduced(self.angles[i], self.too_large);
        // A quarter turn only exchanges sine and cosine and changes a sign, so that the other turn
        // may come before it.
        let pin = PinLine::sin_cos(if SIGNED { reduced } else { (reduced.0, 0) });
        let (s, c) = if TURNED { turned_pin(pin, self.turn) } else { pin };
        if !SIGNED && reduced.1 & 1 == 1 { (c, s) } else { (s, c) }
    }

    #[inline(always)]
    fn ask(&self, i: usize, length: usize) {
        for line in (0..length).step_by(8) {
            cardan_memory::ask(self.angles, i + AHEAD + line);
        }
    }
}

/// The angles of an array, reduced by the loop that needs them.
#[derive(Clone, Copy)]
pub(crate) struct ReducedAngles<'a, T> {
    angles: &'a [f64],
    /// Records angles that are too large for the fast reduction. Their remainders are meaningless.
    too_large: &'a Cell<LargeAngleFlag>,
    numbers: PhantomData<T>,
}

impl<'a, T> ReducedAngles<'a, T> {
    #[inline(always)]
    pub(crate) fn new(angles: &'a [f64], too_large: &'a Cell<LargeAngleFlag>) -> Self {
        Self { angles, too_large, numbers: PhantomData }
    }
}

impl<T: Angle> At for ReducedAngles<'_, T> {
    type Value = (T, u64);

    #[inline(always)]
    fn at(&self, i: usize) -> (T, u64) {
        reduced(self.angles[i], self.too_large)
    }
}

impl<T: Angle> Strips for ReducedAngles<'_, T> {
    type Strip = Self;

    #[inline(always)]
    fn strip(&self, first: usize, length: usize) -> Self {
        Self { angles: &self.angles[first..first + length], ..*self }
    }
}

/// Reduces an angle, and records it if it is too large for that.
#[inline(always)]
fn reduced<T: Angle>(angle: f64, too_large: &Cell<LargeAngleFlag>) -> (T, u64) {
    let reduced = T::reduce(angle);
    let mut flag = too_large.get();
    flag.accumulate(reduced.1);
    too_large.set(flag);
    reduced
}
