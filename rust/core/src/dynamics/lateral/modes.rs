//! Natural frequencies at rest and without damping, and the shapes of the vibrations.
//!
//! The number of natural frequencies below `ω` is the number of negative eigenvalues of the dynamic
//! stiffness at `ω`, as long as no piece with fixed ends has one (W. H. Wittrick and F. W. Williams
//! 1971). Each joint force adds one more. So a natural frequency is where the eigenvalue of its
//! number, counted from the least one, is zero.

use std::f64::consts::FRAC_1_SQRT_2;

use nalgebra::{Complex, DMatrix, SymmetricEigen};

use crate::dynamics::lateral::equations::{BandEquations, Nodes};
use crate::dynamics::lateral::rate::Rate;
use crate::dynamics::lateral::system::{LateralShaft, LateralSystem, RigidShaft};
use crate::error::{Error, Result};

/// A natural frequency beyond this one in rad/s belongs to no shaft.
const HIGHEST: f64 = 1e9;

/// The most natural frequencies that are sought: those of a beam are as good as it is slender.
const MOST: usize = 100;

/// An eigenvalue, relative to the diagonal, below which nothing but rounding holds a shaft.
const ROUNDING: f64 = 1e-12;

/// A natural frequency at rest and without damping.
#[derive(Clone, Debug)]
pub struct LateralMode {
    /// In rad/s.
    pub frequency: f64,
    /// Displacements of the probes, of which the longest has the length 1.
    pub displacements: Vec<[f64; 3]>,
}

/// Dynamic stiffness with the forces of joints, in two directions across each shaft, where it is
/// real. Every row and column is divided by the root of its diagonal when nothing moves.
struct Scaled<'a> {
    layout: &'a Nodes<'a>,
    equations: BandEquations,
    /// Pieces are short enough for frequencies up to this one.
    finest: f64,
    scales: Vec<f64>,
}

impl<'a> Scaled<'a> {
    fn new(layout: &'a Nodes<'a>, finest: f64) -> Self {
        let mut own = Self { layout, equations: BandEquations::default(), finest, scales: vec![] };
        let still = own.matrix(0.0).diagonal();
        let largest = if still.max() > 0.0 { still.max() } else { 1.0 };
        // Nothing holds a free shaft without bearings, and a joint force has no diagonal.
        let scale = |&x: &f64| if x > ROUNDING * largest { x } else { largest }.sqrt().recip();
        own.scales = still.iter().map(scale).collect();
        own
    }

    fn matrix(&mut self, rate: f64) -> DMatrix<f64> {
        self.equations.assemble(self.layout, Rate::at_rest(rate), self.finest);
        let size = self.equations.size();
        self.scales.resize(size, 1.0);
        let mut found = DMatrix::zeros(size, size);
        let pairs = self.equations.pairs();
        for &[a, b] in &pairs {
            for &[c, d] in &pairs {
                let entry = |row, column| self.equations.entry(row, column);
                let [ac, ad, bc, bd] = [entry(a, c), entry(a, d), entry(b, c), entry(b, d)];
                found[(a, c)] = 0.5 * (ac + ad + bc + bd).re;
                found[(a, d)] = 0.5 * (ad + bd - ac - bc).im;
                found[(b, c)] = 0.5 * (ac + ad - bc - bd).im;
                found[(b, d)] = 0.5 * (ac - ad - bc + bd).re;
            }
        }
        for (i, scale) in self.scales.iter().enumerate() {
            found.row_mut(i).scale_mut(*scale);
            found.column_mut(i).scale_mut(*scale);
        }
        found
    }

    /// The eigenvalues in order.
    fn eigenvalues(&mut self, rate: f64) -> Vec<f64> {
        let mut found: Vec<f64> = self.matrix(rate).symmetric_eigenvalues().data.into();
        found.sort_by(f64::total_cmp);
        found
    }

    /// Makes the unknowns those of the eigenvector with this number, and returns the eigenvalue.
    fn take_vector(&mut self, rate: f64, number: usize) -> Option<f64> {
        let found = SymmetricEigen::new(self.matrix(rate));
        let values = found.eigenvalues.as_slice();
        // Of equal ones the first comes first.
        let is_before =
            |i: usize, j: usize| values[j] < values[i] || (values[j] == values[i] && j < i);
        let rank = |&i: &usize| (0..values.len()).filter(|&j| is_before(i, j)).count() == number;
        let own = (0..values.len()).find(rank)?;
        let vector = found.eigenvectors.column(own);
        for [a, b] in self.equations.pairs() {
            let [x, y] = [a, b].map(|i| vector[i] * self.scales[i] * FRAC_1_SQRT_2);
            self.equations.unknowns[a] = Complex::new(x, y);
            self.equations.unknowns[b] = Complex::new(x, -y);
        }
        Some(values[own])
    }

