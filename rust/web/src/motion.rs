//! Outputs at drive angles, and what they do over a turn.

use cardan::{
    Angles, Execution, Peak, Plan, Planes, Request, Result, Samples, Sought, Source, Sweep, Turns,
    drive_angles as driven,
};

use crate::arguments::{Arguments, Lines, LoadOf, RequestOf, check_results};

/// The plan of a request.
fn plan(request: &RequestOf, lines: &Lines<'_>, load: Option<&LoadOf<'_>>) -> Result<Plan> {
    Plan::new(&Request {
        largest_bends: &lines.batch.largest_bends,
        outputs: &request.outputs,
        shafts: &request.shafts,
        joints: &request.joints,
        load: load.map(|load| load.end),
        inertias: &load.map_or(vec![], LoadOf::shafts),
        bearings: lines.batch.bearings.as_deref(),
        as_built: false,
        axes: request.axes,
    })
}

pub(crate) fn evaluate(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (lines, request) = (arguments.lines()?, arguments.request()?);
    let load = arguments.usual_load(lines.count())?;
    let plan = plan(&request, &lines, load.as_ref())?;
    let given = arguments.finite("angles")?;
    let (angle, samples) = if given.is_empty() {
        let samples = arguments.count("samples")?;
        let sweep = if arguments.of("per_turn").is_empty() {
            Sweep::new(arguments.number("start")?, arguments.number("stop")?, samples)?
        } else {
            Sweep::of_turns(samples, arguments.count("per_turn")?)?
        };
        (Angles::Sweep(sweep), sweep.count())
    } else {
        (Angles::Array(Source { data: given, strides: &[0, 1] }), given.len())
    };
    let total = check_results("samples", &[plan.planes(), lines.count(), samples])?;
    let samples = Samples {
        shape: &[lines.count(), samples],
        lines: lines.arrays,
        line_strides: &[1, 0],
        angle,
        load: load.as_ref().map(|load| load.source(&[1, 0])),
    };
    let mut values = vec![0.0; total];
    let mut planes: Vec<&mut [f64]> =
        values.chunks_mut((total / plan.planes().max(1)).max(1)).collect();
    let precision = plan.precision(arguments.maybe("tolerance")?, false);
    plan.run(&samples, None, precision, Planes::Double(&mut planes), Execution::default())?;
    Ok(vec![values])
}

pub(crate) fn drive_angles(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (lines, angles) = (arguments.lines()?, arguments.finite("angles")?);
    let total = check_results("angles", &[2, lines.count(), angles.len()])? / 2;
    let samples = Samples {
        shape: &[lines.count(), angles.len()],
        lines: lines.arrays,
        line_strides: &[1, 0],
        angle: Angles::Array(Source { data: angles, strides: &[0, 1] }),
        load: None,
    };
    let (mut high, mut low) = (vec![0.0; total], vec![0.0; total]);
    driven(lines.joints, &samples, [&mut high, &mut low], Execution::default())?;
    Ok(vec![high, low])
}

pub(crate) fn peaks(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (lines, request) = (arguments.lines()?, arguments.request()?);
    let load = arguments.usual_load(lines.count())?;
    let plan = plan(&request, &lines, load.as_ref())?;
    let sought = if arguments.flag("least")? { Sought::Least } else { Sought::Largest };
    let rows = lines.rows(load.as_ref());
    let found = Turns::new(&plan, &rows).peaks(sought, Execution::default())?;
    let of = |peak: &Peak| (peak.value, peak.places.len() as f64);
    let (values, counts) = found.iter().map(of).unzip();
    Ok(vec![values, counts, found.into_iter().flat_map(|peak| peak.places).collect()])
}

pub(crate) fn orders(arguments: &Arguments<'_>) -> Result<Vec<Vec<f64>>> {
    let (lines, request) = (arguments.lines()?, arguments.request()?);
    let load = arguments.usual_load(lines.count())?;
    let plan = plan(&request, &lines, load.as_ref())?;
    let (orders, driven) = (arguments.counts("orders")?, arguments.flag("driven")?);
    check_results("orders", &[2, plan.planes(), lines.count(), orders.len() + 2])?;
    let tolerance = arguments.maybe("tolerance")?.unwrap_or(0.0);
    let rows = lines.rows(load.as_ref());
    let found =
        Turns::new(&plan, &rows).orders(&orders, driven, tolerance, Execution::default())?;
    Ok(vec![found.mean, found.error, found.amplitudes.into_flattened()])
}
