//! Means over a turn of functions that have kinks, by Lobatto's rules between these.
//!
//! Ideal joints look the same after half a turn, except that their pins have the opposite sense. A
//! pin changes the sense in which it turns in its bearings where it is in the bend plane or normal
//! to it. Between these angles everything is smooth, unless a torque reverses. Panels whose series
//! of Legendre polynomials has not settled are halved until it has: at steep joints, where a
//! function changes within a small part of the turn, and at torques that reverse, about whose zero
//! the panels shrink.

use std::f64::consts::PI;

use crate::error::Result;
use crate::input::Drivelines;
use crate::mechanics::chain::{Transfer, shaft_turn};
use crate::mechanics::joint::Joint;
use crate::number::DoubleDouble;
use crate::number::elementary::{atan2, ln};
use crate::run::execution::Execution;
use crate::turns::rows::each_piece;
use crate::turns::rule::{self, LobattoRule, PanelMean, RULES};
use crate::turns::{Driven, Turns};

/// Kinks that are nearer to each other count as one: what is between them adds the square of it.
const APART: f64 = 1e-8;

/// The part of a mean that a panel adds to its error at most, once it has settled.
const SETTLED: f64 = 2e-15;

/// How often a panel is halved at most, and how many panels may be open for each of the first ones.
/// Kinks and narrow peaks keep a few of them open; where all are, the rounding of a steep chain is what
/// does not settle.
const MOST_HALVINGS: usize = 48;
const MOST_OPEN: usize = 32;

/// Fills the values of functions at some samples, one function after another, from their angles and
/// a plan's planes there.
type Fill<'a> = &'a (dyn Fn(&[f64], &[&[f64]], &mut [f64]) + Sync);

/// Functions of a plan's outputs.
pub(crate) struct Integrands<'a> {
    /// How many there are.
    pub(crate) count: usize,
    /// How many of them follow each other whose errors count beside the first one's mean.
    pub(crate) together: usize,
    /// Their values.
    pub(crate) of: Fill<'a>,
}

/// A mean over a turn, with a bound on what its panels leave out.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mean {
    pub(crate) value: f64,
    pub(crate) error: f64,
    /// The largest magnitude that was met.
    pub(crate) largest: f64,
}

impl Turns<'_> {
    /// The means over a turn of the drive of functions of the outputs, `integrands.count` for each
    /// row.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together.
    pub(crate) fn means(
        &self,
        integrands: &Integrands<'_>,
        out: &mut [f64],
        execution: Execution<'_>,
    ) -> Result<()> {
        self.rows.check(self.plan)?;
        each_piece(out, integrands.count, execution, |first, out| {
            self.means_of_piece(integrands, first, out)
        })
    }

    /// The same for the rows from `first` on. Those with equally many panels of the same rule are
    /// evaluated together.
    fn means_of_piece(
        &self,
        integrands: &Integrands<'_>,
        first: usize,
        out: &mut [f64],
    ) -> Result<()> {
        let (rows, joints) = (self.rows, self.plan.joint_count);
        let cut = |i| (i, Cut::of(&rows.lines, rows.line(first + i), joints));
        let mut cuts: Vec<(usize, Cut)> = (0..out.len() / integrands.count).map(cut).collect();
        let key = |cut: &Cut| (cut.panels.len(), cut.rule);
        cuts.sort_by_key(|(i, cut)| (key(cut), *i));
        for group in cuts.chunk_by(|(_, a), (_, b)| key(a) == key(b)) {
            let own: Vec<usize> = group.iter().map(|(i, _)| first + i).collect();
            let angles: Vec<f64> = group.iter().flat_map(|(_, cut)| cut.angles()).collect();
            let values = self.values(&own, &angles)?;
            let each = angles.len() / group.len();
            for (place, (i, cut)) in group.iter().enumerate() {
                let start = place * each;
                let planes = values.chunks(angles.len()).map(|plane| &plane[start..][..each]);
                let planes: Vec<&[f64]> = planes.collect();
                let row = RowMeans { turns: self, index: first + i, integrands, driven: None };
                let means = row.settled(cut, &angles[start..][..each], &planes)?;
                for (out, mean) in out[i * integrands.count..].iter_mut().zip(means) {
                    *out = mean.value;
                }
            }
        }
        Ok(())
    }
}

/// An interval of the angle: its start and its width.
type Panel = (f64, f64);

/// Half a turn of one driveline, cut into panels, and the index of their rule.
pub(crate) struct Cut {
    panels: Vec<Panel>,
    rule: usize,
}

impl Cut {
    /// The panels between the kinks of a driveline over the drive angle.
    fn of(lines: &Drivelines<'_>, line: usize, joints: usize) -> Self {
        let of = |array: &[f64], each: usize, item: usize| array[line * each + item];
        let (mut transfer, mut steepest, mut kinks) = (Transfer::default(), 0.0_f64, vec![]);
        for joint in 0..joints {
            if joint > 0 {
                let [phase, twist] =
                    [lines.phases, lines.twists].map(|array| of(array, joints - 1, joint - 1));
                transfer.pass_shaft(shaft_turn(phase, twist));
            }
            let own = Joint::with_error_terms(of(lines.bends, joints, joint));
            if own.k.high > 0.0 {
                // Cosine and sine of the joint's input angle over cosine and sine of the drive's.
                let [cc, cs, sc, ss] = transfer.matrix().map(DoubleDouble::value);
                kinks.extend([atan2(-sc, ss), atan2(-cc, cs)]);
            }
            transfer.pass_joint(&own);
            steepest = steepest.max(own.k.high).max(transfer.equivalent().joint.k.high);
        }
        Self::between(kinks, steepest)
    }

