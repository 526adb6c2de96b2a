//! The equations of a system at one frequency, from one end of the driveline to the other.
//!
//! Each shaft that moves has nodes: a rigid one has one, one that bends has nodes at its ends and at
//! its bearings, and between them as many as keep pieces of it shorter than a wave. A node has
//! displacement and slope of the vibration that turns with the shaft, then of that against it. In
//! these directions the matrices of round shafts are diagonal, also with gyroscopic terms. Between
//! the nodes of two shafts stands the force of their joint. Nodes are coupled with neighbours only,
//! so the matrix is a band.

use nalgebra::{Complex, Vector2};

use crate::dynamics::lateral::band::Band;
use crate::dynamics::lateral::bearing::ElasticBearing;
use crate::dynamics::lateral::rate::Rate;
use crate::dynamics::lateral::span::{Section, Stiffness, Transfer};
use crate::dynamics::lateral::system::{BendingShaft, LateralShaft, LateralSystem, pair_across};
use crate::mechanics::geometry::Vector;

type C = Complex<f64>;

/// The directions of rotation: with the shaft and against it.
const TURNS: [f64; 2] = [1.0, -1.0];

/// Unknowns of a node: displacement and slope in either direction of rotation.
const NODE: usize = 4;

/// The longest piece in radians of its wave. A piece whose ends do not move resonates only from `π`
/// on.
const LONGEST: f64 = 2.5;

/// The most pieces of a shaft.
const MOST_PIECES: f64 = 1e4;

/// A bearing closer to another node than this share of the shaft's length moves with it as if the
/// shaft between were rigid, in responses and where shapes are sought: shorter spans are so stiff that
/// rounding hides all else, of eigenvalues sooner than of solutions.
const CLOSE: [f64; 2] = [2e-6, 2e-4];

/// Where shapes are sought, a mass gets no node if it is closer to another one than this share of the
/// shaft's length: so close to a fixed end it hardly changes the resonances of a piece.
const BESIDE: f64 = 0.02;

/// A place that belongs to a node: the node, and its distance from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    stop: usize,
    arm: f64,
}

/// A mass or an unbalance.
#[derive(Clone, Copy, Debug)]
enum Item {
    Mass(usize),
    Unbalance(usize),
}

/// The nodes that a system has at every frequency.
#[derive(Debug)]
pub(super) struct Nodes<'a> {
    pub(super) system: &'a LateralSystem,
    /// Shaft and position of every such node, along the driveline.
    stops: Vec<(usize, f64)>,
    /// The first one of each shaft, and the number of all.
    first: Vec<usize>,
    /// Items at nodes.
    fixed: Vec<(Item, Place)>,
    /// Items between nodes, by shaft and position.
    between: Vec<(usize, f64, Item)>,
    /// The axes of each bearing, and its place.
    pub(super) bearings: Vec<([Vector; 2], Place)>,
    /// Up to which share of a shaft's length a bearing belongs to another node.
    close: f64,
}

