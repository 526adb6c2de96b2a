//! Drivelines, their equivalent joints and their phases.

use cardan::{
    Error, Execution, FIGURES, Geometry, Result, States, Vector, check_length, check_shaft,
    common_phases_of_batch, equivalents_of_batch, frames_of_batch, lengths,
    optimal_phases_of_batch,
};

use crate::arguments::{Arguments, check};

const CHAINS: [&str; 3] = ["bends", "twists", "phases"];

pub(crate) fn from_points(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (joints, flat) = (arguments.count("joints")?, arguments.of("points"));
    let (each, phases) = (3 * joints.saturating_add(2), arguments.of("phases"));
    let count = flat.len() / each;
    check_length("points", flat.len(), count, each)?;
    check_length("phases", phases.len(), count, joints.saturating_sub(1))?;
    let unit = arguments.maybe("unit")?.unwrap_or(1.0);
    if !(unit > 0.0 && unit.is_finite()) {
        return Err(Error::new("unit", &[], format!("is {unit} m; it must be positive")));
    }
    let mut found = vec![vec![]; 5];
    for (line, points) in flat.chunks(each).enumerate() {
        let points: Vec<Vector> = points.chunks(3).map(Vector::from_column_slice).collect();
        let phases = &phases[line * joints.saturating_sub(1)..][..joints.saturating_sub(1)];
        let made = Geometry::from_points(&points, phases).map_err(|error| error.within(&[line]))?;
        found[0].extend(made.bends);
        found[1].extend(made.twists);
        found[2].extend(made.directions.iter().flatten());
        found[3].extend(made.normals.iter().flatten());
        found[4].extend(lengths(&points).map(|length| length * unit));
    }
    Ok(found)
}

pub(crate) fn from_bends(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (joints, chains) = arguments.chains(CHAINS)?;
    let mut frames = [vec![], vec![]];
    let shape = [chains[0].len() / joints];
    frames_of_batch(joints, &shape, chains, &mut frames, Execution::default())?;
    Ok(frames.into())
}

pub(crate) fn equivalent(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let ((joints, chains), shaft) = (arguments.chains(CHAINS)?, arguments.count("shaft")?);
    check_shaft(joints, shaft)?;
    let mut columns = [const { vec![] }; FIGURES];
    equivalents_of_batch(joints, shaft, chains, &mut columns, Execution::default());
    Ok(columns.into())
}

pub(crate) fn optimal_phases(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (joints, [bends, twists, phases]) = arguments.chains(CHAINS)?;
    let mut best = phases.to_vec();
    optimal_phases_of_batch(joints, bends, twists, &mut best, Execution::default());
    Ok(vec![best])
}

pub(crate) fn common_phases(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (joints, [bends, twists, phases]) = arguments.chains(CHAINS)?;
    let (weights, held) = (arguments.of("weights"), arguments.counts("held")?);
    check("weights", weights, "it must be finite and not negative", |x| {
        (0.0..f64::MAX).contains(&x)
    })?;
    let sum: f64 = weights.iter().sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return Err(Error::new("weights", &[], format!("add up to {sum}; one must be positive")));
    }
    let states = bends.len() / joints;
    if weights.is_empty() || states % weights.len() != 0 {
        let problem = format!("has {} values; there are {states} states", weights.len());
        return Err(Error::new("weights", &[], problem));
    }
    check_length("held", held.len(), 1, joints - 1)?;
    let held: Vec<bool> = held.into_iter().map(|held| held > 0).collect();
    let teeth: Vec<u64> =
        arguments.counts("teeth")?.into_iter().map(|teeth| teeth as u64).collect();
    if !teeth.is_empty() {
        check_length("teeth", teeth.len(), 1, joints - 1)?;
        check("teeth", arguments.of("teeth"), "a spline has at least 1 tooth", |x| x > 0.0)?;
    }
    let weights: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
    let weights = &weights;
    let states = States { joints, bends, twists, phases, weights, held: &held, teeth: &teeth };
    Ok(vec![common_phases_of_batch(&states, Execution::default())])
}
