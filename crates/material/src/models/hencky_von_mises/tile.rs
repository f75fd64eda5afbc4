//! The response of many points at once: tensor algebra and radial return on vectors of points. Same formulas, same order, same bits as `respond`.

use super::HenckyVonMises;
use super::flow::Flow;
use super::series::series;
use crate::logarithmic_strain::{
    LONG_EXPONENTIAL, LONG_LOGARITHM, SERIES_LIMIT, SHORT_EXPONENTIAL, SHORT_LOGARITHM,
};
use crate::{KinematicsTile, PlasticHistory, ResponseTile};
use jstsph_tensor::lanes::{
    LaneSymmetric, LaneTensor, Lanes, PlaneLanes, Simd, SymmetricTile, TILE, TensorLanes, TensorTile,
    WithSimd, vectorised,
};

/// See [`Material::respond_tile`](crate::Material::respond_tile).
pub(super) fn respond(
    model: &HenckyVonMises,
    now: &KinematicsTile,
    old: &[PlasticHistory],
    new: &mut [PlasticHistory],
    response: &mut ResponseTile,
) -> bool {
    let (old, new) = (&old[..TILE], &mut new[..TILE]);
    if old.iter().any(|history| model.has_failed(history)) || !model.bears_compression(now) {
        return false;
    }
    let shear_modulus = model.elastic().shear_moduli(&now.temperature);
    let mut inverse_plastic = [[0.0; TILE]; 6];
    let mut trial = Trial::ZERO;
    trial.evaluate(&shear_modulus, now, old, &mut inverse_plastic);
    let Some(flow) = Flow::of(model, &shear_modulus, now, old, &trial) else {
        return false;
    };
    if !flow.plastic {
        response.kirchhoff_stress = trial.stress;
        response.plastic_work = [0.0; TILE];
        new.copy_from_slice(old);
        return true;
    }
    vectorised(Update {
        plane: now.plane,
        deformation_gradient: &now.deformation_gradient,
        trial: &trial,
        flow: &flow,
        inverse_plastic: &mut inverse_plastic,
        stress: &mut response.kirchhoff_stress,
    });
    response.plastic_work = flow.plastic_work;
    for (i, (new, old)) in new.iter_mut().zip(old).enumerate() {
        *new = PlasticHistory::from_components(
            old.equivalent_plastic_strain + flow.increment[i],
            components_of(&inverse_plastic, i),
        )
        .with_damage(old.damage);
    }
    if let Some(damage) = &model.damage {
        for (i, (new, old)) in new.iter_mut().zip(old).enumerate() {
            let (increment, stress) = (flow.increment[i], flow.equivalent_stress[i]);
            if increment > 0.0 {
                let state = [now.jacobian[i], now.temperature[i], now.dt];
                new.damage = model.damage_after(damage, state, old.damage, increment, stress);
            }
        }
    }
    true
}

/// See [`Material::point_energies_tile`](crate::Material::point_energies_tile): μ |dev ε_e|², with what
/// the trial stress of the next step is, τ_eq²/(6 μ).
pub(super) fn energies(
    model: &HenckyVonMises,
    now: &KinematicsTile,
    history: &[PlasticHistory],
    energies: &mut [f64; TILE],
) -> bool {
    let shear_modulus = model.elastic().shear_moduli(&now.temperature);
    let mut trial = Trial::ZERO;
    trial.evaluate(&shear_modulus, now, &history[..TILE], &mut [[0.0; TILE]; 6]);
    let stresses = trial.equivalent_stress.iter().zip(&shear_modulus);
    for (energy, (stress, shear_modulus)) in energies.iter_mut().zip(stresses) {
        *energy = stress * stress / (6.0 * shear_modulus);
    }
    let mut points = trial.determinant.iter().zip(&trial.distortion);
    points.all(|(determinant, distortion)| *determinant > 0.0 && *distortion < SERIES_LIMIT)
}

#[inline(always)]
fn components_of(tile: &SymmetricTile, i: usize) -> [f64; 6] {
    let mut components = [0.0; 6];
    for k in 0..6 {
        components[k] = tile[k][i];
    }
    components
}

/// The elastic trial.
pub(super) struct Trial {
    pub(super) determinant: [f64; TILE],
    /// F C_p⁻¹ Fᵀ.
    b: SymmetricTile,
    /// Squared distance of b/(⅓ tr b) from 1, not a number where b is not positive.
    pub(super) distortion: [f64; TILE],
    stress: SymmetricTile,
    pub(super) equivalent_stress: [f64; TILE],
}

impl Trial {
    const ZERO: Self = Self {
        determinant: [0.0; TILE],
        b: [[0.0; TILE]; 6],
        distortion: [0.0; TILE],
        stress: [[0.0; TILE]; 6],
        equivalent_stress: [0.0; TILE],
    };
}

