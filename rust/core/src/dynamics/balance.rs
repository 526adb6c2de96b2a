//! Periodic orbits of systems with constant loss factors, by harmonic balance.
//!
//! Order `n` of the torque of such a coupling is `c (1 + iη)` times that of its twist. That is no law
//! in time, but it is one of the whole period: the Hilbert transform of the twist times `cη` is added
//! to its torque. The unknowns are samples at equal distances over a period, an odd number of them,
//! through which a trigonometric polynomial goes (Fourier collocation). Newton's method finds it on a
//! coarse mesh. Finer meshes add orders that the joints hardly couple with others: there the residual
//! of the fine mesh is corrected with the matrix of the coarse one and, in the orders above it, with
//! the mean system.
#![allow(clippy::needless_range_loop, reason = "samples, orders and unknowns count together")]

use std::f64::consts::PI;

use nalgebra::{Complex, DMatrix, DVector, Dyn, LU};

use crate::dynamics::lanes::{Lanes, Pack, ZERO, all};
use crate::dynamics::newton::{EquationRow, Equations};
use crate::dynamics::orbit::{Failure, Orbit};
use crate::dynamics::periodic::{FourierSeries, roots_of_unity};
use crate::dynamics::pool::Pool;
use crate::dynamics::search::{DriveMotion, Found, OrbitGoal, Search};
use crate::dynamics::side_by_side::RunsSideBySide;
use crate::dynamics::system::{Spring, TorsionalSystem};
use crate::number::elementary::{ln, norm};

/// Permitted error of the orbit from which the search starts.
const START: f64 = 1e-3;

/// Steps of Newton's method, and corrections on a fine mesh.
const STEPS: usize = 30;
const CORRECTIONS: usize = 60;

/// The most orders of the coarse mesh per half turn of the period, and of the fine one.
const COARSE: usize = 64;
const FINE: usize = 512;

/// The last correction, beside the largest amplitude and the permitted error.
const MARGIN: f64 = 0.01;

/// How far beside a speed, relative to it, the torque of the drive is compared.
const ASIDE: f64 = 1e-4;

/// The last change of Newton's method on a coarse mesh beside the largest amplitude.
const CONVERGED: f64 = 1e-7;

impl TorsionalSystem {
    /// Whether a coupling has a constant loss factor.
    pub(super) fn has_loss_factors(&self) -> bool {
        self.springs.iter().any(|spring| spring.law.loss_factor > 0.0)
    }

    /// The system with viscous dampings in place of the loss factors: those that take as much from
    /// the vibration that joints make grow first at a speed in rad/s.
    pub(super) fn viscous(&self, speed: f64) -> Self {
        let time = self.time_of_growing(speed);
        self.with_dampings(|_| time)
    }

    /// Likewise those that take as much from an orbit, of which these are the torques.
    pub(super) fn viscous_on_orbit(&self, speed: f64, torques: &[FourierSeries]) -> Self {
        let base = 2.0 * speed / self.half_turns as f64;
        self.with_dampings(|place| {
            let spring = &self.springs[place];
            let (c, eta) = (spring.law.stiffness_at(0.0), spring.law.loss_factor);
            let (mut hysteretic, mut viscous) = (0.0, 0.0);
            for (n, x) in (1..).map(f64::from).zip(&torques[place].amplitudes) {
                let rate = n * base;
                let twist = x / (c + I * (c * eta + rate * spring.damping));
                hysteretic += rate * twist.norm_sqr();
                viscous += rate * rate * twist.norm_sqr();
            }
            let vibrates = viscous > 0.0;
            if vibrates { hysteretic / viscous } else { self.time_of_growing(speed) }
        })
    }

    /// The reciprocal in s of the frequency of that vibration. Joints make two vibrations grow
    /// together where twice the speed is the sum of their natural frequencies, against the product
    /// of their dampings, which belongs to the geometric mean of the frequencies.
    fn time_of_growing(&self, speed: f64) -> f64 {
        let each = self.natural_frequencies();
        let away = |(x, y): &(f64, f64)| ln((x + y) / (2.0 * speed)).abs();
        let pairs = each.iter().flat_map(|&x| each.iter().map(move |&y| (x, y)));
        let nearest = pairs.min_by(|one, other| away(one).total_cmp(&away(other)));
        nearest.map_or(0.0, |(x, y)| (x * y).sqrt().recip())
    }

