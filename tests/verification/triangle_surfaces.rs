//! Bodies and obstacles from STL files against the primitives they approximate.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

use jstsph_case::{Case, parse};
use jstsph_solver::Simulation;
use jstsph_tensor::Vec3;

/// Text of an STL file; the corners are in the unit of the file.
fn stl(triangles: &[[[f64; 3]; 3]]) -> String {
    let mut text = String::from("solid part\n");
    for triangle in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle {
            let _ = writeln!(text, "vertex {} {} {}", *x as f32, *y as f32, *z as f32);
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid part\n"
}

/// Two triangles of a quadrilateral.
fn quad([a, b, c, d]: [[f64; 3]; 4]) -> [[[f64; 3]; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Vec<[[f64; 3]; 3]> {
    let at = |i: usize| std::array::from_fn(|axis| [low, high][(i >> axis) & 1][axis]);
    [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ]
    .iter()
    .flat_map(|corners| quad(corners.map(at)))
    .collect()
}

/// A cylinder along z with this many sides.
fn cylinder(radius: f64, height: f64, sides: usize) -> Vec<[[f64; 3]; 3]> {
    let at = |side: usize, z: f64| {
        let angle = TAU * (side % sides) as f64 / sides as f64;
        [radius * angle.cos(), radius * angle.sin(), z]
    };
    (0..sides)
        .flat_map(|side| {
            let (a, b) = (at(side, 0.0), at(side + 1, 0.0));
            let (c, d) = (at(side + 1, height), at(side, height));
            let caps = [[[0.0; 3], b, a], [[0.0, 0.0, height], d, c]];
            quad([a, b, c, d]).into_iter().chain(caps)
        })
        .collect()
}

/// A copper cube of 4 mm that falls with 100 m/s onto an obstacle 1 µm below it.
fn case(folder: &Path, shape: &str, obstacle: &str) -> Case {
    let text = format!(
        "dimension = \"3d\"\n[time]\nend = \"5 us\"\n[[body]]\nname = \"cube\"\nshape = {shape}\n\
         lattice = {{ spacing = \"0.5 mm\" }}\nmaterial = \"copper_taylor\"\n\
         velocity = [0, 0, -100]\n[[obstacle]]\n{obstacle}\n"
    );
    let file = folder.join("c.toml").display().to_string();
    parse("c", &file, &text, &[]).unwrap_or_else(|error| panic!("{error}"))
}

const CUBE: &str =
    "{ box = { min = [\"-2 mm\", \"-2 mm\", 0], max = [\"2 mm\", \"2 mm\", \"4 mm\"] } }";

fn positions(case: Case) -> Vec<Vec3> {
    let end = case.time.end;
    let mut simulation = Simulation::new(case.model).unwrap();
    while simulation.time() < end {
        simulation.advance_step(end).unwrap();
    }
    simulation.state().position.clone()
}

fn largest_difference(a: &[Vec3], b: &[Vec3]) -> f64 {
    assert_eq!(a.len(), b.len());
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).norm());
    distances.fold(0.0, f64::max)
}

#[test]
fn a_body_from_a_file_is_that_of_the_primitive() {
    let folder = tempfile::tempdir().unwrap();
    let file = stl(&cuboid([-2.0, -2.0, 0.0], [2.0, 2.0, 4.0]));
    std::fs::write(folder.path().join("cube.stl"), file).unwrap();
    let wall = "plane = { point = [0, 0, \"-1 um\"], normal = [0, 0, 1] }";
    let part = "{ stl = { file = \"cube.stl\", unit = \"mm\" } }";
    let ours = case(folder.path(), part, wall);
    let theirs = case(folder.path(), CUBE, wall);
    let (a, b) = (&ours.model.bodies[0].body, &theirs.model.bodies[0].body);
    assert!(largest_difference(&a.positions, &b.positions) < 1e-15);
    for (a, b) in a.volumes.iter().zip(&b.volumes) {
        assert!((a / b - 1.0).abs() < 1e-9);
    }
    // The resolved case stands elsewhere and still finds the file.
    let again = parse("c", "/elsewhere/c.toml", &ours.resolved, &[]).unwrap();
    assert_eq!(again.model.bodies[0].body.positions, a.positions);
}

#[test]
fn a_tessellated_cylinder_has_the_volume_of_its_prism() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("bar.stl"), stl(&cylinder(2.0, 4.0, 64))).unwrap();
    let wall = "plane = { point = [0, 0, \"-1 um\"], normal = [0, 0, 1] }";
    let part = "{ stl = { file = \"bar.stl\", unit = \"mm\" } }";
    let case = case(folder.path(), part, wall);
    let body = &case.model.bodies[0].body;
    // Area of the 64-gon; the coordinates have single precision.
    let exact = 32.0 * 4e-6 * (TAU / 64.0).sin() * 4e-3;
    let volume: f64 = body.volumes.iter().sum();
    assert!((volume / exact - 1.0).abs() < 1e-6, "{volume} {exact}");
    assert!(body.volumes.iter().all(|&volume| volume > 0.0));
    // Half of the corners of the prism's lattice lie on its rim: the bar's own builder agrees.
    assert_eq!(body.positions.len(), 49 * 9);
}

#[test]
fn an_impact_on_triangles_is_that_on_the_primitive() {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, triangles: &[[[f64; 3]; 3]]| {
        std::fs::write(folder.path().join(name), stl(triangles)).unwrap();
    };
    let run = |obstacle: &str| positions(case(folder.path(), CUBE, obstacle));

    // The corner of a block, between particles: where one lies on two faces the way out is a choice.
    // All coordinates are held exactly by the single precision of the file, in mm.
    let (top, side) = (2.0_f64.powi(-10), 0.3125);
    save("block.stl", &cuboid([side, side, -4.0], [8.0, 8.0, -top]));
    let flat = run("stl = { file = \"block.stl\", unit = \"mm\" }");
    let exact = run(&format!(
        "box = {{ min = [{0:e}, {0:e}, \"-4 mm\"], max = [\"8 mm\", \"8 mm\", {1:e}] }}",
        side * 1e-3,
        -top * 1e-3
    ));
    let difference = largest_difference(&flat, &exact);
    // Rounding decides when a particle counts as touching, for which 5e-10 m (1e-6 spacings) are
    // allowed; measured 9e-10 m.
    assert!(difference < 5e-9, "{difference:e} m");
}

#[test]
fn broken_files_are_named_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let mut open = cuboid([0.0; 3], [1.0; 3]);
    open.pop();
    std::fs::write(folder.path().join("open.stl"), stl(&open)).unwrap();
    let message = |file: &str| {
        let text = format!(
            "dimension = \"3d\"\n[time]\nend = 1e-6\n[[body]]\nname = \"b\"\n\
             shape = {{ stl = {{ file = \"{file}\", unit = \"mm\" }} }}\n\
             lattice = {{ spacing = 1e-4 }}\nmaterial = \"copper_taylor\"\n"
        );
        let path = folder.path().join("c.toml").display().to_string();
        parse("c", &path, &text, &[]).unwrap_err().to_string()
    };
    let open = message("open.stl");
    assert!(open.contains("c.toml:6:26:"), "{open}");
    assert!(
        open.contains("the surface is not closed: 3 edges"),
        "{open}"
    );
    let missing = message("none.stl");
    assert!(missing.contains("cannot read"), "{missing}");
}
