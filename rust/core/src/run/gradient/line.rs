//! One driveline: the constants of its samples, and what their sums say about its parameters.

use nalgebra::Complex;

use crate::input::Drivelines;
use crate::mechanics::as_built::DEVIATIONS;
use crate::mechanics::bearings::Carrier;
use crate::mechanics::chain::Equivalent;
use crate::mechanics::derivatives::{ChainMaps, Layout, Map, by_points, vector};
use crate::mechanics::geometry::Vector;
use crate::mechanics::joint::Joint;

/// The constants of one shaft's motion, which is that of its equivalent joint.
#[derive(Clone, Copy)]
pub(super) struct ShaftConstants {
    /// `cos β` of the equivalent joint.
    pub(super) cosine: f64,
    pub(super) sine2: f64,
    pub(super) versine: f64,
    /// `(1 + cos β)/2`.
    pub(super) mean: f64,
    /// Cosine and sine of the offset `φ` of its input angle.
    pub(super) turn: [f64; 2],
}

impl ShaftConstants {
    fn new(equivalent: &Equivalent) -> Self {
        let Equivalent { joint, turn_cos, turn_sin } = *equivalent;
        let Joint { cos: cosine, sin2: sine2, versine, .. } = joint;
        Self { cosine, sine2, versine, mean: 0.5 * (1.0 + cosine), turn: [turn_cos, turn_sin] }
    }

    /// `e^{2iφ}`, which takes `q` to that of the equivalent joint without an offset.
    fn double_turn(&self) -> Complex<f64> {
        let turn = Complex::new(self.turn[0], self.turn[1]);
        turn * turn
    }
}

/// The constants of one joint in space.
pub(super) struct PoseConstants {
    /// The map to its driving yoke.
    pub(super) map: Map,
    pub(super) cosine: f64,
    pub(super) sine: f64,
    pub(super) tangent: f64,
    pub(super) axis: Vector,
    pub(super) inward: Vector,
    pub(super) normal: Vector,
}

/// One driveline of a batch.
pub(super) struct LineConstants<'a> {
    joints: usize,
    chain: ChainMaps,
    layout: Layout<'a>,
    pub(super) phases: &'a [f64],
    /// The places of the bearings.
    positions: &'a [f64],
    pub(super) shafts: Vec<ShaftConstants>,
    /// Empty if no output needs them.
    pub(super) poses: Vec<PoseConstants>,
}

/// Sums over the samples: how the value changes with quantities of the driveline.
#[derive(Clone, Default)]
pub(super) struct Sums {
    pub(super) value: f64,
    /// By the `q` of each shaft, times `e^{2iφ}` of its equivalent joint.
    pub(super) q: Vec<Complex<f64>>,
    /// By the input angle of each joint, divided by `tan β`.
    pub(super) turn: Vec<f64>,
    /// By the input angle of each joint, of its pins. A turn of the joint's plane about its driving
    /// shaft turns them as much.
    pub(super) pins: Vec<f64>,
    /// By the bend of each joint, all else fixed.
    pub(super) bends: Vec<f64>,
    /// By a rotation of each shaft and the joint behind it in space.
    pub(super) frames: Vec<Vector>,
    /// By a turn of each joint's plane about its driving shaft, divided by `tan β`, without
    /// `pins`.
    pub(super) plane: Vec<f64>,
    /// By the phase of each intermediate shaft, all motion fixed.
    pub(super) phases: Vec<f64>,
    pub(super) angle: f64,
    pub(super) torque: f64,
    pub(super) inertias: Vec<f64>,
    pub(super) lengths: Vec<f64>,
    /// By the place of each bearing.
    pub(super) positions: Vec<f64>,
}

impl Sums {
    pub(super) fn new(Counts { joints, bearings }: Counts) -> Self {
        Self {
            q: vec![Complex::default(); joints + 1],
            turn: vec![0.0; joints],
            pins: vec![0.0; joints],
            bends: vec![0.0; joints],
            frames: vec![Vector::zeros(); joints + 1],
            plane: vec![0.0; joints],
            phases: vec![0.0; joints - 1],
            inertias: vec![0.0; joints + 1],
            lengths: vec![0.0; joints + 1],
            positions: vec![0.0; bearings],
            ..Self::default()
        }
    }

    pub(super) fn clear(&mut self) {
        *self = Self::new(Counts { joints: self.bends.len(), bearings: self.positions.len() });
    }

    /// Adds a change with the place of a support of a shaft.
    pub(super) fn pull_place(&mut self, shaft: usize, carrier: Carrier, weight: f64) {
        match carrier {
            Carrier::UpstreamJoint => {}
            Carrier::DownstreamJoint => self.lengths[shaft] += weight,
            Carrier::Bearing(bearing) => self.positions[bearing] += weight,
        }
    }

