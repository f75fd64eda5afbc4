//! Selections of particles: `"billet"`, `"billet.top"` or a table.

use jstsph_geometry::{Dimension, Selection, select};
use jstsph_solver::ModelBody;
use jstsph_tensor::Vec3;

use crate::document::{Node, Value};
use crate::error::Problem;
use crate::schema;
use crate::section::Section;
use crate::value::shown;

/// Particles of one body.
#[derive(Clone, Debug)]
pub(crate) struct Selected {
    /// Index of the body.
    pub(crate) body: usize,
    /// Indices in the body, ascending, never empty.
    pub(crate) particles: Vec<u32>,
    /// The face all of them lie on, when the selection names one.
    pub(crate) face: Option<String>,
    /// How the resolved case writes it.
    pub(crate) resolved: toml::Value,
}

/// Evaluates the `where` of a table.
pub(crate) fn read_where(
    section: &mut Section<'_>,
    bodies: &[ModelBody],
    dimension: Dimension,
) -> Result<Selected, Problem> {
    let field = section.need("where")?;
    let reader = Reader { bodies, dimension };
    let (body, selection, resolved) = reader.outermost(&field.node, &field.path)?;
    let particles =
        select(&bodies[body].body, &selection).map_err(|error| field.problem(error.to_string()))?;
    if particles.is_empty() {
        return Err(field
            .problem(format!(
                "`{}` selects no particle of body `{}`",
                field.path, bodies[body].name
            ))
            .help(extent(&bodies[body])));
    }
    section.record("where", resolved.clone());
    Ok(Selected {
        body,
        particles,
        face: face_of(&selection),
        resolved,
    })
}

/// The face a selection lies on.
fn face_of(selection: &Selection) -> Option<String> {
    match selection {
        Selection::Face(face) => Some(face.clone()),
        Selection::And(parts) => parts.iter().find_map(face_of),
        _ => None,
    }
}

fn extent(body: &ModelBody) -> String {
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for x in body.body.positions.iter() {
        low = low.inf(x);
        high = high.sup(x);
    }
    format!(
        "its particles lie between {} and {} m",
        shown(&low),
        shown(&high)
    )
}

struct Reader<'a> {
    bodies: &'a [ModelBody],
    dimension: Dimension,
}

