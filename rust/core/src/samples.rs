//! What a run reads: drivelines, angles and loads, each broadcast over the samples.

use std::borrow::Cow;
use std::iter::once;

use crate::error::{Error, Result};
use crate::plan::Plan;
use crate::sweep::Sweep;

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

impl Drivelines<'_> {
    /// The number of drivelines, after a look whether the arrays fit together.
    pub(crate) fn check(&self, n: usize) -> Result<usize> {
        let count = self.bends.len() / n;
        let lengths = [
            ("bends", self.bends.len(), n),
            ("twists", self.twists.len(), n - 1),
            ("phases", self.phases.len(), n - 1),
            ("directions", self.directions.len(), 3 * (n + 1)),
            ("normals", self.normals.len(), 3 * n),
        ];
        for (name, found, each) in lengths {
            if found != count * each {
                let problem = format!("has {found} values; {count} drivelines need {each} each");
                return Err(Error::new(name, &[], problem));
            }
        }
        if count == 0 {
            return Err(Error::new("bends", &[], "has no driveline"));
        }
        Ok(count)
    }

    /// The largest bend of each of the `joints` over the batch; one with none is straight throughout.
    pub fn largest_bends(&self, joints: usize) -> Vec<f64> {
        let mut largest = vec![0.0_f64; joints];
        for line in self.bends.chunks_exact(joints) {
            for (largest, &bend) in largest.iter_mut().zip(line) {
                *largest = largest.max(bend);
            }
        }
        largest
    }
}

/// The drive angles of the samples.
#[derive(Clone, Debug)]
pub enum Angles<'a> {
    /// In rad.
    Array(Source<'a>),
    /// A uniform sweep along the last axis.
    Sweep(Sweep),
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
    /// The drive angles.
    pub angle: Angles<'a>,
    /// The load, if the plan carries one.
    pub load: Option<Load<'a>>,
}

/// The samples as a table of rows: axes over which every source runs on evenly are merged, the
/// last one is the row.
pub(crate) struct Table<'a> {
    pub(crate) lines: Drivelines<'a>,
    shape: Cow<'a, [usize]>,
    /// Strides over the drivelines.
    pub(crate) line: Cow<'a, [usize]>,
    /// The sweep that stands for the column of angles.
    pub(crate) sweep: Option<Sweep>,
    pub(crate) columns: Vec<Column<'a>>,
    /// Column of each shaft's inertia, if there is a load.
    pub(crate) inertia: Vec<Option<usize>>,
}

// The first columns of a table.
pub(crate) const ANGLE: usize = 0;
pub(crate) const TORQUE: usize = 1;
pub(crate) const SPEED: usize = 2;
pub(crate) const ACCELERATION: usize = 3;

/// What messages call the columns; those that follow are inertias.
const NAMES: [&str; 4] = ["angle", "torque", "speed", "acceleration"];

/// How the geometry changes over the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Geometries {
    /// Not at all.
    One,
    /// From row to row.
    ByRow,
    /// Along the rows.
    BySample,
}

/// One quantity over the samples.
pub(crate) struct Column<'a> {
    pub(crate) data: &'a [f64],
    pub(crate) strides: Cow<'a, [usize]>,
}

impl<'a> Column<'a> {
    fn of(source: &Source<'a>) -> Self {
        Self { data: source.data, strides: Cow::Borrowed(source.strides) }
    }
}

impl<'a> Table<'a> {
    /// The samples in as few and long rows as they have.
    pub(crate) fn new(plan: &Plan, samples: &'a Samples<'a>) -> Result<Self> {
        Self::merged(plan, samples, samples.shape.len())
    }

    /// The same with the last axis as the row.
    pub(crate) fn by_rows(plan: &Plan, samples: &'a Samples<'a>) -> Result<Self> {
        Self::merged(plan, samples, samples.shape.len().saturating_sub(1))
    }

    fn merged(plan: &Plan, samples: &'a Samples<'a>, mergeable: usize) -> Result<Self> {
        let n = plan.joint_count;
        let lines = samples.lines;
        let count = lines.check(n)?;
        let (angle, sweep) = match &samples.angle {
            Angles::Array(source) => (Column::of(source), None),
            // One angle that all samples see, as an array's would be.
            Angles::Sweep(sweep) if sweep.count() == 1 || samples.shape.last() == Some(&1) => {
                (Column { data: sweep.first(), strides: vec![0; samples.shape.len()].into() }, None)
            }
            Angles::Sweep(sweep) => {
                // An array whose elements are their own numbers.
                let last = samples.shape.len().saturating_sub(1);
                let strides = (0..samples.shape.len()).map(|axis| usize::from(axis == last));
                (Column { data: &[], strides: strides.collect() }, Some(*sweep))
            }
        };
        let mut columns = vec![angle];
        let mut inertia = vec![];
        if let Some(load) = &samples.load {
            columns.extend([&load.torque, &load.speed, &load.acceleration].map(Column::of));
            inertia.resize(n + 1, None);
            for (shaft, source) in &load.inertias {
                if *shaft > n {
                    let problem = format!("are of shaft {shaft}; there are {}", n + 1);
                    return Err(Error::new("inertias", &[], problem));
                }
                inertia[*shaft] = Some(columns.len());
                columns.push(Column::of(source));
            }
        } else if plan.load.is_some() {
            return Err(Error::new("load", &[], "is missing; the outputs need one"));
        }
        check_reach("drivelines", count, samples.shape, samples.line_strides)?;
        for (i, column) in columns.iter().enumerate() {
            let length = match &sweep {
                Some(sweep) if i == ANGLE => sweep.count(),
                _ => column.data.len(),
            };
            let name = NAMES.get(i).unwrap_or(&"inertias");
            check_reach(name, length, samples.shape, &column.strides)?;
        }
        let mut shape = Cow::Borrowed(samples.shape);
        let mut line = Cow::Borrowed(samples.line_strides);
        let strides = columns.iter_mut().map(|column| &mut column.strides);
        merge_axes(&mut shape, mergeable, once(&mut line).chain(strides));
        Ok(Self { lines, shape, line, sweep, columns, inertia })
    }

    /// Number of samples.
    pub(crate) fn samples(&self) -> usize {
        self.shape.iter().product()
    }

    /// How the geometry changes over the samples.
    pub(crate) fn geometries(&self) -> Geometries {
        match self.line.split_last() {
            Some((&along, _)) if along != 0 => Geometries::BySample,
            Some((_, outer)) if outer.iter().any(|&stride| stride != 0) => Geometries::ByRow,
            _ => Geometries::One,
        }
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.shape[..self.shape.len() - 1].iter().product()
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

/// Merges neighbours of the first `mergeable` axes over which every source keeps its step, and drops
/// those of length 1; at least one axis remains.
fn merge_axes<'a: 's, 's>(
    shape: &mut Cow<'_, [usize]>,
    mergeable: usize,
    strides: impl Iterator<Item = &'s mut Cow<'a, [usize]>>,
) {
    if shape.len() == 1 {
        return;
    }
    let strides: Vec<_> = strides.collect();
    let mut merged: Vec<usize> = vec![];
    let mut kept: Vec<Vec<usize>> = vec![vec![]; strides.len()];
    for (axis, &length) in shape.iter().enumerate() {
        let may = axis < mergeable;
        if length == 1 && may {
            continue;
        }
        let joins = may
            && !merged.is_empty()
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
    for (s, k) in strides.into_iter().zip(kept) {
        *s = Cow::Owned(k);
    }
    *shape = Cow::Owned(merged);
}
