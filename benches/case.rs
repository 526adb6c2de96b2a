//! Evaluations of one driveline, with everything that they read and fill.

use std::hint::black_box;

use cardan::{
    Angles, Axes, Drivelines, End, Execution, Geometry, Level, Load, Output, Plan, Planes,
    Precision, Request, Samples, Source, Sweep,
};
use rayon::prelude::*;

use Output::{BearingForce, Moment, SupportMoment};

/// The torque of a loaded driveline, in N m.
const TORQUE: [f64; 1] = [100.0];

/// A plan of the last shaft and the last joint. Forces are those of two bearings on each end shaft.
pub(crate) struct Case {
    line: Geometry,
    directions: Vec<f64>,
    normals: Vec<f64>,
    lengths: Vec<f64>,
    plan: Plan,
    loaded: bool,
    pub(crate) angle: Vec<f64>,
    pub(crate) planes: Vec<Vec<f64>>,
    /// In place of the planes of doubles.
    pub(crate) singles: Option<Vec<Vec<f32>>>,
    /// In place of the angles.
    pub(crate) sweep: Option<Sweep>,
    pub(crate) precision: Precision,
}

impl Case {
    pub(crate) fn new(
        joints: usize,
        bend_degrees: f64,
        outputs: &[Output],
        samples: usize,
    ) -> Self {
        let between = joints - 1;
        let bends = vec![bend_degrees.to_radians(); joints];
        let line = Geometry::from_bends(&bends, &vec![0.3; between], &vec![0.7; between])
            .expect("the bends are valid");
        let loads = [Moment, SupportMoment, BearingForce];
        let loaded = outputs.iter().any(|output| loads.contains(output));
        let bearings = [0, 0, joints, joints];
        let request = Request {
            largest_bends: &line.bends,
            outputs,
            shafts: &[joints],
            joints: &[joints - 1],
            load: loaded.then_some(End::Drive),
            inertias: &[],
            bearings: outputs.contains(&BearingForce).then_some(&bearings),
            as_built: false,
            axes: Axes::Space,
        };
        let plan = Plan::new(&request).expect("the request is valid");
        let turn = std::f64::consts::TAU / samples as f64;
        Self {
            directions: line.directions.iter().flat_map(|v| v.iter().copied()).collect(),
            normals: line.normals.iter().flat_map(|v| v.iter().copied()).collect(),
            lengths: vec![1.0; joints + 1],
            angle: (0..samples).map(|i| i as f64 * turn).collect(),
            planes: vec![vec![0.0; samples]; plan.planes()],
            singles: None,
            line,
            plan,
            loaded,
            sweep: None,
            precision: Precision::Double,
        }
    }

    pub(crate) fn run(&mut self, level: Level, workers: Option<usize>) {
        let same = |data| Source { data, strides: &[0] };
        let samples = Samples {
            shape: &[self.angle.len()],
            lines: Drivelines {
                bends: &self.line.bends,
                twists: &self.line.twists,
                phases: &self.line.phases,
                directions: &self.directions,
                normals: &self.normals,
                lengths: &self.lengths,
                positions: &[0.2, 0.7, 0.3, 0.8],
                ..Drivelines::default()
            },
            line_strides: &[0],
            angle: match self.sweep {
                Some(sweep) => Angles::Sweep(sweep),
                None => Angles::Array(Source { data: &self.angle, strides: &[1] }),
            },
            load: self.loaded.then(|| Load {
                torque: same(&TORQUE),
                speed: same(&[0.0]),
                acceleration: same(&[0.0]),
                inertias: vec![],
            }),
        };
        let execution = Execution { level: Some(level), workers, ..Execution::default() };
        let (mut doubles, mut singles): (Vec<_>, Vec<_>);
        let planes = if let Some(planes) = &mut self.singles {
            singles = planes.iter_mut().map(Vec::as_mut_slice).collect();
            Planes::Single(&mut singles)
        } else {
            doubles = self.planes.iter_mut().map(Vec::as_mut_slice).collect();
            Planes::Double(&mut doubles)
        };
        self.plan.run(&samples, None, self.precision, planes, execution).expect("the arrays fit");
        black_box((&mut self.planes, &mut self.singles));
    }

    /// Fills every plane from the angles by vector stores, as the evaluation does, on as many threads.
    pub(crate) fn fill(&mut self) {
        const BLOCK: usize = 16 * 1024;
        let factor = black_box(1.0);
        let angle = &self.angle;
        for plane in &mut self.planes {
            plane.par_chunks_mut(BLOCK).zip(angle.par_chunks(BLOCK)).for_each(|(to, from)| {
                for (to, from) in to.iter_mut().zip(from) {
                    *to = factor * from;
                }
            });
        }
        black_box(&mut self.planes);
    }

    /// The same by the system's copy, whose stores need not read what they overwrite.
    pub(crate) fn copy(&mut self) {
        const BLOCK: usize = 16 * 1024;
        let angle = &self.angle;
        for plane in &mut self.planes {
            plane
                .par_chunks_mut(BLOCK)
                .zip(angle.par_chunks(BLOCK))
                .for_each(|(to, from)| to.copy_from_slice(from));
        }
        black_box(&mut self.planes);
    }
}
