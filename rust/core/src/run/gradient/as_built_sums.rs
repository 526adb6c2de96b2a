//! Derivatives of drivelines of joints as built: weighted sums over the samples, or those of each
//! sample.

use crate::mechanics::as_built::DEVIATIONS;
use crate::mechanics::phasing::is_set;
use crate::plan::Output;
use crate::plan::forces::ForceStep;
use crate::run::execution::Execution;
use crate::run::gradient::WIDTH;
use crate::run::gradient::as_built::{LineAsBuilt, Pass, SampleAsBuilt, Variable, variables};
use crate::run::gradient::line::Wanted;
use crate::run::gradient::motion::CHUNK;
use crate::run::gradient::{BLOCK, Differentiated};
use crate::run::queue::{threads, work_off};

/// The elements of one driveline, or none.
fn part_of(array: &[f64], line: usize, each: usize) -> &[f64] {
    array.get(line * each..(line + 1) * each).unwrap_or(&[])
}

impl Differentiated<'_> {
    /// Whether derivatives are found joint by joint: of joints as built, or by deviations.
    pub(super) fn is_as_built(&self, wanted: Wanted) -> bool {
        wanted.deviations || !self.lines.deviations.is_empty()
    }

    /// A pass over the samples of a driveline for each group of parameters.
    fn passes(&self, line: usize, wanted: &[Variable]) -> Vec<Pass> {
        let n = self.joints;
        let of = |array, each| part_of(array, line, each);
        let lines = &self.lines;
        let own = LineAsBuilt {
            bends: of(lines.bends, n),
            twists: of(lines.twists, n - 1),
            phases: of(lines.phases, n - 1),
            directions: of(lines.directions, 3 * (n + 1)),
            normals: of(lines.normals, 3 * n),
            deviations: of(lines.deviations, DEVIATIONS * n),
            lengths: of(lines.lengths, n + 1),
            positions: of(lines.positions, self.bearings.len()),
        };
        let is_angle = |output| matches!(output, Output::Angle | Output::AngleError);
        let has_angles = self.outputs.iter().any(|(output, _)| is_angle(*output));
        let pass = |variables: &[Variable]| Pass::new(own, variables, has_angles);
        if wanted.is_empty() {
            return vec![pass(&[])];
        }
        wanted.chunks(WIDTH).map(pass).collect()
    }

    /// [`Differentiated::gradient`] joint by joint.
    pub(super) fn gradient_as_built(
        &self,
        weights: &[&[f64]],
        wanted: Wanted,
        out: &mut [f64],
        execution: Execution<'_>,
    ) {
        let (columns, all) = (wanted.count(self.counts()), variables(wanted, self.counts()));
        let threads = threads(self.is_parallel(), execution.workers);
        let blocks = self.samples.div_ceil(BLOCK).max(1);
        let forces = self.forces().unwrap_or_default();
        let sum = |passes: &[Pass], line: usize, block: usize, sums: &mut [f64]| {
            let end = self.samples.min((block + 1) * BLOCK);
            for sample in block * BLOCK..end {
                if is_set(execution.stop) {
                    return;
                }
                let at = (line, sample);
                self.add_sample(passes, forces.as_ref(), at, weights, wanted.value, sums);
            }
        };
        if blocks == 1 {
            let lines = out.chunks_mut(columns).enumerate();
            work_off(
                lines,
                threads,
                || (),
                |(), (line, out)| {
                    out.fill(0.0);
                    sum(&self.passes(line, &all), line, 0, out);
                },
            );
            return;
        }
        for (line, out) in out.chunks_mut(columns).enumerate() {
            let passes = self.passes(line, &all);
            let mut parts = vec![0.0; blocks * columns];
            let pieces = parts.chunks_mut(columns).enumerate();
            work_off(pieces, threads, || (), |(), (block, part)| sum(&passes, line, block, part));
            out.fill(0.0);
            for part in parts.chunks(columns) {
                out.iter_mut().zip(part).for_each(|(out, part)| *out += part);
            }
        }
    }

    /// Adds the weighted outputs of one sample and their derivatives.
    fn add_sample(
        &self,
        passes: &[Pass],
        forces: Option<&ForceStep>,
        (line, sample): (usize, usize),
        weights: &[&[f64]],
        has_value: bool,
        sums: &mut [f64],
    ) {
        let (load, at) = (self.load_at(line, sample), line * self.samples + sample);
        for (i, pass) in passes.iter().enumerate() {
            let state =
                SampleAsBuilt::new(pass, forces, self.angle_at(line, sample), load.as_ref());
            let first = usize::from(has_value) + i * WIDTH;
            let mut plane = 0;
            for (output, items) in &self.outputs {
                for &item in items {
                    let parts = state.output(*output, item);
                    for part in &parts[..output.components()] {
                        let weight = weights[plane][at];
                        plane += 1;
                        if has_value && i == 0 {
                            sums[0] += weight * part.value;
                        }
                        for (sum, by) in sums[first..].iter_mut().zip(part.by) {
                            *sum += weight * by;
                        }
                    }
                }
            }
        }
    }

    /// [`Differentiated::derivatives`] joint by joint.
    pub(super) fn derivatives_as_built(
        &self,
        wanted: Wanted,
        out: &mut [f64],
        execution: Execution<'_>,
    ) {
        let (columns, all) = (wanted.count(self.counts()), variables(wanted, self.counts()));
        let total = self.line_count().saturating_mul(self.samples);
        let size = CHUNK.min(total);
        let mut pieces: Vec<Vec<&mut [f64]>> = vec![];
        pieces.resize_with(total.div_ceil(size), Vec::new);
        for plane in out.chunks_mut(total * columns) {
            for (piece, part) in pieces.iter_mut().zip(plane.chunks_mut(size * columns)) {
                piece.push(part);
            }
        }
        let threads = threads(self.is_parallel(), execution.workers);
        let forces = self.forces().unwrap_or_default();
        work_off(
            pieces.iter_mut().enumerate(),
            threads,
            || (),
            |(), (piece, planes)| {
                let mut known = (usize::MAX, vec![]);
                for i in 0..size.min(total - piece * size) {
                    if is_set(execution.stop) {
                        return;
                    }
                    let (line, sample) =
                        ((piece * size + i) / self.samples, (piece * size + i) % self.samples);
                    if known.0 != line {
                        known = (line, self.passes(line, &all));
                    }
                    let range = i * columns..(i + 1) * columns;
                    let outs = planes.iter_mut().map(|plane| &mut plane[range.clone()]);
                    let at = (line, sample);
                    self.set_sample(&known.1, forces.as_ref(), at, wanted.value, outs);
                }
            },
        );
    }

    /// Sets the derivatives of one sample, in one slice per plane.
    fn set_sample<'b>(
        &self,
        passes: &[Pass],
        forces: Option<&ForceStep>,
        (line, sample): (usize, usize),
        has_value: bool,
        outs: impl Iterator<Item = &'b mut [f64]>,
    ) {
        let load = self.load_at(line, sample);
        let states = passes.iter().map(|pass| {
            SampleAsBuilt::new(pass, forces, self.angle_at(line, sample), load.as_ref())
        });
        let states: Vec<_> = states.collect();
        let items = self.outputs.iter().flat_map(|(output, items)| {
            let components = 0..output.components();
            let of_item = move |&item| components.clone().map(move |part| (*output, item, part));
            items.iter().flat_map(of_item)
        });
        for ((output, item, part), out) in items.zip(outs) {
            for (i, state) in states.iter().enumerate() {
                let number = state.output(output, item)[part];
                if has_value && i == 0 {
                    out[0] = number.value;
                }
                let first = usize::from(has_value) + i * WIDTH;
                for (out, by) in out[first..].iter_mut().zip(number.by) {
                    *out = by;
                }
            }
        }
    }
}
