//! The torque of a compliant shaft or coupling over its twist.

use crate::error::{Error, Result};

/// Connection of the ends of a compliant shaft that is no spring of constant stiffness.
#[derive(Clone, Debug, Default)]
pub struct Coupling {
    /// The number of the shaft.
    pub shaft: usize,
    /// Stiffness in N m/rad.
    pub stiffness: Option<f64>,
    /// Points of the torque in N m over the twist in rad, which is linear between them and goes
    /// straight on beyond them. If the first one is `[0, 0]`, the other direction is the same.
    pub twist_torque: Vec<[f64; 2]>,
    /// The free angle from one flank to the other in rad, in which there is no torque.
    pub play: f64,
    /// Whether the damping of the shaft acts in proportion to the stiffness, so not in the play.
    pub contact_damping: bool,
    /// The tangent of the loss angle: order `n` of the torque is `c (1 + iη)` times that of the
    /// twist.
    pub loss_factor: f64,
    /// Points of the stiffness in N m/rad over the mean torque in N m, linear between them and
    /// constant beyond.
    pub stiffness_by_mean: Vec<[f64; 2]>,
}

/// A piecewise linear law. Behind its kinks it goes straight on.
#[derive(Clone, Debug)]
pub(super) struct Law {
    /// Twist in rad and torque in N m of the kinks, rising.
    pub(super) kinks: Vec<[f64; 2]>,
    /// Stiffnesses in N m/rad: before the first kink, between the kinks, behind the last one.
    slopes: Vec<f64>,
    contact_damping: bool,
    pub(super) loss_factor: f64,
    stiffness_by_mean: Vec<[f64; 2]>,
}

/// Linear part in a range of twists: `stiffness · twist + preload`, and the damping times a
/// factor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Branch {
    pub(super) stiffness: f64,
    pub(super) preload: f64,
    pub(super) damping: f64,
}

impl Law {
    pub(super) fn linear(stiffness: f64) -> Self {
        Self {
            kinks: vec![],
            slopes: vec![stiffness],
            contact_damping: false,
            loss_factor: 0.0,
            stiffness_by_mean: vec![],
        }
    }

