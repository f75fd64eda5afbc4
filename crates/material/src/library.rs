//! Parameter sets that come with the crate.

use crate::hardening::{Hardening, JohnsonCook, Linear, Swift};
use crate::models::{HenckyVonMises, MaterialSpec, NeoHookean};
use crate::{ROOM_TEMPERATURE, Thermal};
use std::sync::LazyLock;

/// A parameter set with its name and the place its numbers come from.
#[derive(Clone, Debug)]
pub struct NamedMaterial {
    /// Name by which a case may refer to it, `snake_case`.
    pub name: &'static str,
    /// Model and parameters.
    pub spec: MaterialSpec,
    /// Where every number comes from.
    pub source: &'static str,
}

const JOHNSON_COOK: &str = "Johnson & Cook 1983 (strength, density, heat capacity, melting point); moduli, \
     conductivity, expansion: ASM Metals Handbook, at 20 degC; 0.9 of the plastic work becomes heat";

/// A, B, Pa, n, C, m and the melting point, K, measured at 1/s and room temperature.
fn strength([a, b, n, c, m]: [f64; 5], melting_temperature: f64) -> Hardening {
    Hardening::JohnsonCook(JohnsonCook {
        a,
        b,
        n,
        c,
        m,
        reference_rate: 1.0,
        reference_temperature: ROOM_TEMPERATURE,
        melting_temperature,
        slow_rates_soften: false,
    })
}

/// Heat capacity, J/(kg K), conductivity, W/(m K), and expansion, 1/K, of a body that is free of
/// stress at room temperature.
fn room_temperature(heat_capacity: f64, conductivity: f64, expansion: f64) -> Thermal {
    Thermal {
        heat_capacity: heat_capacity.into(),
        conductivity: conductivity.into(),
        taylor_quinney: 0.9,
        expansion,
        reference_temperature: ROOM_TEMPERATURE,
    }
}

fn metal(cold: HenckyVonMises, thermal: Thermal) -> MaterialSpec {
    MaterialSpec::HenckyVonMises(HenckyVonMises {
        thermal: Some(thermal),
        ..cold
    })
}

/// The aluminium of Ba & Gakwaya with its rate factor C and its exponent m of thermal softening.
fn ba_gakwaya(c: f64, m: f64) -> MaterialSpec {
    let hardening = Hardening::JohnsonCook(JohnsonCook {
        a: 420e6,
        b: 465e6,
        n: 0.5088,
        c,
        m,
        reference_rate: 0.1,
        reference_temperature: 298.15,
        melting_temperature: 914.15,
        slow_rates_soften: false,
    });
    metal(
        HenckyVonMises::new(2810.0, 71.7e9, 0.33, hardening),
        Thermal {
            reference_temperature: 673.15,
            ..room_temperature(960.0, 130.0, 23.6e-6)
        },
    )
}

static LIBRARY: LazyLock<Vec<NamedMaterial>> = LazyLock::new(|| {
    vec![
        NamedMaterial {
            name: "copper_taylor",
            spec: MaterialSpec::HenckyVonMises(HenckyVonMises::new(
                8930.0,
                117e9,
                0.35,
                Hardening::Linear(Linear {
                    initial_yield_stress: 0.4e9,
                    modulus: 0.1e9,
                }),
            )),
            source: "Greto & Kulasegaram 2019, Sect. 4.1 and 4.2 (Taylor bar, constrained block)",
        },
        NamedMaterial {
            name: "al1100_ecae",
            spec: MaterialSpec::HenckyVonMises(HenckyVonMises::new(
                2800.0,
                69e9,
                0.33,
                Hardening::Swift(Swift {
                    coefficient: 159e6,
                    offset: 0.02,
                    exponent: 0.27,
                }),
            )),
            source: "Greto & Kulasegaram 2019, Sect. 4.3 (equal channel angular extrusion)",
        },
        NamedMaterial {
            name: "rubber",
            spec: MaterialSpec::NeoHookean(NeoHookean {
                density: 1100.0,
                young_modulus: 17e6,
                poisson_ratio: 0.45,
            }),
            source: "Lee, Gil & Bonet, Computers & Structures 118 (2013), benchmarks of large elastic deformation",
        },
        NamedMaterial {
            name: "ofhc_copper",
            spec: metal(
                HenckyVonMises::new(
                    8960.0,
                    124e9,
                    0.34,
                    strength([90e6, 292e6, 0.31, 0.025, 1.09], 1356.0),
                ),
                room_temperature(383.0, 386.0, 16.5e-6),
            ),
            source: JOHNSON_COOK,
        },
        NamedMaterial {
            name: "armco_iron",
            spec: metal(
                HenckyVonMises::new(
                    7890.0,
                    207e9,
                    0.29,
                    strength([175e6, 380e6, 0.32, 0.060, 0.55], 1811.0),
                ),
                room_temperature(452.0, 73.0, 11.8e-6),
            ),
            source: JOHNSON_COOK,
        },
        NamedMaterial {
            name: "steel_4340",
            spec: metal(
                HenckyVonMises::new(
                    7830.0,
                    205e9,
                    0.29,
                    strength([792e6, 510e6, 0.26, 0.014, 1.03], 1793.0),
                ),
                room_temperature(477.0, 44.5, 12.3e-6),
            ),
            source: JOHNSON_COOK,
        },
        NamedMaterial {
            name: "aluminium_ba_gakwaya",
            spec: ba_gakwaya(0.081, 0.862),
            source: "Ba & Gakwaya, Table 1, with its values of c and m exchanged, which gives the usual \
                     sizes of both; elastic and thermal constants: aluminium 7075, ASM Metals Handbook vol. 2; \
                     free of stress at the 400 degC of the tests",
        },
        NamedMaterial {
            name: "aluminium_ba_gakwaya_as_printed",
            spec: ba_gakwaya(0.862, 0.081),
            source: "Ba & Gakwaya, Table 1, as printed; the rest as aluminium_ba_gakwaya",
        },
    ]
});

/// The shipped parameter sets, with their sources.
#[must_use]
pub fn library() -> &'static [NamedMaterial] {
    &LIBRARY
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_is_valid_and_named_once() {
        for (i, entry) in library().iter().enumerate() {
            assert_eq!(entry.spec.validate(), Ok(()), "{}", entry.name);
            assert!(library()[..i].iter().all(|other| other.name != entry.name));
        }
    }

    #[test]
    fn copper_has_the_wave_speeds_of_its_moduli() {
        // By hand: κ = 130 GPa, μ = 43.33 GPa, so c_p = √(187.78e9/8930) = 4585.6 m/s, c_s = 2202.9 m/s.
        let speeds = library()[0].spec.wave_speeds();
        assert!((speeds.pressure - 4585.6).abs() < 0.1, "{speeds:?}");
        assert!((speeds.shear - 2202.9).abs() < 0.1, "{speeds:?}");
    }
}
