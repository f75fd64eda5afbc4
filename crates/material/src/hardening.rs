//! Isotropic hardening laws: flow stress as a function of the equivalent plastic strain, its rate and
//! the temperature. One file each, one line each; every plastic model can use every law.
//!
//! A law never softens with strain: in a local continuum softening concentrates in one row of points, whatever
//! their spacing, and the answer depends on the spacing. [`HardeningLaw::validate`] refuses it.

use crate::return_map::{TileProblem, TileReturn, TileSolution};
use crate::{Description, Key, ParameterError};
use jstsph_tensor::lanes::{Simd, TILE, vectorised};
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

/// The states of [`TILE`] points; see [`FlowState`].
#[derive(Clone, Debug)]
pub struct FlowStateTile {
    /// ε_p ≥ 0.
    pub plastic_strain: [f64; TILE],
    /// dε_p/dt ≥ 0, 1/s.
    pub rate: [f64; TILE],
    /// T, K.
    pub temperature: [f64; TILE],
}

impl FlowStateTile {
    /// One of the points.
    #[inline(always)]
    fn at(&self, i: usize) -> FlowState {
        FlowState {
            plastic_strain: self.plastic_strain[i],
            rate: self.rate[i],
            temperature: self.temperature[i],
        }
    }
}

/// The flow stresses of [`TILE`] points and their derivatives; see [`FlowStress`].
#[derive(Clone, Debug)]
pub struct FlowStressTile {
    /// σ_Y, Pa.
    pub value: [f64; TILE],
    /// ∂σ_Y/∂ε_p, Pa.
    pub slope: [f64; TILE],
    /// ∂σ_Y/∂(dε_p/dt), Pa s.
    pub rate_slope: [f64; TILE],
}

impl FlowStressTile {
    /// A buffer to fill.
    pub const ZERO: Self = Self {
        value: [0.0; TILE],
        slope: [0.0; TILE],
        rate_slope: [0.0; TILE],
    };

    /// One of the points.
    #[inline(always)]
    fn at(&self, i: usize) -> FlowStress {
        FlowStress {
            value: self.value[i],
            slope: self.slope[i],
            rate_slope: self.rate_slope[i],
        }
    }

    #[inline(always)]
    fn set(&mut self, i: usize, flow: FlowStress) {
        self.value[i] = flow.value;
        self.slope[i] = flow.slope;
        self.rate_slope[i] = flow.rate_slope;
    }
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

    /// Whether σ_Y depends on the rate; what does not need not look for it.
    const RATE_DEPENDENT: bool = false;

    /// [`flow_stress`](Self::flow_stress) of many points, with the same bits, in the instruction set of
    /// the function it is inlined into. Laws that are more than a few products do it on vectors.
    #[inline(always)]
    fn flow_stress_tile<S: Simd>(&self, _simd: S, at: &FlowStateTile, out: &mut FlowStressTile) {
        for i in 0..TILE {
            out.set(i, self.flow_stress(&at.at(i)));
        }
    }

    /// [`flow_stress_near`](Self::flow_stress_near) of many points, with the same bits.
    #[inline(always)]
    fn flow_stress_near_tile<S: Simd>(
        &self,
        simd: S,
        _start: &FlowStressTile,
        _from: &[f64; TILE],
        at: &FlowStateTile,
        out: &mut FlowStressTile,
    ) {
        self.flow_stress_tile(simd, at, out);
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

            /// Solves the equations of radial return of a tile.
            #[inline]
            pub(crate) fn solve_tile(&self, problem: &TileProblem, solution: &mut TileSolution) {
                match self {
                    $(Self::$law(law) => vectorised(TileReturn { law, problem, solution })),+
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

mod power_term;

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
