//! Constructors of drivelines, equivalent joints, best phases and sweeps, from any numbers.
#![no_main]

mod input;

use arbitrary::{Result, Unstructured};
use cardan::optimal_phases;
use cardan::{Equivalent, Geometry, Joint, Sweep, Vector};
use input::{JOINTS, about, bend, number, several};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    // Bytes that run out end the case.
    let _ = case(&mut Unstructured::new(data));
});

fn case(u: &mut Unstructured<'_>) -> Result<()> {
    let n = u.int_in_range(0..=JOINTS)?;
    let between = about(u, n.saturating_sub(1))?;
    let vector = |u: &mut Unstructured<'_>| Ok(Vector::new(number(u)?, number(u)?, number(u)?));
    let line = match u.arbitrary::<u8>()? % 4 {
        0 => {
            let bends = several(u, n, bend)?;
            let twists = about(u, between)?;
            let twists = several(u, twists, number)?;
            Geometry::from_bends(&bends, &twists, &several(u, between, number)?)
        }
        1 => {
            let shafts = about(u, n + 1)?;
            let directions = several(u, shafts, vector)?;
            Geometry::from_directions(&directions, &several(u, between, number)?)
        }
        2 => {
            let count = about(u, n + 2)?;
            let points = several(u, count, vector)?;
            Geometry::from_points(&points, &several(u, between, number)?)
        }
        _ => return sweep(u),
    };
    let Ok(line) = line else { return Ok(()) };
    check(&line);
    for shaft in 0..=line.bends.len() {
        let between = shaft.saturating_sub(1);
        let equivalent = Equivalent::of_chain(
            &line.bends[..shaft],
            &line.twists[..between],
            &line.phases[..between],
        );
        let k = equivalent.joint.k;
        // Closer to 90° error terms do not hold what compensating joints cancel.
        let cosines: f64 =
            line.bends[..shaft].iter().map(|&bend| Joint::<f64>::new(bend).cos).product();
        assert!(
            cosines < 1e-12 || (0.0..=1.0).contains(&k),
            "{equivalent:?} of {shaft} in {line:?}"
        );
        assert!(cosines < 1e-12 || equivalent.angle_offset().is_finite(), "{equivalent:?}");
    }
    let best = optimal_phases(&line.bends, &line.twists, &line.phases);
    let finite = best.iter().all(|phase| phase.is_finite());
    assert!(best.len() == line.phases.len() && finite, "{best:?} for {line:?}");
    Ok(())
}

/// What every driveline keeps, whatever it was made from.
fn check(line: &Geometry) {
    let n = line.bends.len();
    assert!(n > 0 && line.twists.len() == n - 1 && line.phases.len() == n - 1);
    assert!(line.directions.len() == n + 1 && line.normals.len() == n);
    assert!(line.bends.iter().all(|bend| (0.0..std::f64::consts::FRAC_PI_2).contains(bend)));
    assert!(line.twists.iter().all(|twist| twist.is_finite()));
    for (j, normal) in line.normals.iter().enumerate() {
        assert!((normal.norm() - 1.0).abs() < 1e-15, "{line:?}");
        for shaft in &line.directions[j..j + 2] {
            assert!((shaft.norm() - 1.0).abs() < 1e-15, "{line:?}");
            assert!(normal.dot(shaft).abs() < 1e-14, "{line:?}");
        }
    }
}

fn sweep(u: &mut Unstructured<'_>) -> Result<()> {
    let (start, stop, count) = (number(u)?, number(u)?, u.arbitrary::<u64>()? as usize);
    let sweeps =
        [Sweep::new(start, stop, count), Sweep::of_turns(count, u.arbitrary::<u64>()? as usize)];
    for sweep in sweeps.into_iter().flatten() {
        for i in [0, 1, sweep.count() / 2, sweep.count() - 1] {
            assert!(sweep.at(i).is_finite(), "{sweep:?}");
        }
    }
    Ok(())
}
