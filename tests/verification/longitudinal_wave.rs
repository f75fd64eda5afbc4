//! Longitudinal standing wave in a strip that cannot move sideways.
//!
//! ```text
//!   u_x = U0 sin(ω t) sin(π X/2),   ω = π c_p/2
//! ```
//!
//! Fixed at X = 0, traction-free at X = 1, rollers above and below: uniaxial strain, so that the
//! speed is that of pressure waves.

use std::f64::consts::FRAC_PI_2;

use jstsph_geometry::Dimension;
use jstsph_solver::Scheme;
use jstsph_tensor::{Mat3, Vec3};
use jstsph_tests::exact::{ERRORS, StandingWave};
use jstsph_tests::{Study, setup};

const AMPLITUDE: f64 = 1e-6;

fn problem(intervals: usize, scheme: Scheme) -> StandingWave {
    let material = setup::rubber(0.3);
    let speed = material.wave_speeds().pressure;
    let frequency = FRAC_PI_2 * speed;
    let p_modulus = material.density() * speed * speed;
    let lame = p_modulus - 2.0 * material.shear_modulus();
    let body = setup::block([1.0, 0.25, 0.0], [intervals, intervals / 4, 1], Dimension::PlaneStrain);
    let shape = |x: &Vec3| Vec3::new((FRAC_PI_2 * x.x).sin(), 0.0, 0.0);
    let mut model =
        setup::free_body(body, material, |x| shape(x) * (AMPLITUDE * frequency), scheme);
    setup::fix(&mut model, "left", [true, false, false]);
    setup::fix(&mut model, "bottom", [false, true, false]);
    setup::fix(&mut model, "top", [false, true, false]);
    StandingWave {
        model,
        amplitude: AMPLITUDE,
        frequency,
        shape: Box::new(shape),
        stress: Box::new(move |x| {
            let strain = FRAC_PI_2 * (FRAC_PI_2 * x.x).cos();
            Mat3::from_diagonal(&Vec3::new(p_modulus, lame, lame)) * strain
        }),
    }
}

fn study(name: &str, scheme: Scheme) -> Study {
    let title = format!("longitudinal wave, {name}");
    let study = Study::over(title, &ERRORS, &[16, 32, 64], |n| {
        problem(n, scheme).errors_after(0.625).row()
    });
    study.show();
    study
}

#[test]
#[allow(dead_code)] fn measure() {
    study("particles .9", setup::particles(0.9));
    study("particles 1.2", setup::particles(1.2));
    study("bonds 0.8", setup::bonds(0.8));
    study("bonds 1.0", setup::bonds(1.0));
}
