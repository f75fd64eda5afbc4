use super::*;
use crate::probe::Statistic;
use crate::testing::{INTEGRATORS, QUADRATURES, impact, scheme};

fn mean_of(field: Field) -> Probe {
    Probe {
        name: format!("{field:?}"),
        kind: ProbeKind::Statistic {
            particles: vec![0, 3, 4],
            field,
            statistic: Statistic::Mean,
        },
    }
}

#[test]
fn probes_read_the_same_bits_from_the_fields_made_for_them() {
    let edge = ProbeKind::EdgeRadius {
        edge: vec![crate::EdgePart {
            particle: 2,
            arm: Vec3::new(1e-4, -2e-4, 0.0),
            weight: 1.0,
        }],
        point: Vec3::zeros(),
        axis: 2,
    };
    let mut probes = vec![Probe {
        name: "edge".into(),
        kind: edge,
    }];
    probes.extend(
        [
            Field::EquivalentPlasticStrain,
            Field::VonMisesStress,
            Field::Pressure,
            Field::Jacobian,
            Field::WaveSpeed,
            Field::Temperature,
            Field::Displacement(1),
            Field::Position(0),
            Field::Velocity(1),
        ]
        .map(mean_of),
    );
    for quadrature in QUADRATURES {
        for integrator in INTEGRATORS {
            let model = impact([5, 4, 1], scheme(quadrature, integrator));
            let mut simulation = Simulation::new(model).unwrap();
            for _ in 0..20 {
                simulation.advance_step(1.0).unwrap();
            }
            let all = simulation.particle_fields();
            for probe in &probes {
                let made = simulation.fields_for(std::slice::from_ref(probe), &[]);
                let (here, there) = (
                    simulation.probe(probe, &made),
                    simulation.probe(probe, &all),
                );
                assert_eq!(here, there, "{}", probe.name);
                assert!(here[0].is_finite(), "{}", probe.name);
                assert_eq!(
                    made.equivalent_plastic_strain,
                    all.equivalent_plastic_strain
                );
            }
        }
    }
}
