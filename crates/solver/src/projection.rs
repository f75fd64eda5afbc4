//! Projection of forces onto those without resultant and torque (3.15).

use jstsph_tensor::{Mat3, Vec3, symmetric_eigen};

use crate::parallel;
use crate::reference::Reference;

/// Principal moments below this fraction of the largest are those of a collinear body about its
/// own line: no torque about it can be taken or given.
const SINGULAR: f64 = 1e-12;

/// Sums over a body, about its first particle, with `N` fields.
#[derive(Clone, Copy)]
struct Moments<const N: usize> {
    volume: f64,
    first: Vec3,
    /// Σ V y ⊗ y as 11, 22, 33, 12, 13, 23.
    second: [f64; 6],
    /// Resultant and torque of each field.
    loads: [[f64; 6]; N],
}

impl<const N: usize> Moments<N> {
    const ZERO: Self = Self {
        volume: 0.0,
        first: Vec3::new(0.0, 0.0, 0.0),
        second: [0.0; 6],
        loads: [[0.0; 6]; N],
    };

    #[inline(always)]
    fn of(volume: f64, arm: &Vec3, forces: [Vec3; N]) -> Self {
        let first = arm * volume;
        let (x, y, z) = (arm.x, arm.y, arm.z);
        Self {
            volume,
            first,
            second: [x * x, y * y, z * z, x * y, x * z, y * z].map(|square| square * volume),
            loads: forces.map(|force| {
                let force = force * volume;
                let torque = arm.cross(&force);
                [force.x, force.y, force.z, torque.x, torque.y, torque.z]
            }),
        }
    }

    fn second(&self) -> Mat3 {
        let [xx, yy, zz, xy, xz, yz] = self.second;
        Mat3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
    }
}

impl<const N: usize> std::ops::Add for Moments<N> {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        self.volume += other.volume;
        self.first += other.first;
        for (sum, value) in self.second.iter_mut().zip(other.second) {
            *sum += value;
        }
        let loads = self.loads.as_flattened_mut().iter_mut();
        for (sum, value) in loads.zip(other.loads.as_flattened()) {
            *sum += value;
        }
        self
    }
}

/// Changes each of `fields` (forces per unit reference volume) as little as possible, in the
/// volume-weighted norm, so that on every body Σ V f = 0 and Σ V y × f = 0, with the lever arm
/// `lever(a)` of particle a.
///
/// `[eq:projection]`: Greto & Kulasegaram 2019, (3.15). The discrete angular momentum of the time integration is
/// conserved exactly when the lever arms are those of docs/theory.md, `[eq:lever-arms]`: xⁿ in the leapfrog and in
/// the first stage of TVD-RK2, xⁿ⁺¹ in the second.
pub(crate) fn conserve<const N: usize>(
    reference: &Reference,
    lever: &(impl Fn(usize) -> Vec3 + Sync),
    mut fields: [&mut [Vec3]; N],
) {
    for body in &reference.bodies {
        let range = body.particles.clone();
        let origin = lever(range.start);
        let (start, forces) = (range.start, fields.each_ref());
        let sums = parallel::sum(range.len(), Moments::ZERO, |a| {
            let arm = lever(start + a) - origin;
            let volume = reference.volume[start + a];
            Moments::of(volume, &arm, forces.map(|field| field[start + a]))
        });
        let centre = sums.first / sums.volume;
        let spread = sums.second() - centre * centre.transpose() * sums.volume;
        let inertia = Mat3::identity() * spread.trace() - spread;
        for (field, load) in fields.iter_mut().zip(sums.loads) {
            let [force, torque] = [[load[0], load[1], load[2]], [load[3], load[4], load[5]]];
            let (force, torque) = (Vec3::from(force), Vec3::from(torque));
            let mean = force / sums.volume;
            let spin = solve_symmetric(&inertia, &(torque - centre.cross(&force)));
            parallel::for_each(&mut field[range.clone()], |a, force| {
                let arm = lever(start + a) - origin - centre;
                *force -= mean + spin.cross(&arm);
            });
        }
    }
}

/// Least-squares solution of a symmetric positive semi-definite system.
fn solve_symmetric(matrix: &Mat3, right: &Vec3) -> Vec3 {
    let spectral = symmetric_eigen(matrix);
    let limit = SINGULAR * spectral.values.max();
    let mut solution = Vec3::zeros();
    for i in 0..3 {
        let direction = spectral.directions.column(i);
        if spectral.values[i] > limit {
            solution += direction * (direction.dot(right) / spectral.values[i]);
        }
    }
    solution
}

#[cfg(test)]
mod tests;
