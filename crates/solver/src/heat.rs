//! Temperature: heating by plastic work, viscosity and friction, thermoelastic exchange, conduction,
//! and heat from outside.

use jstsph_material::{Block, BlockReader, Material, MaterialBlock, Property, Thermal};
use jstsph_tensor::Vec3;

use crate::books::Ledger;
use crate::constraint::CONTACT_TOLERANCE;
use crate::model::{Condition, ConditionKind, Heat, Model, ModelObstacle, Quadrature};
use crate::reference::{BodyReference, Reference};
use crate::state::{State, Workspace};
use crate::{SolverError, parallel};

mod conduction;

use conduction::{Conduction, Conductor};

/// Fraction of the explicit limit of conduction that a sub-step uses.
const CONDUCTION_SAFETY: f64 = 0.8;

/// Gap below which a particle exchanges heat with an obstacle, as a fraction of the spacing: wide
/// enough for the elastic lift-off of a particle between two steps.
const TOUCHING: f64 = 1e3 * CONTACT_TOLERANCE;

/// Boundary area of a particle, over its volume per spacing, below which it counts as inner: far above
/// the defect of summation by parts (0.01), far below a face (1 or more).
const SMALLEST_FACE: f64 = 0.1;

/// One body with what its heat needs.
#[derive(Clone, Debug)]
struct HeatBody {
    thermal: Thermal,
    /// None where no heat flows.
    conduction: Option<Conduction>,
    /// Range of its points in the flux buffer.
    flux: std::ops::Range<usize>,
    /// Outward area vectors of the particles in the reference configuration, m².
    boundary: Vec<Vec3>,
    /// Explicit limit of conduction in the undeformed body, s; infinite without conduction.
    step_limit: f64,
    /// Whether deformation exchanges heat with the elastic energy.
    thermoelastic: bool,
}

/// The heat of a simulation: settings, operators, buffers and books.
#[derive(Clone, Debug)]
pub(crate) struct HeatProcess {
    /// `None`: the surroundings keep every temperature, only the books are kept.
    settings: Option<Heat>,
    bodies: Vec<HeatBody>,
    conditions: Vec<Condition>,
    obstacles: Vec<ModelObstacle>,
    initial_temperature: Vec<f64>,
    /// J and T of the particles before the step under way.
    jacobian_before: Vec<f64>,
    temperature_before: Vec<f64>,
    /// Heat generated in the step under way, J/m³.
    source: Vec<f64>,
    flux: Vec<Vec3>,
    /// Heat flowing in, W/m³.
    rate: Vec<f64>,
    /// Heat made of dissipated work so far, J/m³.
    pub(crate) generated: Vec<f64>,
    /// Heat from outside so far, J/m³.
    pub(crate) supplied: Vec<f64>,
}

/// A temperature at which a material property is not defined.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OutOfRange {
    pub(crate) body: usize,
    /// Index in the body.
    pub(crate) particle: usize,
    pub(crate) temperature: f64,
    pub(crate) property: &'static str,
    pub(crate) range: (f64, f64),
}

/// Temperatures of adiabatic elastic changes of volume, from those before the step:
/// ρ c dT = T ∂τ_vol/∂T d(ln J), midpoint rule in T and J.
struct Adiabatic<'a> {
    capacity: &'a Property,
    density: f64,
    jacobian_before: &'a [f64],
    temperature_before: &'a [f64],
    jacobian: &'a [f64],
    temperature: &'a mut [f64],
}

impl BlockReader for Adiabatic<'_> {
    type Output = ();
    fn visit<M: Material>(&mut self, block: &Block<M>) {
        let (before, now) = (self.jacobian_before, self.jacobian);
        let (start, capacity, density) = (self.temperature_before, self.capacity, self.density);
        parallel::for_each(self.temperature, |a, temperature| {
            let middle = (before[a] * now[a]).sqrt();
            let change = (now[a] / before[a]).ln();
            let after = |t: f64| {
                let heat = block.model.thermoelastic_stress(middle, t) * change / density;
                heated(capacity, start[a], heat)
            };
            *temperature = after(0.5 * (start[a] + after(start[a])));
        });
    }
}

/// T ∂τ_vol/∂T ln(J/J₀) of every particle: heat per reference volume taken up by elasticity while
/// the surroundings keep the temperature, J/m³.
struct Isothermal<'a> {
    before: &'a [f64],
    after: &'a [f64],
    temperature: &'a [f64],
    out: &'a mut [f64],
}