impl Trial {
    /// The trial of points with these histories, whose C_p⁻¹ are left in `inverse_plastic`.
    #[inline(always)]
    fn evaluate(
        &mut self,
        shear_modulus: &[f64; TILE],
        now: &KinematicsTile,
        old: &[PlasticHistory],
        inverse_plastic: &mut SymmetricTile,
    ) {
        for (i, history) in old.iter().enumerate() {
            for (tile, component) in inverse_plastic.iter_mut().zip(history.components()) {
                tile[i] = *component;
            }
        }
        vectorised(TrialStress {
            plane: now.plane,
            shear_modulus,
            deformation_gradient: &now.deformation_gradient,
            inverse_plastic,
            trial: self,
        });
    }
}

struct TrialStress<'a> {
    plane: bool,
    shear_modulus: &'a [f64; TILE],
    deformation_gradient: &'a TensorTile,
    inverse_plastic: &'a SymmetricTile,
    trial: &'a mut Trial,
}

impl WithSimd for TrialStress<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.plane {
            self.evaluate::<S, PlaneLanes<S>>(simd);
        } else {
            self.evaluate::<S, TensorLanes<S>>(simd);
        }
    }
}

impl TrialStress<'_> {
    #[inline(always)]
    fn evaluate<S: Simd, T: LaneTensor<S>>(self, simd: S) {
        let trial = self.trial;
        for pack in 0..TILE / S::F64_LANES {
            let f = T::load(simd, self.deformation_gradient, pack);
            f.determinant().store(&mut trial.determinant, pack);
            let c = T::Symmetric::load(simd, self.inverse_plastic, pack);
            let b = f.congruence(&T::of_symmetric(&c));
            b.store(&mut trial.b, pack);

            let one = Lanes::splat(simd, 1.0);
            let scale = b.trace().over(Lanes::splat(simd, 3.0)).inverse();
            let a = b.scaled(scale).plus_identity(-one);
            let j2 = a.norm_squared() * 0.5;
            let distortion = j2 * 2.0;
            let nan = Lanes::splat(simd, f64::NAN);
            scale
                .if_less(0.0, nan, distortion)
                .store(&mut trial.distortion, pack);
            let (square, j3) = a.square_and_determinant();
            let [_, c1, c2] = series(simd, &SHORT_LOGARITHM, &LONG_LOGARITHM, distortion, j2, j3);
            let c0 = (-c2 * j2).over(Lanes::splat(simd, 3.0));
            let strain = a.combination(&square, [c0, c1 * 0.5, c2 * 0.5]);
            let stiffness = Lanes::load(simd, self.shear_modulus, pack) * 2.0;
            let stress = strain.scaled(stiffness);
            stress.store(&mut trial.stress, pack);
            (stress.norm_squared() * 1.5)
                .sqrt()
                .store(&mut trial.equivalent_stress, pack);
        }
    }
}

struct Update<'a> {
    plane: bool,
    deformation_gradient: &'a TensorTile,
    trial: &'a Trial,
    flow: &'a Flow,
    inverse_plastic: &'a mut SymmetricTile,
    stress: &'a mut SymmetricTile,
}

impl WithSimd for Update<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.plane {
            self.evaluate::<S, PlaneLanes<S>>(simd);
        } else {
            self.evaluate::<S, TensorLanes<S>>(simd);
        }
    }
}

