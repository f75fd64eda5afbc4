//! Signed distances of planes, spheres, cylinders and boxes.

use jstsph_tensor::Vec3;

use crate::Gap;

/// Distance to a plane with a unit normal.
#[inline]
pub(crate) fn plane(point: &Vec3, normal: &Vec3, x: &Vec3) -> Gap {
    Gap {
        distance: (x - point).dot(normal),
        normal: *normal,
    }
}

/// Distance to a sphere.
#[inline]
pub(crate) fn sphere(centre: &Vec3, radius: f64, inside: bool, x: &Vec3) -> Gap {
    round(x - centre, radius, inside, Vec3::x)
}

/// Distance to a cylinder without end.
#[inline]
pub(crate) fn cylinder(point: &Vec3, axis: &Vec3, radius: f64, inside: bool, x: &Vec3) -> Gap {
    let from_point = x - point;
    let radial = from_point - from_point.dot(axis) * axis;
    round(radial, radius, inside, || across(axis))
}

/// Gap from the vector from centre or axis; `any` gives a direction where that has none.
#[inline]
fn round(radial: Vec3, radius: f64, inside: bool, any: impl Fn() -> Vec3) -> Gap {
    let length = radial.norm();
    let outward = if length > 0.0 { radial / length } else { any() };
    if inside {
        Gap {
            distance: radius - length,
            normal: -outward,
        }
    } else {
        Gap {
            distance: length - radius,
            normal: outward,
        }
    }
}

/// Some unit vector normal to a unit vector.
pub(crate) fn across(axis: &Vec3) -> Vec3 {
    // The coordinate axis farthest from the given one.
    let mut other = Vec3::zeros();
    other[axis.iamin()] = 1.0;
    axis.cross(&other).normalize()
}

/// Distance to a cylinder with flat caps, seen from outside.
pub(crate) fn capped_cylinder(
    point: &Vec3,
    axis: &Vec3,
    radius: f64,
    half_length: f64,
    x: &Vec3,
) -> Gap {
    let side = cylinder(point, axis, radius, false, x);
    let along = (x - point).dot(axis);
    let cap = Gap {
        distance: along.abs() - half_length,
        normal: along.signum() * axis,
    };
    convex_edge(&side, &cap)
}

/// Distance to a solid that is the intersection of two at right angles.
fn convex_edge(a: &Gap, b: &Gap) -> Gap {
    if a.distance > 0.0 && b.distance > 0.0 {
        // Nearest to the edge between the two.
        let away = a.distance * a.normal + b.distance * b.normal;
        let distance = away.norm();
        Gap {
            distance,
            normal: away / distance,
        }
    } else if a.distance >= b.distance {
        *a
    } else {
        *b
    }
}

/// Distance to one face of a box seen from inside; faces are −x, +x, −y, +y, −z, +z.
#[inline]
pub(crate) fn box_face(min: &Vec3, max: &Vec3, face: usize, x: &Vec3) -> Gap {
    let axis = face / 2;
    let mut normal = Vec3::zeros();
    if face.is_multiple_of(2) {
        normal[axis] = 1.0;
        Gap {
            distance: x[axis] - min[axis],
            normal,
        }
    } else {
        normal[axis] = -1.0;
        Gap {
            distance: max[axis] - x[axis],
            normal,
        }
    }
}

/// Distance to a box seen from outside.
pub(crate) fn outside_box(min: &Vec3, max: &Vec3, x: &Vec3) -> Gap {
    let nearest = Vec3::from_fn(|axis, _| x[axis].max(min[axis]).min(max[axis]));
    let away = x - nearest;
    let distance = away.norm();
    if distance > 0.0 {
        return Gap {
            distance,
            normal: away / distance,
        };
    }
    // In the box: the way out is through the nearest face.
    let mut least = Gap {
        distance: f64::NEG_INFINITY,
        normal: Vec3::zeros(),
    };
    for face in 0..6 {
        let inside = box_face(min, max, face, x);
        if -inside.distance > least.distance {
            least = Gap {
                distance: -inside.distance,
                normal: -inside.normal,
            };
        }
    }
    least
}
