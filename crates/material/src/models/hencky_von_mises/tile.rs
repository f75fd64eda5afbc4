//! The response of many points at once: the tensor algebra on vectors of points, the scalar equation
//! of radial return point by point. Same formulas, same order, same bits as `respond`.

use super::HenckyVonMises;
use super::flow::Flow;
use crate::logarithmic_strain::{
    LONG_EXPONENTIAL, LONG_LOGARITHM, SHORT_EXPONENTIAL, SHORT_LOGARITHM, SHORT_SERIES_LIMIT,
};
use crate::{KinematicsTile, PlasticHistory, Property, ResponseTile};
use jstsph_tensor::lanes::{
    Lanes, Simd, TILE, TensorTile, WithSimd, load_all, store_all, times, vectorised,
};

/// Symmetric tensors as 11, 22, 33, 12, 13, 23.
type Symmetric<S> = [Lanes<S>; 6];
/// Tensors as 11, 21, 31, 12, 22, 32, 13, 23, 33.
type Full<S> = [Lanes<S>; 9];
type SymmetricTile = [[f64; TILE]; 6];

/// See [`Material::respond_tile`](crate::Material::respond_tile).
pub(super) fn respond(
    model: &HenckyVonMises,
    now: &KinematicsTile,
    old: &[PlasticHistory],
    new: &mut [PlasticHistory],
    response: &mut ResponseTile,
) -> bool {
    let (Property::Constant(_), Property::Constant(_), None, None) = (
        &model.young_modulus,
        &model.poisson_ratio,
        &model.damage,
        &model.equation_of_state,
    ) else {
        return false;
    };
    let shear_modulus = model.elastic().shear_modulus(now.temperature[0]);
    let (old, new) = (&old[..TILE], &mut new[..TILE]);

    let mut inverse_plastic = [[0.0; TILE]; 6];
    for (i, history) in old.iter().enumerate() {
        for (tile, component) in inverse_plastic.iter_mut().zip(history.components()) {
            tile[i] = *component;
        }
    }
    let mut trial = Trial::ZERO;
    vectorised(TrialStress {
        shear_modulus,
        deformation_gradient: &now.deformation_gradient,
        inverse_plastic: &inverse_plastic,
        trial: &mut trial,
    });
    let Some(flow) = Flow::of(model, shear_modulus, now, old, &trial) else {
        return false;
    };
    if !flow.plastic {
        response.kirchhoff_stress = trial.stress;
        response.plastic_work = [0.0; TILE];
        new.copy_from_slice(old);
        return true;
    }
    vectorised(Update {
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
    true
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

struct TrialStress<'a> {
    shear_modulus: f64,
    deformation_gradient: &'a TensorTile,
    inverse_plastic: &'a SymmetricTile,
    trial: &'a mut Trial,
}

impl WithSimd for TrialStress<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let trial = self.trial;
        for pack in 0..TILE / S::F64_LANES {
            let f = self.deformation_gradient.load(simd, pack).0;
            determinant(&f).store(&mut trial.determinant, pack);
            let c = load_all(simd, self.inverse_plastic, pack);
            let b = congruence(&f, &full(&c));
            store_all(&b, &mut trial.b, pack);

            let scale = (b[0] + b[1] + b[2]).over(Lanes::splat(simd, 3.0)).inverse();
            let one = Lanes::splat(simd, 1.0);
            let a = [
                b[0] * scale - one,
                b[1] * scale - one,
                b[2] * scale - one,
                b[3] * scale,
                b[4] * scale,
                b[5] * scale,
            ];
            let j2 = norm_squared(&a) * 0.5;
            let distortion = j2 * 2.0;
            let nan = Lanes::splat(simd, f64::NAN);
            scale
                .if_less(0.0, nan, distortion)
                .store(&mut trial.distortion, pack);
            let (square, j3) = square_and_determinant(&a);
            let [_, c1, c2] = series(simd, &SHORT_LOGARITHM, &LONG_LOGARITHM, distortion, j2, j3);
            let c0 = (-c2 * j2).over(Lanes::splat(simd, 3.0));
            let strain = combination(c0, c1 * 0.5, &a, c2 * 0.5, &square);
            let stress = times(&strain, Lanes::splat(simd, 2.0 * self.shear_modulus));
            store_all(&stress, &mut trial.stress, pack);
            (norm_squared(&stress) * 1.5)
                .sqrt()
                .store(&mut trial.equivalent_stress, pack);
        }
    }
}