    /// The system with viscous dampings in place of the loss factors: `c η` times a time in s.
    fn with_dampings(&self, time: impl Fn(usize) -> f64) -> Self {
        let mut viscous = self.clone();
        for (place, spring) in viscous.springs.iter_mut().enumerate() {
            let stiffness = spring.law.stiffness_at(self.load_torque);
            spring.damping += stiffness * spring.law.loss_factor * time(place);
            spring.law.loss_factor = 0.0;
        }
        viscous
    }

    /// The derivative of the mean torque of a free drive by its mean speed in N m s/rad, of a system
    /// with loss factors; `None` of a held one, and without orbits on both sides.
    pub(super) fn torque_slope(
        &self,
        speed: f64,
        goal: OrbitGoal,
        pool: &mut Pool<'_>,
    ) -> Option<f64> {
        if !self.is_free() {
            return None;
        }
        let [below, above] = [-ASIDE, ASIDE].map(|side| {
            let found = self.balance(speed * (1.0 + side), goal, pool);
            found.ok().map(|found| found.drive.torque)
        });
        Some((above? - below?) / (2.0 * ASIDE * speed))
    }

    /// Torques that loss factors add to those of the compliant shafts at a mean speed in rad/s.
    pub(super) fn hysteretic_torques(
        &self,
        speed: f64,
        torques: &[FourierSeries],
    ) -> Vec<FourierSeries> {
        let of = |(spring, all): (&Spring, &FourierSeries)| {
            let (c, eta) = (spring.law.stiffness_at(0.0), spring.law.loss_factor);
            let base = 2.0 * speed / self.half_turns as f64;
            let part = |(n, x): (f64, &Complex<f64>)| {
                let whole = c + I * (c * eta + n * base * spring.damping);
                if eta == 0.0 { Complex::default() } else { x * I * c * eta / whole }
            };
            let amplitudes = (1..).map(f64::from).zip(&all.amplitudes).map(part).collect();
            FourierSeries { mean: 0.0, amplitudes, ..*all }
        };
        self.springs.iter().zip(torques).map(of).collect()
    }

    /// The orbit at a mean speed in rad/s.
    pub(super) fn balance(
        &self,
        speed: f64,
        goal: OrbitGoal,
        pool: &mut Pool<'_>,
    ) -> Result<Found, Failure> {
        let near = OrbitGoal { tolerance: START, order: 0.0, stability: false };
        let viscous = self.viscous(speed);
        let start = pool.run(vec![Search::at(&viscous, speed, near)]).remove(0)?.orbit;
        let mut balance = HarmonicBalance::new(self, speed, &start);
        let top = self.highest_order().max(4.0) + 2.0;
        let mut coarse = (0.5 * top * self.half_turns as f64).ceil() as usize;
        while coarse <= COARSE * self.mesh() {
            let solved = balance.solve(coarse)?;
            let mut orders = (2 * coarse).next_power_of_two() - 1;
            while orders < FINE * self.mesh() {
                let Some(found) = balance.correct(&solved, orders, goal.tolerance) else { break };
                let enough = orders as f64 > 0.5 * goal.order * self.half_turns as f64;
                if enough && found.is_resolved(goal.tolerance) {
                    return Ok(balance.result(found));
                }
                orders = 2 * orders + 1;
            }
            coarse *= 2;
        }
        Err(Failure::NotResolved)
    }
}

/// The equations of one run on meshes of many sizes, and the latest orbit.
struct HarmonicBalance<'a> {
    system: &'a TorsionalSystem,
    runs: RunsSideBySide,
    /// The amplitudes of the unknowns: mean first, then order by order, `(unknowns, orders + 1)`.
    amplitudes: Vec<Vec<Complex<f64>>>,
    mean_torque: f64,
}

/// The equations at samples.
struct Rows {
    /// Residuals of the equations, `(unknowns, samples)`.
    residuals: Vec<Vec<f64>>,
    linear: Vec<Vec<EquationRow>>,
    /// The ratios of the pieces before the springs.
    ratios: Vec<Vec<f64>>,
    /// `(springs, samples)`.
    torques: Vec<Vec<f64>>,
    twists: Vec<Vec<f64>>,
    /// The mean torque of the drive.
    losses: f64,
}

