//! Drivelines and loads, broadcast to rows: one turn each, on several threads if there are many.

use std::sync::OnceLock;
use std::sync::atomic::Ordering;

use crate::error::{Error, Result};
use crate::input::table::check_reach;
use crate::input::{Angles, Drivelines, Load, Samples, Source};
use crate::number::Precision;
use crate::plan::steps::Plan;
use crate::run::driven;
use crate::run::execution::{Execution, Planes};
use crate::run::queue::{threads, work_off};

/// On the calling thread.
const ALONE: Execution<'_> =
    Execution { level: None, workers: Some(1), stop: None, new_memory: false };

/// Drivelines and loads that are constant over a turn, broadcast to rows.
#[derive(Clone, Debug)]
pub struct Rows<'a> {
    /// The shape of the rows.
    pub shape: &'a [usize],
    /// The drivelines.
    pub lines: Drivelines<'a>,
    /// One stride per axis of the rows, in drivelines.
    pub line_strides: &'a [usize],
    /// The load, if there is one.
    pub load: Option<Load<'a>>,
}

impl Rows<'_> {
    /// The number of rows.
    pub fn count(&self) -> usize {
        self.shape.iter().product()
    }

    /// Checks that the arrays fit together and that the strides stay within them.
    pub(crate) fn check(&self, plan: &Plan) -> Result<()> {
        if self.count() == 0 {
            return Ok(());
        }
        let count = plan.check_lines(&self.lines)?;
        check_reach("drivelines", count, self.shape, self.line_strides)?;
        for (name, source) in self.sources() {
            check_reach(name, source.data.len(), self.shape, source.strides)?;
        }
        Ok(())
    }

    /// The arrays of the load with their names.
    fn sources(&self) -> impl Iterator<Item = (&'static str, &Source<'_>)> {
        self.load.iter().flat_map(|load| {
            let motion = [
                ("torque", &load.torque),
                ("speed", &load.speed),
                ("acceleration", &load.acceleration),
            ];
            motion.into_iter().chain(load.inertias.iter().map(|(_, source)| ("inertias", source)))
        })
    }

    /// The element of an array in a row.
    fn place(&self, strides: &[usize], mut row: usize) -> usize {
        let mut place = 0;
        for (&length, &stride) in self.shape.iter().zip(strides).rev() {
            place += row % length * stride;
            row /= length;
        }
        place
    }

    /// The number of a row's driveline.
    pub(crate) fn line(&self, row: usize) -> usize {
        self.place(self.line_strides, row)
    }

    /// Bends, twists and phases of the chain to a shaft, from 1 on, of a row's driveline.
    pub(crate) fn chain(&self, row: usize, joints: usize, shaft: usize) -> [&[f64]; 3] {
        let line = self.line(row);
        let of = |array, each: usize, count| part(array, line * each, count);
        let between = joints - 1;
        [
            of(self.lines.bends, joints, shaft),
            of(self.lines.twists, between, shaft - 1),
            of(self.lines.phases, between, shaft - 1),
        ]
    }

    /// Copies of what belongs to some rows.
    pub(crate) fn gathered(&self, rows: &[usize], joints: usize) -> Gathered {
        let count = self.lines.bends.len() / joints;
        let lines = self.lines.arrays().map(|array| {
            let each = array.len() / count;
            rows.iter().flat_map(|&row| &array[self.line(row) * each..][..each]).copied().collect()
        });
        let of = |(_, source): (_, &Source<'_>)| {
            rows.iter().map(|&row| source.data[self.place(source.strides, row)]).collect()
        };
        let shafts = self.load.iter().flat_map(|load| &load.inertias).map(|&(shaft, _)| shaft);
        Gathered {
            count: rows.len(),
            lines,
            load: self.sources().map(of).collect(),
            shafts: shafts.collect(),
        }
    }
}

/// The drivelines and loads of some rows.
#[derive(Debug)]
pub(crate) struct Gathered {
    count: usize,
    lines: [Vec<f64>; 8],
    /// Torque, speed, acceleration, and the inertias of `shafts`, if there is a load.
    load: Vec<Vec<f64>>,
    shafts: Vec<usize>,
}

