//! The running maps of the drivelines that are folded together, one per lane.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use crate::mechanics::chain::{self, Complex, Equivalent, Transfer};
use crate::mechanics::double_angle::DoubleAngle;
use crate::mechanics::joint::Joint;
use crate::number::double_double::DoubleDouble;
use crate::number::storage::{Column, View, columns, views, views_mut};
use crate::number::trig;

/// The number of drivelines that are folded together: their maps stay in the first-level cache.
pub(super) const LANES: usize = 64;

/// The maps of the drivelines that are folded together, up to the current joint.
#[derive(Clone, Debug)]
pub(super) struct Maps {
    a: [Column<DoubleDouble>; 2],
    b: [Column<DoubleDouble>; 2],
    complement: Column<DoubleDouble>,
}

impl Maps {
    pub(super) fn new(lanes: usize) -> Self {
        Self { a: columns(lanes), b: columns(lanes), complement: Column::new(lanes) }
    }

    #[inline(always)]
    pub(super) fn read(&self, length: usize) -> MapsView<'_> {
        let [a_re, a_im] = views(&self.a, length);
        let [b_re, b_im] = views(&self.b, length);
        MapsView([a_re, a_im, b_re, b_im, self.complement.view(length)])
    }

    /// Applies a step to each map.
    #[inline(always)]
    pub(super) fn update(&mut self, length: usize, step: &impl Step) {
        let ([a_re, a_im], [b_re, b_im]) =
            (views_mut(&mut self.a, 0, length), views_mut(&mut self.b, 0, length));
        let (mut a_re, mut a_im) = (a_re.cut(length), a_im.cut(length));
        let (mut b_re, mut b_im) = (b_re.cut(length), b_im.cut(length));
        let mut complement = self.complement.view_mut(length).cut(length);
        for i in 0..length {
            let mut transfer = Transfer {
                a: Complex::new(a_re.get(i), a_im.get(i)),
                b: Complex::new(b_re.get(i), b_im.get(i)),
                complement: complement.get(i),
            };
            step.take(i, &mut transfer);
            a_re.set(i, transfer.a.re);
            a_im.set(i, transfer.a.im);
            b_re.set(i, transfer.b.re);
            b_im.set(i, transfer.b.im);
            complement.set(i, transfer.complement);
        }
    }
}

// The work of a lane is a method and not a closure: a closure of this size would be compiled as a
// separate function, without the instruction set of the loop that calls it.

/// A value for each lane.
pub(super) trait Lane<T> {
    fn at(&self, i: usize) -> T;
}

/// A change of the map of each lane.
pub(super) trait Step {
    fn take(&self, i: usize, transfer: &mut Transfer);
}

/// A read-only view of the maps.
pub(super) struct MapsView<'a>([View<'a, DoubleDouble>; 5]);

impl MapsView<'_> {
    /// The determinant of a map.
    #[inline(always)]
    pub(super) fn complement(&self, i: usize) -> DoubleDouble {
        let [.., complement] = &self.0;
        complement.get(i)
    }

    /// [`Transfer::row_loses_digits`].
    pub(super) fn row_loses_digits(&self, i: usize, product: f64) -> bool {
        let transfer: Transfer = self.at(i);
        transfer.row_loses_digits(product)
    }
}

impl Lane<Transfer> for MapsView<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> Transfer {
        let [a_re, a_im, b_re, b_im, complement] = &self.0;
        Transfer {
            a: Complex::new(a_re.get(i), a_im.get(i)),
            b: Complex::new(b_re.get(i), b_im.get(i)),
            complement: complement.get(i),
        }
    }
}

impl Lane<Equivalent<DoubleDouble>> for Transfer {
    #[inline(always)]
    fn at(&self, _: usize) -> Equivalent<DoubleDouble> {
        self.equivalent()
    }
}

impl Lane<DoubleAngle<DoubleDouble>> for MapsView<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> DoubleAngle<DoubleDouble> {
        let transfer: Transfer = self.at(i);
        transfer.double_angle()
    }
}

impl Lane<Equivalent<DoubleDouble>> for MapsView<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> Equivalent<DoubleDouble> {
        let transfer: Transfer = self.at(i);
        transfer.equivalent()
    }
}

/// First joints, from their bends.
pub(super) struct FirstJoint<'a>(pub(super) &'a [f64]);

impl Lane<DoubleAngle<DoubleDouble>> for FirstJoint<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> DoubleAngle<DoubleDouble> {
        DoubleAngle::of_joint(self.0[i])
    }
}

impl Lane<Equivalent<DoubleDouble>> for FirstJoint<'_> {
    #[inline(always)]
    fn at(&self, i: usize) -> Equivalent<DoubleDouble> {
        Equivalent::of_joint(Joint::with_error_terms(self.0[i]))
    }
}

/// Returns to the drive shaft.
pub(super) struct Reset;

impl Step for Reset {
    #[inline(always)]
    fn take(&self, _: usize, transfer: &mut Transfer) {
        *transfer = Transfer::default();
    }
}

/// Appends a joint, given its bend. A `WIDE` one has nearly all digits of a double-double.
pub(super) struct PassJoint<'a, const WIDE: bool>(pub(super) &'a [f64]);

impl<const WIDE: bool> Step for PassJoint<'_, WIDE> {
    #[inline(always)]
    fn take(&self, i: usize, transfer: &mut Transfer) {
        let bend = self.0[i];
        let joint = if WIDE { Joint::of_chain(bend) } else { Joint::with_error_terms(bend) };
        transfer.pass_joint(&joint);
        if WIDE {
            *transfer = transfer.renormalized();
        }
    }
}

/// Appends a shaft, given its turn.
pub(super) struct PassShaft<'a, const WIDE: bool>([View<'a, DoubleDouble>; 2]);

impl<const WIDE: bool> Step for PassShaft<'_, WIDE> {
    #[inline(always)]
    fn take(&self, i: usize, transfer: &mut Transfer) {
        let [re, im] = &self.0;
        transfer.pass_shaft(Complex::new(re.get(i), im.get(i)));
        if WIDE {
            *transfer = transfer.renormalized();
        }
    }
}

/// The turns of one intermediate shaft, one per driveline.
#[derive(Clone, Debug)]
pub(super) struct Turns([Column<DoubleDouble>; 2]);

impl Turns {
    pub(super) fn new(lanes: usize) -> Self {
        Self(columns(lanes))
    }

    /// Turns, which have nearly all digits of a double-double if `wide`.
    #[inline(always)]
    pub(super) fn find(&mut self, phases: &[f64], twists: &[f64], wide: bool) {
        let length = phases.len();
        let (phases, twists) = (&phases[..length], &twists[..length]);
        let [re, im] = views_mut(&mut self.0, 0, length);
        let (mut re, mut im) = (re.cut(length), im.cut(length));
        let far = trig::any_too_large(phases.iter().chain(twists).copied());
        for i in 0..length {
            let turn = if wide {
                chain::near_wide_shaft_turn(phases[i], twists[i])
            } else {
                chain::near_shaft_turn(phases[i], twists[i])
            };
            re.set(i, turn.re);
            im.set(i, turn.im);
        }
        if far {
            for i in 0..length {
                let far = if wide { chain::wide_shaft_turn } else { chain::shaft_turn };
                let turn = far(phases[i], twists[i]);
                re.set(i, turn.re);
                im.set(i, turn.im);
            }
        }
    }

    #[inline(always)]
    pub(super) fn read<const WIDE: bool>(&self, length: usize) -> PassShaft<'_, WIDE> {
        PassShaft(views(&self.0, length))
    }
}