    pub(super) fn add(&mut self, other: &Self) {
        fn each<T: Copy + std::ops::AddAssign>(sums: &mut [T], others: &[T]) {
            sums.iter_mut().zip(others).for_each(|(sum, &other)| *sum += other);
        }
        self.value += other.value;
        self.angle += other.angle;
        self.torque += other.torque;
        each(&mut self.q, &other.q);
        each(&mut self.turn, &other.turn);
        each(&mut self.pins, &other.pins);
        each(&mut self.bends, &other.bends);
        each(&mut self.frames, &other.frames);
        each(&mut self.plane, &other.plane);
        each(&mut self.phases, &other.phases);
        each(&mut self.inertias, &other.inertias);
        each(&mut self.lengths, &other.lengths);
        each(&mut self.positions, &other.positions);
    }
}

/// Which derivatives are written, in this order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "a set of names")]
pub struct Wanted {
    /// The value itself, one number.
    pub value: bool,
    /// By bends, one number per joint.
    pub bends: bool,
    /// By twists, one number per intermediate shaft.
    pub twists: bool,
    /// By phases, one number per intermediate shaft.
    pub phases: bool,
    /// By points, three numbers for each of the ends and joints.
    pub points: bool,
    /// By the drive angle, one number. A gradient of motions alone leaves it 0, because each sample has
    /// an angle to itself.
    pub angle: bool,
    /// By the torque of the load, one number.
    pub torque: bool,
    /// By inertias, one number per shaft.
    pub inertias: bool,
    /// By the lengths of the shafts, all directions held, one number per shaft.
    pub lengths: bool,
    /// By the positions of the bearings, one number each.
    pub positions: bool,
    /// By the deviations of the joints, three numbers each.
    pub deviations: bool,
}

/// How many joints and bearings a driveline has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// The number of joints, at least one.
    pub joints: usize,
    /// The number of bearings.
    pub bearings: usize,
}

impl Wanted {
    /// How many numbers are written for a driveline with so many joints and bearings.
    pub fn count(&self, Counts { joints, bearings }: Counts) -> usize {
        let counts = [
            (self.value, 1),
            (self.bends, joints),
            (self.twists, joints - 1),
            (self.phases, joints - 1),
            (self.points, 3 * (joints + 2)),
            (self.angle, 1),
            (self.torque, 1),
            (self.inertias, joints + 1),
            (self.lengths, joints + 1),
            (self.positions, bearings),
            (self.deviations, DEVIATIONS * joints),
        ];
        counts.iter().filter(|(wanted, _)| *wanted).map(|(_, count)| count).sum()
    }
}

impl<'a> LineConstants<'a> {
    /// Driveline `line` of a batch. The motion of shafts is known where `moves` says so; `posed` if
    /// joints are needed in space.
    pub(super) fn new(
        lines: &Drivelines<'a>,
        Counts { joints, bearings }: Counts,
        line: usize,
        moves: impl Fn(usize) -> bool,
        posed: bool,
    ) -> Self {
        let of = |array: &'a [f64], each: usize| -> &'a [f64] {
            array.get(line * each..(line + 1) * each).unwrap_or(&[])
        };
        let bends = of(lines.bends, joints);
        let (twists, phases) = (of(lines.twists, joints - 1), of(lines.phases, joints - 1));
        let layout = Layout {
            directions: of(lines.directions, 3 * (joints + 1)),
            normals: of(lines.normals, 3 * joints),
            lengths: of(lines.lengths, joints + 1),
        };
        let straight = ShaftConstants::new(&Equivalent::nearest(&Equivalent::STRAIGHT));
        let mut shafts = vec![straight; joints + 1];
        let chain = ChainMaps::folded(bends, twists, phases, |shaft, transfer| {
            if moves(shaft) {
                let equivalent = transfer.renormalized().equivalent();
                shafts[shaft] = ShaftConstants::new(&Equivalent::nearest(&equivalent));
            }
        });
        let pose = |(j, &bend): (usize, &f64)| {
            let Joint { sin: sine, cos: cosine, .. } = Joint::new(bend);
            let (axis, normal) = (vector(layout.directions, j), vector(layout.normals, j));
            let (map, inward) = (chain.map_to_joint(j), normal.cross(&axis));
            PoseConstants { map, cosine, sine, tangent: sine / cosine, axis, inward, normal }
        };
        let poses = if posed { bends.iter().enumerate().map(pose).collect() } else { Vec::new() };
        let positions = of(lines.positions, bearings);
        Self { joints, chain, layout, phases, positions, shafts, poses }
    }