impl BlockReader for Isothermal<'_> {
    type Output = ();
    fn visit<M: Material>(&mut self, block: &Block<M>) {
        let (before, after, temperature) = (self.before, self.after, self.temperature);
        parallel::for_each(self.out, |a, source| {
            let middle = (before[a] * after[a]).sqrt();
            *source += block.model.thermoelastic_stress(middle, temperature[a])
                * (after[a] / before[a]).ln();
        });
    }
}

struct IsThermoelastic;

impl BlockReader for IsThermoelastic {
    type Output = bool;
    fn visit<M: Material>(&mut self, block: &Block<M>) -> bool {
        block.model.thermoelastic_stress(0.99, 300.0) != 0.0
    }
}

impl HeatProcess {
    /// `None` when nothing in the model has to do with heat.
    ///
    /// # Errors
    /// [`SolverError::Inconsistent`] when a body's material lacks thermal properties that the
    /// model needs.
    pub(crate) fn new(
        model: &Model,
        reference: &Reference,
        materials: &[MaterialBlock],
    ) -> Result<Option<Box<Self>>, SolverError> {
        let thermoelastic: Vec<bool> = materials
            .iter()
            .map(|block| block.visit_ref(&mut IsThermoelastic))
            .collect();
        if model.heat.is_none() && !thermoelastic.contains(&true) {
            return Ok(None);
        }
        let conducts = model.heat.is_some_and(|heat| heat.conduction);
        let mut bodies = Vec::new();
        let mut first_flux = 0;
        for ((input, body), thermoelastic) in model
            .bodies
            .iter()
            .zip(&reference.bodies)
            .zip(thermoelastic)
        {
            let Some(thermal) = input.material.thermal().cloned() else {
                return Err(SolverError::Inconsistent {
                    what: format!(
                        "heat needs thermal properties, but the material of body \"{}\" has none: \
                         give its model a table `thermal`",
                        input.name
                    ),
                });
            };
            let volume = &reference.volume[body.particles.clone()];
            let conductivity = thermal.conductivity.largest();
            let conduction = if conducts && conductivity > 0.0 {
                Some(Conduction::new(input, body, model.scheme.quadrature)?)
            } else {
                None
            };
            let capacity = body.material_density * thermal.heat_capacity.smallest();
            let bound = conduction
                .as_ref()
                .map_or(0.0, |flow| flow.spectral_bound(body, volume))
                * conductivity
                / capacity;
            let flux = first_flux..first_flux + conduction.as_ref().map_or(0, Conduction::points);
            first_flux = flux.end;
            bodies.push(HeatBody {
                boundary: body
                    .gradient
                    .boundary_vectors(&reference.point_volume[body.points.clone()]),
                step_limit: if bound > 0.0 {
                    2.0 / bound
                } else {
                    f64::INFINITY
                },
                thermal,
                conduction,
                flux,
                thermoelastic,
            });
        }
        let particles = reference.position.len();
        let initial_temperature: Vec<f64> = model
            .bodies
            .iter()
            .flat_map(|body| body.initial_temperature.iter().copied())
            .collect();
        Ok(Some(Box::new(Self {
            settings: model.heat,
            bodies,
            conditions: model
                .conditions
                .iter()
                .filter(|condition| condition.kind.is_thermal())
                .cloned()
                .collect(),
            obstacles: model.obstacles.clone(),
            temperature_before: initial_temperature.clone(),
            initial_temperature,
            jacobian_before: vec![1.0; particles],
            source: vec![0.0; particles],
            flux: vec![Vec3::zeros(); first_flux],
            rate: vec![0.0; particles],
            generated: vec![0.0; particles],
            supplied: vec![0.0; particles],
        })))
    }

    /// Whether temperatures change.
    pub(crate) fn is_active(&self) -> bool {
        self.settings.is_some()
    }

    /// Remembers J and T before a step.
    pub(crate) fn open(&mut self, state: &State) {
        self.jacobian_before.copy_from_slice(&state.jacobian);
        self.temperature_before.copy_from_slice(&state.temperature);
    }