/// The matrix of a coarse mesh at its solution.
struct Solved {
    mesh: Mesh,
    matrix: LU<f64, Dyn, Dyn>,
    mean: Vec<MeanDerivatives>,
}

/// The means of an equation's derivatives, as of an [`EquationRow`].
#[derive(Clone, Copy, Default)]
struct MeanDerivatives {
    acceleration: f64,
    slope: [f64; 3],
    angle: [f64; 3],
}

/// The torques of a fine mesh.
struct Fine {
    torques: Vec<Vec<Complex<f64>>>,
    losses: f64,
}

/// Cosines and sines of all multiples of a part of a turn.
struct Mesh {
    roots: Vec<Complex<f64>>,
    orders: usize,
}

impl Mesh {
    /// The mesh that resolves so many orders.
    fn new(orders: usize) -> Self {
        Self { roots: roots_of_unity(2 * orders + 1), orders }
    }

    fn count(&self) -> usize {
        self.roots.len()
    }

    /// The distance of the samples in rad for a period of so many half turns.
    fn width(&self, half_turns: usize) -> f64 {
        PI * half_turns as f64 / self.count() as f64
    }

    /// The powers of a root of unity, from the first one on.
    fn powers(&self, root: usize) -> impl Iterator<Item = Complex<f64>> {
        let (count, mut place) = (self.count(), 0);
        std::iter::repeat_with(move || {
            let power = self.roots[place];
            place += root;
            place -= if place >= count { count } else { 0 };
            power
        })
    }

    /// The amplitudes of samples.
    fn amplitudes(&self, samples: &[f64]) -> Vec<Complex<f64>> {
        let of = |n: usize| {
            let terms = self.powers(n).zip(samples).map(|(root, x)| root.conj() * *x);
            let scale = if n == 0 { 1.0 } else { 2.0 } / self.count() as f64;
            terms.sum::<Complex<f64>>() * scale
        };
        (0..=self.orders).map(of).collect()
    }

    /// The samples of `Re Σ factor(n) X_n e^{inx}`.
    fn samples(
        &self,
        amplitudes: &[Complex<f64>],
        factor: impl Fn(f64) -> Complex<f64>,
    ) -> Vec<f64> {
        let of_mesh = amplitudes.iter().take(self.orders + 1).enumerate();
        let terms: Vec<Complex<f64>> = of_mesh.map(|(n, x)| factor(n as f64) * x).collect();
        let real = |root: Complex<f64>, x: &Complex<f64>| x.re * root.re - x.im * root.im;
        let at = |k: usize| self.powers(k).zip(&terms).map(|(root, x)| real(root, x)).sum();
        (0..self.count()).map(at).collect()
    }

    /// The circulant matrix that multiplies order `n` by a factor, by the distance of the samples.
    fn kernel(&self, factor: impl Fn(f64) -> Complex<f64>) -> Vec<f64> {
        let scale = 2.0 / self.count() as f64;
        let ones: Vec<_> = (0..=self.orders).map(|n| Complex::from(f64::from(n > 0))).collect();
        self.samples(&ones, |n| factor(n) * scale)
    }
}

const I: Complex<f64> = Complex::new(0.0, 1.0);

/// `i` times the sign of an order, which is not negative.
fn hilbert(n: f64) -> Complex<f64> {
    if n > 0.0 { I } else { Complex::default() }
}

impl<'a> HarmonicBalance<'a> {
    fn new(system: &'a TorsionalSystem, speed: f64, start: &Orbit) -> Self {
        let mut runs = RunsSideBySide::default();
        runs.load(&[(system, speed)]);
        let roots = roots_of_unity(start.intervals);
        let amplitudes = (0..start.unknowns)
            .map(|u| {
                let series =
                    FourierSeries::through(system.half_turns, |k| start.state(k).0[u], &roots);
                std::iter::once(Complex::from(series.mean)).chain(series.amplitudes).collect()
            })
            .collect();
        Self { system, runs, amplitudes, mean_torque: start.mean_torque }
    }

