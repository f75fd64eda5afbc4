//! Reading DXF files: lines of a code and a value each, in turn.
//!
//! Source: Autodesk, DXF reference, sections ENTITIES and "object coordinate systems".

use super::bulge;
use crate::{Contour, GeometryError};

/// First bytes of the binary form.
const BINARY: &[u8] = b"AutoCAD Binary DXF";

/// What stands in drawings beside the outline and is no line.
const PASSED_OVER: &[&str] = &[
    "TEXT",
    "MTEXT",
    "DIMENSION",
    "ARC_DIMENSION",
    "LEADER",
    "MLEADER",
    "MULTILEADER",
    "TOLERANCE",
    "POINT",
    "HATCH",
    "ATTDEF",
    "ATTRIB",
    "VIEWPORT",
    "SEQEND",
    "IMAGE",
    "WIPEOUT",
    "ACAD_TABLE",
];

/// One pair of the file.
#[derive(Clone, Copy)]
struct Pair<'a> {
    code: i32,
    value: &'a str,
    /// Line of the value, from 1.
    line: usize,
}

/// The pairs from one with code 0 to before the next.
struct Entity<'a> {
    kind: &'a str,
    line: usize,
    pairs: &'a [Pair<'a>],
}

/// Lines of the file in its own units.
pub(super) fn read(bytes: &[u8], layer: Option<&str>) -> Result<Vec<Contour>, GeometryError> {
    if bytes.starts_with(BINARY) {
        return Err(unreadable(
            1,
            "this is a binary DXF file; save it as text (ASCII)",
        ));
    }
    let text = String::from_utf8_lossy(bytes);
    let pairs = pairs(&text)?;
    let entities = entities(&pairs)?;
    let mut layers: Vec<&str> = Vec::new();
    let mut lines = Vec::new();
    let mut waiting = entities.iter().peekable();
    while let Some(entity) = waiting.next() {
        if PASSED_OVER.contains(&entity.kind) || entity.flag(67)? & 1 == 1 {
            continue;
        }
        // The vertices of a polyline are entities of their own.
        let mut vertices = Vec::new();
        while entity.kind == "POLYLINE"
            && let Some(vertex) = waiting.next_if(|next| next.kind == "VERTEX")
        {
            vertices.push(vertex);
        }
        let own = entity.text(8).unwrap_or("0");
        if !layers.contains(&own) {
            layers.push(own);
        }
        if layer.is_none_or(|wanted| wanted == own) {
            lines.push(entity.contour(&vertices)?);
        }
    }
    match layer {
        Some(wanted) if !layers.contains(&wanted) => Err(GeometryError::UnknownLayer {
            layer: wanted.to_owned(),
            available: layers.into_iter().map(str::to_owned).collect(),
        }),
        _ => Ok(lines),
    }
}

fn unreadable(line: usize, reason: impl Into<String>) -> GeometryError {
    GeometryError::UnreadableDrawing {
        line,
        reason: reason.into(),
    }
}

fn pairs(text: &str) -> Result<Vec<Pair<'_>>, GeometryError> {
    let mut found = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((number, code)) = lines.next() {
        // Some programs end a file with an empty line.
        let Some((_, value)) = lines.next() else {
            break;
        };
        let code = code.trim().parse().map_err(|_| {
            unreadable(
                number + 1,
                format!(
                    "\"{}\" is no group code: this is no DXF file",
                    shortened(code)
                ),
            )
        })?;
        found.push(Pair {
            code,
            value: value.trim(),
            line: number + 2,
        });
    }
    Ok(found)
}

fn shortened(text: &str) -> String {
    text.trim().chars().take(20).collect()
}

