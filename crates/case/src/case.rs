//! From the text of a case file to a checked case.

use std::path::Path;

use jstsph_solver::{Model, Probe, SolverError};

use crate::body::{BodyPlace, Context, read_body};
use crate::boundary::read_boundary;
use crate::document::{self, Node, Value};
use crate::error::{CaseError, Origin, Problem, Source};
use crate::include;
use crate::inputs::{self, InputFile};
use crate::material::{self, Materials};
use crate::obstacle::read_obstacle;
use crate::parameters;
use crate::plausibility::{self, Facts};
use crate::probe::read_probe;
use crate::resolved;
use crate::schema;
use crate::scheme::{read_dimension, read_heat, read_output, read_scheme, read_time};
use crate::section::Section;

/// A checked case: everything a run needs.
#[derive(Clone, Debug)]
pub struct Case {
    /// Name of the file without folder and extension.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Bodies, conditions, obstacles and scheme, in SI units.
    pub model: Model,
    /// Duration and CFL number.
    pub time: TimeSettings,
    /// What is written how often.
    pub output: OutputSettings,
    /// Numbers to read off the simulation; particles count through all bodies.
    pub probes: Vec<Probe>,
    /// The case as TOML with every default written out and every number in SI units; reading it
    /// gives the same case.
    pub resolved: String,
    /// What is allowed but looks like a mistake; one sentence each.
    pub warnings: Vec<String>,
    /// Included files and those of shapes.
    pub inputs: Vec<InputFile>,
    source: Source,
    places: Vec<BodyPlace>,
}

/// Duration and step size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimeSettings {
    /// Simulated time, s.
    pub end: f64,
    /// CFL number, also in the model's scheme.
    pub cfl: f64,
}

/// What is written how often.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputSettings {
    /// Between rows of history.csv.
    pub history_interval: Interval,
    /// Between frames.
    pub frame_interval: Interval,
    /// Between restart files.
    pub restart_interval: Interval,
    /// Names of the fields in frames, of [`FRAME_FIELDS`](crate::schema::FRAME_FIELDS).
    pub fields: Vec<&'static str>,
    /// Numbers in frames.
    pub precision: Precision,
    /// Whether frames are compressed.
    pub compression: bool,
    /// Files of a frame.
    pub format: FrameFormat,
    /// What frames show in ParaView.
    pub cells: FrameCells,
}

/// When something is written again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interval {
    /// At the first step at or past each multiple of this simulated time, s.
    Time(f64),
    /// At each multiple of this number of steps, at least 1.
    Steps(u64),
}

/// Files of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameFormat {
    /// VTU, which pictures and reports read.
    Vtu,
    /// VTKHDF beside it.
    VtuAndVtkhdf,
}

/// What frames show in ParaView.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameCells {
    /// The cells of the lattice, when every body has one; else the particles.
    Lattice,
    /// The particles as points.
    Particles,
}

/// Numbers in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// 64 bits.
    Double,
    /// 32 bits.
    Single,
}

/// Reads and checks a case file, with overrides `(dotted key, value)` applied in their order.
///
/// A key may go through a list by number or by name (`body.0.material`, `body.billet.material`); a
/// value is TOML, or a text when it is not TOML (`45 ms`).
///
/// # Errors
/// [`CaseError::Unreadable`] without the file; [`CaseError::Input`] for the first mistake in it.
pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Case, CaseError> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|source| CaseError::Unreadable {
        file: file.clone(),
        source,
    })?;
    let name = path.file_stem().map_or_else(
        || "case".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    parse(&name, &file, &text, overrides)
}

/// The same for a text; `file` is used in messages, and paths in the case start at its folder.
///
/// # Errors
/// [`CaseError::Input`] for the first mistake.
pub fn parse(
    name: &str,
    file: &str,
    text: &str,
    overrides: &[(String, String)],
) -> Result<Case, CaseError> {
    let mut source = Source {
        file: file.to_owned(),
        text: text.to_owned(),
        overrides: overrides.to_vec(),
        included: Vec::new(),
    };
    match read(name, &mut source) {
        Ok(case) => Ok(case),
        Err(problem) => Err(source.locate(problem)),
    }
}

