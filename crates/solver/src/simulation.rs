//! A running simulation and the named pieces that the integrators are made of.

use jstsph_material::MaterialBlock;
use jstsph_tensor::{Mat3, Vec3};

use crate::books::Ledger;
use crate::constraint::{Obstacles, Prescribed, Stage};
use crate::error::Place;
use crate::eulerian::CurrentKernels;
use crate::force::Loads;
use crate::heat::{HeatProcess, HeatStep, OutOfRange};
use crate::local_steps::LocalSteps;
use crate::model::{Formulation, Integrator, Model, Scheme};
use crate::profile::{Observer, Phase};
use crate::reference::Reference;
use crate::runge_kutta::{Method, Registers};
use crate::state::{State, Workspace};
use crate::strain::Strains;
use crate::time_step::{AcousticLimit, StableStep};
use crate::{
    SolverError, consistency, dissipation, force, leapfrog, local_steps, parallel, projection,
    runge_kutta, strain, stress,
};

/// A simulation: a [`Model`] that moves.
///
/// Run it inside one rayon pool (`pool.install(|| ...)`): entering a pool from outside costs more
/// than a step of a small problem. Results do not depend on the number of threads.
#[derive(Clone, Debug)]
pub struct Simulation {
    pub(crate) reference: Reference,
    pub(crate) scheme: Scheme,
    pub(crate) materials: Vec<MaterialBlock>,
    pub(crate) state: State,
    pub(crate) work: Workspace,
    pub(crate) ledger: Ledger,
    pub(crate) prescribed: Prescribed,
    pub(crate) obstacles: Obstacles,
    pub(crate) loads: Loads,
    /// Neighbours and kernels of the present positions, for the formulation that has them.
    eulerian: Option<Box<CurrentKernels>>,
    /// Temperatures that change, when they do.
    pub(crate) heat: Option<Box<HeatProcess>>,
    /// States that a Runge-Kutta step remembers; empty for the leapfrog.
    pub(crate) registers: Option<Box<Registers>>,
    /// Equivalent plastic strain of the points, kept when a dissipation depends on it.
    plastic_strain: Vec<f64>,
    pub(crate) observer: Observer,
    pub(crate) time: f64,
    pub(crate) dt: f64,
    pub(crate) step: u64,
    /// Whether momentum and positions belong to the same time.
    pub(crate) synchronised: bool,
    pub(crate) initial_energy: f64,
    /// Smallest principal stretch of the points when the step was last chosen.
    pub(crate) smallest_stretch: f64,
    /// First time step, to which the floor is relative; zero before it is known.
    pub(crate) first_dt: f64,
    /// The limit by the frequency of the deformed bodies, when it is used.
    pub(crate) acoustic: Option<Box<AcousticLimit>>,
    /// Groups with steps of their own, when they are used.
    pub(crate) local: Option<Box<LocalSteps>>,
}

