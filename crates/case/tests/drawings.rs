//! Bodies and obstacles from DXF and SVG files.

#[expect(dead_code, reason = "only the good case is needed here")]
mod common;

use common::GOOD;
use jstsph_case::{Case, parse};
use jstsph_contact::Surface;
use jstsph_tensor::Vec3;

/// A plate of 8 mm by 56 mm with a hole, as a drawing.
const PLATE: &str = r#"<svg xmlns="http://www.w3.org/2000/svg">
<rect id="plate" y="-57" width="8" height="56"/>
<circle id="hole" cx="4" cy="-30" r="2"/>
<path id="wall" d="M -1 0 V -60"/>
</svg>
"#;

/// The good case with a piece of it replaced, in a folder with the drawing.
fn case(from: &str, to: &str) -> Result<Case, String> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("plate.svg"), PLATE).unwrap();
    std::fs::write(folder.path().join("plate.step"), PLATE).unwrap();
    assert_eq!(GOOD.matches(from).count(), 1);
    let file = folder.path().join("c.toml").display().to_string();
    parse("c", &file, &GOOD.replace(from, to), &[]).map_err(|error| {
        let folder = folder.path().display().to_string();
        error.to_string().replace(&folder, "FOLDER")
    })
}

const BODY: &str = r#"shape = { box = { min = ["0 mm", "1 mm"], max = ["8 mm", "57 mm"] } }
lattice = { counts = [8, 50] }"#;
const PLANE: &str = r#"plane = { point = [0, 0], normal = [0, 1] }"#;

fn body(shape: &str) -> Result<Case, String> {
    case(
        BODY,
        &format!("shape = {shape}\nlattice = {{ spacing = \"1 mm\" }}"),
    )
}

#[test]
fn a_body_has_the_outline_of_the_drawing_and_its_holes() {
    let plate =
        body(r#"{ drawing = { file = "plate.svg", unit = "mm", layer = "plate" } }"#).unwrap();
    assert_eq!(plate.particles(), 9 * 57);
    assert_eq!(plate.model.bodies[0].body.positions[0].y, 1e-3);
    // Half as large, and the resolved case says the same again.
    let half = r#"{ drawing = { file = "plate.svg", unit = "mm", layer = "plate", scale = 0.5, translate = ["1 mm", 0.0] } }"#;
    let half = body(half).unwrap();
    let corner = half.model.bodies[0].body.positions[0];
    assert!(
        (corner - Vec3::new(1e-3, 0.5e-3, 0.0)).norm() < 1e-15,
        "{corner}"
    );
    assert!(
        half.resolved.contains("layer = \"plate\""),
        "{}",
        half.resolved
    );

    let difference = r#"{ difference = [
        { drawing = { file = "plate.svg", unit = "mm", layer = "plate" } },
        { drawing = { file = "plate.svg", unit = "mm", layer = "hole" } }] }"#;
    let pierced = body(&difference.replace('\n', "")).unwrap();
    let volume: f64 = pierced.model.bodies[0].body.volumes.iter().sum();
    let hole = 36.0 * 4.0 * 5.0_f64.to_radians().sin();
    assert!(
        (volume * 1e6 / (448.0 - hole) - 1.0).abs() < 1e-5,
        "{volume}"
    );
}

#[test]
fn an_obstacle_is_free_where_the_point_is() {
    let obstacle = |point: &str| {
        let drawing = format!(
            "drawing = {{ file = \"plate.svg\", unit = \"mm\", layer = \"wall\", free_point = {point} }}"
        );
        case(PLANE, &drawing)
    };
    let model = obstacle("[0, \"5 mm\"]").unwrap().model;
    let Surface::Profile(_) = &model.obstacles[0].obstacle.surface else {
        panic!("a drawing is a profile");
    };
    let gap = |x| {
        model.obstacles[0]
            .obstacle
            .surface
            .gap(&Vec3::new(x, 0.01, 0.0))
            .distance
    };
    assert_eq!((gap(0.0), gap(-3e-3)), (1e-3, -2e-3));
    let error = obstacle("[\"-2 mm\", 0]").unwrap_err();
    assert!(
        error.contains("body `billet` overlaps obstacle `floor`"),
        "{error}"
    );
    let error = obstacle("[-1e-3, 0]").unwrap_err();
    assert!(error.contains("lies on a line of the drawing"), "{error}");
    assert!(error.contains("| drawing = {"), "{error}");
}

