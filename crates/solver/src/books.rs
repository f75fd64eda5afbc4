//! The books kept beside the unknowns: impulses and work by cause. They never act back on the unknowns.

use std::ops::{Add, Mul};

use jstsph_contact::{CachedGap, Exchange};
use jstsph_tensor::Vec3;

use crate::constraint::{Obstacles, Prescribed};
use crate::leapfrog::Kick;
use crate::parallel::CHUNK;
use crate::reference::Reference;
use crate::state::Workspace;

/// Momentum changes of one particle within a step, per unit reference volume, by cause.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Impulse {
    pub(crate) numerical: Vec3,
    pub(crate) external: Vec3,
    /// Of the contact law.
    pub(crate) contact: Vec3,
    /// Of friction.
    pub(crate) friction: Vec3,
    /// Work of the friction impulses at the velocities of their walls, J/m³.
    pub(crate) friction_at_walls: f64,
}

/// Work done on one particle per unit reference volume, J/m³, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Work {
    pub(crate) numerical: f64,
    pub(crate) external: f64,
    /// Of the contact law, and of friction at the velocity of the wall.
    pub(crate) contact: f64,
    /// Dissipated by friction: positive when energy is lost.
    pub(crate) friction: f64,
}

impl Add for Work {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            numerical: self.numerical + other.numerical,
            external: self.external + other.external,
            contact: self.contact + other.contact,
            friction: self.friction + other.friction,
        }
    }
}

impl Mul<f64> for Work {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self {
            numerical: self.numerical * factor,
            external: self.external * factor,
            contact: self.contact * factor,
            friction: self.friction * factor,
        }
    }
}

/// Work of one cause on one particle, J/m³.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Account {
    /// Up to the time of the positions.
    pub(crate) total: f64,
    /// Of the last kick (leapfrog), half of which is in `total`.
    pub(crate) last: f64,
}

impl Account {
    /// Books the work of a kick.
    #[inline]
    pub(crate) fn kick(&mut self, kick: Kick, done: f64) {
        match kick {
            // Half of twice the work is booked with the next kick: all of it by then.
            Kick::Opening => self.last = done + done,
            Kick::Full => {
                self.total = self.total + 0.5 * self.last + 0.5 * done;
                self.last = done;
            }
            Kick::Closing => {
                self.total = self.total + 0.5 * self.last + done;
                self.last = 0.0;
            }
        }
    }
}

/// What one particle has to do with one part of one obstacle that it has met.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ContactSlot {
    /// Impulse on the particle so far, N s.
    pub(crate) impulse: Vec3,
    /// Impulses on the particle in the last kick (leapfrog) or step (TVD-RK2), per unit reference
    /// volume.
    pub(crate) given: Exchange,
    /// How often the particle was put back onto the surface.
    pub(crate) corrections: u32,
}

/// What obstacles do to the particles of a page of which some have met one.
#[derive(Clone, Debug)]
pub(crate) struct Met {
    /// Particle by particle, one per obstacle part.
    pub(crate) slots: Vec<ContactSlot>,
    pub(crate) contact: Vec<Account>,
    pub(crate) friction: Vec<Account>,
    /// Energy that friction has taken from each particle in the last kick (leapfrog) or step
    /// (TVD-RK2), J per m³ of reference volume: what a heat source would be made of. The sum over
    /// all kicks is the friction energy of the balance.
    pub(crate) friction_heat: Vec<f64>,
}

impl Met {
    fn new(parts: usize) -> Box<Self> {
        Box::new(Self {
            slots: vec![ContactSlot::default(); CHUNK * parts],
            contact: vec![Account::default(); CHUNK],
            friction: vec![Account::default(); CHUNK],
            friction_heat: vec![0.0; CHUNK],
        })
    }
}

/// A particle that a condition holds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held {
    /// Its place in the page.
    pub(crate) place: u32,
    pub(crate) condition: u32,
    /// Change of its momentum in the last kick, not multiplied with anything.
    pub(crate) change: Vec3,
}

/// The books of [`CHUNK`] particles: only for causes that there are.
#[derive(Clone, Debug)]
pub(crate) struct Page {
    /// Particle by particle, then condition by condition.
    pub(crate) held: Vec<Held>,
    /// Work of dissipation; empty without it.
    pub(crate) numerical: Vec<Account>,
    /// Work of loads and prescribed velocities; empty where there are none.
    pub(crate) external: Vec<Account>,
    /// Distances computed last, particle by particle, one per obstacle part, to skip particles that cannot
    /// have reached the wall since.
    pub(crate) gaps: Vec<CachedGap>,
    /// From when the first of its particles meets an obstacle.
    pub(crate) met: Option<Box<Met>>,
}