    /// The order of the drive's rotation that repeats once in a period.
    fn base(&self) -> f64 {
        2.0 / self.system.half_turns as f64
    }

    /// The equations at the samples of a mesh.
    fn rows(&mut self, mesh: &Mesh) -> Rows {
        let (base, m) = (self.base(), self.amplitudes.len());
        let (springs, lanes) = (self.system.springs.len(), Lanes::of(true, 1));
        let curve = |factor: &dyn Fn(f64) -> Complex<f64>| -> Vec<Vec<f64>> {
            self.amplitudes.iter().map(|own| mesh.samples(own, factor)).collect()
        };
        let y = curve(&|_| Complex::from(1.0));
        let v = curve(&|n| I * base * n);
        let a = curve(&|n| Complex::from(-(base * n).powi(2)));
        let state = |k: usize| {
            [&y, &v, &a].map(|of| of.iter().map(|own| all(own[k])).collect::<Vec<Pack>>())
        };
        let angle = |k: usize| k as f64 * mesh.width(self.system.half_turns);
        let count = mesh.count();
        let empty = vec![vec![0.0; count]; springs];
        let mut found = Rows {
            residuals: vec![vec![0.0; count]; m],
            linear: vec![vec![EquationRow::default(); m]; count],
            ratios: empty.clone(),
            torques: empty.clone(),
            twists: empty,
            losses: 0.0,
        };
        for k in 0..count {
            let [y, v, _] = state(k);
            self.runs.prepare(lanes, angle(k), &y, &v);
            for s in 0..springs {
                found.twists[s][k] = self.runs.twists[s][0];
            }
        }
        let mut added = vec![];
        for (spring, twists) in self.system.springs.iter().zip(&found.twists) {
            let by = spring.law.loss_factor * spring.law.stiffness_at(0.0);
            let twist = mesh.amplitudes(twists);
            added.push(mesh.samples(&twist, |n| hilbert(n) * by));
            let power = |(n, x): (usize, &Complex<f64>)| base * n as f64 * norm(*x).powi(2);
            found.losses += 0.5 * by * twist.iter().enumerate().map(power).sum::<f64>();
        }
        self.runs.set_mean_torque(&all(self.mean_torque));
        let mut losses = ZERO;
        for k in 0..count {
            let [y, v, a] = state(k);
            for s in 0..springs {
                self.runs.springs[s].preload[0] = added[s][k];
            }
            self.runs.rows(lanes, angle(k), [&y, &v, &a], &mut found.linear[k]);
            self.runs.add_losses(lanes, &v, &mut losses);
            for u in 0..m {
                found.residuals[u][k] = found.linear[k][u].residual[0];
            }
            for s in 0..springs {
                found.ratios[s][k] = self.runs.ratio(s);
                found.torques[s][k] = self.runs.torques[s][0];
                self.runs.springs[s].preload[0] = 0.0;
            }
        }
        found.losses += losses[0] / count as f64;
        found
    }

    /// Newton's method on a coarse mesh.
    fn solve(&mut self, orders: usize) -> Result<Solved, Failure> {
        let mesh = Mesh::new(orders);
        let (base, m, count) = (self.base(), self.amplitudes.len(), mesh.count());
        let [first, second, turned] = [
            mesh.kernel(|n| I * base * n),
            mesh.kernel(|n| Complex::from(-(base * n).powi(2))),
            mesh.kernel(hilbert),
        ];
        self.amplitudes.iter_mut().for_each(|own| own.resize(orders + 1, Complex::default()));
        let free = usize::from(self.system.is_free());
        let size = count * m;
        for _ in 0..STEPS {
            let rows = self.rows(&mesh);
            let mut matrix = DMatrix::<f64>::zeros(size + free, size + free);
            for j in 0..count {
                for k in 0..count {
                    let d = (j + count - k) % count;
                    for (u, row) in rows.linear[j].iter().enumerate() {
                        for (c, w) in neighbours(u, m) {
                            let mut entry = row.by_slope[c][0] * first[d];
                            if c == 1 {
                                entry += row.by_acceleration[0] * second[d];
                            }
                            if d == 0 {
                                entry += row.by_angle[c][0];
                            }
                            matrix[(j * m + u, k * m + w)] += entry;
                        }
                    }
                    let ratios = |s: usize| [rows.ratios[s][j], rows.ratios[s][k]];
                    self.hysteretic(ratios, |u, w, stiffness| {
                        matrix[(j * m + u, k * m + w)] += stiffness * turned[d];
                    });
                }
                if free == 1 {
                    matrix[(j * m, size)] = -1.0;
                    matrix[(size, j * m)] = 1.0 / count as f64;
                }
            }
            let matrix = matrix.lu();
            let change = self.improve(&mesh, &matrix, &rows.residuals);
            if !change.is_finite() {
                return Err(Failure::NotFound);
            }
            if change <= CONVERGED * self.largest() {
                return Ok(Solved { mesh, matrix, mean: rows.mean() });
            }
        }
        Err(Failure::NotFound)
    }

