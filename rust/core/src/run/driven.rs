//! The drive angles that belong to angles of the last shaft.
//!
//! A chain moves its last shaft as one joint of bend `β` does, whose input angle is the drive angle
//! plus an offset `φ`: with `u` for that input angle and `v` for the angle of the last shaft plus
//! `φ`, `tan u = cos β tan v`. So `tan (u − v) = −(1 − cos β) sin v cos v/(cos² v + cos β sin² v)`,
//! and nothing is iterated.
//!
//! Any function of a drive angle magnifies its error by up to `1/cos β`. Each is therefore the sum
//! of a double and an error term.

use std::sync::atomic::Ordering;

use crate::error::{Error, Result};
use crate::input::Samples;
use crate::input::table::{ANGLE, Table};
use crate::mechanics::chain::{Equivalent, Offset, Transfer, wide_shaft_turn};
use crate::mechanics::exact::{Chains, ExactMap, To};
use crate::mechanics::joint::Joint;
use crate::number::atan::Atan;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Real;
use crate::number::reduction::{self, LargeAngleFlag};
use crate::number::series;
use crate::run::execution::Execution;
use crate::run::level::{Compiled, Level};
use crate::run::queue::work_off;
use crate::run::scratch::CHUNK;
use crate::run::sines;
use crate::run::threads::threads_for;
use crate::sincos::array::{DriveAngles, sample_number};

/// Fills `out` with the drive angles in rad at which the last shaft has the angles of the samples,
/// and with the error terms of these doubles. The drivelines have `joints` ideal joints each. A
/// drive angle and its error term are within `2⁻¹⁰⁰/cos β` of the exact angle, in parts of it or of
/// 1 rad, if that is more.
///
/// # Errors
/// Arrays whose lengths do not fit together.
pub fn drive_angles(
    joints: usize,
    samples: &Samples<'_>,
    out: [&mut [f64]; 2],
    execution: Execution<'_>,
) -> Result<()> {
    let table = Table::new(joints, false, samples)?;
    let total = table.samples();
    if let Some(plane) = out.iter().find(|plane| plane.len() != total) {
        let problem = format!("has {} elements; there are {total} samples", plane.len());
        return Err(Error::new("out", &[], problem));
    }
    if total == 0 {
        return Ok(());
    }
    let level = execution.level.unwrap_or_else(Level::new);
    let [highs, lows] = out.map(|plane| plane.chunks_mut(CHUNK));
    let run = |buffers: &mut [Vec<f64>; 2], (i, (high, low)): (usize, (&mut [f64], &mut [f64]))| {
        if execution.stop.is_none_or(|stop| !stop.load(Ordering::Relaxed)) {
            fill_piece(level, &table, table.lines.chains(joints), i * CHUNK, [high, low], buffers);
        }
    };
    let pieces = highs.zip(lows).enumerate();
    work_off(pieces, threads_for(total, execution.workers), <[Vec<f64>; 2]>::default, run);
    Ok(())
}

/// Fills the results of consecutive samples, row by row.
fn fill_piece(
    level: Level,
    table: &Table<'_>,
    chains: Chains<'_>,
    first: usize,
    [high, low]: [&mut [f64]; 2],
    buffers: &mut [Vec<f64>; 2],
) {
    let (length, mut at) = (table.row_length(), 0);
    while at < high.len() {
        let (row, sample) = ((first + at) / length, (first + at) % length);
        let (line, each) = table.locate(&table.line, row);
        let (angle, step) = table.locate(&table.columns[ANGLE].strides, row);
        // The samples that share a driveline.
        let count = if each == 0 { (length - sample).min(high.len() - at) } else { 1 };
        let place = [angle + sample * step, step, count];
        let driven = sines::drive_angles(table, None, place, buffers);
        let inverse = Inverse::new(chains, line + sample * each);
        let [high, low] = [&mut high[at..at + count], &mut low[at..at + count]];
        DoubleDouble::run(
            level,
            #[inline(always)]
            |_, _| inverse.fill(driven, [&mut *high, &mut *low]),
        );
        at += count;
    }
}

/// Data to turn the angles of one driveline's last shaft back.
struct Inverse {
    offset: Offset,
    /// `cos β` and `1 − cos β`.
    cos: DoubleDouble,
    versine: DoubleDouble,
}

