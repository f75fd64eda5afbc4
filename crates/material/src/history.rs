//! What a point remembers of its deformation.

use jstsph_tensor::Mat3;
use std::fmt::Debug;

/// The history of one point: a plain value that a model reads and returns anew.
pub trait History: Copy + Debug + PartialEq + Send + Sync + 'static {
    /// Names of the numbers [`write`](Self::write) gives, as they appear in output and restart.
    const FIELDS: &'static [&'static str];

    /// Writes one number per field.
    ///
    /// # Panics
    /// If `columns` has fewer entries than [`FIELDS`](Self::FIELDS): a bug in the caller.
    fn write(&self, columns: &mut [f64]);

    /// The inverse of [`write`](Self::write), bit for bit.
    ///
    /// # Panics
    /// If `columns` has fewer entries than [`FIELDS`](Self::FIELDS): a bug in the caller.
    fn read(columns: &[f64]) -> Self;

    /// ε_p, accumulated; zero for elastic models.
    fn equivalent_plastic_strain(&self) -> f64;

    /// D, from 0 to 1, where the metal has failed; zero for models without damage.
    fn damage(&self) -> f64 {
        0.0
    }

    /// C_p⁻¹; the identity for elastic models.
    fn inverse_plastic_cauchy_green(&self) -> Mat3;
}

/// Nothing to remember: elastic models.
impl History for () {
    const FIELDS: &'static [&'static str] = &[];

    fn write(&self, _columns: &mut [f64]) {}

    fn read(_columns: &[f64]) -> Self {}

    fn equivalent_plastic_strain(&self) -> f64 {
        0.0
    }

    fn inverse_plastic_cauchy_green(&self) -> Mat3 {
        Mat3::identity()
    }
}

/// History of isotropic finite-strain plasticity, Greto & Kulasegaram 2019, Appendix A: C_p⁻¹ and
/// ε_p, and the damage. Eight numbers: one point fills a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticHistory {
    /// ε_p, accumulated.
    pub equivalent_plastic_strain: f64,
    /// C_p⁻¹ as 11, 22, 33, 12, 13, 23.
    components: [f64; 6],
    /// D, from 0 to 1, where the metal has failed.
    pub damage: f64,
}

impl PlasticHistory {
    /// No plastic deformation yet: C_p⁻¹ = 1, ε_p = 0, D = 0.
    pub const INITIAL: Self = Self {
        equivalent_plastic_strain: 0.0,
        components: [1.0, 1.0, 1.0, 0.0, 0.0, 0.0],
        damage: 0.0,
    };

    /// From ε_p and C_p⁻¹, of which the upper triangle is read; undamaged.
    #[inline]
    #[must_use]
    pub fn new(equivalent_plastic_strain: f64, inverse_plastic_cauchy_green: &Mat3) -> Self {
        let c = inverse_plastic_cauchy_green;
        Self {
            equivalent_plastic_strain,
            components: [c.m11, c.m22, c.m33, c.m12, c.m13, c.m23],
            damage: 0.0,
        }
    }

    /// C_p⁻¹ as 11, 22, 33, 12, 13, 23.
    #[inline]
    pub(crate) fn components(&self) -> &[f64; 6] {
        &self.components
    }

    /// Undamaged, from ε_p and C_p⁻¹ as 11, 22, 33, 12, 13, 23.
    #[inline]
    pub(crate) fn from_components(equivalent_plastic_strain: f64, components: [f64; 6]) -> Self {
        Self {
            equivalent_plastic_strain,
            components,
            damage: 0.0,
        }
    }

    /// The same with a damage D.
    #[inline]
    #[must_use]
    pub fn with_damage(self, damage: f64) -> Self {
        Self { damage, ..self }
    }
}

impl History for PlasticHistory {
    const FIELDS: &'static [&'static str] = &[
        "equivalent_plastic_strain",
        "inverse_plastic_cauchy_green_11",
        "inverse_plastic_cauchy_green_22",
        "inverse_plastic_cauchy_green_33",
        "inverse_plastic_cauchy_green_12",
        "inverse_plastic_cauchy_green_13",
        "inverse_plastic_cauchy_green_23",
        "damage",
    ];

    fn write(&self, columns: &mut [f64]) {
        columns[0] = self.equivalent_plastic_strain;
        columns[1..7].copy_from_slice(&self.components);
        columns[7] = self.damage;
    }

    fn read(columns: &[f64]) -> Self {
        let mut components = [0.0; 6];
        components.copy_from_slice(&columns[1..7]);
        Self {
            equivalent_plastic_strain: columns[0],
            components,
            damage: columns[7],
        }
    }

    #[inline]
    fn equivalent_plastic_strain(&self) -> f64 {
        self.equivalent_plastic_strain
    }

    #[inline]
    fn damage(&self) -> f64 {
        self.damage
    }

    #[inline]
    fn inverse_plastic_cauchy_green(&self) -> Mat3 {
        let [m11, m22, m33, m12, m13, m23] = self.components;
        Mat3::new(m11, m12, m13, m12, m22, m23, m13, m23, m33)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plastic_history_survives_a_round_trip_and_lists_its_columns_in_order() {
        let c = Mat3::new(1.1, 0.4, 0.5, 0.4, 1.2, 0.6, 0.5, 0.6, 1.3);
        let history = PlasticHistory::new(0.7, &c).with_damage(0.2);
        let mut columns = [0.0; PlasticHistory::FIELDS.len()];
        history.write(&mut columns);
        assert_eq!(columns, [0.7, 1.1, 1.2, 1.3, 0.4, 0.5, 0.6, 0.2]);
        assert_eq!(PlasticHistory::read(&columns), history);
        assert_eq!(history.inverse_plastic_cauchy_green(), c);
    }
}