impl<'a> Nodes<'a> {
    /// The nodes of a system. Where shapes are sought, point masses of shafts that bend have nodes as
    /// well, so that no piece with fixed ends resonates below its own frequencies.
    pub(super) fn new(system: &'a LateralSystem, of_shapes: bool) -> Self {
        let attached = &system.attached;
        let mut own = Self {
            system,
            stops: vec![],
            first: vec![],
            fixed: vec![],
            between: vec![],
            bearings: vec![],
            close: CLOSE[usize::from(of_shapes)],
        };
        for (shaft, kind) in system.shafts.iter().enumerate() {
            own.first.push(own.stops.len());
            let bearings = attached.bearings.iter().filter(|own| own.shaft == shaft);
            match kind {
                LateralShaft::Held => {}
                LateralShaft::Rigid(rigid) => {
                    // A stiff bearing away from the node would hide what else holds the slope.
                    let stiffer = |x: &&ElasticBearing, y: &&ElasticBearing| {
                        x.stiffness[0]
                            .max(x.stiffness[1])
                            .total_cmp(&y.stiffness[0].max(y.stiffness[1]))
                    };
                    let stiffest = bearings.max_by(stiffer).map(|own| own.position);
                    own.stops.push((shaft, stiffest.unwrap_or(rigid.centre)));
                }
                LateralShaft::Bending(_) => {
                    let length = system.lengths[shaft];
                    let mut positions = vec![0.0, length];
                    let masses =
                        attached.masses.iter().filter(|own| of_shapes && own.shaft == shaft);
                    let others = bearings
                        .map(|bearing| (bearing.position, own.close))
                        .chain(masses.map(|mass| (mass.position, BESIDE)));
                    for (position, share) in others {
                        let is_near = |node: &f64| (position - node).abs() <= share * length;
                        if !positions.iter().any(is_near) {
                            positions.push(position);
                        }
                    }
                    positions.sort_by(f64::total_cmp);
                    own.stops.extend(positions.into_iter().map(|position| (shaft, position)));
                }
            }
        }
        own.first.push(own.stops.len());
        let masses = attached.masses.iter().enumerate();
        let unbalances = attached.unbalances.iter().enumerate();
        let items = masses
            .map(|(i, mass)| (mass.shaft, mass.position, Item::Mass(i)))
            .chain(unbalances.map(|(i, own)| (own.shaft, own.position, Item::Unbalance(i))));
        for (shaft, position, item) in items {
            if let Some(place) = own.at_node(shaft, position) {
                own.fixed.push((item, place));
                continue;
            }
            let is_before = |other: &(usize, f64, Item)| (other.0, other.1) <= (shaft, position);
            let place = own.between.partition_point(is_before);
            own.between.insert(place, (shaft, position, item));
        }
        own.bearings = attached
            .bearings
            .iter()
            .map(|bearing| {
                let u = system.directions[bearing.shaft];
                let axes = match bearing.axis {
                    Some(axis) => pair_across(u, axis),
                    None => system.pairs[bearing.shaft],
                };
                (axes, own.near_node(bearing.shaft, bearing.position).expect("a node"))
            })
            .collect();
        own
    }

    /// The place of a position that belongs to a node at every frequency.
    pub(super) fn at_node(&self, shaft: usize, position: f64) -> Option<Place> {
        self.node_within(shaft, position, 0.0)
    }

    /// The place of a bearing, if it belongs to such a node.
    fn near_node(&self, shaft: usize, position: f64) -> Option<Place> {
        self.node_within(shaft, position, self.close * self.system.lengths[shaft])
    }

    fn node_within(&self, shaft: usize, position: f64, distance: f64) -> Option<Place> {
        let range = self.first[shaft]..self.first[shaft + 1];
        match self.system.shafts[shaft] {
            LateralShaft::Held => None,
            LateralShaft::Rigid(_) => {
                Some(Place { stop: range.start, arm: position - self.stops[range.start].1 })
            }
            LateralShaft::Bending(_) => range
                .into_iter()
                .map(|stop| Place { stop, arm: position - self.stops[stop].1 })
                .find(|place| place.arm.abs() <= distance),
        }
    }

    /// The place of the end of a joint's driving or driven shaft, unless that is held.
    pub(super) fn end(&self, shaft: usize, joint: usize) -> Option<Place> {
        self.at_node(shaft, if shaft == joint { self.system.lengths[shaft] } else { 0.0 })
    }
}

/// A piece of a shaft that bends, between two nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    shaft: usize,
    /// The first unknown of its upstream node; the downstream one follows.
    start: usize,
    /// Its ends.
    from: f64,
    to: f64,
    stiffness: [Stiffness; 2],
}

/// The equations of a system at one frequency, and their solution.
#[derive(Debug, Default)]
pub(super) struct BandEquations {
    band: Band,
    /// The unknowns once they are solved; before that what forces within pieces do to nodes.
    pub(super) unknowns: Vec<C>,
    /// The forces and couples on nodes.
    given: Vec<C>,
    /// The first unknown of each node that the layout has.
    base: Vec<usize>,
    /// The first unknown of each joint's force.
    pub(super) joints: Vec<usize>,
    pub(super) pieces: Vec<Piece>,
    /// Joint forces are unknowns in this unit.
    pub(super) unit: f64,
}

