//! Vectors, and drivelines in space.

use crate::angle::sin_cos;
use crate::wide::Wide;

pub(crate) type Span = [Wide; 3];

pub(crate) fn cross(a: Span, b: Span) -> Span {
    let part = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [part(1, 2), part(2, 0), part(0, 1)]
}

pub(crate) fn dot(a: Span, b: Span) -> Wide {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A vector turned about a unit vector perpendicular to it.
pub(crate) fn turned(v: Span, axis: Span, (s, c): (Wide, Wide)) -> Span {
    plus(scaled(v, c), scaled(cross(axis, v), s))
}

pub(crate) fn plus(a: Span, b: Span) -> Span {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn scaled(v: Span, factor: Wide) -> Span {
    v.map(|x| x * factor)
}

/// What a driveline transmits at an angle.
pub(crate) struct Transmitted {
    /// Of each shaft.
    pub(crate) torques: Vec<Wide>,
    /// Of each joint on its driven shaft.
    pub(crate) moments: Vec<Span>,
    /// The largest component of a moment if none of the torques of drive and inertias cancelled.
    pub(crate) largest: f64,
}

/// Shafts and bend planes in space.
#[derive(Clone, Debug)]
pub(crate) struct ExactAxes {
    pub(crate) directions: Vec<Span>,
    pub(crate) normals: Vec<Span>,
}

impl ExactAxes {
    /// With the first shaft along x and the first normal along z.
    pub(crate) fn of(bends: &[f64], twists: &[f64]) -> Self {
        let unit = |i: usize| [0, 1, 2].map(|j| Wide::from(f64::from(i == j)));
        let (mut directions, mut normals) = (vec![unit(0)], vec![unit(2)]);
        for (j, &bend) in bends.iter().enumerate() {
            if j > 0 {
                normals.push(turned(normals[j - 1], directions[j], sin_cos(&[twists[j - 1]])));
            }
            directions.push(turned(directions[j], normals[j], sin_cos(&[bend])));
        }
        Self { directions, normals }
    }

    /// What the bearings of a shaft must give, by the moments of the joints.
    pub(crate) fn support(&self, moments: &[Span], shaft: usize) -> Span {
        let moment = |joint: usize| *moments.get(joint).unwrap_or(&[Wide::ZERO; 3]);
        let before = moment(shaft.wrapping_sub(1)).map(|x| -x);
        self.across(plus(moment(shaft), before), shaft)
    }

    /// The bending moment that a joint's moment gives a shaft.
    pub(crate) fn bending(&self, moment: Span, shaft: usize) -> Wide {
        let across = self.across(moment, shaft);
        dot(across, across).sqrt()
    }

    /// What of a vector is across a shaft.
    fn across(&self, v: Span, shaft: usize) -> Span {
        let u = self.directions[shaft];
        plus(v, scaled(u, -dot(v, u)))
    }

    /// The components of every plane of torque, moment, support moment and both bending moments.
    pub(crate) fn loads(&self, transmitted: Transmitted) -> Vec<Vec<Wide>> {
        let (n, Transmitted { torques, moments, .. }) = (self.normals.len(), transmitted);
        torques
            .into_iter()
            .map(|torque| vec![torque])
            .chain(moments.iter().map(|m| m.to_vec()))
            .chain((0..=n).map(|shaft| self.support(&moments, shaft).to_vec()))
            .chain((0..n).map(|j| vec![self.bending(moments[j], j)]))
            .chain((0..n).map(|j| vec![self.bending(moments[j], j + 1)]))
            .collect()
    }
}

/// The solutions of linear equations with several right-hand sides, which end the rows.
pub(crate) fn solved(mut rows: Vec<Vec<Wide>>) -> Vec<Vec<Wide>> {
    let unknowns = rows.len();
    for pivot in 0..unknowns {
        let largest = (pivot..unknowns)
            .max_by(|&a, &b| rows[a][pivot].abs().high.total_cmp(&rows[b][pivot].abs().high))
            .expect("a row is left");
        rows.swap(pivot, largest);
        let inverse = Wide::ONE / rows[pivot][pivot];
        for x in &mut rows[pivot][pivot..] {
            *x = *x * inverse;
        }
        let own = rows[pivot].clone();
        for (i, row) in rows.iter_mut().enumerate() {
            let factor = row[pivot];
            if i == pivot || factor.high == 0.0 {
                continue;
            }
            for (x, &y) in row[pivot..].iter_mut().zip(&own[pivot..]) {
                *x = *x - factor * y;
            }
        }
    }
    let side = |side: usize| rows.iter().map(|row| row[side]).collect();
    (unknowns..rows[0].len()).map(side).collect()
}
