//! Parameter sets that come with the crate.

use crate::hardening::{Hardening, Linear, Swift};
use crate::models::{HenckyVonMises, MaterialSpec, NeoHookean};
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
