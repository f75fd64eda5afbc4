//! Checks of a model that its types cannot express.

use jstsph_material::MaterialSpec;

use crate::SolverError;
use crate::constraint::MAX_OBSTACLES;
use crate::model::{
    ConditionKind, Formulation, Integrator, Model, ModelBody, Quadrature, Scheme, Stabilisation,
    StepLimit,
};

/// Refuses a model whose parts do not fit together, or whose numbers are out of range.
pub(crate) fn check(model: &Model) -> Result<(), SolverError> {
    let inconsistent = |what: String| Err(SolverError::Inconsistent { what });
    if model.bodies.is_empty() {
        return inconsistent("a simulation needs at least one body".into());
    }
    if model.obstacles.len() > MAX_OBSTACLES {
        return inconsistent(format!(
            "{} obstacles exceed the limit of {MAX_OBSTACLES}",
            model.obstacles.len()
        ));
    }
    for body in &model.bodies {
        body.material
            .validate()
            .map_err(|source| SolverError::Material {
                body: body.name.clone(),
                source,
            })?;
        if body.initial_velocity.len() != body.body.positions.len() {
            return inconsistent(format!(
                "body \"{}\" has {} particles but {} initial velocities",
                body.name,
                body.body.positions.len(),
                body.initial_velocity.len()
            ));
        }
        if body.initial_temperature.len() != body.body.positions.len() {
            return inconsistent(format!(
                "body \"{}\" has {} particles but {} initial temperatures",
                body.name,
                body.body.positions.len(),
                body.initial_temperature.len()
            ));
        }
        if let Some(t) = body
            .initial_temperature
            .iter()
            .find(|t| !(**t > 0.0 && t.is_finite()))
        {
            return inconsistent(format!(
                "body \"{}\" has an initial temperature of {t} K: it must be greater than 0 K",
                body.name
            ));
        }
    }
    for condition in &model.conditions {
        let Some(body) = model.bodies.get(condition.body) else {
            return inconsistent(format!(
                "condition \"{}\" refers to body {} of {}",
                condition.name,
                condition.body,
                model.bodies.len()
            ));
        };
        let particles = body.body.positions.len();
        if let Some(particle) = condition
            .particles
            .iter()
            .find(|a| **a as usize >= particles)
        {
            return inconsistent(format!(
                "condition \"{}\" refers to particle {particle} of {particles}",
                condition.name
            ));
        }
        if let Some(areas) = condition.kind.areas()
            && areas.len() != condition.particles.len()
        {
            return inconsistent(format!(
                "condition \"{}\" has {} areas for {} particles",
                condition.name,
                areas.len(),
                condition.particles.len()
            ));
        }
    }
    let scheme = &model.scheme;
    for (name, value) in [
        ("cfl", scheme.cfl),
        ("smoothing ratio", scheme.smoothing_ratio),
    ] {
        if !(value.is_finite() && value > 0.0) {
            return inconsistent(format!("{name} is {value}, it must be positive"));
        }
    }
    if !(scheme.inertia_scale.is_finite() && scheme.inertia_scale > 0.0) {
        return inconsistent(format!(
            "the mass scaling is {}, it must be positive",
            scheme.inertia_scale
        ));
    }
    if model.heat.is_none()
        && let Some(condition) = model.conditions.iter().find(|c| c.kind.is_thermal())
    {
        return inconsistent(format!(
            "condition \"{}\" acts on the temperature, but the model has no heat",
            condition.name
        ));
    }
    if scheme.formulation == Formulation::EulerianKernel {
        check_eulerian(model)?;
    }
    if !scheme.substeps.is_power_of_two() {
        return inconsistent(format!(
            "{} sub-steps: their number must be a power of two",
            scheme.substeps
        ));
    }
    if scheme.substeps > 1
        && let Some(needed) = model.lacks_for_substeps()
    {
        return inconsistent(format!("sub-steps need {needed}"));
    }
    if !scheme.formulation.integrates_jacobian()
        && scheme.stabilisation.jst.is_some_and(|jst| jst.on_jacobian)
    {
        return inconsistent(
            "JST dissipation of J needs J as an unknown: formulation \"pFHJ\" or \"pFJ\"".into(),
        );
    }
    Ok(())
}

impl Model {
    /// What local time steps ([`Scheme::substeps`]) would need that the model does not have.
    #[must_use]
    pub fn lacks_for_substeps(&self) -> Option<&'static str> {
        let Scheme {
            quadrature,
            formulation,
            integrator,
            step_limit,
            stabilisation,
            projection,
            ..
        } = self.scheme;
        let mut tractions = self.conditions.iter().map(|condition| &condition.kind);
        let failing = |body: &ModelBody| matches!(&body.material, MaterialSpec::HenckyVonMises(metal) if metal.damage.is_some());
        let missing = [
            (integrator != Integrator::Leapfrog, "the leapfrog"),
            (quadrature != Quadrature::Bonds, "bonds as quadrature"),
            (
                step_limit != StepLimit::Acoustic,
                "the acoustic limit of the time step",
            ),
            (
                formulation != Formulation::MomentumGradientCofactorJacobian,
                "the formulation \"pFHJ\"",
            ),
            (
                stabilisation != Stabilisation::default(),
                "a scheme without stabilisation",
            ),
            (projection, "a scheme without projection"),
            (self.heat.is_some(), "temperatures that do not change"),
            (
                tractions.any(|kind| matches!(kind, ConditionKind::Traction { .. })),
                "a model without tractions",
            ),
            (self.bodies.iter().any(failing), "materials without damage"),
        ];
        let mut missing = missing.into_iter();
        missing.find_map(|(lacks, needed)| lacks.then_some(needed))
    }
}

/// The Eulerian-kernel formulation exists for comparison: particles, leapfrog, viscosity.
fn check_eulerian(model: &Model) -> Result<(), SolverError> {
    let scheme = &model.scheme;
    let stabilisation = &scheme.stabilisation;
    let refused = if scheme.quadrature != Quadrature::Particles {
        "needs quadrature = \"particles\""
    } else if scheme.integrator != Integrator::Leapfrog {
        "needs the leapfrog integrator"
    } else if stabilisation.jst.is_some()
        || stabilisation.upwind != 0.0
        || stabilisation.hourglass != 0.0
    {
        "has no stabilisation but artificial viscosity: the others live in the reference configuration"
    } else if scheme.step_limit == StepLimit::Acoustic {
        "has no acoustic limit of the time step: its operator changes with the positions"
    } else if model.heat.is_some_and(|heat| heat.conduction) {
        "does not conduct heat"
    } else {
        return Ok(());
    };
    Err(SolverError::Inconsistent {
        what: format!("formulation \"eulerian-kernel\" {refused}"),
    })
}
