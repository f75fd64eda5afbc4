//! Pressure at strong compression, as a function of J and T: `[eq:mie-grueneisen]`.

use crate::{Description, Key, MaterialError, ParameterError, Property, Range, Thermal};
use serde::{Deserialize, Serialize};

/// An equation of state, as in `equation_of_state = { <law> = { ... } }` of a case file.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EquationOfState {
    /// See [`MieGrueneisen`].
    MieGrueneisen(MieGrueneisen),
}

/// The equations of state with their keys, units and ranges.
pub const EQUATIONS_OF_STATE: &[Description] = &[Description {
    name: "mie_grueneisen",
    summary: "shocks faster than sound by s times the particle speed; pressure of heat gamma0 * density * energy",
    keys: KEYS,
}];

/// Mie-Grüneisen equation of state about a linear shock Hugoniot U_s = c_0 + s u_p, with Γ ρ = Γ_0 ρ_0.
///
/// With η = 1 − J, energies per unit reference volume, T_0 the reference temperature and c the heat
/// capacity, both constants of the [`Thermal`] part:
///
/// ```text
///   p = p_H + Γ_0 (e − e_H) ,   p_H = ρ c_0² η/(1 − s η)² ,   e_H = ½ p_H η   [eq:mie-grueneisen]
/// ```
///
/// which as a function of J and T is, about the isentrope through the reference state,
///
/// ```text
///   T_s = T_0 exp(Γ_0 η) ,   e_s = ∫₀^η p_H(x) (1 − ½ Γ_0 x) exp(Γ_0 (η − x)) dx
///   p   = p_s + Γ_0 ρ c (T − T_s) ,   p_s = p_H + Γ_0 (e_s − e_H) = de_s/dη
///   e   = e_s + ρ c (T − T_s)
/// ```
///
/// In tension, where no shock was ever measured, the isentrope is p_s = ρ c_0² η/(1 − 2 s η), which
/// continues its slope and curvature and tends to ρ c_0²/(2 s). The integral is evaluated by twelve
/// points of Gauss: pressures are right to 1e-12 up to s η of one half, to 1e-9 at the end of the range.
///
/// ρ c_0² takes the place of κ; it should be near the κ of E and ν, of which only μ is used. The sound
/// speed grows under compression as √((1 + s η)/(1 − s η)³): beyond η of a tenth choose a smaller
/// time step, which is estimated from c_0.
///
/// # Limits
/// J > 1 − 3/(4 s); the pressure is infinite beyond.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct MieGrueneisen {
    /// c_0, m/s, positive.
    pub c0: f64,
    /// s, zero or positive.
    pub s: f64,
    /// Γ_0, zero or positive.
    pub gamma0: f64,
}

const C0: Key = Key {
    name: "c0",
    unit: "m/s",
    meaning: "bulk sound speed; density * c0^2 takes the place of the bulk modulus",
    range: Range::Positive,
    optional: false,
};
const S: Key = Key {
    name: "s",
    unit: "-",
    meaning: "slope of the shock speed over the particle speed",
    range: Range::NonNegative,
    optional: false,
};
const GAMMA0: Key = Key {
    name: "gamma0",
    unit: "-",
    meaning: "Grueneisen's constant: pressure over energy density of heat",
    range: Range::NonNegative,
    optional: false,
};
const KEYS: &[Key] = &[C0, S, GAMMA0];

/// Largest s η.
const LARGEST_COMPRESSION: f64 = 0.75;

/// Points (on one side) and weights of Gauss's rule on (−1, 1).
const GAUSS: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_8),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_5, 0.203_167_426_723_065_9),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_2),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_4),
    (0.981_560_634_246_719_2, 0.047_175_336_386_511_8),
];

/// The equation of state of a material: with its density and its heat capacity.
#[derive(Clone, Copy)]
pub(crate) struct StateEquation<'a> {
    law: &'a MieGrueneisen,
    density: f64,
    /// ρ c, J/(m³ K).
    heat_capacity: f64,
    reference_temperature: f64,
}

