//! A block of samples, which one thread runs: rows of the table, cut into chunks.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use cardan_memory::{Plane, Stores};

use crate::input::table::{ANGLE, GeometryVariation, TORQUE, Table};
use crate::number::Number;
use crate::number::double_double::DoubleDouble;
use crate::number::float::Float;
use crate::plan::output::Output;
use crate::plan::reduction::Reduction;
use crate::plan::route::{Pins, Routes};
use crate::plan::steps::Plan;
use crate::run::constants::GeometryIndex;
use crate::run::fold::Folded;
use crate::run::kernels::{self, Chunk};
use crate::run::level::{Level, is_compact};
use crate::run::load::{self, has_even_torque};
use crate::run::motion;
use crate::run::reduce::samples_near_extrema;
use crate::run::scratch::Scratch;
use crate::run::scratch::{SHORT_CHUNK, chunk_length};
use crate::run::sines;
use crate::run::sink::Outputs;
use crate::run::stores_as::StoresAs;
use crate::run::threads::SweepTables;
use crate::sincos::array::DriveAngles;

/// The most rows whose drivelines are folded together.
pub(crate) const GROUP: usize = 64;

/// The destination of a block's results.
pub(crate) enum Target<'a, 'b, W> {
    /// These parts of the planes.
    Planes(&'a mut [Plane<'b, W>]),
    /// A reduction of each row, one number per group of planes.
    Reduced(Reduction, &'a [usize], &'a mut [DoubleDouble]),
}

/// The data that all blocks of a run share.
pub(crate) struct Shared<'a, 's, T: Number> {
    pub(crate) plan: &'a Plan,
    pub(crate) table: &'a Table<'s>,
    pub(crate) level: Level,
    pub(crate) routes: Routes,
    pub(crate) tables: SweepTables<T>,
    /// The only driveline, if it was folded before.
    pub(crate) folded: Option<&'a Folded<T>>,
    /// Whether the results exceed the caches, so that strips are stored past them.
    pub(crate) past_caches: bool,
    /// Whether they exceed the cache of a core, so that strips request the memory of their results.
    pub(crate) asks_results: bool,
    /// Skips the remaining chunks when set.
    pub(crate) stop: Option<&'a AtomicBool>,
}

/// A thread's buffers for the blocks that it runs one after another.
pub(crate) struct Block<'a, 's, T: StoresAs<W>, W: Float> {
    shared: &'a Shared<'a, 's, T>,
    /// The folded drivelines: the only one, those of `rows`, or those of the samples of one chunk.
    folded: Cow<'a, Folded<T>>,
    rows: Range<usize>,
    /// The numbers of the drivelines that are folded next.
    numbers: Vec<usize>,
    /// Samples per chunk.
    chunk_length: usize,
    scratch: Scratch<T>,
    /// Planes for one chunk, if the results are converted or reduced afterwards.
    staging: Vec<Vec<T::Plane>>,
    /// The angles of a chunk and their error terms, if they are not contiguous in the samples.
    angles: [Vec<f64>; 2],
    /// First angle, step and length of the chunks for which `scratch` holds pins, wide pins and
    /// double angles.
    pins_key: Option<(usize, usize, usize)>,
    wide_pins_key: Option<(usize, usize, usize)>,
    double_angles_key: Option<(usize, usize, usize)>,
}

/// Part of a row: the row, its samples, and the offset of its results in the block's planes.
struct RowPart {
    row: usize,
    samples: Range<usize>,
    offset: usize,
}

impl<T: Number> Shared<'_, '_, T> {
    /// Whether chunks begin where results begin a cache line.
    fn aligns_chunks(&self) -> bool {
        self.past_caches && !self.routes.has_rotation() && self.routes.period.is_none()
    }
}

impl<'a, 's, T: StoresAs<W>, W: Float> Block<'a, 's, T, W> {
    /// Buffers for runs of at most so many rows each.
    pub(crate) fn new(shared: &'a Shared<'a, 's, T>, rows: usize, staging: bool) -> Self {
        let Shared { plan, table, ref routes, .. } = *shared;
        let (row_length, one) = (table.row_length(), GeometryIndex::Shared(0));
        let even = plan.load.as_ref().is_some_and(|load| {
            has_even_torque(load, table.locate(&table.columns[TORQUE].strides, 0))
        });
        let pins = shared.folded.filter(|_| !staging).map_or(Pins::Stored, |folded| {
            sines::pins(shared.level, plan, routes, folded, one, row_length, even)
        });
        let chunk_length = chunk_length::<T>(plan, routes, pins, staging);
        let (longest, staged) =
            (chunk_length.min(row_length), if staging { plan.planes } else { 0 });
        let allocate = || {
            let (lines, by_sample) = match table.geometry_variation() {
                GeometryVariation::One => (1, false),
                GeometryVariation::ByRow => (GROUP.min(rows), false),
                GeometryVariation::BySample => (longest, true),
            };
            Cow::Owned(Folded::new(plan, lines, by_sample, routes))
        };
        Self {
            shared,
            folded: shared.folded.map_or_else(allocate, Cow::Borrowed),
            rows: 0..0,
            numbers: vec![],
            chunk_length,
            scratch: Scratch::new(plan, table, longest, routes),
            staging: (0..staged).map(|_| vec![T::Plane::default(); longest]).collect(),
            angles: [vec![], vec![]],
            pins_key: None,
            wide_pins_key: None,
            double_angles_key: None,
        }
    }

