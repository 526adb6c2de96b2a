//! One call on several threads: its samples are cut into blocks, and rows are reduced in the same
//! parts on any number of threads.

use std::ops::Range;
use std::sync::atomic::Ordering;

use cardan_memory::write_strips;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::input::table::{GeometryVariation, Table};
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::plan::reduction::Reduction;
use crate::plan::route::Routes;
use crate::plan::steps::Plan;
use crate::run::block::{Block, CHUNK, Shared, Target};
use crate::run::execution::Execution;
use crate::run::fold::FoldedDriveline;
use crate::run::level::Level;
use crate::run::stores_as::StoresAs;
use crate::run::sweep_tables::SweepTables;

/// The most samples per block of a threaded run: about 20 µs of work. It is a multiple of the
/// chunk.
pub(crate) const BLOCK: usize = 16 * CHUNK;

/// The fewest samples for which a run uses threads: about 100 µs of work. There one thread and four
/// take the same time for the cheapest output.
const THREADED: usize = 6 * BLOCK;

/// The fewest bytes of angles and results that are stored past the caches. Fewer may still be in a
/// cache when they are read.
const PAST_CACHES: usize = 48 << 20;

/// Whether a run over this number of samples may use several threads.
pub fn uses_threads(samples: usize) -> bool {
    samples >= THREADED
}

/// One call: its plan, its input, and how it uses the machine.
pub(crate) struct Run<'a, 's> {
    pub(crate) plan: &'a Plan,
    pub(crate) table: &'a Table<'s>,
    /// The only driveline, if it was folded before.
    pub(crate) folded: Option<&'a FoldedDriveline>,
    pub(crate) execution: Execution<'a>,
}

impl<'a, 's> Run<'a, 's> {
    /// Fills the planes, in blocks if threads save time.
    pub(crate) fn fill<T: StoresAs<W>, W: Float>(&self, planes: &mut [&mut [W]]) -> Result<()> {
        let workers = self.execution.workers;
        let total = self.table.samples();
        if planes.len() != self.plan.planes || planes.iter().any(|plane| plane.len() != total) {
            let (given, needed) = (planes.len(), self.plan.planes);
            let problem = format!("has {given} planes; it needs {needed} of {total} samples");
            return Err(Error::new("planes", &[], problem));
        }
        if total == 0 || planes.is_empty() {
            return Ok(());
        }
        let size = block_size(total, workers);
        let shared = self.shared::<T, _>();
        if size >= total {
            fill_block(&shared, 0..total, planes);
            return Ok(());
        }
        let mut chunks: Vec<_> = planes.iter_mut().map(|plane| plane.chunks_mut(size)).collect();
        let blocks: Vec<Vec<&mut [W]>> = (0..total.div_ceil(size))
            .map(|_| chunks.iter_mut().filter_map(Iterator::next).collect())
            .collect();
        blocks.into_par_iter().enumerate().for_each(|(i, mut block)| {
            let samples = i * size..total.min((i + 1) * size);
            fill_block(&shared, samples, &mut block);
        });
        Ok(())
    }