    /// Temperatures that go with the present J, before the stress is evaluated with them.
    ///
    /// The thermoelastic exchange belongs to the stress of the same J: one step late it would be a
    /// negative viscosity, (3 α κ)² T/(ρ c) Δt, and the waves of an elastic body would grow.
    pub(crate) fn exchange_with_elasticity(
        &self,
        reference: &Reference,
        materials: &[MaterialBlock],
        state: &mut State,
    ) {
        if self.settings.is_none() {
            return;
        }
        for ((body, heat), material) in reference.bodies.iter().zip(&self.bodies).zip(materials) {
            if !heat.thermoelastic {
                continue;
            }
            let range = body.particles.clone();
            material.visit_ref(&mut Adiabatic {
                capacity: &heat.thermal.heat_capacity,
                density: body.material_density,
                jacobian_before: &self.jacobian_before[range.clone()],
                temperature_before: &self.temperature_before[range.clone()],
                jacobian: &state.jacobian[range.clone()],
                temperature: &mut state.temperature[range],
            });
        }
    }

    /// Advances the temperatures over the step of `dt` that ends at `time` with the present state.
    ///
    /// ```text
    ///   ρ c dT/dt = β τ_eq dε_p/dt + T ∂τ_vol/∂T d(ln J)/dt + viscous and friction heat
    ///               + Div(K grad T) + heat from outside                               [eq:heat]
    /// ```
    ///
    /// Dissipated heat spreads evenly over the step; conduction is explicit, in as many sub-steps
    /// as its own limit asks for.
    pub(crate) fn advance(
        &mut self,
        context: HeatStep<'_>,
        state: &mut State,
        work: &Workspace,
    ) -> Result<(), OutOfRange> {
        self.collect_sources(&context, state, work);
        let Some(settings) = self.settings else {
            // The surroundings take up what elasticity gives off.
            let source = &self.source;
            parallel::for_each(&mut self.supplied, |a, supplied| *supplied -= source[a]);
            return Ok(());
        };
        let reference = context.reference;
        for (index, body) in reference.bodies.iter().enumerate() {
            let steps = self.sub_steps(index, settings, &context);
            let dt = context.dt / f64::from(steps);
            for sub_step in 1..=steps {
                let time = context.time - context.dt + f64::from(sub_step) * dt;
                self.conduct(index, body, &context, state);
                self.exchange_with_outside(index, body, &context, state, time, dt);
                self.update_temperature(index, body, state, dt / context.dt, dt);
                self.prescribe(index, reference, state, time);
            }
            self.check_range(index, body, state)?;
        }
        Ok(())
    }

    /// Heat generated over the step, and the exchange with elasticity.
    fn collect_sources(&mut self, context: &HeatStep<'_>, state: &State, work: &Workspace) {
        for ((body, heat), material) in context
            .reference
            .bodies
            .iter()
            .zip(&self.bodies)
            .zip(context.materials)
        {
            let range = body.particles.clone();
            let source = &mut self.source[range.clone()];
            if let Some(settings) = self.settings {
                let plastic = &work.plastic_work[body.points.clone()];
                let share = heat.thermal.taylor_quinney;
                let viscous = if settings.viscous_heating && !work.viscous_heating.is_empty() {
                    &work.viscous_heating[range.clone()]
                } else {
                    &[]
                };
                let friction = settings.friction_heating.then_some(context.ledger);
                let generated = &mut self.generated[range.clone()];
                parallel::for_each_pair(source, generated, |a, source, generated| {
                    let mut heat = share * body.shares.mean(a, |q| plastic[q]);
                    if let Some(rate) = viscous.get(a) {
                        heat += rate * context.dt;
                    }
                    heat += friction.map_or(0.0, |ledger| ledger.friction_heat(range.start + a));
                    *source = heat;
                    *generated += heat;
                });
            } else {
                source.fill(0.0);
            }
            if heat.thermoelastic && self.settings.is_none() {
                material.visit_ref(&mut Isothermal {
                    before: &self.jacobian_before[range.clone()],
                    after: &state.jacobian[range.clone()],
                    temperature: &state.temperature[range.clone()],
                    out: &mut self.source[range],
                });
            }
        }
    }

    /// Sub-steps of conduction. Compression shortens the explicit limit: the largest principal
    /// conductivity is J k over the square of the smallest stretch.
    fn sub_steps(&self, index: usize, settings: Heat, context: &HeatStep<'_>) -> u32 {
        if !settings.conduction {
            return 1;
        }
        let stretch = context.smallest_stretch;
        let limit = CONDUCTION_SAFETY * self.bodies[index].step_limit * stretch * stretch;
        (context.dt / limit).ceil().clamp(1.0, f64::from(u32::MAX)) as u32
    }