/// The entities of the section of that name.
fn entities<'a>(pairs: &'a [Pair<'a>]) -> Result<Vec<Entity<'a>>, GeometryError> {
    let begins = |pair: &[Pair<'_>]| {
        (pair[0].code, pair[0].value) == (0, "SECTION")
            && (pair[1].code, pair[1].value) == (2, "ENTITIES")
    };
    let last = pairs.last().map_or(1, |pair| pair.line);
    let start = pairs
        .windows(2)
        .position(begins)
        .ok_or_else(|| unreadable(last, "the file has no section ENTITIES"))?;
    let inside = &pairs[start + 2..];
    let length = inside
        .iter()
        .position(|pair| (pair.code, pair.value) == (0, "ENDSEC"))
        .ok_or_else(|| unreadable(last, "the file ends within its section ENTITIES"))?;
    let inside = &inside[..length];
    let heads: Vec<usize> = (0..length).filter(|&i| inside[i].code == 0).collect();
    Ok(heads
        .iter()
        .enumerate()
        .map(|(number, &head)| {
            let end = heads.get(number + 1).copied().unwrap_or(length);
            Entity {
                kind: inside[head].value,
                line: inside[head].line,
                pairs: &inside[head + 1..end],
            }
        })
        .collect())
}

impl Entity<'_> {
    fn find(&self, code: i32) -> Option<&Pair<'_>> {
        self.pairs.iter().find(|pair| pair.code == code)
    }

    fn text(&self, code: i32) -> Option<&str> {
        self.find(code).map(|pair| pair.value)
    }

    fn flag(&self, code: i32) -> Result<i64, GeometryError> {
        self.find(code).map_or(Ok(0), |pair| parse(pair))
    }

    fn number(&self, code: i32) -> Result<f64, GeometryError> {
        match self.find(code) {
            Some(pair) => parse(pair),
            None => Err(unreadable(
                self.line,
                format!("the {} has no group {code}", self.kind),
            )),
        }
    }

    fn number_or(&self, code: i32, default: f64) -> Result<f64, GeometryError> {
        self.find(code).map_or(Ok(default), parse)
    }

    fn unsupported(&self, remedy: &'static str) -> GeometryError {
        GeometryError::UnsupportedDrawing {
            line: self.line,
            item: format!(
                "{} (of layer \"{}\")",
                self.kind,
                self.text(8).unwrap_or("0")
            ),
            remedy,
        }
    }

    fn contour(&self, vertices: &[&Entity<'_>]) -> Result<Contour, GeometryError> {
        let line = match self.kind {
            "LINE" => {
                let point = |x, y| Ok([self.number(x)?, self.number(y)?]);
                return Contour::new(vec![point(10, 20)?, point(11, 21)?], vec![0.0], false);
            }
            "CIRCLE" => self.arc(0.0, 360.0)?,
            "ARC" => self.arc(self.number(50)?, self.number(51)?)?,
            "LWPOLYLINE" => self.light_polyline()?,
            "POLYLINE" => self.polyline(vertices)?,
            "SPLINE" | "ELLIPSE" | "HELIX" => {
                return Err(self.unsupported(
                    "convert it to a polyline of arcs or straight pieces in the drawing program",
                ));
            }
            "INSERT" => {
                return Err(self.unsupported("explode the block in the drawing program"));
            }
            _ => {
                return Err(self.unsupported(
                    "use LINE, ARC, CIRCLE, LWPOLYLINE or POLYLINE, or put it onto another layer",
                ));
            }
        };
        self.unmirrored(line)
    }

    /// From the entity's own coordinates: mirrored parts have their z axis turned, and x with it.
    fn unmirrored(&self, line: Contour) -> Result<Contour, GeometryError> {
        let direction = [
            self.number_or(210, 0.0)?,
            self.number_or(220, 0.0)?,
            self.number_or(230, 1.0)?,
        ];
        if direction[0].hypot(direction[1]) > 1e-9 * direction[2].abs() || direction[2] == 0.0 {
            return Err(self.unsupported("it does not lie in the x-y plane"));
        }
        if direction[2] > 0.0 {
            return Ok(line);
        }
        let closed = line.is_closed();
        let (mut points, mut bulges) = line.into_parts();
        points.iter_mut().for_each(|point| point[0] = -point[0]);
        bulges.iter_mut().for_each(|bulge| *bulge = -*bulge);
        Contour::new(points, bulges, closed)
    }

    /// An arc between two angles (degrees), anticlockwise, cut in the middle.
    fn arc(&self, from: f64, to: f64) -> Result<Contour, GeometryError> {
        let (x, y, radius) = (self.number(10)?, self.number(20)?, self.number(40)?);
        let turn = match (to - from).rem_euclid(360.0) {
            0.0 => 360.0,
            turn => turn,
        };
        let place = |part: f64| {
            let (sin, cos) = (from + part * turn).to_radians().sin_cos();
            [x + radius * cos, y + radius * sin]
        };
        let closed = turn == 360.0;
        let mut points = vec![place(0.0), place(0.5)];
        if !closed {
            points.push(place(1.0));
        }
        Contour::new(points, vec![bulge(0.5 * turn.to_radians()); 2], closed)
    }

    fn light_polyline(&self) -> Result<Contour, GeometryError> {
        let (mut points, mut bulges) = (Vec::<[f64; 2]>::new(), Vec::new());
        for pair in self.pairs {
            match (pair.code, points.last_mut()) {
                (10, _) => {
                    points.push([parse(pair)?, 0.0]);
                    bulges.push(0.0);
                }
                (20, Some(point)) => point[1] = parse(pair)?,
                (42, Some(_)) => {
                    if let Some(last) = bulges.last_mut() {
                        *last = parse(pair)?;
                    }
                }
                _ => {}
            }
        }
        self.line(points, bulges)
    }

    fn polyline(&self, vertices: &[&Entity<'_>]) -> Result<Contour, GeometryError> {
        // 4: a curve was fitted by splines; 16, 64: a mesh of polygons.
        if self.flag(70)? & (4 | 16 | 64) != 0 {
            return Err(self.unsupported(
                "fitted splines and meshes are no lines of straight pieces and arcs: convert it",
            ));
        }
        let (mut points, mut bulges) = (Vec::new(), Vec::new());
        for vertex in vertices {
            points.push([vertex.number(10)?, vertex.number(20)?]);
            bulges.push(vertex.number_or(42, 0.0)?);
        }
        self.line(points, bulges)
    }

    /// A line through vertices; the bulge of the last counts only if the line is closed.
    fn line(&self, points: Vec<[f64; 2]>, mut bulges: Vec<f64>) -> Result<Contour, GeometryError> {
        if points.len() < 2 {
            return Err(unreadable(
                self.line,
                format!("the {} has fewer than two vertices", self.kind),
            ));
        }
        let closed = self.flag(70)? & 1 == 1;
        if !closed {
            bulges.pop();
        }
        Contour::new(points, bulges, closed)
    }
}

fn parse<T: std::str::FromStr>(pair: &Pair<'_>) -> Result<T, GeometryError> {
    let wrong = |_| {
        unreadable(
            pair.line,
            format!(
                "\"{}\" is no number of group {}",
                shortened(pair.value),
                pair.code
            ),
        )
    };
    pair.value.parse().map_err(wrong)
}