    /// The displacement of a place in the eigenvector.
    fn displacement(&self, rate: f64, (shaft, position): (usize, f64)) -> [f64; 3] {
        let at = Rate::at_rest(rate);
        self.equations.displacement_at(self.layout, at, shaft, position).map(|x| x.re)
    }
}

/// An eigenvalue at rest, relative to the diagonal, of which rounding leaves no digit.
const SOFTEST: f64 = 1e-14;

impl LateralSystem {
    /// Refuses a shaft that can move without any resistance.
    pub(super) fn check_support(&self) -> Result<()> {
        // Whether there is a support depends on what is stiff, not on how stiff it is.
        let mut alike = self.clone();
        let stiffest =
            self.attached.bearings.iter().flat_map(|own| own.stiffness).fold(0.0, f64::max);
        for own in &mut alike.attached.bearings {
            own.stiffness = own.stiffness.map(|k| if k > 0.0 { stiffest } else { 0.0 });
        }
        // Nor does it depend on bending, and short stiff spans would hide what else holds a shaft.
        for (shaft, length) in alike.shafts.iter_mut().zip(&self.lengths) {
            if let LateralShaft::Bending(_) = shaft {
                let centre = 0.5 * length;
                *shaft =
                    LateralShaft::Rigid(RigidShaft { mass: 0.0, centre, across: 0.0, along: 0.0 });
            }
        }
        let layout = Nodes::new(&alike, false);
        let mut scaled = Scaled::new(&layout, 0.0);
        let least = scaled.take_vector(0.0, 2 * self.joints());
        if least.is_none_or(|least| least >= ROUNDING) {
            return Ok(());
        }
        let moved = |shaft: usize| -> f64 {
            let ends = [0.0, self.lengths[shaft]];
            ends.map(|end| length(&scaled.displacement(0.0, (shaft, end)))).into_iter().sum()
        };
        let moving = (0..self.shafts.len()).filter(|&i| self.shafts[i] != LateralShaft::Held);
        let shaft = moving.max_by(|&i, &j| moved(i).total_cmp(&moved(j))).unwrap_or(0);
        let problem = format!("and joints leave shaft {shaft} without support");
        Err(Error::new("bearings", &[], problem))
    }

    /// Up to `count` natural frequencies, lowest first, and the displacements of probes, which are
    /// shafts and positions in m. Rigid shafts have fewer.
    ///
    /// # Errors
    /// A probe beyond its shaft, more than 100 frequencies, bearings of which one is 1e14 times
    /// as stiff as another.
    pub fn modes(&self, count: usize, probes: &[(usize, f64)]) -> Result<Vec<LateralMode>> {
        for (i, &(shaft, position)) in probes.iter().enumerate() {
            self.place("probes", i, shaft, position)?;
        }
        if count > MOST {
            let problem = format!("is {count}; it must be at most {MOST}");
            return Err(Error::new("count", &[], problem));
        }
        let layout = Nodes::new(self, true);
        let ties = 2 * self.joints();
        let mut found: Vec<f64> = vec![];
        let (mut low, mut high) = (0.0, 1.0);
        let mut scaled = Scaled::new(&layout, high);
        let mut below = scaled.eigenvalues(0.0);
        if below.get(ties).is_some_and(|&least| least < SOFTEST) {
            let problem = "hold shafts so softly beside the stiffest that rounding hides it";
            return Err(Error::new("bearings", &[], problem));
        }
        while found.len() < count && high < HIGHEST && self.has_long_waves(high, 0.0) {
            scaled = Scaled::new(&layout, high);
            let above = scaled.eigenvalues(high);
            let number = above.iter().filter(|&&x| x < 0.0).count().saturating_sub(ties);
            // In pieces as fine as these, so that an eigenvalue is one function.
            if number > found.len() {
                below = scaled.eigenvalues(low);
            }
            for mode in found.len()..number.min(count) {
                let at = ties + mode;
                found.push(root([low, high], [below[at], above[at]], |rate| {
                    scaled.eigenvalues(rate)[at]
                }));
            }
            (low, high) = (high, 2.0 * high);
        }
        let mode = |(number, &frequency): (usize, &f64)| {
            let displacements = shape(&layout, frequency, ties + number, probes);
            LateralMode { frequency, displacements }
        };
        Ok(found.iter().enumerate().map(mode).collect())
    }
}

