//! `[time]`, `[scheme]`, `[stabilisation]`, `[heat]` and `[output]`.

use jstsph_geometry::Dimension;
use jstsph_solver::{
    Biharmonic, Formulation, Heat, Integrator, Jst, Quadrature, Scheme, Stabilisation, StepLimit,
    Viscosity,
};
use jstsph_sph::Kernel;

use crate::case::{Interval, OutputSettings, TimeSettings};
use crate::document::{Node, Value};
use crate::error::{Origin, Problem};
use crate::schema::{self, Limit};
use crate::section::{Field, Section};
use crate::units::Measure;
use crate::value::number;

/// `[time]` with the integrator and the smallest step, which belong to the scheme.
pub(crate) struct Time {
    pub(crate) settings: TimeSettings,
    pub(crate) integrator: Integrator,
    pub(crate) step_limit: StepLimit,
    pub(crate) smallest_time_step: f64,
    pub(crate) substeps: u32,
    pub(crate) inertia_scale: f64,
    pub(crate) resolved: toml::Table,
    /// Where `substeps` is written.
    substeps_origin: Option<Origin>,
}

impl Time {
    /// `substeps` do not go with the rest of the case, which would need `needed`.
    pub(crate) fn refuse_substeps(&self, needed: &str) -> Problem {
        let origin = self.substeps_origin.clone().unwrap_or(Origin::File(0..0));
        let message = format!(
            "`time.substeps` is {}, but sub-steps need {needed}",
            self.substeps
        );
        Problem::new(&origin, message).help(
            "time.substeps = 1 makes all steps equal; more go with the leapfrog, bonds, limit = \"acoustic\" and formulation = \"pFHJ\", without stabilisation, projection, heat, tractions and damage",
        )
    }
}

/// More have never paid: see docs/performance.md.
const LARGEST_SUBSTEPS: u32 = 64;

/// Reads `[time]`.
pub(crate) fn read_time(node: &Node) -> Result<Time, Problem> {
    let mut section = Section::open(node, "time", schema::TIME)?;
    let end = section.number("end")?;
    let integrator = section.choice("integrator", schema::INTEGRATORS)?;
    let cfl = section.number_or(
        "cfl",
        match integrator {
            Integrator::Leapfrog => 0.5,
            Integrator::TvdRungeKutta => 0.3,
            // The same fractions of their limits on the imaginary axis as the leapfrog's.
            Integrator::SspRungeKutta => 0.4,
            Integrator::RungeKutta4 => 0.8,
        },
    )?;
    let step_limit = section.choice("limit", schema::STEP_LIMITS)?;
    let substeps_origin = section.node("substeps").map(|node| node.origin.clone());
    let substeps = read_substeps(&mut section)?;
    let smallest_time_step = section.number("smallest_step")?;
    let inertia_scale = read_inertia_scale(&mut section)?;
    Ok(Time {
        settings: TimeSettings { end, cfl },
        integrator,
        step_limit,
        smallest_time_step,
        substeps,
        inertia_scale,
        resolved: section.finish(),
        substeps_origin,
    })
}

/// Most sub-steps of a step: a power of two.
fn read_substeps(section: &mut Section<'_>) -> Result<u32, Problem> {
    let count = section.count("substeps")?.unwrap_or(1);
    match u32::try_from(count) {
        Ok(substeps) if substeps.is_power_of_two() && substeps <= LARGEST_SUBSTEPS => Ok(substeps),
        _ => Err(section
            .problem("substeps", format!("`time.substeps` is {count}"))
            .help(format!(
                "it must be a power of two from 1 (all steps equal) to {LARGEST_SUBSTEPS}"
            ))),
    }
}

/// `rate_scale` and `mass_scale` are two names of one thing: the factor on the inertia.
fn read_inertia_scale(section: &mut Section<'_>) -> Result<f64, Problem> {
    match (section.has("rate_scale"), section.has("mass_scale")) {
        (true, true) => Err(section
            .problem("mass_scale", "`time` has both rate_scale and mass_scale")
            .help("mass_scale = rate_scale^2: give one of them")),
        (true, false) => section.number("rate_scale").map(|scale| scale * scale),
        (false, true) => section.number("mass_scale"),
        (false, false) => Ok(1.0),
    }
}