impl BandEquations {
    /// Makes the equations of a frequency, with pieces as short as a rate in rad/s needs.
    pub(super) fn assemble(&mut self, layout: &Nodes<'_>, at: Rate, finest: f64) {
        let system = layout.system;
        self.place_nodes(layout, at.speed, finest);
        let size = self.unknowns.len();
        self.band.clear(size);
        let mut pieces = std::mem::take(&mut self.pieces);
        for piece in &mut pieces {
            self.add_piece(layout, at, piece);
        }
        self.pieces = pieces;
        for (shaft, kind) in system.shafts.iter().enumerate() {
            if let LateralShaft::Rigid(own) = kind {
                let place = layout.at_node(shaft, own.centre).expect("a rigid shaft has a node");
                self.add_mass(at, place, [own.mass, own.across, own.along]);
            }
        }
        for &(item, place) in &layout.fixed {
            match item {
                Item::Mass(i) => {
                    let own = &system.attached.masses[i];
                    self.add_mass(at, place, [own.mass, own.across, own.along]);
                }
                Item::Unbalance(i) => {
                    let force = unbalance(system, i, at);
                    let base = self.base[place.stop];
                    self.given[base] += force;
                    self.given[base + 1] += force * place.arm;
                }
            }
        }
        for ((axes, place), own) in layout.bearings.iter().zip(&system.attached.bearings) {
            let turning = system.turning(own.shaft);
            for (axis, stiffness) in axes.iter().zip(own.dynamic_stiffness(at)) {
                let along = turning.map(|e| dot(axis, e));
                for (i, row) in along.iter().enumerate() {
                    for (j, column) in along.iter().enumerate() {
                        self.add_at(*place, [i, j], row.conj() * column * stiffness);
                    }
                }
            }
        }
        let largest = (0..size).map(|i| self.band.get(i, i).norm_sqr()).fold(0.0, f64::max).sqrt();
        // Joints may hold rigid shafts on their own.
        self.unit = if largest > 0.0 { largest } else { 1.0 };
        for joint in 0..system.joints() {
            self.add_joint(layout, joint);
        }
    }

    /// Numbers the unknowns.
    fn place_nodes(&mut self, layout: &Nodes<'_>, speed: f64, finest: f64) {
        self.base.clear();
        self.joints.clear();
        self.pieces.clear();
        let system = layout.system;
        let mut next = 0;
        for (shaft, kind) in system.shafts.iter().enumerate() {
            let stops = &layout.stops[layout.first[shaft]..layout.first[shaft + 1]];
            let waves = wavenumber(kind, finest, speed);
            for (i, &(_, position)) in stops.iter().enumerate() {
                if i > 0 {
                    let from = stops[i - 1].1;
                    let length = position - from;
                    let count = (waves * length / LONGEST).ceil().max(1.0);
                    let mut start = from;
                    for piece in 1..=count as usize {
                        let last = piece as f64 == count;
                        let end =
                            if last { position } else { from + length * (piece as f64 / count) };
                        let stiffness = [Stiffness::NONE; 2];
                        self.pieces.push(Piece {
                            shaft,
                            start: next - NODE,
                            from: start,
                            to: end,
                            stiffness,
                        });
                        start = end;
                        if !last {
                            next += NODE;
                        }
                    }
                }
                self.base.push(next);
                next += NODE;
            }
            if shaft < system.joints() {
                self.joints.push(next);
                next += 2;
            }
        }
        for vector in [&mut self.unknowns, &mut self.given] {
            vector.clear();
            vector.resize(next, C::ZERO);
        }
    }

