//! Running a plan: blocks for the threads, rows of one driveline, chunks for the cache.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use fearless_simd::Level;
use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::input::table::{GeometryVariation, Table};
use crate::input::{Angles, Drivelines, Samples, Source};
use crate::mechanics::geometry::{Geometry, Vector};
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::number::{Number, Precision};
use crate::plan::reduction::Reduction;
use crate::plan::steps::Plan;
use crate::run::block::{Block, CHUNK, GROUP, SHORT_CHUNK, Shared, StoresAs, Target};
use crate::run::fold::Folded;
use crate::run::level::compiled_for;
use crate::run::long_sweep::LongSweep;

/// Samples per block of a threaded run, at most: some 20 µs of work. A multiple of the chunk.
const BLOCK: usize = 16 * CHUNK;

/// Samples from which threads repay their waking: about 100 µs of work, where one thread and four
/// measure the same for the cheapest output.
const THREADED: usize = 6 * BLOCK;

/// How a run is spread over the machine. Results do not depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Execution<'a> {
    /// The instruction set; the best of the machine if `None`.
    pub level: Option<Level>,
    /// At most so many threads; if `None`, all of rayon's where the work repays them.
    pub workers: Option<usize>,
    /// Once this is set, every thread leaves out the chunks that it has not begun, and the results
    /// are partial.
    pub stop: Option<&'a AtomicBool>,
}

/// The planes of a result, each as long as there are samples.
#[derive(Debug)]
pub enum Planes<'a, 'b> {
    /// Of doubles.
    Double(&'a mut [&'b mut [f64]]),
    /// Of single precision.
    Single(&'a mut [&'b mut [f32]]),
}

/// The folded constants of one driveline, prepared for any number of runs.
#[derive(Clone, Debug)]
pub struct FoldedDriveline(pub(crate) Kept);

#[derive(Clone, Debug)]
pub(crate) enum Kept {
    Single(Folded<f32>),
    Double(Folded<f64>),
    DoubleDouble(Folded<DoubleDouble>),
}

impl Plan {
    /// Folds the first of the drivelines once for all runs.
    ///
    /// # Errors
    /// Arrays of other lengths than one driveline has, or fewer.
    pub fn fold(&self, lines: &Drivelines<'_>, precision: Precision) -> Result<FoldedDriveline> {
        lines.check(self.joint_count)?;
        Ok(FoldedDriveline(match precision {
            Precision::Single => Kept::Single(folded(self, lines)),
            Precision::Double => Kept::Double(folded(self, lines)),
            Precision::DoubleDouble => Kept::DoubleDouble(folded(self, lines)),
        }))
    }

    /// Evaluates the plan at every sample.
    ///
    /// `constants` are what [`Plan::fold`] gives for the only driveline of the samples, if it is
    /// known.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together, a plan with a load without one in the samples.
    pub fn run(
        &self,
        samples: &Samples<'_>,
        constants: Option<&FoldedDriveline>,
        precision: Precision,
        planes: Planes<'_, '_>,
        execution: Execution<'_>,
    ) -> Result<()> {
        let table = Table::new(self.joint_count, self.load.is_some(), samples)?;
        let run = Run::new(self, &table, constants, execution);
        let workers = execution.workers;
        match (precision, planes) {
            (Precision::Single, Planes::Single(planes)) => run.fill::<f32, f32>(planes, workers),
            (Precision::Single, Planes::Double(planes)) => run.fill::<f32, f64>(planes, workers),
            (Precision::Double, Planes::Single(planes)) => run.fill::<f64, f32>(planes, workers),
            (Precision::Double, Planes::Double(planes)) => run.fill::<f64, f64>(planes, workers),
            (Precision::DoubleDouble, Planes::Single(planes)) => {
                run.fill::<DoubleDouble, f32>(planes, workers)
            }
            (Precision::DoubleDouble, Planes::Double(planes)) => {
                run.fill::<DoubleDouble, f64>(planes, workers)
            }
        }
    }

    /// Evaluates the plan and reduces the last axis of the samples; `planes` are as many as
    /// [`Reduction::results`] says, each as long as there are rows.
    ///
    /// # Errors
    /// As [`Plan::run`].
    pub fn reduce(
        &self,
        samples: &Samples<'_>,
        constants: Option<&FoldedDriveline>,
        precision: Precision,
        reduction: Reduction,
        planes: &mut [&mut [f64]],
        execution: Execution<'_>,
    ) -> Result<()> {
        let table = Table::by_rows(self.joint_count, self.load.is_some(), samples)?;
        let run = Run::new(self, &table, constants, execution);
        match precision {
            Precision::Single => run.reduce::<f32>(reduction, planes, execution.workers),
            Precision::Double => run.reduce::<f64>(reduction, planes, execution.workers),
            Precision::DoubleDouble => {
                run.reduce::<DoubleDouble>(reduction, planes, execution.workers)
            }
        }
    }

