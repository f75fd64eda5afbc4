//! The tridiagonal matrix of the Lanczos process and its largest eigenvalue.

/// Lanczos steps: the largest eigenvalue of the undeformed operators is then within one per cent (a
/// third of a per cent measured), that of deformed bodies, whose fastest mode sits in one place, far
/// closer.
const STEPS: usize = 12;

/// Size of a residual, over the diagonal, below which the vectors span an invariant subspace.
const EXHAUSTED: f64 = 1e-10;

/// Bisections: enough for every bit.
const BISECTIONS: usize = 64;

/// A symmetric tridiagonal matrix that grows by one row per step.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tridiagonal {
    diagonal: [f64; STEPS],
    /// Between row i and row i + 1.
    coupling: [f64; STEPS],
    size: usize,
}

impl Tridiagonal {
    pub(super) fn size(&self) -> usize {
        self.size
    }

    pub(super) fn is_full(&self) -> bool {
        self.size == STEPS
    }

    /// The coupling to the next row; zero at the start.
    pub(super) fn last_coupling(&self) -> f64 {
        match self.size {
            0 => 0.0,
            size => self.coupling[size - 1],
        }
    }

    /// Appends a row; whether the process can go on.
    pub(super) fn extend(&mut self, diagonal: f64, coupling: f64) -> bool {
        self.diagonal[self.size] = diagonal;
        self.coupling[self.size] = coupling;
        self.size += 1;
        coupling > EXHAUSTED * diagonal
    }

    /// By bisection; not a number where an entry is none.
    pub(super) fn largest_eigenvalue(&self) -> f64 {
        let (diagonal, coupling) = (&self.diagonal[..self.size], &self.coupling[..self.size]);
        let within = coupling.split_last().map_or(0.0, |(_, inner)| {
            inner.iter().fold(0.0, |largest: f64, c| largest.max(*c))
        });
        // Gershgorin: below and above every eigenvalue that may be the largest.
        let mut low = diagonal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mut high = low + 2.0 * within;
        if diagonal.iter().any(|d| !d.is_finite()) || !high.is_finite() {
            return f64::NAN;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if self.all_below(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        high
    }

    /// Whether every eigenvalue is below `x`: all pivots of the matrix minus x are negative (Sturm).
    fn all_below(&self, x: f64) -> bool {
        let mut pivot = f64::INFINITY;
        let mut coupling = 0.0;
        for i in 0..self.size {
            pivot = self.diagonal[i] - x - coupling * coupling / pivot;
            if pivot >= 0.0 {
                return false;
            }
            coupling = self.coupling[i];
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_eigenvalue_of_a_second_difference_is_known() {
        // 2 on the diagonal, -1 (or 1) beside it: 2 + 2 cos(π/(n + 1)).
        let mut matrix = Tridiagonal::default();
        for n in 1..=STEPS {
            assert!(matrix.extend(2.0, 1.0));
            let expected = 2.0 + 2.0 * (std::f64::consts::PI / (n as f64 + 1.0)).cos();
            assert!((matrix.largest_eigenvalue() - expected).abs() < 1e-14);
        }
        assert!(matrix.is_full());
    }

    #[test]
    fn an_exhausted_space_ends_the_process_and_nan_is_passed_on() {
        let mut matrix = Tridiagonal::default();
        assert!(!matrix.extend(3.0, 1e-12));
        assert_eq!(matrix.largest_eigenvalue(), 3.0);
        let mut matrix = Tridiagonal::default();
        assert!(!matrix.extend(f64::NAN, f64::NAN));
        assert!(matrix.largest_eigenvalue().is_nan());
    }
}
