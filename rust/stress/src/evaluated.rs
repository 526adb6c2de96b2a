//! What the core computes for the samples of one driveline.

use cardan::{Execution, Plan, Planes, Samples};

use crate::judge::Tier;

/// The planes of a plan at each sample, with the arithmetic that the core chooses for a tier.
pub(crate) fn planes(plan: &Plan, samples: &Samples<'_>, tier: Tier) -> Vec<Vec<f64>> {
    let precision = match tier {
        Tier::Faithful => plan.precision(Some(0.0), false),
        Tier::Default => plan.precision(None, false),
        Tier::Loose | Tier::Float32 => plan.precision(None, true),
    };
    let length = samples.shape.iter().product();
    let run = |planes: Planes<'_, '_>| {
        plan.run(samples, None, precision, planes, Execution::default()).expect("the arrays fit");
    };
    if tier == Tier::Float32 {
        let mut planes = vec![vec![f32::NAN; length]; plan.planes()];
        run(Planes::Single(&mut planes.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>()));
        return planes
            .into_iter()
            .map(|plane| plane.into_iter().map(f64::from).collect())
            .collect();
    }
    let mut planes = vec![vec![f64::NAN; length]; plan.planes()];
    run(Planes::Double(&mut planes.iter_mut().map(Vec::as_mut_slice).collect::<Vec<_>>()));
    planes
}