    fn add_piece(&mut self, layout: &Nodes<'_>, at: Rate, piece: &mut Piece) {
        let [with, against] = TURNS;
        let of = |turn| layout.transfer(piece, piece.to, at, turn).stiffness();
        let first = of(with);
        piece.stiffness =
            [first, if layout.differs(piece.shaft, at) { of(against) } else { first }];
        for (i, own) in piece.stiffness.iter().enumerate() {
            for (end, row) in own.blocks.iter().enumerate() {
                let first = piece.start + NODE * end + 2 * i;
                for (other, block) in row.iter().enumerate() {
                    let column = piece.start + NODE * other + 2 * i;
                    for (r, c) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                        self.band.add(first + r, column + c, block[(r, c)]);
                    }
                }
                self.unknowns[first] += own.load[end][0];
                self.unknowns[first + 1] += own.load[end][1];
            }
        }
    }

    fn add_mass(&mut self, at: Rate, place: Place, [mass, across, along]: [f64; 3]) {
        let base = self.base[place.stop];
        for (i, turn) in TURNS.into_iter().enumerate() {
            self.add_at(place, [i, i], C::from(-mass * at.omega * at.omega));
            let slope = base + 2 * i + 1;
            self.band.add(slope, slope, C::from(-at.rotary(across, along, turn)));
        }
    }

    /// Adds a stiffness between the displacements of a place in two directions of rotation.
    fn add_at(&mut self, place: Place, [i, j]: [usize; 2], stiffness: C) {
        let base = self.base[place.stop];
        let factors = [1.0, place.arm];
        for (r, own) in factors.into_iter().enumerate() {
            for (c, other) in factors.into_iter().enumerate() {
                self.band.add(base + 2 * i + r, base + 2 * j + c, stiffness * (own * other));
            }
        }
    }

    /// Adds the force of a joint, and that it keeps both ends together across the sliding shaft.
    fn add_joint(&mut self, layout: &Nodes<'_>, joint: usize) {
        let system = layout.system;
        let own = system.turning(system.sliding[joint]);
        for (shaft, sign) in [(joint, 1.0), (joint + 1, -1.0)] {
            let Some(place) = layout.end(shaft, joint) else { continue };
            let turning = system.turning(shaft);
            for (i, e) in turning.into_iter().enumerate() {
                for (j, f) in own.into_iter().enumerate() {
                    let tied = product(e, f) * (sign * self.unit);
                    let column = self.joints[joint] + j;
                    for (r, factor) in [1.0, place.arm].into_iter().enumerate() {
                        let row = self.base[place.stop] + 2 * i + r;
                        self.band.add(row, column, tied * factor);
                        self.band.add(column, row, tied.conj() * factor);
                    }
                }
            }
        }
    }

    /// Adds a couple on the slope of a place.
    pub(super) fn add_couple(
        &mut self,
        layout: &Nodes<'_>,
        shaft: usize,
        place: Place,
        couple: [C; 3],
    ) {
        let base = self.base[place.stop];
        for (i, e) in layout.system.turning(shaft).into_iter().enumerate() {
            self.given[base + 2 * i + 1] += product(e, couple);
        }
    }

    /// Adds a force along a real direction at a place.
    pub(super) fn add_force(
        &mut self,
        layout: &Nodes<'_>,
        shaft: usize,
        place: Place,
        force: Vector,
    ) {
        let base = self.base[place.stop];
        for (i, e) in layout.system.turning(shaft).into_iter().enumerate() {
            let along = dot(&force, e).conj();
            self.given[base + 2 * i] += along;
            self.given[base + 2 * i + 1] += along * place.arm;
        }
    }

    /// Factors the matrix, after which there is a solution for any forces.
    pub(super) fn factor(&mut self) {
        self.band.factor();
    }

    /// Finds the unknowns of all forces.
    pub(super) fn solve(&mut self) {
        for (x, given) in self.unknowns.iter_mut().zip(&self.given) {
            *x += given;
        }
        self.band.solve(&mut self.unknowns);
    }

    /// Takes all forces on nodes away.
    pub(super) fn without_forces(&mut self) {
        self.unknowns.fill(C::ZERO);
        self.given.fill(C::ZERO);
    }

    /// The unknowns of either direction of rotation that belong together.
    pub(super) fn pairs(&self) -> Vec<[usize; 2]> {
        let mut found: Vec<_> = self.joints.iter().map(|&joint| [joint, joint + 1]).collect();
        let within = self.pieces.iter().map(|piece| piece.start);
        let within = within.filter(|start| !self.base.contains(start));
        for node in self.base.iter().copied().chain(within) {
            found.extend([[node, node + 2], [node + 1, node + 3]]);
        }
        found
    }

    pub(super) fn entry(&self, row: usize, column: usize) -> C {
        self.band.get(row, column)
    }

    pub(super) fn size(&self) -> usize {
        self.unknowns.len()
    }

    /// The displacement of a place as a vector, from the unknowns.
    pub(super) fn displacement(&self, layout: &Nodes<'_>, shaft: usize, place: Place) -> [C; 3] {
        let base = self.base[place.stop];
        let turning = layout.system.turning(shaft);
        let moved = [0, 1]
            .map(|i| self.unknowns[base + 2 * i] + self.unknowns[base + 2 * i + 1] * place.arm);
        [0, 1, 2].map(|i| turning[0][i] * moved[0] + turning[1][i] * moved[1])
    }

    /// The displacement of any position of a shaft.
    pub(super) fn displacement_at(
        &self,
        layout: &Nodes<'_>,
        at: Rate,
        shaft: usize,
        position: f64,
    ) -> [C; 3] {
        let position = layout.system.snapped(shaft, position);
        if let Some(place) = layout.at_node(shaft, position) {
            return self.displacement(layout, shaft, place);
        }
        let holds = |piece: &&Piece| piece.shaft == shaft && piece.to >= position;
        let Some(piece) = self.pieces.iter().find(holds) else { return [C::ZERO; 3] };
        let mut moved = [C::ZERO; 2];
        for (i, turn) in TURNS.into_iter().enumerate() {
            let (ends, [force, _]) = self.ends(piece, i);
            let transfer = layout.transfer(piece, position, at, turn);
            moved[i] = transfer.at_end(ends[0], -force)[0];
        }
        let turning = layout.system.turning(shaft);
        [0, 1, 2].map(|i| turning[0][i] * moved[0] + turning[1][i] * moved[1])
    }

    /// Displacements and slopes of both ends of a piece in a direction of rotation, and the forces
    /// on them.
    fn ends(&self, piece: &Piece, turn: usize) -> ([Vector2<C>; 2], [Vector2<C>; 2]) {
        let ends = [0, NODE].map(|node| {
            let first = piece.start + node + 2 * turn;
            Vector2::new(self.unknowns[first], self.unknowns[first + 1])
        });
        let Stiffness { blocks, load } = &piece.stiffness[turn];
        let forces = [0, 1].map(|i| blocks[i][0] * ends[0] + blocks[i][1] * ends[1] - load[i]);
        (ends, forces)
    }

    /// Twice the mean power in W that all forces give, over the rate.
    pub(super) fn given_power(&self, layout: &Nodes<'_>, at: Rate) -> f64 {
        let of = |force: C, moved: C| (force * moved.conj()).im;
        let at_nodes = self.given.iter().zip(&self.unknowns).map(|(&force, &x)| of(force, x));
        let mut sum: f64 = at_nodes.sum();
        for &(shaft, position, item) in &layout.between {
            if let Item::Unbalance(i) = item {
                let moved = self.displacement_at(layout, at, shaft, position);
                let [with, _] = layout.system.turning(shaft);
                sum += of(unbalance(layout.system, i, at), product(with, moved));
            }
        }
        sum
    }

    /// Twice the mean power in W that goes into shafts that bend, over the rate.
    pub(super) fn lost_in_pieces(&self) -> f64 {
        let mut sum = 0.0;
        for piece in &self.pieces {
            for turn in 0..2 {
                let (ends, forces) = self.ends(piece, turn);
                for (moved, force) in ends.iter().zip(forces) {
                    sum += moved.dotc(&force).im;
                }
            }
        }
        sum
    }
}

