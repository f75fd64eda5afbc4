//! The complete state as named arrays of numbers, for restart files.

use jstsph_material::{Block, BlockReader, BlockVisitor, History, Material, MaterialBlock};
use jstsph_tensor::{Mat3, Vec3};

use crate::SolverError;
use crate::simulation::Simulation;
use crate::state::Work;

/// Everything that moves in a simulation; with the model it restores the simulation bit by bit.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    /// Time, s.
    pub time: f64,
    /// Latest time step, s.
    pub time_step: f64,
    /// Steps made.
    pub step: u64,
    /// Whether momenta and positions belong to the same time.
    pub synchronised: bool,
    /// Named arrays, flat, particle by particle.
    pub arrays: Vec<(String, Vec<f64>)>,
}

fn flat_vectors(values: &[Vec3]) -> Vec<f64> {
    values.iter().flat_map(|v| [v.x, v.y, v.z]).collect()
}

fn flat_tensors(values: &[Mat3]) -> Vec<f64> {
    values
        .iter()
        .flat_map(|m| m.as_slice().iter().copied())
        .collect()
}

fn flat_work(values: &[Work]) -> Vec<f64> {
    values
        .iter()
        .flat_map(|w| [w.numerical, w.external, w.contact, w.friction])
        .collect()
}

struct WriteHistory;

impl BlockReader for WriteHistory {
    type Output = Vec<f64>;
    fn visit<M: Material>(&mut self, block: &Block<M>) -> Vec<f64> {
        let columns = M::History::FIELDS.len();
        let mut flat = vec![0.0; columns * block.committed.len()];
        if columns > 0 {
            for (history, row) in block.committed.iter().zip(flat.chunks_mut(columns)) {
                history.write(row);
            }
        }
        flat
    }
}

struct ReadHistory<'a> {
    flat: &'a [f64],
}

impl BlockVisitor for ReadHistory<'_> {
    /// Whether the array has the right length.
    type Output = bool;
    fn visit<M: Material>(&mut self, block: &mut Block<M>) -> bool {
        let columns = M::History::FIELDS.len();
        if self.flat.len() != columns * block.committed.len() {
            return false;
        }
        if columns > 0 {
            for (history, row) in block.committed.iter_mut().zip(self.flat.chunks(columns)) {
                *history = M::History::read(row);
            }
        }
        true
    }
}

/// Arrays of a saved state by name, with errors that say what is wrong.
struct Arrays<'a> {
    saved: &'a Saved,
}

impl<'a> Arrays<'a> {
    fn get(&self, name: &str, length: usize) -> Result<&'a [f64], SolverError> {
        let found = self
            .saved
            .arrays
            .iter()
            .find(|(n, _)| n == name)
            .map(|(_, values)| values);
        match found {
            Some(values) if values.len() == length => Ok(values),
            Some(values) => Err(SolverError::ForeignState {
                what: format!(
                    "{name} has {} numbers, this case has {length}",
                    values.len()
                ),
            }),
            None => Err(SolverError::ForeignState {
                what: format!("{name} is missing"),
            }),
        }
    }

    fn scalars(&self, name: &str, out: &mut [f64]) -> Result<(), SolverError> {
        out.copy_from_slice(self.get(name, out.len())?);
        Ok(())
    }

    fn vectors(&self, name: &str, out: &mut [Vec3]) -> Result<(), SolverError> {
        let flat = self.get(name, 3 * out.len())?;
        for (v, c) in out.iter_mut().zip(flat.chunks_exact(3)) {
            *v = Vec3::new(c[0], c[1], c[2]);
        }
        Ok(())
    }

    fn tensors(&self, name: &str, out: &mut [Mat3]) -> Result<(), SolverError> {
        let flat = self.get(name, 9 * out.len())?;
        for (m, c) in out.iter_mut().zip(flat.chunks_exact(9)) {
            *m = Mat3::from_column_slice(c);
        }
        Ok(())
    }

    fn work(&self, name: &str, out: &mut [Work]) -> Result<(), SolverError> {
        let flat = self.get(name, 4 * out.len())?;
        for (w, c) in out.iter_mut().zip(flat.chunks_exact(4)) {
            *w = Work {
                numerical: c[0],
                external: c[1],
                contact: c[2],
                friction: c[3],
            };
        }
        Ok(())
    }
}