    /// Runs the samples, row by row.
    pub(crate) fn run(&mut self, samples: Range<usize>, target: &mut Target<'_, '_, W>) {
        let row_length = self.shared.table.row_length();
        let last_row = (samples.end - 1) / row_length;
        let mut at = samples.start;
        while at < samples.end && !self.stopped() {
            let (row, first) = (at / row_length, at % row_length);
            let end = row_length.min(first + samples.end - at);
            let row_in_block = row - samples.start / row_length;
            let part = RowPart { row, samples: first..end, offset: at - samples.start };
            self.load_row(row, last_row);
            self.row(&part, row_in_block, target);
            at += end - first;
        }
    }

    #[inline(always)]
    fn stopped(&self) -> bool {
        self.shared.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Loads the row: folds its driveline, together with those of the next rows, unless this was
    /// done.
    fn load_row(&mut self, row: usize, last: usize) {
        for (column, cursor) in self.shared.table.columns.iter().zip(&mut self.scratch.cursors) {
            *cursor = self.shared.table.locate(&column.strides, row);
        }
        (self.scratch.keeps_columns, self.scratch.kept_power) = (false, 0);
        let rows = match self.shared.table.geometry_variation() {
            GeometryVariation::One => row..row + 1,
            GeometryVariation::ByRow => row..(last + 1).min(row + GROUP),
            GeometryVariation::BySample => return,
        };
        let is_folded = match (&self.folded, self.shared.table.geometry_variation()) {
            (Cow::Borrowed(_), _) => true,
            (_, GeometryVariation::One) => !self.rows.is_empty(),
            _ => self.rows.contains(&row),
        };
        if is_folded {
            return;
        }
        let table = self.shared.table;
        self.numbers.clear();
        self.numbers.extend(rows.clone().map(|row| table.locate(&table.line, row).0));
        let folded = self.folded.to_mut();
        folded.fold(self.shared.level, self.shared.plan, &table.lines, &self.numbers);
        self.rows = rows;
    }

    /// The columns of the load that the plan needs: only inertias need speed and acceleration.
    fn load_columns(&self) -> Range<usize> {
        match &self.shared.plan.load {
            None => 0..0,
            Some(load) if load.absorbs() => TORQUE..self.shared.table.columns.len(),
            Some(_) => TORQUE..TORQUE + 1,
        }
    }

    /// Runs a part of one row, chunk by chunk.
    fn row(&mut self, part: &RowPart, row_in_block: usize, target: &mut Target<'_, '_, W>) {
        let Range { start, end } = part.samples;
        let stop = match self.period(part, target) {
            Some(period) => start + period,
            None => end,
        };
        // A part that is not repeated may be longer than the period of the row before it.
        let errors = if stop < end {
            stop - start
        } else if self.shared.table.adds_angles_last() || is_compact(self.shared.level) {
            self.chunk_length.min(end - start)
        } else {
            0
        };
        self.scratch.keep_errors(self.shared.plan, errors);
        if let Target::Reduced(reduction, ..) = target
            && let Some(selected) = self.extreme_samples(part.row, start..stop, *reduction)
        {
            for samples in selected.chunks(self.chunk_length) {
                self.chunk(part, 0..samples.len(), Some(samples), row_in_block, target);
            }
            return;
        }
        let mut at = start;
        while at < stop && !self.stopped() {
            let next = self.chunk_end(part, at, stop, target);
            if !self.chunk(part, at..next, None, row_in_block, target) {
                for first in (at..next).step_by(SHORT_CHUNK) {
                    let piece = first..next.min(first + SHORT_CHUNK);
                    self.chunk(part, piece, None, row_in_block, target);
                }
            }
            at = next;
        }
        if stop < end {
            match target {
                Target::Planes(planes) => self.repeat(part, stop - start, planes),
                Target::Reduced(reduction, groups, partials) => {
                    let times = (end - start) / (stop - start);
                    for partial in &mut partials
                        [row_in_block * groups.len()..(row_in_block + 1) * groups.len()]
                    {
                        reduction.repeat(partial, times);
                    }
                }
            }
        }
    }

    /// The end of the chunk that begins at sample `at` of a row. Chunks begin at multiples of their
    /// length, or where the results begin a cache line.
    fn chunk_end(
        &self,
        part: &RowPart,
        at: usize,
        stop: usize,
        target: &mut Target<'_, '_, W>,
    ) -> usize {
        match target {
            Target::Planes(planes) if self.shared.aligns_chunks() => {
                let first = part.offset + at - part.samples.start;
                let plane = planes[0].part(first..first + stop - at);
                match plane.words_before_cache_line() {
                    0 => stop.min(at + self.chunk_length),
                    before => stop.min(at + before),
                }
            }
            _ => stop.min((at / self.chunk_length + 1) * self.chunk_length),
        }
    }

    /// The number of samples after which the results of a row repeat, if they are to be copied.
    fn period(&self, part: &RowPart, target: &Target<'_, '_, W>) -> Option<usize> {
        let period = self.shared.routes.period?;
        let repeats = 2 * period <= part.samples.len();
        match target {
            Target::Planes(_) => repeats.then_some(period),
            // One period of the samples gives the reduction of any whole number of periods.
            Target::Reduced(..) => {
                let whole = part.samples.len().is_multiple_of(period);
                (repeats && whole && !self.shared.plan.needs_angle()).then_some(period)
            }
        }
    }

    /// The samples that can have the smallest or largest value, if they are few.
    fn extreme_samples(
        &self,
        row: usize,
        samples: Range<usize>,
        reduction: Reduction,
    ) -> Option<Vec<f64>> {
        let sweep = self.shared.table.sweep.as_ref()?;
        let (_, along) = self.scratch.cursors[ANGLE];
        let one = self.shared.table.geometry_variation() != GeometryVariation::BySample;
        if !(reduction.is_extreme() && self.shared.plan.has_closed_extremes() && one && along == 1)
        {
            return None;
        }
        let one = self.shared.table.geometry_variation() == GeometryVariation::One;
        let index = if one { 0 } else { row - self.rows.start };
        let shafts = self.shared.plan.moving().filter_map(|step| {
            self.folded.shafts[step.shaft]
                .as_ref()
                .map(|shaft| (step, shaft.extrema_locator(index)))
        });
        samples_near_extrema(sweep, samples, shafts)
    }

    /// Runs one chunk of a row, or samples selected from it. Returns whether it has results: not if an
    /// angle of a long chunk is too large for the loop that finds its pins.
    fn chunk(
        &mut self,
        part: &RowPart,
        samples: Range<usize>,
        selected: Option<&[f64]>,
        row_in_block: usize,
        target: &mut Target<'_, '_, W>,
    ) -> bool {
        let loads = self.load_columns();
        let Self { shared, scratch, .. } = self;
        let &Shared { plan, table, level, ref routes, ref tables, .. } = *shared;
        let (rotations, size) = (tables.rotations.as_ref(), samples.len());
        let (origin, step) = scratch.cursors[ANGLE];
        let begin = origin + samples.start * step;
        let drive = sines::drive_angles(table, selected, [begin, step, size], &mut self.angles);
        let geometry = match table.geometry_variation() {
            GeometryVariation::One => GeometryIndex::Shared(0),
            GeometryVariation::ByRow => GeometryIndex::Shared(part.row - self.rows.start),
            GeometryVariation::BySample => {
                let (line, step) = table.locate(&table.line, part.row);
                self.numbers.clear();
                self.numbers.extend(samples.clone().map(|i| line + i * step));
                self.folded.to_mut().fold(level, plan, &table.lines, &self.numbers);
                GeometryIndex::PerSample
            }
        };
        let folded: &Folded<T> = &self.folded;
        let key = selected.is_none().then_some((begin, step, size));
        let needed = sines::sines_needed(plan, routes, folded, geometry);
        let torque = scratch.cursors.get(TORQUE).copied();
        let even =
            plan.load.as_ref().zip(torque).is_some_and(|(load, at)| has_even_torque(load, at));
        let pins = sines::pins(level, plan, routes, folded, geometry, size, even);
        if needed.pins && pins == Pins::Stored && (key.is_none() || self.pins_key != key) {
            let group = tables.tangent_sum.as_ref();
            kernels::find_pins(level, plan, drive, group, scratch, size);
            self.pins_key = key;
        }
        if needed.wide_pins && (key.is_none() || self.wide_pins_key != key) {
            kernels::find_wide_pins(level, drive, scratch, size);
            self.wide_pins_key = key;
        }
        if needed.double_angles && (key.is_none() || self.double_angles_key != key) {
            kernels::find_double_angles(level, drive, rotations, scratch, size);
            self.double_angles_key = key;
        }
        // Selected samples have no position in the row: they are reduced at once.
        let row_offset = if selected.is_some() { 0 } else { samples.start - part.samples.start };
        let first = part.offset + row_offset;
        let direct = match target {
            Target::Planes(planes) => T::direct(planes),
            Target::Reduced(..) => None,
        };
        let chains = table.lines.chains(plan.joint_count);
        let chunk = Chunk {
            level,
            plan,
            routes,
            drive,
            rotations,
            folded,
            chains,
            geometry,
            size,
            row_offset,
            pins,
        };
        let asks = shared.asks_results && direct.is_some();
        let stored = Chunk { pins: Pins::Stored, ..chunk };
        let mut run = |planes: &mut [Plane<'_, T::Plane>], window: Range<usize>| {
            let outputs = &mut Outputs::new(planes, &window, Stores::ordinary(), drive, asks);
            if plan.is_as_built() {
                let joints = &folded.as_built;
                let buffers = &mut scratch.as_built;
                kernels::find_motion_as_built(level, plan, drive, joints, geometry, buffers, size);
                kernels::store_motion_as_built(&chunk, scratch, outputs);
            } else if !motion::run_motion(&chunk, scratch, outputs) {
                if size > SHORT_CHUNK {
                    return false;
                }
                kernels::find_pins(level, plan, drive, None, scratch, size);
                motion::run_motion(&stored, scratch, outputs);
            }
            let Some(step) = &plan.load else { return true };
            let mut run_load = |chunk: &Chunk<'_, T>, scratch: &mut Scratch<T>| {
                if load::reads_power(plan, step, chunk.pins, even) {
                    scratch.gather(table, loads.clone(), samples.start, size);
                }
                load::run_load(chunk, step, table, scratch, outputs)
            };
            if !run_load(&chunk, scratch) {
                kernels::find_pins(level, plan, drive, None, scratch, size);
                run_load(&stored, scratch);
            }
            true
        };
        if let Some(planes) = direct {
            return run(planes, first..first + size);
        }
        let planes = self.staging.iter_mut().map(|words| Plane::cached(words));
        let has_results = run(&mut planes.collect::<Vec<_>>(), 0..size);
        if has_results {
            self.unstage(first, size, row_in_block, target);
        }
        has_results
    }