    /// Writes the derivatives that the sums make.
    pub(super) fn finish(&self, sums: &Sums, wanted: Wanted, out: &mut [f64]) {
        let mut out = out.iter_mut();
        let mut write = |numbers: &[f64]| {
            out.by_ref().zip(numbers).for_each(|(out, &number)| *out = number);
        };
        let adjoints = self.adjoints(sums);
        let gradient = self.chain.gradient(&adjoints);
        // The frames behind each joint turn with its bend, those from it on with its twist.
        let mut behind = vec![Vector::zeros(); self.joints + 2];
        for i in (0..=self.joints).rev() {
            behind[i] = behind[i + 1] + sums.frames[i];
        }
        if wanted.value {
            write(&[sums.value]);
        }
        if wanted.bends {
            for j in 0..self.joints {
                let turned = vector(self.layout.normals, j).dot(&behind[j + 1]);
                write(&[gradient.bends[j] + sums.bends[j] + turned]);
            }
        }
        for (is_wanted, of_twists) in [(wanted.twists, true), (wanted.phases, false)] {
            for j in (1..self.joints).filter(|_| is_wanted) {
                let turn = gradient.phases[j - 1] + self.input_angle(sums, j);
                let twisted = || self.axis(j).dot(&behind[j]) - turn;
                write(&[if of_twists { twisted() } else { turn + sums.phases[j - 1] }]);
            }
        }
        if wanted.points {
            let mut points = by_points(&self.by_directions(sums, &adjoints), self.layout);
            for (shaft, &length) in sums.lengths.iter().enumerate() {
                let along = self.axis(shaft) * length;
                points[shaft] -= along;
                points[shaft + 1] += along;
            }
            for point in &points {
                write(point.as_slice());
            }
        }
        if wanted.angle {
            write(&[sums.angle]);
        }
        if wanted.torque {
            write(&[sums.torque]);
        }
        if wanted.inertias {
            write(&sums.inertias);
        }
        if wanted.lengths {
            write(&sums.lengths);
        }
        if wanted.positions {
            write(&sums.positions);
        }
    }

    /// Where a support of a shaft is, from the shaft's upstream end.
    pub(super) fn place(&self, shaft: usize, carrier: Carrier) -> f64 {
        match carrier {
            Carrier::UpstreamJoint => 0.0,
            Carrier::DownstreamJoint => self.layout.lengths[shaft],
            Carrier::Bearing(bearing) => self.positions[bearing],
        }
    }

    /// The direction of a shaft.
    pub(super) fn axis(&self, shaft: usize) -> Vector {
        vector(self.layout.directions, shaft)
    }

    /// The derivative by the input angle of a joint.
    fn input_angle(&self, sums: &Sums, j: usize) -> f64 {
        self.poses.get(j).map_or(0.0, |pose| sums.turn[j] * pose.tangent + sums.pins[j])
    }

    /// The adjoints of the maps to all shafts. The input angle of a joint is the argument of `A` of
    /// its driving shaft, plus what `q` adds, which is among the sums by `q`.
    fn adjoints(&self, sums: &Sums) -> Vec<Map> {
        let of_shaft = |shaft: usize| {
            let weight = sums.q[shaft] * self.shafts[shaft].double_turn();
            let [mut a, b] = self.chain.adjoint_of_q(shaft, weight);
            if shaft > 0 && shaft < self.joints {
                let angle = self.input_angle(sums, shaft);
                a += (Complex::new(0.0, -angle) / self.chain.map(shaft)[0]).conj();
            }
            [a, b]
        };
        (0..=self.joints).map(of_shaft).collect()
    }

    fn by_directions(&self, sums: &Sums, adjoints: &[Map]) -> Vec<Vector> {
        let mut directions = self.chain.by_directions(adjoints, self.layout);
        for (i, direction) in directions.iter_mut().enumerate() {
            *direction += sums.frames[i].cross(&self.axis(i));
        }
        for (j, pose) in self.poses.iter().enumerate() {
            let PoseConstants { cosine, sine, axis: u, inward, normal, .. } = *pose;
            // The drive angle counts from the plane of joint 0 and turns with it.
            let counted =
                if j == 0 && sine > 0.0 { -sums.pins[j] * cosine / sine } else { sums.turn[j] };
            // tan β dμ_u, in which a straight joint's division by sin β cancels.
            let plane = (sums.plane[j] - counted) / cosine;
            let outward = inward * cosine - u * sine;
            directions[j] -= normal * (plane * cosine) + inward * sums.bends[j];
            directions[j + 1] += normal * plane + outward * sums.bends[j];
        }
        directions
    }
}
