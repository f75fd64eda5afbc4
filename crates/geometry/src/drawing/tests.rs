use super::*;
use crate::{Dimension, Shape};

fn options(format: DrawingFormat) -> DrawingOptions<'static> {
    DrawingOptions {
        format,
        layer: None,
        unit: 1e-3,
        translation: [0.0, 0.0],
        tolerance: None,
    }
}

/// A DXF file: entities as "KIND code value code value ...".
fn dxf(entities: &[&str]) -> String {
    let mut text = String::from("  0\nSECTION\n  2\nENTITIES\n");
    for entity in entities {
        let mut words = entity.split(' ');
        text += &format!("  0\n{}\n", words.next().unwrap());
        for word in words {
            text += &format!("{word}\n");
        }
    }
    text + "  0\nENDSEC\n  0\nEOF\n"
}

fn read_dxf(entities: &[&str]) -> Result<Vec<Contour>, GeometryError> {
    read_drawing(dxf(entities).as_bytes(), &options(DrawingFormat::Dxf))
}

fn svg(content: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:i=\"urn:i\" viewBox=\"0 0 1 1\">\n{content}\n</svg>"
    )
}

fn read_svg(content: &str) -> Result<Vec<Contour>, GeometryError> {
    read_drawing(svg(content).as_bytes(), &options(DrawingFormat::Svg))
}

fn area(contours: &[Contour]) -> f64 {
    Shape::from_contours(contours, None)
        .unwrap()
        .volume(Dimension::PlaneStrain)
        * 1e6
}

/// A quarter of a square of 10 with a rounded corner of radius 4, its lines in disorder.
const QUARTER: &[&str] = &[
    "LINE 10 0 20 0 11 10 21 0",
    "ARC 10 6 20 6 40 4 50 0 51 90",
    "LINE 10 6 20 10 11 0 21 10",
    "TEXT 1 hello 10 3 20 3",
    "LINE 10 10 20 6.0000001 11 10 21 0",
    "LINE 10 0 20 0 11 0 21 10",
];

#[test]
fn single_lines_and_arcs_are_joined_to_one_outline() {
    let contours = read_dxf(QUARTER).unwrap();
    assert_eq!(contours.len(), 1);
    assert!(contours[0].is_closed());
    let radii: Vec<f64> = contours[0].radii().collect();
    // The arc is in two halves.
    assert_eq!(radii.len(), 2);
    assert!((radii[0] - 4e-3).abs() < 1e-9);
    // 18 pieces of 5° instead of the quarter circle.
    let cut = 16.0 - 18.0 * 8.0 * (5.0_f64.to_radians()).sin();
    let found = area(&contours);
    assert!((found - (100.0 - cut)).abs() < 1e-4, "{found}");
}

#[test]
fn polylines_have_bulges_and_mirrored_ones_are_turned_back() {
    // A slot: two half circles of radius 1 and straight lines of length 4.
    let light = "LWPOLYLINE 8 slot 90 4 70 1 10 0 20 -1 10 4 20 -1 42 1 10 4 20 1 10 0 20 1 42 1";
    let old = [
        "POLYLINE 66 1 70 1",
        "VERTEX 10 0 20 -1",
        "VERTEX 10 4 20 -1 42 1",
        "VERTEX 10 4 20 1",
        "VERTEX 10 0 20 1 42 1",
        "SEQEND 8 0",
    ];
    let first = read_dxf(&[light]).unwrap();
    assert_eq!(first, read_dxf(&old).unwrap());
    let circle = 72.0 * 0.5 * (5.0_f64.to_radians()).sin();
    assert!((area(&first) - (8.0 + circle)).abs() < 1e-9);
    let mirrored = read_dxf(&[&format!("{light} 210 0 220 0 230 -1")]).unwrap();
    assert!((area(&mirrored) - area(&first)).abs() < 1e-9);
    let left = |contour: &Contour| contour.points().iter().map(|p| p[0]).fold(1.0, f64::min);
    assert!((left(&mirrored[0]) + 4e-3).abs() < 1e-15);
    // A circle and an arc over the start of the angles.
    let round = read_dxf(&["CIRCLE 10 1 20 1 40 2", "ARC 10 9 20 0 40 1 50 350 51 20"]).unwrap();
    assert!((area(&round[..1]) - 4.0 * circle).abs() < 1e-9);
    let turn: f64 = round[1].bulges().iter().map(|b| 4.0 * b.atan()).sum();
    assert!((turn.to_degrees() - 30.0).abs() < 1e-9);
}

