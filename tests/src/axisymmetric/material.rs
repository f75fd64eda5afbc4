//! Hencky elasticity with von Mises plasticity and linear hardening, at the four points of an element.

use super::Lanes;

/// A symmetric tensor without torsion: components in the plane of radius and axis, and the hoop component.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Symmetric {
    /// Radial component.
    pub rr: Lanes,
    /// Axial component.
    pub zz: Lanes,
    /// Shear between radius and axis.
    pub rz: Lanes,
    /// Hoop component.
    pub tt: Lanes,
}

impl Symmetric {
    /// The unit tensor.
    #[must_use]
    pub fn unit() -> Self {
        Self::diagonal([1.0, 1.0, 1.0])
    }

    /// The same radial, axial and hoop components at all points, no shear.
    #[must_use]
    pub fn diagonal([rr, zz, tt]: [f64; 3]) -> Self {
        Self {
            rr: Lanes::of(rr),
            zz: Lanes::of(zz),
            rz: Lanes::of(0.0),
            tt: Lanes::of(tt),
        }
    }

    /// Eigenvalues, the two of the plane first, and cosine and sine of twice the angle from the radius to
    /// the direction of the first.
    #[inline]
    fn spectrum(&self) -> ([Lanes; 3], [Lanes; 2]) {
        let mean = 0.5 * (self.rr + self.zz);
        let difference = 0.5 * (self.rr - self.zz);
        let radius = (difference * difference + self.rz * self.rz).sqrt();
        let first = mean + radius;
        // The small eigenvalue from the determinant: the difference would cancel.
        let second = (self.rr * self.zz - self.rz * self.rz) / first;
        // Any direction will do where the two are equal.
        let divisor = radius.max(Lanes::of(1e-300));
        let directions = [difference / divisor, self.rz / divisor];
        ([first, second, self.tt], directions)
    }

    /// The tensor of given eigenvalues with the directions of another.
    #[inline]
    fn from_spectrum([first, second, hoop]: [Lanes; 3], [cosine, sine]: [Lanes; 2]) -> Self {
        let (mean, half) = (0.5 * (first + second), 0.5 * (first - second));
        Self {
            rr: mean + half * cosine,
            zz: mean - half * cosine,
            rz: half * sine,
            tt: hoop,
        }
    }
}

/// Moduli, density and hardening of an isotropic metal, SI units.
#[derive(Clone, Copy, Debug)]
pub struct Metal {
    /// Density of the undeformed metal, kg/m³.
    pub density: f64,
    /// Bulk modulus κ, Pa.
    pub bulk_modulus: f64,
    /// Shear modulus μ, Pa.
    pub shear_modulus: f64,
    /// Yield stress (Cauchy) of the virgin metal σ_0, Pa.
    pub initial_yield_stress: f64,
    /// Slope H of the yield stress over the equivalent plastic strain, Pa.
    pub hardening_modulus: f64,
}

/// What a strain increment gives at the points.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// Deviator of the Kirchhoff stress, Pa.
    pub deviator: Symmetric,
    /// Elastic left Cauchy-Green tensor after plastic flow.
    pub elastic_strain: Symmetric,
    /// Increment of the equivalent plastic strain.
    pub plastic_increment: Lanes,
    /// Elastic energy of distortion per undeformed volume, J/m³.
    pub distortion_energy: Lanes,
    /// Plastic work of the increment per undeformed volume, J/m³, with the stress at its end.
    pub plastic_work: Lanes,
}

impl Metal {
    /// The copper of `cases/taylor-bar.toml`: 117 GPa, ν = 0.35, 400 MPa + 100 MPa ε_p, 8930 kg/m³.
    #[must_use]
    pub fn copper() -> Self {
        let (young, poisson) = (117e9, 0.35);
        Self {
            density: 8930.0,
            bulk_modulus: young / (3.0 * (1.0 - 2.0 * poisson)),
            shear_modulus: young / (2.0 * (1.0 + poisson)),
            initial_yield_stress: 400e6,
            hardening_modulus: 100e6,
        }
    }

