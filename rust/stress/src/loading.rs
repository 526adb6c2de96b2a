//! Drivelines under a load: what loads them, and what the core computes.

use cardan::{
    Angles, Axes, Drivelines, End, Execution, Geometry, Load, Output, Plan, Planes, Request,
    Samples, Source, Vector,
};

use crate::judge::Tier;
use crate::samples::Random;
use crate::wide::Wide;

/// The bearings of a driveline.
#[derive(Debug)]
pub(crate) struct BearingLayout {
    /// The shaft of each.
    pub(crate) bearings: Vec<usize>,
    /// Of the shafts.
    pub(crate) lengths: Vec<f64>,
    /// Of the bearings.
    pub(crate) positions: Vec<f64>,
}

/// What a driveline is loaded with.
#[derive(Debug)]
pub(crate) struct Loading {
    pub(crate) end: End,
    pub(crate) torque: f64,
    pub(crate) speed: f64,
    pub(crate) acceleration: f64,
    /// Of each shaft; zeros without them.
    pub(crate) inertias: Vec<f64>,
}

impl Loading {
    pub(crate) fn of(random: &mut Random, shafts: usize) -> Self {
        let end = random.pick(&[End::Drive, End::Output]);
        let turns = random.below(3) == 0;
        let inertias = (0..shafts).map(|_| if turns { random.between(0.0, 0.1) } else { 0.0 });
        Self {
            end,
            inertias: inertias.collect(),
            torque: random.between(-9.0, 9.0),
            speed: random.between(1.0, 5.0),
            acceleration: random.between(-3.0, 3.0),
        }
    }

    /// A torque of the drive alone.
    pub(crate) fn of_drive(torque: f64, shafts: usize) -> Self {
        let inertias = vec![0.0; shafts];
        Self { end: End::Drive, torque, speed: 0.0, acceleration: 0.0, inertias }
    }

    /// The power over the drive's speed on its way into each shaft and out of the last, from speed
    /// ratios and acceleration ratios of the shafts, and the sum of the magnitudes of its terms.
    pub(crate) fn powers(&self, rates: &[[Wide; 2]]) -> (Vec<Wide>, Wide) {
        let shafts = rates.len();
        let parts = |i: usize| {
            let [ratio, acceleration] = rates[i];
            [acceleration * self.speed * self.speed, ratio * self.acceleration]
                .map(|part| part * ratio * self.inertias[i])
        };
        let absorbed = |i: usize| {
            let [steady, accelerating] = parts(i);
            steady + accelerating
        };
        let mut power = vec![Wide::from(self.torque); shafts + 1];
        if self.end == End::Drive {
            (0..shafts).for_each(|i| power[i + 1] = power[i] - absorbed(i));
        } else {
            power[shafts] = rates[shafts - 1][0] * self.torque;
            (0..shafts).rev().for_each(|i| power[i] = power[i + 1] + absorbed(i));
        }
        let given = if self.end == End::Drive { power[0] } else { power[shafts] };
        let terms = (0..shafts).flat_map(parts).fold(given.abs(), |sum, part| sum + part.abs());
        (power, terms)
    }

    /// The shafts with an inertia.
    fn heavy(&self) -> Vec<usize> {
        (0..self.inertias.len()).filter(|&shaft| self.inertias[shaft] != 0.0).collect()
    }
}

/// A driveline under a load, and what is evaluated for it.
pub(crate) struct LoadedDriveline<'a> {
    pub(crate) line: &'a Geometry,
    pub(crate) loading: &'a Loading,
    pub(crate) angles: &'a [f64],
    pub(crate) outputs: &'a [Output],
    pub(crate) layout: Option<&'a BearingLayout>,
    /// Of the joints in rad, `(n, 3)`; empty for ideal ones.
    pub(crate) deviations: &'a [f64],
    /// Whether the driveline is given again with each angle, as in a batch.
    pub(crate) repeated: bool,
    pub(crate) axes: Axes,
}

