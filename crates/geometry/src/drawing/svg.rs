//! Reading SVG files: which elements are lines, and where they are.
//!
//! Source: W3C, Scalable Vector Graphics 2, chapters "Paths" and "Basic shapes".

use kurbo::Affine;
use roxmltree::{Document, Node};
use svgtypes::{Length, LengthUnit, PathParser, PathSegment, PointsParser, Transform};

use super::svg_path::Lines;
use super::{TOLERANCE, diagonal};
use crate::{Contour, GeometryError};

/// Elements whose content is shown elsewhere or not at all.
const NOT_DRAWN: &[&str] = &["defs", "clipPath", "mask", "marker", "pattern", "symbol"];

/// Names in a message.
const NAMES: usize = 20;

/// Lines of the file in its own units with y upwards, and the tolerance: that given or the default.
pub(super) fn read(
    bytes: &[u8],
    layer: Option<&str>,
    tolerance: Option<f64>,
) -> Result<(Vec<Contour>, f64), GeometryError> {
    let text = std::str::from_utf8(bytes).map_err(|error| GeometryError::UnreadableDrawing {
        line: 1,
        reason: format!("this is no SVG file: {error}"),
    })?;
    let document = Document::parse(text).map_err(|error| GeometryError::UnreadableDrawing {
        line: error.pos().row as usize,
        reason: format!("this is no SVG file: {error}"),
    })?;
    let mut lines = Lines::default();
    let mut is_known = layer.is_none();
    let mut names: Vec<String> = Vec::new();
    for node in document.descendants().filter(Node::is_element) {
        let own = node.ancestors().filter(Node::is_element);
        let groups: Vec<Node<'_, '_>> = own.collect();
        if groups.iter().any(is_not_drawn) {
            continue;
        }
        let is_chosen = |wanted| groups.iter().any(|node| has_name(node, wanted));
        is_known |= layer.is_some_and(|wanted| has_name(&node, wanted));
        names.extend(name(&node).filter(|_| names.len() < NAMES));
        if layer.is_none_or(is_chosen) {
            let segments = Element { node, text }.segments()?;
            if !segments.is_empty() {
                lines.add(&segments, transformation(&groups, text)?);
            }
        }
    }
    if let (false, Some(layer)) = (is_known, layer) {
        return Err(GeometryError::UnknownLayer {
            layer: layer.to_owned(),
            available: names,
        });
    }
    let tolerance = tolerance.unwrap_or_else(|| TOLERANCE * diagonal(lines.points()));
    Ok((lines.flatten(tolerance)?, tolerance))
}

fn is_not_drawn(node: &Node<'_, '_>) -> bool {
    let is_none = |style: &str| style.replace(' ', "").contains("display:none");
    NOT_DRAWN.contains(&node.tag_name().name())
        || node.attribute("display") == Some("none")
        || node.attribute("style").is_some_and(is_none)
}

/// The label that Inkscape gives a layer.
fn label<'a>(node: &Node<'a, '_>) -> Option<&'a str> {
    let is_label = |attribute: &roxmltree::Attribute<'_, '_>| {
        attribute.name() == "label" && attribute.namespace().is_some()
    };
    node.attributes()
        .find(is_label)
        .map(|attribute| attribute.value())
}

fn has_name(node: &Node<'_, '_>, wanted: &str) -> bool {
    node.attribute("id") == Some(wanted) || label(node) == Some(wanted)
}

fn name(node: &Node<'_, '_>) -> Option<String> {
    let name = label(node).or_else(|| node.attribute("id"))?;
    Some(name.to_owned())
}

/// From the coordinates of an element to those of the file with y upwards; the element comes first.
fn transformation(groups: &[Node<'_, '_>], text: &str) -> Result<Affine, GeometryError> {
    let mut all = Affine::IDENTITY;
    for node in groups {
        if let Some(value) = node.attribute("transform") {
            let own: Transform = value
                .parse()
                .map_err(|error| unreadable(node, text, format!("transform: {error}")))?;
            all = Affine::new([own.a, own.b, own.c, own.d, own.e, own.f]) * all;
        }
    }
    Ok(Affine::FLIP_Y * all)
}

fn line_of(node: &Node<'_, '_>, text: &str) -> usize {
    text[..node.range().start].matches('\n').count() + 1
}

fn unreadable(node: &Node<'_, '_>, text: &str, reason: String) -> GeometryError {
    GeometryError::UnreadableDrawing {
        line: line_of(node, text),
        reason: format!("<{}>: {reason}", node.tag_name().name()),
    }
}

/// An element and the text of the file it stands in.
struct Element<'a, 'input> {
    node: Node<'a, 'input>,
    text: &'a str,
}

