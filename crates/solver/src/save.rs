//! The complete state as named arrays of numbers, for restart files.

use std::ops::Range;

use jstsph_contact::Exchange;
use jstsph_material::{Block, BlockReader, BlockVisitor, History, Material, MaterialBlock};
use jstsph_tensor::{Mat3, Vec3};

use crate::SolverError;
use crate::books::{ContactSlot, Work};
use crate::parallel;
use crate::simulation::Simulation;

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

/// Appends the numbers of some items.
type Append<'a> = dyn Fn(Range<usize>, &mut Vec<f64>) + Sync + 'a;

/// One array of the state, read piece by piece: a large state is not held in memory once more.
pub struct SavedArray<'a> {
    /// Name, unique in a state.
    pub name: String,
    /// Particles, points or other items.
    pub items: usize,
    /// Numbers of each item.
    pub width: usize,
    numbers: Box<Append<'a>>,
}

impl<'a> SavedArray<'a> {
    fn of<T: Sync, const N: usize>(
        name: &str,
        items: &'a [T],
        numbers: impl Fn(&T) -> [f64; N] + Sync + 'a,
    ) -> Self {
        Self {
            name: name.to_owned(),
            items: items.len(),
            width: N,
            numbers: Box::new(move |range, out| {
                out.extend(items[range].iter().flat_map(&numbers));
            }),
        }
    }

    fn by<const N: usize>(
        name: &str,
        items: usize,
        numbers: impl Fn(usize) -> [f64; N] + Sync + 'a,
    ) -> Self {
        Self {
            name: name.to_owned(),
            items,
            width: N,
            numbers: Box::new(move |range, out| out.extend(range.flat_map(&numbers))),
        }
    }

    fn scalars(name: &str, items: &'a [f64]) -> Self {
        Self::of(name, items, |value| [*value])
    }

    fn owned(name: &str, values: Vec<f64>) -> Self {
        Self {
            name: name.to_owned(),
            items: values.len(),
            width: 1,
            numbers: Box::new(move |range, out| out.extend_from_slice(&values[range])),
        }
    }

    fn vectors(name: &str, items: &'a [Vec3]) -> Self {
        Self::of(name, items, |v| [v.x, v.y, v.z])
    }

    /// Vectors that are zero when there are none.
    fn vectors_or_zero(name: &str, items: &'a [Vec3], count: usize) -> Self {
        if !items.is_empty() {
            return Self::vectors(name, items);
        }
        Self {
            name: name.to_owned(),
            items: count,
            width: 3,
            numbers: Box::new(|range, out| out.extend(range.flat_map(|_| [0.0; 3]))),
        }
    }

    fn tensors(name: &str, items: &'a [Mat3]) -> Self {
        Self::of(name, items, |m| {
            let [[a, b, c], [d, e, f], [g, h, i]]: [[f64; 3]; 3] = (*m).into();
            [a, b, c, d, e, f, g, h, i]
        })
    }

    fn work(name: &str, items: usize, work: impl Fn(usize) -> Work + Sync + 'a) -> Self {
        Self::by(name, items, move |a| {
            let w = work(a);
            [w.numerical, w.external, w.contact, w.friction]
        })
    }

    fn history(name: String, material: &'a MaterialBlock) -> Self {
        let (items, width) = material.visit_ref(&mut HistorySize);
        Self {
            name,
            items,
            width,
            numbers: Box::new(move |range, out| {
                material.visit_ref(&mut WriteHistory { range, out });
            }),
        }
    }

    /// Appends the numbers of some items, item by item.
    ///
    /// # Panics
    /// If there are not as many items.
    pub fn append_to(&self, items: Range<usize>, out: &mut Vec<f64>) {
        (self.numbers)(items, out);
    }
}

impl std::fmt::Debug for SavedArray<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {} x {}", self.name, self.items, self.width)
    }
}

struct HistorySize;

impl BlockReader for HistorySize {
    /// Points, and numbers of each.
    type Output = (usize, usize);
    fn visit<M: Material>(&mut self, block: &Block<M>) -> (usize, usize) {
        (block.committed.len(), M::History::FIELDS.len())
    }
}

struct WriteHistory<'a> {
    range: Range<usize>,
    out: &'a mut Vec<f64>,
}

impl BlockReader for WriteHistory<'_> {
    type Output = ();
    fn visit<M: Material>(&mut self, block: &Block<M>) {
        let columns = M::History::FIELDS.len();
        for history in &block.committed[self.range.clone()] {
            let start = self.out.len();
            self.out.resize(start + columns, 0.0);
            history.write(&mut self.out[start..]);
        }
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

    /// Work on each of some particles.
    fn work(
        &self,
        name: &str,
        particles: usize,
    ) -> Result<impl Fn(usize) -> Work + use<'a>, SolverError> {
        let flat = self.get(name, 4 * particles)?;
        Ok(move |a: usize| Work {
            numerical: flat[4 * a],
            external: flat[4 * a + 1],
            contact: flat[4 * a + 2],
            friction: flat[4 * a + 3],
        })
    }
}

impl Simulation {
    /// The complete state.
    #[must_use]
    pub fn save(&self) -> Saved {
        let mut saved = Saved {
            time: 0.0,
            time_step: 0.0,
            step: 0,
            synchronised: true,
            arrays: Vec::new(),
        };
        self.save_into(&mut saved);
        saved
    }