/// Compliances and inertias of a shaft that bends, at a rate.
fn section(own: &BendingShaft, at: Rate, turn: f64) -> Section {
    let loss = if at.lossy { own.loss_factor * at.sign() } else { 0.0 };
    let softened = Complex::new(1.0, loss).inv();
    Section {
        shear: softened / own.shear_stiffness,
        bending: softened / own.stiffness,
        mass: own.mass * at.omega * at.omega,
        rotary: at.rotary(own.rotary_inertia, 2.0 * own.rotary_inertia, turn),
    }
}

/// The largest wavenumber in 1/m of a shaft, 0 of one that does not bend.
fn wavenumber(kind: &LateralShaft, omega: f64, speed: f64) -> f64 {
    let LateralShaft::Bending(own) = kind else { return 0.0 };
    let at = Rate { omega, speed, damped: false, lossy: false };
    TURNS.map(|turn| section(own, at, turn).wavenumber()).into_iter().fold(0.0, f64::max)
}

impl LateralSystem {
    /// Whether the waves in all shafts are long enough for their pieces to be counted.
    pub(super) fn has_long_waves(&self, omega: f64, speed: f64) -> bool {
        let mut shafts = self.shafts.iter().zip(&self.lengths);
        shafts
            .all(|(kind, length)| wavenumber(kind, omega, speed) * length <= LONGEST * MOST_PIECES)
    }
}