    /// An upper bound on the bytes that a run allocates apart from its results: folded drivelines and a
    /// chunk of each result per thread, and the partial results of a reduction. `folded` says whether
    /// the only driveline was folded before.
    pub fn scratch_bytes(
        &self,
        samples: &Samples<'_>,
        folded: bool,
        reduction: Option<Reduction>,
        threads: usize,
    ) -> usize {
        let lanes = match samples.line_strides.last() {
            _ if folded => 1,
            Some(0) => GROUP,
            _ => CHUNK,
        };
        let of_joint = 512 * lanes + if samples.load.is_some() { 64 * CHUNK } else { 0 };
        let of_planes = (16 * CHUNK).saturating_mul(self.planes);
        let of_thread = (self.joint_count + 1).saturating_mul(of_joint).saturating_add(of_planes);
        let total = samples.shape.iter().fold(1_usize, |total, &n| total.saturating_mul(n));
        let parts = match (reduction, samples.shape.split_last()) {
            (Some(_), Some((&length, rows))) if length > 0 => {
                let rows = rows.iter().fold(1_usize, |rows, &n| rows.saturating_mul(n));
                rows.saturating_mul(length.div_ceil(BLOCK))
            }
            _ => total.div_ceil(BLOCK),
        };
        let of_parts = parts.saturating_mul(24 * self.planes);
        of_thread.saturating_mul(threads).saturating_add(of_parts)
    }

    /// Evaluates a plan without a load for one driveline; one vector per plane.
    ///
    /// # Errors
    /// As [`Plan::run`].
    ///
    /// ```
    /// use cardan::{Geometry, Output, Plan, Request};
    ///
    /// let joint = Geometry::from_bends(&[0.5], &[], &[])?;
    /// let plan = Plan::new(&Request {
    ///     largest_bends: &joint.bends,
    ///     outputs: &[Output::SpeedRatio],
    ///     shafts: &[1],
    ///     joints: &[],
    ///     load: None,
    ///     inertias: &[],
    /// })?;
    /// let ratio = &plan.evaluate(&joint, &[0.0])?[0];
    /// assert!((ratio[0] - 1.0 / 0.5_f64.cos()).abs() < 1e-15);
    /// # Ok::<(), cardan::Error>(())
    /// ```
    pub fn evaluate(&self, line: &Geometry, angle: &[f64]) -> Result<Vec<Vec<f64>>> {
        let flat = |vectors: &[Vector]| -> Vec<f64> {
            vectors.iter().flat_map(|v| v.iter().copied()).collect()
        };
        let (directions, normals) = (flat(&line.directions), flat(&line.normals));
        let samples = Samples {
            shape: &[angle.len()],
            lines: Drivelines {
                bends: &line.bends,
                twists: &line.twists,
                phases: &line.phases,
                directions: &directions,
                normals: &normals,
            },
            line_strides: &[0],
            angle: Angles::Array(Source { data: angle, strides: &[1] }),
            load: None,
        };
        let mut planes = vec![vec![0.0; angle.len()]; self.planes];
        let mut views: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        let planes_to_fill = Planes::Double(&mut views);
        self.run(&samples, None, Precision::Double, planes_to_fill, Execution::default())?;
        Ok(planes)
    }
}

/// The first driveline folded.
fn folded<T: Number>(plan: &Plan, lines: &Drivelines<'_>) -> Folded<T> {
    let mut folded = Folded::new(plan, 1, false, T::DOUBLED);
    compiled_for!(Level::new(), folded.fold(plan, lines, 1, |_| 0));
    folded
}

/// One call: what it reads and for which instruction set.
struct Run<'a, 's> {
    plan: &'a Plan,
    table: &'a Table<'s>,
    level: Level,
    constants: Option<&'a FoldedDriveline>,
    stop: Option<&'a AtomicBool>,
}

impl<'a, 's> Run<'a, 's> {
    fn new(
        plan: &'a Plan,
        table: &'a Table<'s>,
        constants: Option<&'a FoldedDriveline>,
        execution: Execution<'a>,
    ) -> Self {
        let level = execution.level.unwrap_or_else(Level::new);
        Self { plan, table, level, constants, stop: execution.stop }
    }

