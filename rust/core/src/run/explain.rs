//! A description of what a run does for each sample, and of what it skips and why.

use crate::error::{Error, Result};
use crate::input::Samples;
use crate::input::table::{GeometryVariation, Table};
use crate::mechanics::forces::PARTS;
use crate::mechanics::moment::Pose;
use crate::number::atan::AtanRange;
use crate::number::double_double::DoubleDouble;
use crate::number::{Number, Precision};
use crate::plan::output::{Needs, OfCross, Output};
use crate::plan::reduction::Reduction;
use crate::plan::request::Axes;
use crate::plan::route::{Route, Routes};
use crate::plan::steps::{Plan, ShaftStep};
use crate::run::constants::GeometryIndex;
use crate::run::fold::{Folded, fold_first};
use crate::run::level::Level;

/// How a plan is called, apart from its samples.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// The arithmetic.
    pub precision: Precision,
    /// The reduction of rows, if any.
    pub reduction: Option<Reduction>,
    /// Whether results are in single precision.
    pub single: bool,
}

/// The routes of a run, and the routes of its shafts for the first driveline.
struct Choices {
    routes: Routes,
    /// Whether the angles come from a sweep.
    sweep: bool,
    /// Route and range of the inverse tangent for each shaft of the plan.
    shafts: Vec<(Route, AtanRange)>,
}

impl Choices {
    fn new<T: Number>(plan: &Plan, table: &Table<'_>) -> Self {
        let routes = Routes::of_run(plan, table, T::PRECISION);
        let per_sample = table.geometry_variation() == GeometryVariation::BySample;
        let mut folded = Folded::<T>::new(plan, 1, per_sample, &routes);
        folded.fold(Level::new(), plan, &table.lines, &[0]);
        let geometry = if per_sample { GeometryIndex::PerSample } else { GeometryIndex::Shared(0) };
        let of = |step: &ShaftStep| folded.route(&routes, step.shaft, geometry);
        Self { routes, sweep: table.sweep.is_some(), shafts: plan.shafts.iter().map(of).collect() }
    }

    fn any(&self, route: Route) -> bool {
        self.shafts.iter().any(|&(taken, _)| taken == route)
    }
}

impl Plan {
    /// A text with the steps taken, the steps skipped with the reason, and the bytes per sample. It
    /// describes the first of the drivelines.
    ///
    /// # Errors
    /// Arrays whose lengths do not fit together, or an empty set of samples.
    pub fn explain(&self, samples: &Samples<'_>, call: Call) -> Result<String> {
        self.check_lines(&samples.lines)?;
        if samples.shape.contains(&0) {
            return Err(Error::new("samples", &[], "are none; there is nothing to explain"));
        }
        let call = Call { precision: self.computed_in(call.precision), ..call };
        let (joints, loaded) = (self.joint_count, self.load.is_some());
        let table = match call.reduction {
            Some(_) => Table::by_rows(joints, loaded, samples)?,
            None => Table::new(joints, loaded, samples)?,
        };
        if self.is_as_built() {
            return Ok(self.explain_as_built(table.sweep.is_some(), call));
        }
        let choices = self.choices(&table, call.precision);
        let mut text = format!("arithmetic: {}\nsteps:", kind(call.precision));
        for words in self.steps(&choices, call) {
            text.extend(["\n  ", &words]);
        }
        let skipped = self.skipped(&table, &choices);
        if !skipped.is_empty() {
            text += "\nskipped:";
        }
        for words in skipped {
            text.extend(["\n  ", &words]);
        }
        Ok(text + &self.traffic(choices.sweep, call))
    }

    /// The bytes per sample.
    fn traffic(&self, sweep: bool, call: Call) -> String {
        let read = if sweep { 0 } else { 8 };
        let word = if call.single { 4 } else { 8 };
        let written = if call.reduction.is_some() { 0 } else { word * self.planes };
        format!("\nper sample: {read} bytes read, {written} bytes written")
    }

    /// The description for drivelines with deviations.
    fn explain_as_built(&self, sweep: bool, call: Call) -> String {
        let from = if sweep { "sample number" } else { "angle" };
        let mut text = format!("arithmetic: {}\nsteps:", kind(call.precision));
        let mut steps = vec![format!("{from} to sine and cosine")];
        let joint = |joint| format!("joint {joint}: as built, from its own input angle");
        steps.extend((0..self.reach()).map(joint));
        let shaft = |step: &ShaftStep| format!("shaft {}: {}", step.shaft, output_names(step));
        steps.extend(self.shafts.iter().map(shaft));
        steps.extend(self.step_texts_of_loads(call));
        for words in &steps {
            text.extend(["\n  ", words]);
        }
        text += "\nskipped:\n  one equivalent joint: chains of joints with deviations have none";
        text + &self.traffic(sweep, call)
    }

    fn choices(&self, table: &Table<'_>, precision: Precision) -> Choices {
        match precision {
            Precision::Single => Choices::new::<f32>(self, table),
            Precision::Double => Choices::new::<f64>(self, table),
            Precision::DoubleDouble => Choices::new::<DoubleDouble>(self, table),
        }
    }