    /// The panels between some kinks, of functions whose series falls like the powers of `k`.
    fn between(kinks: Vec<f64>, k: f64) -> Self {
        let mut kinks: Vec<f64> = kinks.into_iter().map(|kink| kink.rem_euclid(PI)).collect();
        kinks.sort_by(f64::total_cmp);
        kinks.dedup_by(|next, kink| *next - *kink < APART);
        if kinks.is_empty() {
            kinks.push(0.0);
        }
        let ends = kinks.iter().skip(1).copied().chain([kinks[0] + PI]);
        let panels: Vec<Panel> =
            kinks.iter().zip(ends).map(|(&start, end)| (start, end - start)).collect();
        let widest = panels.iter().fold(0.0_f64, |widest, panel| widest.max(panel.1));
        // Functions of a shaft's motion have poles at this distance from the real axis.
        let distance = -0.5 * ln(k.max(f64::MIN_POSITIVE));
        Self { panels, rule: rule::choose(widest, distance) }
    }

    fn angles(&self) -> Vec<f64> {
        angles(&RULES[self.rule], &self.panels)
    }
}

/// The angles at the nodes of some panels.
fn angles(rule: &LobattoRule, panels: &[Panel]) -> Vec<f64> {
    let of = |&(start, width): &Panel| rule.nodes.iter().map(move |x| start + width * x);
    panels.iter().flat_map(of).collect()
}

/// One row of a turn, over the angle of the last shaft if that is given.
pub(crate) struct RowMeans<'a> {
    pub(crate) turns: &'a Turns<'a>,
    pub(crate) index: usize,
    pub(crate) integrands: &'a Integrands<'a>,
    pub(crate) driven: Option<&'a Driven>,
}

impl RowMeans<'_> {
    /// The means over the turn.
    pub(crate) fn means(&self) -> Result<Vec<Mean>> {
        let (rows, joints) = (self.turns.rows, self.turns.plan.joint_count);
        let mut cut = Cut::of(&rows.lines, rows.line(self.index), joints);
        if let Some(driven) = self.driven {
            let starts: Vec<f64> = cut.panels.iter().map(|panel| panel.0).collect();
            // Over the angle of the last shaft functions are steeper; panels find out how much.
            cut = Cut::between(driven.of_drive(rows, self.index, &starts)?, 0.5);
        }
        let angles = cut.angles();
        let values = self.turns.values_at(self.driven, self.index, &angles)?;
        let planes: Vec<&[f64]> = values.chunks(angles.len()).collect();
        self.settled(&cut, &angles, &planes)
    }

    /// The means, from the planes at the nodes of the first panels.
    fn settled(&self, cut: &Cut, first: &[f64], planes: &[&[f64]]) -> Result<Vec<Mean>> {
        let (count, together) = (self.integrands.count, self.integrands.together);
        let rule = &RULES[cut.rule];
        let mut open = cut.panels.clone();
        let mut found = self.found(rule, first, planes);
        let mut means = vec![Mean::default(); count];
        let mut settled = vec![0.0; count];
        for halvings in 0.. {
            let each = || open.iter().zip(found.chunks(count));
            let mut sizes = settled.clone();
            for (&(_, width), found) in each() {
                for (size, found) in sizes.iter_mut().zip(found) {
                    *size += found.mean.abs() * width / PI;
                }
            }
            let size = |function: usize| sizes[function - function % together];
            let last = halvings == MOST_HALVINGS || open.len() > MOST_OPEN * cut.panels.len();
            let mut halves = vec![];
            for (&(start, width), found) in each() {
                let part = width / PI;
                // NaN settles.
                let unsettled = |(function, found): (usize, &PanelMean)| {
                    found.error * part > SETTLED * size(function)
                };
                if !last && found.iter().enumerate().any(unsettled) {
                    halves.extend([(start, 0.5 * width), (start + 0.5 * width, 0.5 * width)]);
                    continue;
                }
                for (function, found) in found.iter().enumerate() {
                    means[function].value += found.mean * part;
                    means[function].error += PanelMean::LARGER * found.error * part;
                    means[function].largest = means[function].largest.max(found.largest);
                    settled[function] += found.mean.abs() * part;
                }
            }
            if halves.is_empty() {
                break;
            }
            open = halves;
            let angles = angles(rule, &open);
            let values = self.turns.values_at(self.driven, self.index, &angles)?;
            found = self.found(rule, &angles, &values.chunks(angles.len()).collect::<Vec<_>>());
        }
        Ok(means)
    }

    /// Result of the rule for each function in each panel, panel by panel.
    fn found(&self, rule: &LobattoRule, angles: &[f64], planes: &[&[f64]]) -> Vec<PanelMean> {
        let (count, order) = (self.integrands.count, rule.nodes.len());
        let mut values = vec![0.0; count * angles.len()];
        (self.integrands.of)(angles, planes, &mut values);
        let mut found = vec![PanelMean::default(); count * angles.len() / order];
        for (function, values) in values.chunks(angles.len()).enumerate() {
            for (panel, values) in values.chunks(order).enumerate() {
                found[panel * count + function] = rule.of(values);
            }
        }
        found
    }
}
