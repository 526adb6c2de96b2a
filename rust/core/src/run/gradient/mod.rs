//! Derivatives of outputs by the parameters of drivelines: weighted sums over the samples, in one
//! pass, or those of each sample.
//!
//! The samples of a driveline are cut into the same blocks for any number of threads, and their
//! sums are added in order, so that results have the same bits.

mod as_built;
mod as_built_forces;
mod as_built_sums;
mod blocks;
mod columns;
mod forces;
mod line;
mod load;
mod motion;
mod pulls;
mod sample;

use crate::input::{Drivelines, Sweep};
use crate::mechanics::geometry::Vector;
use crate::mechanics::phasing::is_set;
use crate::number::dual::Dual;
use crate::plan::forces::ForceStep;
use crate::plan::{Axes, End, Output, Per};
use crate::run::execution::Execution;
use crate::run::level::Level;
use crate::run::queue::{threads, work_off};
use blocks::{Buffers, MOTIONS, Part};
use columns::ChunkColumn;
pub use line::{Counts, Wanted};
use line::{LineConstants, Sums};
use motion::CHUNK;
use sample::{Common, LineAt, LoadAt, Pull};

/// The derivatives of joints as built that one pass over the samples finds.
const WIDTH: usize = 4;

/// A number that carries its derivatives by the parameters of a pass through the formulas of joints as
/// built.
type Carried = Dual<WIDTH>;

/// A vector of such numbers.
type Direction = [Carried; 3];

/// The samples of a block that one thread sums.
const BLOCK: usize = 32 * CHUNK;

/// The fewest samples that use threads.
const MIN_PARALLEL: usize = 2 * BLOCK;

/// A value for each sample: `per_line` and `per_sample` are its strides.
#[derive(Clone, Copy, Debug)]
pub struct Spread<'a> {
    /// The elements.
    pub data: &'a [f64],
    /// The step from one driveline to the next.
    pub per_line: usize,
    /// The step from one sample to the next.
    pub per_sample: usize,
}

impl Spread<'_> {
    fn at(&self, line: usize, sample: usize) -> f64 {
        self.data[line * self.per_line + sample * self.per_sample]
    }

    /// Fills a column with some samples of a driveline, of which the last repeats.
    fn fill(&self, line: usize, first: usize, length: usize, column: &mut ChunkColumn) {
        let (known, rest) = column.split_at_mut(length);
        if self.per_sample == 1 {
            let at = line * self.per_line + first;
            known.copy_from_slice(&self.data[at..at + length]);
        } else {
            let samples = known.iter_mut().enumerate();
            samples.for_each(|(i, value)| *value = self.at(line, first + i));
        }
        rest.fill(self.at(line, first + length - 1));
    }

    /// Whether it has an element for each of the samples.
    fn reaches(&self, lines: usize, samples: usize) -> bool {
        if lines == 0 || samples == 0 {
            return true;
        }
        let last = |count: usize, step| (count - 1).saturating_mul(step);
        let index = last(lines, self.per_line).saturating_add(last(samples, self.per_sample));
        index < self.data.len()
    }
}

/// The drive angles of the samples.
#[derive(Clone, Copy, Debug)]
pub enum SpreadAngles<'a> {
    /// In rad.
    Array(Spread<'a>),
    /// The same sweep for each driveline.
    Sweep(Sweep),
}

/// The load of the samples.
#[derive(Clone, Debug)]
pub struct SpreadLoad<'a> {
    /// The end at which the torque is given.
    pub end: End,
    /// In N·m.
    pub torque: Spread<'a>,
    /// Speed of the drive, in rad/s.
    pub speed: Spread<'a>,
    /// Acceleration of the drive, in rad/s².
    pub acceleration: Spread<'a>,
    /// One per shaft, in kg·m²; missing ones are 0.
    pub inertias: Vec<Option<Spread<'a>>>,
}

/// Quantities to differentiate: outputs of drivelines with the same number of samples each.
#[derive(Clone, Debug)]
pub struct Differentiated<'a> {
    /// The number of joints.
    pub joints: usize,
    /// The drivelines.
    pub lines: Drivelines<'a>,
    /// The shaft of each bearing.
    pub bearings: &'a [usize],
    /// The number of samples of each.
    pub samples: usize,
    /// The outputs, each with the shafts, joints or bearings of which it is wanted.
    pub outputs: Vec<(Output, Vec<usize>)>,
    /// The axes of moments.
    pub axes: Axes,
    /// The drive angles.
    pub angle: SpreadAngles<'a>,
    /// Whether derivatives are those at a given angle of the last shaft, which the drive angle
    /// follows.
    pub driven: bool,
    /// The load, if the outputs need one.
    pub load: Option<SpreadLoad<'a>>,
}

