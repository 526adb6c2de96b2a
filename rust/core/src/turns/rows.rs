//! Drivelines and loads, broadcast to rows: one turn each.

use crate::error::Result;
use crate::input::table::check_reach;
use crate::input::{Angles, Drivelines, Load, Samples, Source};
use crate::number::Precision;
use crate::plan::steps::Plan;
use crate::run::execution::{Execution, Planes};

/// Drivelines and loads that are constant over a turn, broadcast to rows.
#[derive(Clone, Debug)]
pub struct Rows<'a> {
    /// The shape of the rows.
    pub shape: &'a [usize],
    /// The drivelines.
    pub lines: Drivelines<'a>,
    /// One stride per axis of the rows, in drivelines.
    pub line_strides: &'a [usize],
    /// The load, if there is one.
    pub load: Option<Load<'a>>,
}

impl Rows<'_> {
    /// The number of rows.
    pub fn count(&self) -> usize {
        self.shape.iter().product()
    }

    /// Checks that the arrays fit together and that the strides stay within them.
    pub(crate) fn check(&self, plan: &Plan) -> Result<()> {
        if self.count() == 0 {
            return Ok(());
        }
        let count = plan.check_lines(&self.lines)?;
        check_reach("drivelines", count, self.shape, self.line_strides)?;
        for (name, source) in self.sources() {
            check_reach(name, source.data.len(), self.shape, source.strides)?;
        }
        Ok(())
    }

    /// The arrays of the load with their names.
    fn sources(&self) -> impl Iterator<Item = (&'static str, &Source<'_>)> {
        self.load.iter().flat_map(|load| {
            let motion = [
                ("torque", &load.torque),
                ("speed", &load.speed),
                ("acceleration", &load.acceleration),
            ];
            motion.into_iter().chain(load.inertias.iter().map(|(_, source)| ("inertias", source)))
        })
    }

    /// The element of an array in a row.
    fn place(&self, strides: &[usize], mut row: usize) -> usize {
        let mut place = 0;
        for (&length, &stride) in self.shape.iter().zip(strides).rev() {
            place += row % length * stride;
            row /= length;
        }
        place
    }

    /// The number of a row's driveline.
    pub(crate) fn line(&self, row: usize) -> usize {
        self.place(self.line_strides, row)
    }

    /// Bends, twists and phases of the chain to a shaft, from 1 on, of a row's driveline.
    pub(crate) fn chain(&self, row: usize, joints: usize, shaft: usize) -> [&[f64]; 3] {
        let line = self.line(row);
        let of = |array, each: usize, count| part(array, line * each, count);
        let between = joints - 1;
        [
            of(self.lines.bends, joints, shaft),
            of(self.lines.twists, between, shaft - 1),
            of(self.lines.phases, between, shaft - 1),
        ]
    }

    /// Copies of what belongs to some rows.
    pub(crate) fn gathered(&self, rows: &[usize], joints: usize) -> Gathered {
        let count = self.lines.bends.len() / joints;
        let lines = self.lines.arrays().map(|array| {
            let each = array.len() / count;
            rows.iter().flat_map(|&row| &array[self.line(row) * each..][..each]).copied().collect()
        });
        let of = |(_, source): (_, &Source<'_>)| {
            rows.iter().map(|&row| source.data[self.place(source.strides, row)]).collect()
        };
        let shafts = self.load.iter().flat_map(|load| &load.inertias).map(|&(shaft, _)| shaft);
        Gathered {
            count: rows.len(),
            lines,
            load: self.sources().map(of).collect(),
            shafts: shafts.collect(),
        }
    }
}

/// The drivelines and loads of some rows.
#[derive(Debug)]
pub(crate) struct Gathered {
    count: usize,
    lines: [Vec<f64>; 8],
    /// Torque, speed, acceleration, and the inertias of `shafts`, if there is a load.
    load: Vec<Vec<f64>>,
    shafts: Vec<usize>,
}

impl Gathered {
    /// The chains of one row behind a straight joint, without what only loads and vectors need.
    pub(crate) fn behind_straight_joint(self) -> Self {
        let [bends, twists, phases, directions, normals, ..] = self.lines;
        let behind = |angles: Vec<f64>| [vec![0.0], angles].concat();
        let longer = |vectors: Vec<f64>| vec![0.0; vectors.len() + 3];
        let lines =
            [behind(bends), behind(twists), behind(phases), longer(directions), longer(normals)];
        let [bends, twists, phases, directions, normals] = lines;
        let none = Vec::new;
        let lines = [bends, twists, phases, directions, normals, none(), none(), none()];
        Self { lines, load: vec![], shafts: vec![], ..self }
    }

    /// Evaluates the plan at drive angles, the same number in each row, on the calling thread. The
    /// planes follow each other, of each all rows.
    pub(crate) fn run(
        &self,
        plan: &Plan,
        precision: Precision,
        angles: &[f64],
    ) -> Result<Vec<f64>> {
        let each = angles.len() / self.count;
        let load = match self.load.as_slice() {
            [torque, speed, acceleration, inertias @ ..] => Some(Load {
                torque: by_row(torque),
                speed: by_row(speed),
                acceleration: by_row(acceleration),
                inertias: self.shafts.iter().copied().zip(inertias.iter().map(by_row)).collect(),
            }),
            _ => None,
        };
        let samples = Samples {
            shape: &[self.count, each],
            lines: Drivelines::from_arrays(self.lines.each_ref().map(Vec::as_slice)),
            line_strides: &[1, 0],
            angle: Angles::Array(Source { data: angles, strides: &[each, 1] }),
            load,
        };
        let mut values = vec![0.0; plan.planes() * angles.len()];
        let mut planes: Vec<&mut [f64]> = values.chunks_mut(angles.len()).collect();
        let alone = Execution { workers: Some(1), ..Execution::default() };
        plan.run(&samples, None, precision, Planes::Double(&mut planes), alone)?;
        Ok(values)
    }
}

/// One value for each row, the same along it.
#[allow(clippy::ptr_arg, reason = "mapped over arrays of the same type")]
fn by_row(values: &Vec<f64>) -> Source<'_> {
    Source { data: values, strides: &[1, 0] }
}

fn part(array: &[f64], start: usize, count: usize) -> &[f64] {
    &array[start..start + count]
}
