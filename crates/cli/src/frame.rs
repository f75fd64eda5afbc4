//! The fields of a simulation as frames show them.

use std::ops::Range;

use jstsph_output::{Frame, Values};
use jstsph_solver::{Particle, Simulation};

/// A frame, without its cells, that holds the chosen fields.
pub(crate) fn whole(simulation: &Simulation, chosen: &[&str]) -> Frame<'static> {
    let (state, fields) = (simulation.state(), simulation.fields_for(chosen));
    let mut frame = Frame::new(
        simulation.time(),
        simulation.step_count(),
        state.position.clone(),
    )
    .scalar("jacobian", state.jacobian.clone())
    .scalar("determinant", fields.determinant)
    .scalar("von_mises_stress", fields.von_mises_stress)
    .scalar("pressure", fields.pressure)
    .scalar(
        "equivalent_plastic_strain",
        fields.equivalent_plastic_strain,
    )
    .scalar("wave_speed", fields.wave_speed)
    .vector("displacement", fields.displacement)
    .vector("velocity", fields.velocity)
    .tensor("deformation_gradient", fields.deformation_gradient)
    .tensor("cauchy_stress", fields.cauchy_stress);
    if simulation.has_heat() {
        frame = frame.scalar("temperature", fields.temperature);
    }
    with_bodies(retain(frame, chosen), simulation)
}

/// The same frame, which computes its fields while they are written.
pub(crate) fn lazy<'a>(simulation: &'a Simulation, chosen: &[&str]) -> Frame<'a> {
    let state = simulation.state();
    let mut frame = Frame::new(simulation.time(), simulation.step_count(), &state.position)
        .scalar("jacobian", &state.jacobian)
        .scalar("determinant", pieces(simulation, Particle::determinant))
        .scalar(
            "von_mises_stress",
            pieces(simulation, Particle::von_mises_stress),
        )
        .scalar("pressure", pieces(simulation, Particle::pressure))
        .scalar(
            "equivalent_plastic_strain",
            pieces(simulation, Particle::equivalent_plastic_strain),
        )
        .scalar("wave_speed", pieces(simulation, Particle::wave_speed))
        .vector("displacement", pieces(simulation, Particle::displacement))
        .vector("velocity", pieces(simulation, Particle::velocity))
        .tensor(
            "deformation_gradient",
            pieces(simulation, Particle::deformation_gradient),
        )
        .tensor("cauchy_stress", pieces(simulation, Particle::cauchy_stress));
    if simulation.has_heat() {
        frame = frame.scalar("temperature", &state.temperature);
    }
    with_bodies(retain(frame, chosen), simulation)
}

fn pieces<'a, T: Clone + 'a>(
    simulation: &'a Simulation,
    value: impl Fn(&Particle<'a>) -> T + Send + Sync + 'a,
) -> Values<'a, T> {
    let count = simulation.state().position.len();
    Values::pieces(count, move |range: Range<usize>, out: &mut Vec<T>| {
        out.extend(range.map(|a| value(&simulation.particle(a))));
    })
}

fn retain<'a>(mut frame: Frame<'a>, chosen: &[&str]) -> Frame<'a> {
    frame.scalars.retain(|(name, _)| chosen.contains(&&**name));
    frame.vectors.retain(|(name, _)| chosen.contains(&&**name));
    frame.tensors.retain(|(name, _)| chosen.contains(&&**name));
    frame
}

/// Adds the number of the body, where there are several.
fn with_bodies<'a>(frame: Frame<'a>, simulation: &Simulation) -> Frame<'a> {
    let bodies = &simulation.reference().bodies;
    if bodies.len() < 2 {
        return frame;
    }
    let mut body = vec![0.0; simulation.state().position.len()];
    for (number, reference) in bodies.iter().enumerate() {
        #[expect(clippy::cast_precision_loss, reason = "a handful of bodies")]
        body[reference.particles.clone()].fill(number as f64);
    }
    frame.scalar("body", body)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_of_frame_show_the_same_bits() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../cases/taylor-bar.toml");
        let lattice = "{ per_radius = 2, layers = 21 }".to_owned();
        let overrides = [("body.bar.lattice".to_owned(), lattice)];
        let case = jstsph_case::load(path.as_ref(), &overrides).unwrap();
        let mut simulation = Simulation::new(case.model).unwrap();
        for _ in 0..30 {
            simulation.advance_step(1.0).unwrap();
        }
        let chosen = ["determinant", "pressure", "velocity", "cauchy_stress"];
        let (whole, lazy) = (whole(&simulation, &chosen), lazy(&simulation, &chosen));
        let all = 0..simulation.state().position.len();
        assert_eq!(whole.scalars.len(), 2);
        for ((name, here), (other, there)) in whole.scalars.iter().zip(&lazy.scalars) {
            assert_eq!(name, other);
            assert!(here.get(all.clone()).iter().any(|value| *value != 1.0));
            assert_eq!(here.get(all.clone()), there.get(all.clone()), "{name}");
        }
        assert_eq!(whole.vectors[0].0, lazy.vectors[0].0);
        assert_eq!(
            whole.vectors[0].1.get(3..40),
            lazy.vectors[0].1.get(3..40),
            "velocity"
        );
        assert_eq!(
            whole.tensors[0].1.get(3..40),
            lazy.tensors[0].1.get(3..40),
            "stress"
        );
        assert_eq!(whole.tensors.len(), lazy.tensors.len());
    }
}