impl Differentiated<'_> {
    /// The number of drivelines.
    pub fn line_count(&self) -> usize {
        self.lines.bends.len() / self.joints
    }

    /// The numbers of joints and bearings of each driveline.
    pub fn counts(&self) -> Counts {
        Counts { joints: self.joints, bearings: self.bearings.len() }
    }

    /// Whether its samples are enough for several threads.
    pub fn is_parallel(&self) -> bool {
        self.line_count().saturating_mul(self.samples) >= MIN_PARALLEL
    }

    /// The number of planes: one per item and component.
    pub fn planes(&self) -> usize {
        self.outputs.iter().map(|(output, items)| output.components() * items.len()).sum()
    }

    /// Whether every array has an element for each sample, the load is given if it is needed, and
    /// the forces are determinate.
    pub fn is_complete(&self) -> bool {
        let (lines, samples) = (self.line_count(), self.samples);
        let reaches = |spread: &Spread<'_>| spread.reaches(lines, samples);
        let angles = match &self.angle {
            SpreadAngles::Array(spread) => reaches(spread),
            SpreadAngles::Sweep(sweep) => sweep.count() == samples,
        };
        let of_load = match &self.load {
            Some(load) => {
                let own = [&load.torque, &load.speed, &load.acceleration];
                let inertias = load.inertias.iter().flatten();
                load.inertias.len() == self.joints + 1
                    && own.into_iter().chain(inertias).all(reaches)
            }
            None => !self.outputs.iter().any(|(output, _)| output.needs_load()),
        };
        let known = |(output, items): &(Output, Vec<usize>)| {
            let last = match output.row().per {
                Per::Shaft => self.joints + 1,
                Per::Joint => self.joints,
                Per::Bearing => self.bearings.len(),
            };
            items.iter().all(|&item| item < last)
        };
        let known = self.outputs.iter().all(known);
        angles && of_load && known && self.has_places() && self.forces().is_ok()
    }

    /// Whether lengths and positions of bearings are known, if forces need them.
    fn has_places(&self) -> bool {
        let (lines, lengths) = (self.line_count(), self.lines.lengths.len());
        let fits = lengths == lines * (self.joints + 1)
            && self.lines.positions.len() == lines * self.bearings.len();
        fits || !self.outputs.iter().any(|(output, _)| is_force(*output))
    }

    /// How the wanted forces follow from the moments of the joints.
    fn forces(&self) -> Result<Option<ForceStep>, String> {
        let mut step: Option<ForceStep> = None;
        for (output, items) in self.outputs.iter().filter(|(output, _)| is_force(*output)) {
            let step = step.get_or_insert_with(|| ForceStep::new(self.joints, self.bearings));
            for &item in items {
                match output {
                    Output::JointForce => step.add_joint(item, 0)?,
                    _ => step.add_bearing(item, self.bearings[item], 0)?,
                }
            }
        }
        Ok(step)
    }

    /// Whether all outputs are motions of shafts.
    pub fn only_motion(&self) -> bool {
        self.load.is_none() && self.outputs.iter().all(|(output, _)| is_motion(*output))
    }

    fn line(&self, line: usize) -> LineConstants<'_> {
        let posed = !self.only_motion();
        let asked = |shaft: usize| {
            self.driven && shaft == self.joints
                || self.outputs.iter().any(|(_, items)| items.contains(&shaft))
        };
        LineConstants::new(&self.lines, self.counts(), line, |shaft| posed || asked(shaft), posed)
    }

    fn common<'b>(&self, forces: Option<&'b ForceStep>) -> Common<'b> {
        Common { forces, axes: self.axes, driven: self.driven }
    }

    fn load_at(&self, line: usize, sample: usize) -> Option<LoadAt> {
        let load = self.load.as_ref()?;
        let at = |spread: &Spread<'_>| spread.at(line, sample);
        let inertia = |spread: &Option<Spread<'_>>| spread.as_ref().map_or(0.0, at);
        Some(LoadAt {
            end: load.end,
            torque: at(&load.torque),
            speed: at(&load.speed),
            acceleration: at(&load.acceleration),
            inertias: load.inertias.iter().map(inertia).collect(),
        })
    }

    fn angle_at(&self, line: usize, sample: usize) -> f64 {
        match &self.angle {
            SpreadAngles::Array(spread) => spread.at(line, sample),
            SpreadAngles::Sweep(sweep) => sweep.at(sample),
        }
    }

    /// Sums the weighted outputs of every driveline and their derivatives. `weights` has
    /// [`Differentiated::planes`] planes with one element per driveline and sample, `out` for each
    /// driveline [`Wanted::count`] numbers.
    pub fn gradient(
        &self,
        weights: &[&[f64]],
        wanted: Wanted,
        out: &mut [f64],
        execution: Execution<'_>,
    ) {
        let columns = wanted.count(self.counts());
        if columns == 0 {
            return;
        }
        if self.is_as_built(wanted) {
            return self.gradient_as_built(weights, wanted, out, execution);
        }
        let threads = threads(self.is_parallel(), execution.workers);
        let level = execution.level.unwrap_or_else(Level::new);
        let blocks = self.samples.div_ceil(BLOCK).max(1);
        let forces = self.forces().unwrap_or_default();
        let common = self.common(forces.as_ref());
        let looped = self.has_loops(wanted);
        let state = || self.buffers(forces.as_ref(), looped);
        let sum = |buffers: &mut Buffers, line: usize, own: &LineConstants<'_>, block: usize| {
            let first = block * BLOCK;
            let end = self.samples.min(first + BLOCK);
            let mut sums = Sums::new(self.counts());
            if is_set(execution.stop) {
                return sums;
            }
            let part = Part { own, line, samples: first..end, weights, level, looped };
            self.sum_block(common, &part, buffers, &mut sums);
            sums
        };
        if blocks == 1 {
            // Pieces of several drivelines, so that the queue costs nothing.
            let size = (BLOCK / self.samples.max(1)).clamp(1, 256);
            let pieces = out.chunks_mut(size * columns).enumerate();
            work_off(pieces, threads, state, |buffers, (piece, out)| {
                for (i, out) in out.chunks_mut(columns).enumerate() {
                    let line = piece * size + i;
                    let own = self.line(line);
                    own.finish(&sum(buffers, line, &own, 0), wanted, out);
                }
            });
            return;
        }
        for (line, out) in out.chunks_mut(columns).enumerate() {
            let own = self.line(line);
            let mut parts: Vec<_> = (0..blocks).map(|_| Sums::default()).collect();
            work_off(parts.iter_mut().enumerate(), threads, state, |buffers, (i, part)| {
                *part = sum(buffers, line, &own, i);
            });
            let mut sums = Sums::new(self.counts());
            for part in &parts {
                sums.add(part);
            }
            own.finish(&sums, wanted, out);
        }
    }

    /// The derivatives of every sample: for each plane, driveline and sample [`Wanted::count`]
    /// numbers.
    pub fn derivatives(&self, wanted: Wanted, out: &mut [f64], execution: Execution<'_>) {
        let columns = wanted.count(self.counts());
        let (lines, samples) = (self.line_count(), self.samples);
        let total = lines.saturating_mul(samples);
        if columns == 0 || total == 0 {
            return;
        }
        if self.is_as_built(wanted) {
            return self.derivatives_as_built(wanted, out, execution);
        }
        let mut planes = vec![];
        for (output, items) in &self.outputs {
            for &item in items {
                planes.extend((0..output.components()).map(|i| (*output, item, i)));
            }
        }
        let size = CHUNK.min(total);
        let pieces = out.chunks_mut(total * columns).zip(planes).flat_map(|(plane, of)| {
            plane.chunks_mut(size * columns).enumerate().map(move |x| (of, x))
        });
        let threads = threads(self.is_parallel(), execution.workers);
        let forces = self.forces().unwrap_or_default();
        let common = self.common(forces.as_ref());
        let state = || (Sums::new(self.counts()), Pull::new(self.joints, common.forces));
        work_off(pieces, threads, state, |(sums, pull), ((output, item, component), (i, out))| {
            let mut known: Option<(usize, LineConstants<'_>)> = None;
            for (j, out) in out.chunks_mut(columns).enumerate() {
                if is_set(execution.stop) {
                    return;
                }
                let (line, sample) = ((i * size + j) / samples, (i * size + j) % samples);
                let (_, own) = match known.take() {
                    Some(known_line) if known_line.0 == line => known.insert(known_line),
                    _ => known.insert((line, self.line(line))),
                };
                let load = self.load_at(line, sample);
                let state = LineAt::new(common, own, load.as_ref(), self.angle_at(line, sample));
                let mut weight = Vector::zeros();
                weight[component] = 1.0;
                sums.clear();
                state.pull(output, item, weight, pull, sums);
                state.settle(pull, sums);
                own.finish(sums, wanted, out);
            }
        });
    }
}

fn is_motion(output: Output) -> bool {
    MOTIONS.contains(&output)
}

fn is_force(output: Output) -> bool {
    matches!(output, Output::JointForce | Output::BearingForce)
}
