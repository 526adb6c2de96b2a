//! What the oracle says, for `tests/check_oracle.py` to judge.

use cardan::Geometry;

use crate::angle::sin_cos;
use crate::exact::{ExactChain, ExactJoint, Turn};
use crate::forces;
use crate::leaning;
use crate::samples::{Kind, Random};
use crate::wide::hex;

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
        for (name, x) in [
            ("sine", at.s),
            ("cosine", at.c),
            ("sine of the bend", s),
            ("cosine of the bend", c),
            ("angle", motion.angle),
            ("angle_error", motion.error),
            ("speed_ratio", motion.ratio),
            ("acceleration_ratio", motion.acceleration),
            ("jerk_ratio", motion.jerk),
            ("moment y", joint.moment(&at)[1]),
            ("moment z", joint.moment(&at)[2]),
            ("support x", joint.supports(&at)[1][0]),
            ("support y", joint.supports(&at)[1][1]),
            ("support z", joint.supports(&at)[1][2]),
            ("bending_driving", joint.bending(&at)[0]),
            ("bending_driven", joint.bending(&at)[1]),
            ("tilt_driving", joint.tilts(&at)[0]),
            ("tilt_driven", joint.tilts(&at)[1]),
            ("pin_moment", joint.pin_moment(&at)),
            ("swing_driving", joint.swings(&at)[0]),
            ("swing_driven", joint.swings(&at)[1]),
            ("driven_pin x", joint.pins(&at)[1][0]),
            ("driven_pin y", joint.pins(&at)[1][1]),
            ("driven_pin z", joint.pins(&at)[1][2]),
        ] {
            println!("{name}: {}", x.hex());
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