impl Simulation {
    /// Builds operators, states and buffers. Nothing is allocated after this.
    ///
    /// # Errors
    /// [`SolverError`] when the model is inconsistent or a body cannot be discretised.
    pub fn new(model: Model) -> Result<Self, SolverError> {
        consistency::check(&model)?;
        let reference = Reference::new(&model)?;
        let momentum = model
            .bodies
            .iter()
            .flat_map(|body| {
                let density = body.material.density() * model.scheme.inertia_scale;
                body.initial_velocity
                    .iter()
                    .map(move |velocity| velocity * density)
            })
            .collect();
        let mut state = State::undeformed(&reference, &model.scheme, momentum);
        for (input, body) in model.bodies.iter().zip(&reference.bodies) {
            state.temperature[body.particles.clone()].copy_from_slice(&input.initial_temperature);
        }
        let materials: Vec<MaterialBlock> = model
            .bodies
            .iter()
            .zip(&reference.bodies)
            .map(|(input, body)| input.material.block(body.points.len()))
            .collect();
        let (prescribed, obstacles) = (Prescribed::new(&model), Obstacles::new(&model));
        let particles = reference.position.len();
        let points = reference.point_volume.len();
        let method = Method::of(model.scheme.integrator);
        let (momentum, has_impulses) = (&state.momentum, method.is_some());
        let constraints = (&prescribed, &obstacles);
        let mut ledger = Ledger::new(&reference, momentum, constraints, has_impulses);
        let loads = Loads::new(&model);
        let keeps_rates = model.scheme.integrator != Integrator::Leapfrog
            || strain::keeps_velocity_gradient(&model.scheme);
        let mut work = Workspace::new(&reference, keeps_rates);
        if !loads.is_empty() {
            work.external_force = vec![Vec3::zeros(); particles];
        }
        if model.scheme.stabilisation.hourglass != 0.0 {
            work.hourglass_stress = vec![Mat3::zeros(); particles];
            work.hourglass_point_stress = vec![Mat3::zeros(); points];
        }
        if model.scheme.formulation == Formulation::Displacement {
            work.displacement = vec![Vec3::zeros(); particles];
        }
        let jst = model.scheme.stabilisation.jst;
        ledger.open_accounts(&work, jst.is_some_and(|jst| jst.on_jacobian));
        let registers = method.map(|method| Box::new(Registers::new(&method, &state)));
        let plastic = if model.scheme.stabilisation.jst.is_some() {
            points
        } else {
            0
        };
        let mut simulation = Self {
            loads,
            eulerian: (model.scheme.formulation == Formulation::EulerianKernel)
                .then(|| Box::new(CurrentKernels::new(&model, &reference))),
            heat: HeatProcess::new(&model, &reference, &materials)?,
            acoustic: AcousticLimit::new(&model.scheme, &reference),
            local: LocalSteps::new(&model.scheme, &reference),
            scheme: model.scheme,
            reference,
            materials,
            state,
            work,
            ledger,
            prescribed,
            obstacles,
            registers,
            plastic_strain: vec![0.0; plastic],
            observer: None,
            time: 0.0,
            dt: 0.0,
            step: 0,
            synchronised: true,
            initial_energy: 0.0,
            smallest_stretch: 1.0,
            first_dt: 0.0,
        };
        // Momenta at time zero obey the prescribed velocities, without an impulse.
        simulation.prescribed.apply(
            &simulation.reference,
            0.0,
            0.0,
            &mut simulation.state.momentum,
            &mut simulation.ledger,
        );
        if simulation.local.is_none() {
            simulation.renew_acoustic_limit();
        }
        simulation.evaluate_stress(0.0)?;
        let energies = simulation.energies();
        simulation.initial_energy = energies.kinetic + energies.elastic;
        Ok(simulation)
    }

    /// Advances by one stable time step, or by the rest of the time to `end` if that is shorter.
    /// Does nothing at or after `end`.
    ///
    /// # Errors
    /// [`SolverError`] when a point inverts, a value is no longer finite or the time step falls
    /// below its floor. The state is then that of a step under way: go back to a saved one.
    pub fn advance_step(&mut self, end: f64) -> Result<(), SolverError> {
        if self.time >= end {
            return Ok(());
        }
        if let Some(mut local) = self.local.take() {
            let result = local_steps::step(self, &mut local, end);
            self.local = Some(local);
            result?;
        } else {
            match Method::of(self.scheme.integrator) {
                None => leapfrog::step(self, end)?,
                Some(method) => runge_kutta::step(self, &method, end)?,
            }
        }
        self.step += 1;
        Ok(())
    }

    /// Time of positions, strains and stresses, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps made.
    #[must_use]
    pub fn step_count(&self) -> u64 {
        self.step
    }

    /// Latest time step, s; zero before the first.
    #[must_use]
    pub fn time_step(&self) -> f64 {
        self.dt
    }

    /// Whether the momenta belong to the time of the positions (always with Runge-Kutta methods, at the
    /// beginning and the end of a run with the leapfrog).
    #[must_use]
    pub fn is_synchronised(&self) -> bool {
        self.synchronised
    }

    /// The unknowns.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// What never changes.
    #[must_use]
    pub fn reference(&self) -> &Reference {
        &self.reference
    }

    /// Whether temperatures change.
    #[must_use]
    pub fn has_heat(&self) -> bool {
        self.heat.as_ref().is_some_and(|heat| heat.is_active())
    }

    /// The scheme in use.
    #[must_use]
    pub fn scheme(&self) -> &Scheme {
        &self.scheme
    }

    pub(crate) fn strains(&self) -> Strains {
        Strains {
            formulation: self.scheme.formulation,
            quadrature: self.scheme.quadrature,
        }
    }