impl Inverse {
    fn new(chains: Chains<'_>, line: usize) -> Self {
        let (first, between) = (line * chains.joints, line * (chains.joints - 1));
        let mut map = Transfer::default();
        let (mut sum, mut product) = (0.0, 1.0);
        for j in 0..chains.joints {
            if j > 0 {
                let (phase, twist) =
                    (chains.phases[between + j - 1], chains.twists[between + j - 1]);
                map.pass_shaft(wide_shaft_turn(phase, twist));
            }
            let joint = Joint::of_chain(chains.bends[first + j]);
            map.pass_joint(&joint);
            map = map.renormalized();
            sum += joint.k.high;
            product *= 1.0 + joint.k.high;
        }
        if map.loses_digits(sum, product) {
            map = ExactMap::new(chains, line, To::Shaft(chains.joints)).transfer();
        }
        let equivalent = map.equivalent();
        let Equivalent { joint: Joint { cos, versine, .. }, .. } = equivalent;
        Self { offset: equivalent.offset(), cos, versine }
    }

    #[inline(always)]
    fn fill(&self, driven: DriveAngles<'_>, [high, low]: [&mut [f64]; 2]) {
        let length = high.len();
        let low = &mut low[..length];
        match driven {
            DriveAngles::Array(angle) => {
                let angle = &angle[..length];
                let mut too_large = LargeAngleFlag::for_quadrants();
                for i in 0..length {
                    let angle = DoubleDouble::exact(angle[i]);
                    let reduced = reduction::reduce_double_double(angle);
                    too_large.accumulate(reduced.1);
                    DoubleDouble { high: high[i], low: low[i] } = self.of(angle, reduced);
                }
                if too_large.any() {
                    for i in 0..length {
                        let reduced = reduction::reduce_any(angle[i]);
                        DoubleDouble { high: high[i], low: low[i] } =
                            self.of(DoubleDouble::exact(angle[i]), reduced);
                    }
                }
            }
            DriveAngles::Sweep(sweep, first) => {
                let reduction = sweep.reduction();
                for i in 0..length {
                    let i_th = sample_number(first, i);
                    DoubleDouble { high: high[i], low: low[i] } =
                        self.of(sweep.angle(i_th), reduction.of(i_th));
                }
            }
            DriveAngles::Sums(..) | DriveAngles::Selected(..) => {
                unreachable!("angles of the last shaft are an array or a sweep")
            }
        }
    }

    /// The drive angle at an angle of the last shaft, which is given reduced as well.
    #[inline(always)]
    fn of(&self, driven: DoubleDouble, reduced: (DoubleDouble, u64)) -> DoubleDouble {
        let (s, c) = series::sin_cos(self.offset.after(reduced, false));
        let y = -(self.versine * (s * c));
        let x = c.square() + self.cos * s.square();
        // One step of Newton's method doubles the digits.
        let near = f64::atan_any(y.high, x.high);
        let (s, c) = series::sin_cos(reduction::reduce_double_double(DoubleDouble::exact(near)));
        let rest = (y * c - x * s).value() / x.high.mul_add(c.high, y.high * s.high);
        (driven + DoubleDouble::new(near, rest)).renormalized()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::{Angles, Drivelines, Source};

    #[test]
    fn angles_of_any_size_are_turned_back() {
        let (bend, angles) = ([1.57], [0.0, -0.3, 1.5, 7.5, -1e15, 3e20]);
        let samples = Samples {
            shape: &[angles.len()],
            lines: Drivelines {
                bends: &bend,
                directions: &[0.0; 6],
                normals: &[0.0; 3],
                ..Drivelines::default()
            },
            line_strides: &[0],
            angle: Angles::Array(Source { data: &angles, strides: &[1] }),
            load: None,
        };
        let [mut high, mut low] = [[0.0; 6]; 2];
        drive_angles(1, &samples, [&mut high, &mut low], Execution::default()).unwrap();
        let cosine = Joint::of_chain(bend[0]).cos;
        for (i, &driven) in angles.iter().enumerate() {
            let (s, c) = series::sin_cos(reduction::reduce_any(driven));
            let drive = reduction::reduce_any_sum(DoubleDouble::new(high[i], low[i]));
            let (sine, cosine) = (series::sin_cos(drive), cosine);
            // Both directions are the same line.
            let off = sine.0 * c - cosine * s * sine.1;
            assert!(off.value().abs() < 1e-29 * (1.0 + driven.abs()), "{driven}: {off:?}");
            assert!((high[i] - driven).abs() <= std::f64::consts::FRAC_PI_2 + 1e-16 * driven.abs());
        }
        let short = drive_angles(1, &samples, [&mut high[..5], &mut low], Execution::default());
        let error = short.unwrap_err().to_string();
        assert_eq!(error, "out has 5 elements; there are 6 samples");
    }
}
