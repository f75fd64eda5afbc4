//! What the largest frequency of the bodies says about the time step, and the kinetic energy about
//! a slow process computed faster.

use jstsph_case::Case;
use jstsph_output::Energies;
use jstsph_solver::{Integrator, Simulation};

/// Initial speed over wave speed from which a case is an impact: a body of metal that stops from
/// this speed yields.
const IMPACT: f64 = 2e-3;

/// Kinetic over internal energy up to which a process is slow.
const SLOW: f64 = 0.05;

/// Whether the time step suits elastic vibrations.
pub(crate) struct Stability {
    /// Largest stable CFL number.
    pub(crate) limit: f64,
    is_exceeded: bool,
    is_impact: bool,
}

impl Stability {
    /// Of the undeformed bodies; `None` with an integrator that has another limit.
    pub(crate) fn new(case: &Case, simulation: &Simulation) -> Option<Self> {
        if case.model.scheme.integrator != Integrator::Leapfrog {
            return None;
        }
        let limit = simulation.elastic_cfl_limit();
        Some(Self {
            limit,
            is_exceeded: case.time.cfl > limit,
            is_impact: is_impact(case),
        })
    }

    /// A line for `check`.
    pub(crate) fn description(&self, case: &Case) -> String {
        let judged = match (self.is_exceeded, self.is_impact) {
            (false, _) => "stable",
            (true, true) => "fine for an impact that flows plastically, unstable for slow loading",
            (true, false) => "unstable",
        };
        format!(
            "elastic vibrations are stable up to time.cfl = {:.2}; it is {}: {judged}",
            self.limit, case.time.cfl
        )
    }

    /// The warning before a run; an impact, which never has one, does not pay for the limit.
    pub(crate) fn warning_before_run(case: &Case, simulation: &Simulation) -> Option<String> {
        if is_impact(case) {
            return None;
        }
        Self::new(case, simulation)?.warning(case)
    }

    /// A warning for cases that load slowly.
    pub(crate) fn warning(&self, case: &Case) -> Option<String> {
        (self.is_exceeded && !self.is_impact).then(|| {
            format!(
                "time.cfl = {} is beyond the limit of elastic vibrations, {:.2}: fine for impacts that flow plastically, \
                 unstable for slow loading; reduce time.cfl below {:.2}",
                case.time.cfl,
                self.limit,
                self.limit
            )
        })
    }
}

fn is_impact(case: &Case) -> bool {
    case.model.bodies.iter().any(|body| {
        let fastest = body.initial_velocity.iter().map(|v| v.norm());
        fastest.fold(0.0, f64::max) > IMPACT * body.material.wave_speeds().pressure
    })
}

/// A warning when a process computed faster than it is has more inertia than it may.
pub(crate) fn inertia(energies: &Energies, inertia_scale: f64) -> Option<String> {
    let ratio = energies.kinetic_to_internal();
    (inertia_scale > 1.0 && ratio > SLOW).then(|| {
        format!(
            "the kinetic energy is {:.1} % of the internal energy at the end, more than {} %: \
             inertia shapes this slow process; reduce time.rate_scale (or mass_scale)",
            100.0 * ratio,
            100.0 * SLOW
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(cfl: f64, velocity: &str) -> (Case, Simulation) {
        let text = format!(
            "dimension = \"plane-strain\"\n[time]\nend = \"1 ms\"\ncfl = {cfl}\n[[body]]\nname = \"block\"\n\
             shape = {{ box = {{ min = [0, 0], max = [\"4 mm\", \"6 mm\"] }} }}\nlattice = {{ counts = [5, 7] }}\n\
             material = \"copper_taylor\"\nvelocity = [0, \"{velocity}\"]\n"
        );
        let case = jstsph_case::parse("block", "block.toml", &text, &[]).expect("sound");
        let simulation = Simulation::new(case.model.clone()).expect("sound");
        (case, simulation)
    }

    #[test]
    fn slow_loading_beyond_the_limit_is_warned_of_and_an_impact_only_described() {
        let (case, simulation) = block(0.3, "0 m/s");
        let limit = Stability::new(&case, &simulation).expect("leapfrog").limit;
        assert!((0.4..2.0).contains(&limit), "{limit}");
        for (cfl, velocity, warns, words) in [
            (0.9 * limit, "0 m/s", false, ": stable"),
            (1.1 * limit, "0 m/s", true, ": unstable"),
            (1.1 * limit, "-1 m/s", true, ": unstable"),
            (1.1 * limit, "-150 m/s", false, "fine for an impact"),
        ] {
            let (case, simulation) = block(cfl, velocity);
            let found = Stability::new(&case, &simulation).expect("leapfrog");
            assert_eq!(found.warning(&case).is_some(), warns, "{cfl} {velocity}");
            assert!(found.description(&case).contains(words), "{cfl} {velocity}");
        }
    }

    #[test]
    fn inertia_is_mentioned_only_for_scaled_processes_with_too_much_of_it() {
        let energies = |kinetic| Energies {
            kinetic,
            elastic: 1.0,
            plastic: 9.0,
            ..Energies::default()
        };
        assert_eq!(inertia(&energies(0.4), 100.0), None);
        assert_eq!(inertia(&energies(5.0), 1.0), None);
        let text = inertia(&energies(0.8), 100.0).expect("too much");
        assert!(text.contains("8.0 % of the internal energy"), "{text}");
    }
}
