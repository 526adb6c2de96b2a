//! Sinks for angles: a loop gives angle errors, to which they add the drive angles.

use crate::input::sweep::Sweep;
use crate::number::Number;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::number::storage::View;
use crate::run::sink::{PlainSink, STRIP, Sink, SinkStrip, WordStrip, Words};
use crate::sincos::array::sample_number;

/// A drive angle per sample, to which sinks add angle errors.
pub(crate) trait DriveAngle: Copy {
    /// The same for `length` samples from `start` on.
    fn slice(self, start: usize, length: usize) -> Self;

    /// The same for a strip from `start` on.
    fn strip(self, start: usize) -> Self;

    fn angle(&self, i: usize) -> DoubleDouble;
}

/// Angles from an array.
#[derive(Clone, Copy)]
pub(crate) struct ArrayAngle<'a>(pub(crate) &'a [f64]);

impl DriveAngle for ArrayAngle<'_> {
    #[inline(always)]
    fn slice(self, start: usize, length: usize) -> Self {
        Self(&self.0[start..start + length])
    }

    #[inline(always)]
    fn strip(self, start: usize) -> Self {
        self.slice(start, STRIP)
    }

    #[inline(always)]
    fn angle(&self, i: usize) -> DoubleDouble {
        DoubleDouble::exact(self.0[i])
    }
}

/// The angles of a sweep from this sample on.
#[derive(Clone, Copy)]
pub(crate) struct SweepAngle<'a>(pub(crate) &'a Sweep, pub(crate) usize);

impl DriveAngle for SweepAngle<'_> {
    #[inline(always)]
    fn slice(self, start: usize, _: usize) -> Self {
        Self(self.0, self.1 + start)
    }

    #[inline(always)]
    fn strip(self, start: usize) -> Self {
        self.slice(start, STRIP)
    }

    #[inline(always)]
    fn angle(&self, i: usize) -> DoubleDouble {
        self.0.angle(sample_number(self.1, i))
    }
}

/// The same from one angle of the sweep and a table of the angles of whole steps.
#[derive(Clone, Copy)]
pub(crate) struct SteppedAngle<'a> {
    sweep: &'a Sweep,
    first: usize,
    begin: DoubleDouble,
    turns: View<'a, DoubleDouble>,
}

impl<'a> SteppedAngle<'a> {
    /// Begins at sample `first`; slices may be as long as `turns`.
    #[inline(always)]
    pub(crate) fn new(sweep: &'a Sweep, first: usize, turns: View<'a, DoubleDouble>) -> Self {
        Self { sweep, first, begin: sweep.angle(first as f64), turns }
    }
}

impl DriveAngle for SteppedAngle<'_> {
    #[inline(always)]
    fn slice(self, start: usize, length: usize) -> Self {
        Self::new(self.sweep, self.first + start, self.turns.cut(length))
    }

    #[inline(always)]
    fn strip(self, start: usize) -> Self {
        Self { turns: self.turns.part(start, STRIP), ..self }
    }

    #[inline(always)]
    fn angle(&self, i: usize) -> DoubleDouble {
        self.begin + self.turns.get(i)
    }
}

/// Adds drive angles to angle errors.
pub(crate) struct AngleSink<'a, D, W>(pub(crate) D, pub(crate) Words<'a, W>);

/// The same, one by one.
pub(crate) struct PlainAngleSink<'a, D, W>(D, &'a mut [W]);

/// The angles of a strip.
pub(crate) struct AngleStrip<D, W>(D, WordStrip<W>);

impl<T: Number, D: DriveAngle, W: Float> SinkStrip<T> for AngleStrip<D, W> {
    #[inline(always)]
    fn set(&mut self, i: usize, error: T) {
        self.1.0[i] = error.after(self.0.angle(i));
    }
}

impl<T: Number, D: DriveAngle, W: Float> PlainSink<T> for PlainAngleSink<'_, D, W> {
    #[inline(always)]
    fn store(&mut self, i: usize, error: T) {
        self.1[i] = error.after(self.0.angle(i));
    }
}

impl<T: Number, D: DriveAngle, W: Float> Sink<T> for AngleSink<'_, D, W> {
    type Plain<'a>
        = PlainAngleSink<'a, D, W>
    where
        Self: 'a;

    type Strip = AngleStrip<D, W>;

    #[inline(always)]
    fn length(&self) -> usize {
        Sink::<T>::length(&self.1)
    }

    #[inline(always)]
    fn takes_strips(&self) -> bool {
        Sink::<T>::takes_strips(&self.1)
    }

    #[inline(always)]
    fn plain(&mut self, start: usize, length: usize) -> PlainAngleSink<'_, D, W> {
        PlainAngleSink(self.0.slice(start, length), Sink::<T>::plain(&mut self.1, start, length))
    }

    #[inline(always)]
    fn request_angles(&self, first: usize) {
        Sink::<T>::request_angles(&self.1, first);
    }

    #[inline(always)]
    fn strip(&self, first: usize) -> AngleStrip<D, W> {
        AngleStrip(self.0.strip(first), Sink::<T>::strip(&self.1, first))
    }

    #[inline(always)]
    fn put(&mut self, first: usize, strip: &AngleStrip<D, W>) {
        Sink::<T>::put(&mut self.1, first, &strip.1);
    }
}
