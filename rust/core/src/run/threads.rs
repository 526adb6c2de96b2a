//! One call on several threads: its samples are cut into pieces, and rows are reduced in the same
//! parts on any number of threads.

use std::ops::Range;
use std::sync::atomic::Ordering;

use cardan_memory::write_strips;

use crate::error::{Error, Result};
use crate::input::sweep::Sweep;
use crate::input::table::{GeometryVariation, Table};
use crate::number::Precision;
use crate::number::float::Float;
use crate::number::trig::Angle;
use crate::plan::output::Output;
use crate::plan::reduction::Reduction;
use crate::plan::route::Routes;
use crate::plan::steps::Plan;
use crate::run::block::{Block, Shared, Target};
use crate::run::execution::Execution;
use crate::run::fold::FoldedDriveline;
use crate::run::level::{Level, compiled_for};
use crate::run::queue::{threads, work_off};
use crate::run::scratch::CHUNK;
use crate::run::stores_as::{StoresAs, first_unwritten, mark_unwritten};
use crate::sincos::rotation::Rotations;
use crate::sincos::tangent_sum::TangentSum;

/// The most samples in a part of a row that is reduced: about 20 µs of work. It is a multiple of
/// the chunk.
pub(crate) const BLOCK: usize = 16 * CHUNK;

/// The fewest samples for which a run uses threads: about 70 µs of work. There the calling thread
/// alone and with a pool that has to wake up take the same time.
const THREADED: usize = 4 * BLOCK;

/// The fewest samples for each thread that is woken.
const SHARE: usize = BLOCK;

/// The most samples of a piece that a thread takes from the queue: drivelines of so many rows are
/// folded together, and a period is computed once per piece.
const LONGEST: usize = 4 * BLOCK;

/// The fewest bytes of angles and results that are stored past the caches. Fewer may still be in a
/// cache when they are read.
const PAST_CACHES: usize = 48 << 20;

/// The fewest bytes of angles and results that do not stay in the second-level cache of most cores.
/// Strips of single-precision numbers then request the memory of the next results. Doubles take so much
/// time between two stores that requests gain nothing.
const PAST_OWN_CACHE: usize = 3 << 19;

