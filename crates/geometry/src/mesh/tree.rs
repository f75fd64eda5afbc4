//! A tree of boxes around triangles.

use jstsph_tensor::Vec3;

use super::nearest::{Feature, on_triangle};

/// Most triangles of a leaf.
const LEAF: usize = 4;
/// Room for the branches that wait while another is searched: the depth of a balanced tree of all
/// triangles that 32 bits can count.
const STACK: usize = 64;

/// A box and what it contains: triangles of a leaf, else two boxes, the first next in the list.
#[derive(Clone, Debug)]
struct Node {
    low: Vec3,
    high: Vec3,
    /// First triangle of a leaf; the second box otherwise.
    first: u32,
    /// Number of triangles of a leaf; 0 otherwise.
    count: u32,
}

#[derive(Clone, Debug)]
pub(super) struct Tree {
    nodes: Vec<Node>,
    order: Vec<u32>,
}

/// The nearest point of all.
pub(super) struct Found {
    pub(super) triangle: u32,
    pub(super) point: Vec3,
    pub(super) feature: Feature,
}

impl Tree {
    /// A tree over some of the triangles, at least one.
    pub(super) fn new(points: &[Vec3], triangles: &[[u32; 3]], mut order: Vec<u32>) -> Self {
        let boxes: Vec<(Vec3, Vec3)> = triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| points[corner as usize]);
                (a.inf(&b).inf(&c), a.sup(&b).sup(&c))
            })
            .collect();
        let mut nodes = Vec::with_capacity(order.len());
        build(&mut nodes, &boxes, &mut order, 0);
        Self { nodes, order }
    }

    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        (self.nodes[0].low, self.nodes[0].high)
    }

    pub(super) fn nearest(&self, points: &[Vec3], triangles: &[[u32; 3]], x: &Vec3) -> Found {
        let mut best = (f64::INFINITY, None);
        let mut stack = [(0.0, 0_u32); STACK];
        let mut waiting = 1;
        stack[0] = (self.square(0, x), 0);
        while waiting > 0 {
            waiting -= 1;
            let (square, at) = stack[waiting];
            // Written so that NaN is searched and ends at the first leaf.
            if square >= best.0 {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count == 0 {
                let [near, far] = [at + 1, node.first].map(|at| (self.square(at, x), at));
                let [near, far] = if far.0 < near.0 {
                    [far, near]
                } else {
                    [near, far]
                };
                stack[waiting] = far;
                stack[waiting + 1] = near;
                waiting += 2;
                continue;
            }
            for &triangle in &self.order[node.first as usize..][..node.count as usize] {
                let corners = triangles[triangle as usize].map(|corner| points[corner as usize]);
                let (point, feature) = on_triangle(x, corners);
                let square = (x - point).norm_squared();
                if best.1.is_none() || square < best.0 {
                    best = (
                        square,
                        Some(Found {
                            triangle,
                            point,
                            feature,
                        }),
                    );
                }
            }
        }
        best.1.expect("a tree has a triangle")
    }

    /// Square of the distance from a box.
    fn square(&self, at: u32, x: &Vec3) -> f64 {
        let node = &self.nodes[at as usize];
        let beyond = (node.low - x).sup(&(x - node.high)).sup(&Vec3::zeros());
        beyond.norm_squared()
    }

    /// All triangles of the leaves whose box meets a box.
    pub(super) fn visit_box(&self, low: &Vec3, high: &Vec3, visit: &mut dyn FnMut(u32)) {
        let mut stack = vec![0_u32];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            if (0..3).any(|axis| node.low[axis] > high[axis] || node.high[axis] < low[axis]) {
                continue;
            }
            if node.count == 0 {
                stack.extend([at + 1, node.first]);
            } else {
                let triangles = &self.order[node.first as usize..][..node.count as usize];
                triangles.iter().for_each(|&triangle| visit(triangle));
            }
        }
    }

    /// All triangles whose box the line along x through (·, y, z) meets.
    pub(super) fn visit_line(&self, y: f64, z: f64, visit: &mut dyn FnMut(u32)) {
        let mut stack = vec![0_u32];
        while let Some(at) = stack.pop() {
            let node = &self.nodes[at as usize];
            let is_within =
                (node.low.y..=node.high.y).contains(&y) && (node.low.z..=node.high.z).contains(&z);
            if !is_within {
                continue;
            }
            if node.count == 0 {
                stack.extend([at + 1, node.first]);
            } else {
                let triangles = &self.order[node.first as usize..][..node.count as usize];
                triangles.iter().for_each(|&triangle| visit(triangle));
            }
        }
    }
}

/// Adds the box around some triangles, and those in it; `first` is the place of these triangles.
fn build(nodes: &mut Vec<Node>, boxes: &[(Vec3, Vec3)], order: &mut [u32], first: usize) {
    let start = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (low, high) = order.iter().fold(start, |(low, high), &triangle| {
        let (a, b) = &boxes[triangle as usize];
        (low.inf(a), high.sup(b))
    });
    let place = nodes.len();
    nodes.push(Node {
        low,
        high,
        first: first as u32,
        count: order.len() as u32,
    });
    if order.len() <= LEAF {
        return;
    }
    let axis = (high - low).imax();
    let centre = |triangle: u32| {
        let (low, high) = &boxes[triangle as usize];
        low[axis] + high[axis]
    };
    // Equal centres in the order of the triangles, so that the tree is the same everywhere.
    order.sort_by(|&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
    let middle = order.len() / 2;
    let (lower, upper) = order.split_at_mut(middle);
    build(nodes, boxes, lower, first);
    nodes[place].first = nodes.len() as u32;
    nodes[place].count = 0;
    build(nodes, boxes, upper, first + middle);
}