    /// [`save`](Self::save) that uses the memory of an earlier state of the same simulation.
    pub fn save_into(&self, saved: &mut Saved) {
        let arrays = self.saved_arrays();
        saved.arrays.resize_with(arrays.len(), Default::default);
        let particles = self.state.position.len();
        parallel::for_each_large(particles, &mut saved.arrays, |k, (name, values)| {
            let array = &arrays[k];
            name.clone_from(&array.name);
            values.clear();
            values.reserve_exact(array.items * array.width);
            array.append_to(0..array.items, values);
        });
        saved.time = self.time;
        saved.time_step = self.dt;
        saved.step = self.step;
        saved.synchronised = self.synchronised;
    }

    /// The arrays of [`save`](Self::save) without a copy of them.
    #[must_use]
    pub fn saved_arrays(&self) -> Vec<SavedArray<'_>> {
        let (state, ledger, work) = (&self.state, &self.ledger, &self.work);
        let particles = state.position.len();
        let parts = self.obstacles.slots();
        let slots = particles * parts;
        let slot = move |k: usize| {
            ledger
                .slot(k / parts, k % parts)
                .copied()
                .unwrap_or_default()
        };
        let scalars = [self.initial_energy, self.first_dt, self.smallest_stretch];
        let mut arrays = vec![
            SavedArray::vectors("position", &state.position),
            SavedArray::vectors("momentum", &state.momentum),
            SavedArray::scalars("jacobian", &state.jacobian),
            SavedArray::scalars("temperature", &state.temperature),
            SavedArray::tensors("deformation_gradient", &state.deformation_gradient),
            SavedArray::tensors("cofactor", &state.cofactor),
            // Re-evaluated stresses differ in the last bit where a point is on its yield surface.
            SavedArray::tensors("scaled_stress", &work.scaled_stress),
            SavedArray::scalars("volumetric_stress", &work.volumetric_stress),
            SavedArray::scalars("plastic_work", &work.plastic_work),
            // The next step does not need them, the energies (4.1) of the last one do.
            SavedArray::vectors("internal_force", &work.internal_force),
            SavedArray::vectors_or_zero("dissipation", &work.dissipation, particles),
            SavedArray::scalars("jacobian_dissipation", &work.jacobian_dissipation),
            SavedArray::vectors("momentum_before", &ledger.momentum_before),
            SavedArray::work("work", particles, |a| ledger.work(a)),
            SavedArray::work("last_work", particles, |a| ledger.last_work(a)),
            SavedArray::scalars("plastic_dissipation", &ledger.plastic_dissipation),
            SavedArray::vectors("condition_impulse", &ledger.condition_impulse),
            SavedArray::vectors("obstacle_displacement", &self.obstacles.displacement),
            SavedArray::by("contact_impulse", slots, move |k| slot(k).impulse.into()),
            SavedArray::by("contact_given", slots, move |k| {
                let Exchange { normal, friction } = slot(k).given;
                [
                    normal.x, normal.y, normal.z, friction.x, friction.y, friction.z,
                ]
            }),
            SavedArray::by("friction_heat", particles, |a| [ledger.friction_heat(a)]),
            SavedArray::by("contact_corrections", slots, move |k| {
                [f64::from(slot(k).corrections)]
            }),
            SavedArray::of("scalars", &[()], move |()| scalars),
        ];
        if let Some(limit) = &self.acoustic {
            let saved = limit.saved();
            arrays.push(SavedArray::of("acoustic_limit", &[()], move |()| saved));
        }
        if let Some(local) = &self.local {
            arrays.push(SavedArray::owned("local_steps", local.saved()));
        }
        if let Some(heat) = &self.heat {
            arrays.push(SavedArray::scalars("heat_generated", &heat.generated));
            arrays.push(SavedArray::scalars("heat_supplied", &heat.supplied));
        }
        for (k, material) in self.materials.iter().enumerate() {
            arrays.push(SavedArray::history(format!("history_{k}"), material));
        }
        arrays
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
        // Not kept by schemes without dissipation.
        let stored = arrays.get("dissipation", 3 * state.position.len())?;
        for (v, c) in work.dissipation.iter_mut().zip(stored.chunks_exact(3)) {
            *v = Vec3::new(c[0], c[1], c[2]);
        }
        arrays.scalars("jacobian_dissipation", &mut work.jacobian_dissipation)?;
        arrays.vectors("momentum_before", &mut ledger.momentum_before)?;
        arrays.scalars("plastic_dissipation", &mut ledger.plastic_dissipation)?;
        arrays.vectors("condition_impulse", &mut ledger.condition_impulse)?;
        arrays.vectors("obstacle_displacement", &mut self.obstacles.displacement)?;
        let particles = state.position.len();
        let (total, last) = (
            arrays.work("work", particles)?,
            arrays.work("last_work", particles)?,
        );
        let heat = arrays.get("friction_heat", particles)?;
        for (a, heat) in heat.iter().enumerate() {
            ledger.restore_work(a, [total(a), last(a)], *heat);
        }
        let parts = self.obstacles.slots();
        let slots = particles * parts;
        let (impulses, given) = (
            arrays.get("contact_impulse", 3 * slots)?,
            arrays.get("contact_given", 6 * slots)?,
        );
        let corrections = arrays.get("contact_corrections", slots)?;
        let vector = |flat: &[f64], k: usize| Vec3::from_column_slice(&flat[3 * k..3 * k + 3]);
        for (k, count) in corrections.iter().enumerate() {
            let slot = ContactSlot {
                impulse: vector(impulses, k),
                given: Exchange {
                    normal: vector(given, 2 * k),
                    friction: vector(given, 2 * k + 1),
                },
                corrections: *count as u32,
            };
            ledger.restore_slot((k / parts, k % parts), slot);
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
        self.work.stretch_bounds.are_fresh = false;
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