    fn conduct(
        &mut self,
        index: usize,
        body: &BodyReference,
        context: &HeatStep<'_>,
        state: &State,
    ) {
        let heat = &self.bodies[index];
        let range = body.particles.clone();
        let of = Conductor {
            body,
            quadrature: context.quadrature,
            temperature: &state.temperature[range.clone()],
            deformation: state.deformation(body.points.clone()),
            volume: &context.reference.volume[range.clone()],
            conductivity: &heat.thermal.conductivity,
        };
        match &heat.conduction {
            Some(conduction) => {
                let flux = &mut self.flux[heat.flux.clone()];
                conduction.rate(of, flux, &mut self.rate[range]);
            }
            None => self.rate[range].fill(0.0),
        }
    }

    /// Flux, convection and contact with obstacles, added to the rate and to the books.
    fn exchange_with_outside(
        &mut self,
        index: usize,
        body: &BodyReference,
        context: &HeatStep<'_>,
        state: &State,
        time: f64,
        dt: f64,
    ) {
        let reference = context.reference;
        let first = body.particles.start;
        for condition in self.conditions.iter().filter(|c| c.body == index) {
            let Some(areas) = condition.kind.areas() else {
                continue;
            };
            for (&particle, area) in condition.particles.iter().zip(areas) {
                let a = first + particle as usize;
                let flux = heat_flux(
                    &condition.kind,
                    time,
                    &reference.position[a],
                    state.temperature[a],
                );
                let rate = flux * area / reference.volume[a];
                self.rate[a] += rate;
                self.supplied[a] += rate * dt;
            }
        }
        for (o, obstacle) in self.obstacles.iter().enumerate() {
            let Some(exchange) = &obstacle.heat else {
                continue;
            };
            let temperature = exchange.temperature.at(time, &Vec3::zeros());
            let displacement = context.displacement[o];
            let surface = &obstacle.obstacle.surface;
            let boundary = &self.bodies[index].boundary;
            let deformation = state.deformation(body.points.clone());
            let reach = TOUCHING * body.spacing;
            parallel::for_each_pair(
                &mut self.rate[body.particles.clone()],
                &mut self.supplied[body.particles.clone()],
                |a, rate, supplied| {
                    // Inner particles have no area to exchange heat through.
                    let area = &boundary[a];
                    let volume = reference.volume[first + a];
                    if area.norm() * body.spacing < SMALLEST_FACE * volume {
                        return;
                    }
                    let gap = surface.gap(&(state.position[first + a] - displacement));
                    if gap.distance > reach {
                        return;
                    }
                    // Nanson: the current area is H times the reference one; the wall's normal
                    // points at the body, its own outward area the other way.
                    let current = body.shares.mean_tensor(a, |q| deformation.cofactor(q)) * area;
                    let facing = -current.dot(&gap.normal);
                    if facing > 0.0 {
                        let flow = exchange.conductance
                            * facing
                            * (temperature - state.temperature[first + a])
                            / volume;
                        *rate += flow;
                        *supplied += flow * dt;
                    }
                },
            );
        }
    }

    /// T from the heat of a sub-step, which is `fraction` of the step's sources and `dt` of the rates.
    fn update_temperature(
        &mut self,
        index: usize,
        body: &BodyReference,
        state: &mut State,
        fraction: f64,
        dt: f64,
    ) {
        let capacity = &self.bodies[index].thermal.heat_capacity;
        let density = body.material_density;
        let range = body.particles.clone();
        let (source, rate) = (&self.source[range.clone()], &self.rate[range.clone()]);
        parallel::for_each(&mut state.temperature[range], |a, temperature| {
            let heat = (fraction * source[a] + dt * rate[a]) / density;
            *temperature = heated(capacity, *temperature, heat);
        });
    }