    /// Speed of pressure waves, m/s.
    #[must_use]
    pub fn pressure_wave_speed(&self) -> f64 {
        ((self.bulk_modulus + 4.0 / 3.0 * self.shear_modulus) / self.density).sqrt()
    }

    /// Return to the yield surface of a trial elastic left Cauchy-Green tensor.
    ///
    /// With logarithmic principal strains ε_i = ½ ln b_i and their deviator e: τ' = 2 μ e, q = √(3/2) |τ'|,
    /// q ≤ J (σ_0 + H ε_p). For linear hardening the plastic increment is exact,
    /// Δε_p = (q − J σ_Y)/(3 μ + J H). Simo, CMAME 99 (1992) 61-112, written for the Cauchy yield stress.
    ///
    /// # Arguments
    /// * `jacobian`: J, one for the whole element.
    #[must_use]
    #[inline]
    pub fn respond(&self, trial: &Symmetric, jacobian: f64, plastic_strain: Lanes) -> Response {
        let (squares, directions) = trial.spectrum();
        let [first, second, hoop] = squares.map(|square| 0.5 * logarithm(square));
        let mean = 1.0 / 3.0 * (first + second + hoop);
        let deviator = [first - mean, second - mean, hoop - mean];
        let [first, second, hoop] = deviator;
        let norm = (first * first + second * second + hoop * hoop).sqrt();

        let equivalent = 6.0_f64.sqrt() * self.shear_modulus * norm;
        let flow_stress =
            Lanes::of(self.initial_yield_stress) + self.hardening_modulus * plastic_strain;
        let stiffness = 3.0 * self.shear_modulus;
        let excess = (equivalent - jacobian * flow_stress).max(Lanes::of(0.0));
        let plastic_increment = 1.0 / (stiffness + jacobian * self.hardening_modulus) * excess;
        let remaining = equivalent - stiffness * plastic_increment;
        let scale = remaining / equivalent.max(Lanes::of(1e-300));

        let deviator = deviator.map(|e| scale * e);
        let elastic_strain = if plastic_increment.largest() > 0.0 {
            let squares = deviator.map(|e| exponential(2.0 * (e + mean)));
            Symmetric::from_spectrum(squares, directions)
        } else {
            *trial
        };
        let stress = deviator.map(|e| 2.0 * self.shear_modulus * e);
        let norm = scale * norm;
        Response {
            deviator: Symmetric::from_spectrum(stress, directions),
            elastic_strain,
            plastic_increment,
            distortion_energy: self.shear_modulus * (norm * norm),
            plastic_work: remaining * plastic_increment,
        }
    }
}

/// ln x. Elastic stretches are within per cents of one, where a series is exact to rounding.
#[inline]
fn logarithm(x: Lanes) -> Lanes {
    let y = (x - Lanes::of(1.0)) / (x + Lanes::of(1.0));
    let z = y * y;
    if z.largest() < 1e-3 {
        let mut sum = Lanes::of(1.0 / 13.0);
        for divisor in [11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
            sum = sum * z + Lanes::of(1.0 / divisor);
        }
        2.0 * y * sum
    } else {
        x.map(f64::ln)
    }
}

