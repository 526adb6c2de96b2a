//! The largest length of a vector over the turn.

use nalgebra::Complex;

use crate::error::{Error, Result};
use crate::number::elementary::turn;

type C = Complex<f64>;

/// The most turns after which orders repeat.
const TURNS: usize = 16;

/// Samples of a wave of the highest order, between which a length is followed to its extremum.
const SAMPLES: f64 = 16.0;

/// The largest length of `Re Σ xₖ e^{ikα}` over all drive angles, of vectors `(vectors, orders, 3)`.
///
/// # Errors
/// Orders that are negative or not finite, or do not repeat within 16 turns.
pub fn largest_lengths(amplitudes: &[C], orders: &[f64]) -> Result<Vec<f64>> {
    let is_right = |order: &f64| *order >= 0.0 && order.is_finite();
    if let Some(i) = orders.iter().position(|order| !is_right(order)) {
        let problem = format!("is {:?}; an order must be finite and not negative", orders[i]);
        return Err(Error::new("orders", &[i], problem));
    }
    let whole = |turns: &usize| {
        orders.iter().all(|order| {
            let repeats = order * *turns as f64;
            (repeats - repeats.round()).abs() <= 1e-9 * repeats.max(1.0)
        })
    };
    let Some(turns) = (1..=TURNS).find(whole) else {
        let problem = format!("are {orders:?}, which do not repeat within {TURNS} turns");
        return Err(Error::new("orders", &[], problem));
    };
    let each = 3 * orders.len().max(1);
    Ok(amplitudes.chunks_exact(each).map(|own| largest(own, orders, turns)).collect())
}

fn largest(amplitudes: &[C], orders: &[f64], turns: usize) -> f64 {
    if let (&[order], &[x, y, z]) = (orders, amplitudes) {
        let [x, y, z] = if order == 0.0 { [x, y, z].map(|x| C::from(x.re)) } else { [x, y, z] };
        // The longer half axis of an ellipse; a constant vector has its own length.
        let size = x.norm_sqr() + y.norm_sqr() + z.norm_sqr();
        let square = (x * x + y * y + z * z).norm_sqr().sqrt();
        return (0.5 * (size + square)).sqrt();
    }
    // Half the square of the length with its first two derivatives.
    let at = |angle: f64| {
        let mut rates = [[0.0; 3]; 3];
        for (own, &order) in amplitudes.chunks_exact(3).zip(orders) {
            let turned = turn(order * angle);
            for (i, x) in own.iter().enumerate() {
                let x = x * turned;
                rates[0][i] += x.re;
                rates[1][i] -= order * x.im;
                rates[2][i] -= order * order * x.re;
            }
        }
        let dot = |a: usize, b: usize| -> f64 { (0..3).map(|i| rates[a][i] * rates[b][i]).sum() };
        [0.5 * dot(0, 0), dot(0, 1), dot(1, 1) + dot(0, 2)]
    };
    let highest = orders.iter().copied().fold(0.5, f64::max);
    let count = (SAMPLES * highest * turns as f64).ceil() as usize;
    let step = std::f64::consts::TAU * turns as f64 / count as f64;
    let values: Vec<f64> = (0..count).map(|i| at(step * i as f64)[0]).collect();
    let mut best = 0.0_f64;
    for i in 0..count {
        let [before, own, after] = [count - 1, 0, 1].map(|by| values[(i + by) % count]);
        if own >= before && own >= after {
            let mut angle = step * i as f64;
            best = best.max(own);
            for _ in 0..8 {
                let [_, slope, curvature] = at(angle);
                if curvature >= 0.0 || !(slope / curvature).is_finite() {
                    break;
                }
                angle -= (slope / curvature).clamp(-step, step);
            }
            best = best.max(at(angle)[0]);
        }
    }
    (2.0 * best).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_orders_reach_their_sum() {
        let amplitudes = [C::from(3.0), C::ZERO, C::ZERO, Complex::new(0.0, 2.0), C::ZERO, C::ZERO];
        let found = largest_lengths(&amplitudes, &[0.0, 2.0]).unwrap();
        assert!((found[0] - 5.0).abs() < 1e-14, "{found:?}");
        let circle = [C::ONE, Complex::new(0.0, 1.0), C::ZERO];
        assert!((largest_lengths(&circle, &[2.0]).unwrap()[0] - 1.0).abs() < 1e-15);
        assert!(largest_lengths(&circle, &[0.123]).is_err());
    }
}
