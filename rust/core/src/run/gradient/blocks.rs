//! Sums over a block of samples of one driveline: motions and loads chunk by chunk, and what has no
//! loops sample by sample.

use nalgebra::Complex;

use crate::mechanics::geometry::Vector;
use crate::plan::forces::ForceStep;
use crate::plan::output::{Needs, OfCross};
use crate::plan::{Axes, Output};
use crate::run::gradient::columns::{self, COLUMN, ChunkColumn};
use crate::run::gradient::line::{LineConstants, Sums};
use crate::run::gradient::load::{LoadBuffers, LoadChunk, LoadColumns, Weighted};
use crate::run::gradient::motion::{CHUNK, ChunkPins, ZEROS, sweep_angles};
use crate::run::gradient::sample::{Common, LineAt, Pull};
use crate::run::gradient::{Differentiated, Spread, SpreadAngles, SpreadLoad, Wanted, is_motion};
use crate::run::level::Level;

/// The fewest samples of a driveline whose loads are summed in loops, which have whole chunks.
const MIN_LOOPED: usize = 16;

/// Some samples of one driveline.
pub(super) struct Part<'a> {
    pub(super) own: &'a LineConstants<'a>,
    pub(super) line: usize,
    pub(super) samples: std::ops::Range<usize>,
    /// One plane per item and component of an output.
    pub(super) weights: &'a [&'a [f64]],
    pub(super) level: Level,
    /// Whether they are summed in loops.
    pub(super) looped: bool,
}

/// The motions of a shaft.
pub(super) const MOTIONS: [Output; 5] = [
    Output::Angle,
    Output::AngleError,
    Output::SpeedRatio,
    Output::AccelerationRatio,
    Output::JerkRatio,
];

/// A shaft with the planes of its [`MOTIONS`].
type MotionPlanes = (usize, [Option<usize>; MOTIONS.len()]);

/// The buffers of a thread.
pub(super) struct Buffers {
    pins: Box<ChunkPins>,
    /// If loads are summed in loops.
    load: Option<LoadBuffers>,
}

