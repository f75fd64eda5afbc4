//! Isotropic hardening laws: flow stress as a function of the equivalent plastic strain, its rate and
//! the temperature. One file each, one line each; every plastic model can use every law.
//!
//! A law never softens with strain: in a local continuum softening concentrates in one row of points, whatever
//! their spacing, and the answer depends on the spacing. [`HardeningLaw::validate`] refuses it.

use crate::return_map::{TileProblem, TileReturn, TileSolution};
use crate::{Description, Key, ParameterError};
use jstsph_tensor::lanes::{Lanes, Simd, TILE, vectorised};
use std::fmt::Debug;

/// The state on which a flow stress depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowState {
    /// ε_p ≥ 0.
    pub plastic_strain: f64,
    /// dε_p/dt ≥ 0, 1/s: in a step Δε_p/Δt. Zero where yield is tested.
    pub rate: f64,
    /// T, K.
    pub temperature: f64,
}

/// Flow stress and its derivatives at one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowStress {
    /// σ_Y, Pa. Zero only for molten metal, then at all strains and rates.
    pub value: f64,
    /// ∂σ_Y/∂ε_p, Pa; may be infinite at ε_p = 0.
    pub slope: f64,
    /// ∂σ_Y/∂(dε_p/dt), Pa s; may be infinite at rate 0.
    pub rate_slope: f64,
}

impl FlowStress {
    /// Of a law that does not depend on the rate.
    #[inline]
    #[must_use]
    pub fn rate_independent(value: f64, slope: f64) -> Self {
        Self {
            value,
            slope,
            rate_slope: 0.0,
        }
    }
}

/// Flow stresses and slopes of several points, one per lane, for laws that depend on the plastic strain
/// alone.
#[derive(Clone, Copy, Debug)]
pub struct FlowLanes<S: Simd> {
    /// σ_Y, Pa.
    pub value: Lanes<S>,
    /// dσ_Y/dε_p, Pa.
    pub slope: Lanes<S>,
}

/// Flow stress as a function of the equivalent plastic strain, its rate and the temperature.
pub trait HardeningLaw: Clone + Debug + Send + Sync + 'static {
    /// Name in a case file.
    const NAME: &'static str;
    /// One line: the formula.
    const SUMMARY: &'static str;
    /// The keys of the law's table.
    const KEYS: &'static [Key];

    /// Checks the parameters: positive initial flow stress, no softening with strain or rate.
    ///
    /// # Errors
    /// The first key whose value cannot be used.
    fn validate(&self) -> Result<(), ParameterError>;

    /// σ_Y and its slopes.
    fn flow_stress(&self, at: &FlowState) -> FlowStress;

    /// σ_Y and its slopes at `at`, to round-off, from those at the plastic strain `from`, for laws
    /// that find them sooner so where the strains are near each other.
    #[inline]
    fn flow_stress_near(&self, _start: &FlowStress, _from: f64, at: &FlowState) -> FlowStress {
        self.flow_stress(at)
    }

    /// Whether the law depends on the plastic strain alone and works on many points at once: with
    /// [`flow_stress_tile`](Self::flow_stress_tile) and [`flow_stress_lanes`](Self::flow_stress_lanes).
    const ON_LANES: bool = false;

    /// σ_Y and its slope of a tile of plastic strains: the bits of [`flow_stress`](Self::flow_stress).
    #[inline(always)]
    fn flow_stress_tile<S: Simd>(
        &self,
        _simd: S,
        plastic_strain: &[f64; TILE],
        [value, slope]: [&mut [f64; TILE]; 2],
    ) {
        for i in 0..TILE {
            let flow = self.flow_stress(&FlowState {
                plastic_strain: plastic_strain[i],
                rate: 0.0,
                temperature: crate::ROOM_TEMPERATURE,
            });
            (value[i], slope[i]) = (flow.value, flow.slope);
        }
    }

    /// The bits of [`flow_stress_near`](Self::flow_stress_near), or no number in lanes that this way
    /// of working does not reach; no number at all from laws that do not work so.
    #[inline(always)]
    fn flow_stress_lanes<S: Simd>(
        &self,
        simd: S,
        _start: &FlowLanes<S>,
        _from: Lanes<S>,
        _at: Lanes<S>,
    ) -> FlowLanes<S> {
        let none = Lanes::splat(simd, f64::NAN);
        FlowLanes {
            value: none,
            slope: none,
        }
    }

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

            /// σ_Y and its slopes.
            // A call here costs the plastic update of the simple laws 5 to 10 % (measured).
            #[inline(always)]
            #[must_use]
            pub fn flow_stress(&self, at: &FlowState) -> FlowStress {
                match self { $(Self::$law(law) => law.flow_stress(at)),+ }
            }

            /// σ_Y and its slopes at `at`, from those at the plastic strain `from`, rate zero and the
            /// same temperature: to round-off those of [`flow_stress`](Self::flow_stress).
            #[inline(always)]
            #[must_use]
            pub fn flow_stress_near(
                &self,
                start: &FlowStress,
                from: f64,
                at: &FlowState,
            ) -> FlowStress {
                match self { $(Self::$law(law) => law.flow_stress_near(start, from, at)),+ }
            }

            /// Solves the equations of radial return of a tile in the law's lanes; false if it has none.
            #[inline]
            pub(crate) fn solve_tile(&self, problem: &TileProblem, solution: &mut TileSolution) -> bool {
                match self {
                    $(Self::$law(law) if $law::ON_LANES => {
                        vectorised(TileReturn { law, problem, solution });
                        true
                    })+
                    _ => false,
                }
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
    johnson_cook::JohnsonCook,
    zerilli_armstrong::ZerilliArmstrong,
}

const INITIAL_YIELD_STRESS: Key = Key {
    name: "initial_yield_stress",
    unit: "Pa",
    meaning: "flow stress of undeformed material",
    range: crate::Range::Positive,
    optional: false,
};

pub(crate) use johnson_cook::{check_melting, homologous_temperature};

#[cfg(test)]
mod conformance;
