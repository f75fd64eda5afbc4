//! The registered models: one file each, one line each.

use crate::{
    Block, BlockReader, BlockVisitor, Description, Material, ParameterError, Thermal, WaveSpeeds,
};

/// Makes the module, the case-file variant, the block variant and the conformance tests of each model.
macro_rules! register_materials {
    ($($module:ident :: $model:ident),+ $(,)?) => {
        $(
            mod $module;
            pub use $module::$model;
        )+

        /// A model with its parameters, as in the table `[material.<name>.<model>]` of a case file.
        ///
        /// All numbers are SI; ranges are checked by [`validate`](Self::validate), not by reading.
        #[derive(Clone, Debug, PartialEq, serde::Deserialize, serde::Serialize)]
        #[serde(rename_all = "snake_case")]
        pub enum MaterialSpec {
            $(
                #[doc = concat!("See [`", stringify!($model), "`].")]
                $model($model),
            )+
        }

        /// A run of points of one material, whatever its model.
        #[derive(Clone, Debug)]
        pub enum MaterialBlock {
            $(
                #[doc = concat!("Points of [`", stringify!($model), "`].")]
                $model(Block<$model>),
            )+
        }

        /// Names of the registered models.
        pub const NAMES: &[&str] = &[$($model::NAME),+];

        /// One line about each registered model, in the order of [`NAMES`].
        pub const SUMMARIES: &[&str] = &[$($model::SUMMARY),+];

        /// The registered models with their keys, units and ranges, in the order of [`NAMES`].
        pub const MODELS: &[Description] = &[$(Description {
            name: $model::NAME,
            summary: $model::SUMMARY,
            keys: $model::KEYS,
        }),+];

        impl MaterialSpec {
            /// Name of the model.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $(Self::$model(_) => $model::NAME),+ }
            }

            /// Checks the parameters.
            ///
            /// # Errors
            /// The first key whose value lies outside its range.
            pub fn validate(&self) -> Result<(), ParameterError> {
                match self { $(Self::$model(model) => model.validate()),+ }
            }

            /// ρ, mass per unit reference volume, kg/m³.
            #[must_use]
            pub fn density(&self) -> f64 {
                match self { $(Self::$model(model) => model.density()),+ }
            }

            /// μ of the reference state, Pa.
            #[must_use]
            pub fn shear_modulus(&self) -> f64 {
                match self { $(Self::$model(model) => model.shear_modulus()),+ }
            }

            /// Wave speeds of the reference state.
            #[must_use]
            pub fn wave_speeds(&self) -> WaveSpeeds {
                match self { $(Self::$model(model) => model.wave_speeds()),+ }
            }

            /// Thermal properties, if the model has them.
            #[must_use]
            pub fn thermal(&self) -> Option<&Thermal> {
                match self { $(Self::$model(model) => model.thermal()),+ }
            }

            /// `points` points of this material in their initial state.
            #[must_use]
            pub fn block(&self, points: usize) -> MaterialBlock {
                match self {
                    $(Self::$model(model) => MaterialBlock::$model(Block::new(model.clone(), points)),)+
                }
            }
        }

        impl MaterialBlock {
            /// Calls the visitor with the typed block.
            pub fn visit<V: BlockVisitor>(&mut self, visitor: &mut V) -> V::Output {
                match self { $(Self::$model(block) => visitor.visit(block)),+ }
            }

            /// Calls the reader with the typed block.
            pub fn visit_ref<V: BlockReader>(&self, reader: &mut V) -> V::Output {
                match self { $(Self::$model(block) => reader.visit(block)),+ }
            }

            /// Accepts the latest evaluation, see [`Block::commit`].
            pub fn commit(&mut self) {
                match self { $(Self::$model(block) => block.commit()),+ }
            }

            /// Accepts the latest evaluation of some points, see [`Block::commit_points`].
            ///
            /// # Panics
            /// If there are no such points.
            pub fn commit_points(&mut self, points: std::ops::Range<usize>) {
                match self { $(Self::$model(block) => block.commit_points(points)),+ }
            }
        }

        #[cfg(test)]
        mod conformance_of_registered_models {
            $(mod $module {
                crate::conformance::conformance_tests!(crate::models::$model);

                #[test]
                fn table_has_the_described_keys() {
                    use crate::{Material, models::{$model, MaterialSpec}};
                    for model in $model::examples() {
                        let spec = MaterialSpec::$model(model);
                        crate::conformance::table_has_the_described_keys(&spec, $model::NAME, $model::KEYS);
                    }
                }
            })+
        }
    };
}

register_materials! {
    hencky_von_mises::HenckyVonMises,
    hencky::Hencky,
    neo_hookean::NeoHookean,
    mooney_rivlin::MooneyRivlin,
    st_venant_kirchhoff::StVenantKirchhoff,
}