impl Gathered {
    /// The drive angles at angles of the last shaft of one row, and their error terms.
    pub(crate) fn drive_angles(&self, joints: usize, angles: &[f64]) -> Result<[Vec<f64>; 2]> {
        let samples = Samples {
            shape: &[angles.len()],
            lines: self.lines(),
            line_strides: &[0],
            angle: Angles::Array(Source { data: angles, strides: &[1] }),
            load: None,
        };
        let mut found = [(); 2].map(|()| vec![0.0; angles.len()]);
        driven::drive_angles(joints, &samples, found.each_mut().map(Vec::as_mut_slice), ALONE)?;
        Ok(found)
    }

    fn lines(&self) -> Drivelines<'_> {
        Drivelines::from_arrays(self.lines.each_ref().map(Vec::as_slice))
    }

    /// Evaluates the plan at drive angles, the same number in each row, on the calling thread. The
    /// planes follow each other, of each all rows.
    pub(crate) fn run(
        &self,
        plan: &Plan,
        precision: Precision,
        angles: &[f64],
    ) -> Result<Vec<f64>> {
        self.run_at_sums(plan, precision, angles, None)
    }

    /// The same at sums of drive angles and error terms, if these are given.
    pub(crate) fn run_at_sums(
        &self,
        plan: &Plan,
        precision: Precision,
        angles: &[f64],
        error_terms: Option<&[f64]>,
    ) -> Result<Vec<f64>> {
        let each = angles.len() / self.count;
        let load = match self.load.as_slice() {
            [torque, speed, acceleration, inertias @ ..] => Some(Load {
                torque: by_row(torque),
                speed: by_row(speed),
                acceleration: by_row(acceleration),
                inertias: self.shafts.iter().copied().zip(inertias.iter().map(by_row)).collect(),
            }),
            _ => None,
        };
        let angle = Source { data: angles, strides: &[each, 1] };
        let samples = Samples {
            shape: &[self.count, each],
            lines: self.lines(),
            line_strides: &[1, 0],
            angle: match error_terms {
                Some(error_terms) => Angles::Sums(angle, error_terms),
                None => Angles::Array(angle),
            },
            load,
        };
        let mut values = vec![0.0; plan.planes() * angles.len()];
        let mut planes: Vec<&mut [f64]> = values.chunks_mut(angles.len()).collect();
        plan.run(&samples, None, precision, Planes::Double(&mut planes), ALONE)?;
        Ok(values)
    }
}

/// One value for each row, the same along it.
#[allow(clippy::ptr_arg, reason = "mapped over arrays of the same type")]
fn by_row(values: &Vec<f64>) -> Source<'_> {
    Source { data: values, strides: &[1, 0] }
}

fn part(array: &[f64], start: usize, count: usize) -> &[f64] {
    &array[start..start + count]
}

/// The rows of a piece of work for one thread, and the fewest pieces that use threads.
pub(crate) const PIECE: usize = 32;
const MIN_PARALLEL_PIECES: usize = 4;

/// Calls `work` with the first row of every piece and the piece's part of `out`, which has `each`
/// elements for each row. The first error ends nothing but is returned.
pub(crate) fn each_piece<N: Send>(
    out: &mut [N],
    each: usize,
    execution: Execution<'_>,
    work: impl Fn(usize, &mut [N]) -> Result<()> + Sync,
) -> Result<()> {
    let failed = OnceLock::new();
    let pieces = out.chunks_mut((PIECE * each).max(1)).enumerate();
    let run = |(): &mut (), (piece, out): (usize, &mut [N])| {
        if execution.stop.is_none_or(|stop| !stop.load(Ordering::Relaxed))
            && let Err(error) = work(piece * PIECE, out)
        {
            failed.get_or_init(|| error);
        }
    };
    let threads = threads(pieces.len() >= MIN_PARALLEL_PIECES, execution.workers);
    work_off(pieces, threads, || (), run);
    failed.into_inner().map_or(Ok(()), Err::<(), Error>)
}

/// The same row by row.
pub(crate) fn each_row<N: Send>(
    out: &mut [N],
    each: usize,
    execution: Execution<'_>,
    work: impl Fn(usize, &mut [N]) -> Result<()> + Sync,
) -> Result<()> {
    each_piece(out, each, execution, |first, out| {
        out.chunks_mut(each.max(1)).enumerate().try_for_each(|(i, out)| work(first + i, out))
    })
}
