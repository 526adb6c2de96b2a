//! What the oracle says, for `tests/check_oracle.py` to judge.

use cardan::Geometry;

use crate::angle::sin_cos;
use crate::exact::{ExactChain, ExactJoint, Turn};
use crate::forces;
use crate::judge::Quantity;
use crate::leaning;
use crate::samples::{JointSample, Kind, Random};
use crate::wide::hex;

const XYZ: [&str; 3] = [" x", " y", " z"];

/// Prints what the oracle says: names, doubles in hexadecimal, results as two of them.
pub(crate) fn print(count: u64) {
    let mut random = Random::new(7);
    for number in 0..count {
        let kinds = &Kind::ALL[..6];
        let kind = kinds[number as usize % kinds.len()];
        let bend = kind.bend(&mut random, &[]);
        let angle = kind.angle(&mut random, bend, &[]);
        let at = Turn::by(&[angle]);
        let (joint, (s, c)) = (ExactJoint::bent(bend), sin_cos(&[bend]));
        let motion = joint.motion(&at);
        println!("bend {} angle {}", hex(bend), hex(angle));
        for (name, x) in
            [("sine", at.s), ("cosine", at.c), ("sine of the bend", s), ("cosine of the bend", c)]
        {
            println!("{name}: {}", x.hex());
        }
        let sample = JointSample { bend, angle, torque: 1.0 };
        for quantity in Quantity::all() {
            let (numbers, _) = joint.exact(quantity, &at, &motion, sample);
            for (x, axis) in numbers.iter().zip(if numbers.len() > 1 { XYZ } else { [""; 3] }) {
                println!("{}{axis}: {}", quantity.name(), x.hex());
            }
        }
        if number % 4 == 0 {
            let n = 2 + random.below(4);
            let mut angles =
                |most: f64| (0..n).map(|_| random.between(0.0, most)).collect::<Vec<_>>();
            let (bends, twists, phases) = (angles(1.3), angles(6.0), angles(6.0));
            let (twists, phases) = (&twists[1..], &phases[1..]);
            let (motion, _) = ExactChain::of(&bends, twists, phases).motion(&at);
            let list = |all: &[f64]| all.iter().map(|&x| hex(x)).collect::<Vec<_>>().join(" ");
            println!("chain {} / {} / {}", list(&bends), list(twists), list(phases));
            for (name, x) in [
                ("angle", motion.angle),
                ("angle_error", motion.error),
                ("speed_ratio", motion.ratio),
                ("acceleration_ratio", motion.acceleration),
                ("jerk_ratio", motion.jerk),
            ] {
                println!("{name}: {}", x.hex());
            }
            let line = Geometry::from_bends(&bends, twists, phases).expect("bends are in range");
            forces::print_oracle(&line, angle, &mut random);
        }
        // Their means over a turn take long with many digits.
        if number % 120 == 0 {
            let n = 1 + random.below(3);
            let mut angles =
                |most: f64| (0..n).map(|_| random.between(-most, most)).collect::<Vec<_>>();
            let (bends, twists, phases) = (angles(0.5), angles(3.0), angles(3.0));
            let bends: Vec<f64> = bends.iter().map(|bend| bend.abs()).collect();
            let deviations = [angles(0.1), angles(0.1), angles(0.1)].concat();
            let line = Geometry::from_bends(&bends, &twists[1..], &phases[1..]);
            leaning::print_oracle(&line.expect("bends are in range"), &deviations, angle);
        }
    }
}