impl Update<'_> {
    #[inline(always)]
    fn evaluate<S: Simd, T: LaneTensor<S>>(self, simd: S) {
        for pack in 0..TILE / S::F64_LANES {
            let trial_stress = T::Symmetric::load(simd, &self.trial.stress, pack);
            let direction = trial_stress.scaled(Lanes::load(simd, &self.flow.direction, pack));
            let j2 = direction.norm_squared() * 0.5;
            let (square, j3) = direction.square_and_determinant();
            let coefficients = series(
                simd,
                &SHORT_EXPONENTIAL,
                &LONG_EXPONENTIAL,
                j2 * 2.0,
                j2,
                j3,
            );
            let exponential_less_one = direction.combination(&square, coefficients);
            let b = T::Symmetric::load(simd, &self.trial.b, pack);
            let b_change = T::of_symmetric(&b).product(&T::of_symmetric(&exponential_less_one));

            let f = T::load(simd, self.deformation_gradient, pack);
            let inverse_determinant = Lanes::load(simd, &self.trial.determinant, pack).inverse();
            let f_inverse = f.cofactor().transposed(inverse_determinant);
            let change = f_inverse.congruence(&b_change);
            let old = T::Symmetric::load(simd, self.inverse_plastic, pack);
            old.plus(&change).store(self.inverse_plastic, pack);

            let ratio = Lanes::load(simd, &self.flow.ratio, pack);
            trial_stress.scaled(ratio).store(self.stress, pack);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kinematics, Material};
    use jstsph_tensor::Mat3;

    /// Points around a deformation they have flowed to, strained on by up to `size`.
    fn points(
        model: &HenckyVonMises,
        plane: bool,
        size: f64,
    ) -> (Vec<Kinematics>, Vec<PlasticHistory>) {
        (0..TILE)
            .map(|i| {
                let wave = |phase: f64| (1.3 * i as f64 + phase).sin();
                let f = |extra: f64| {
                    Mat3::from_fn(|r, c| {
                        let identity = if r == c { 1.0 } else { 0.0 };
                        if plane && (r == 2 || c == 2) {
                            return identity;
                        }
                        identity
                            + 0.2 * wave((2 * r + 5 * c) as f64)
                            + extra * wave((7 * r + 3 * c + 1) as f64)
                    })
                };
                let kinematics = |f: Mat3| Kinematics {
                    deformation_gradient: f,
                    jacobian: f.determinant() * (1.0 + 1e-3 * wave(0.5)),
                    dt: 1e-7,
                    temperature: crate::ROOM_TEMPERATURE + i as f64,
                };
                let flowed = model.respond(&kinematics(f(0.0)), &model.initial_history());
                (kinematics(f(size * i as f64 / TILE as f64)), flowed.unwrap().history)
            })
            .unzip()
    }

    fn tile_of(points: &[Kinematics], plane: bool) -> KinematicsTile {
        let mut tile = KinematicsTile {
            plane,
            ..KinematicsTile::new(points[0].dt)
        };
        let gradients: Vec<Mat3> = points.iter().map(|p| p.deformation_gradient).collect();
        tile.deformation_gradient.read(&gradients);
        for (i, point) in points.iter().enumerate() {
            tile.jacobian[i] = point.jacobian;
            tile.temperature[i] = point.temperature;
        }
        tile
    }

    #[test]
    fn tiles_have_the_bits_of_single_points() {
        let models = HenckyVonMises::examples();
        for (model, plane) in models.iter().flat_map(|model| [(model, false), (model, true)]) {
            // All elastic, mixed, long and short series together.
            for size in [1e-5, 1e-3, 1e-2, 4e-2] {
                let (now, old) = points(model, plane, size);
                let (mut new, mut response) = (old.clone(), ResponseTile::ZERO);
                let tile = tile_of(&now, plane);
                if !model.respond_tile(&tile, &old, &mut new, &mut response) {
                    // The series of the logarithm and the exponential do not reach further.
                    assert!(size > 1e-2, "{model:?} declines at {size}");
                    continue;
                }
                let mut energies = [0.0; TILE];
                assert!(model.point_energies_tile(&tile, &new, &mut energies));
                for i in 0..TILE {
                    let one = model.respond(&now[i], &old[i]).unwrap();
                    assert_eq!(new[i], one.history, "{model:?}, point {i}");
                    assert_eq!(response.plastic_work[i], one.plastic_work);
                    let t = one.kirchhoff_stress;
                    let expected = [t.m11, t.m22, t.m33, t.m12, t.m13, t.m23];
                    let found = response.kirchhoff_stress.each_ref().map(|tile| tile[i]);
                    assert_eq!(found, expected, "{model:?}, point {i}");
                    let energy = model.point_energy(&now[i], &new[i]);
                    // Strains of 1e-3 by F C_p⁻¹ Fᵀ of the order of 1: 1e-13 of them.
                    assert!((energies[i] - energy).abs() < 1e-12 * energy + 1e-6, "point {i}");
                }
            }
        }
    }

    #[test]
    fn tiles_with_a_point_that_is_not_sound_are_left_to_single_points() {
        let model = &HenckyVonMises::examples()[0];
        let (now, old) = points(model, false, 1e-3);
        let (mut new, mut response) = (old.clone(), ResponseTile::ZERO);
        let spoilt: [fn(&mut Kinematics); 4] = [
            |point| point.jacobian = -0.1,
            |point| point.jacobian = f64::NAN,
            |point| point.deformation_gradient.m21 = f64::NAN,
            |point| point.deformation_gradient.m11 *= -1.0,
        ];
        assert!(model.respond_tile(&tile_of(&now, false), &old, &mut new, &mut response));
        for spoil in spoilt {
            let mut now = now.clone();
            spoil(&mut now[17]);
            let tile = tile_of(&now, false);
            assert!(!model.respond_tile(&tile, &old, &mut new, &mut response));
            // Energies do not read J.
            let sound = now[17].deformation_gradient.determinant() > 0.0;
            assert_eq!(model.point_energies_tile(&tile, &old, &mut [0.0; TILE]), sound);
        }
    }

    #[test]
    fn tiles_with_a_point_that_has_failed_or_is_compressed_too_far_are_left_to_single_points() {
        let model = &HenckyVonMises::examples().pop().unwrap();
        assert!(model.damage.is_some() && model.equation_of_state.is_some());
        let (mut now, mut old) = points(model, false, 1e-3);
        let (mut new, mut response) = (old.clone(), ResponseTile::ZERO);
        old[5] = old[5].with_damage(0.999);
        assert!(model.respond_tile(&tile_of(&now, false), &old, &mut new, &mut response));
        old[5] = old[5].with_damage(1.0);
        assert!(!model.respond_tile(&tile_of(&now, false), &old, &mut new, &mut response));
        old[5] = old[5].with_damage(0.0);
        now[7].jacobian = 0.05;
        assert!(model.respond(&now[7], &old[7]).is_err());
        assert!(!model.respond_tile(&tile_of(&now, false), &old, &mut new, &mut response));
    }
}
