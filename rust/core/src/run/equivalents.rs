//! The joints equivalent to the chains of a batch of drivelines, many together.
#![allow(clippy::needless_range_loop, reason = "as in the kernels")]

use crate::mechanics::chain::Equivalent;
use crate::mechanics::joint::Joint;
use crate::mechanics::phasing::is_set;
use crate::number::double_double::DoubleDouble;
use crate::number::elementary::finite_atan2;
use crate::run::execution::Execution;
use crate::run::lanes::{LANES, Lane, Maps, PassJoint, Reset, Turns};
use crate::run::level::{Level, compiled_up_to_avx2};

/// The figures of an equivalent joint: bend, offset of the drive angle, `tan²(β/2)`, non-uniformity,
/// largest angle error, smallest and largest speed ratio, largest acceleration ratio.
pub const FIGURES: usize = 8;

/// Appends the [`FIGURES`] of the joint equivalent to the first `shaft` joints of each driveline to
/// the columns, from bends `(…, joints)`, twists and phases `(…, joints − 1)` in rad.
///
/// ```
/// let mut columns = [const { vec![] }; cardan::FIGURES];
/// let given = [&[0.3, 0.2][..], &[], &[]];
/// cardan::equivalents_of_batch(1, 1, given, &mut columns, cardan::Execution::default());
/// assert_eq!(columns[0], [0.3, 0.2]);
/// ```
pub fn equivalents_of_batch(
    joints: usize,
    shaft: usize,
    given: [&[f64]; 3],
    columns: &mut [Vec<f64>; FIGURES],
    execution: Execution<'_>,
) {
    let level = execution.level.unwrap_or_else(Level::new);
    let lines = given[0].len().checked_div(joints).unwrap_or(0);
    let mut group = LineGroup::new();
    for first in (0..lines).step_by(LANES) {
        if is_set(execution.stop) {
            return;
        }
        let length = LANES.min(lines - first);
        compiled_up_to_avx2!(level, group.find([joints, shaft], given, first, length));
        for (column, found) in columns.iter_mut().zip(&group.found) {
            column.extend_from_slice(&found[..length]);
        }
    }
}

/// Drivelines that are folded together.
struct LineGroup {
    maps: Maps,
    turns: Turns,
    /// The constants of the equivalent joints: cosine, sine, their squares, versine, `k`.
    constants: [[f64; LANES]; 6],
    offsets: [[f64; LANES]; 2],
    found: [[f64; LANES]; FIGURES],
}

impl LineGroup {
    fn new() -> Self {
        Self {
            maps: Maps::new(LANES),
            turns: Turns::new(LANES),
            constants: [[0.0; LANES]; 6],
            offsets: [[0.0; LANES]; 2],
            found: [[0.0; LANES]; FIGURES],
        }
    }

    #[inline(always)]
    fn find(
        &mut self,
        [joints, shaft]: [usize; 2],
        [bends, twists, phases]: [&[f64]; 3],
        first: usize,
        length: usize,
    ) {
        let Self { maps, turns, .. } = self;
        let gather = |array: &[f64], each: usize, j: usize| {
            let mut own = [0.0; LANES];
            for (own, value) in
                own.iter_mut().zip(array.iter().skip(first * each + j).step_by(each))
            {
                *own = *value;
            }
            own
        };
        let (mut bent, mut sums) = ([0; LANES], [0.0; LANES]);
        maps.update(length, &Reset);
        for j in 0..shaft {
            if j > 0 {
                let [phases, twists] =
                    [phases, twists].map(|angles| gather(angles, joints - 1, j - 1));
                turns.find(&phases[..length], &twists[..length], false);
                maps.update(length, &turns.read::<false>(length));
            }
            let own = gather(bends, joints, j);
            for i in 0..LANES {
                bent[i] += i32::from(own[i] != 0.0);
                sums[i] += own[i];
            }
            maps.update(length, &PassJoint::<false>(&own[..length]));
        }
        self.set_constants(length);
        for i in (0..length).filter(|&i| bent[i] == 1) {
            // The joint's own constants hold where tan²(β/2) is too small for a double.
            self.set_joint(i, &Joint::with_error_terms(sums[i]));
        }
        self.set_figures(length);
    }

