//! The equations of the multiplier, put together and solved.

use jstsph_tensor::Vec3;

use super::Fit;

/// The conjugate gradients end when they have reduced the defect by this factor. Defects of a third of a
/// face end below 10⁻⁴ of one, a twentieth of what is accepted without any correction. What then remains is
/// smooth over the whole body: the equations are of fourth order, and another factor of ten would take up to
/// ten times the iterations.
const REDUCTION: f64 = 1e-4;

/// Ten times what the largest body of the tests needs.
const ITERATION_LIMIT: usize = 10_000;

/// Added to the diagonal, over the mean volume. A linear multiplier changes no row, so the equations are
/// singular; this keeps its size bounded and changes the rest by less than [`REDUCTION`] asks for.
const DAMPING: f64 = 1e-9;

/// A_cd = Σ_q V_q (δ_cd − 1/n_q − (X_c − X̄_q) · M_q⁻¹ (X_d − X̄_q)) over the rows q with c and d, between the
/// particles that have rows: symmetric, the same for all three components of the multiplier.
pub(super) struct NormalEquations {
    /// Particle of each equation, ascending.
    particles: Vec<u32>,
    offsets: Vec<usize>,
    indices: Vec<u32>,
    values: Vec<f64>,
    diagonal: Vec<f64>,
}

impl NormalEquations {
    pub(super) fn new(rows: &[Fit<'_>], particles: usize) -> Self {
        // Rows of every particle, in their order.
        let mut counts = vec![0usize; particles + 1];
        for c in rows.iter().flat_map(|row| row.row.indices()) {
            counts[c + 1] += 1;
        }
        for c in 0..particles {
            counts[c + 1] += counts[c];
        }
        let mut lists = vec![0u32; counts[particles]];
        let mut next = counts.clone();
        for (number, row) in rows.iter().enumerate() {
            for c in row.row.indices() {
                lists[next[c]] = number as u32;
                next[c] += 1;
            }
        }
        let reached: Vec<u32> = (0..particles as u32)
            .filter(|&c| counts[c as usize + 1] > counts[c as usize])
            .collect();
        let mut equation = vec![u32::MAX; particles];
        for (number, &c) in (0u32..).zip(&reached) {
            equation[c as usize] = number;
        }

        let volumes = rows.iter().map(|row| row.volume).sum::<f64>();
        let damping = DAMPING * volumes / rows.len().max(1) as f64;
        let mut normal = Self {
            diagonal: Vec::with_capacity(reached.len()),
            particles: reached,
            offsets: vec![0],
            indices: Vec::new(),
            values: Vec::new(),
        };
        let mut sums = vec![0.0; particles];
        let mut touched: Vec<u32> = Vec::new();
        for &c in &normal.particles {
            for &number in &lists[counts[c as usize]..counts[c as usize + 1]] {
                let row = &rows[number as usize];
                let arm = row.inverse * row.offset(c as usize);
                let mean = 1.0 / row.row.len() as f64;
                for d in row.row.indices() {
                    // Zero only before the first sum; a later zero only lists d twice, and sorting finds it.
                    if sums[d] == 0.0 {
                        touched.push(d as u32);
                    }
                    sums[d] -= row.volume * (mean + arm.dot(&row.offset(d)));
                }
                sums[c as usize] += row.volume;
            }
            sums[c as usize] += damping;
            touched.sort_unstable();
            touched.dedup();
            normal.diagonal.push(sums[c as usize]);
            for &d in &touched {
                normal.indices.push(equation[d as usize]);
                normal.values.push(sums[d as usize]);
                sums[d as usize] = 0.0;
            }
            touched.clear();
            normal.offsets.push(normal.indices.len());
        }
        normal
    }

    /// A λ.
    fn apply(&self, field: &[Vec3], image: &mut [Vec3]) {
        for (number, image) in image.iter_mut().enumerate() {
            let range = self.offsets[number]..self.offsets[number + 1];
            let (mut x, mut y, mut z) = (0.0, 0.0, 0.0);
            for (&d, value) in self.indices[range.clone()].iter().zip(&self.values[range]) {
                let f = &field[d as usize];
                x += f.x * value;
                y += f.y * value;
                z += f.z * value;
            }
            *image = Vec3::new(x, y, z);
        }
    }

    /// λ of every particle, with A λ = `defect`, and the number of iterations: conjugate gradients with
    /// the diagonal as preconditioner.
    pub(super) fn solve(&self, defect: &[Vec3]) -> (Vec<Vec3>, usize) {
        let count = self.particles.len();
        let dot = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
        let mut residual: Vec<Vec3> = self.particles.iter().map(|&c| defect[c as usize]).collect();
        let mut solution = vec![Vec3::zeros(); count];
        let mut scaled: Vec<Vec3> = residual
            .iter()
            .zip(&self.diagonal)
            .map(|(r, d)| r / *d)
            .collect();
        let mut direction = scaled.clone();
        let mut image = vec![Vec3::zeros(); count];
        let mut product = dot(&residual, &scaled);
        let target = dot(&residual, &residual) * REDUCTION * REDUCTION;
        let mut iterations = 0;
        while iterations < ITERATION_LIMIT && dot(&residual, &residual) > target {
            self.apply(&direction, &mut image);
            let length = product / dot(&direction, &image);
            for number in 0..count {
                solution[number] += direction[number] * length;
                residual[number] -= image[number] * length;
                scaled[number] = residual[number] / self.diagonal[number];
            }
            let last = std::mem::replace(&mut product, dot(&residual, &scaled));
            let ratio = product / last;
            for (direction, scaled) in direction.iter_mut().zip(&scaled) {
                *direction = scaled + *direction * ratio;
            }
            iterations += 1;
        }
        let mut all = vec![Vec3::zeros(); defect.len()];
        for (&c, value) in self.particles.iter().zip(&solution) {
            all[c as usize] = *value;
        }
        (all, iterations)
    }
}