/// Reads `[heat]`; without it temperatures stay.
pub(crate) fn read_heat(node: Option<&Node>) -> Result<Option<(Heat, toml::Table)>, Problem> {
    let Some(node) = node else { return Ok(None) };
    let mut section = Section::open(node, "heat", schema::HEAT)?;
    let heat = Heat {
        conduction: section.flag("conduction")?,
        viscous_heating: section.flag("viscous_heating")?,
        friction_heating: section.flag("friction_heating")?,
    };
    Ok(Some((heat, section.finish())))
}

/// Reads `[scheme]` and `[stabilisation]`; returns their resolved tables in this order.
pub(crate) fn read_scheme(
    scheme: &Node,
    stabilisation: &Node,
    time: &Time,
) -> Result<(Scheme, toml::Table, toml::Table), Problem> {
    let mut section = Section::open(scheme, "scheme", schema::SCHEME)?;
    let quadrature = section.choice("quadrature", schema::QUADRATURES)?;
    let bonds = quadrature == Quadrature::Bonds;
    let kernels = Kernel::ALL.map(|kernel| (kernel.name(), kernel));
    let formulation = section.choice("formulation", schema::FORMULATIONS)?;
    let kernel = section.choice("kernel", &kernels)?;
    let smoothing_ratio = section.number_or("smoothing_ratio", if bonds { 0.8 } else { 1.2 })?;
    let reference = if bonds { "spacing" } else { "volume" };
    let smoothing_reference = section.choice_or(
        "smoothing_reference",
        schema::SMOOTHING_REFERENCES,
        reference,
    )?;
    let weights = section.choice("weights", schema::WEIGHTS)?;
    let boundary_correction = section.flag("boundary_correction")?;
    let projection = section.flag_or("projection", !bonds)?;
    let reference_frame = formulation != Formulation::EulerianKernel;
    let (stabilisation, resolved) = read_stabilisation(stabilisation, bonds || !reference_frame)?;
    let scheme = Scheme {
        quadrature,
        kernel,
        smoothing_ratio,
        smoothing_reference,
        weights,
        boundary_correction,
        formulation,
        integrator: time.integrator,
        cfl: time.settings.cfl,
        step_limit: time.step_limit,
        stabilisation,
        projection,
        inertia_scale: time.inertia_scale,
        smallest_time_step: time.smallest_time_step,
        substeps: time.substeps,
    };
    Ok((scheme, section.finish(), resolved))
}

fn read_stabilisation(node: &Node, bare: bool) -> Result<(Stabilisation, toml::Table), Problem> {
    let mut section = Section::open(node, "stabilisation", schema::STABILISATION)?;
    let bare = bare || section.has("jst");
    let upwind = section.number_or("upwind", if bare { 0.0 } else { 0.3 })?;
    let hourglass = section.number("hourglass")?;
    let jst = match section.field("jst")? {
        None => None,
        Some(field) => {
            let (jst, resolved) = read_jst(&field)?;
            section.record("jst", resolved);
            Some(jst)
        }
    };
    let viscosity = match section.field("viscosity")? {
        None => None,
        Some(field) => {
            let mut table = Section::open(&field.node, &field.path, schema::VISCOSITY)?;
            let viscosity = Viscosity {
                linear: table.number("linear")?,
                quadratic: table.number("quadratic")?,
            };
            section.record("viscosity", table.finish());
            Some(viscosity)
        }
    };
    let stabilisation = Stabilisation {
        jst,
        upwind,
        hourglass,
        viscosity,
    };
    Ok((stabilisation, section.finish()))
}

