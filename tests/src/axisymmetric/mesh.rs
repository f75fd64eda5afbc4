//! The section of a cylinder in quadrilaterals.

/// Nodes in rows of constant height from the axis outwards, rows from the base to the top.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Undeformed places (radius, height) of the nodes, m.
    pub nodes: Vec<[f64; 2]>,
    /// Nodes of the elements, counter-clockwise in the plane of radius and height.
    pub elements: Vec<[usize; 4]>,
    radial: usize,
    axial: usize,
}

impl Mesh {
    /// `radial` times `axial` equal rectangles.
    #[must_use]
    pub fn cylinder(radius: f64, height: f64, radial: usize, axial: usize) -> Self {
        let mut nodes = Vec::with_capacity((radial + 1) * (axial + 1));
        for row in 0..=axial {
            for column in 0..=radial {
                nodes.push([
                    radius * column as f64 / radial as f64,
                    height * row as f64 / axial as f64,
                ]);
            }
        }
        let width = radial + 1;
        let elements = (0..axial)
            .flat_map(|row| (0..radial).map(move |column| row * width + column))
            .map(|first| [first, first + 1, first + width + 1, first + width])
            .collect();
        Self {
            nodes,
            elements,
            radial,
            axial,
        }
    }

    /// Nodes of the base from the axis to the edge.
    #[must_use]
    pub fn base(&self) -> std::ops::RangeInclusive<usize> {
        0..=self.radial
    }

    /// Nodes of the side from the edge of the base to that of the top.
    #[must_use]
    pub fn side(&self) -> Vec<usize> {
        (0..=self.axial)
            .map(|row| row * (self.radial + 1) + self.radial)
            .collect()
    }

    /// The node on the edge of the base.
    #[must_use]
    pub fn corner(&self) -> usize {
        self.radial
    }
}
