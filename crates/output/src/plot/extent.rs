//! What a picture shows of the plane of view.

/// The smallest upright rectangle about some points.
pub(super) struct Extent {
    pub(super) lower: [f64; 2],
    pub(super) upper: [f64; 2],
}

impl Default for Extent {
    fn default() -> Self {
        Self {
            lower: [f64::MAX; 2],
            upper: [f64::MIN; 2],
        }
    }
}

impl Extent {
    pub(super) fn add(&mut self, point: [f64; 2]) {
        for (i, coordinate) in point.into_iter().enumerate() {
            self.lower[i] = self.lower[i].min(coordinate);
            self.upper[i] = self.upper[i].max(coordinate);
        }
    }

    pub(super) fn size(&self) -> [f64; 2] {
        std::array::from_fn(|i| self.upper[i] - self.lower[i])
    }

    /// With a border of half a spacing, so that a single line of particles has an area.
    pub(super) fn area(&self, spacing: f64) -> f64 {
        self.size().iter().map(|size| size + spacing).product()
    }
}