fn read(name: &str, source: &mut Source) -> Result<Case, Problem> {
    let document = document(source)?;
    let mut section = Section::open(&document, "", schema::CASE)?;
    let empty = Node {
        value: Value::Table(Vec::new()),
        origin: document.origin.clone(),
    };

    let title = section.text("title")?;
    let dimension = read_dimension(&mut section)?;
    let time = read_time(&section.need("time")?.node)?;
    section.record("time", time.resolved.clone());
    let stabilisation = section.node("stabilisation").unwrap_or(&empty);
    let (scheme, scheme_table, stabilisation_table) = read_scheme(
        section.node("scheme").unwrap_or(&empty),
        stabilisation,
        &time,
    )?;
    section.record("scheme", scheme_table);
    section.record("stabilisation", stabilisation_table);
    let (output, table) = read_output(section.node("output").unwrap_or(&empty), time.settings.end)?;
    section.record("output", table);

    let heat = read_heat(section.node("heat"))?.map(|(heat, table)| {
        section.record("heat", table);
        heat
    });
    let materials = Materials::read(section.node("material"))?;
    let context = Context {
        dimension,
        materials: &materials,
        folder: Path::new(&source.file).parent().unwrap_or(Path::new("")),
    };
    let (mut bodies, mut places, mut tables) = (Vec::new(), Vec::new(), Vec::new());
    for (number, node) in list(&section, "body")?.into_iter().enumerate() {
        let (body, place, table) = read_body(node, number, &context, &places)?;
        bodies.push(body);
        places.push(place);
        tables.push(table);
    }
    if bodies.is_empty() {
        return Err(section.problem("body", "the case has no [[body]]"));
    }
    record_list(&mut section, "body", tables);
    let used = bodies
        .iter()
        .zip(&places)
        .map(|(body, place)| (place.material_name.as_str(), &body.material));
    section.record("material", material::resolved(used));

    let (mut conditions, mut tables) = (Vec::new(), Vec::new());
    for (number, node) in list(&section, "boundary")?.into_iter().enumerate() {
        let (condition, table) = read_boundary(node, number, &bodies, dimension)?;
        conditions.push(condition);
        tables.push(table);
    }
    record_list(&mut section, "boundary", tables);

    let (mut obstacles, mut tables, mut smallest_fillets) = (Vec::new(), Vec::new(), Vec::new());
    for (number, node) in list(&section, "obstacle")?.into_iter().enumerate() {
        let obstacle = read_obstacle(node, number, &bodies, &context)?;
        smallest_fillets.push(obstacle.smallest_fillet);
        obstacles.push(obstacle.model);
        tables.push(obstacle.resolved);
    }
    record_list(&mut section, "obstacle", tables);

    let (mut probes, mut tables) = (Vec::new(), Vec::new());
    for (number, node) in list(&section, "probe")?.into_iter().enumerate() {
        let (probe, table) = read_probe(node, number, &bodies, dimension, &probes)?;
        probes.push(probe);
        tables.push(table);
    }
    record_list(&mut section, "probe", tables);

    let model = Model {
        dimension,
        bodies,
        conditions,
        obstacles,
        heat,
        scheme,
    };
    if let (2.., Some(needed)) = (scheme.substeps, model.lacks_for_substeps()) {
        return Err(time.refuse_substeps(needed));
    }
    let warnings = plausibility::warnings(&Facts {
        model: &model,
        end: time.settings.end,
        smallest_fillets: &smallest_fillets,
    });
    Ok(Case {
        name: name.to_owned(),
        title,
        model,
        time: time.settings,
        output,
        probes,
        resolved: resolved::write(&section.finish()),
        warnings,
        inputs: inputs::collect(&document, context.folder)?,
        source: source.clone(),
        places,
    })
}

/// The document with included files and overrides, its expressions calculated.
fn document(source: &mut Source) -> Result<Node, Problem> {
    let mut document = document::parse(&source.text, &Origin::File)?;
    // What is included must be known before the other overrides reach into it.
    let (first, then): (Vec<_>, Vec<_>) = source
        .overrides
        .clone()
        .into_iter()
        .enumerate()
        .partition(|(_, (key, _))| key.split('.').next() == Some("include"));
    for (index, entry) in first {
        document::set(&mut document, index, &entry)?;
    }
    include::merge(&mut document, source)?;
    for (index, entry) in then {
        document::set(&mut document, index, &entry)?;
    }
    parameters::resolve(&mut document)?;
    Ok(document)
}

/// Tables of a list, none when the list is not written.
fn list<'a>(section: &Section<'a>, name: &str) -> Result<Vec<&'a Node>, Problem> {
    if section.field(name)?.is_none() {
        return Ok(Vec::new());
    }
    match section.node(name).map(|node| (&node.value, &node.origin)) {
        Some((Value::Array(items), _)) => Ok(items.iter().collect()),
        Some((other, origin)) => Err(Problem::new(
            origin,
            format!("`{name}` must be a list of tables, but is {}", other.kind()),
        )
        .help(format!("write [[{name}]] with two brackets"))),
        None => Ok(Vec::new()),
    }
}

fn record_list(section: &mut Section<'_>, name: &str, tables: Vec<toml::Table>) {
    if !tables.is_empty() {
        section.record(
            name,
            tables
                .into_iter()
                .map(toml::Value::Table)
                .collect::<Vec<_>>(),
        );
    }
}

impl Case {
    /// Number of particles of all bodies.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.model
            .bodies
            .iter()
            .map(|body| body.body.positions.len())
            .sum()
    }

    /// The case as its author wrote it, comments included; without the overrides.
    #[must_use]
    pub fn original(&self) -> &str {
        &self.source.text
    }

    /// A set-up error of the solver as a mistake in the case file, at the place of the body it
    /// names.
    #[must_use]
    pub fn setup_error(&self, error: &SolverError) -> CaseError {
        let place = |name: &String| self.places.iter().find(|place| place.name == *name);
        let found = match error {
            SolverError::Operator { body, .. } => place(body).map(|place| {
                Problem::new(&place.lattice, error.to_string()).help(format!(
                    "scheme.smoothing_ratio (now {}) or the number of particles is too small",
                    self.model.scheme.smoothing_ratio
                ))
            }),
            SolverError::Material { body, .. } => {
                place(body).map(|place| Problem::new(&place.material, error.to_string()))
            }
            _ => None,
        };
        let first = self
            .places
            .first()
            .map_or(Origin::File(0..0), |place| place.table.clone());
        self.source
            .locate(found.unwrap_or_else(|| Problem::new(&first, error.to_string())))
    }
}
