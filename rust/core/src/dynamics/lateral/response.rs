//! Response of a system at steady speeds.

use nalgebra::Complex;

use crate::dynamics::lateral::equations::{BandEquations, Nodes};
use crate::dynamics::lateral::rate::Rate;
use crate::dynamics::lateral::system::LateralSystem;
use crate::error::{Error, Result};
use crate::mechanics::phasing::is_set;
use crate::run::execution::Execution;
use crate::run::queue::{threads, work_off};

type C = Complex<f64>;

/// The fewest runs that take longer than it takes to wake a thread.
const ENOUGH: usize = 64;

/// Which system runs at which speed, and what its joints transmit.
#[derive(Clone, Copy, Debug)]
pub struct LateralRuns<'a> {
    /// The systems, all with the same numbers of joints and bearings.
    pub systems: &'a [LateralSystem],
    /// The system of each run.
    pub system: &'a [usize],
    /// The speed of the drive in each run, in rad/s.
    pub speed: &'a [f64],
    /// Multiples of the drive speed, the same in each run.
    pub orders: &'a [f64],
    /// Amplitudes of the moment of each joint on its driven shaft in N m,
    /// `(runs, orders, joints, 3)`.
    pub moments: &'a [C],
    /// Shafts and positions in m of the places whose displacements are asked for.
    pub probes: &'a [(usize, f64)],
}

/// The vectors and numbers of a run at one order.
struct Record<'a> {
    vectors: &'a mut [C],
    powers: &'a mut [f64],
}