impl Differentiated<'_> {
    pub(super) fn buffers(&self, forces: Option<&ForceStep>, looped: bool) -> Buffers {
        let load = (looped && !self.only_motion()).then(|| LoadBuffers::new(self.joints, forces));
        Buffers { pins: ChunkPins::new(), load }
    }

    /// Whether there are loops for what is wanted, for the axes and for the angle that is held, and
    /// whether they pay.
    pub(super) fn has_loops(&self, wanted: Wanted) -> bool {
        let pays = self.only_motion() || self.samples >= MIN_LOOPED;
        let has_pins =
            self.outputs.iter().any(|(output, _)| output.row().needs == Needs::Cross(OfCross::Pin));
        pays && !has_pins && !wanted.angle && self.axes == Axes::Space && !self.driven
    }

    /// Adds what the weighted outputs of a block contribute.
    #[inline(never)]
    pub(super) fn sum_block(
        &self,
        common: Common<'_>,
        part: &Part<'_>,
        buffers: &mut Buffers,
        sums: &mut Sums,
    ) {
        if !part.looped {
            return self.sum_samples(common, part, sums);
        }
        self.sum_motion(part, &mut buffers.pins, sums);
        if let Some(buffers) = &mut buffers.load {
            self.sum_loads(common.forces, part, buffers, sums);
        }
    }

    /// The wanted outputs with their items and first planes.
    fn items(&self, wanted: impl Fn(Output) -> bool) -> Vec<(Output, usize, usize)> {
        let (mut found, mut plane) = (vec![], 0);
        for (output, items) in &self.outputs {
            for &item in items {
                found.push((*output, item, plane));
                plane += output.components();
            }
        }
        found.retain(|&(output, ..)| wanted(output));
        found
    }

    /// The shafts whose motions are wanted, each as often as it is named.
    fn motions(&self) -> Vec<MotionPlanes> {
        let mut shafts: Vec<MotionPlanes> = vec![];
        for (output, shaft, plane) in self.items(is_motion) {
            let Some(of) = MOTIONS.iter().position(|&motion| motion == output) else { continue };
            let free = |(other, planes): &MotionPlanes| *other == shaft && planes[of].is_none();
            let place = shafts.iter().position(free).unwrap_or(shafts.len());
            if place == shafts.len() {
                shafts.push((shaft, [None; MOTIONS.len()]));
            }
            shafts[place].1[of] = Some(plane);
        }
        shafts
    }

    /// Sums motions chunk by chunk.
    fn sum_motion(&self, part: &Part<'_>, pins: &mut ChunkPins, sums: &mut Sums) {
        let &Part { own, line, ref samples, weights, level, .. } = part;
        let shafts = self.motions();
        if shafts.is_empty() {
            return;
        }
        let mut buffer = ZEROS;
        for first in samples.clone().step_by(CHUNK) {
            let length = CHUNK.min(samples.end - first);
            let angles = match &self.angle {
                SpreadAngles::Array(Spread { data, per_line, per_sample: 1 }) => {
                    let at = line * per_line + first;
                    &data[at..at + length]
                }
                SpreadAngles::Array(spread) => {
                    buffer[..length].fill(spread.at(line, first));
                    &buffer[..length]
                }
                SpreadAngles::Sweep(sweep) => {
                    sweep_angles(sweep, first, &mut buffer[..length], level);
                    &buffer[..length]
                }
            };
            pins.turn(angles, level);
            let at = line * self.samples + first;
            let mut add = |shaft: usize, [value, re, im]: [f64; 3]| {
                sums.value += value;
                sums.q[shaft] += Complex::new(re, im);
            };
            for &(shaft, planes) in &shafts {
                let weights = planes.map(|plane| Some(&weights[plane?][at..at + length]));
                let [angle, error, ratio, acceleration, jerk] = weights;
                let constants = &own.shafts[shaft];
                if ratio.or(acceleration).is_some() {
                    add(shaft, pins.rates(constants, [ratio, acceleration], level));
                }
                if let Some(weights) = jerk {
                    add(shaft, pins.jerks(constants, weights, level));
                }
                for (weights, drive) in [(angle, Some(angles)), (error, None)] {
                    if let Some(weights) = weights {
                        add(shaft, pins.errors(constants, weights, drive, level));
                    }
                }
            }
        }
    }

    /// Sums everything but motions chunk by chunk.
    fn sum_loads(
        &self,
        forces: Option<&ForceStep>,
        part: &Part<'_>,
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        let &Part { own, line, ref samples, weights, level, .. } = part;
        let items = self.items(|output| !is_motion(output));
        let with_columns = |&(output, item, _): &_| (output, item, [columns::ZEROS; 3]);
        let mut outputs: Vec<Weighted> = items.iter().map(with_columns).collect();
        let columns = |load: &SpreadLoad<'_>| LoadColumns::new(load.end, load.inertias.len());
        let (mut load, mut angles) = (self.load.as_ref().map(columns), columns::ZEROS);
        for first in samples.clone().step_by(COLUMN) {
            let length = COLUMN.min(samples.end - first);
            // Constants stay from the first chunk on.
            let fill = |spread: &Spread<'_>, column: &mut ChunkColumn| {
                if first == samples.start || spread.per_sample > 0 {
                    spread.fill(line, first, length, column);
                }
            };
            match &self.angle {
                SpreadAngles::Array(spread) => fill(spread, &mut angles),
                SpreadAngles::Sweep(sweep) => {
                    sweep_angles(sweep, first, &mut angles[..length], level);
                    angles[length..].fill(sweep.at(first + length - 1));
                }
            }
            if let (Some(given), Some(load)) = (&self.load, &mut load) {
                fill(&given.torque, &mut load.torque);
                fill(&given.speed, &mut load.speed);
                fill(&given.acceleration, &mut load.acceleration);
                for (inertia, column) in given.inertias.iter().zip(&mut load.inertias) {
                    if let Some(inertia) = inertia {
                        fill(inertia, column);
                    }
                }
            }
            let at = line * self.samples + first;
            for ((_, _, columns), &(output, _, plane)) in outputs.iter_mut().zip(&items) {
                let planes = &weights[plane..plane + output.components()];
                for (column, weights) in columns.iter_mut().zip(planes) {
                    column[..length].copy_from_slice(&weights[at..at + length]);
                    column[length..].fill(0.0);
                }
            }
            let chunk = LoadChunk { line: own, forces, load: load.as_ref(), level };
            chunk.run(&angles, &outputs, buffers, sums);
        }
    }

    /// Sums any outputs sample by sample.
    fn sum_samples(&self, common: Common<'_>, part: &Part<'_>, sums: &mut Sums) {
        let (items, mut pull) = (self.items(|_| true), Pull::new(self.joints, common.forces));
        for i in part.samples.clone() {
            let load = self.load_at(part.line, i);
            let angle = self.angle_at(part.line, i);
            let sample = LineAt::new(common, part.own, load.as_ref(), angle);
            let at = part.line * self.samples + i;
            for &(output, item, plane) in &items {
                let mut weight = Vector::zeros();
                for component in 0..output.components() {
                    weight[component] = part.weights[plane + component][at];
                }
                sample.pull(output, item, weight, &mut pull, sums);
            }
            sample.settle(&mut pull, sums);
        }
    }
}
