//! Mean and orders of outputs over a turn.
//!
//! Half a turn tells the whole: ideal joints look the same after it, except that their pins have the
//! opposite sense. What depends on that sense has odd orders only, everything else even ones. Joints
//! with deviations repeat after a whole turn only; they have all orders and are sampled over it.
//!
//! A smooth output is sampled at `N` equal steps. The sum then differs from the integral by the
//! amplitudes of the orders `2N − m` and beyond, and each order is about the `k` of the equivalent
//! joint times the one two below it. Magnitudes have kinks and are summed between them. Whatever else
//! is not smooth is noticed, because every sum is compared with the one over half as many samples.

use std::f64::consts::PI;

use crate::error::{Error, Result};
use crate::mechanics::chain::Equivalent;
use crate::number::DoubleDouble;
use crate::number::elementary::{hypot, ln, ln_1p};
use crate::number::trig;
use crate::plan::output::Output;
use crate::run::execution::Execution;
use crate::turns::panels::{Integrands, RowMeans};
use crate::turns::rows::each_row;
use crate::turns::{Driven, Turns};

/// Outputs have errors of some ulp, and chains amplify those of their constants.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Samples of half a turn.
const FEWEST: f64 = 16.0;
const MOST: usize = 1 << 20;

/// The orders of the outputs of a plan, of every row plane by plane.
#[derive(Clone, Debug)]
pub struct Orders {
    /// The mean.
    pub mean: Vec<f64>,
    /// A bound on the error of the mean and of every amplitude.
    pub error: Vec<f64>,
    /// Real and imaginary parts of the amplitudes `c` of `Re Σ c e^{imα}`, order by order.
    pub amplitudes: Vec<[f64; 2]>,
}

impl Turns<'_> {
    /// The highest order of an output: more would take more than a million samples of half a turn.
    pub const HIGHEST_ORDER: usize = MOST >> 2;

    /// Mean and orders of the outputs over a turn: over the drive angle, or if `driven` over the
    /// angle of the last shaft. Rounding counts as `tolerance` of an output's largest magnitude if
    /// that is more.
    ///
    /// # Errors
    /// An order above [`Self::HIGHEST_ORDER`], angles, which grow from turn to turn, arrays whose lengths do not fit together, a plan with
    /// a load without one in the rows.
    pub fn orders(
        &self,
        orders: &[usize],
        driven: bool,
        tolerance: f64,
        execution: Execution<'_>,
    ) -> Result<Orders> {
        if let Some(place) = orders.iter().position(|&order| order > Self::HIGHEST_ORDER) {
            let problem =
                format!("is {}; it must be at most {}", orders[place], Self::HIGHEST_ORDER);
            return Err(Error::new("orders", &[place], problem));
        }
        if self.plan.outputs.contains(&Output::Angle) {
            let problem = "holds \"angle\", which grows from turn to turn; angle_error has orders";
            return Err(Error::new("outputs", &[], problem));
        }
        self.rows.check(self.plan)?;
        let driven = if driven { Some(Driven::new(&self.plan.largest_bends)?) } else { None };
        let planes = self.plan.planes;
        let each = planes * (2 + 2 * orders.len());
        let mut out = vec![0.0; self.rows.count() * each];
        let search = Search {
            turns: self,
            orders,
            driven: driven.as_ref(),
            rounding: ROUNDING.max(tolerance),
        };
        each_row(&mut out, each, execution, |row, out| search.run(row, out))?;
        let of_planes = || out.chunks(2 + 2 * orders.len());
        Ok(Orders {
            mean: of_planes().map(|plane| plane[0]).collect(),
            error: of_planes().map(|plane| plane[1]).collect(),
            amplitudes: of_planes()
                .flat_map(|plane| plane[2..].as_chunks::<2>().0.iter().copied())
                .collect(),
        })
    }
}

struct Search<'a> {
    turns: &'a Turns<'a>,
    orders: &'a [usize],
    driven: Option<&'a Driven>,
    /// The part of an output's largest magnitude that counts as rounding.
    rounding: f64,
}

/// How a plane behaves over half a turn.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    reverses: bool,
    has_kinks: bool,
    /// The number of the output of a shaft, joint or bearing of which it is a component.
    item: usize,
}