    /// Whether G is kept; the drift of the leapfrog works it out for itself elsewhere.
    pub(crate) fn keeps_velocity_gradient(&self) -> bool {
        strain::keeps_velocity_gradient(&self.scheme)
    }

    /// G of the present momenta.
    pub(crate) fn velocity_gradient(&mut self) {
        strain::pad_momenta(&self.state, &mut self.work);
        self.gradient_of_padded_momenta();
    }

    /// G of the present momenta, which have been padded.
    pub(crate) fn gradient_of_padded_momenta(&mut self) {
        if let Some(kernels) = &mut self.eulerian {
            kernels.velocity_gradient(&self.reference, &self.state, &mut self.work);
            return;
        }
        strain::velocity_gradient(&self.reference, &mut self.work);
    }

    /// Internal force, stabilisation and loads of the present state; the torque of the internal
    /// ones is taken out about `lever`. `[eq:momentum]`, `[eq:semi-discrete]`.
    pub(crate) fn forces(&mut self, lever: impl Fn(&State, usize) -> Vec3 + Sync) {
        let stabilisation = &self.scheme.stabilisation;
        match &mut self.eulerian {
            Some(kernels) => kernels.forces(&self.reference, &self.state, &mut self.work),
            None => force::internal(&self.reference, &mut self.work),
        }
        self.finished(Phase::Force);
        if stabilisation.upwind != 0.0 || stabilisation.hourglass != 0.0 {
            force::average_to_particles(&self.reference, &self.state, &mut self.work);
        }
        if stabilisation.hourglass != 0.0 {
            force::hourglass(
                &self.reference,
                &self.state,
                stabilisation.hourglass,
                &mut self.work,
            );
        }
        let dissipates = stabilisation.jst.is_some()
            || stabilisation.upwind != 0.0
            || stabilisation.viscosity.is_some();
        if self.eulerian.is_none() {
            dissipation::evaluate(
                stabilisation,
                &self.reference,
                &self.state,
                &self.plastic_strain,
                &mut self.work,
            );
        }
        if self.scheme.projection {
            let state = &self.state;
            let lever = |a: usize| lever(state, a);
            let work = &mut self.work;
            if dissipates {
                let fields = [&mut work.internal_force[..], &mut work.dissipation[..]];
                projection::conserve(&self.reference, &lever, fields);
            } else {
                projection::conserve(&self.reference, &lever, [&mut work.internal_force]);
            }
        }
        self.loads
            .evaluate(&self.reference, self.time, &mut self.work.external_force);
        self.finished(Phase::Stabilisation);
    }

    /// Stress of the present strains from the committed history, with the temperatures that go
    /// with them.
    pub(crate) fn evaluate_stress(&mut self, dt: f64) -> Result<(), SolverError> {
        if let Some(heat) = &self.heat {
            heat.exchange_with_elasticity(&self.reference, &self.materials, &mut self.state);
        }
        stress::evaluate(
            self.strains(),
            &self.reference,
            &self.state,
            &mut self.materials,
            &mut self.work,
            dt,
        )
        .map_err(|failure| self.constitutive(failure))
    }

    /// The one line where history moves.
    pub(crate) fn commit_history(&mut self) {
        self.materials.iter_mut().for_each(MaterialBlock::commit);
        let plastic_work = &self.work.plastic_work;
        parallel::for_each(&mut self.ledger.plastic_dissipation, |q, total| {
            *total += plastic_work[q];
        });
        self.refresh_plastic_strain();
    }

    /// Temperatures over the step of `dt` that has just been committed; the clock shows its end.
    pub(crate) fn advance_heat(&mut self, dt: f64) -> Result<(), SolverError> {
        let Some(heat) = &mut self.heat else {
            return Ok(());
        };
        let step = HeatStep {
            reference: &self.reference,
            materials: &self.materials,
            quadrature: self.scheme.quadrature,
            ledger: &self.ledger,
            displacement: &self.obstacles.displacement,
            time: self.time,
            dt,
            smallest_stretch: self.smallest_stretch,
        };
        heat.advance(step, &mut self.state, &self.work)
            .map_err(|failure| self.out_of_range(failure))
    }