/// The fewest bytes of results for which the allocator of glibc always gets new pages.
const NEW_PAGES: usize = 32 << 20;

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
        let total = self.table.samples();
        if planes.len() != self.plan.planes || planes.iter().any(|plane| plane.len() != total) {
            let (given, needed) = (planes.len(), self.plan.planes);
            let problem = format!("has {given} planes; it needs {needed} of {total} samples");
            return Err(Error::new("planes", &[], problem));
        }
        if total == 0 || planes.is_empty() {
            return Ok(());
        }
        if cfg!(debug_assertions) {
            mark_unwritten(planes);
        }
        self.fill_pieces::<T, W>(planes);
        if cfg!(debug_assertions)
            && self.execution.stop.is_none_or(|stop| !stop.load(Ordering::Relaxed))
            && let Some(plane) = first_unwritten(planes)
        {
            let of = |output: &Output| vec![output.row().name; output.components()];
            let names: Vec<&str> = self.plan.outputs.iter().flat_map(of).collect();
            panic!("nothing writes {}", names[plane]);
        }
        Ok(())
    }

    fn fill_pieces<T: StoresAs<W>, W: Float>(&self, planes: &mut [&mut [W]]) {
        let total = self.table.samples();
        let threads = threads_for(total, self.execution.workers);
        let shared = self.shared::<T, _>();
        let staging = T::direct(&mut []).is_none();
        let new_block = |longest| Block::<T, W>::new(&shared, self.rows_of(longest), staging);
        let fill = |block: &mut Block<'_, '_, T, W>, samples, planes: &mut [&mut [W]]| {
            write_strips(planes, shared.past_caches, |planes| {
                block.run(samples, &mut Target::Planes(planes));
            });
        };
        if threads == 1 {
            return fill(&mut new_block(total), 0..total, planes);
        }
        let pieces = Pieces {
            planes: planes.iter_mut().map(|plane| &mut **plane).collect(),
            rest: 0..total,
            threads,
        };
        work_off(
            pieces,
            threads,
            || new_block(LONGEST),
            |block, (samples, mut planes)| fill(block, samples, &mut planes),
        );
    }

    /// Reduces every row to one number per result. Rows are cut into the same parts for any number
    /// of threads, so that sums have the same bits.
    pub(crate) fn reduce<T: StoresAs<f64>>(
        &self,
        reduction: Reduction,
        out: &mut [&mut [f64]],
    ) -> Result<()> {
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
        let run = |block: &mut Block<'_, '_, T, f64>, (i, partials): (usize, &mut [_])| {
            let samples = if parts > 1 {
                let (row, part) = (i / parts, i % parts);
                row * length + part * BLOCK..row * length + length.min((part + 1) * BLOCK)
            } else {
                let first = i * rows_per_block;
                first * length..(first + partials.len() / results) * length
            };
            block.run(samples, &mut Target::Reduced(reduction, &groups, partials));
        };
        let new_block = || Block::new(&shared, rows_per_block, true);
        let threads = threads_for(rows * length, self.execution.workers);
        work_off(partials.chunks_mut(per_block).enumerate(), threads, new_block, run);
        for row in 0..rows {
            for (result, plane) in out.iter_mut().enumerate() {
                let own = (0..parts).map(|part| partials[(row * parts + part) * results + result]);
                plane[row] = reduction.finish(own, length);
            }
        }
        Ok(())
    }

    /// The most rows that so many samples, one after another, can touch.
    fn rows_of(&self, samples: usize) -> usize {
        self.table.rows().min(samples / self.table.row_length() + 2)
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
        let of_plane = table.samples().saturating_mul(size_of::<W>());
        // The system clears a new page at the first store to it, which leaves its lines in the
        // caches: stores past them would write these back first.
        let new_pages = execution.new_memory && of_plane.saturating_mul(plan.planes) >= NEW_PAGES;
        let bytes = of_plane.saturating_mul(plan.planes + 1);
        let past_caches = bytes >= PAST_CACHES && !new_pages;
        let is_single = T::PRECISION == Precision::Single;
        let asks_results = is_single && bytes >= PAST_OWN_CACHE && !past_caches;
        let stop = execution.stop;
        Shared { plan, table, level, routes, tables, folded, past_caches, asks_results, stop }
    }
}

/// The planes of the samples that no thread has begun, cut off piece by piece.
struct Pieces<'p, W> {
    planes: Vec<&'p mut [W]>,
    rest: Range<usize>,
    threads: usize,
}

impl<'p, W> Iterator for Pieces<'p, W> {
    type Item = (Range<usize>, Vec<&'p mut [W]>);

    /// Pieces get shorter towards the end, so that the threads end at nearly the same time.
    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let share = self.rest.len().div_ceil(2 * self.threads).next_multiple_of(CHUNK);
        let length = share.min(LONGEST).min(self.rest.len());
        let start = self.rest.start;
        self.rest.start += length;
        let pieces = self.planes.iter_mut().filter_map(|plane| plane.split_off_mut(..length));
        Some((start..start + length, pieces.collect()))
    }
}

/// The number of threads for so many samples, the calling one among them.
pub(super) fn threads_for(samples: usize, workers: Option<usize>) -> usize {
    threads(uses_threads(samples), workers).min((samples / SHARE).max(1))
}

/// The tables that the routes of a run need.
pub(crate) struct SweepTables<T: Angle> {
    /// For sine and cosine of the drive angle, up to a common factor.
    pub(crate) tangent_sum: Option<TangentSum<T>>,
    /// For sine and cosine of twice the drive angle.
    pub(crate) rotations: Option<Rotations<T>>,
}

impl<T: Angle> SweepTables<T> {
    pub(crate) fn new(routes: &Routes, sweep: Option<&Sweep>, level: Level) -> Self {
        let Some(sweep) = sweep else { return Self { tangent_sum: None, rotations: None } };
        let sum = |length| compiled_for!(level, TangentSum::new(sweep, length));
        let rotations = || compiled_for!(level, Rotations::new(sweep));
        Self {
            tangent_sum: routes.tangent_sum.map(sum),
            rotations: routes.needs_rotations().then(rotations),
        }
    }
}