    /// Prescribed temperatures; what they take is heat from outside.
    fn prescribe(&mut self, index: usize, reference: &Reference, state: &mut State, time: f64) {
        let body = &reference.bodies[index];
        let capacity = &self.bodies[index].thermal.heat_capacity;
        for condition in self.conditions.iter().filter(|c| c.body == index) {
            let ConditionKind::Temperature(signal) = &condition.kind else {
                continue;
            };
            for &particle in &condition.particles {
                let a = body.particles.start + particle as usize;
                let prescribed = signal.at(time, &reference.position[a]);
                self.supplied[a] +=
                    body.material_density * capacity.integral(state.temperature[a], prescribed);
                state.temperature[a] = prescribed;
            }
        }
    }

    fn check_range(
        &self,
        index: usize,
        body: &BodyReference,
        state: &State,
    ) -> Result<(), OutOfRange> {
        let thermal = &self.bodies[index].thermal;
        let limits = [
            ("heat capacity", thermal.heat_capacity.range()),
            ("conductivity", thermal.conductivity.range()),
            // Absolute zero; a NaN is outside too.
            ("temperature", Some((0.0, f64::MAX))),
        ];
        let temperatures = &state.temperature[body.particles.clone()];
        // One parallel pass says that all is well; only when it is not the first offence is looked
        // for, property by property.
        let allowed = limits.iter().filter_map(|(_, range)| *range);
        let (low, high) = allowed.fold((0.0_f64, f64::MAX), |(low, high), range| {
            (low.max(range.0), high.min(range.1))
        });
        let all_inside = parallel::reduce(
            temperatures.len(),
            &|part| {
                let part = temperatures[part].iter();
                part.fold(true, |inside, t| inside & (*t >= low) & (*t <= high))
            },
            &|a, b| a && b,
        );
        if all_inside {
            return Ok(());
        }
        for (property, range) in limits {
            let Some((low, high)) = range else { continue };
            let outside = |t: &f64| !(*t >= low && *t <= high);
            if let Some(particle) = temperatures.iter().position(outside) {
                return Err(OutOfRange {
                    body: index,
                    particle,
                    temperature: temperatures[particle],
                    property,
                    range: (low, high),
                });
            }
        }
        Ok(())
    }

    /// Heat content above that of the start, Σ V ρ ∫ c dT, J.
    pub(crate) fn content(&self, reference: &Reference, state: &State) -> f64 {
        reference
            .bodies
            .iter()
            .zip(&self.bodies)
            .map(|(body, heat)| {
                let first = body.particles.start;
                let capacity = &heat.thermal.heat_capacity;
                parallel::sum(body.particles.len(), 0.0, |a| {
                    let i = first + a;
                    reference.volume[i]
                        * body.material_density
                        * capacity.integral(self.initial_temperature[i], state.temperature[i])
                })
            })
            .sum()
    }
}

/// What a heat step reads beside the state.
#[derive(Clone, Copy)]
pub(crate) struct HeatStep<'a> {
    pub(crate) reference: &'a Reference,
    pub(crate) materials: &'a [MaterialBlock],
    pub(crate) quadrature: Quadrature,
    /// What friction took from the particles in the last kick.
    pub(crate) ledger: &'a Ledger,
    /// Displacements of the obstacles, m.
    pub(crate) displacement: &'a [Vec3],
    /// End and length of the step, s.
    pub(crate) time: f64,
    pub(crate) dt: f64,
    pub(crate) smallest_stretch: f64,
}

/// Heat that a condition lets into the body per reference area and time, W/m².
fn heat_flux(kind: &ConditionKind, time: f64, position: &Vec3, temperature: f64) -> f64 {
    match kind {
        ConditionKind::HeatFlux { flux, .. } => flux.at(time, position),
        ConditionKind::Convection {
            coefficient,
            ambient,
            ..
        } => coefficient * (ambient.at(time, position) - temperature),
        _ => 0.0,
    }
}

/// Temperature after `heat` (J/kg) was added; exact also for a tabulated capacity.
#[inline]
fn heated(capacity: &Property, temperature: f64, heat: f64) -> f64 {
    match capacity {
        Property::Constant(capacity) => temperature + heat / capacity,
        Property::Table { .. } => {
            // Newton on the convex-by-pieces enthalpy; the capacity is positive everywhere.
            let mut found = temperature + heat / capacity.at(temperature);
            for _ in 0..20 {
                let change = (heat - capacity.integral(temperature, found)) / capacity.at(found);
                found += change;
                if change.abs() <= 1e-14 * temperature {
                    break;
                }
            }
            found
        }
    }
}

#[cfg(test)]
mod tests;
