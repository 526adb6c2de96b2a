//! Transmissions of a batch of drivelines, sample by sample.

use cardan::Ideal;
use numpy::{Complex64, IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;

use crate::convert::{OrRaise, slice};
use crate::lines::Lines;
use crate::watch::{check_memory, reserve};

/// The transmissions to one shaft of each driveline.
#[pyclass(frozen, name = "Transmission", module = "cardan._core")]
pub(crate) struct NativeTransmission(Vec<Ideal>);

#[pymethods]
impl NativeTransmission {
    #[new]
    fn new(py: Python<'_>, lines: &Lines, shaft: usize) -> PyResult<Self> {
        let joints = lines.batch().joints();
        if shaft > joints {
            return Err(PyIndexError::new_err(format!(
                "shaft is {shaft}; there are {}",
                joints + 1
            )));
        }
        lines.batch().check_ideal("a transmission by q is").or_raise()?;
        lines.with(py, |lines| {
            let count = lines.bends.len() / joints;
            check_memory(count.saturating_mul(size_of::<Ideal>()))?;
            let between = shaft.saturating_sub(1);
            let ideal = |line: usize| {
                let of = |array: &[f64], each: usize, used: usize| {
                    array[line * each..line * each + used].to_vec()
                };
                let bends = of(lines.bends, joints, shaft);
                let twists = of(lines.twists, joints - 1, between);
                let phases = of(lines.phases, joints - 1, between);
                Ideal::of_chain(&bends, &twists, &phases)
            };
            Ok(Self((0..count).map(ideal).collect()))
        })
    }

    /// `q` of each driveline.
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<Complex64>>> {
        let mut q = vec![];
        reserve(&mut q, self.0.len())?;
        q.extend(self.0.iter().map(Ideal::q));
        Ok(q.into_pyarray(py))
    }

    /// Angle error, speed ratio, acceleration ratio and jerk ratio of the drivelines with these
    /// numbers at these drive angles.
    fn motion<'py>(
        &self,
        py: Python<'py>,
        lines: PyReadonlyArray1<'py, i64>,
        angles: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<[Bound<'py, PyArray1<f64>>; 4]> {
        self.columns(py, &lines, &angles, |ideal, angle| {
            let motion = ideal.motion(angle);
            [motion.angle_error, motion.speed_ratio, motion.acceleration_ratio, motion.jerk_ratio]
        })
    }

    /// The derivatives of these quantities with respect to `q`.
    fn gradient<'py>(
        &self,
        py: Python<'py>,
        lines: PyReadonlyArray1<'py, i64>,
        angles: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<[Bound<'py, PyArray1<Complex64>>; 4]> {
        self.columns(py, &lines, &angles, |ideal, angle| {
            let gradient = ideal.gradient(angle);
            [
                gradient.angle_error,
                gradient.speed_ratio,
                gradient.acceleration_ratio,
                gradient.jerk_ratio,
            ]
        })
    }
}

impl NativeTransmission {
    fn columns<'py, N: numpy::Element>(
        &self,
        py: Python<'py>,
        lines: &PyReadonlyArray1<'py, i64>,
        angles: &PyReadonlyArray1<'py, f64>,
        numbers: impl Fn(&Ideal, f64) -> [N; 4] + Sync,
    ) -> PyResult<[Bound<'py, PyArray1<N>>; 4]> {
        let (lines, angles) = (slice("lines", lines)?, slice("angle", angles)?);
        let mut columns = [const { Vec::<N>::new() }; 4];
        for column in &mut columns {
            reserve(column, angles.len())?;
        }
        for (&line, &angle) in lines.iter().zip(angles) {
            let ideal = usize::try_from(line).ok().and_then(|line| self.0.get(line));
            let missing = || PyIndexError::new_err(format!("there is no driveline {line}"));
            for (column, number) in
                columns.iter_mut().zip(numbers(ideal.ok_or_else(missing)?, angle))
            {
                column.push(number);
            }
        }
        Ok(columns.map(|column| column.into_pyarray(py)))
    }
}