#[test]
fn mistakes_in_dxf_files_name_the_place() {
    let text = |entities: &[&str]| read_dxf(entities).unwrap_err().to_string();
    assert_eq!(
        text(&["LINE 10 0 20 0 11 1 21 0", "SPLINE 8 die 70 8"]),
        "line 16 of the drawing: SPLINE (of layer \"die\") cannot be used; convert it to a polyline \
         of arcs or straight pieces in the drawing program"
    );
    assert_eq!(
        text(&["LINE 10 0 20 zero 11 1 21 0"]),
        "line 10 of the drawing: \"zero\" is no number of group 20"
    );
    assert!(text(&["INSERT 2 part"]).contains("explode the block"));
    // A line drawn twice.
    let twice = text(&[QUARTER[0], QUARTER[0], QUARTER[5]]);
    assert!(
        twice.starts_with("3 lines of the drawing end at (0, 0) m"),
        "{twice}"
    );
    let read = |bytes: &[u8], layer| {
        let options = DrawingOptions {
            layer,
            ..options(DrawingFormat::Dxf)
        };
        read_drawing(bytes, &options).unwrap_err().to_string()
    };
    assert_eq!(
        read(dxf(&["LINE 8 a 10 0 20 0 11 1 21 0"]).as_bytes(), Some("b")),
        "the drawing has no layer \"b\"; its layers with lines are a"
    );
    assert!(read(b"AutoCAD Binary DXF\r\n\x1a\0", None).contains("save it as text"));
    assert!(read(b"<svg>\n</svg>\n", None).contains("this is no DXF file"));
    assert!(read(b"0\nSECTION\n2\nENTITIES\n0\nLINE\n", None).contains("ends within"));
    assert!(read(dxf(&[]).as_bytes(), None).contains("no lines"));
}

#[test]
fn an_open_outline_names_its_ends_unless_the_tolerance_covers_the_gap() {
    let gap = [
        "LINE 10 0 20 0 11 10 21 0",
        "LINE 10 10 20 0 11 5 21 5",
        "LINE 10 5 20 5 11 0 21 0.1",
    ];
    let contours = read_dxf(&gap).unwrap();
    let error = Shape::from_contours(&contours, None).unwrap_err();
    assert!(
        matches!(error, GeometryError::OpenContour { gap, .. } if (gap - 1e-4).abs() < 1e-12),
        "{error}"
    );
    let options = DrawingOptions {
        tolerance: Some(2e-4),
        ..options(DrawingFormat::Dxf)
    };
    let contours = read_drawing(dxf(&gap).as_bytes(), &options).unwrap();
    assert!(contours[0].is_closed() && contours[0].points().len() == 3);
}

#[test]
fn all_commands_of_a_path_are_understood() {
    // The same square with a round corner, by absolute and relative commands.
    let absolute = "M 0 0 H 10 V 6 A 4 4 0 0 1 6 10 L 0 10 Z";
    let relative = "m 0 0 h 10 v 6 a 4 4 0 0 1 -4 4 l -6 0 z";
    let path = |d: &str| read_svg(&format!("<path d=\"{d}\"/>")).unwrap();
    let contours = path(absolute);
    assert_eq!(contours, path(relative));
    assert!((contours[0].radii().next().unwrap() - 4e-3).abs() < 1e-15);
    assert!(
        (area(&contours) - 100.0 + 16.0 - 18.0 * 8.0 * 5.0_f64.to_radians().sin()).abs() < 1e-9
    );
    // y points down in the file.
    assert!(contours[0].points().iter().all(|point| point[1] <= 0.0));
    // A parabola over [0, 2] with height 1 has 2/3 of its box, and so has its smooth continuation.
    let curves = path("M 0 0 Q 1 2 2 0 T 4 0 L 4 -3 H 0 Z");
    assert!(
        (area(&curves) - 12.0).abs() < 4.0 * 5e-4,
        "{}",
        area(&curves)
    );
    // Four smooth cubic curves for a circle of radius 1: area π to 2.8e-4 of the curves themselves.
    let k = 0.552_284_75;
    let circle = path(&format!(
        "M 1 0 C 1 {k} {k} 1 0 1 S -1 {k} -1 0 S -{k} -1 0 -1 S 1 -{k} 1 0 Z"
    ));
    assert!(
        (area(&circle) - std::f64::consts::PI).abs() < 3e-3,
        "{}",
        area(&circle)
    );
    // Two lines in one path, the second from where the first began.
    assert_eq!(path("M 1 1 h 1 v 1 z l 5 5").len(), 2);
}