impl Search<'_> {
    /// Fills mean, error and amplitudes of each plane of one row.
    fn run(&self, row: usize, out: &mut [f64]) -> Result<()> {
        let plan = self.turns.plan;
        let planes: Vec<Symmetry> = plan
            .outputs
            .iter()
            .enumerate()
            .flat_map(|(item, output)| {
                // Deviations move the zeros of a magnitude and round its kinks off.
                let has_kinks = output.has_kinks() && !plan.is_as_built();
                (0..output.components()).map(move |component| {
                    let reverses = output.reverses(component, plan.axes);
                    Symmetry { reverses, has_kinks, item }
                })
            })
            .collect();
        if planes.iter().any(|plane| !plane.has_kinks) {
            self.by_equal_steps(row, &planes, out)?;
        }
        if planes.iter().any(|plane| plane.has_kinks) {
            self.by_panels(row, &planes, out)?;
        }
        Ok(())
    }

    /// Sums over equal steps, of which there are enough.
    fn by_equal_steps(&self, row: usize, planes: &[Symmetry], out: &mut [f64]) -> Result<()> {
        let mut samples = self.samples(row);
        let mut before = f64::INFINITY;
        loop {
            let excess = self.sums(row, planes, samples, out)?;
            // Sums that twice as many samples hardly change any less differ by the rounding of the
            // results: joints as built that compensate each other leave that of each joint.
            if 2 * samples > MOST || excess <= 1.0 || excess > 0.5 * before {
                return Ok(());
            }
            (before, samples) = (excess, 2 * samples);
        }
    }

    /// Sums over `samples` equal steps of half a turn. Returns by how many roundings they differ
    /// from sums over half as many.
    fn sums(
        &self,
        row: usize,
        planes: &[Symmetry],
        samples: usize,
        out: &mut [f64],
    ) -> Result<f64> {
        let whole = self.turns.plan.is_as_built();
        let count = if whole { 2 * samples } else { samples };
        let step = PI / samples as f64;
        let angles: Vec<f64> = (0..count).map(|i| i as f64 * step).collect();
        let values = self.turns.values_at(self.driven, row, &angles)?;
        // Whole numbers of steps lose no digit of a high order's angle.
        let turn: Vec<(f64, f64)> =
            (0..2 * samples).map(|i| trig::sin_cos(i as f64 * step)).collect();
        let sizes: Vec<f64> = values.chunks(count).map(largest).collect();
        let size_of = |item: usize| {
            let own = planes.iter().zip(&sizes).filter(|(plane, _)| plane.item == item);
            own.fold(
                0.0_f64,
                |size, (_, &other)| if other > size || other.is_nan() { other } else { size },
            )
        };
        let mut excess = 0.0_f64;
        let each = 2 + 2 * self.orders.len();
        for ((plane, values), out) in
            planes.iter().zip(values.chunks(count)).zip(out.chunks_mut(each))
        {
            if plane.has_kinks {
                continue;
            }
            let kept = |order: usize| whole || plane.reverses == (order % 2 == 1);
            // Over every second sample and over all. A million equal terms round in the same sense.
            let sum = |order: usize| -> [[f64; 2]; 2] {
                let mut sums = [[DoubleDouble::default(); 2]; 2];
                if kept(order) {
                    for (i, &value) in values.iter().enumerate() {
                        let (sine, cosine) = turn[i * order % (2 * samples)];
                        for (sum, part) in sums[i % 2].iter_mut().zip([cosine, -sine]) {
                            let DoubleDouble { high, low } =
                                DoubleDouble::two_sum(sum.high, value * part);
                            *sum = DoubleDouble { high, low: sum.low + low };
                        }
                    }
                }
                let scale = if order == 0 { 1.0 } else { 2.0 } / count as f64;
                let [second, other] = sums.map(|sum| sum.map(DoubleDouble::value));
                let all = [second[0] + other[0], second[1] + other[1]];
                [second.map(|x| 2.0 * x * scale), all.map(|x| x * scale)]
            };
            let mut apart = 0.0_f64;
            let mut note = |[half, all]: [[f64; 2]; 2]| {
                let off = hypot(all[0] - half[0], all[1] - half[1]);
                apart = if off.is_nan() { off } else { apart.max(off) };
                all
            };
            out[0] = note(sum(0))[0];
            for (&order, out) in self.orders.iter().zip(out[2..].as_chunks_mut::<2>().0) {
                *out = note(sum(order));
            }
            let rounding = self.rounding * size_of(plane.item);
            out[1] = apart + rounding;
            excess = excess.max(apart / if rounding > 0.0 { rounding } else { 1.0 });
        }
        Ok(excess)
    }

    /// Sums between kinks; only of magnitudes, which half a turn does not change.
    fn by_panels(&self, row: usize, planes: &[Symmetry], out: &mut [f64]) -> Result<()> {
        let kinked: Vec<usize> = (0..planes.len()).filter(|&i| planes[i].has_kinks).collect();
        let together = 1 + 2 * self.orders.len();
        let fill = |angles: &[f64], values: &[&[f64]], out: &mut [f64]| {
            let count = angles.len();
            for (&plane, out) in kinked.iter().zip(out.chunks_mut(together * count)) {
                let (mean, amplitudes) = out.split_at_mut(count);
                mean.copy_from_slice(values[plane]);
                for (&order, parts) in self.orders.iter().zip(amplitudes.chunks_mut(2 * count)) {
                    if order % 2 == 1 {
                        continue;
                    }
                    for i in 0..count {
                        let (sine, cosine) = trig::sin_cos(order as f64 * angles[i]);
                        parts[i] = 2.0 * values[plane][i] * cosine;
                        parts[count + i] = -2.0 * values[plane][i] * sine;
                    }
                }
            }
        };
        let integrands = Integrands { count: kinked.len() * together, together, of: &fill };
        let row = RowMeans {
            turns: self.turns,
            index: row,
            integrands: &integrands,
            driven: self.driven,
        };
        let means = row.means()?;
        let each = 2 + 2 * self.orders.len();
        for (&plane, means) in kinked.iter().zip(means.chunks(together)) {
            let out = &mut out[plane * each..][..each];
            let left = means.iter().fold(0.0_f64, |left, mean| left.max(mean.error));
            out[0] = means[0].value;
            out[1] = left + self.rounding * means[0].largest;
            for (out, mean) in out[2..].iter_mut().zip(&means[1..]) {
                *out = mean.value;
            }
        }
        Ok(())
    }

    /// Samples of half a turn, of which every second leaves an error below rounding.
    fn samples(&self, row: usize) -> usize {
        let highest = self.orders.iter().copied().max().unwrap_or(2) as f64 / 2.0;
        let k = self.steepness(row);
        let decay = if k > 0.0 { -ln(k) } else { f64::INFINITY };
        let length = if decay > 0.0 { 40.0 / decay } else { MOST as f64 };
        // Products of several ratios have poles of higher order, whose amplitudes decay later.
        let wanted = 2.0 * (highest + 2.0 + length * (1.0 + 0.1 * ln_1p(length)));
        let fewest = FEWEST.max(4.0 * (highest + 1.0));
        (fewest.max(wanted.min(MOST as f64)).ceil() as usize).next_power_of_two()
    }

    /// The largest `k` of any shaft. Deviations change the rate at which orders decrease only a
    /// little.
    fn steepness(&self, row: usize) -> f64 {
        let rows = self.turns.rows;
        let joints = self.turns.plan.joint_count;
        let of_shaft = |shaft: usize| {
            let [bends, twists, phases] = rows.chain(row, joints, shaft);
            Equivalent::of_chain(bends, twists, phases).joint.k
        };
        let steepest = (1..=joints).map(of_shaft).fold(0.0, f64::max);
        if self.driven.is_none() {
            return steepest;
        }
        // Steps in the hyperbolic plane, in which a chain's q is a point at distance 2 artanh k.
        let last = of_shaft(joints);
        (steepest + last) / (1.0 + steepest * last)
    }
}

/// The largest magnitude; NaN if there is one.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |largest, value| {
        let size = value.abs();
        if size > largest || size.is_nan() { size } else { largest }
    })
}