    /// The steps that compute sines and cosines.
    fn sines(&self, choices: &Choices) -> Vec<String> {
        let Choices { routes, sweep, .. } = choices;
        let mut steps = vec![];
        let from = if *sweep { "sample number" } else { "angle" };
        let by_steps = if routes.needs_rotations() {
            ", turned by whole steps from the middle of groups of samples"
        } else {
            ""
        };
        if choices.any(Route::DoubleAngle) || choices.any(Route::Rotation) {
            steps.push(format!("{from} to sine and cosine of twice the angle{by_steps}"));
        }
        if self.needs_poses() || choices.any(Route::Tangent) {
            let sense = if self.needs_sense() { "" } else { ", sign left open" };
            let sums = match routes.tangent_sum {
                Some(length) => {
                    format!(", by the addition theorem within groups of {length} samples")
                }
                None => String::new(),
            };
            steps.push(format!(
                "{from} to unnormalised sine and cosine (tangent form{sense}){sums}"
            ));
        }
        steps
    }

    /// All steps, in the order in which they run.
    fn steps(&self, choices: &Choices, call: Call) -> Vec<String> {
        let mut steps = self.sines(choices);
        for (step, &(route, range)) in self.shafts.iter().zip(&choices.shafts) {
            let shaft = step.shaft;
            let names = output_names(step);
            if route == Route::Drive {
                steps.push(format!("shaft {shaft}: {names}, those of the drive"));
                continue;
            }
            if shaft > 1 && route == Route::Tangent {
                steps
                    .push(format!("shaft {shaft}: sine and cosine turned to its equivalent joint"));
            }
            let mut how = String::new();
            let has = |output| step.planes.get(output).is_some();
            if has(Output::Angle) || has(Output::AngleError) {
                let terms = range.terms()[call.precision as usize];
                how = format!(" (inverse tangent of {terms} terms)");
            }
            if step.combined_planes().is_some() && range.is_moderate() {
                how += ", in one loop";
            }
            steps.push(format!("shaft {shaft}: {names}{how}"));
        }
        steps.extend(self.step_texts_of_loads(call));
        steps
    }

    /// The steps of crosses, torques and moments, and the reduction.
    fn step_texts_of_loads(&self, call: Call) -> Vec<String> {
        let mut steps = vec![];
        let [of_moment, of_support] = match self.axes {
            Axes::Space => ["moment", "support moments"],
            Axes::Shaft => [
                "moment in axes that turn with its shaft",
                "support moments in axes that turn with their shafts",
            ],
        };
        for (j, step) in self.joints.iter().enumerate() {
            let is_of = |output: &Output, of| {
                step.planes.get(*output).is_some() && output.row().needs == Needs::Cross(of)
            };
            let parts = [
                (OfCross::Tilt, "tilts of the cross"),
                (OfCross::Swing, "rates of the cross from the speed ratio"),
                (OfCross::Pin, "pins in space"),
            ];
            for (of, name) in parts {
                if Output::ALL.iter().any(|output| is_of(output, of)) {
                    steps.push(format!("joint {j}: {name}"));
                }
            }
        }
        for station in self.load.iter().flat_map(|load| &load.stations) {
            let shaft = station.shaft;
            if station.absorbs {
                steps.push(format!("shaft {shaft}: power that its inertia takes"));
            }
            if station.torque.is_some() {
                steps.push(format!("shaft {shaft}: torque from the power"));
            }
            if station.force_power {
                let joint = shaft - 1;
                steps.push(format!("joint {joint}: parts for the forces from the power"));
            }
            if station.torsion {
                let step = &self.joints[shaft - 1];
                let parts = [
                    (step.planes.get(Output::Moment).is_some(), of_moment),
                    (step.needs_support(), of_support),
                    (step.needs_force && self.is_as_built(), "forces"),
                ];
                let is_magnitude = |output: &Output| {
                    output.row().needs == Needs::Torsion
                        && !output.is_vector()
                        && step.planes.get(*output).is_some()
                };
                let parts = parts.iter().filter(|(computed, _)| *computed);
                let magnitudes = Output::ALL.into_iter().filter(is_magnitude);
                let names: Vec<String> = parts
                    .map(|(_, name)| (*name).into())
                    .chain(magnitudes.map(Output::label))
                    .collect();
                steps.push(format!("joint {}: {} from the torsion", shaft - 1, names.join(", ")));
            }
        }
        for target in self.forces.iter().flat_map(|forces| &forces.targets) {
            let (per, item) = target.of;
            let what = match target.force {
                Some(_) => format!("a sum of {} terms", PARTS * target.sources.len()),
                None => "zero because both its shafts have other supports".into(),
            };
            let turned = match self.axes {
                Axes::Space => String::new(),
                Axes::Shaft => format!(", turned with the pin of shaft {}", target.shaft),
            };
            steps.push(format!("{} {item}: force, {what}{turned}", per.name()));
        }
        if let Some(reduction) = call.reduction {
            steps.push(format!("each row to its {}; no sample is stored", reduction.name()));
        }
        steps
    }