    /// The law of a coupling.
    pub(super) fn of(coupling: &Coupling) -> Result<Self> {
        let refused = |problem: String| Err(Error::new("couplings", &[coupling.shaft], problem));
        let mut law = Self {
            contact_damping: coupling.contact_damping,
            loss_factor: coupling.loss_factor,
            stiffness_by_mean: coupling.stiffness_by_mean.clone(),
            ..Self::linear(coupling.stiffness.unwrap_or(1.0))
        };
        let rises = |points: &[[f64; 2]], column: usize| {
            points.windows(2).all(|pair| pair[0][column] < pair[1][column])
        };
        let Coupling { twist_torque: table, play, loss_factor, stiffness_by_mean: by_mean, .. } =
            coupling;
        if !(*play >= 0.0 && play.is_finite() && *loss_factor >= 0.0 && loss_factor.is_finite()) {
            return refused(format!(
                "has the play {play:?} and the loss factor {loss_factor:?}; neither may be negative"
            ));
        }
        let stiffness = coupling.stiffness.unwrap_or(1.0);
        let mut laws = usize::from(coupling.stiffness.is_some());
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            return refused(format!("has the stiffness {stiffness:?}; it must be positive"));
        }
        if !table.is_empty() {
            laws += 1;
            let mut points = table.clone();
            if points[0] == [0.0, 0.0] {
                let mirrored = table[1..].iter().rev().map(|point| point.map(|x| -x));
                points.splice(..0, mirrored);
            }
            let finite = points.iter().flatten().all(|x| x.is_finite());
            if !(points.len() > 1 && finite && rises(&points, 0) && rises(&points, 1)) {
                return refused(format!(
                    "has the points {table:?} of twist and torque; there must be two at least, and \
                     both must rise from point to point"
                ));
            }
            let steps = points.windows(2);
            law.slopes = steps.map(|p| (p[1][1] - p[0][1]) / (p[1][0] - p[0][0])).collect();
            law.kinks = points[1..points.len() - 1].to_vec();
            // Between equal stiffnesses there is no kink; table values are rounded.
            for i in (0..law.kinks.len()).rev() {
                if (law.slopes[i] - law.slopes[i + 1]).abs() <= 1e-12 * law.slopes[i] {
                    law.kinks.remove(i);
                    law.slopes.remove(i + 1);
                }
            }
        }
        if !by_mean.is_empty() {
            laws += 1;
            let sound = by_mean.iter().all(|[torque, c]| torque.is_finite() && *c > 0.0);
            if !(sound && rises(by_mean, 0)) {
                return refused(format!(
                    "has the stiffnesses {by_mean:?} over the mean torque; torques must rise, and \
                     stiffnesses must be positive"
                ));
            }
        }
        if laws != 1 {
            return refused(format!(
                "has {laws} laws; it needs one of a stiffness, a table of twist and torque, and a \
                 stiffness by the mean torque"
            ));
        }
        if *play > 0.0 {
            if !table.is_empty() || !by_mean.is_empty() {
                return refused("has play and a table; play needs one stiffness".to_owned());
            }
            law.kinks = vec![[-0.5 * play, 0.0], [0.5 * play, 0.0]];
            law.slopes = vec![stiffness, 0.0, stiffness];
        }
        if *loss_factor > 0.0 && !law.is_linear() {
            return refused(
                "has a loss factor and a stiffness that varies with the twist; a loss factor is \
                 that of a constant stiffness or of one by the mean torque"
                    .to_owned(),
            );
        }
        Ok(law)
    }

    /// Whether the stiffness does not vary with the twist.
    pub(super) fn is_linear(&self) -> bool {
        self.kinks.is_empty()
    }

    /// Which range of twists one belongs to.
    pub(super) fn range(&self, twist: f64) -> usize {
        self.kinks.partition_point(|kink| kink[0] < twist)
    }

    /// The law in a range of twists.
    pub(super) fn in_range(&self, range: usize) -> Branch {
        let stiffness = self.slopes[range];
        let kink = self.kinks.get(range.saturating_sub(1));
        let preload = kink.map_or(0.0, |[twist, torque]| torque - stiffness * twist);
        let damping = if self.contact_damping { stiffness / self.largest() } else { 1.0 };
        Branch { stiffness, preload, damping }
    }

    /// The law at a twist in rad.
    pub(super) fn branch(&self, twist: f64) -> Branch {
        self.in_range(self.range(twist))
    }

    /// The range of twists at a static torque in N m.
    pub(super) fn range_at(&self, torque: f64) -> usize {
        let below = self.kinks.partition_point(|kink| kink[1] < torque);
        // Without a torque a coupling with play is in the middle of it.
        let level = self.kinks.iter().filter(|kink| kink[1] == torque).count();
        below + level / 2
    }

    /// The twist in rad under a static torque in N m.
    pub(super) fn twist(&self, torque: f64) -> f64 {
        let Branch { stiffness, preload, .. } = self.in_range(self.range_at(torque));
        if stiffness > 0.0 { (torque - preload) / stiffness } else { 0.0 }
    }

    /// The law with the stiffness that belongs to a mean torque in N m, if that is another one.
    pub(super) fn at_mean(&self, torque: f64) -> Option<Self> {
        let points = &self.stiffness_by_mean;
        let last = points.last()?;
        let torque = if points[0][0] < 0.0 { torque } else { torque.abs() };
        let above = points.partition_point(|point| point[0] < torque);
        let stiffness = match above {
            0 => points[0][1],
            _ if above == points.len() => last[1],
            _ => {
                let ([t0, c0], [t1, c1]) = (points[above - 1], points[above]);
                c0 + (c1 - c0) * (torque - t0) / (t1 - t0)
            }
        };
        let differs = (stiffness - self.slopes[0]).abs() > 1e-12 * stiffness;
        differs.then(|| Self { slopes: vec![stiffness], ..self.clone() })
    }

    /// The stiffness at a static torque in N m, or the largest one where it has none there.
    pub(super) fn stiffness_at(&self, torque: f64) -> f64 {
        let here = self.slopes[self.range_at(torque)];
        if here > 0.0 { here } else { self.largest() }
    }

    /// The largest stiffness.
    fn largest(&self) -> f64 {
        self.slopes.iter().copied().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn torque(law: &Law, twist: f64) -> f64 {
        let Branch { stiffness, preload, .. } = law.branch(twist);
        stiffness * twist + preload
    }

    fn close(x: f64, y: f64) -> bool {
        (x - y).abs() < 1e-12 * y.abs().max(1.0)
    }

    #[test]
    fn play_has_no_torque_within_it() {
        let coupling = Coupling {
            stiffness: Some(8000.0),
            play: 0.02,
            contact_damping: true,
            ..Coupling::default()
        };
        let law = Law::of(&coupling).unwrap();
        for (twist, expected) in [(-0.02, -80.0), (-0.01, 0.0), (0.004, 0.0), (0.03, 160.0)] {
            assert!(close(torque(&law, twist), expected), "{twist}");
        }
        assert_eq!([-0.02, 0.0, 0.02].map(|twist| law.branch(twist).damping), [1.0, 0.0, 1.0]);
        assert!(close(law.twist(40.0), 0.015) && close(law.twist(-40.0), -0.015));
        assert!(law.twist(0.0) == 0.0 && law.stiffness_at(0.0) == 8000.0);
    }

    #[test]
    fn a_table_from_zero_is_odd_and_goes_straight_on() {
        let table = vec![[0.0, 0.0], [0.02, 100.0], [0.03, 250.0]];
        let coupling = Coupling { twist_torque: table, ..Coupling::default() };
        let law = Law::of(&Coupling { contact_damping: true, ..coupling }).unwrap();
        for (twist, expected) in [(0.01, 50.0), (0.02, 100.0), (0.025, 175.0), (0.05, 550.0)] {
            assert!(close(torque(&law, twist), expected), "{twist}");
            assert!(close(torque(&law, -twist), -expected), "{twist}");
            assert!(close(law.twist(expected), twist) && close(law.twist(-expected), -twist));
        }
        // In proportion to the stiffness, and no kink at zero.
        assert!(close(law.branch(0.0).damping, 1.0 / 3.0) && law.branch(0.05).damping == 1.0);
        assert!(law.kinks.len() == 2 && law.range(-0.03) == 0 && law.range(0.03) == 2);
    }

    #[test]
    fn a_table_of_both_directions_is_as_given() {
        let table = vec![[-0.02, -60.0], [-0.01, -10.0], [0.01, 50.0], [0.02, 150.0]];
        let law = Law::of(&Coupling { twist_torque: table, ..Coupling::default() }).unwrap();
        for (twist, expected) in [(-0.03, -110.0), (-0.015, -35.0), (0.0, 20.0), (0.03, 250.0)] {
            assert!(close(torque(&law, twist), expected), "{twist}");
        }
        // Torque and its branches agree at the kinks.
        for (i, [twist, torque]) in law.kinks.iter().enumerate() {
            for range in [i, i + 1] {
                let Branch { stiffness, preload, .. } = law.in_range(range);
                assert!(close(stiffness * twist + preload, *torque));
            }
        }
    }

    #[test]
    fn a_stiffness_by_the_mean_torque_is_linear_between_its_points() {
        let points = vec![[0.0, 1000.0], [100.0, 3000.0]];
        let law = Law::of(&Coupling { stiffness_by_mean: points, ..Coupling::default() }).unwrap();
        for (mean, expected) in [(0.0, 1000.0), (50.0, 2000.0), (-50.0, 2000.0), (200.0, 3000.0)] {
            let own = law.at_mean(mean).unwrap();
            assert!(close(own.stiffness_at(0.0), expected), "{mean}");
            assert!(own.at_mean(mean).is_none());
        }
    }
}
