use super::*;
use crate::probe::{Field, Probe, ProbeKind, Statistic};
use crate::testing::{INTEGRATORS, QUADRATURES, impact, scheme};

fn reading(field: Field, a: u32) -> Probe {
    Probe {
        name: format!("{field:?}"),
        kind: ProbeKind::Statistic {
            particles: vec![a],
            field,
            statistic: Statistic::Maximum,
        },
    }
}

#[test]
fn probes_and_extremes_read_the_bits_of_the_fields() {
    for quadrature in QUADRATURES {
        for integrator in INTEGRATORS {
            let model = impact([5, 4, 1], scheme(quadrature, integrator));
            let mut simulation = Simulation::new(model).unwrap();
            for _ in 0..20 {
                simulation.advance_step(1.0).unwrap();
            }
            let all = simulation.particle_fields();
            let state = simulation.state();
            for a in [0, 3, 17] {
                let edge = ProbeKind::EdgeRadius {
                    edge: vec![crate::EdgePart {
                        particle: a,
                        arm: Vec3::new(1e-4, -2e-4, 0.0),
                        weight: 1.0,
                    }],
                    point: Vec3::zeros(),
                    axis: 2,
                };
                let edge = Probe {
                    name: "edge".into(),
                    kind: edge,
                };
                let a = a as usize;
                let mut place =
                    state.position[a] + all.deformation_gradient[a] * Vec3::new(1e-4, -2e-4, 0.0);
                place.z = 0.0;
                assert_eq!(simulation.probe(&edge), [place.norm()]);
                for (field, expected) in [
                    (
                        Field::EquivalentPlasticStrain,
                        all.equivalent_plastic_strain[a],
                    ),
                    (Field::VonMisesStress, all.von_mises_stress[a]),
                    (Field::Pressure, all.pressure[a]),
                    (Field::Jacobian, state.jacobian[a]),
                    (Field::WaveSpeed, all.wave_speed[a]),
                    (Field::Temperature, all.temperature[a]),
                    (Field::Displacement(1), all.displacement[a].y),
                    (Field::Position(0), state.position[a].x),
                    (Field::Velocity(1), all.velocity[a].y),
                ] {
                    let probe = reading(field, a as u32);
                    assert_eq!(simulation.probe(&probe), [expected], "{field:?}");
                    assert!(expected.is_finite(), "{field:?}");
                }
            }
            let strains = all.equivalent_plastic_strain.iter().copied();
            assert_eq!(
                simulation.largest_plastic_strain(),
                strains.fold(0.0, f64::max)
            );
            let (low, high) = simulation.jacobian_range();
            assert!(low < high);
            assert!(state.jacobian.contains(&low) && state.jacobian.contains(&high));
            assert!(state.jacobian.iter().all(|j| (low..=high).contains(j)));
        }
    }
}

#[test]
fn only_the_fields_asked_for_are_computed() {
    let model = impact([5, 4, 1], scheme(QUADRATURES[0], INTEGRATORS[0]));
    let simulation = Simulation::new(model).unwrap();
    let (all, some) = (
        simulation.particle_fields(),
        simulation.fields_for(&["pressure", "velocity"]),
    );
    assert_eq!((some.pressure, some.velocity), (all.pressure, all.velocity));
    assert!(some.cauchy_stress.is_empty() && some.von_mises_stress.is_empty());
    assert!(some.temperature.is_empty() && some.equivalent_plastic_strain.is_empty());
}