impl LateralRuns<'_> {
    /// Vectors of a run at one order: forces and displacements of bearings, forces and
    /// displacements of joints, displacements of probes.
    pub fn vectors(&self) -> usize {
        self.systems.first().map_or(0, |system| 2 * (system.bearings() + system.joints()))
            + self.probes.len()
    }

    /// Powers of a run at one order: those lost in each bearing, that lost in the shafts, and that of
    /// all excitations.
    pub fn powers(&self) -> usize {
        self.systems.first().map_or(0, LateralSystem::bearings) + 2
    }

    /// Fills vectors, `(runs, orders, vectors, 3)`, and mean powers in W, `(runs, orders, powers)`.
    ///
    /// # Errors
    /// A probe beyond its shaft, a speed so large that waves are too short.
    pub fn responses(
        &self,
        vectors: &mut [C],
        powers: &mut [f64],
        execution: Execution<'_>,
    ) -> Result<()> {
        let Execution { workers, stop, .. } = execution;
        let Some(first) = self.systems.first() else { return Ok(()) };
        for system in self.systems {
            for (i, &(shaft, position)) in self.probes.iter().enumerate() {
                system.place("probes", i, shaft, position)?;
            }
        }
        for (i, (&system, &speed)) in self.system.iter().zip(self.speed).enumerate() {
            for order in self.orders {
                let omega = order * speed;
                if !(omega.is_finite() && self.systems[system].has_long_waves(omega, speed)) {
                    let problem = format!(
                        "is {speed:?} rad/s; at order {order:?} waves are too short for these shafts"
                    );
                    return Err(Error::new("speed", &[i], problem));
                }
            }
        }
        let orders = self.orders.len();
        let each = (3 * self.vectors() * orders, self.powers() * orders);
        let given = 3 * first.joints() * orders;
        let count = self.speed.len();
        let threads = threads(count * orders > ENOUGH, workers);
        // Several blocks for each thread, so that threads end together.
        let block = (count / (8 * threads)).clamp(1, ENOUGH);
        if orders == 0 {
            return Ok(());
        }
        let items = vectors
            .chunks_mut(each.0 * block)
            .zip(powers.chunks_mut(each.1 * block))
            .zip(self.system.chunks(block).zip(self.speed.chunks(block)))
            .enumerate();
        work_off(
            items,
            threads,
            BandEquations::default,
            |equations, (i, (out, (systems, speeds)))| {
                if is_set(stop) {
                    return;
                }
                let mut layout: Option<(usize, Nodes<'_>)> = None;
                let runs = out.0.chunks_mut(each.0).zip(out.1.chunks_mut(each.1));
                for (j, ((vectors, powers), (&system, &speed))) in
                    runs.zip(systems.iter().zip(speeds)).enumerate()
                {
                    let known = layout.take().filter(|(own, _)| *own == system);
                    let (_, layout) = layout.insert(
                        known.unwrap_or_else(|| (system, Nodes::new(&self.systems[system], false))),
                    );
                    let places = vectors
                        .chunks_mut(each.0 / orders)
                        .zip(powers.chunks_mut(each.1 / orders))
                        .zip(self.orders);
                    for (k, ((vectors, powers), &order)) in places.enumerate() {
                        let at = (i * block + j) * given + k * given / orders;
                        let moments = &self.moments[at..][..given / orders];
                        let record = Record { vectors, powers };
                        self.one(equations, layout, Rate::of_order(order, speed), moments, record);
                    }
                }
            },
        );
        Ok(())
    }

    /// One run at one order.
    fn one(
        &self,
        equations: &mut BandEquations,
        layout: &Nodes<'_>,
        at: Rate,
        moments: &[C],
        Record { vectors, powers }: Record<'_>,
    ) {
        let system = layout.system;
        equations.assemble(layout, at, at.omega);
        for (joint, moment) in moments.chunks_exact(3).enumerate() {
            for (shaft, sign) in [(joint, -1.0), (joint + 1, 1.0)] {
                if let Some(place) = layout.end(shaft, joint) {
                    let u = system.directions[shaft];
                    let couple = [(1, 2), (2, 0), (0, 1)]
                        .map(|(a, b)| (moment[a] * u[b] - moment[b] * u[a]) * sign);
                    equations.add_couple(layout, shaft, place, couple);
                }
            }
        }
        equations.factor();
        equations.solve();
        let mut vectors = vectors.chunks_exact_mut(3);
        let mut put = |vector: [C; 3]| {
            if let Some(place) = vectors.next() {
                place.copy_from_slice(&vector);
            }
        };
        let bearings = layout.bearings.iter().zip(&system.attached.bearings);
        let moved = |shaft, place| equations.displacement(layout, shaft, place);
        for ((axes, place), own) in bearings.clone() {
            let moved = moved(own.shaft, *place);
            let forces = own.dynamic_stiffness(at);
            let along = [0, 1].map(|i| forces[i] * scalar(moved, axes[i]));
            put([0, 1, 2].map(|i| -(along[0] * axes[0][i] + along[1] * axes[1][i])));
        }
        for ((_, place), own) in bearings.clone() {
            put(moved(own.shaft, *place));
        }
        for (&first, &shaft) in equations.joints.iter().zip(&system.sliding) {
            let turning = system.turning(shaft);
            let [with, against] = [0, 1].map(|i| equations.unknowns[first + i] * equations.unit);
            put([0, 1, 2].map(|i| turning[0][i] * with + turning[1][i] * against));
        }
        for (joint, &shaft) in system.sliding.iter().enumerate() {
            put(layout.end(shaft, joint).map_or([C::ZERO; 3], |place| moved(shaft, place)));
        }
        for &(shaft, position) in self.probes {
            put(equations.displacement_at(layout, at, shaft, position));
        }
        let mut powers = powers.iter_mut();
        let mut put = |power: f64| {
            if let Some(place) = powers.next() {
                *place = power;
            }
        };
        for ((axes, place), own) in bearings {
            let moved = moved(own.shaft, *place);
            let lost = |(axis, stiffness): (_, C)| stiffness.im * scalar(moved, axis).norm_sqr();
            let both: f64 = axes.iter().copied().zip(own.dynamic_stiffness(at)).map(lost).sum();
            put(0.5 * at.omega * both);
        }
        put(if at.lossy { 0.5 * at.omega * equations.lost_in_pieces() } else { 0.0 });
        put(0.5 * at.omega * equations.given_power(layout, at));
    }
}

/// `v · axis`.
fn scalar(v: [C; 3], axis: crate::mechanics::geometry::Vector) -> C {
    v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2]
}