/// The displacements of probes at a natural frequency.
fn shape(
    layout: &Nodes<'_>,
    frequency: f64,
    number: usize,
    probes: &[(usize, f64)],
) -> Vec<[f64; 3]> {
    if probes.is_empty() {
        return vec![];
    }
    let mut scaled = Scaled::new(layout, frequency);
    scaled.take_vector(frequency, number);
    let moved: Vec<_> = probes.iter().map(|&probe| scaled.displacement(frequency, probe)).collect();
    let longest = moved.iter().map(length).fold(0.0, f64::max);
    let scale = if longest > 0.0 { 1.0 / longest } else { 0.0 };
    moved.into_iter().map(|v| v.map(|x| x * scale)).collect()
}

fn length(v: &[f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The place where a function changes its sign, by false position with halved ends.
fn root(
    [mut low, mut high]: [f64; 2],
    [mut below, mut above]: [f64; 2],
    mut value: impl FnMut(f64) -> f64,
) -> f64 {
    const ROUNDS: usize = 200;
    let mut side = 0;
    for _ in 0..ROUNDS {
        if high - low <= 4.0 * f64::EPSILON * high || above == 0.0 {
            break;
        }
        let mut middle = (low * above - high * below) / (above - below);
        if !(low < middle && middle < high) {
            middle = 0.5 * (low + high);
        }
        let own = value(middle);
        if own > 0.0 {
            (low, below) = (middle, own);
            if side == 1 {
                above *= 0.5;
            }
            side = 1;
        } else {
            (high, above) = (middle, own);
            if side == -1 {
                below *= 0.5;
            }
            side = -1;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::dynamics::lateral::bearing::ElasticBearing;
    use crate::dynamics::lateral::system::{Attached, BendingShaft, PointMass};
    use crate::mechanics::geometry::Vector;

    const TUBE: BendingShaft = BendingShaft {
        stiffness: 1.6e5,
        mass: 6.4,
        shear_stiffness: f64::INFINITY,
        rotary_inertia: 0.0,
        loss_factor: 0.0,
    };

    /// Shafts in a line between two machines.
    fn between(shafts: &[(f64, LateralShaft)], attached: Attached) -> LateralSystem {
        let machine = (0.3, LateralShaft::Held);
        let all = [&[machine], shafts, &[machine]].concat();
        let (lengths, kinds): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        let directions = vec![Vector::x(); kinds.len()];
        LateralSystem::new(&directions, &lengths, &kinds, attached, None).unwrap()
    }

    fn close(found: f64, wanted: f64, error: f64) {
        assert!((found / wanted - 1.0).abs() < error, "{found} for {wanted}");
    }

    #[test]
    fn a_pinned_tube_has_sines_of_whole_waves() {
        let system = between(&[(1.6, LateralShaft::Bending(TUBE))], Attached::default());
        let first = (PI / 1.6).powi(2) * (TUBE.stiffness / TUBE.mass).sqrt();
        for (i, mode) in system.modes(6, &[(1, 0.8)]).unwrap().iter().enumerate() {
            let number = (i / 2 + 1) as f64;
            close(mode.frequency, number * number * first, 1e-12);
        }
    }

    #[test]
    fn two_rods_are_one_mass_on_a_spring() {
        let rod = |mass: f64, length: f64| {
            let (centre, across) = (0.5 * length, mass * length * length / 12.0);
            (length, LateralShaft::Rigid(RigidShaft { mass, centre, across, along: 0.0 }))
        };
        let bearing = ElasticBearing {
            shaft: 1,
            position: 1.13,
            stiffness: [1.5e5; 2],
            axis: None,
            loss_factor: [0.1; 2],
            damping: [0.0; 2],
        };
        let attached = Attached { bearings: vec![bearing], ..Attached::default() };
        let system = between(&[rod(12.0, 1.25), rod(17.0, 1.75)], attached);
        let modes = system.modes(3, &[]).unwrap();
        assert_eq!(modes.len(), 2);
        for mode in modes {
            close(mode.frequency, 1.13 / 1.25 * (1.5e5_f64 / (29.0 / 3.0)).sqrt(), 1e-12);
        }
    }

    #[test]
    fn what_is_close_to_an_end_moves_with_it() {
        let frequency = |position: f64| {
            let mass = PointMass { shaft: 1, position, mass: 3.0, across: 0.0, along: 0.0 };
            let attached = Attached { masses: vec![mass], ..Attached::default() };
            let system = between(&[(1.6, LateralShaft::Bending(TUBE))], attached);
            system.modes(1, &[]).unwrap()[0].frequency
        };
        // A mass at a joint that a machine holds has no effect.
        let bare = frequency(0.0);
        for position in [1e-6, 1e-4, 3e-4, 1.6 - 1e-4] {
            close(frequency(position), bare, 1e-5);
        }
    }
}
