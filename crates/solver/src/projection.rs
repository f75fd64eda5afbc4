//! Projection of forces onto those without resultant and torque (3.15).

use jstsph_tensor::{Mat3, Vec3, symmetric_eigen};

use crate::parallel;
use crate::reference::Reference;

/// Principal moments below this fraction of the largest are those of a collinear body about its
/// own line: no torque about it can be taken or given.
const SINGULAR: f64 = 1e-12;

/// Sums over a body, about its first particle.
#[derive(Clone, Copy)]
struct Moments {
    volume: f64,
    first: Vec3,
    second: Mat3,
    force: Vec3,
    torque: Vec3,
}

impl Moments {
    const ZERO: Self = Self {
        volume: 0.0,
        first: Vec3::new(0.0, 0.0, 0.0),
        second: Mat3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        force: Vec3::new(0.0, 0.0, 0.0),
        torque: Vec3::new(0.0, 0.0, 0.0),
    };
}

impl std::ops::Add for Moments {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            volume: self.volume + other.volume,
            first: self.first + other.first,
            second: self.second + other.second,
            force: self.force + other.force,
            torque: self.torque + other.torque,
        }
    }
}

/// Changes `field` (a force per unit reference volume) as little as possible, in the
/// volume-weighted norm, so that on every body Σ V f = 0 and Σ V y × f = 0, with the lever arm
/// `lever(a)` of particle a.
///
/// `[eq:projection]`: Greto & Kulasegaram 2019, (3.15). The discrete angular momentum of the time integration is
/// conserved exactly when the lever arms are those of docs/theory.md, `[eq:lever-arms]`: xⁿ in the leapfrog and in
/// the first stage of TVD-RK2, xⁿ⁺¹ in the second.
pub(crate) fn conserve(
    reference: &Reference,
    lever: &(impl Fn(usize) -> Vec3 + Sync),
    field: &mut [Vec3],
) {
    for body in &reference.bodies {
        let range = body.particles.clone();
        let origin = lever(range.start);
        let (start, forces) = (range.start, &field[range.clone()]);
        let sums = parallel::sum(range.len(), Moments::ZERO, |a| {
            let volume = reference.volume[start + a];
            let arm = lever(start + a) - origin;
            let force = forces[a] * volume;
            Moments {
                volume,
                first: arm * volume,
                second: arm * arm.transpose() * volume,
                force,
                torque: arm.cross(&force),
            }
        });
        let centre = sums.first / sums.volume;
        let spread = sums.second - centre * centre.transpose() * sums.volume;
        let inertia = Mat3::identity() * spread.trace() - spread;
        let torque = sums.torque - centre.cross(&sums.force);

        let mean = sums.force / sums.volume;
        let spin = solve_symmetric(&inertia, &torque);
        parallel::for_each(&mut field[range], |a, force| {
            let arm = lever(start + a) - origin - centre;
            *force -= mean + spin.cross(&arm);
        });
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
