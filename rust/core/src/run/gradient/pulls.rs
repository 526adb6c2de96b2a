//! Contributions of weighted outputs of a chunk to the value, and how their changes are passed back
//! from forces to moments, from moments to torsions, and from power and rates to `q`.

use crate::number::atan::Atan;
use crate::plan::forces::ForceOf;
use crate::plan::output::Needs;
use crate::plan::{End, Output};
use crate::run::gradient::columns::{
    Vectors, ZEROS, across, add, add_cross, dot, each, sum_by_axis, sum_of_crosses, sum_of_dots,
};
use crate::run::gradient::line::{PoseConstants, ShaftConstants, Sums};
use crate::run::gradient::load::{LoadBuffers, LoadChunk, LoadColumns, sign};
use crate::run::gradient::motion::turned;
use crate::run::gradient::sample;

impl LoadChunk<'_> {
    /// Adds what a weighted output contributes.
    pub(super) fn pull(
        &self,
        output: Output,
        item: usize,
        weights: &Vectors,
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        match output {
            Output::Torque => {
                let LoadBuffers { rates, power, by_rates, by_power, .. } = buffers;
                let (weights, power, ratio) = (&weights[0], &power[item], &rates[item][0]);
                let [value] = each(
                    self.level,
                    [&mut by_power[item], &mut by_rates[item][0]],
                    #[inline(always)]
                    |i, [by_power, by_ratio]| {
                        let inverse = ratio[i].recip();
                        let (torque, pulled) = (power[i] * inverse, weights[i] * inverse);
                        ([by_power + pulled, by_ratio - torque * pulled], [weights[i] * torque])
                    },
                );
                sums.value += value;
            }
            Output::Moment => add(self.level, 1.0, weights, &mut buffers.by_moments[item]),
            Output::SupportMoment => self.pull_support(item, weights, buffers, sums),
            Output::JointForce | Output::BearingForce => {
                let of = (output.row().per, item);
                let targets = self.forces.map_or(&[][..], |step| &step.targets);
                if let Some(force) = targets.iter().find(|x| x.of == of).and_then(|x| x.force) {
                    let pulled = &mut buffers.by_forces[force.balance][force.carrier];
                    add(self.level, sign(force), weights, pulled);
                }
            }
            Output::TiltDriving | Output::TiltDriven => {
                self.pull_tilt(output, item, weights, buffers, sums);
            }
            _ if matches!(output.row().needs, Needs::Cross(_)) => {
                self.pull_swing(output, item, weights, buffers, sums);
            }
            _ => self.pull_magnitude(output, item, weights, buffers, sums),
        }
    }

    /// Tilts, with their derivatives by the bend and by the input angle over `tan β`.
    fn pull_tilt(
        &self,
        output: Output,
        item: usize,
        weights: &Vectors,
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        let PoseConstants { cosine: e, sine: sigma, .. } = self.line.poses[item];
        let ([sine, cosine], weights) = (&buffers.pins[item], &weights[0]);
        let turns = [&mut buffers.by_turn[item]];
        let [value, bend] = if output == Output::TiltDriving {
            each(
                self.level,
                turns,
                #[inline(always)]
                |i, [turn]| {
                    let (s, c) = (sine[i], cosine[i]);
                    let scale = weights[i] / (sigma * s).mul_add(sigma * s, e * e);
                    let value = weights[i] * f64::atan_any(sigma * s, e);
                    ([scale.mul_add(c * (e * e), turn)], [value, scale * s])
                },
            )
        } else {
            each(
                self.level,
                turns,
                #[inline(always)]
                |i, [turn]| {
                    let (s, c) = (sine[i], cosine[i]);
                    let root = (e * c).mul_add(e * c, s * s).sqrt();
                    let (scale, value) = (weights[i] * e / root, f64::atan_any(sigma * c, root));
                    ([turn - scale * s], [weights[i] * value, scale * c])
                },
            )
        };
        sums.value += value;
        sums.bends[item] += bend;
    }

    /// Rates of the cross: a function of pins and bend times the speed ratio.
    fn pull_swing(
        &self,
        output: Output,
        item: usize,
        weights: &Vectors,
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        let PoseConstants { cosine: e, sine: sigma, .. } = self.line.poses[item];
        let LoadBuffers { pins, rates, by_rates, by_turn, .. } = buffers;
        let ([sine, cosine], weights, ratio) = (&pins[item], &weights[0], &rates[item][0]);
        let pulled = [&mut by_rates[item][0], &mut by_turn[item]];
        macro_rules! by {
            ($formula:expr) => {
                each(
                    self.level,
                    pulled,
                    #[inline(always)]
                    |i, [by_ratio, turn]| {
                        let [value, by_bend, by_turn] = $formula(sine[i], cosine[i]);
                        let scale = weights[i] * ratio[i];
                        let changes =
                            [weights[i].mul_add(value, by_ratio), scale.mul_add(by_turn, turn)];
                        (changes, [scale * value, scale * by_bend])
                    },
                )
            };
        }
        let [value, bend] = match output {
            Output::SwingDriving => by!(|s, c| sample::swing_driving([e, sigma], s, c)),
            Output::SwingDriven => by!(|s, c| sample::swing_driven([e, sigma], s, c)),
            _ => by!(|s, c| sample::by_formula(output, [sigma, e], [s, c])),
        };
        sums.value += value;
        sums.bends[item] += bend;
    }

    /// The magnitudes of moments: a function of pins and bend times that of the torsion.
    fn pull_magnitude(
        &self,
        output: Output,
        item: usize,
        weights: &Vectors,
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        let PoseConstants { cosine: e, sine: sigma, tangent, .. } = self.line.poses[item];
        let LoadBuffers { pins, torsion, rates, by_rates, by_power, by_turn, .. } = buffers;
        let ([sine, cosine], weights) = (&pins[item], &weights[0]);
        let (torsion, ratio) = (&torsion[item], &rates[item][0]);
        let pulled = [&mut by_power[item + 1], &mut by_rates[item][0], &mut by_turn[item]];
        let [value, bend] = if output == Output::BendingDriving {
            each(
                self.level,
                pulled,
                #[inline(always)]
                |i, old| {
                    let (s, c) = (sine[i], cosine[i]);
                    let of = [tangent * s.abs(), s.abs() / (e * e), c * sample::sign(s)];
                    loaded([weights[i], torsion[i], ratio[i]], old, of)
                },
            )
        } else if output == Output::BendingDriven {
            each(
                self.level,
                pulled,
                #[inline(always)]
                |i, old| {
                    let (s, c) = (sine[i], cosine[i]);
                    let stretch = (tangent * s).mul_add(tangent * s, 1.0).sqrt();
                    let bent = sigma * s * s * tangent / (e * e * stretch);
                    let twice = c.abs() * tangent * tangent * s * c / stretch;
                    let by_turn = e * (twice - s * sample::sign(c) * stretch);
                    let by_bend = c.abs() * e.mul_add(stretch, bent);
                    let of = [sigma * c.abs() * stretch, by_bend, by_turn];
                    loaded([weights[i], torsion[i], ratio[i]], old, of)
                },
            )
        } else if output == Output::PinMoment {
            each(
                self.level,
                pulled,
                #[inline(always)]
                |i, old| {
                    let of = sample::pin_moment([e, tangent], sine[i], cosine[i]);
                    loaded([weights[i], torsion[i], ratio[i]], old, of)
                },
            )
        } else {
            each(
                self.level,
                pulled,
                #[inline(always)]
                |i, old| {
                    let of = sample::by_formula(output, [sigma, e], [sine[i], cosine[i]]);
                    loaded([weights[i], torsion[i], ratio[i]], old, of)
                },
            )
        };
        sums.value += value;
        sums.bends[item] += bend;
    }

    /// The support moment `Δ − u (u·Δ)` of a shaft, from the difference `Δ` of moments.
    fn pull_support(
        &self,
        item: usize,
        weights: &Vectors,
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        let u = self.line.axis(item);
        self.pull_difference(item, &across(self.level, weights, &u), buffers);
        let difference = self.difference(item, &buffers.moments);
        sums.frames[item] += u.cross(&sum_by_axis(self.level, &u, &difference, weights));
    }

    /// Adds a change with the difference of moments of a shaft.
    fn pull_difference(&self, shaft: usize, weight: &Vectors, buffers: &mut LoadBuffers) {
        if let Some(behind) = buffers.by_moments.get_mut(shaft) {
            add(self.level, 1.0, weight, behind);
        }
        if let Some(before) = shaft.checked_sub(1) {
            add(self.level, -1.0, weight, &mut buffers.by_moments[before]);
        }
    }

    /// Passes a change of one balance's forces on ([`super::forces`]).
    pub(super) fn pull_balance(&self, index: usize, buffers: &mut LoadBuffers, sums: &mut Sums) {
        let Some(balance) = self.forces.map(|step| &step.balances[index]) else { return };
        let (level, shaft) = (self.level, balance.shaft);
        let (u, [first, second]) = self.placed(balance);
        let inverse = (second - first).recip();
        let [of_first, of_second] = buffers.by_forces[index];
        let mut delta = of_second;
        add(level, -1.0, &of_first, &mut delta);
        for (&carrier, force) in balance.carriers.iter().zip(&buffers.forces[index]) {
            sums.pull_place(shaft, carrier, -inverse * sum_of_dots(level, &delta, force));
        }
        // h (δ × Δ)·du, in which the part of Δ along u does not count.
        let difference = self.difference(shaft, &buffers.moments);
        let mut by_axis = sum_of_crosses(level, &delta, &difference) * inverse;
        for load in &balance.loads {
            let ForceOf { balance: other, carrier, .. } = load.force;
            let (place, sign) = (self.line.place(shaft, load.at), sign(load.force));
            let force = &buffers.forces[other][carrier];
            let change = sum_of_dots(level, &delta, &across(level, force, &u));
            sums.pull_place(shaft, load.at, -inverse * sign * change);
            let mut weight = [ZEROS; 3];
            add(level, -inverse * (place - first), &of_second, &mut weight);
            add(level, -inverse * (second - place), &of_first, &mut weight);
            by_axis += sum_by_axis(level, &u, &weight, force) * sign;
            let pulled = &mut buffers.by_forces[other][carrier];
            add(level, sign, &across(level, &weight, &u), pulled);
        }
        sums.frames[shaft] += u.cross(&by_axis);
        let mut weight = [ZEROS; 3];
        add_cross(level, &(u * inverse), &delta, &mut weight);
        self.pull_difference(shaft, &weight, buffers);
    }

    /// Passes a change of a joint's moment on. The weight has parts `a`, `b` and `n` along the axes
    /// `u`, `e_in` and `m` of the joint, which are right-handed.
    pub(super) fn pull_moment(&self, joint: usize, buffers: &mut LoadBuffers, sums: &mut Sums) {
        let PoseConstants { cosine, tangent, axis, inward, normal, .. } = self.line.poses[joint];
        let LoadBuffers { pins, rates, torsion, by_moments, by_rates, by_power, by_turn, .. } =
            buffers;
        let ([sines, cosines], [x, y, z]) = (&pins[joint], &by_moments[joint]);
        let (torsion, ratio) = (&torsion[joint], &rates[joint][0]);
        let [value, bend, plane, along, inside, across] = each(
            self.level,
            [&mut by_power[joint + 1], &mut by_rates[joint][0], &mut by_turn[joint]],
            #[inline(always)]
            |i, [by_power, by_ratio, turn]| {
                let (s, c, torsion) = (sines[i], cosines[i], torsion[i]);
                let weight = [x[i], y[i], z[i]];
                let (a, b, n) = (dot(weight, &axis), dot(weight, &inward), dot(weight, &normal));
                let bent = s * s.mul_add(b, -(c * n));
                let unit = tangent.mul_add(bent, a);
                let pulled = unit / ratio[i];
                let turned = (2.0 * s * c).mul_add(b, -((c - s) * (c + s) * n));
                let changes =
                    [by_power + pulled, by_ratio - pulled * torsion, torsion.mul_add(turned, turn)];
                // The moment over the torsion, and its cross product with the weight.
                let (in_plane, out_of_plane) = (tangent * (s * s), -(tangent * (s * c)));
                let terms = [
                    unit,
                    bent,
                    s * s.mul_add(n, c * b),
                    in_plane.mul_add(n, -(out_of_plane * b)),
                    out_of_plane.mul_add(a, -n),
                    (-in_plane).mul_add(a, b),
                ];
                (changes, terms.map(|term| torsion * term))
            },
        );
        sums.value += value;
        sums.bends[joint] += bend / (cosine * cosine);
        sums.plane[joint] += plane;
        sums.frames[joint] += axis * along + inward * inside + normal * across;
    }

    /// Passes changes of power on to torque, inertias, speed and acceleration ratios.
    pub(super) fn pull_power(
        &self,
        load: &LoadColumns,
        buffers: &mut LoadBuffers,
        sums: &mut Sums,
    ) {
        let (level, n) = (self.level, self.line.shafts.len());
        let LoadBuffers { rates, by_rates, by_power, .. } = buffers;
        for step in 0..n {
            let (shaft, from, to, sign) = match load.end {
                End::Drive => (n - 1 - step, n - step, n - 1 - step, -1.0),
                End::Output => (step, step, step + 1, 1.0),
            };
            let ([ratio, rate], inertia) = (&rates[shaft], &load.inertias[shaft]);
            let (speed, own) = (&load.speed, &load.acceleration);
            let Ok([pulled, out]) = by_power.get_disjoint_mut([from, to]) else { continue };
            let [by_ratio, by_rate] = &mut by_rates[shaft];
            let [change] = each(
                level,
                [out, by_ratio, by_rate],
                #[inline(always)]
                |i, [by_power, by_ratio, by_rate]| {
                    let (square, ratio) = (speed[i] * speed[i], ratio[i]);
                    let turning = square.mul_add(rate[i], own[i] * ratio);
                    let signed = sign * pulled[i];
                    let weight = signed * inertia[i];
                    let changes = [
                        by_power + pulled[i],
                        weight.mul_add(own[i].mul_add(ratio, turning), by_ratio),
                        (weight * square).mul_add(ratio, by_rate),
                    ];
                    (changes, [signed * turning * ratio])
                },
            );
            sums.inertias[shaft] += change;
        }
        let [torque] = match load.end {
            End::Drive => {
                let first = &by_power[0];
                each(
                    level,
                    [],
                    #[inline(always)]
                    |i, []| ([], [first[i]]),
                )
            }
            End::Output => {
                let (last, ratio, torque) = (&by_power[n], &rates[n - 1][0], &load.torque);
                each(
                    level,
                    [&mut by_rates[n - 1][0]],
                    #[inline(always)]
                    |i, [by_ratio]| ([last[i].mul_add(torque[i], by_ratio)], [last[i] * ratio[i]]),
                )
            }
        };
        sums.torque += torque;
    }

    /// Passes changes of a shaft's speed and acceleration ratio, and of the input angle of the joint
    /// behind it, on to its `q`.
    pub(super) fn pull_rates(&self, shaft: usize, buffers: &LoadBuffers, sums: &mut Sums) {
        let LoadBuffers { drive: [sine, cosine], by_rates, by_turn, .. } = buffers;
        let ShaftConstants { cosine: e, sine2, mean, turn, .. } = self.line.shafts[shaft];
        let ([by_ratio, by_rate], turns) = (&by_rates[shaft], &by_turn[shaft]);
        let tangent = self.line.poses.get(shaft).map_or(0.0, |pose| pose.tangent);
        let [re, im, total] = each(
            self.level,
            [],
            #[inline(always)]
            |i, []| {
                let (s, c) = turned(sine[i], cosine[i], turn);
                let (s2, product, ec) = (s * s, s * c, e * c);
                let inverse = ec.mul_add(ec, s2).recip();
                let length = c.mul_add(c, s2) * inverse;
                let (x, y) = (e * length, -(sine2 * product) * inverse);
                let w = (mean * mean) * (length * inverse);
                let (w_re, w_im) = (w * ec.mul_add(ec, -s2), w * (-2.0 * e * product));
                let re = (-4.0 * y).mul_add(by_rate[i], -2.0 * by_ratio[i]);
                let im = (4.0 * x) * by_rate[i];
                let scale = mean * inverse * (tangent * turns[i]);
                let real = re.mul_add(w_re, -(im * w_im));
                let imaginary = re.mul_add(w_im, im * w_re);
                let terms = [
                    scale.mul_add(-((1.0 + e) * product), real),
                    scale.mul_add(-ec.mul_add(c, -s2), imaginary),
                    turns[i],
                ];
                ([], terms)
            },
        );
        sums.q[shaft].re += re;
        sums.q[shaft].im += im;
        if let Some(sum) = sums.turn.get_mut(shaft) {
            *sum += total;
        }
    }
}

/// Adds to changes of power, speed ratio and turn, and returns the terms of the value and of its
/// derivative by the bend, given the value for a torsion of 1 and its derivatives by the bend and by
/// the input angle over `tan β`.
#[inline(always)]
fn loaded(
    [weight, torsion, ratio]: [f64; 3],
    [by_power, by_ratio, turn]: [f64; 3],
    [value, by_bend, by_turn]: [f64; 3],
) -> ([f64; 3], [f64; 2]) {
    let scale = weight * torsion.abs();
    let pulled = weight * sample::sign(torsion) * value / ratio;
    let changes = [by_power + pulled, by_ratio - pulled * torsion, scale.mul_add(by_turn, turn)];
    (changes, [scale * value, scale * by_bend])
}