impl Simulation {
    /// The complete state.
    #[must_use]
    pub fn save(&self) -> Saved {
        let (state, ledger, work) = (&self.state, &self.ledger, &self.work);
        let mut arrays = vec![
            ("position".to_owned(), flat_vectors(&state.position)),
            ("momentum".to_owned(), flat_vectors(&state.momentum)),
            ("jacobian".to_owned(), state.jacobian.clone()),
            ("temperature".to_owned(), state.temperature.clone()),
            (
                "deformation_gradient".to_owned(),
                flat_tensors(&state.deformation_gradient),
            ),
            ("cofactor".to_owned(), flat_tensors(&state.cofactor)),
            // Re-evaluated stresses differ in the last bit where a point is on its yield surface.
            (
                "scaled_stress".to_owned(),
                flat_tensors(&work.scaled_stress),
            ),
            (
                "volumetric_stress".to_owned(),
                work.volumetric_stress.clone(),
            ),
            ("plastic_work".to_owned(), work.plastic_work.clone()),
            // The next step does not need them, the energies (4.1) of the last one do.
            (
                "internal_force".to_owned(),
                flat_vectors(&work.internal_force),
            ),
            ("dissipation".to_owned(), flat_vectors(&work.dissipation)),
            (
                "jacobian_dissipation".to_owned(),
                work.jacobian_dissipation.clone(),
            ),
            (
                "momentum_before".to_owned(),
                flat_vectors(&ledger.momentum_before),
            ),
            ("work".to_owned(), flat_work(&ledger.work)),
            ("last_work".to_owned(), flat_work(&ledger.last_work)),
            (
                "plastic_dissipation".to_owned(),
                ledger.plastic_dissipation.clone(),
            ),
            (
                "condition_impulse".to_owned(),
                flat_vectors(&ledger.condition_impulse),
            ),
            (
                "obstacle_displacement".to_owned(),
                flat_vectors(&self.obstacles.displacement),
            ),
            (
                "contact_impulse".to_owned(),
                ledger
                    .contact
                    .iter()
                    .flat_map(|s| [s.impulse.x, s.impulse.y, s.impulse.z])
                    .collect(),
            ),
            (
                "contact_given".to_owned(),
                flat_vectors(
                    &ledger
                        .contact
                        .iter()
                        .flat_map(|s| [s.given.normal, s.given.friction])
                        .collect::<Vec<_>>(),
                ),
            ),
            ("friction_heat".to_owned(), ledger.friction_heat.clone()),
            (
                "contact_corrections".to_owned(),
                ledger
                    .contact
                    .iter()
                    .map(|s| f64::from(s.corrections))
                    .collect(),
            ),
            (
                "scalars".to_owned(),
                vec![self.initial_energy, self.first_dt, self.smallest_stretch],
            ),
        ];
        if let Some(limit) = &self.acoustic {
            arrays.push(("acoustic_limit".to_owned(), limit.saved().to_vec()));
        }
        if let Some(local) = &self.local {
            arrays.push(("local_steps".to_owned(), local.saved()));
        }
        if let Some(heat) = &self.heat {
            arrays.push(("heat_generated".to_owned(), heat.generated.clone()));
            arrays.push(("heat_supplied".to_owned(), heat.supplied.clone()));
        }
        for (k, material) in self.materials.iter().enumerate() {
            arrays.push((
                format!("history_{k}"),
                material.visit_ref(&mut WriteHistory),
            ));
        }
        Saved {
            time: self.time,
            time_step: self.dt,
            step: self.step,
            synchronised: self.synchronised,
            arrays,
        }
    }

