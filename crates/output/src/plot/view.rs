//! How the body is looked at.

use jstsph_tensor::Vec3;

/// A coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axis {
    /// First coordinate.
    X,
    /// Second coordinate.
    Y,
    /// Third coordinate.
    Z,
}

impl Axis {
    pub(crate) fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        ["x", "y", "z"][self.index()]
    }

    pub(crate) fn direction(self) -> Vec3 {
        let mut direction = Vec3::zeros();
        direction[self.index()] = 1.0;
        direction
    }
}

/// A parallel projection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// x to the right, y up, seen against z.
    #[default]
    Xy,
    /// x to the right, z up, seen along y.
    Xz,
    /// y to the right, z up, seen against x.
    Yz,
    /// From above and aside, with this axis up; with a scale bar instead of axes.
    Oblique(Axis),
}

impl View {
    /// The axes to the right and up, if the view is along the third one.
    pub(crate) fn plane(self) -> Option<[Axis; 2]> {
        match self {
            Self::Xy => Some([Axis::X, Axis::Y]),
            Self::Xz => Some([Axis::X, Axis::Z]),
            Self::Yz => Some([Axis::Y, Axis::Z]),
            Self::Oblique(_) => None,
        }
    }

    /// Unit vectors to the right, up, and toward the viewer.
    pub(crate) fn frame(self) -> [Vec3; 3] {
        let [right, up] = match self {
            Self::Oblique(axis) => {
                let up = axis.direction();
                // x points to the right unless it is up.
                let first = if axis == Axis::X {
                    Vec3::y()
                } else {
                    Vec3::x()
                };
                let second = up.cross(&first);
                // Elevation about 22 degrees, azimuth about 30: no two axes coincide.
                let toward = (first * 0.5 - second * 0.85 + up * 0.4).normalize();
                let right = up.cross(&toward).normalize();
                [right, toward.cross(&right)]
            }
            Self::Xy => [Vec3::x(), Vec3::y()],
            Self::Xz => [Vec3::x(), Vec3::z()],
            Self::Yz => [Vec3::y(), Vec3::z()],
        };
        [right, up, right.cross(&up)]
    }
}

/// A slab of the body: only particles inside are shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Normal of the slab.
    pub axis: Axis,
    /// Coordinate of its middle, m.
    pub at: f64,
    /// Thickness, m; one particle spacing shows a single layer.
    pub thickness: f64,
}

impl Section {
    pub(crate) fn contains(&self, position: &Vec3) -> bool {
        (position[self.axis.index()] - self.at).abs() <= 0.5 * self.thickness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_is_a_right_handed_orthonormal_frame() {
        let oblique = [Axis::X, Axis::Y, Axis::Z].map(View::Oblique);
        for view in [View::Xy, View::Xz, View::Yz].into_iter().chain(oblique) {
            let [right, up, toward] = view.frame();
            assert!((right.cross(&up) - toward).norm() < 1e-15, "{view:?}");
            assert!(right.dot(&up).abs() < 1e-15 && (up.norm() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_oblique_view_keeps_its_axis_upright() {
        for axis in [Axis::X, Axis::Y, Axis::Z] {
            let [right, up, toward] = View::Oblique(axis).frame();
            let direction = axis.direction();
            assert!(direction.dot(&right).abs() < 1e-15);
            assert!(direction.dot(&up) > 0.8 && direction.dot(&toward) > 0.3);
            assert!(axis == Axis::X || right.x > 0.8);
        }
    }

    #[test]
    fn a_section_is_a_slab() {
        let section = Section {
            axis: Axis::Y,
            at: 1.0,
            thickness: 0.5,
        };
        assert!(section.contains(&Vec3::new(9.0, 1.25, 9.0)));
        assert!(!section.contains(&Vec3::new(9.0, 0.7, 9.0)));
    }
}
