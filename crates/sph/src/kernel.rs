//! Smoothing kernels W(r, h) of support radius 2h.

use std::f64::consts::PI;

/// A radial kernel of support radius 2h, normalised so that it integrates to one (3.2a): `[eq:kernel]`.
///
/// Source of the default: Greto & Kulasegaram 2019, (3.4)-(3.5), with the plane normalisation
/// corrected to 3/(16π); the printed 1/(32π) does not integrate to one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// Quintic spline of two pieces (3.4), continuous up to the fourth derivative at r = h and 2h.
    #[default]
    QuinticSpline,
    /// Cubic B-spline (Monaghan 1992).
    CubicSpline,
    /// Wendland's C² function.
    WendlandC2,
    /// Wendland's C⁴ function.
    WendlandC4,
}

impl Kernel {
    /// Every kernel.
    pub const ALL: [Self; 4] = [
        Self::QuinticSpline,
        Self::CubicSpline,
        Self::WendlandC2,
        Self::WendlandC4,
    ];

    /// Name in case files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::QuinticSpline => "quintic-spline",
            Self::CubicSpline => "cubic-spline",
            Self::WendlandC2 => "wendland-c2",
            Self::WendlandC4 => "wendland-c4",
        }
    }

    /// The kernel of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kernel| kernel.name() == name)
    }

    /// Normalisation α_d in W = α_d w(q)/h^d for d = 2 or 3.
    #[must_use]
    pub fn normalisation(self, dimension: usize) -> f64 {
        let plane = dimension == 2;
        match self {
            Self::QuinticSpline if plane => 3.0 / (16.0 * PI),
            Self::QuinticSpline => 7.0 / (40.0 * PI),
            Self::CubicSpline if plane => 10.0 / (7.0 * PI),
            Self::CubicSpline => 1.0 / PI,
            Self::WendlandC2 if plane => 7.0 / (4.0 * PI),
            Self::WendlandC2 => 21.0 / (16.0 * PI),
            Self::WendlandC4 if plane => 9.0 / (4.0 * PI),
            Self::WendlandC4 => 495.0 / (256.0 * PI),
        }
    }

    /// W(r, h), m^-d, for r >= 0 and d = `dimension` (2 or 3).
    #[must_use]
    pub fn value(self, r: f64, h: f64, dimension: usize) -> f64 {
        let q = r / h;
        if q >= 2.0 {
            return 0.0;
        }
        let shape = match self {
            Self::QuinticSpline => (2.0 - q).powi(5) - 16.0 * (1.0 - q).max(0.0).powi(5),
            Self::CubicSpline => 0.25 * (2.0 - q).powi(3) - (1.0 - q).max(0.0).powi(3),
            Self::WendlandC2 => (1.0 - 0.5 * q).powi(4) * (2.0 * q + 1.0),
            Self::WendlandC4 => (1.0 - 0.5 * q).powi(6) * (35.0 / 12.0 * q * q + 3.0 * q + 1.0),
        };
        self.normalisation(dimension) * shape / h.powi(dimension as i32)
    }

    /// W'(r)/r, m^-(d+2): the factor that turns an offset into a kernel gradient. Finite and
    /// non-positive for every r > 0; at r = 0, where gradients vanish, it is zero by convention.
    #[must_use]
    pub fn derivative_over_radius(self, r: f64, h: f64, dimension: usize) -> f64 {
        let q = r / h;
        if q >= 2.0 || q == 0.0 {
            return 0.0;
        }
        let slope = match self {
            Self::QuinticSpline => -5.0 * (2.0 - q).powi(4) + 80.0 * (1.0 - q).max(0.0).powi(4),
            Self::CubicSpline => -0.75 * (2.0 - q).powi(2) + 3.0 * (1.0 - q).max(0.0).powi(2),
            Self::WendlandC2 => -5.0 * q * (1.0 - 0.5 * q).powi(3),
            Self::WendlandC4 => -7.0 / 3.0 * q * (2.0 + 5.0 * q) * (1.0 - 0.5 * q).powi(5),
        };
        self.normalisation(dimension) * slope / (h.powi(dimension as i32 + 1) * r)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ f(r) dr over the support by the midpoint rule; error O(n⁻²).
    fn integrate(f: impl Fn(f64) -> f64, h: f64) -> f64 {
        let n = 20_000;
        let dr = 2.0 * h / f64::from(n);
        (0..n).map(|i| f((f64::from(i) + 0.5) * dr) * dr).sum()
    }

    #[test]
    fn every_kernel_integrates_to_one() {
        let h = 0.37;
        for kernel in Kernel::ALL {
            let plane = integrate(|r| 2.0 * PI * r * kernel.value(r, h, 2), h);
            let solid = integrate(|r| 4.0 * PI * r * r * kernel.value(r, h, 3), h);
            assert!((plane - 1.0).abs() < 1e-7, "{kernel:?} plane {plane}");
            assert!((solid - 1.0).abs() < 1e-7, "{kernel:?} solid {solid}");
        }
    }

    #[test]
    fn first_moment_of_the_gradient_is_minus_one() {
        // ∫ ∇W ⊗ r dV = -1, i.e. ∫ W'(r) r dV = -d.
        let h = 0.8;
        for kernel in Kernel::ALL {
            let plane = integrate(
                |r| 2.0 * PI * r * r * r * kernel.derivative_over_radius(r, h, 2),
                h,
            );
            let solid = integrate(
                |r| 4.0 * PI * r.powi(4) * kernel.derivative_over_radius(r, h, 3),
                h,
            );
            assert!((plane + 2.0).abs() < 1e-6, "{kernel:?} plane {plane}");
            assert!((solid + 3.0).abs() < 1e-6, "{kernel:?} solid {solid}");
        }
    }

    #[test]
    fn derivative_is_the_slope_of_the_value_and_never_positive() {
        let h = 1.3;
        for kernel in Kernel::ALL {
            for dimension in [2, 3] {
                for i in 1..200 {
                    let r = 2.0 * h * f64::from(i) / 200.0;
                    let step = 1e-5 * h;
                    let slope = (kernel.value(r + step, h, dimension)
                        - kernel.value(r - step, h, dimension))
                        / (2.0 * step);
                    let derivative = kernel.derivative_over_radius(r, h, dimension) * r;
                    // Central differences: third derivative times step², and round-off / step.
                    assert!((slope - derivative).abs() < 1e-7, "{kernel:?} at {r}");
                    assert!(derivative <= 0.0);
                }
            }
        }
    }

    #[test]
    fn nothing_is_felt_from_twice_the_smoothing_length_on() {
        for kernel in Kernel::ALL {
            assert_eq!(kernel.value(2.0, 1.0, 3), 0.0);
            assert_eq!(kernel.derivative_over_radius(2.5, 1.0, 2), 0.0);
        }
    }

    #[test]
    fn names_find_their_kernel() {
        for kernel in Kernel::ALL {
            assert_eq!(Kernel::from_name(kernel.name()), Some(kernel));
        }
        assert_eq!(Kernel::from_name("gaussian"), None);
    }
}