impl Page {
    /// The books of obstacles, opened if they are not.
    #[inline]
    pub(crate) fn opened(met: &mut Option<Box<Met>>, parts: usize) -> &mut Met {
        met.get_or_insert_with(|| Met::new(parts))
    }

    /// Whether anything is booked.
    #[inline]
    pub(crate) fn has_accounts(&self) -> bool {
        !self.numerical.is_empty() || !self.external.is_empty() || self.met.is_some()
    }

    /// Books the work of an impulse on a particle at its mean velocity.
    #[inline]
    pub(crate) fn book(&mut self, kick: Kick, place: usize, impulse: &Impulse, velocity: &Vec3) {
        if let Some(account) = self.numerical.get_mut(place) {
            account.kick(kick, impulse.numerical.dot(velocity));
        }
        if let Some(account) = self.external.get_mut(place) {
            account.kick(kick, impulse.external.dot(velocity));
        }
        if let Some(met) = &mut self.met {
            let [contact, friction] = of_walls(impulse, velocity);
            met.contact[place].kick(kick, contact);
            met.friction[place].kick(kick, friction);
            met.friction_heat[place] = friction;
        }
    }

    /// Books the work of a whole step.
    #[inline]
    pub(crate) fn book_step(&mut self, place: usize, impulse: &Impulse, velocity: &Vec3) {
        if let Some(account) = self.numerical.get_mut(place) {
            account.total += impulse.numerical.dot(velocity);
        }
        if let Some(account) = self.external.get_mut(place) {
            account.total += impulse.external.dot(velocity);
        }
        if let Some(met) = &mut self.met {
            let [contact, friction] = of_walls(impulse, velocity);
            met.contact[place].total += contact;
            met.friction[place].total += friction;
            met.friction_heat[place] = friction;
        }
    }
}

/// Work of the contact law and energy dissipated by friction.
fn of_walls(impulse: &Impulse, velocity: &Vec3) -> [f64; 2] {
    [
        impulse.contact.dot(velocity) + impulse.friction_at_walls,
        impulse.friction_at_walls - impulse.friction.dot(velocity),
    ]
}

/// Books of a simulation: what was done by whom.
#[derive(Clone, Debug)]
pub(crate) struct Ledger {
    /// Momentum before the last kick (leapfrog), for quantities at the time of the positions.
    pub(crate) momentum_before: Vec<Vec3>,
    /// Impulses of the step under way; empty for the leapfrog, which books them at once.
    pub(crate) impulse: Vec<Impulse>,
    /// Books of the particles.
    pub(crate) pages: Vec<Page>,
    /// Obstacle parts.
    parts: usize,
    /// Plastic dissipation of the points so far, J/m³.
    pub(crate) plastic_dissipation: Vec<f64>,
    /// Impulse of each condition on its particles so far, N s.
    pub(crate) condition_impulse: Vec<Vec3>,
}

impl Ledger {
    /// Opens the books. Those of obstacles are opened, too, where particles are near one; elsewhere when
    /// the first of a page meets one.
    pub(crate) fn new(
        reference: &Reference,
        momentum: &[Vec3],
        (prescribed, obstacles): (&Prescribed, &Obstacles),
        has_impulses: bool,
    ) -> Self {
        let particles = reference.position.len();
        let parts = obstacles.slots();
        let page = |first: usize| Page {
            held: Vec::new(),
            numerical: Vec::new(),
            external: Vec::new(),
            gaps: vec![CachedGap::UNKNOWN; CHUNK.min(particles - first) * parts],
            met: None,
        };
        let mut pages: Vec<Page> = (0..particles).step_by(CHUNK).map(page).collect();
        for (a, condition) in prescribed.held(reference) {
            pages[a / CHUNK].held.push(Held {
                place: (a % CHUNK) as u32,
                condition: condition as u32,
                change: Vec3::zeros(),
            });
        }
        for page in &mut pages {
            page.held.sort_by_key(|held| (held.place, held.condition));
            if !page.held.is_empty() {
                page.external = vec![Account::default(); CHUNK];
            }
        }
        for a in 0..particles {
            let page = &mut pages[a / CHUNK];
            if page.met.is_none() && obstacles.is_near(reference, a) {
                Page::opened(&mut page.met, parts);
            }
        }
        let impulses = if has_impulses { particles } else { 0 };
        Self {
            momentum_before: momentum.to_vec(),
            impulse: vec![Impulse::default(); impulses],
            pages,
            parts,
            plastic_dissipation: vec![0.0; reference.point_volume.len()],
            condition_impulse: vec![Vec3::zeros(); prescribed.len()],
        }
    }