impl LoadedDriveline<'_> {
    /// The planes of the outputs in each of the tiers.
    ///
    /// # Errors
    /// Forces that are not determinate.
    pub(crate) fn evaluate(&self, tiers: &[Tier]) -> cardan::Result<Vec<Vec<Vec<f64>>>> {
        self.planned(|plan, lines, load| {
            let angle = Angles::Array(Source { data: self.angles, strides: &[1] });
            let (shape, line_strides) = (&[self.angles.len()], &[usize::from(self.repeated)]);
            let samples = Samples { shape, lines, line_strides, angle, load: Some(load) };
            tiers.iter().map(|&tier| planes(plan, &samples, tier)).collect()
        })
    }

    /// What is made of the plan, the driveline and the load.
    ///
    /// # Errors
    /// Forces that are not determinate.
    pub(crate) fn planned<R>(
        &self,
        made: impl FnOnce(&Plan, Drivelines<'_>, Load<'_>) -> R,
    ) -> cardan::Result<R> {
        let Self { line, loading, angles, outputs, layout, deviations, repeated, axes } = *self;
        let n = line.bends.len();
        let times = if repeated { angles.len() } else { 1 };
        let each = |numbers: &[f64]| numbers.repeat(times);
        let vectors = |vectors: &[Vector]| -> Vec<f64> {
            each(&vectors.iter().flat_map(|v| v.iter().copied()).collect::<Vec<_>>())
        };
        let [bends, twists, phases] = [&line.bends, &line.twists, &line.phases].map(|x| each(x));
        let [directions, normals] = [&line.directions, &line.normals].map(|x| vectors(x));
        let lines = Drivelines {
            bends: &bends,
            twists: &twists,
            phases: &phases,
            directions: &directions,
            normals: &normals,
            lengths: &each(layout.map_or(&[], |own| &own.lengths)),
            positions: &each(layout.map_or(&[], |own| &own.positions)),
            deviations: &each(deviations),
        };
        let heavy = loading.heavy();
        let plan = Plan::new(&Request {
            largest_bends: &line.bends,
            outputs,
            shafts: &(0..=n).collect::<Vec<_>>(),
            joints: &(0..n).collect::<Vec<_>>(),
            load: Some(loading.end),
            inertias: &heavy,
            bearings: layout.map(|own| &own.bearings[..]),
            as_built: !deviations.is_empty(),
            axes,
        })?;
        let given = [loading.torque, loading.speed, loading.acceleration];
        let constant = |i: usize| Source { data: &given[i..=i], strides: &[0] };
        let inertia = |&shaft: &usize| {
            (shaft, Source { data: &loading.inertias[shaft..=shaft], strides: &[0] })
        };
        let load = Load {
            torque: constant(0),
            speed: constant(1),
            acceleration: constant(2),
            inertias: heavy.iter().map(inertia).collect(),
        };
        Ok(made(&plan, lines, load))
    }
}

/// The planes of a plan at each sample, with the arithmetic that the core chooses for a tier.
pub(crate) fn planes(plan: &Plan, samples: &Samples<'_>, tier: Tier) -> Vec<Vec<f64>> {
    let precision = match tier {
        Tier::Faithful => plan.precision(Some(0.0), false),
        Tier::Default => plan.precision(None, false),
        Tier::Loose | Tier::Float32 => plan.precision(None, true),
    };
    let length = samples.shape.iter().product();
    let run = |planes: Planes<'_, '_>| {
        plan.run(samples, None, precision, planes, Execution::default()).expect("the arrays fit");
    };
    if tier == Tier::Float32 {
        let mut planes = vec![vec![f32::NAN; length]; plan.planes()];
        run(Planes::Single(&mut planes.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>()));
        return planes
            .into_iter()
            .map(|plane| plane.into_iter().map(f64::from).collect())
            .collect();
    }
    let mut planes = vec![vec![f64::NAN; length]; plan.planes()];
    run(Planes::Double(&mut planes.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>()));
    planes
}