struct Update<'a> {
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
        for pack in 0..TILE / S::F64_LANES {
            let trial_stress = load_all(simd, &self.trial.stress, pack);
            let factor = Lanes::load(simd, &self.flow.direction, pack);
            let direction = times(&trial_stress, factor);
            let j2 = norm_squared(&direction) * 0.5;
            let (square, j3) = square_and_determinant(&direction);
            let [c0, c1, c2] = series(
                simd,
                &SHORT_EXPONENTIAL,
                &LONG_EXPONENTIAL,
                j2 * 2.0,
                j2,
                j3,
            );
            let exponential_less_one = combination(c0, c1, &direction, c2, &square);
            let b = load_all(simd, &self.trial.b, pack);
            let b_change = product(&full(&b), &full(&exponential_less_one));

            let f = self.deformation_gradient.load(simd, pack).0;
            let inverse_determinant =
                Lanes::load(simd, &self.trial.determinant, pack).inverse();
            let f_inverse = times(&cofactor_transposed(&f), inverse_determinant);
            let change = congruence(&f_inverse, &b_change);
            let old = load_all(simd, self.inverse_plastic, pack);
            let mut new = old;
            for k in 0..6 {
                new[k] = old[k] + change[k];
            }
            store_all(&new, self.inverse_plastic, pack);

            let ratio = Lanes::load(simd, &self.flow.ratio, pack);
            store_all(&times(&trial_stress, ratio), self.stress, pack);
        }
    }
}

#[inline(always)]
fn full<S: Simd>(&[m11, m22, m33, m12, m13, m23]: &Symmetric<S>) -> Full<S> {
    [m11, m12, m13, m12, m22, m23, m13, m23, m33]
}

#[inline(always)]
fn determinant<S: Simd>(&[m11, m21, m31, m12, m22, m32, m13, m23, m33]: &Full<S>) -> Lanes<S> {
    m11 * (m22 * m33 - m32 * m23) - m12 * (m21 * m33 - m31 * m23) + m13 * (m21 * m32 - m31 * m22)
}

/// (cof F)ᵀ, whose columns are the rows of the cofactor.
#[inline(always)]
fn cofactor_transposed<S: Simd>(
    &[m11, m21, m31, m12, m22, m32, m13, m23, m33]: &Full<S>,
) -> Full<S> {
    [
        m22 * m33 - m23 * m32,
        m23 * m31 - m21 * m33,
        m21 * m32 - m22 * m31,
        m32 * m13 - m33 * m12,
        m33 * m11 - m31 * m13,
        m31 * m12 - m32 * m11,
        m12 * m23 - m13 * m22,
        m13 * m21 - m11 * m23,
        m11 * m22 - m12 * m21,
    ]
}

#[inline(always)]
fn product<S: Simd>(a: &Full<S>, b: &Full<S>) -> Full<S> {
    let mut product = *a;
    for (k, entry) in product.iter_mut().enumerate() {
        let (i, j) = (k % 3, 3 * (k / 3));
        *entry = a[i] * b[j] + a[i + 3] * b[j + 1] + a[i + 6] * b[j + 2];
    }
    product
}

/// Σ_k A_ik F_jk.
#[inline(always)]
fn entry<S: Simd>(a: &Full<S>, f: &Full<S>, i: usize, j: usize) -> Lanes<S> {
    a[i] * f[j] + a[i + 3] * f[j + 3] + a[i + 6] * f[j + 6]
}

/// F A Fᵀ of a symmetric A.
#[inline(always)]
fn congruence<S: Simd>(f: &Full<S>, a: &Full<S>) -> Symmetric<S> {
    let fa = product(f, a);
    [
        entry(&fa, f, 0, 0),
        entry(&fa, f, 1, 1),
        entry(&fa, f, 2, 2),
        entry(&fa, f, 0, 1),
        entry(&fa, f, 0, 2),
        entry(&fa, f, 1, 2),
    ]
}

#[inline(always)]
fn norm_squared<S: Simd>(&[m11, m22, m33, m12, m13, m23]: &Symmetric<S>) -> Lanes<S> {
    (m11 * m11 + m12 * m12 + m13 * m13)
        + (m12 * m12 + m22 * m22 + m23 * m23)
        + (m13 * m13 + m23 * m23 + m33 * m33)
}

/// A² and det A.
#[inline(always)]
fn square_and_determinant<S: Simd>(
    &[m11, m22, m33, m12, m13, m23]: &Symmetric<S>,
) -> (Symmetric<S>, Lanes<S>) {
    let square = [
        m11 * m11 + m12 * m12 + m13 * m13,
        m12 * m12 + m22 * m22 + m23 * m23,
        m13 * m13 + m23 * m23 + m33 * m33,
        m12 * (m11 + m22) + m13 * m23,
        m13 * (m11 + m33) + m12 * m23,
        m23 * (m22 + m33) + m12 * m13,
    ];
    let determinant = m11 * (m22 * m33 - m23 * m23) - m12 * (m12 * m33 - m13 * m23)
        + m13 * (m12 * m23 - m13 * m22);
    (square, determinant)
}