    /// Reduces every row to one number per result. Rows are cut into the same parts for any number
    /// of threads, so that sums have the same bits.
    pub(crate) fn reduce<T: StoresAs<f64>>(
        &self,
        reduction: Reduction,
        out: &mut [&mut [f64]],
    ) -> Result<()> {
        let workers = self.execution.workers;
        let (rows, length) = (self.table.rows(), self.table.row_length());
        let groups = reduction.groups(self.plan);
        if out.len() != groups.len() || out.iter().any(|plane| plane.len() != rows) {
            let (given, needed) = (out.len(), groups.len());
            let problem = format!("has {given} planes; it needs {needed} of {rows} rows");
            return Err(Error::new("planes", &[], problem));
        }
        if groups.is_empty() || rows * length == 0 {
            return Ok(());
        }
        let parts = length.div_ceil(BLOCK);
        let rows_per_block = (BLOCK / length).max(1);
        let results = groups.len();
        let mut partials = vec![reduction.start(); rows * parts * results];
        let per_block = rows_per_block * results;
        let shared = self.shared::<T, _>();
        let run = |(i, partials): (usize, &mut [DoubleDouble])| {
            let samples = if parts > 1 {
                let (row, part) = (i / parts, i % parts);
                row * length + part * BLOCK..row * length + length.min((part + 1) * BLOCK)
            } else {
                let first = i * rows_per_block;
                first * length..(first + partials.len() / results) * length
            };
            run_block(&shared, samples, Target::Reduced(reduction, &groups, partials));
        };
        if block_size(rows * length, workers) >= rows * length {
            partials.chunks_mut(per_block).enumerate().for_each(run);
        } else {
            let blocks = rows.div_ceil(rows_per_block) * parts;
            let min_length = workers.map_or(1, |workers| blocks.div_ceil(workers.max(1)));
            partials
                .par_chunks_mut(per_block)
                .with_min_len(if workers.is_some() { min_length } else { 1 })
                .enumerate()
                .for_each(run);
        }
        for row in 0..rows {
            for (result, plane) in out.iter_mut().enumerate() {
                let own = (0..parts).map(|part| partials[(row * parts + part) * results + result]);
                plane[row] = reduction.finish(own, length);
            }
        }
        Ok(())
    }

    /// The data that the blocks of this run share.
    fn shared<T: StoresAs<W>, W: Float>(&self) -> Shared<'a, 's, T> {
        let Self { plan, table, folded, execution } = *self;
        let level = execution.level.unwrap_or_else(Level::new);
        let routes = Routes::of_run(plan, table, T::PRECISION);
        let tables = SweepTables::new(&routes, table.sweep.as_ref(), level);
        // A driveline folded before the run has the constants for arrays of angles.
        let arrays = Routes::of_arrays(plan, T::PRECISION);
        let one = table.geometry_variation() == GeometryVariation::One;
        let usable = one && routes.splits() == arrays.splits();
        let folded = folded.filter(|_| usable).and_then(T::folded);
        let bytes = table.samples().saturating_mul(size_of::<W>()).saturating_mul(plan.planes + 1);
        let past_caches = bytes >= PAST_CACHES;
        Shared { plan, table, level, routes, tables, folded, past_caches, stop: execution.stop }
    }
}

/// Fills planes with a range of the samples.
fn fill_block<T: StoresAs<W>, W: Float>(
    shared: &Shared<'_, '_, T>,
    samples: Range<usize>,
    planes: &mut [&mut [W]],
) {
    write_strips(planes, shared.past_caches, |planes| {
        run_block(shared, samples, Target::Planes(planes));
    });
}

/// Runs a range of the samples.
fn run_block<T: StoresAs<W>, W: Float>(
    shared: &Shared<'_, '_, T>,
    samples: Range<usize>,
    mut target: Target<'_, '_, W>,
) {
    if shared.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
        return;
    }
    let staging = match &mut target {
        Target::Planes(planes) => T::direct(planes).is_none(),
        Target::Reduced(..) => true,
    };
    let mut block = Block::<T, W>::new(shared, &samples, staging);
    block.run(samples, &mut target);
}

/// Samples per block; all of them if threads save no time.
fn block_size(total: usize, workers: Option<usize>) -> usize {
    match workers {
        _ if !uses_threads(total) => total,
        // This does not query the pool, which may not exist.
        Some(1) => total,
        Some(workers) if workers < rayon::current_num_threads() => {
            total.div_ceil(workers.max(1)).next_multiple_of(BLOCK)
        }
        // At least two blocks per thread, so that no thread waits long for the last block.
        _ => {
            let shared = total.div_ceil(2 * rayon::current_num_threads());
            BLOCK.min(shared.next_multiple_of(CHUNK))
        }
    }
}