    #[inline(always)]
    fn set_constants(&mut self, length: usize) {
        let maps = self.maps.read(length);
        let [cos, sin, cos2, sin2, versine, k] = &mut self.constants;
        let [turn_cos, turn_sin] = &mut self.offsets;
        for i in 0..length.min(LANES) {
            let Equivalent { joint, turn_cos: c, turn_sin: s }: Equivalent<DoubleDouble> =
                maps.at(i);
            (cos[i], sin[i]) = (joint.cos.value(), joint.sin.value());
            (cos2[i], sin2[i]) = (joint.cos2.value(), joint.sin2.value());
            (versine[i], k[i]) = (joint.versine.value(), joint.k.value());
            (turn_cos[i], turn_sin[i]) = (c.value(), s.value());
        }
    }

    #[inline(always)]
    fn set_joint(&mut self, i: usize, joint: &Joint<DoubleDouble>) {
        let Joint { cos, sin, cos2, sin2, versine, k, .. } = *joint;
        for (row, constant) in self.constants.iter_mut().zip([cos, sin, cos2, sin2, versine, k]) {
            row[i] = constant.value();
        }
    }

    #[inline(always)]
    fn set_figures(&mut self, length: usize) {
        let [cos, sin, cos2, sin2, versine, k] = &self.constants;
        let [turn_cos, turn_sin] = &self.offsets;
        let [bend, offset, own_k, non_uniformity, angle, least, most, acceleration] =
            &mut self.found;
        for i in 0..length.min(LANES) {
            let joint = Joint {
                cos: cos[i],
                cos2: cos2[i],
                sin: sin[i],
                sin2: sin2[i],
                versine: versine[i],
                inverse_exsecant: 0.0,
                k: k[i],
            };
            bend[i] = finite_atan2(joint.sin, joint.cos);
            offset[i] = finite_atan2(turn_sin[i], turn_cos[i]);
            own_k[i] = joint.k;
            non_uniformity[i] = joint.non_uniformity();
            angle[i] = finite_atan2(joint.max_error_tangent(), 1.0);
            (least[i], most[i]) = (joint.cos, joint.max_speed_ratio());
            acceleration[i] = joint.max_acceleration_ratio();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_batch_gives_what_single_chains_give() {
        for (joints, shaft) in [(1, 0), (1, 1), (3, 2), (3, 3), (5, 5)] {
            let lines = 200;
            let values = |each: usize, scale: f64| -> Vec<f64> {
                let value = |i: usize| scale * (1.3 * i as f64).sin();
                (0..lines * each).map(value).collect()
            };
            let mut bends = values(joints, 1.5);
            for bend in &mut bends {
                *bend = if *bend < 0.0 { 0.0 } else { *bend };
            }
            let (twists, mut phases) = (values(joints - 1, 4.0), values(joints - 1, -7.0));
            if joints > 1 {
                phases[7] = 1e300;
            }
            for (_, level) in crate::level::available() {
                let execution = Execution { level: Some(level), ..Execution::default() };
                let mut columns = [const { vec![] }; FIGURES];
                let given = [&bends[..], &twists, &phases];
                equivalents_of_batch(joints, shaft, given, &mut columns, execution);
                for line in 0..lines {
                    let own = |array: &'_ [f64], each: usize, used: usize| {
                        array[line * each..line * each + used].to_vec()
                    };
                    let between = shaft.saturating_sub(1);
                    let one = Equivalent::of_chain(
                        &own(&bends, joints, shaft),
                        &own(&twists, joints - 1, between),
                        &own(&phases, joints - 1, between),
                    );
                    let joint = one.joint;
                    let expected = [
                        joint.bend(),
                        one.angle_offset(),
                        joint.k,
                        joint.non_uniformity(),
                        joint.max_angle_error(),
                        joint.cos,
                        joint.max_speed_ratio(),
                        joint.max_acceleration_ratio(),
                    ];
                    let found = columns.each_ref().map(|column| column[line]);
                    assert_eq!(
                        found.map(f64::to_bits),
                        expected.map(f64::to_bits),
                        "{joints} {line}"
                    );
                }
            }
        }
    }
}
