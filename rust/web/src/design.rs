//! Closed forms of drivelines and shafts, and the wear of joints.

use cardan::design::tube::{Round, Tube};
use cardan::design::{excitations_of_batch, splines_of_batch, steering_of_batch};
use cardan::{
    Error, Excitations, Execution, Result, Spline, Steering, Wear, check_length,
    free_drives as drives, hours as hours_of, least_drive_inertias as least, pin_means as means,
};

use crate::arguments::{Arguments, check_results};

/// The columns of records, of which each has so many numbers.
fn columns(records: &[f64], size: usize) -> Vec<Vec<f64>> {
    (0..size).map(|i| records.iter().skip(i).step_by(size).copied().collect()).collect()
}

pub(crate) fn excitations(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let lines = arguments.lines()?;
    let mut records = vec![0.0; Excitations::COUNT * lines.count()];
    excitations_of_batch(lines.joints, &lines.arrays, &mut records, Execution::default());
    Ok(columns(&records, Excitations::COUNT))
}

pub(crate) fn steering(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (lines, centres) = (arguments.lines()?, arguments.finite("centres")?);
    check_length("centres", centres.len(), lines.count(), 1)?;
    let numbers: Vec<usize> = (0..lines.count()).collect();
    let mut records = vec![0.0; Steering::COUNT * lines.count()];
    let (centres, out) = ((centres, None), &mut records);
    steering_of_batch(lines.joints, &lines.arrays, &numbers, centres, out, Execution::default());
    Ok(columns(&records, Steering::COUNT))
}

pub(crate) fn spline_forces(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let lines = arguments.lines()?;
    let Some(bearings) = lines.batch.bearings.as_deref() else {
        return Err(Error::new("lengths", &[], "are missing; a spline needs them"));
    };
    let spline = Spline::new(lines.joints, arguments.count("spline")?, bearings)?;
    let numbers: Vec<usize> = (0..lines.count()).collect();
    let mut loads = [&[][..]; 3];
    for (load, name) in loads.iter_mut().zip(["torque", "friction", "radius"]) {
        *load = arguments.finite(name)?;
        check_length(name, load.len(), lines.count(), 1)?;
    }
    let size = spline.record();
    let mut records = vec![0.0; size * lines.count()];
    splines_of_batch(&spline, &lines.arrays, &numbers, loads, &mut records, Execution::default());
    let mut found = columns(&records, size);
    let of_bearings = found.split_off(Spline::COUNT);
    let flat = |columns: &[Vec<f64>]| -> Vec<f64> {
        (0..lines.count()).flat_map(|line| columns.iter().map(move |column| column[line])).collect()
    };
    let [axial, x, y, z, rest @ ..] = <[Vec<f64>; Spline::COUNT]>::try_from(found)
        .expect("a record begins with the numbers of a spline");
    let upstream = flat(&[x, y, z]);
    Ok([vec![axial, upstream], rest.into(), vec![flat(&of_bearings)]].concat())
}

pub(crate) fn tubes(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    const NAMES: [&str; 6] =
        ["outer_diameter", "wall", "length", "shear_modulus", "elastic_modulus", "density"];
    let (given, count) = (NAMES.map(|name| arguments.of(name)), arguments.of(NAMES[0]).len());
    for (name, values) in NAMES.into_iter().zip(given) {
        check_length(name, values.len(), count, 1)?;
        crate::arguments::check(name, values, "it must be positive", |x| x > 0.0)?;
    }
    let of = |i| {
        let [diameter, wall, length, shear_modulus, elastic_modulus, density] =
            given.map(|values| values[i]);
        Tube::new(Round { diameter, wall, length, shear_modulus, elastic_modulus, density })
    };
    let records: Vec<f64> = (0..count).flat_map(|i| of(i).fields()).collect();
    Ok(columns(&records, Tube::<f64>::COUNT))
}

pub(crate) fn pin_means(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let lines = arguments.lines()?;
    let Some(load) = arguments.usual_load(lines.count())? else {
        return Err(Error::new("torque", &[], "is missing; wear needs a load"));
    };
    let wear = arguments.member("wear", &[Wear::Friction, Wear::Fatigue])?;
    let total = check_results("joints", &[lines.count(), wear.count(lines.joints)])?;
    let (mut out, bends) = (vec![0.0; total], &lines.batch.largest_bends);
    means(&lines.rows(Some(&load)), bends, load.end, wear, &mut out, Execution::default())?;
    Ok(vec![out])
}

pub(crate) fn hours(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (means, bends) = (arguments.finite("means")?, arguments.finite("bends")?);
    let (rpm, ratings) = (arguments.finite("rpm")?, arguments.finite("ratings")?);
    check_length("means", means.len(), bends.len(), 5)?;
    check_length("rpm", rpm.len(), bends.len(), 1)?;
    check_length("ratings", ratings.len(), bends.len(), 1)?;
    let of = |(joint, &means)| hours_of(means, bends[joint], rpm[joint], ratings[joint]).into();
    let (hours, by_law) = means.as_chunks::<5>().0.iter().enumerate().map(of).unzip();
    Ok(vec![hours, by_law])
}

pub(crate) fn free_drives(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (lines, inertias) = (arguments.lines()?, arguments.finite("inertias")?);
    let rows = lines.rows(None);
    let found = drives(&rows, &lines.batch.largest_bends, inertias, Execution::default())?;
    let records: Vec<f64> =
        found.iter().flat_map(|drive| [drive.least, drive.largest, drive.variation]).collect();
    Ok(columns(&records, 3))
}

pub(crate) fn least_drive_inertias(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let lines = arguments.lines()?;
    let (inertias, variations) = (arguments.finite("inertias")?, arguments.finite("variations")?);
    let (rows, bends) = (lines.rows(None), &lines.batch.largest_bends);
    least(&rows, bends, inertias, variations, Execution::default()).map(|found| vec![found])
}