    /// Calls `put` with two unknowns and what the equation of the first one gains by the Hilbert
    /// transform of the second one. The ratios of the piece before a spring are those where the
    /// torque acts and where the twist is.
    fn hysteretic(
        &self,
        ratios: impl Fn(usize) -> [f64; 2],
        mut put: impl FnMut(usize, usize, f64),
    ) {
        let free = usize::from(self.system.is_free());
        for (s, spring) in self.system.springs.iter().enumerate() {
            let by = spring.law.loss_factor * spring.law.stiffness_at(0.0);
            if by == 0.0 {
                continue;
            }
            let [of_torque, of_twist] =
                ratios(s).map(|ratio| [((s + free).checked_sub(1), ratio), (Some(s + free), -1.0)]);
            for (u, torque) in of_torque {
                for (w, twist) in of_twist {
                    if let (Some(u), Some(w)) = (u, w) {
                        put(u, w, torque * by * twist);
                    }
                }
            }
        }
    }

    /// A step with the matrix of a mesh for the residuals on it, `(unknowns, samples)`. Returns the
    /// largest change.
    fn improve(&mut self, mesh: &Mesh, matrix: &LU<f64, Dyn, Dyn>, residuals: &[Vec<f64>]) -> f64 {
        let (m, count) = (residuals.len(), mesh.count());
        let mut changes = DVector::zeros(count * m + usize::from(self.system.is_free()));
        for (u, own) in residuals.iter().enumerate() {
            for (j, residual) in own.iter().enumerate() {
                changes[j * m + u] = -residual;
            }
        }
        if self.system.is_free() {
            changes[count * m] = -self.amplitudes[0][0].re;
        }
        if !matrix.solve_mut(&mut changes) {
            return f64::NAN;
        }
        // NaN stays.
        let larger = |most: f64, x: &f64| if x.abs() <= most { most } else { x.abs() };
        let largest = changes.rows(0, count * m).iter().fold(0.0, larger);
        // No step turns a shaft by more than half a radian, where the joints' curves bend.
        let part = if largest > 0.5 { 0.5 / largest } else { 1.0 };
        for (u, own) in self.amplitudes.iter_mut().enumerate() {
            let samples: Vec<f64> = (0..count).map(|k| part * changes[k * m + u]).collect();
            for (x, dx) in own.iter_mut().zip(mesh.amplitudes(&samples)) {
                *x += dx;
            }
        }
        if let Some(change) = changes.get(count * m) {
            self.mean_torque += part * change;
        }
        largest
    }

    /// The largest amplitude of the unknowns, with their means.
    fn largest(&self) -> f64 {
        self.amplitudes.iter().flatten().fold(0.0, |most, x| norm(*x).max(most))
    }

