//! What is measured at the deformed bar.

use super::{Body, Mesh};

/// Shape and strain of a bar after the impact; lengths in m.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Radius of the node on the edge of the undeformed base.
    pub corner_radius: f64,
    /// Its height above the wall.
    pub corner_height: f64,
    /// Largest radius of the body.
    pub largest_radius: f64,
    /// Height of the largest radius.
    pub largest_radius_height: f64,
    /// Largest radius at which the body touches the wall.
    pub contact_radius: f64,
    /// Nodes of the side, without the edge, that touch the wall.
    pub folded: usize,
    /// Extent along the axis.
    pub length: f64,
    /// Equivalent plastic strain of the element at the centre of the base.
    pub centre_strain: f64,
    /// Largest equivalent plastic strain of an element.
    pub largest_strain: f64,
}

impl Shape {
    /// Measures a body.
    #[must_use]
    pub fn of(body: &Body) -> Self {
        let mesh = &body.mesh;
        let place = |node: usize| body.position[node];
        let side = mesh.side();
        // Far below any length of interest, far above rounding.
        let touches = |node: &usize| place(*node)[1] < 1e-9;
        let corner = place(mesh.corner());
        let widest = side
            .iter()
            .map(|node| place(*node))
            .fold(
                corner,
                |one, other| if other[0] > one[0] { other } else { one },
            );
        let heights = || body.position.iter().map(|x| x[1]);
        let strain = body.plastic_strain();
        Self {
            corner_radius: corner[0],
            corner_height: corner[1],
            largest_radius: widest[0],
            largest_radius_height: widest[1],
            contact_radius: mesh
                .base()
                .chain(side.iter().copied())
                .filter(touches)
                .map(|node| place(node)[0])
                .fold(0.0, f64::max),
            folded: side[1..].iter().filter(|node| touches(node)).count(),
            length: heights().fold(0.0, f64::max) - heights().fold(f64::INFINITY, f64::min),
            centre_strain: strain[0],
            largest_strain: strain.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// Largest radius of the side at a height, m; none where it does not reach.
#[must_use]
pub fn outline_radius(mesh: &Mesh, position: &[[f64; 2]], height: f64) -> Option<f64> {
    let side = mesh.side();
    side.windows(2)
        .filter_map(|pair| {
            let [one, other] = [position[pair[0]], position[pair[1]]];
            let inside = (one[1] - height) * (other[1] - height) <= 0.0 && one[1] != other[1];
            inside.then(|| {
                let share = (height - one[1]) / (other[1] - one[1]);
                one[0] + share * (other[0] - one[0])
            })
        })
        .reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::Metal;
    use super::*;

    #[test]
    fn a_flared_base_is_measured() {
        let mut body = Body::new(Mesh::cylinder(1.0, 4.0, 2, 4), Metal::copper());
        let [corner, above] = [0, 1].map(|row| body.mesh.side()[row]);
        body.position[corner] = [2.0, 0.25];
        body.position[above] = [3.0, 0.0];
        let shape = Shape::of(&body);
        assert_eq!([shape.corner_radius, shape.corner_height], [2.0, 0.25]);
        assert_eq!(
            [shape.largest_radius, shape.largest_radius_height],
            [3.0, 0.0]
        );
        // The node above the corner came down on the wall.
        assert_eq!((shape.contact_radius, shape.folded), (3.0, 1));
        assert_eq!(shape.length, 4.0);
        // From (3, 0) to (1, 2), the outer of the two edges at this height.
        let radius = outline_radius(&body.mesh, &body.position, 0.2);
        assert!((radius.expect("a place on the side") - 2.8).abs() < 1e-15);
        assert_eq!(outline_radius(&body.mesh, &body.position, 4.1), None);
    }
}
