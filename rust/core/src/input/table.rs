//! Samples as a table of rows.

use std::borrow::Cow;
use std::iter::once;

use crate::error::{Error, Result};
use crate::input::drivelines::Drivelines;
use crate::input::samples::{Angles, Samples, Source};
use crate::input::sweep::Sweep;

/// The samples as a table of rows. Axes over which every array keeps its stride are merged; the
/// last axis is the row.
pub(crate) struct Table<'a> {
    pub(crate) lines: Drivelines<'a>,
    shape: Cow<'a, [usize]>,
    /// Strides of the drivelines.
    pub(crate) line: Cow<'a, [usize]>,
    /// The sweep that replaces the column of angles.
    pub(crate) sweep: Option<Sweep>,
    /// The error terms of the angles, if these are sums.
    pub(crate) error_terms: Option<&'a [f64]>,
    pub(crate) columns: Vec<TableColumn<'a>>,
    /// Column of each shaft's inertia, if there is a load.
    pub(crate) inertia: Vec<Option<usize>>,
}

// The first columns of a table.
pub(crate) const ANGLE: usize = 0;
pub(crate) const TORQUE: usize = 1;
pub(crate) const SPEED: usize = 2;
pub(crate) const ACCELERATION: usize = 3;

/// The names of the columns in messages; all later columns are inertias.
const NAMES: [&str; 4] = ["angle", "torque", "speed", "acceleration"];

/// How the geometry changes over the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GeometryVariation {
    /// It does not change.
    One,
    /// It changes from row to row.
    ByRow,
    /// It changes along the rows.
    BySample,
}

/// One quantity over the samples.
pub(crate) struct TableColumn<'a> {
    pub(crate) data: &'a [f64],
    pub(crate) strides: Cow<'a, [usize]>,
}

impl<'a> TableColumn<'a> {
    fn of(source: &Source<'a>) -> Self {
        Self { data: source.data, strides: Cow::Borrowed(source.strides) }
    }

    /// Reads values that lie `step` apart, from the one at `begin` on.
    pub(crate) fn read(&self, begin: usize, step: usize, out: &mut [f64]) {
        read(self.data, begin, step, out);
    }
}

/// Reads values of an array that lie `step` apart, from the one at `begin` on.
fn read(data: &[f64], begin: usize, step: usize, out: &mut [f64]) {
    match step {
        0 => out.fill(data[begin]),
        1 => out.copy_from_slice(&data[begin..begin + out.len()]),
        _ => {
            for (x, &value) in out.iter_mut().zip(data[begin..].iter().step_by(step)) {
                *x = value;
            }
        }
    }
}

/// `size` values of an array from the one at `begin` on, in steps of `step`: the array itself, or
/// gathered in `buffer` if they are not contiguous.
pub(crate) fn contiguous<'d>(
    data: &'d [f64],
    [begin, step, size]: [usize; 3],
    buffer: &'d mut Vec<f64>,
) -> &'d [f64] {
    if step == 1 {
        return &data[begin..begin + size];
    }
    buffer.resize(size, 0.0);
    read(data, begin, step, buffer);
    buffer
}

impl<'a> Table<'a> {
    /// A table with as few and as long rows as possible, for drivelines of `joints` joints.
    /// `loaded` plans need a load.
    pub(crate) fn new(joints: usize, loaded: bool, samples: &'a Samples<'a>) -> Result<Self> {
        Self::merged(joints, loaded, samples, samples.shape.len())
    }

    /// The same, with the last axis of the samples as the row.
    pub(crate) fn by_rows(joints: usize, loaded: bool, samples: &'a Samples<'a>) -> Result<Self> {
        Self::merged(joints, loaded, samples, samples.shape.len().saturating_sub(1))
    }

    fn merged(n: usize, loaded: bool, samples: &'a Samples<'a>, mergeable: usize) -> Result<Self> {
        let lines = samples.lines;
        let count = lines.check(n)?;
        let (angle, sweep) = match &samples.angle {
            Angles::Array(source) | Angles::Sums(source, _) => (TableColumn::of(source), None),
            // All samples share one angle, as with an array of one element.
            Angles::Sweep(sweep) if sweep.count() == 1 || samples.shape.last() == Some(&1) => (
                TableColumn { data: sweep.first(), strides: vec![0; samples.shape.len()].into() },
                None,
            ),
            Angles::Sweep(sweep) => {
                // A sweep acts as an array whose elements are their own indices.
                let last = samples.shape.len().saturating_sub(1);
                let strides = (0..samples.shape.len()).map(|axis| usize::from(axis == last));
                (TableColumn { data: &[], strides: strides.collect() }, Some(*sweep))
            }
        };
        let error_terms = match samples.angle {
            Angles::Sums(_, error_terms) => Some(error_terms),
            Angles::Array(_) | Angles::Sweep(_) => None,
        };
        if let Some(error_terms) = error_terms {
            check_reach("error terms", error_terms.len(), samples.shape, &angle.strides)?;
        }
        let mut columns = vec![angle];
        let mut inertia = vec![];
        if let Some(load) = &samples.load {
            columns.extend([&load.torque, &load.speed, &load.acceleration].map(TableColumn::of));
            inertia.resize(n + 1, None);
            for (shaft, source) in &load.inertias {
                if *shaft > n {
                    let problem = format!("are of shaft {shaft}; there are {}", n + 1);
                    return Err(Error::new("inertias", &[], problem));
                }
                inertia[*shaft] = Some(columns.len());
                columns.push(TableColumn::of(source));
            }
        } else if loaded {
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
        Ok(Self { lines, shape, line, sweep, error_terms, columns, inertia })
    }

    /// Number of samples.
    pub(crate) fn samples(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether angle errors are kept until the drive angles are added to them: those of a sweep where
    /// each sample has its own driveline, and sums.
    pub(crate) fn adds_angles_last(&self) -> bool {
        let by_sample = self.geometry_variation() == GeometryVariation::BySample;
        self.sweep.is_some() && by_sample || self.error_terms.is_some()
    }

    /// How the geometry changes over the samples.
    pub(crate) fn geometry_variation(&self) -> GeometryVariation {
        match self.line.split_last() {
            Some((&along, _)) if along != 0 => GeometryVariation::BySample,
            Some((_, outer)) if outer.iter().any(|&stride| stride != 0) => GeometryVariation::ByRow,
            _ => GeometryVariation::One,
        }
    }

    /// Whether the load or an inertia changes along the rows.
    pub(crate) fn load_varies(&self) -> bool {
        self.columns.iter().skip(1).any(|column| column.strides.last() != Some(&0))
    }

    /// Number of rows.
    pub(crate) fn rows(&self) -> usize {
        self.shape[..self.shape.len() - 1].iter().product()
    }

    pub(crate) fn row_length(&self) -> usize {
        self.shape[self.shape.len() - 1]
    }

    /// Index of the row's first element, and the step along the row.
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

/// Checks that the array has every element that the strides reach.
pub(crate) fn check_reach(
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

/// Merges neighbouring axes, among the first `mergeable`, over which every array keeps its stride,
/// and drops axes of length 1. At least one axis remains.
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