/// exp x, by its series where that is exact to rounding.
#[inline]
fn exponential(x: Lanes) -> Lanes {
    if x.largest() < 0.06 && x.smallest() > -0.06 {
        let mut sum = Lanes::of(1.0 / 362_880.0);
        for factorial in [40_320.0, 5_040.0, 720.0, 120.0, 24.0, 6.0, 2.0, 1.0, 1.0] {
            sum = sum * x + Lanes::of(1.0 / factorial);
        }
        sum
    } else {
        x.map(f64::exp)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_are_those_of_the_library() {
        for k in -100..=100 {
            let x = 0.001 * f64::from(k);
            // Rounding and the first term left out, 2 y^15/15 and x^10/10!, are below these.
            let [logarithm, ..] = logarithm(Lanes::of(1.0 + x)).0;
            let [exponential, ..] = exponential(Lanes::of(x)).0;
            assert!((logarithm - (1.0 + x).ln()).abs() < 3e-16, "{x}");
            assert!((exponential - x.exp()).abs() < 5e-16, "{x}");
        }
    }

    #[test]
    fn a_tensor_is_rebuilt_from_its_spectrum() {
        let tensor = Symmetric {
            rz: Lanes([-0.35, 0.0, 0.1, 0.2]),
            ..Symmetric::diagonal([1.3, 0.4, 2.0])
        };
        let (values, directions) = tensor.spectrum();
        // Trace and determinant of the plane.
        assert!((values[0].0[0] + values[1].0[0] - 1.7).abs() < 1e-15);
        assert!((values[0].0[0] * values[1].0[0] - (1.3 * 0.4 - 0.35 * 0.35)).abs() < 1e-15);
        let rebuilt = Symmetric::from_spectrum(values, directions);
        for (one, other) in [
            (rebuilt.rr, tensor.rr),
            (rebuilt.zz, tensor.zz),
            (rebuilt.rz, tensor.rz),
            (rebuilt.tt, tensor.tt),
        ] {
            assert!(
                (one - other).map(f64::abs).largest() < 1e-15,
                "{one:?} {other:?}"
            );
        }
    }

    /// Isochoric compression along the axis by exp(−0.5) in equal steps: all strains stay coaxial, so the
    /// equivalent plastic strain is (3 μ |ε| − σ_0)/(3 μ + H) however many steps there are.
    #[test]
    fn coaxial_flow_is_exact_for_any_number_of_steps() {
        let metal = Metal::copper();
        let total: f64 = 0.5;
        for steps in [1, 7, 100] {
            let (mut elastic, mut plastic_strain) = (Symmetric::unit(), Lanes::of(0.0));
            let mut deviator = Symmetric::unit();
            let stretch = (-total / f64::from(steps)).exp();
            for _ in 0..steps {
                let trial = Symmetric {
                    rr: 1.0 / stretch * elastic.rr,
                    zz: stretch * stretch * elastic.zz,
                    rz: Lanes::of(0.0),
                    tt: 1.0 / stretch * elastic.tt,
                };
                let response = metal.respond(&trial, 1.0, plastic_strain);
                elastic = response.elastic_strain;
                plastic_strain += response.plastic_increment;
                deviator = response.deviator;
            }
            let stiffness = 3.0 * metal.shear_modulus;
            let exact = (stiffness * total - metal.initial_yield_stress)
                / (stiffness + metal.hardening_modulus);
            let plastic_strain = plastic_strain.0[0];
            assert!((plastic_strain / exact - 1.0).abs() < 1e-12);
            // Uniaxial compression: the deviator is −⅔ σ_Y along the axis.
            let flow_stress = metal.initial_yield_stress + metal.hardening_modulus * plastic_strain;
            assert!((deviator.zz.0[0] / (-2.0 / 3.0 * flow_stress) - 1.0).abs() < 1e-9);
            let trace = (deviator.rr + deviator.zz + deviator.tt).0[0];
            assert!(trace.abs() < 1e-6 * flow_stress);
        }
    }

    #[test]
    fn a_rotated_trial_has_the_rotated_stress() {
        let metal = Metal::copper();
        let plane = |angle: f64| {
            let (s, c) = angle.sin_cos();
            let diagonal = [1.2 * c * c + 0.9 * s * s, 1.2 * s * s + 0.9 * c * c, 0.95];
            Symmetric {
                rz: Lanes::of(0.3 * s * c),
                ..Symmetric::diagonal(diagonal)
            }
        };
        let of = |angle| {
            let deviator = metal.respond(&plane(angle), 1.02, Lanes::of(0.1)).deviator;
            [deviator.rr, deviator.zz, deviator.rz, deviator.tt].map(|lanes| lanes.0[2])
        };
        let ([rr, zz, _, tt], turned) = (of(0.0), of(0.7));
        let (s, c) = 0.7_f64.sin_cos();
        let expected = [
            rr * c * c + zz * s * s,
            rr * s * s + zz * c * c,
            (rr - zz) * s * c,
            tt,
        ];
        for (one, other) in turned.iter().zip(expected) {
            assert!((one - other).abs() < 1e-9 * rr.abs(), "{one} {other}");
        }
    }
}
