//! Sums over the samples of tilts, torques, moments and forces, in vectorised loops.
//!
//! The formulas are those of [`super::sample`] for a chunk of samples. All vectors are linear in the
//! moments of the joints: the weights of supports and forces are first passed back to weights `μ_j`
//! of the moments `M_j`, and the value is `Σ μ_j·M_j`.

use crate::mechanics::geometry::Vector;
use crate::number::trig;
use crate::plan::forces::{Balance, ForceOf, ForceStep};
use crate::plan::{End, Output};
use crate::run::gradient::columns::{
    ChunkColumn, Vectors, ZEROS, across, add, add_cross, each, repeated,
};
use crate::run::gradient::line::{LineConstants, PoseConstants, ShaftConstants, Sums};
use crate::run::gradient::motion::{find_sines, turned};
use crate::run::level::Level;

/// The load of the samples of a chunk.
pub(super) struct LoadColumns {
    pub(super) end: End,
    pub(super) torque: ChunkColumn,
    pub(super) speed: ChunkColumn,
    pub(super) acceleration: ChunkColumn,
    /// One per shaft.
    pub(super) inertias: Vec<ChunkColumn>,
}

impl LoadColumns {
    pub(super) fn new(end: End, shafts: usize) -> Self {
        let inertias = repeated(&ZEROS, shafts);
        Self { end, torque: ZEROS, speed: ZEROS, acceleration: ZEROS, inertias }
    }
}

/// An output of a shaft, joint or bearing with its weights. Scalars have them in the first column.
pub(super) type Weighted = (Output, usize, Vectors);

/// The columns of one chunk: the state of the driveline, and how the value changes with it.
pub(super) struct LoadBuffers {
    /// Sine and cosine of the drive angle up to a positive factor, and those of the input angle of
    /// each joint.
    pub(super) drive: [ChunkColumn; 2],
    pub(super) pins: Vec<[ChunkColumn; 2]>,
    /// Speed and acceleration ratio of each shaft.
    pub(super) rates: Vec<[ChunkColumn; 2]>,
    /// Power over the drive's speed, on its way into each shaft and out of the last.
    pub(super) power: Vec<ChunkColumn>,
    pub(super) torsion: Vec<ChunkColumn>,
    pub(super) moments: Vec<Vectors>,
    /// The forces of both supports of each balance.
    pub(super) forces: Vec<[Vectors; 2]>,
    pub(super) by_rates: Vec<[ChunkColumn; 2]>,
    pub(super) by_power: Vec<ChunkColumn>,
    pub(super) by_moments: Vec<Vectors>,
    pub(super) by_forces: Vec<[Vectors; 2]>,
    /// By the input angle of the joint behind each shaft, divided by `tan β`.
    pub(super) by_turn: Vec<ChunkColumn>,
}

impl LoadBuffers {
    pub(super) fn new(joints: usize, forces: Option<&ForceStep>) -> Self {
        let balances = forces.map_or(0, |step| step.balances.len());
        Self {
            drive: [ZEROS; 2],
            pins: repeated(&[ZEROS; 2], joints),
            rates: repeated(&[ZEROS; 2], joints + 1),
            power: repeated(&ZEROS, joints + 2),
            torsion: repeated(&ZEROS, joints),
            moments: repeated(&[ZEROS; 3], joints),
            forces: repeated(&[[ZEROS; 3]; 2], balances),
            by_rates: repeated(&[ZEROS; 2], joints + 1),
            by_power: repeated(&ZEROS, joints + 2),
            by_moments: repeated(&[ZEROS; 3], joints),
            by_forces: repeated(&[[ZEROS; 3]; 2], balances),
            by_turn: repeated(&ZEROS, joints + 1),
        }
    }

    fn clear(&mut self, vectors: bool) {
        self.by_rates.fill([ZEROS; 2]);
        self.by_power.fill(ZEROS);
        self.by_turn.fill(ZEROS);
        if vectors {
            self.by_moments.fill([ZEROS; 3]);
            self.by_forces.fill([[ZEROS; 3]; 2]);
        }
    }
}

/// One chunk of one driveline.
pub(super) struct LoadChunk<'a> {
    pub(super) line: &'a LineConstants<'a>,
    pub(super) forces: Option<&'a ForceStep>,
    pub(super) load: Option<&'a LoadColumns>,
    pub(super) level: Level,
}