impl EquationOfState {
    /// Checks the parameters and that the thermal part suits them.
    ///
    /// # Errors
    /// The first key that cannot be used, within the model's table.
    pub(crate) fn validate(&self, thermal: Option<&Thermal>) -> Result<(), ParameterError> {
        let Self::MieGrueneisen(law) = self;
        let name = EQUATIONS_OF_STATE[0].name;
        C0.check(law.c0).map_err(|error| error.within(name))?;
        S.check(law.s).map_err(|error| error.within(name))?;
        GAMMA0
            .check(law.gamma0)
            .map_err(|error| error.within(name))?;
        let needs = |key: String, what| Err(ParameterError::Needs { key, what });
        let Some(thermal) = thermal else {
            return needs(name.to_owned(), "the heat capacity in a table `thermal`");
        };
        if !matches!(thermal.heat_capacity, Property::Constant(_)) {
            return needs(
                name.to_owned(),
                "a thermal.heat_capacity that does not depend on the temperature",
            );
        }
        if thermal.expansion != 0.0 {
            return needs(
                name.to_owned(),
                "thermal.expansion = 0: the expansion follows from gamma0",
            );
        }
        Ok(())
    }

    /// With the constants of the material, of which the heat capacity is one.
    #[inline]
    pub(crate) fn of<'a>(&'a self, density: f64, thermal: &Thermal) -> StateEquation<'a> {
        let Self::MieGrueneisen(law) = self;
        StateEquation {
            law,
            density,
            heat_capacity: density * thermal.heat_capacity.at(thermal.reference_temperature),
            reference_temperature: thermal.reference_temperature,
        }
    }
}

/// (−y − ln(1 − y))/y², ½ at y = 0, for y ≤ 0: e_s/(ρ c_0² η²) in tension with y = 2 s η.
fn tension_energy(y: f64) -> f64 {
    if y < -0.01 {
        return (-y - (-y).ln_1p()) / (y * y);
    }
    // The first omitted term is y⁸/10, below 1e-17.
    (2..10)
        .rev()
        .fold(0.0, |sum, k| sum * y + 1.0 / f64::from(k))
}

impl StateEquation<'_> {
    /// ρ c_0², Pa.
    pub(crate) fn bulk_modulus(&self) -> f64 {
        self.density * self.law.c0 * self.law.c0
    }

    /// Smallest J of the range.
    fn smallest_jacobian(&self) -> f64 {
        1.0 - LARGEST_COMPRESSION / self.law.s
    }

    /// # Errors
    /// [`MaterialError::Compressed`] outside the range.
    #[inline]
    pub(crate) fn check(&self, jacobian: f64) -> Result<(), MaterialError> {
        let limit = self.smallest_jacobian();
        if jacobian < limit {
            return Err(MaterialError::Compressed { jacobian, limit });
        }
        Ok(())
    }

    /// p_H, Pa.
    fn hugoniot(&self, compression: f64) -> f64 {
        let left = 1.0 - self.law.s * compression;
        self.bulk_modulus() * compression / (left * left)
    }

    /// p_s and e_s.
    fn isentrope(&self, compression: f64) -> (f64, f64) {
        if compression <= 0.0 {
            let expansion = 2.0 * self.law.s * compression;
            let pressure = self.bulk_modulus() * compression;
            return (
                pressure / (1.0 - expansion),
                pressure * compression * tension_energy(expansion),
            );
        }
        if self.law.s * compression > LARGEST_COMPRESSION {
            return (f64::INFINITY, f64::INFINITY);
        }
        let gamma = self.law.gamma0;
        let integrand =
            |x: f64| self.hugoniot(x) * (1.0 - 0.5 * gamma * x) * (gamma * (compression - x)).exp();
        let half = 0.5 * compression;
        let energy = half
            * GAUSS
                .iter()
                .map(|(point, weight)| {
                    weight * (integrand(half - half * point) + integrand(half + half * point))
                })
                .sum::<f64>();
        let pressure = self.hugoniot(compression);
        (
            pressure + gamma * (energy - 0.5 * pressure * compression),
            energy,
        )
    }

    /// T_s, K.
    fn isentropic_temperature(&self, jacobian: f64) -> f64 {
        self.reference_temperature * (self.law.gamma0 * (1.0 - jacobian)).exp()
    }

    /// τ_vol = −J p.
    pub(crate) fn volumetric_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        let thermal = self.law.gamma0
            * self.heat_capacity
            * (temperature - self.isentropic_temperature(jacobian));
        -jacobian * (self.isentrope(1.0 - jacobian).0 + thermal)
    }

    /// e less the heat ρ c (T − T_0), which leaves e_s − ρ c (T_s − T_0).
    pub(crate) fn volumetric_energy(&self, jacobian: f64) -> f64 {
        let warmed = self.isentropic_temperature(jacobian) - self.reference_temperature;
        self.isentrope(1.0 - jacobian).1 - self.heat_capacity * warmed
    }

    /// T ∂τ_vol/∂T = −J Γ_0 ρ c T.
    pub(crate) fn thermoelastic_stress(&self, jacobian: f64, temperature: f64) -> f64 {
        -jacobian * self.law.gamma0 * self.heat_capacity * temperature
    }
}

