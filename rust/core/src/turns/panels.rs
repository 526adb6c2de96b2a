//! Means over a turn of functions that have kinks, by Gauss's rules between these.
//!
//! Ideal joints look the same after half a turn, except that their pins have the opposite sense. A
//! pin changes the sense in which it turns in its bearings where it is in the bend plane or normal
//! to it. Between these angles everything is smooth, unless a torque reverses. Panels whose series
//! of Legendre polynomials has not settled are halved until it has: at steep joints, where a
//! function changes within a small part of the turn, and at torques that reverse, about whose zero
//! the panels shrink.

use std::f64::consts::PI;
use std::sync::OnceLock;

use crate::error::{Error, Result};
use crate::input::Drivelines;
use crate::mechanics::chain::{Transfer, shaft_turn};
use crate::mechanics::joint::Joint;
use crate::number::DoubleDouble;
use crate::number::elementary::{atan2, ln};
use crate::plan::steps::Plan;
use crate::run::execution::Execution;
use crate::run::queue::work_off;
use crate::turns::rows::Rows;
use crate::turns::rule::{self, Found, RULES, Rule};

/// The rows of a piece of work for one thread, and the fewest pieces that use threads.
const PIECE: usize = 32;
const MIN_PARALLEL_PIECES: usize = 4;

/// Kinks that are nearer to each other count as one: what is between them adds the square of it.
const APART: f64 = 1e-8;

/// The square of a panel's last coefficients over that of the mean, times the panel's part of the
/// turn, at which it has settled.
const SETTLED: f64 = 1e-15;

/// How often a panel is halved at most, and how many panels are open at a time at most.
const MOST_HALVINGS: usize = 48;
const MOST_PANELS: usize = 1 << 12;

/// Fills the values of functions at some samples, one function after another, from a plan's planes
/// there.
type Fill<'a> = &'a (dyn Fn(&[&[f64]], &mut [f64]) + Sync);

/// Functions of a plan's outputs.
pub(crate) struct Integrands<'a> {
    /// How many there are.
    pub(crate) count: usize,
    pub(crate) of: Fill<'a>,
}

/// The means over a turn of functions of a plan's outputs, `integrands.count` for each row.
///
/// # Errors
/// Arrays whose lengths do not fit together.
pub(crate) fn means(
    plan: &Plan,
    rows: &Rows<'_>,
    integrands: &Integrands<'_>,
    out: &mut [f64],
    execution: Execution<'_>,
) -> Result<()> {
    rows.check(plan)?;
    let failed = OnceLock::new();
    let pieces = out.chunks_mut(PIECE * integrands.count).enumerate();
    let work = |(): &mut (), (piece, out): (usize, &mut [f64])| {
        if execution.stop.is_none_or(|stop| !stop.load(std::sync::atomic::Ordering::Relaxed))
            && let Err(error) = of_piece(plan, rows, integrands, piece * PIECE, out)
        {
            failed.get_or_init(|| error);
        }
    };
    // The pool, which may not exist, is not queried for one thread.
    let alone = execution.workers == Some(1) || pieces.len() < MIN_PARALLEL_PIECES;
    let pool = if alone { 1 } else { rayon::current_num_threads() };
    let threads = execution.workers.map_or(pool, |workers| pool.min(workers));
    work_off(pieces, threads, || (), work);
    failed.into_inner().map_or(Ok(()), Err::<(), Error>)
}

/// The same for the rows from `first` on. Those with equally many panels of the same rule are
/// evaluated together.
fn of_piece(
    plan: &Plan,
    rows: &Rows<'_>,
    integrands: &Integrands<'_>,
    first: usize,
    out: &mut [f64],
) -> Result<()> {
    let joints = plan.joint_count;
    let turn = |i| (i, Turn::new(&rows.lines, rows.line(first + i), joints));
    let mut turns: Vec<(usize, Turn)> = (0..out.len() / integrands.count).map(turn).collect();
    turns.sort_by_key(|(i, turn)| (turn.panels.len(), turn.rule, *i));
    for group in
        turns.chunk_by(|(_, a), (_, b)| a.panels.len() == b.panels.len() && a.rule == b.rule)
    {
        let rule = &RULES[group[0].1.rule];
        let own: Vec<usize> = group.iter().map(|(i, _)| first + i).collect();
        let angles: Vec<f64> =
            group.iter().flat_map(|(_, turn)| angles(rule, &turn.panels)).collect();
        let values = rows.gathered(&own, joints).run(plan, &angles)?;
        let each = angles.len() / group.len();
        for (place, (i, turn)) in group.iter().enumerate() {
            let planes: Vec<&[f64]> =
                values.chunks(angles.len()).map(|plane| &plane[place * each..][..each]).collect();
            let means = &mut out[i * integrands.count..][..integrands.count];
            Row { plan, rows, index: first + i, integrands, rule }.settle(
                turn.panels.clone(),
                &planes,
                means,
            )?;
        }
    }
    Ok(())
}