impl Nodes<'_> {
    /// Whether the directions of rotation differ for the pieces of a shaft. Euler's theory does not
    /// distinguish them.
    fn differs(&self, shaft: usize, at: Rate) -> bool {
        let rotary = matches!(
            self.system.shafts[shaft],
            LateralShaft::Bending(own) if own.rotary_inertia > 0.0
        );
        (rotary && at.speed != 0.0) || self.between.iter().any(|item| item.0 == shaft)
    }

    /// From the start of a piece to a position in it.
    fn transfer(&self, piece: &Piece, to: f64, at: Rate, turn: f64) -> Transfer {
        let LateralShaft::Bending(own) = &self.system.shafts[piece.shaft] else {
            unreachable!("only shafts that bend have pieces")
        };
        let section = section(own, at, turn);
        let mut found = None::<Transfer>;
        let mut position = piece.from;
        let and = |found: Option<Transfer>, next| Some(found.map_or(next, |own| own.and(&next)));
        for &(shaft, place, item) in &self.between {
            if shaft == piece.shaft && place > piece.from && place <= to {
                found = and(found, section.transfer(place - position));
                position = place;
                let point = match item {
                    Item::Mass(i) => {
                        let own = &self.system.attached.masses[i];
                        let rotary = at.rotary(own.across, own.along, turn);
                        Transfer::point(own.mass * at.omega * at.omega, rotary, C::ZERO)
                    }
                    Item::Unbalance(i) => {
                        let force =
                            if turn > 0.0 { unbalance(self.system, i, at) } else { C::ZERO };
                        Transfer::point(0.0, 0.0, force)
                    }
                };
                found = and(found, point);
            }
        }
        let rest = section.transfer(to - position);
        found.map_or(rest, |before| before.and(&rest))
    }
}

/// The force of an unbalance in N, which turns with the shaft, at order 1.
pub(super) fn unbalance(system: &LateralSystem, item: usize, at: Rate) -> C {
    if at.omega != at.speed {
        return C::ZERO;
    }
    let own = &system.attached.unbalances[item];
    let [e, _] = pair_across(system.directions[own.shaft], own.direction);
    // `e − i u × e` is this multiple of the unit vector that turns with the shaft.
    let [with, _] = system.turning(own.shaft);
    dot(&e, with).conj() * (2.0 * own.mass_arm * at.speed * at.speed)
}

/// `axis · e`.
fn dot(axis: &Vector, e: [C; 3]) -> C {
    e[0] * axis[0] + e[1] * axis[1] + e[2] * axis[2]
}

/// `conj(e) · v`.
fn product(e: [C; 3], v: [C; 3]) -> C {
    e[0].conj() * v[0] + e[1].conj() * v[1] + e[2].conj() * v[2]
}