impl LoadChunk<'_> {
    /// Adds what the weighted outputs of the samples contribute.
    pub(super) fn run(
        &self,
        angles: &ChunkColumn,
        outputs: &[Weighted],
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        let vectors = outputs.iter().any(|(output, ..)| output.components() == 3);
        buffers.clear(vectors);
        self.turn(angles, buffers);
        if let Some(load) = self.load {
            self.load(load, vectors, buffers);
        }
        for (output, item, weights) in outputs {
            self.pull(*output, *item, weights, buffers, sums);
        }
        for i in (0..self.forces.map_or(0, |step| step.balances.len())).rev() {
            self.pull_balance(i, buffers, sums);
        }
        if vectors {
            for joint in 0..self.line.poses.len() {
                self.pull_moment(joint, buffers, sums);
            }
        }
        if let Some(load) = self.load {
            self.pull_power(load, buffers, sums);
        }
        for shaft in 0..self.line.shafts.len() {
            self.pull_rates(shaft, buffers, sums);
        }
    }

    /// Sines and cosines, then speed and acceleration ratios.
    fn turn(&self, angles: &ChunkColumn, buffers: &mut LoadBuffers) {
        let LoadBuffers { drive: [sine, cosine], pins, rates, .. } = buffers;
        find_sines(trig::directed_pin, angles, sine, cosine, self.level);
        for (constants, rates) in self.line.shafts.iter().zip(rates) {
            let ShaftConstants { cosine: e, sine2, turn, .. } = *constants;
            each(
                self.level,
                rates.each_mut(),
                #[inline(always)]
                |i, _| {
                    let (s, c) = turned(sine[i], cosine[i], turn);
                    let inverse = (e * c).mul_add(e * c, s * s).recip();
                    let ratio = e * c.mul_add(c, s * s) * inverse;
                    ([ratio, -2.0 * ratio * (sine2 * (s * c) * inverse)], [])
                },
            );
        }
        for (pose, pins) in self.line.poses.iter().zip(pins) {
            let [a, b] = pose.map;
            let (xx, xy) = (a.re + b.re, b.im - a.im);
            let (yx, yy) = (a.im + b.im, a.re - b.re);
            each(
                self.level,
                pins.each_mut(),
                #[inline(always)]
                |i, _| {
                    let (s, c) = (sine[i], cosine[i]);
                    let (x, y) = (c.mul_add(xx, s * xy), c.mul_add(yx, s * yy));
                    let inverse = x.mul_add(x, y * y).sqrt().recip();
                    ([y * inverse, x * inverse], [])
                },
            );
        }
    }

    /// Power and torsions, then moments and forces.
    fn load(&self, load: &LoadColumns, vectors: bool, buffers: &mut LoadBuffers) {
        let (level, n) = (self.level, self.line.shafts.len());
        let LoadBuffers { pins, rates, power, torsion, moments, forces, .. } = buffers;
        match load.end {
            End::Drive => power[0] = load.torque,
            End::Output => {
                let (torque, ratio) = (&load.torque, &rates[n - 1][0]);
                each(
                    level,
                    [&mut power[n]],
                    #[inline(always)]
                    |i, _| ([torque[i] * ratio[i]], []),
                );
            }
        }
        for step in 0..n {
            let (shaft, from, to, sign) = match load.end {
                End::Drive => (step, step, step + 1, -1.0),
                End::Output => (n - 1 - step, n - step, n - 1 - step, 1.0),
            };
            let ([ratio, rate], inertia) = (&rates[shaft], &load.inertias[shaft]);
            let (speed, own) = (&load.speed, &load.acceleration);
            let Ok([known, out]) = power.get_disjoint_mut([from, to]) else { continue };
            each(
                level,
                [out],
                #[inline(always)]
                |i, _| {
                    let turning = (speed[i] * speed[i]).mul_add(rate[i], own[i] * ratio[i]);
                    ([(sign * inertia[i] * turning).mul_add(ratio[i], known[i])], [])
                },
            );
        }
        for (j, pose) in self.line.poses.iter().enumerate() {
            let (torsion, power, ratio) = (&mut torsion[j], &power[j + 1], &rates[j][0]);
            each(
                level,
                [&mut *torsion],
                #[inline(always)]
                |i, _| ([power[i] / ratio[i]], []),
            );
            if !vectors {
                continue;
            }
            let PoseConstants { tangent, axis, inward, normal, .. } = *pose;
            let ([sine, cosine], across, along) = (&pins[j], inward * tangent, normal * -tangent);
            each(
                level,
                moments[j].each_mut(),
                #[inline(always)]
                |i, _| {
                    let (s2, product) = (sine[i] * sine[i], sine[i] * cosine[i]);
                    let unit = |k: usize| s2.mul_add(across[k], product.mul_add(along[k], axis[k]));
                    ([0, 1, 2].map(|k| torsion[i] * unit(k)), [])
                },
            );
        }
        for (i, balance) in self.forces.iter().flat_map(|step| &step.balances).enumerate() {
            let (known, own) = forces.split_at_mut(i);
            self.solve(balance, moments, known, &mut own[0]);
        }
    }

    /// The moment of the joint behind a shaft minus that of the joint before it.
    pub(super) fn difference(&self, shaft: usize, moments: &[Vectors]) -> Vectors {
        let mut out = moments.get(shaft).copied().unwrap_or([ZEROS; 3]);
        if let Some(before) = shaft.checked_sub(1) {
            add(self.level, -1.0, &moments[before], &mut out);
        }
        out
    }

    /// The forces of one balance.
    fn solve(
        &self,
        balance: &Balance,
        moments: &[Vectors],
        known: &[[Vectors; 2]],
        [at_first, at_second]: &mut [Vectors; 2],
    ) {
        let (u, [first, second]) = self.placed(balance);
        let inverse = (second - first).recip();
        let difference = self.difference(balance.shaft, moments);
        (*at_first, *at_second) = ([ZEROS; 3], [ZEROS; 3]);
        add_cross(self.level, &(u * inverse), &difference, at_first);
        add(self.level, -1.0, at_first, at_second);
        for load in &balance.loads {
            let place = self.line.place(balance.shaft, load.at);
            let force = across(self.level, &known[load.force.balance][load.force.carrier], &u);
            let scale = -sign(load.force) * inverse;
            add(self.level, scale * (second - place), &force, at_first);
            add(self.level, scale * (place - first), &force, at_second);
        }
    }

    /// The direction of its shaft and the places of its supports.
    pub(super) fn placed(&self, balance: &Balance) -> (Vector, [f64; 2]) {
        let shaft = balance.shaft;
        let places = balance.carriers.map(|carrier| self.line.place(shaft, carrier));
        (self.line.axis(shaft), places)
    }
}

/// Whether a force is the opposite of that of its balance, as a factor.
pub(super) fn sign(force: ForceOf) -> f64 {
    if force.reversed { -1.0 } else { 1.0 }
}
