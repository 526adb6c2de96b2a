//! The worst errors of kinds of drivelines or points.

/// The worst errors of one kind, by tier or by whatever else tells results apart, and by output.
#[derive(Clone, Debug)]
pub(crate) struct ShapeErrors<S, const ROWS: usize, const OUTPUTS: usize> {
    pub(crate) shape: S,
    /// Samples, and their results.
    pub(crate) judged: u64,
    pub(crate) results: u64,
    pub(crate) off: [[f64; OUTPUTS]; ROWS],
    pub(crate) place: [[String; OUTPUTS]; ROWS],
}

impl<S: Copy, const ROWS: usize, const OUTPUTS: usize> ShapeErrors<S, ROWS, OUTPUTS> {
    /// At least so many samples of each of these kinds; each call of `judge` judges some.
    pub(crate) fn of_each(
        shapes: &[S],
        samples: u64,
        mut judge: impl FnMut(S, &mut Self),
    ) -> Vec<Self> {
        let each = |&shape: &S| {
            let place = std::array::from_fn(|_| std::array::from_fn(|_| String::new()));
            let mut found =
                Self { shape, judged: 0, results: 0, off: [[0.0; OUTPUTS]; ROWS], place };
            while found.judged < samples {
                judge(shape, &mut found);
            }
            found
        };
        shapes.iter().map(each).collect()
    }

    /// Keeps an error and its place if it is the worst so far. A result that is not a number is as
    /// wrong as can be.
    pub(crate) fn take(&mut self, row: usize, output: usize, off: f64, place: impl Fn() -> String) {
        self.results += 1;
        let off = if off.is_nan() { f64::INFINITY } else { off };
        if off > self.off[row][output] {
            self.off[row][output] = off;
            self.place[row][output] = place();
        }
    }

    /// What is beyond the limits of a row, a line each.
    pub(crate) fn beyond(&self, row: usize, limits: [f64; OUTPUTS], unit: &str) -> Vec<String> {
        let all = self.off[row].iter().zip(&self.place[row]).zip(limits);
        let beyond = all.filter(|((off, _), limit)| **off > *limit);
        beyond.map(|((off, place), _)| format!("{off:.3e} {unit}: {place}")).collect()
    }
}