fn read_jst(field: &Field<'_>) -> Result<(Jst, toml::Table), Problem> {
    let mut section = Section::open(&field.node, &field.path, schema::JST)?;
    let harmonic = section.number("harmonic")?;
    let coefficient = section.need("biharmonic")?;
    let biharmonic = if matches!(coefficient.node.value, Value::Table(_)) {
        let mut falling = Section::open(&coefficient.node, &coefficient.path, schema::BIHARMONIC)?;
        let biharmonic = Biharmonic::FallingWithPlasticStrain {
            initial: falling.number("initial")?,
            last: falling.number("final")?,
            strain: falling.number("plastic_strain")?,
        };
        section.record("biharmonic", falling.finish());
        biharmonic
    } else {
        let value = number(
            &coefficient.node,
            &coefficient.path,
            Measure::NUMBER,
            Limit::NotNegative,
        )?;
        section.record("biharmonic", value);
        Biharmonic::Constant(value)
    };
    let jst = Jst {
        harmonic,
        biharmonic,
        on_jacobian: section.flag("on_jacobian")?,
        laplacian: section.choice("laplacian", schema::LAPLACIANS)?,
    };
    Ok((jst, section.finish()))
}

/// Reads `[output]`.
pub(crate) fn read_output(node: &Node, end: f64) -> Result<(OutputSettings, toml::Table), Problem> {
    let mut section = Section::open(node, "output", schema::OUTPUT)?;
    let settings = OutputSettings {
        history_interval: read_interval(&mut section, "history", end / 500.0)?,
        frame_interval: read_interval(&mut section, "frame", end / 50.0)?,
        restart_interval: read_interval(&mut section, "restart", end / 10.0)?,
        fields: read_fields(&mut section)?,
        precision: section.choice("precision", schema::PRECISIONS)?,
        compression: section.flag("compression")?,
        format: section.choice("format", schema::FORMATS)?,
        cells: section.choice("cells", schema::CELLS)?,
    };
    Ok((settings, section.finish()))
}

/// `WHAT_interval` or `WHAT_steps`; one on the command line replaces the other in the file.
fn read_interval(
    section: &mut Section<'_>,
    what: &str,
    otherwise: f64,
) -> Result<Interval, Problem> {
    let (time, steps) = (format!("{what}_interval"), format!("{what}_steps"));
    let is_override = |node: &Node| matches!(node.origin, Origin::Override(_));
    let by_steps = match (section.node(&time), section.node(&steps)) {
        (Some(time_node), Some(steps_node))
            if is_override(time_node) == is_override(steps_node) =>
        {
            return Err(section
                .problem(&steps, format!("`output` has both {time} and {steps}"))
                .help("give one of them: a simulated time, or a number of steps"));
        }
        (Some(_), Some(node)) => is_override(node),
        (_, node) => node.is_some(),
    };
    match by_steps
        .then(|| section.count(&steps))
        .transpose()?
        .flatten()
    {
        Some(count) => Ok(Interval::Steps(count as u64)),
        None => section.number_or(&time, otherwise).map(Interval::Time),
    }
}

/// The fields of frames in the order of the schema; all unless some are chosen.
fn read_fields(section: &mut Section<'_>) -> Result<Vec<&'static str>, Problem> {
    let Some(field) = section.field("fields")? else {
        return Ok(schema::FRAME_FIELDS.to_vec());
    };
    let Value::Array(items) = &field.node.value else {
        return Err(field.problem(format!(
            "`{}` must be a list of names, but is {}",
            field.path,
            field.node.value.kind()
        )));
    };
    let mut chosen = Vec::new();
    for item in items {
        let text = match &item.value {
            Value::Text(text) => text.as_str(),
            other => other.kind(),
        };
        match schema::FRAME_FIELDS.iter().find(|name| **name == text) {
            Some(name) => chosen.push(*name),
            None => {
                return Err(
                    Problem::new(&item.origin, format!("frames have no field `{text}`"))
                        .allowed(text, schema::FRAME_FIELDS.iter().copied()),
                );
            }
        }
    }
    let fields: Vec<&'static str> = schema::FRAME_FIELDS
        .iter()
        .copied()
        .filter(|name| chosen.contains(name))
        .collect();
    let names = fields.iter().map(|name| toml::Value::from(*name));
    section.record("fields", names.collect::<Vec<_>>());
    Ok(fields)
}

/// Reads `dimension`.
pub(crate) fn read_dimension(case: &mut Section<'_>) -> Result<Dimension, Problem> {
    case.choice(
        "dimension",
        &[
            ("plane-strain", Dimension::PlaneStrain),
            ("3d", Dimension::Solid),
        ],
    )
}