    /// The skipped steps, with the reason.
    fn skipped(&self, table: &Table<'_>, choices: &Choices) -> Vec<String> {
        let n = self.joint_count;
        let mut skipped = vec![];
        for (j, &bend) in self.largest_bends.iter().enumerate() {
            if bend == 0.0 {
                skipped.push(format!("joint {j}: straight, it passes its rotation on"));
            }
        }
        if let Some(step) = self.shafts.last().filter(|step| step.shaft > 1) {
            skipped.push(format!(
                "joints one by one: the {} before shaft {} act as one",
                step.shaft, step.shaft
            ));
        }
        let reach = self.reach();
        if reach < n {
            let last = if reach + 1 == n { String::new() } else { format!(" to {}", n - 1) };
            skipped.push(format!("joint {reach}{last}: beyond everything asked for"));
        }
        let idle: Vec<String> = (0..=n)
            .filter(|&shaft| self.shafts.iter().all(|step| step.shaft != shaft))
            .map(|shaft| shaft.to_string())
            .collect();
        if !idle.is_empty() {
            let plural = if idle.len() > 1 { "s" } else { "" };
            skipped.push(format!("shaft{plural} {}: motion not asked for", idle.join(", ")));
        }
        if self.load.is_none() {
            skipped.push("torques and moments: not asked for".into());
        }
        for (step, &(route, _)) in self.shafts.iter().zip(&choices.shafts) {
            if route == Route::Drive && choices.routes.is_bent(step.shaft) {
                let why = "the joints before it compensate each other exactly";
                skipped.push(format!("shaft {}: turns with the drive, {why}", step.shaft));
            }
        }
        if !self.needs_poses() && choices.shafts.iter().all(|&(route, _)| route == Route::Drive) {
            skipped.push("sine and cosine: everything turns with the drive".into());
        }
        skipped.extend(self.vanishing(table));
        if choices.sweep {
            skipped.push("array of angles: a sweep needs none".into());
        }
        if let Some(period) = choices.routes.period {
            skipped.push(format!(
                "samples after the first {period} of a row: results repeat and are copied"
            ));
        }
        skipped
    }

    /// Terms of vectors that are zero because of the first driveline's position in space.
    fn vanishing(&self, table: &Table<'_>) -> Vec<String> {
        if self.axes == Axes::Shaft {
            return vec![];
        }
        let folded = fold_first::<f64>(self, &table.lines);
        let mut vanishing = vec![];
        for (j, step) in self.joints.iter().enumerate() {
            let Some([.., normal]) = folded.poses[j].first().and_then(Pose::plane_axes) else {
                continue;
            };
            let plane = ["yz", "zx", "xy"][normal];
            let why = format!("zero because its shafts lie along the {plane} plane");
            if step.planes.get(Output::Moment).is_some() {
                vanishing.push(format!("joint {j}: 4 of the moment's 9 terms, {why}"));
            }
            for support in step.support.iter().flatten() {
                let shaft = if support.driving { j } else { j + 1 };
                let what = format!("3 of 6 terms of its part of shaft {shaft}'s support");
                vanishing.push(format!("joint {j}: {what}, {why}"));
            }
        }
        vanishing
    }
}

/// The arithmetic in words.
fn kind(precision: Precision) -> &'static str {
    match precision {
        Precision::Single => "single precision after a reduction in double",
        Precision::Double => "double precision",
        Precision::DoubleDouble => "double precision with error terms",
    }
}

/// The names of the outputs that are computed for a shaft.
fn output_names(step: &ShaftStep) -> String {
    let computed = |output: &Output| {
        step.planes.get(*output).is_some()
            || *output == Output::SpeedRatio && step.keep_ratio
            || *output == Output::AccelerationRatio && step.keep_acceleration
    };
    let names: Vec<String> = Output::ALL
        .iter()
        .filter(|o| computed(o))
        .map(|o| o.row().name.replace('_', " "))
        .collect();
    names.join(", ")
}

/// The routes that runs have taken, recorded for tests.
#[cfg(test)]
pub(crate) mod taken {
    use std::cell::RefCell;
    use std::collections::BTreeSet;

    use crate::number::atan::AtanRange;
    use crate::plan::route::Route;

    thread_local! {
        static TAKEN: RefCell<BTreeSet<(usize, Route, AtanRange)>> =
            const { RefCell::new(BTreeSet::new()) };
    }

    /// Records the route of a shaft in a chunk.
    pub(crate) fn note(shaft: usize, route: Route, range: AtanRange) {
        TAKEN.with_borrow_mut(|taken| taken.insert((shaft, route, range)));
    }

    /// The routes recorded on this thread since the last call.
    pub(crate) fn take() -> Vec<(usize, Route, AtanRange)> {
        TAKEN.take().into_iter().collect()
    }
}

#[cfg(test)]
mod tests;
