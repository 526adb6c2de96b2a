//! Running a plan: blocks for the threads, rows of one driveline, chunks for the cache.

use fearless_simd::{Level, dispatch};
use rayon::prelude::*;

use crate::chunk::{self, Scratch};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, Vector};
use crate::plan::Plan;
use crate::samples::{ANGLE, Drivelines, Samples, Source, Table};

/// Samples per chunk: sines and cosines of this length stay in the first-level cache.
const CHUNK: usize = 1024;

/// Samples per block of a threaded run: some 20 µs of work.
const BLOCK: usize = 16 * 1024;

/// Samples from which threads repay their waking: about 100 µs of work, where one thread and four
/// measure the same for the cheapest output.
const THREADED: usize = 6 * BLOCK;

/// How a run is spread over the machine. Results do not depend on it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Execution {
    /// The instruction set; the best of the machine if `None`.
    pub level: Option<Level>,
    /// At most so many threads; if `None`, all of rayon's where the work repays them.
    pub workers: Option<usize>,
}

impl Plan {
    /// Evaluates the plan at every sample; `planes` are the planes of the result, each as long as
    /// there are samples.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together, a plan with a load without one in the samples.
    pub fn run(
        &self,
        samples: &Samples<'_>,
        planes: &mut [&mut [f64]],
        execution: Execution,
    ) -> Result<()> {
        let total = samples.shape.iter().product::<usize>();
        if planes.len() != self.planes || planes.iter().any(|plane| plane.len() != total) {
            let (found, wanted) = (planes.len(), self.planes);
            let problem = format!("has {found} planes; it needs {wanted} of {total} samples");
            return Err(Error::new("planes", &[], problem));
        }
        let table = Table::new(self, samples)?;
        if total == 0 {
            return Ok(());
        }
        let level = execution.level.unwrap_or_else(Level::new);
        let size = match execution.workers {
            _ if total < THREADED => total,
            Some(workers) if workers < rayon::current_num_threads() => {
                total.div_ceil(workers.max(1)).max(BLOCK)
            }
            _ => BLOCK,
        };
        if size >= total {
            run_block(self, &table, level, 0, planes);
            return Ok(());
        }
        let mut rests: Vec<_> = planes.iter_mut().map(|plane| plane.chunks_mut(size)).collect();
        let blocks: Vec<Vec<&mut [f64]>> = (0..total.div_ceil(size))
            .map(|_| rests.iter_mut().filter_map(Iterator::next).collect())
            .collect();
        blocks.into_par_iter().enumerate().for_each(|(i, mut block)| {
            run_block(self, &table, level, i * size, &mut block);
        });
        Ok(())
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
    ///     joint_count: 1,
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
            angle: Source { data: angle, strides: &[1] },
            load: None,
        };
        let mut planes = vec![vec![0.0; angle.len()]; self.planes];
        let mut views: Vec<&mut [f64]> = planes.iter_mut().map(Vec::as_mut_slice).collect();
        self.run(&samples, &mut views, Execution::default())?;
        Ok(planes)
    }
}

/// Runs the block of samples that starts at `start`, compiled for the level.
fn run_block(
    plan: &Plan,
    table: &Table<'_>,
    level: Level,
    start: usize,
    planes: &mut [&mut [f64]],
) {
    let longest = CHUNK.min(table.row_length());
    let mut scratch = Scratch::new(plan, table, longest);
    dispatch!(level, _simd => run_rows(plan, table, &mut scratch, start, planes));
}

#[inline(always)]
fn run_rows(
    plan: &Plan,
    table: &Table<'_>,
    scratch: &mut Scratch,
    start: usize,
    planes: &mut [&mut [f64]],
) {
    let total = planes.first().map_or(0, |plane| plane.len());
    let row_length = table.row_length();
    let mut done = 0;
    while done < total {
        let (row, first) = ((start + done) / row_length, (start + done) % row_length);
        let length = (row_length - first).min(total - done);
        let (line, line_step) = table.locate(&table.line, row);
        for (column, cursor) in table.columns.iter().zip(&mut scratch.cursors) {
            let (origin, step) = table.locate(&column.strides, row);
            *cursor = (origin + first * step, step);
        }
        if line_step == 0 {
            scratch.folded.fold(plan, &table.lines, [line]);
        }
        for at in (0..length).step_by(CHUNK) {
            let size = CHUNK.min(length - at);
            if line_step != 0 {
                let samples = first + at..first + at + size;
                scratch.folded.fold(plan, &table.lines, samples.map(|i| line + i * line_step));
            }
            let place = done + at..done + at + size;
            let (origin, step) = scratch.cursors[ANGLE];
            let angle = table.columns[ANGLE].data;
            if step == 1 {
                let angle = &angle[origin + at..origin + at + size];
                chunk::run_motion(plan, angle, scratch, planes, place.clone());
            } else {
                let mut gathered = [0.0; CHUNK];
                gather(angle, origin + at * step, step, &mut gathered[..size]);
                chunk::run_motion(plan, &gathered[..size], scratch, planes, place.clone());
            }
            if let Some(load) = &plan.load {
                let columns = table.columns.iter().zip(&scratch.cursors);
                for ((column, &(origin, step)), buffer) in
                    columns.zip(&mut scratch.gathered).skip(1)
                {
                    gather(column.data, origin + at * step, step, &mut buffer[..size]);
                }
                chunk::run_load(plan, load, table, scratch, planes, place);
            }
        }
        done += length;
    }
}

#[inline(always)]
fn gather(data: &[f64], origin: usize, step: usize, buffer: &mut [f64]) {
    match step {
        0 => buffer.fill(data[origin]),
        1 => buffer.copy_from_slice(&data[origin..origin + buffer.len()]),
        _ => {
            for (x, &value) in buffer.iter_mut().zip(data[origin..].iter().step_by(step)) {
                *x = value;
            }
        }
    }
}