    /// Corrects the orbit on a mesh of so many orders; `None` if that does not converge.
    fn correct(&mut self, solved: &Solved, orders: usize, tolerance: f64) -> Option<Fine> {
        let fine = Mesh::new(orders);
        self.amplitudes.iter_mut().for_each(|own| own.resize(orders + 1, Complex::default()));
        let mut before = f64::INFINITY;
        for step in 0..CORRECTIONS {
            let rows = self.rows(&fine);
            let left: Vec<_> = rows.residuals.iter().map(|own| fine.amplitudes(own)).collect();
            let low: Vec<_> =
                left.iter().map(|own| solved.mesh.samples(own, |_| Complex::from(1.0))).collect();
            let mut change = self.improve(&solved.mesh, &solved.matrix, &low);
            for n in solved.mesh.orders + 1..=orders {
                let right = DVector::from_iterator(left.len(), left.iter().map(|own| -own[n]));
                let steps = self.of_mean(solved, n).lu().solve(&right)?;
                for (own, dx) in self.amplitudes.iter_mut().zip(steps.iter()) {
                    own[n] += dx;
                    change = change.max(norm(*dx));
                }
            }
            let enough = MARGIN * tolerance * self.largest();
            let slow = step > 3 && change > 0.8 * before;
            if change <= enough {
                let torques = rows.torques.iter().map(|own| fine.amplitudes(own)).collect();
                return Some(Fine { torques, losses: rows.losses });
            }
            if slow || !change.is_finite() {
                return None;
            }
            before = change;
        }
        None
    }

    /// The matrix of the mean system for the amplitudes of an order.
    fn of_mean(&self, solved: &Solved, order: usize) -> DMatrix<Complex<f64>> {
        let (m, n) = (solved.mean.len(), self.base() * order as f64);
        let mut matrix = DMatrix::<Complex<f64>>::zeros(m, m);
        for (u, MeanDerivatives { acceleration, slope, angle }) in solved.mean.iter().enumerate() {
            matrix[(u, u)] -= n * n * acceleration;
            for (c, w) in neighbours(u, m) {
                matrix[(u, w)] += Complex::new(angle[c], n * slope[c]);
            }
        }
        self.hysteretic(|_| [1.0, 1.0], |u, w, stiffness| matrix[(u, w)] += I * stiffness);
        matrix
    }

    /// Result of the search.
    fn result(&self, Fine { torques, losses }: Fine) -> Found {
        let (half_turns, base) = (self.system.half_turns, self.base());
        let series = |own: &[Complex<f64>]| FourierSeries {
            half_turns,
            mean: own[0].re,
            amplitudes: own[1..].to_vec(),
        };
        let unknowns: Vec<_> = self.amplitudes.iter().map(|own| series(own)).collect();
        let mesh = (2 * self.amplitudes[0].len(), half_turns);
        let mut orbit = Orbit::start(unknowns.len(), mesh, |angle, [y, v, a]| {
            for (u, own) in unknowns.iter().enumerate() {
                [y[u], v[u], a[u]] = own.at(angle);
            }
        });
        orbit.mean_torque = self.mean_torque;
        let slope = self.system.is_free().then(|| {
            let rates = self.amplitudes[0].iter().enumerate();
            let rates: Vec<_> = rates.map(|(n, x)| I * base * n as f64 * x).collect();
            series(&rates)
        });
        let drive = DriveMotion { torque: losses, slope, torque_slope: None };
        let torques = torques.iter().map(|own| series(own)).collect();
        Found { orbit, contraction: 0.0, torques, drive, extremes: None }
    }
}

impl Rows {
    /// The coefficients of the mean system.
    fn mean(&self) -> Vec<MeanDerivatives> {
        let mut mean = vec![MeanDerivatives::default(); self.residuals.len()];
        let part = 1.0 / self.linear.len() as f64;
        for rows in &self.linear {
            for (row, mean) in rows.iter().zip(&mut mean) {
                mean.acceleration += part * row.by_acceleration[0];
                for c in 0..3 {
                    mean.slope[c] += part * row.by_slope[c][0];
                    mean.angle[c] += part * row.by_angle[c][0];
                }
            }
        }
        mean
    }
}

impl Fine {
    /// Whether the orders of the torques fall below a share of the largest one.
    fn is_resolved(&self, tolerance: f64) -> bool {
        self.torques.iter().all(|own| {
            let largest =
                |part: &[Complex<f64>]| part.iter().fold(0.0, |most, x| norm(*x).max(most));
            largest(&own[own.len() * 3 / 4..]) <= tolerance * largest(own)
        })
    }
}

/// The unknowns in the equation of one of `m`, with the places of their derivatives in its row.
fn neighbours(unknown: usize, m: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..3).filter_map(move |c| {
        (unknown + c).checked_sub(1).filter(|other| *other < m).map(|other| (c, other))
    })
}