impl Element<'_, '_> {
    /// The element as a path; empty if it is none.
    fn segments(&self) -> Result<Vec<PathSegment>, GeometryError> {
        let unsupported = |remedy| GeometryError::UnsupportedDrawing {
            line: line_of(&self.node, self.text),
            item: format!("<{}>", self.node.tag_name().name()),
            remedy,
        };
        match self.node.tag_name().name() {
            "path" => PathParser::from(self.node.attribute("d").unwrap_or(""))
                .collect::<Result<_, _>>()
                .map_err(|error| unreadable(&self.node, self.text, format!("d: {error}"))),
            "line" => Ok(vec![
                start(self.length("x1")?, self.length("y1")?),
                line(self.length("x2")?, self.length("y2")?),
            ]),
            kind @ ("polyline" | "polygon") => {
                let points = PointsParser::from(self.node.attribute("points").unwrap_or(""));
                let mut segments: Vec<PathSegment> = points.map(|(x, y)| line(x, y)).collect();
                if let Some(first) = segments.first_mut()
                    && let PathSegment::LineTo { x, y, .. } = *first
                {
                    *first = start(x, y);
                }
                if kind == "polygon" {
                    segments.push(PathSegment::ClosePath { abs: true });
                }
                Ok(segments)
            }
            "circle" => self.ellipse(self.length("r")?, self.length("r")?),
            "ellipse" => self.ellipse(self.length("rx")?, self.length("ry")?),
            "rect" => self.rectangle(),
            "use" => Err(unsupported("unlink the clone in the drawing program")),
            "svg" if self.node.parent_element().is_some() => {
                Err(unsupported("a drawing in a drawing: ungroup it"))
            }
            _ => Ok(Vec::new()),
        }
    }

    /// A length in user units; zero if it is not there.
    fn length(&self, name: &str) -> Result<f64, GeometryError> {
        let Some(value) = self.node.attribute(name) else {
            return Ok(0.0);
        };
        match value.trim().parse::<Length>() {
            Ok(length) if matches!(length.unit, LengthUnit::None | LengthUnit::Px) => {
                Ok(length.number)
            }
            _ => Err(unreadable(
                &self.node,
                self.text,
                format!("{name} is \"{value}\", but must be a number without unit"),
            )),
        }
    }

    fn ellipse(&self, rx: f64, ry: f64) -> Result<Vec<PathSegment>, GeometryError> {
        let (x, y) = (self.length("cx")?, self.length("cy")?);
        if rx <= 0.0 || ry <= 0.0 {
            return Ok(Vec::new());
        }
        Ok(vec![
            start(x + rx, y),
            arc(rx, ry, x - rx, y),
            arc(rx, ry, x + rx, y),
            PathSegment::ClosePath { abs: true },
        ])
    }

    fn rectangle(&self) -> Result<Vec<PathSegment>, GeometryError> {
        let (x, y) = (self.length("x")?, self.length("y")?);
        let (width, height) = (self.length("width")?, self.length("height")?);
        if width <= 0.0 || height <= 0.0 {
            return Ok(Vec::new());
        }
        // One radius stands for both; neither is more than half of its side.
        let given = |name| self.node.has_attribute(name).then(|| self.length(name));
        let (rx, ry) = (given("rx").transpose()?, given("ry").transpose()?);
        let (rx, ry) = (rx.or(ry).unwrap_or(0.0), ry.or(rx).unwrap_or(0.0));
        let (rx, ry) = (rx.min(0.5 * width), ry.min(0.5 * height));
        let (right, bottom) = (x + width, y + height);
        let mut segments = if rx > 0.0 && ry > 0.0 {
            vec![
                start(x + rx, y),
                line(right - rx, y),
                arc(rx, ry, right, y + ry),
                line(right, bottom - ry),
                arc(rx, ry, right - rx, bottom),
                line(x + rx, bottom),
                arc(rx, ry, x, bottom - ry),
                line(x, y + ry),
                arc(rx, ry, x + rx, y),
            ]
        } else {
            vec![
                start(x, y),
                line(right, y),
                line(right, bottom),
                line(x, bottom),
            ]
        };
        segments.push(PathSegment::ClosePath { abs: true });
        Ok(segments)
    }
}

fn start(x: f64, y: f64) -> PathSegment {
    PathSegment::MoveTo { abs: true, x, y }
}

fn line(x: f64, y: f64) -> PathSegment {
    PathSegment::LineTo { abs: true, x, y }
}

/// At most half an ellipse, in the direction from x to y.
fn arc(rx: f64, ry: f64, x: f64, y: f64) -> PathSegment {
    PathSegment::EllipticalArc {
        abs: true,
        rx,
        ry,
        x_axis_rotation: 0.0,
        large_arc: false,
        sweep: true,
        x,
        y,
    }
}
