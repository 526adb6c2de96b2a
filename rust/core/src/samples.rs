//! What a run reads: drivelines, angles and loads, each broadcast over the samples.

use crate::error::{Error, Result};
use crate::plan::Plan;

/// A flat array seen through broadcasting: sample `(i_0, i_1, …)` holds element `Σ i_k stride_k`.
#[derive(Clone, Debug)]
pub struct Source<'a> {
    /// The elements.
    pub data: &'a [f64],
    /// One stride in elements per axis of the samples.
    pub strides: &'a [usize],
}

/// A batch of drivelines with the same number of joints, as flat arrays.
#[derive(Clone, Copy, Debug)]
pub struct Drivelines<'a> {
    /// `(…, n)`.
    pub bends: &'a [f64],
    /// `(…, n − 1)`.
    pub twists: &'a [f64],
    /// `(…, n − 1)`.
    pub phases: &'a [f64],
    /// `(…, n + 1, 3)`.
    pub directions: &'a [f64],
    /// `(…, n, 3)`.
    pub normals: &'a [f64],
}

/// The load on a driveline; torque in N·m, speed in rad/s, acceleration in rad/s², inertias in
/// kg·m² with the shaft they belong to.
#[derive(Clone, Debug)]
pub struct Load<'a> {
    /// The torque at the end that the plan names.
    pub torque: Source<'a>,
    /// Speed of the drive.
    pub speed: Source<'a>,
    /// Acceleration of the drive.
    pub acceleration: Source<'a>,
    /// Inertia of each shaft that the plan counts.
    pub inertias: Vec<(usize, Source<'a>)>,
}

/// Everything that one run reads: the shape of the samples and what each sample sees.
#[derive(Clone, Debug)]
pub struct Samples<'a> {
    /// Shape of the samples.
    pub shape: &'a [usize],
    /// The drivelines.
    pub lines: Drivelines<'a>,
    /// Strides of the samples over the drivelines.
    pub line_strides: &'a [usize],
    /// The drive angles in rad.
    pub angle: Source<'a>,
    /// The load, if the plan carries one.
    pub load: Option<Load<'a>>,
}

/// The samples as a table of rows: axes over which every source runs on evenly are merged, the
/// last one is the row.
pub(crate) struct Table<'a> {
    pub(crate) lines: Drivelines<'a>,
    shape: Vec<usize>,
    /// Strides over the drivelines.
    pub(crate) line: Vec<usize>,
    pub(crate) columns: Vec<Column<'a>>,
    /// Column of each shaft's inertia.
    pub(crate) inertia: Vec<Option<usize>>,
}

// The first columns of a table.
pub(crate) const ANGLE: usize = 0;
pub(crate) const TORQUE: usize = 1;
pub(crate) const SPEED: usize = 2;
pub(crate) const ACCELERATION: usize = 3;

/// One quantity over the samples.
pub(crate) struct Column<'a> {
    pub(crate) data: &'a [f64],
    pub(crate) strides: Vec<usize>,
}

impl<'a> Table<'a> {
    pub(crate) fn new(plan: &Plan, samples: &Samples<'a>) -> Result<Self> {
        let n = plan.joint_count;
        let lines = samples.lines;
        let count = lines.bends.len() / n;
        let lengths = [
            ("bends", lines.bends.len(), n),
            ("twists", lines.twists.len(), n - 1),
            ("phases", lines.phases.len(), n - 1),
            ("directions", lines.directions.len(), 3 * (n + 1)),
            ("normals", lines.normals.len(), 3 * n),
        ];
        for (name, found, each) in lengths {
            if found != count * each {
                let problem = format!("has {found} values; {count} drivelines need {each} each");
                return Err(Error::new(name, &[], problem));
            }
        }
        let mut sources = vec![("angle", &samples.angle)];
        let mut inertia = vec![None; n + 1];
        if let Some(load) = &samples.load {
            sources.extend([
                ("torque", &load.torque),
                ("speed", &load.speed),
                ("acceleration", &load.acceleration),
            ]);
            for (shaft, source) in &load.inertias {
                inertia[*shaft] = Some(sources.len());
                sources.push(("inertias", source));
            }
        } else if plan.load.is_some() {
            return Err(Error::new("load", &[], "is missing; the outputs need one"));
        }
        check_reach("drivelines", count, samples.shape, samples.line_strides)?;
        for (name, source) in &sources {
            check_reach(name, source.data.len(), samples.shape, source.strides)?;
        }
        let mut strides: Vec<Vec<usize>> = vec![samples.line_strides.to_vec()];
        strides.extend(sources.iter().map(|(_, source)| source.strides.to_vec()));
        let shape = merge_axes(samples.shape, &mut strides);
        let line = strides.remove(0);
        let columns = sources
            .iter()
            .zip(strides)
            .map(|((_, source), strides)| Column { data: source.data, strides })
            .collect();
        Ok(Self { lines, shape, line, columns, inertia })
    }

    pub(crate) fn row_length(&self) -> usize {
        self.shape[self.shape.len() - 1]
    }

    /// Element of the row's first sample, and step along the row.
    pub(crate) fn locate(&self, strides: &[usize], row: usize) -> (usize, usize) {
        let last = strides.len() - 1;
        let mut rest = row;
        let mut first = 0;
        for axis in (0..last).rev() {
            first += rest % self.shape[axis] * strides[axis];
            rest /= self.shape[axis];
        }
        (first, strides[last])
    }
}

/// Every element that the strides can reach must exist.
fn check_reach(
    argument: &'static str,
    len: usize,
    shape: &[usize],
    strides: &[usize],
) -> Result<()> {
    let empty = shape.contains(&0);
    let last: usize = shape.iter().zip(strides).map(|(&n, &s)| n.saturating_sub(1) * s).sum();
    if shape.len() == strides.len() && (empty || last < len) {
        return Ok(());
    }
    Err(Error::new(argument, &[], format!("has {len} elements, which do not fill the samples")))
}

/// Merges neighbouring axes over which every source keeps its step, and drops axes of length 1;
/// at least one axis remains.
fn merge_axes(shape: &[usize], strides: &mut [Vec<usize>]) -> Vec<usize> {
    let mut merged: Vec<usize> = vec![];
    let mut kept: Vec<Vec<usize>> = vec![vec![]; strides.len()];
    for (axis, &length) in shape.iter().enumerate() {
        if length == 1 {
            continue;
        }
        let joins = !merged.is_empty()
            && strides.iter().zip(&kept).all(|(s, k)| k[k.len() - 1] == s[axis] * length);
        if joins {
            let last = merged.len() - 1;
            merged[last] *= length;
        } else {
            merged.push(length);
        }
        for (s, k) in strides.iter().zip(&mut kept) {
            if joins {
                k.pop();
            }
            k.push(s[axis]);
        }
    }
    if merged.is_empty() {
        merged.push(1);
        for k in &mut kept {
            k.push(0);
        }
    }
    for (s, k) in strides.iter_mut().zip(kept) {
        *s = k;
    }
    merged
}
