//! `[[obstacle]]`: rigid surfaces, their contact law and motion.

use jstsph_contact::{Chain, ContactError, Friction, Law, Obstacle, Profile, Surface};
use jstsph_geometry::{Contour, Dimension};
use jstsph_solver::{ModelBody, ModelObstacle, ObstacleHeat, Signal};
use jstsph_tensor::Vec3;

use crate::body::Context;
use crate::document::{Node, Value};
use crate::drawing;
use crate::error::Problem;
use crate::schema::{self, Limit};
use crate::section::{Field, Section};
use crate::shape::read_points;
use crate::signal::{Scope, VARIABLES, signal, velocity_components};
use crate::stl::read_stl;
use crate::units::Measure;
use crate::value::{number, shown};

/// How far a particle may stand in an obstacle at the start unless the case allows more, over the
/// spacing of its body.
const OVERLAP_TOLERANCE: f64 = 1e-6;

/// Extent of a plane-strain box obstacle along z, where it has no faces (m).
const ENDLESS: f64 = 1e9;

/// An obstacle with what is only needed for checks.
pub(crate) struct ReadObstacle {
    pub(crate) model: ModelObstacle,
    /// Smallest positive fillet radius, m.
    pub(crate) smallest_fillet: Option<f64>,
    pub(crate) resolved: toml::Table,
}

/// Reads one obstacle and refuses bodies that stand in it.
pub(crate) fn read_obstacle(
    node: &Node,
    number: usize,
    bodies: &[ModelBody],
    context: &Context<'_>,
) -> Result<ReadObstacle, Problem> {
    let dimension = context.dimension;
    let mut section = Section::open(node, &format!("obstacle.{number}"), schema::OBSTACLE)?;
    let name = match section.field("name")? {
        Some(field) => field.text()?.to_owned(),
        None => format!("obstacle-{number}"),
    };
    crate::body::check_name(&section, &name)?;
    section.record("name", name.as_str());
    section.rename(format!("obstacle.{name}"));
    let form = section.one_of(schema::OBSTACLE_FORMS)?;
    let mut fillets = Vec::new();
    let surface = read_surface(&mut section, form, context, &mut fillets)?;
    let law = read_law(&mut section)?;
    let velocity = read_motion(&mut section, dimension)?;
    let friction = Friction::coulomb(section.number_or("friction", 0.0)?);
    let obstacle = Obstacle {
        name,
        surface,
        law,
        friction,
    };
    obstacle
        .validate()
        .map_err(|error| section.problem(form, format!("`{}.{form}`: {error}", section.path())))?;
    let heat = read_heat(&mut section)?;
    let allowed_overlap = match section.field("allowed_overlap")? {
        Some(_) => Some(section.number("allowed_overlap")?),
        None => None,
    };
    for body in bodies {
        let allowed = allowed_overlap.unwrap_or(OVERLAP_TOLERANCE * body.body.spacing);
        check_overlap(&section, form, &obstacle, body, allowed)?;
    }
    Ok(ReadObstacle {
        model: ModelObstacle {
            obstacle,
            velocity,
            heat,
        },
        smallest_fillet: fillets
            .into_iter()
            .filter(|radius| *radius > 0.0)
            .reduce(f64::min),
        resolved: section.finish(),
    })
}

/// Heat exchange of an obstacle with the bodies that touch it.
fn read_heat(section: &mut Section<'_>) -> Result<Option<ObstacleHeat>, Problem> {
    let Some(field) = section.field("heat")? else {
        return Ok(None);
    };
    let mut table = Section::open(&field.node, &field.path, schema::OBSTACLE_HEAT)?;
    let conductance = table.number("conductance")?;
    let temperature = table.need("temperature")?;
    let scope = Scope {
        variables: &VARIABLES[..1],
        positions: &[],
    };
    let (temperature, resolved) = signal(
        &temperature.node,
        &temperature.path,
        Measure::TEMPERATURE,
        scope,
    )?;
    table.record("temperature", resolved);
    section.record("heat", table.finish());
    Ok(Some(ObstacleHeat {
        conductance,
        temperature,
    }))
}

