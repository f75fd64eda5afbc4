//! A body of revolution that meets a rigid, frictionless wall: central differences and the balance.

use super::{Body, Inverted, Mesh, Metal};

/// What the base of the bar may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// It touches the wall and may lift off.
    Free,
    /// Its nodes keep their height, as in a symmetric impact of two bars.
    Held,
}

/// Energies, J.
#[derive(Clone, Copy, Debug)]
pub struct Energies {
    /// Kinetic energy at the start.
    pub initial: f64,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Elastic energy.
    pub elastic: f64,
    /// Plastic work since the start.
    pub plastic: f64,
    /// Energy lost by nodes that the wall stopped, since the start.
    pub wall: f64,
}

impl Energies {
    /// What is missing, of the initial energy.
    #[must_use]
    pub fn balance(&self) -> f64 {
        (self.kinetic + self.elastic + self.plastic + self.wall) / self.initial - 1.0
    }
}

/// A body in flight towards or on the wall z = 0.
#[derive(Clone, Debug)]
pub struct Impact {
    /// The body.
    pub body: Body,
    /// Velocities of the nodes half a step before [`time`](Self::time), m/s.
    pub velocity: Vec<[f64; 2]>,
    base: Base,
    courant: f64,
    time: f64,
    step: f64,
    steps: usize,
    energies: Energies,
    // Booked by the kicks before the last, and by the last.
    wall: f64,
}

impl Impact {
    /// A body whose nodes all move with the axial velocity `speed` (negative: towards the wall).
    ///
    /// # Arguments
    /// * `courant`: step over the estimate [`Body::stable_step`].
    #[must_use]
    pub fn new(mesh: Mesh, metal: Metal, base: Base, speed: f64, courant: f64) -> Self {
        let body = Body::new(mesh, metal);
        let velocity = vec![[0.0, speed]; body.mass.len()];
        let initial = kinetic(&body.mass, &velocity);
        Self {
            step: 0.0,
            velocity,
            base,
            courant,
            time: 0.0,
            steps: 0,
            energies: Energies {
                initial,
                kinetic: initial,
                elastic: 0.0,
                plastic: 0.0,
                wall: 0.0,
            },
            wall: 0.0,
            body,
        }
    }

    /// Time of the positions, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Steps made.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.steps
    }

    /// Energies one step before the last: those of the present are known after the next kick.
    #[must_use]
    pub fn energies(&self) -> Energies {
        self.energies
    }

    /// Steps until `end`, s; the last one is cut to arrive there.
    ///
    /// # Errors
    /// If an element is inverted.
    pub fn run_to(&mut self, end: f64) -> Result<(), Inverted> {
        while self.time < end {
            let mut next = self.courant * self.body.stable_step();
            if self.step > 0.0 {
                // Sudden growth of the step costs the second order of central differences.
                next = next.min(1.05 * self.step);
            }
            let left = end - self.time;
            if next >= left {
                next = left;
                self.advance(next)?;
                self.time = end;
            } else {
                // No sliver of a step at the end.
                self.advance(next.min(left / 1.5))?;
            }
        }
        Ok(())
    }

    /// One step: kick over half of the last and half of the next step, wall, drift, forces.
    fn advance(&mut self, next: f64) -> Result<(), Inverted> {
        let kick = 0.5 * (self.step + next);
        let before = kinetic(&self.body.mass, &self.velocity);
        let base = self.body.mesh.base();
        let mut lost = 0.0;
        for (node, v) in self.velocity.iter_mut().enumerate() {
            let mass = self.body.mass[node];
            let force = self.body.force[node];
            let before = v[1];
            v[0] += kick * force[0] / mass;
            v[1] += kick * force[1] / mass;
            if self.body.mesh.nodes[node][0] == 0.0 {
                v[0] = 0.0;
            }
            let height = self.body.position[node][1];
            let held = self.base == Base::Held && base.contains(&node);
            let slowest = if held { 0.0 } else { -height / next };
            if held || v[1] < slowest {
                // Impulse of the wall times the mean velocity of the kick.
                lost += 0.5 * mass * (v[1] - slowest) * (before + slowest);
                v[1] = slowest;
            }
        }
        let after = kinetic(&self.body.mass, &self.velocity);
        let stored = self.body.stored();
        // At the first kick, a half one, both energies are those of the start.
        let (kinetic_now, wall_now) = if self.steps == 0 {
            (after, self.wall + lost)
        } else {
            (0.5 * (before + after), self.wall + 0.5 * lost)
        };
        self.energies.kinetic = kinetic_now;
        self.energies.wall = wall_now;
        self.energies.elastic = stored.elastic;
        self.energies.plastic = stored.plastic;
        self.wall += lost;

        for (x, v) in self.body.position.iter_mut().zip(&self.velocity) {
            x[0] += next * v[0];
            x[1] += next * v[1];
        }
        self.time += next;
        self.step = next;
        self.steps += 1;
        self.body.deform()
    }
}

fn kinetic(mass: &[f64], velocity: &[[f64; 2]]) -> f64 {
    mass.iter()
        .zip(velocity)
        .map(|(m, [r, z])| 0.5 * m * (r * r + z * z))
        .sum()
}