    /// Converts or reduces the results of one chunk in `staging`.
    fn unstage(
        &self,
        first: usize,
        size: usize,
        row_in_block: usize,
        target: &mut Target<'_, '_, W>,
    ) {
        let level = self.shared.level;
        match target {
            Target::Planes(planes) => {
                for (plane, words) in planes.iter_mut().zip(&self.staging) {
                    let words = &words[..size];
                    kernels::convert(level, words, &mut plane.words()[first..first + size]);
                }
            }
            Target::Reduced(reduction, groups, partials) => {
                let own =
                    &mut partials[row_in_block * groups.len()..(row_in_block + 1) * groups.len()];
                let mut plane = 0;
                for (partial, &group) in own.iter_mut().zip(*groups) {
                    let planes = &self.staging[plane..plane + group];
                    kernels::reduce(level, *reduction, partial, planes, size);
                    plane += group;
                }
            }
        }
    }

    /// Copies the first period of a row to the rest of it.
    fn repeat(&mut self, part: &RowPart, period: usize, planes: &mut [Plane<'_, W>]) {
        let length = part.samples.len();
        for (i, plane) in planes.iter_mut().enumerate() {
            if !self.shared.plan.is_angle(i) {
                let row = &mut plane.words()[part.offset..part.offset + length];
                let (first, rest) = row.split_at_mut(period);
                for copy in rest.chunks_mut(period) {
                    if self.stopped() {
                        return;
                    }
                    copy.copy_from_slice(&first[..copy.len()]);
                }
            }
        }
        let Some(sweep) = &self.shared.table.sweep else { return };
        let (origin, _) = self.scratch.cursors[ANGLE];
        let angles =
            self.shared.plan.shafts.iter().filter_map(|step| step.planes.get(Output::Angle));
        for (slot, plane) in angles.enumerate() {
            let mut at = period;
            while at < length && !self.stopped() {
                let in_period = at % period;
                let size = (period - in_period).min(length - at).min(self.chunk_length);
                let drive = DriveAngles::Sweep(sweep, origin + part.samples.start + at);
                let place = part.offset + at..part.offset + at + size;
                let (scratch, level) = (&self.scratch, self.shared.level);
                if let Some(direct) = T::direct(planes) {
                    let out = &mut direct[plane].words()[place];
                    kernels::repeat_angle(level, scratch, slot, in_period, drive, out);
                } else {
                    let angles = &mut self.staging[plane][..size];
                    kernels::repeat_angle(level, scratch, slot, in_period, drive, &mut *angles);
                    kernels::convert(level, angles, &mut planes[plane].words()[place]);
                }
                at += size;
            }
        }
    }
}