#[test]
fn curves_deviate_by_the_tolerance() {
    let content = "<path d=\"M 0 0 C 0 40 100 40 100 0 Z\"/>";
    let count = |tolerance| {
        let options = DrawingOptions {
            tolerance: Some(tolerance),
            ..options(DrawingFormat::Svg)
        };
        read_drawing(svg(content).as_bytes(), &options).unwrap()[0]
            .points()
            .len()
    };
    // The number of pieces grows with the inverse square root.
    let (coarse, fine) = (count(1e-4), count(1e-6));
    assert!(fine > 8 * coarse && fine < 12 * coarse, "{coarse} {fine}");
}

#[test]
fn shapes_and_transformations_are_understood() {
    let one = |content: &str| area(&read_svg(content).unwrap());
    let circle = 72.0 * 0.5 * (5.0_f64.to_radians()).sin();
    assert!((one("<circle cx=\"3\" cy=\"4\" r=\"2px\"/>") - 4.0 * circle).abs() < 1e-9);
    assert!((one("<rect x=\"1\" y=\"2\" width=\"3\" height=\"4\"/>") - 12.0).abs() < 1e-9);
    let rounded = one("<rect width=\"3\" height=\"4\" rx=\"1\"/>");
    assert!((rounded - (12.0 - 4.0 + circle)).abs() < 1e-9);
    assert!((one("<polygon points=\"0,0 4,0 0,4\"/>") - 8.0).abs() < 1e-9);
    // An ellipse is no circle: it is made of straight pieces, each within the tolerance.
    let ellipse = one("<ellipse rx=\"3\" ry=\"1\"/>");
    assert!(
        (ellipse / std::f64::consts::PI - 3.0).abs() < 2e-2,
        "{ellipse}"
    );
    // A turned and mirrored circle is one still, a stretched one is not.
    let group = |transform: &str| {
        let content =
            format!("<g transform=\"{transform}\"><circle r=\"1\" transform=\"scale(2)\"/></g>");
        read_svg(&content).unwrap()
    };
    let turned = group("translate(5 0) rotate(30) scale(-1 1)");
    assert!((turned[0].radii().next().unwrap() - 2e-3).abs() < 1e-15);
    assert!((area(&turned) - 4.0 * circle).abs() < 1e-9);
    let stretched = group("scale(2 1)");
    assert_eq!(stretched[0].radii().count(), 0);
    assert!((area(&stretched) / (8.0 * std::f64::consts::PI) - 1.0).abs() < 5e-3);
}

#[test]
fn layers_of_svg_files_are_groups_by_id_or_label() {
    let content = "<defs><path d=\"M 0 0 H 1\"/></defs>\
        <g i:label=\"die\"><path id=\"wall\" d=\"M 0 0 H 8\"/><path d=\"M 9 0 H 12\"/></g>\
        <g id=\"notes\"><text>12 mm</text><use href=\"#wall\"/></g>\
        <g style=\"display: none\"><use href=\"#wall\"/></g>";
    let lines = |layer| {
        let options = DrawingOptions {
            layer: Some(layer),
            ..options(DrawingFormat::Svg)
        };
        read_drawing(svg(content).as_bytes(), &options)
    };
    assert_eq!(lines("die").unwrap().len(), 2);
    assert_eq!(lines("wall").unwrap().len(), 1);
    assert!(
        lines("notes")
            .unwrap_err()
            .to_string()
            .contains("unlink the clone")
    );
    assert_eq!(
        lines("billet").unwrap_err().to_string(),
        "the drawing has no layer \"billet\"; its layers with lines are die, wall, notes"
    );
    assert!(
        read_svg("<path d=\"M 0 0 L x\"/>")
            .unwrap_err()
            .to_string()
            .starts_with("line 2 of the drawing: <path>: d: ")
    );
    assert!(
        read_svg("<rect width=\"1cm\" height=\"2\"/>")
            .unwrap_err()
            .to_string()
            .contains("without unit")
    );
    assert!(
        read_svg("<g>")
            .unwrap_err()
            .to_string()
            .contains("no SVG file")
    );
}
