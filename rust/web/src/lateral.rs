//! Natural frequencies of lateral systems, and their response.

use cardan::dynamics::lateral::{Complex, Described, LateralRuns, Numbers, largest_lengths};
use cardan::{Execution, Result, Vector, check_length};

use crate::arguments::{Arguments, check};

pub(crate) fn lateral(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let joints = arguments.count("joints")?;
    let directions = arguments.finite("directions")?;
    check_length("directions", directions.len(), joints + 1, 3)?;
    let vectors = |flat: &[f64]| flat.chunks_exact(3).map(Vector::from_column_slice).collect();
    let directions: Vec<Vector> = vectors(directions);
    let names = [
        ("kinds", "of_shafts"),
        ("elastic_shafts", "of_elastic"),
        ("mass_shafts", "of_masses"),
        ("unbalance_shafts", "of_unbalances"),
    ];
    let mut whole = vec![];
    for (name, _) in names {
        whole.push(arguments.counts(name)?);
    }
    let numbers = |i: usize| Numbers { whole: &whole[i], fields: arguments.of(names[i].1) };
    let [shafts, bearings, masses, unbalances] = [0, 1, 2, 3].map(numbers);
    let sliding = arguments.counts("sliding")?;
    let system = Described { shafts, bearings, masses, unbalances }.system(
        &directions,
        arguments.finite("lengths")?,
        Some(&sliding),
    )?;
    let (speed, orders) = (arguments.finite("speeds")?, arguments.of("orders"));
    check("orders", orders, "it must not be negative", |x| (0.0..f64::INFINITY).contains(&x))?;
    let (real, imaginary) = (arguments.finite("moments_re")?, arguments.finite("moments_im")?);
    for (name, array) in [("moments_re", real), ("moments_im", imaginary)] {
        check_length(name, array.len(), speed.len() * orders.len(), 3 * joints)?;
    }
    let moments: Vec<_> =
        real.iter().zip(imaginary).map(|(&re, &im)| Complex::new(re, im)).collect();
    let (shafts, positions) = (arguments.counts("probe_shafts")?, arguments.of("probe_positions"));
    check_length("probe_positions", positions.len(), shafts.len(), 1)?;
    let probes: Vec<_> = shafts.into_iter().zip(positions.iter().copied()).collect();
    let runs = LateralRuns {
        systems: &[system],
        system: &vec![0; speed.len()],
        speed,
        orders,
        moments: &moments,
        probes: &probes,
    };
    let each = speed.len() * orders.len();
    let mut found = vec![Complex::default(); 3 * each * runs.vectors()];
    let mut powers = vec![0.0; each * runs.powers()];
    runs.responses(&mut found, &mut powers, Execution::default())?;
    let count = arguments.count("count")?;
    let frequencies =
        runs.systems[0].modes(count, &[])?.iter().map(|mode| mode.frequency).collect();
    // Of every run and order the forces of the bearings and their displacements come first, and the
    // displacements of the probes last.
    let (bearings, all) = (runs.systems[0].bearings(), runs.vectors());
    let part = |first: usize, count: usize| -> Vec<Complex<f64>> {
        let own = found.chunks_exact(3 * all.max(1));
        own.flat_map(|x| x[3 * first..][..3 * count].to_vec()).collect()
    };
    let moved = part(all - probes.len(), probes.len());
    Ok(vec![
        moved.iter().map(|x| x.re).collect(),
        moved.iter().map(|x| x.im).collect(),
        frequencies,
        largest_lengths(&part(0, bearings), &[1.0])?,
        largest_lengths(&part(bearings, bearings), &[1.0])?,
    ])
}