/// An interval of the drive angle: its start and its width.
type Panel = (f64, f64);

/// The drive angles at the nodes of some panels.
fn angles(rule: &Rule, panels: &[Panel]) -> Vec<f64> {
    let of = |&(start, width): &Panel| rule.nodes.iter().map(move |x| start + width * x);
    panels.iter().flat_map(of).collect()
}

/// The panels of half a turn of one driveline, and the index of their rule.
struct Turn {
    panels: Vec<Panel>,
    rule: usize,
}

impl Turn {
    fn new(lines: &Drivelines<'_>, line: usize, joints: usize) -> Self {
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
                kinks.extend([atan2(-sc, ss), atan2(-cc, cs)].map(|kink| kink.rem_euclid(PI)));
            }
            transfer.pass_joint(&own);
            steepest = steepest.max(own.k.high).max(transfer.equivalent().joint.k.high);
        }
        kinks.sort_by(f64::total_cmp);
        kinks.dedup_by(|next, kink| *next - *kink < APART);
        let first = kinks.first().copied().unwrap_or(0.0);
        let ends = kinks.iter().skip(1).copied().chain([first + PI]);
        let starts = if kinks.is_empty() { &[0.0][..] } else { &kinks };
        let panels: Vec<Panel> =
            starts.iter().zip(ends).map(|(&start, end)| (start, end - start)).collect();
        let widest = panels.iter().fold(0.0_f64, |widest, panel| widest.max(panel.1));
        // Functions of a shaft's motion have poles at this distance from the real axis.
        let distance = -0.5 * ln(steepest.max(f64::MIN_POSITIVE));
        Self { panels, rule: rule::choose(widest, distance) }
    }
}

/// One row and the rule of its panels.
struct Row<'a> {
    plan: &'a Plan,
    rows: &'a Rows<'a>,
    index: usize,
    integrands: &'a Integrands<'a>,
    rule: &'a Rule,
}

impl Row<'_> {
    /// The means, from the planes of the first panels.
    fn settle(&self, first: Vec<Panel>, planes: &[&[f64]], means: &mut [f64]) -> Result<()> {
        let mut open = first;
        let mut found = self.found(planes, open.len());
        let mut settled = vec![0.0; means.len()];
        means.fill(0.0);
        for halvings in 0.. {
            let each = || open.iter().zip(found.chunks(means.len()));
            let mut sizes = settled.clone();
            for (&(_, width), found) in each() {
                for (size, found) in sizes.iter_mut().zip(found) {
                    *size += found.mean.abs() * width;
                }
            }
            let last = halvings == MOST_HALVINGS || open.len() > MOST_PANELS;
            let mut halves = vec![];
            for (&(start, width), found) in each() {
                // NaN settles.
                let unsettled = |(found, size): (&Found, &f64)| {
                    found.tail * found.tail * width * PI > SETTLED * size * size
                };
                if !last && found.iter().zip(&sizes).any(unsettled) {
                    halves.extend([(start, 0.5 * width), (start + 0.5 * width, 0.5 * width)]);
                    continue;
                }
                for ((mean, size), found) in means.iter_mut().zip(&mut settled).zip(found) {
                    *mean += found.mean * width / PI;
                    *size += found.mean.abs() * width;
                }
            }
            if halves.is_empty() {
                break;
            }
            open = halves;
            let angles = angles(self.rule, &open);
            let values =
                self.rows.gathered(&[self.index], self.plan.joint_count).run(self.plan, &angles)?;
            let planes: Vec<&[f64]> = values.chunks(angles.len()).collect();
            found = self.found(&planes, open.len());
        }
        Ok(())
    }

    /// What the rule finds of each function in each of some panels, panel by panel.
    fn found(&self, planes: &[&[f64]], panels: usize) -> Vec<Found> {
        let (count, order) = (self.integrands.count, self.rule.nodes.len());
        let mut values = vec![0.0; count * panels * order];
        (self.integrands.of)(planes, &mut values);
        let mut found = vec![Found::default(); count * panels];
        for (function, values) in values.chunks(panels * order).enumerate() {
            for (panel, values) in values.chunks(order).enumerate() {
                found[panel * count + function] = self.rule.of(values);
            }
        }
        found
    }
}