/// c₀ 1 + c₁ A + c₂ B.
#[inline(always)]
fn combination<S: Simd>(
    c0: Lanes<S>,
    c1: Lanes<S>,
    a: &Symmetric<S>,
    c2: Lanes<S>,
    b: &Symmetric<S>,
) -> Symmetric<S> {
    let mut sum = *a;
    for k in 0..6 {
        sum[k] = if k < 3 {
            c0 + c1 * a[k] + c2 * b[k]
        } else {
            c1 * a[k] + c2 * b[k]
        };
    }
    sum
}

/// The reduced series, short or long for every lane by its squared norm; the long one is only worked
/// out where some lane needs it.
#[inline(always)]
fn series<S: Simd, const SHORT: usize, const LONG: usize>(
    simd: S,
    short: &[f64; SHORT],
    long: &[f64; LONG],
    size: Lanes<S>,
    j2: Lanes<S>,
    j3: Lanes<S>,
) -> [Lanes<S>; 3] {
    let of_short = reduced_series(simd, short, j2, j3);
    if size.largest() < SHORT_SERIES_LIMIT {
        return of_short;
    }
    let of_long = reduced_series(simd, long, j2, j3);
    [
        size.if_less(SHORT_SERIES_LIMIT, of_short[0], of_long[0]),
        size.if_less(SHORT_SERIES_LIMIT, of_short[1], of_long[1]),
        size.if_less(SHORT_SERIES_LIMIT, of_short[2], of_long[2]),
    ]
}

/// Horner's scheme with A³ replaced as soon as it appears; the first three steps need no arithmetic.
#[inline(always)]
fn reduced_series<S: Simd, const N: usize>(
    simd: S,
    coefficients: &[f64; N],
    j2: Lanes<S>,
    j3: Lanes<S>,
) -> [Lanes<S>; 3] {
    let mut c0 = Lanes::splat(simd, coefficients[N - 3]);
    let mut c1 = Lanes::splat(simd, coefficients[N - 2]);
    let mut c2 = Lanes::splat(simd, coefficients[N - 1]);
    let mut k = N - 3;
    while k > 0 {
        k -= 1;
        let next = Lanes::splat(simd, coefficients[k]);
        (c0, c1, c2) = (next + c2 * j3, c0 + c2 * j2, c1);
    }
    [c0, c1, c2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kinematics, Material};
    use jstsph_tensor::Mat3;

    /// Points around a deformation they have flowed to, strained on by up to `size`.
    fn points(model: &HenckyVonMises, size: f64) -> (Vec<Kinematics>, Vec<PlasticHistory>) {
        (0..TILE)
            .map(|i| {
                let wave = |phase: f64| (1.3 * i as f64 + phase).sin();
                let f = |extra: f64| {
                    Mat3::identity()
                        + Mat3::from_fn(|r, c| 0.2 * wave((2 * r + 5 * c) as f64))
                        + Mat3::from_fn(|r, c| extra * wave((7 * r + 3 * c + 1) as f64))
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

    fn tile_of(points: &[Kinematics]) -> KinematicsTile {
        let mut tile = KinematicsTile::new(points[0].dt);
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
        let mut tiles = 0;
        for model in HenckyVonMises::examples() {
            // All elastic, mixed, long and short series together.
            for size in [1e-5, 1e-3, 1e-2, 4e-2] {
                let (now, old) = points(&model, size);
                let (mut new, mut response) = (old.clone(), ResponseTile::ZERO);
                if !model.respond_tile(&tile_of(&now), &old, &mut new, &mut response) {
                    continue;
                }
                tiles += 1;
                for i in 0..TILE {
                    let one = model.respond(&now[i], &old[i]).unwrap();
                    assert_eq!(new[i], one.history, "{model:?}, point {i}");
                    assert_eq!(response.plastic_work[i], one.plastic_work);
                    let t = one.kirchhoff_stress;
                    let expected = [t.m11, t.m22, t.m33, t.m12, t.m13, t.m23];
                    let found = response.kirchhoff_stress.each_ref().map(|tile| tile[i]);
                    assert_eq!(found, expected, "{model:?}, point {i}");
                }
            }
        }
        assert!(tiles >= 24, "only {tiles} tiles took the vectorised path");
    }

    #[test]
    fn tiles_with_a_point_that_is_not_sound_are_left_to_single_points() {
        let model = &HenckyVonMises::examples()[0];
        let (now, old) = points(model, 1e-3);
        let (mut new, mut response) = (old.clone(), ResponseTile::ZERO);
        let spoilt: [fn(&mut Kinematics); 4] = [
            |point| point.jacobian = -0.1,
            |point| point.jacobian = f64::NAN,
            |point| point.deformation_gradient.m21 = f64::NAN,
            |point| point.deformation_gradient.m11 *= -1.0,
        ];
        assert!(model.respond_tile(&tile_of(&now), &old, &mut new, &mut response));
        for spoil in spoilt {
            let mut now = now.clone();
            spoil(&mut now[17]);
            assert!(!model.respond_tile(&tile_of(&now), &old, &mut new, &mut response));
        }
    }
}