    /// Puts a saved state back; the run that follows has the same bits as one never interrupted.
    ///
    /// # Errors
    /// [`SolverError::ForeignState`] when an array is missing or has another length; the
    /// simulation may then be partly overwritten and must not be used.
    pub fn restore(&mut self, saved: &Saved) -> Result<(), SolverError> {
        let arrays = Arrays { saved };
        let (state, ledger, work) = (&mut self.state, &mut self.ledger, &mut self.work);
        arrays.vectors("position", &mut state.position)?;
        arrays.vectors("momentum", &mut state.momentum)?;
        arrays.scalars("jacobian", &mut state.jacobian)?;
        arrays.scalars("temperature", &mut state.temperature)?;
        arrays.tensors("deformation_gradient", &mut state.deformation_gradient)?;
        arrays.tensors("cofactor", &mut state.cofactor)?;
        arrays.tensors("scaled_stress", &mut work.scaled_stress)?;
        arrays.scalars("volumetric_stress", &mut work.volumetric_stress)?;
        arrays.scalars("plastic_work", &mut work.plastic_work)?;
        arrays.vectors("internal_force", &mut work.internal_force)?;
        arrays.vectors("dissipation", &mut work.dissipation)?;
        arrays.scalars("jacobian_dissipation", &mut work.jacobian_dissipation)?;
        arrays.vectors("momentum_before", &mut ledger.momentum_before)?;
        arrays.work("work", &mut ledger.work)?;
        arrays.work("last_work", &mut ledger.last_work)?;
        arrays.scalars("plastic_dissipation", &mut ledger.plastic_dissipation)?;
        arrays.vectors("condition_impulse", &mut ledger.condition_impulse)?;
        arrays.vectors("obstacle_displacement", &mut self.obstacles.displacement)?;
        let mut impulses = vec![Vec3::zeros(); ledger.contact.len()];
        arrays.vectors("contact_impulse", &mut impulses)?;
        let mut given = vec![Vec3::zeros(); 2 * ledger.contact.len()];
        arrays.vectors("contact_given", &mut given)?;
        for (slot, given) in ledger.contact.iter_mut().zip(given.chunks_exact(2)) {
            [slot.given.normal, slot.given.friction] = [given[0], given[1]];
        }
        arrays.scalars("friction_heat", &mut ledger.friction_heat)?;
        let corrections = arrays.get("contact_corrections", ledger.contact.len())?;
        for ((slot, impulse), count) in ledger.contact.iter_mut().zip(impulses).zip(corrections) {
            slot.impulse = impulse;
            slot.corrections = *count as u32;
            slot.cache = Default::default();
        }
        if let Some(limit) = &mut self.acoustic {
            limit.restore(arrays.get("acoustic_limit", 3)?);
        }
        if let Some(local) = &mut self.local {
            let saved = arrays.get("local_steps", local.saved_length())?;
            local.restore(&self.reference, saved);
        }
        if let Some(heat) = &mut self.heat {
            arrays.scalars("heat_generated", &mut heat.generated)?;
            arrays.scalars("heat_supplied", &mut heat.supplied)?;
        }
        let scalars = arrays.get("scalars", 3)?;
        self.smallest_stretch = scalars[2];
        self.initial_energy = scalars[0];
        self.first_dt = scalars[1];
        for (k, material) in self.materials.iter_mut().enumerate() {
            let name = format!("history_{k}");
            let found = saved.arrays.iter().find(|(n, _)| *n == name);
            let Some((_, flat)) = found else {
                return Err(SolverError::ForeignState {
                    what: format!("{name} is missing"),
                });
            };
            if !MaterialBlock::visit(material, &mut ReadHistory { flat }) {
                return Err(SolverError::ForeignState {
                    what: format!("{name} belongs to another material or resolution"),
                });
            }
        }
        self.time = saved.time;
        self.dt = saved.time_step;
        self.step = saved.step;
        self.synchronised = saved.synchronised;
        self.refresh_plastic_strain();
        Ok(())
    }
}

#[cfg(test)]
mod tests;
