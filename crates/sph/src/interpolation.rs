//! Shepard-corrected interpolation of particle values at any point.

use jstsph_tensor::Vec3;

use crate::Support;

/// Σ_b V_b f_b W_b / Σ_b V_b W_b at `point`: exact for constants; `None` where no particle is
/// within the support radius.
///
/// Positions may be the reference or the current ones. `[eq:interpolation]`: Greto & Kulasegaram 2019, (3.1), with the
/// constant kernel correction of Bonet & Lok 1999.
#[must_use]
pub fn interpolate(
    point: &Vec3,
    positions: &[Vec3],
    volumes: &[f64],
    values: &[f64],
    support: &Support,
) -> Option<f64> {
    let (mut sum, mut total) = (0.0, 0.0);
    for ((position, volume), value) in positions.iter().zip(volumes).zip(values) {
        let r = (position - point).norm();
        if r < support.radius() {
            let weight = volume * support.value(r);
            sum += weight * value;
            total += weight;
        }
    }
    (total > 0.0).then(|| sum / total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Kernel;

    #[test]
    fn constants_are_exact_and_far_points_have_no_value() {
        let positions = [
            Vec3::zeros(),
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
        ];
        let support = Support {
            kernel: Kernel::QuinticSpline,
            smoothing_length: 1.0,
            dimension: 2,
        };
        let at =
            |point: Vec3| interpolate(&point, &positions, &[1.0, 0.5, 0.25], &[7.0; 3], &support);
        assert!((at(Vec3::new(0.3, 0.4, 0.0)).unwrap() - 7.0).abs() < 1e-14);
        assert_eq!(at(Vec3::new(9.0, 0.0, 0.0)), None);
    }
}
