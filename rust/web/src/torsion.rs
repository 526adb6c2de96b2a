//! Natural frequencies of torsional systems and critical speeds.

use cardan::dynamics::{Coupling, CriticalSpeeds, Drive, ShaftEnds, TorsionalSystem};
use cardan::judge::{Limit, Rank, Side};
use cardan::{Error, Result, check_length};

use crate::arguments::{Arguments, check};

/// The points of a table for each coupling, as many as `counts` has.
fn tables(
    arguments: &Arguments<'_>,
    counts: &'static str,
    points: &'static str,
    couplings: usize,
) -> Result<Vec<Vec<[f64; 2]>>> {
    let (each, mut left) = (arguments.counts(counts)?, arguments.of(points).as_chunks::<2>().0);
    check_length(counts, each.len(), couplings, 1)?;
    let mut table = |count: &usize| {
        let (own, others) = left.split_at_checked(*count)?;
        left = others;
        Some(own.to_vec())
    };
    let found = each.iter().map(&mut table).collect::<Option<_>>();
    found.ok_or_else(|| Error::new(points, &[], format!("has fewer points than {counts} says")))
}

fn couplings(arguments: &Arguments<'_>) -> Result<Vec<Coupling>> {
    let shafts = arguments.counts("couplings")?;
    let of = |name| {
        let values = arguments.of(name);
        check_length(name, values.len(), shafts.len(), 1)?;
        Ok(values)
    };
    let (stiffnesses, plays) = (of("coupling_stiffnesses")?, of("plays")?);
    let by_twist = tables(arguments, "twist_counts", "twist_torques", shafts.len())?;
    let by_mean = tables(arguments, "mean_counts", "stiffnesses_by_mean", shafts.len())?;
    let coupling = |(i, (twist_torque, stiffness_by_mean))| Coupling {
        shaft: shafts[i],
        stiffness: Some(stiffnesses[i]).filter(|stiffness: &f64| !stiffness.is_nan()),
        twist_torque,
        play: plays[i],
        stiffness_by_mean,
        ..Coupling::default()
    };
    Ok(by_twist.into_iter().zip(by_mean).enumerate().map(coupling).collect())
}

pub(crate) fn torsion(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (joints, [bends, twists, phases]) = arguments.chains(["bends", "twists", "phases"])?;
    check_length("bends", bends.len(), 1, joints)?;
    let (inertias, stiffnesses) = (arguments.of("inertias"), arguments.of("stiffnesses"));
    check("inertias", inertias, "it must not be negative", |x| (0.0..f64::INFINITY).contains(&x))?;
    let rule = "it must be positive, or NaN of a rigid shaft";
    check("stiffnesses", stiffnesses, rule, |x| x.is_nan() || x > 0.0)?;
    let rigid = |&stiffness: &f64| if stiffness.is_nan() { f64::INFINITY } else { stiffness };
    let of_shafts = ShaftEnds {
        inertias,
        stiffnesses: &stiffnesses.iter().map(rigid).collect::<Vec<_>>(),
        dampings: &vec![0.0; joints + 1],
    };
    let load = [arguments.maybe("load_torque")?.unwrap_or(0.0), 0.0];
    let drive = if arguments.flag("free")? { Drive::Free { slope: 0.0 } } else { Drive::Held };
    let modes = TorsionalSystem::new(bends, twists, phases, of_shafts, load)?
        .with_drive(drive)?
        .with_couplings(&couplings(arguments)?)?
        .modes();
    let frequencies: Vec<f64> = modes.iter().map(|mode| mode.frequency).collect();
    let (orders, excited) = (arguments.of("orders"), arguments.of("excited"));
    check("orders", orders, "it must be positive", |order| order > 0.0)?;
    check("range", arguments.of("range"), "it must be finite", f64::is_finite)?;
    check_length("excited", excited.len(), orders.len(), 1)?;
    let orders: Vec<_> = orders.iter().zip(excited).map(|(&n, &own)| (n, own != 0.0)).collect();
    let [low, high] = *arguments.of("range") else {
        return Err(Error::new("range", &[], "must be two speeds"));
    };
    let beside = |range| CriticalSpeeds::new(&frequencies, &orders, range);
    let at = arguments.maybe("speed")?;
    let (found, now) = (beside([low, high]), at.map(|speed| beside([speed; 2])));
    let place = |found: &CriticalSpeeds| found.nearest.map_or(-1.0, |place| place as f64);
    let limit = arguments.maybe("margin")?.unwrap_or(f64::NAN);
    let limit = Limit { limit, maximum: limit, side: Side::Least, size: 0.0 };
    let rank = found.nearest.map_or(Rank::NotJudged, |nearest| limit.rank(found.away[nearest]));
    Ok(vec![
        modes.iter().map(|mode| mode.shaft as f64).collect(),
        vec![place(&found)],
        vec![rank as usize as f64],
        vec![now.as_ref().map_or(-1.0, place)],
        now.map_or(vec![], |now| now.away),
        frequencies,
        found.speeds,
        found.away,
    ])
}
