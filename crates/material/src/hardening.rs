//! Isotropic hardening laws: flow stress as a function of the equivalent plastic strain. One file
//! each, one line each; every plastic model can use every law.
//!
//! A law never softens: in a local continuum softening concentrates in one row of points, whatever
//! their spacing, and the answer depends on the spacing. [`HardeningLaw::validate`] refuses it.

use crate::{Description, Key, ParameterError};
use std::fmt::Debug;

/// Flow stress and its derivative at one equivalent plastic strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowStress {
    /// σ_Y, Pa.
    pub value: f64,
    /// dσ_Y/dε_p, Pa; may be infinite at ε_p = 0.
    pub slope: f64,
}

/// Flow stress as a function of the equivalent plastic strain.
pub trait HardeningLaw: Clone + Debug + Send + Sync + 'static {
    /// Name in a case file.
    const NAME: &'static str;
    /// One line: the formula.
    const SUMMARY: &'static str;
    /// The keys of the law's table.
    const KEYS: &'static [Key];

    /// Checks the parameters: positive initial flow stress, no softening.
    ///
    /// # Errors
    /// The first key whose value cannot be used.
    fn validate(&self) -> Result<(), ParameterError>;

    /// σ_Y and its slope at ε_p ≥ 0.
    fn flow_stress(&self, plastic_strain: f64) -> FlowStress;

    /// Parameter sets on which the conformance tests run.
    fn examples() -> Vec<Self>;
}

macro_rules! register_hardening_laws {
    ($($module:ident :: $law:ident),+ $(,)?) => {
        $(
            mod $module;
            pub use $module::$law;
        )+

        /// A law with its parameters, as in `hardening = { <law> = { ... } }` of a case file.
        #[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Hardening {
            $(
                #[doc = concat!("See [`", stringify!($law), "`].")]
                $law($law),
            )+
        }

        /// The registered laws with their keys, units and ranges.
        pub const LAWS: &[Description] = &[$(Description {
            name: $law::NAME,
            summary: $law::SUMMARY,
            keys: $law::KEYS,
        }),+];

        impl Hardening {
            /// Name of the law.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$law(_) => $law::NAME),+ }
            }

            /// Checks the parameters.
            ///
            /// # Errors
            /// The first key that cannot be used, as `<law>.<key>`.
            pub fn validate(&self) -> Result<(), ParameterError> {
                match self {
                    $(Self::$law(law) => law.validate().map_err(|error| error.within($law::NAME))),+
                }
            }

            /// σ_Y and its slope at ε_p ≥ 0.
            #[inline]
            #[must_use]
            pub fn flow_stress(&self, plastic_strain: f64) -> FlowStress {
                match self { $(Self::$law(law) => law.flow_stress(plastic_strain)),+ }
            }

            /// Examples of every law.
            #[must_use]
            pub fn examples() -> Vec<Self> {
                let mut examples = Vec::new();
                $(examples.extend($law::examples().into_iter().map(Self::$law));)+
                examples
            }
        }

        #[cfg(test)]
        mod conformance_of_registered_laws {
            $(mod $module {
                #[test]
                fn conforms() {
                    super::super::conformance::check::<super::super::$law>();
                }
            })+
        }
    };
}

register_hardening_laws! {
    perfect::Perfect,
    linear::Linear,
    swift::Swift,
    voce::Voce,
    ludwik::Ludwik,
    tabulated::Tabulated,
}

const INITIAL_YIELD_STRESS: Key = Key {
    name: "initial_yield_stress",
    unit: "Pa",
    meaning: "flow stress of undeformed material",
    range: crate::Range::Positive,
};

#[cfg(test)]
mod conformance;