fn check_overlap(
    section: &Section<'_>,
    form: &str,
    obstacle: &Obstacle,
    body: &ModelBody,
    allowed: f64,
) -> Result<(), Problem> {
    let gaps = body
        .body
        .positions
        .iter()
        .map(|x| obstacle.surface.gap(x).distance);
    let Some((deepest, gap)) = gaps.enumerate().min_by(|a, b| a.1.total_cmp(&b.1)) else {
        return Ok(());
    };
    if gap >= -allowed {
        return Ok(());
    }
    let x = body.body.positions[deepest];
    Err(section
        .problem(
            form,
            format!(
                "body `{}` overlaps obstacle `{}` at the start: particle {deepest} at {} m is {:.4e} m inside it, allowed are {allowed:.1e} m",
                body.name,
                obstacle.name,
                shown(&x),
                -gap
            ),
        )
        .help("move the body or the obstacle apart, or check the side that is free (free_side, normal, inside)")
        .help("where it is meant, write allowed_overlap = \"...\" beside the obstacle's shape"))
}

fn read_surface(
    section: &mut Section<'_>,
    form: &str,
    context: &Context<'_>,
    fillets: &mut Vec<f64>,
) -> Result<Surface, Problem> {
    let dimension = context.dimension;
    let field = section.need(form)?;
    let contact = |error: ContactError| field.problem(format!("`{}`: {error}", field.path));
    if form == "profile" {
        if dimension != Dimension::PlaneStrain {
            return Err(field
                .problem(format!("`{}`: a profile is for plane strain", field.path))
                .help("in 3d use plane, sphere, cylinder, box or stl"));
        }
        let (profile, resolved) = read_profile(&field, fillets)?;
        section.record(form, resolved);
        return Ok(Surface::Profile(profile));
    }
    let mut part = Section::open(&field.node, &field.path, field.kind.keys())?;
    let surface = match form {
        "drawing" => read_lines(&mut part, context, fillets)?,
        "plane" => Surface::plane(
            part.vector("point", dimension)?,
            part.vector("normal", dimension)?,
        )
        .map_err(contact)?,
        "sphere" => Surface::Sphere {
            centre: part.vector("centre", dimension)?,
            radius: part.number("radius")?,
            inside: part.flag("inside")?,
        },
        "cylinder" => {
            if dimension == Dimension::PlaneStrain {
                return Err(field.problem(format!(
                    "`{}`: in plane strain a cylinder along z is written as a sphere",
                    field.path
                )));
            }
            let point = part.vector("point", dimension)?;
            let axis = part.vector("axis", dimension)?;
            let radius = part.number("radius")?;
            let half_length = if part.has("length") {
                Some(part.number("length")? / 2.0)
            } else {
                None
            };
            Surface::cylinder(point, axis, radius, half_length, part.flag("inside")?)
                .map_err(contact)?
        }
        "stl" => {
            if dimension == Dimension::PlaneStrain {
                return Err(field
                    .problem(format!("`{}`: an STL surface is for 3d", field.path))
                    .help("in plane strain write a profile"));
            }
            Surface::Mesh {
                mesh: read_stl(&mut part, context.folder)?,
                inside: part.flag("inside")?,
            }
        }
        _ => {
            let mut min = part.vector("min", dimension)?;
            let mut max = part.vector("max", dimension)?;
            if dimension == Dimension::PlaneStrain {
                (min.z, max.z) = (-ENDLESS, ENDLESS);
            }
            Surface::Box {
                min,
                max,
                inside: part.flag("inside")?,
            }
        }
    };
    section.record(form, part.finish());
    Ok(surface)
}

/// Walls along the lines of a drawing.
fn read_lines(
    part: &mut Section<'_>,
    context: &Context<'_>,
    radii: &mut Vec<f64>,
) -> Result<Surface, Problem> {
    let path = part.path().to_owned();
    if context.dimension != Dimension::PlaneStrain {
        return Err(part
            .problem(
                "file",
                format!("`{path}`: lines of a drawing are for plane strain"),
            )
            .help("in 3d use plane, sphere, cylinder, box or stl"));
    }
    let drawing = drawing::read(part, context.folder)?;
    let free_point = drawing::pair(&part.need("free_point")?)?;
    part.record("free_point", free_point.to_vec());
    let profile = Profile::around(&drawing.contours, free_point).map_err(|error| {
        let key = match error {
            ContactError::FreePointOnWall { .. } => "free_point",
            _ => "file",
        };
        part.problem(
            key,
            format!("`{path}`: {}: {error}", drawing.path.display()),
        )
    })?;
    radii.extend(drawing.contours.iter().flat_map(Contour::radii));
    Ok(Surface::Profile(profile))
}