#[test]
fn mistakes_name_file_and_reason() {
    let error = |shape: &str| body(shape).unwrap_err();
    let all = error(r#"{ drawing = { file = "plate.svg", unit = "mm" } }"#);
    let expected = "`body.billet.shape.drawing`: FOLDER/plate.svg: the outline is open: it begins \
                    at (-0.001, 0) m and ends at (-0.001, 0.06) m, 6.000e-2 m apart";
    assert!(all.contains(expected), "{all}");
    let format = error(r#"{ drawing = { file = "plate.step", unit = "mm" } }"#);
    assert!(
        format.contains("FOLDER/plate.step: the name must end with .dxf or .svg"),
        "{format}"
    );
    let layer = error(r#"{ drawing = { file = "plate.svg", unit = "mm", layer = "plat" } }"#);
    assert!(
        layer.contains("no layer \"plat\"; its layers with lines are plate, hole, wall"),
        "{layer}"
    );
    let missing = error(r#"{ drawing = { file = "plate.dxf", unit = "mm" } }"#);
    assert!(
        missing.contains("FOLDER/plate.dxf: cannot be read"),
        "{missing}"
    );
    let unit = error(r#"{ drawing = { file = "plate.svg" } }"#);
    assert!(unit.contains("`unit` is missing"), "{unit}");
}

#[test]
fn copies_of_all_files_can_take_the_place_of_the_files() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("plate.svg"), PLATE).unwrap();
    std::fs::create_dir(folder.path().join("materials")).unwrap();
    let (before, after) = GOOD.split_once("[material.al").unwrap();
    let (material, after) = after.split_once("[[boundary]]").unwrap();
    let material = format!("[material.al{material}");
    std::fs::write(folder.path().join("materials/al.toml"), material).unwrap();
    let drawn = |layer: &str, more: &str| {
        format!("drawing = {{ file = \"plate.svg\", unit = 'mm', layer = \"{layer}\"{more} }}")
    };
    let text =
        format!("include = [\"materials/al.toml\"] # aluminium\n{before}[[boundary]]{after}")
            .replace(
                BODY,
                &format!(
                    "shape = {{ {} }}\nlattice = {{ spacing = \"1 mm\" }}",
                    drawn("plate", "")
                ),
            )
            .replace(PLANE, &drawn("wall", ", free_point = [0, 0]"));
    let case = parse(
        "c",
        &folder.path().join("c.toml").display().to_string(),
        &text,
        &[],
    )
    .unwrap();
    let names: Vec<&str> = case
        .inputs
        .iter()
        .map(|input| input.name.as_str())
        .collect();
    assert_eq!(names, ["1-plate.svg", "2-al.toml"]);
    let original = case.original_with_copies("inputs");
    assert!(
        original.starts_with("include = [\"inputs/2-al.toml\"] # aluminium\n"),
        "{original}"
    );
    assert_eq!(original.matches("file = \"inputs/1-plate.svg\"").count(), 2);

    // The copies are all that is needed, and copies of them are called the same.
    let other = tempfile::tempdir().unwrap();
    std::fs::create_dir(other.path().join("inputs")).unwrap();
    for input in &case.inputs {
        std::fs::write(other.path().join("inputs").join(&input.name), &input.bytes).unwrap();
    }
    drop(folder);
    let resolved = case.resolved_with_copies("inputs");
    for text in [&original, &resolved] {
        let file = other.path().join("case.toml").display().to_string();
        let again = parse("c", &file, text, &[]).unwrap();
        assert_eq!(again.particles(), case.particles());
        assert_eq!(again.resolved_with_copies("inputs"), resolved);
    }
}