    /// Opens the accounts of the causes that a workspace has room for.
    pub(crate) fn open_accounts(&mut self, work: &Workspace, on_jacobian: bool) {
        let accounts = || vec![Account::default(); CHUNK];
        for page in &mut self.pages {
            if on_jacobian || !work.dissipation.is_empty() {
                page.numerical = accounts();
            }
            if !work.external_force.is_empty() {
                page.external = accounts();
            }
        }
    }

    /// Work done on a particle up to the time of the positions.
    pub(crate) fn work(&self, a: usize) -> Work {
        self.accounts(a, |account| account.total)
    }

    /// Work of the last kick (leapfrog), half of which is in [`work`](Self::work).
    pub(crate) fn last_work(&self, a: usize) -> Work {
        self.accounts(a, |account| account.last)
    }

    fn accounts(&self, a: usize, value: impl Fn(&Account) -> f64) -> Work {
        let (page, place) = (&self.pages[a / CHUNK], a % CHUNK);
        let of = |accounts: &[Account]| accounts.get(place).map_or(0.0, &value);
        let met = page.met.as_deref();
        Work {
            numerical: of(&page.numerical),
            external: of(&page.external),
            contact: met.map_or(0.0, |met| value(&met.contact[place])),
            friction: met.map_or(0.0, |met| value(&met.friction[place])),
        }
    }

    /// Energy that friction has taken from a particle in the last kick or step, J/m³.
    pub(crate) fn friction_heat(&self, a: usize) -> f64 {
        let met = self.pages[a / CHUNK].met.as_ref();
        met.map_or(0.0, |met| met.friction_heat[a % CHUNK])
    }

    /// What a particle has to do with a part of an obstacle; `None` if it has never met one.
    pub(crate) fn slot(&self, a: usize, part: usize) -> Option<&ContactSlot> {
        let met = self.pages[a / CHUNK].met.as_ref();
        met.map(|met| &met.slots[a % CHUNK * self.parts + part])
    }

    /// All slots that there are.
    pub(crate) fn slots(&self) -> impl Iterator<Item = &ContactSlot> {
        let met = self.pages.iter().filter_map(|page| page.met.as_ref());
        met.flat_map(|met| &met.slots)
    }

    /// Adds up the impulses of the conditions on the particles for which `chosen(a)` holds.
    pub(crate) fn add_up_conditions(
        &mut self,
        reference: &Reference,
        chosen: impl Fn(usize) -> bool,
    ) {
        for (k, total) in self.condition_impulse.iter_mut().enumerate() {
            let mut sum = Vec3::zeros();
            for (number, page) in self.pages.iter().enumerate() {
                let of_condition = |held: &&Held| held.condition as usize == k;
                for held in page.held.iter().filter(of_condition) {
                    let a = number * CHUNK + held.place as usize;
                    if chosen(a) {
                        sum += held.change * reference.volume[a];
                    }
                }
            }
            *total += sum;
        }
    }

    // Restart.

    /// Puts back what was saved of a particle: work up to now and of the last kick, friction heat.
    pub(crate) fn restore_work(&mut self, a: usize, [total, last]: [Work; 2], heat: f64) {
        let (page, place) = (&mut self.pages[a / CHUNK], a % CHUNK);
        let account = |total: f64, last: f64| Account { total, last };
        if let Some(numerical) = page.numerical.get_mut(place) {
            *numerical = account(total.numerical, last.numerical);
        }
        if let Some(external) = page.external.get_mut(place) {
            *external = account(total.external, last.external);
        }
        let (contact, friction) = (
            account(total.contact, last.contact),
            account(total.friction, last.friction),
        );
        let nothing = Account::default();
        if page.met.is_some() || contact != nothing || friction != nothing || heat != 0.0 {
            let met = Page::opened(&mut page.met, self.parts);
            met.contact[place] = contact;
            met.friction[place] = friction;
            met.friction_heat[place] = heat;
        }
    }

    /// Puts back a slot, and forgets the gap.
    pub(crate) fn restore_slot(&mut self, (a, part): (usize, usize), slot: ContactSlot) {
        let (page, place) = (&mut self.pages[a / CHUNK], a % CHUNK);
        let k = place * self.parts + part;
        page.gaps[k] = CachedGap::UNKNOWN;
        let ContactSlot {
            impulse,
            given,
            corrections,
        } = slot;
        let is_new = impulse == Vec3::zeros() && given == Exchange::default() && corrections == 0;
        if page.met.is_some() || !is_new {
            Page::opened(&mut page.met, self.parts).slots[k] = slot;
        }
    }
}
