//! A case before it runs: particles, conditions and obstacles.

use jstsph_case::Case;
use jstsph_geometry::Dimension;
use jstsph_output::plot::{Figure, Group, ParticlePlot, Wall};
use jstsph_solver::{Condition, ConditionKind};
use jstsph_tensor::Vec3;

use super::body::{Sight, box_of};
use super::{heading, lines};
use crate::arguments::{Look, ViewName};
use crate::error::CliError;

/// Draws the particles, those of a condition in its colour (of several, in that of the last), and
/// the obstacles; a solid from above and aside unless another view is asked for.
pub(super) fn figure(case: &Case, view: Option<ViewName>) -> Result<Figure, CliError> {
    let is_solid = case.model.dimension == Dimension::Solid;
    let look = Look {
        view: view.or(is_solid.then_some(ViewName::Oblique)),
        ..Look::default()
    };
    let sight = Sight::new(case, &look);
    let bodies = &case.model.bodies;
    let positions: Vec<Vec3> = bodies
        .iter()
        .flat_map(|body| body.body.positions.iter().copied())
        .collect();
    let spacing = bodies
        .iter()
        .map(|body| body.body.spacing)
        .fold(f64::INFINITY, f64::min);
    let names: Vec<&str> = bodies.iter().map(|body| body.name.as_str()).collect();
    let group = |label: String, is_wall| Group { label, is_wall };
    let mut groups = vec![group(
        format!("{} ({})", names.join(", "), positions.len()),
        false,
    )];
    let mut values = vec![0.0; positions.len()];
    for condition in &case.model.conditions {
        let before = bodies[..condition.body].iter();
        let first: usize = before.map(|body| body.body.positions.len()).sum();
        for &particle in &condition.particles {
            values[first + particle as usize] = groups.len() as f64;
        }
        groups.push(group(describe(condition), false));
    }
    for obstacle in &case.model.obstacles {
        groups.push(group(format!("obstacle {}", obstacle.obstacle.name), true));
    }
    let corners = box_of(positions.iter());
    let middle = 0.5 * (corners.0 + corners.1);
    let walls = lines::walls(case, sight, &middle, corners, 0.0);
    let plot = ParticlePlot {
        view: sight.view(case),
        window: window(sight, corners, &walls, spacing),
        walls,
        groups: &groups,
        ..ParticlePlot::new(&positions, &values, "", "", spacing)
    };
    Figure::panels(heading(case), &[plot]).map_err(CliError::Picture)
}

/// The body and the bends of the walls around it, as long as they are about as large as the body:
/// ends of a line are only where it leaves the picture.
fn window(
    sight: Sight,
    (low, high): (Vec3, Vec3),
    walls: &[Wall],
    spacing: f64,
) -> Option<[[f64; 2]; 2]> {
    let [right, up, _] = sight.plane?;
    let size = (high - low).norm();
    let (mut lower, mut upper) = ([low[right], low[up]], [high[right], high[up]]);
    for wall in walls {
        let bends = wall.line.get(1..wall.line.len().saturating_sub(1));
        for bend in bends.into_iter().flatten() {
            let place = [bend[right], bend[up]];
            let is_near = [right, up]
                .into_iter()
                .all(|axis| bend[axis] > low[axis] - size && bend[axis] < high[axis] + size);
            if is_near {
                for i in 0..2 {
                    lower[i] = lower[i].min(place[i]);
                    upper[i] = upper[i].max(place[i]);
                }
            }
        }
    }
    let margin = spacing + 0.04 * (upper[0] - lower[0]).max(upper[1] - lower[1]);
    Some([lower.map(|x| x - margin), upper.map(|x| x + margin)])
}

/// Name, kind and number of particles of a condition.
fn describe(condition: &Condition) -> String {
    let axes = |components: &[Option<jstsph_solver::Signal>; 3]| -> String {
        let named = ["x", "y", "z"].into_iter().zip(components);
        named
            .filter_map(|(name, component)| component.as_ref().map(|_| name))
            .collect()
    };
    let kind = match &condition.kind {
        ConditionKind::Velocity(components) => format!("velocity {}", axes(components)),
        ConditionKind::Traction { .. } => "traction".to_owned(),
        ConditionKind::Temperature(_) => "temperature".to_owned(),
        ConditionKind::HeatFlux { .. } => "heat flux".to_owned(),
        ConditionKind::Convection { .. } => "convection".to_owned(),
    };
    format!("{}: {kind} ({})", condition.name, condition.particles.len())
}
