//! Swinging plate: a standing shear-free wave of the unit square in plane strain.
//!
//! ```text
//!   u = U0 sin(ω t) (−sin(π X/2) cos(π Y/2), cos(π X/2) sin(π Y/2)),   ω = π c_s/√2
//! ```
//!
//! Rollers on X = 0 and Y = 0, traction-free on X = 1 and Y = 1; div u = 0 and no shear strain, so
//! that σ = 2 μ ε for every Poisson's ratio. Aguirre, Gil, Bonet & Carreño, J. Comput. Phys. 259
//! (2014), started here from its velocity because a total Lagrangian body starts undeformed.

use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

use jstsph_geometry::Dimension;
use jstsph_solver::{Integrator, Jst, Biharmonic, Laplacian, Scheme, Stabilisation, Weights};
use jstsph_tensor::{Mat3, Vec3};
use jstsph_tests::exact::{ERRORS, StandingWave};
use jstsph_tests::{Study, setup};

/// Small enough for linear elasticity: its square is far below every error asserted here.
const AMPLITUDE: f64 = 1e-6;

fn shape(x: &Vec3) -> Vec3 {
    let (x, y) = (x.x * FRAC_PI_2, x.y * FRAC_PI_2);
    Vec3::new(-x.sin() * y.cos(), x.cos() * y.sin(), 0.0)
}

fn problem(intervals: usize, poisson_ratio: f64, amplitude: f64, scheme: Scheme) -> StandingWave {
    let material = setup::rubber(poisson_ratio);
    let frequency = PI * material.wave_speeds().shear / SQRT_2;
    let shear_modulus = material.shear_modulus();
    let body = setup::block([1.0, 1.0, 0.0], [intervals, intervals, 1], Dimension::PlaneStrain);
    let speed = amplitude * frequency;
    let mut model = setup::free_body(body, material, |x| shape(x) * speed, scheme);
    setup::fix(&mut model, "left", [true, false, false]);
    setup::fix(&mut model, "bottom", [false, true, false]);
    StandingWave {
        model,
        amplitude,
        frequency,
        shape: Box::new(shape),
        stress: Box::new(move |x| {
            let strain = FRAC_PI_2 * (x.x * FRAC_PI_2).cos() * (x.y * FRAC_PI_2).cos();
            Mat3::from_diagonal(&Vec3::new(-strain, strain, 0.0)) * (2.0 * shear_modulus)
        }),
    }
}

fn study(name: &str, intervals: &[usize], poisson_ratio: f64, scheme: Scheme) -> Study {
    let title = format!("swinging plate, nu = {poisson_ratio}, {name}");
    let study = Study::over(title, &ERRORS, intervals, |n| {
        problem(n, poisson_ratio, AMPLITUDE, scheme).errors_after(0.625).row()
    });
    study.show();
    study
}

#[test]
fn measure() {
    let n = [10, 20, 40, 80];
    let jst = |laplacian| Stabilisation { jst: Some(Jst { harmonic: 0.0, biharmonic: Biharmonic::Constant(1.0 / 64.0), on_jacobian: true, laplacian }), ..Default::default() };
    let nu = 0.3;
    for alpha in [0.9, 1.0, 1.1, 1.2] {
        study(&format!("none {alpha}"), &n, nu, Scheme { stabilisation: Default::default(), ..setup::particles(alpha) });
    }
        study("upwind 0.1 .9", &n, nu, Scheme { stabilisation: Stabilisation { upwind: 0.1, ..Default::default() }, ..setup::particles(0.9) });
        study("jst cor 1.2", &n, nu, Scheme { stabilisation: jst(Laplacian::Corrected), ..setup::particles(1.2) });
        study("jst sym 1.2", &n, nu, Scheme { stabilisation: jst(Laplacian::Symmetric), ..setup::particles(1.2) });
        study("upwind+hourglass", &n, nu, Scheme { stabilisation: Stabilisation { upwind: 0.15, hourglass: 0.02, ..Default::default() }, ..setup::particles(0.9) });
        study("bonds upwind 0.1", &n, nu, Scheme { stabilisation: Stabilisation { upwind: 0.1, ..Default::default() }, ..setup::bonds(0.8) });
}