fn read_profile(
    field: &Field<'_>,
    fillets: &mut Vec<f64>,
) -> Result<(Profile, toml::Table), Problem> {
    // One chain may be written without the list around it.
    let nodes: Vec<&Node> = match field.node.entry("chains") {
        None => vec![&field.node],
        Some(entry) => {
            Section::open(&field.node, &field.path, schema::PROFILE)?;
            match &entry.node.value {
                Value::Array(items) => items.iter().collect(),
                other => {
                    let message = format!(
                        "`{}.chains` must be a list of tables, but is {}",
                        field.path,
                        other.kind()
                    );
                    return Err(Problem::new(&entry.node.origin, message));
                }
            }
        }
    };
    let (mut chains, mut resolved) = (Vec::new(), Vec::<toml::Value>::new());
    for (number, node) in nodes.into_iter().enumerate() {
        let (chain, table) = read_chain(node, &format!("{}.{number}", field.path), fillets)?;
        chains.push(chain);
        resolved.push(table.into());
    }
    let profile = Profile::new(chains)
        .map_err(|error| field.problem(format!("`{}`: {error}", field.path)))?;
    Ok((
        profile,
        toml::Table::from_iter([("chains".to_owned(), resolved.into())]),
    ))
}

fn read_chain(
    node: &Node,
    path: &str,
    fillets: &mut Vec<f64>,
) -> Result<(Chain, toml::Table), Problem> {
    let mut section = Section::open(node, path, schema::CHAIN)?;
    let field = section.need("points")?;
    let points = read_points(&field)?;
    section.record(
        "points",
        points
            .iter()
            .map(|p| p.to_vec().into())
            .collect::<Vec<toml::Value>>(),
    );
    let radii = match section.field("fillets")? {
        None => vec![0.0; points.len()],
        Some(field) => {
            let items = field.items()?.into_iter().enumerate();
            let radius = |(place, item): (usize, &Node)| {
                number(
                    item,
                    &format!("{}.{place}", field.path),
                    Measure::LENGTH,
                    Limit::NotNegative,
                )
            };
            items.map(radius).collect::<Result<Vec<f64>, Problem>>()?
        }
    };
    section.record("fillets", radii.clone());
    let closed = section.flag("closed")?;
    let side = section.choice("free_side", schema::SIDES)?;
    let chain = Chain::new(&points, &radii, closed, side).map_err(|error| {
        // Which of the two lists is meant shows the user where to look.
        let fillet = matches!(
            error,
            ContactError::FilletCount { .. }
                | ContactError::FilletTooLarge { .. }
                | ContactError::EndFillet { .. }
                | ContactError::NegativeFillet { .. }
        );
        section.problem(
            if fillet { "fillets" } else { "points" },
            format!("`{path}`: {error}"),
        )
    })?;
    fillets.extend(radii);
    Ok((chain, section.finish()))
}

fn read_law(section: &mut Section<'_>) -> Result<Law, Problem> {
    let inelastic = section.choice("law", &[("inelastic", true), ("reflection", false)])?;
    if inelastic {
        return Ok(Law::Inelastic {
            restitution: section.number_or("restitution", 0.0)?,
        });
    }
    if section.has("restitution") {
        return Err(section.problem(
            "restitution",
            format!("`{}.restitution` belongs to the inelastic law; reflection always returns everything", section.path()),
        ));
    }
    Ok(Law::Reflection)
}

fn read_motion(
    section: &mut Section<'_>,
    dimension: Dimension,
) -> Result<Option<[Signal; 3]>, Problem> {
    let Some(field) = section.field("velocity")? else {
        return Ok(None);
    };
    let origin = [Vec3::zeros()];
    let scope = Scope {
        variables: &VARIABLES[..1],
        positions: &origin,
    };
    let (velocity, resolved) = velocity_components(&field.node, &field.path, dimension, scope)?;
    section.record("velocity", resolved);
    Ok(Some(velocity.map(|component| {
        component.unwrap_or(Signal::Constant(0.0))
    })))
}