    /// Fills the planes, in blocks if threads repay it.
    fn fill<T: StoresAs<W>, W: Float>(
        &self,
        planes: &mut [&mut [W]],
        workers: Option<usize>,
    ) -> Result<()> {
        let total = self.table.samples();
        if planes.len() != self.plan.planes || planes.iter().any(|plane| plane.len() != total) {
            let (found, wanted) = (planes.len(), self.plan.planes);
            let problem = format!("has {found} planes; it needs {wanted} of {total} samples");
            return Err(Error::new("planes", &[], problem));
        }
        if total == 0 || planes.is_empty() {
            return Ok(());
        }
        let size = block_size(total, workers);
        let long_sweep = self.long_sweep();
        if size >= total {
            self.block::<T, W>(&long_sweep, 0..total, Target::Planes(planes));
            return Ok(());
        }
        let mut rests: Vec<_> = planes.iter_mut().map(|plane| plane.chunks_mut(size)).collect();
        let blocks: Vec<Vec<&mut [W]>> = (0..total.div_ceil(size))
            .map(|_| rests.iter_mut().filter_map(Iterator::next).collect())
            .collect();
        blocks.into_par_iter().enumerate().for_each(|(i, mut block)| {
            let samples = i * size..total.min((i + 1) * size);
            self.block::<T, W>(&long_sweep, samples, Target::Planes(&mut block));
        });
        Ok(())
    }

    /// Reduces every row to one number per result. Rows are cut into the same parts whatever the
    /// number of threads, so that sums are the same.
    fn reduce<T: StoresAs<f64>>(
        &self,
        reduction: Reduction,
        out: &mut [&mut [f64]],
        workers: Option<usize>,
    ) -> Result<()> {
        let (rows, length) = (self.table.rows(), self.table.row_length());
        let groups = reduction.groups(self.plan);
        if out.len() != groups.len() || out.iter().any(|plane| plane.len() != rows) {
            let (found, wanted) = (out.len(), groups.len());
            let problem = format!("has {found} planes; it needs {wanted} of {rows} rows");
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
        let long_sweep = self.long_sweep();
        let run = |(i, partials): (usize, &mut [DoubleDouble])| {
            let samples = if parts > 1 {
                let (row, part) = (i / parts, i % parts);
                row * length + part * BLOCK..row * length + length.min((part + 1) * BLOCK)
            } else {
                let first = i * rows_per_block;
                first * length..(first + partials.len() / results) * length
            };
            self.block::<T, f64>(
                &long_sweep,
                samples,
                Target::Reduced(reduction, &groups, partials),
            );
        };
        if block_size(rows * length, workers) >= rows * length {
            partials.chunks_mut(per_block).enumerate().for_each(run);
        } else {
            let blocks = rows.div_ceil(rows_per_block) * parts;
            let most = workers.map_or(1, |workers| blocks.div_ceil(workers.max(1)));
            partials
                .par_chunks_mut(per_block)
                .with_min_len(if workers.is_some() { most } else { 1 })
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

    fn long_sweep<T: Number>(&self) -> LongSweep<T> {
        LongSweep::new(self.plan, self.table, SHORT_CHUNK, self.level)
    }

    /// Runs a range of the samples, compiled for the level.
    fn block<T: StoresAs<W>, W: Float>(
        &self,
        long_sweep: &LongSweep<T>,
        samples: Range<usize>,
        mut target: Target<'_, '_, W>,
    ) {
        if self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed)) {
            return;
        }
        let one = self.table.geometry_variation() == GeometryVariation::One;
        // What is kept has no constants for twice the angle, but where the number type needs them.
        let kept = self
            .constants
            .and_then(T::kept)
            .filter(|_| one && (T::DOUBLED || long_sweep.twice.is_none()));
        let spare = match &mut target {
            Target::Planes(planes) => T::direct(planes).is_none(),
            Target::Reduced(..) => true,
        };
        let (plan, table, level, stop) = (self.plan, self.table, self.level, self.stop);
        let shared = Shared { plan, table, level, kept, long_sweep, stop };
        let mut block = Block::<T, W>::new(&shared, &samples, spare);
        block.run(samples, &mut target);
    }
}

/// Samples per block: all of them where threads do not repay their waking.
fn block_size(total: usize, workers: Option<usize>) -> usize {
    match workers {
        _ if total < THREADED => total,
        // Without a look at the pool, which may not be there.
        Some(1) => total,
        Some(workers) if workers < rayon::current_num_threads() => {
            total.div_ceil(workers.max(1)).next_multiple_of(BLOCK)
        }
        // Two for each thread at least, so that none waits long for the last one.
        _ => {
            let shared = total.div_ceil(2 * rayon::current_num_threads());
            BLOCK.min(shared.next_multiple_of(CHUNK))
        }
    }
}