    pub(crate) fn refresh_plastic_strain(&mut self) {
        if !self.plastic_strain.is_empty() {
            stress::equivalent_plastic_strain(
                &self.reference,
                &self.materials,
                &mut self.plastic_strain,
            );
        }
    }

    pub(crate) fn move_obstacles(&mut self, time: f64, dt: f64) {
        self.obstacles.advance(time, dt);
    }

    /// Prescribed velocities at `time` and contact over the travel of `dt` that follows.
    pub(crate) fn constrain(&mut self, time: f64, dt: f64, stage: Stage) {
        let Self {
            reference,
            state,
            ledger,
            ..
        } = self;
        let factor = stage.factor();
        self.prescribed
            .apply(reference, time, factor, &mut state.momentum, ledger);
        self.obstacles
            .apply(reference, time, dt, stage, state, ledger);
    }

    /// Sets the clock; `end` exactly when the step was cut there.
    pub(crate) fn advance_clock(&mut self, dt: f64, end: f64) {
        let rest = end - self.time;
        self.time = if rest <= dt { end } else { self.time + dt };
    }

    /// Work that D(J) does on the volumetric energy over `dt`.
    pub(crate) fn book_jacobian_dissipation(&mut self, dt: f64) {
        if !self
            .scheme
            .stabilisation
            .jst
            .is_some_and(|jst| jst.on_jacobian)
        {
            return;
        }
        let Self {
            state,
            work,
            ledger,
            ..
        } = self;
        let all = 0..state.jacobian.len();
        let arrays = (
            &mut state.jacobian[..],
            &mut work.volumetric_stress[..],
            &mut work.jacobian_dissipation[..],
        );
        parallel::for_each_page(
            all,
            arrays,
            &mut ledger.pages,
            |_, j, stress, rate, page| {
                for (account, ((j, stress), rate)) in page
                    .numerical
                    .iter_mut()
                    .zip(j.iter().zip(stress).zip(rate))
                {
                    account.total += dt * *stress / *j * *rate;
                }
            },
        );
    }

    // Errors, with everything a user needs to find the place.

    pub(crate) fn not_finite(&self, point: usize) -> SolverError {
        let (body, index) = self.reference.owner_of_point(point);
        let position = self.reference.point_position(body, index).into();
        SolverError::NotFinite {
            quantity: "deformation gradient",
            place: self.place(body, index, position),
            cfl: self.scheme.cfl,
        }
    }

    pub(crate) fn too_small(&self, time_step: f64, limit: f64, stable: &StableStep) -> SolverError {
        let (body, index) = self.reference.owner_of_point(stable.point);
        SolverError::TimeStepTooSmall {
            place: self.place(body, index, self.current_point_position(body, index)),
            time_step,
            limit,
            stretch: stable.stretch,
        }
    }

    fn out_of_range(&self, failure: OutOfRange) -> SolverError {
        let particle = self.reference.bodies[failure.body].particles.start + failure.particle;
        let mut place = self.place(
            failure.body,
            failure.particle,
            self.state.position[particle].into(),
        );
        place.what = "particle";
        SolverError::Temperature {
            place,
            temperature: failure.temperature,
            property: failure.property,
            low: failure.range.0,
            high: failure.range.1,
        }
    }

    pub(crate) fn constitutive(&self, failure: stress::StressFailure) -> SolverError {
        let (body, index) = (failure.body, failure.point);
        SolverError::Constitutive {
            place: self.place(body, index, self.current_point_position(body, index)),
            cfl: self.scheme.cfl,
            source: failure.source,
        }
    }

    fn place(&self, body: usize, index: usize, position: [f64; 3]) -> Box<Place> {
        Box::new(Place {
            what: self.point_name(),
            index,
            body: self.reference.bodies[body].name.clone(),
            position,
            time: self.time,
            step: self.step,
        })
    }

    /// `particle` or `bond`.
    #[must_use]
    pub fn point_name(&self) -> &'static str {
        match self.scheme.quadrature {
            crate::model::Quadrature::Particles => "particle",
            crate::model::Quadrature::Bonds => "bond",
        }
    }

    fn current_point_position(&self, body: usize, point: usize) -> [f64; 3] {
        let body = &self.reference.bodies[body];
        let [a, b] = body.ends[point].map(|end| body.particles.start + end as usize);
        ((self.state.position[a] + self.state.position[b]) * 0.5).into()
    }
}