/// The optional key of a model that can have an equation of state.
pub(crate) const EQUATION_OF_STATE: Key = Key {
    name: "equation_of_state",
    unit: "-",
    meaning: "pressure at strong compression, in place of the bulk modulus; needs thermal",
    range: Range::OneOf(EQUATIONS_OF_STATE),
    optional: true,
};

#[cfg(test)]
mod tests {
    use super::*;

    /// OFHC copper, D. J. Steinberg, UCRL-MA-106439 (1996): c_0 = 3940 m/s, s = 1.489, Γ_0 = 2.02.
    fn copper() -> (EquationOfState, Thermal) {
        let thermal = Thermal {
            heat_capacity: 383.0.into(),
            conductivity: 386.0.into(),
            taylor_quinney: 0.9,
            expansion: 0.0,
            reference_temperature: 300.0,
        };
        let law = MieGrueneisen {
            c0: 3940.0,
            s: 1.489,
            gamma0: 2.02,
        };
        (EquationOfState::MieGrueneisen(law), thermal)
    }

    #[test]
    fn shocked_states_obey_the_jump_conditions() {
        let (law, thermal) = copper();
        let state = law.of(8930.0, &thermal);
        for particle_speed in [1.0, 100.0, 500.0, 1000.0, 2000.0, 4000.0] {
            // Jumps of mass, momentum and energy across a shock into material at rest.
            let shock_speed = 3940.0 + 1.489 * particle_speed;
            let jacobian = 1.0 - particle_speed / shock_speed;
            let pressure = 8930.0 * shock_speed * particle_speed;
            let energy = 0.5 * 8930.0 * particle_speed * particle_speed;
            // The temperature at which the material has that energy, and its pressure there.
            let heat = energy - state.volumetric_energy(jacobian);
            let temperature = 300.0 + heat / (8930.0 * 383.0);
            let found = -state.volumetric_stress(jacobian, temperature) / jacobian;
            // Quadrature; round-off of 1 − J, relative to J.
            let tolerance = 1e-11 * pressure + 1e-15 * state.bulk_modulus();
            assert!(
                (found - pressure).abs() < tolerance,
                "{particle_speed} m/s: {found} Pa is not {pressure} Pa"
            );
            assert!(temperature > state.isentropic_temperature(jacobian) - 1e-9);
        }
    }

    #[test]
    fn isentropic_pressure_is_the_derivative_of_its_energy_up_to_the_end_of_the_range() {
        let (law, thermal) = copper();
        let state = law.of(8930.0, &thermal);
        let end = 1.0 - state.smallest_jacobian();
        for compression in [-0.5, -0.1, -5e-3, -1e-3, 1e-3, 0.05, 0.2, 0.4, 0.99 * end] {
            let h = 1e-4;
            let energy = |step: f64| state.isentrope(compression + step * h).1;
            let slope =
                (8.0 * (energy(1.0) - energy(-1.0)) - (energy(2.0) - energy(-2.0))) / (12.0 * h);
            let pressure = state.isentrope(compression).0;
            // The quadrature at the end of the range; truncation h⁴ (s/(1 − s η))⁴ and round-off are less.
            let tolerance = if compression > 0.3 { 1e-9 } else { 1e-11 };
            assert!(
                (slope - pressure).abs() < tolerance * (pressure.abs() + state.bulk_modulus()),
                "{compression}: {slope} Pa is not {pressure} Pa"
            );
        }
        assert_eq!(state.isentrope(1.01 * end).0, f64::INFINITY);
    }

    #[test]
    fn what_it_needs_of_the_thermal_part_is_asked_for() {
        let (law, thermal) = copper();
        assert_eq!(law.validate(Some(&thermal)), Ok(()));
        let warm = Thermal {
            expansion: 1e-5,
            ..thermal.clone()
        };
        let table = Thermal {
            heat_capacity: Property::Table {
                temperatures: vec![300.0, 400.0],
                values: vec![380.0, 390.0],
            },
            ..thermal
        };
        for thermal in [None, Some(&warm), Some(&table)] {
            assert!(matches!(
                law.validate(thermal),
                Err(ParameterError::Needs { .. })
            ));
        }
    }
}