impl Reader<'_> {
    fn body(&self, node: &Node, name: &str) -> Result<usize, Problem> {
        self.bodies
            .iter()
            .position(|body| body.name == name)
            .ok_or_else(|| {
                Problem::new(&node.origin, format!("unknown body `{name}`"))
                    .allowed(name, self.bodies.iter().map(|body| body.name.as_str()))
            })
    }

    fn outermost(
        &self,
        node: &Node,
        path: &str,
    ) -> Result<(usize, Selection, toml::Value), Problem> {
        match &node.value {
            Value::Text(text) => {
                let (name, face) = match text.split_once('.') {
                    Some((name, face)) => (name, Some(face)),
                    None => (text.as_str(), None),
                };
                let body = self.body(node, name)?;
                let selection =
                    face.map_or(Ok(Selection::All), |face| self.face(body, node, face))?;
                Ok((body, selection, text.as_str().into()))
            }
            Value::Table(_) => {
                let body = match node.entry("body") {
                    Some(entry) => match &entry.node.value {
                        Value::Text(name) => self.body(&entry.node, name)?,
                        other => {
                            return Err(Problem::new(
                                &entry.node.origin,
                                format!(
                                    "`{path}.body` must be the name of a body, but is {}",
                                    other.kind()
                                ),
                            ));
                        }
                    },
                    None if self.bodies.len() == 1 => 0,
                    None => {
                        let names: Vec<&str> =
                            self.bodies.iter().map(|body| body.name.as_str()).collect();
                        return Err(Problem::new(
                            &node.origin,
                            format!("`{path}` must say which body"),
                        )
                        .help(format!("body = one of: {}", names.join(", "))));
                    }
                };
                let (selection, mut table) = self.table(body, node, path, true)?;
                table.insert("body".to_owned(), self.bodies[body].name.as_str().into());
                Ok((body, selection, table.into()))
            }
            other => Err(Problem::new(
                &node.origin,
                format!(
                    "`{path}` must be a text such as \"{}.top\" or a table, but is {}",
                    self.bodies[0].name,
                    other.kind()
                ),
            )),
        }
    }

    fn face(&self, body: usize, node: &Node, face: &str) -> Result<Selection, Problem> {
        let shape = &self.bodies[body].body.shape;
        let faces = shape.faces(self.dimension);
        match face {
            "all" => Ok(Selection::All),
            "boundary" => Ok(Selection::Boundary),
            _ if faces.contains(&face) => Ok(Selection::Face(face.to_owned())),
            _ => Err(Problem::new(
                &node.origin,
                format!(
                    "body `{}` is a {} and has no face `{face}`",
                    self.bodies[body].name,
                    shape.name()
                ),
            )
            .allowed(face, faces.iter().copied().chain(["all", "boundary"]))),
        }
    }

    /// A selection inside another one; a text is a face.
    fn inner(
        &self,
        body: usize,
        node: &Node,
        path: &str,
    ) -> Result<(Selection, toml::Value), Problem> {
        match &node.value {
            Value::Text(face) => Ok((self.face(body, node, face)?, face.as_str().into())),
            _ => {
                let (selection, table) = self.table(body, node, path, false)?;
                Ok((selection, table.into()))
            }
        }
    }

    fn table(
        &self,
        body: usize,
        node: &Node,
        path: &str,
        outermost: bool,
    ) -> Result<(Selection, toml::Table), Problem> {
        let mut section = Section::open(node, path, schema::SELECTION)?;
        if section.has("body") && !outermost {
            return Err(section.problem(
                "body",
                format!("`{path}.body`: only the outermost table names the body"),
            ));
        }
        let names = schema::SELECTION.iter().map(|key| key.name);
        let name = section.one_of(&names.filter(|name| *name != "body").collect::<Vec<_>>())?;
        let selection = match name {
            "all" | "boundary" => {
                if !section.flag(name)? {
                    return Err(section.problem(name, format!("`{path}.{name}` can only be true")));
                }
                if name == "all" {
                    Selection::All
                } else {
                    Selection::Boundary
                }
            }
            "face" => {
                let face = section.text("face")?;
                self.face(body, &section.need("face")?.node, &face)?
            }
            "half_space" => {
                let field = section.need(name)?;
                let mut part = Section::open(&field.node, &field.path, schema::HALF_SPACE)?;
                let selection = Selection::HalfSpace {
                    point: part.vector("point", self.dimension)?,
                    normal: part.direction("normal", self.dimension)?,
                };
                section.record(name, part.finish());
                selection
            }
            "box" => {
                let field = section.need(name)?;
                let mut part = Section::open(&field.node, &field.path, schema::BOX)?;
                let selection = Selection::Box {
                    min: part.vector("min", self.dimension)?,
                    max: part.vector("max", self.dimension)?,
                };
                section.record(name, part.finish());
                selection
            }
            "not" => {
                let field = section.need(name)?;
                let (inner, resolved) = self.inner(body, &field.node, &field.path)?;
                section.record(name, resolved);
                Selection::Not(Box::new(inner))
            }
            _ => {
                let field = section.need(name)?;
                let (mut parts, mut resolved) = (Vec::new(), Vec::new());
                for (number, item) in field.items()?.into_iter().enumerate() {
                    let (part, value) =
                        self.inner(body, item, &format!("{}.{number}", field.path))?;
                    parts.push(part);
                    resolved.push(value);
                }
                if parts.is_empty() {
                    return Err(field.problem(format!(
                        "`{}` is empty, but needs at least one selection",
                        field.path
                    )));
                }
                section.record(name, resolved);
                if name == "and" {
                    Selection::And(parts)
                } else {
                    Selection::Or(parts)
                }
            }
        };
        Ok((selection, section.finish()))
    }
}
