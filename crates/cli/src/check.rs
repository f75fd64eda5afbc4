//! `jstsph check`.

use std::fmt::Write as _;
use std::time::{Duration, Instant};

use jstsph_case::Case;
use jstsph_contact::Law;
use jstsph_solver::{ModelObstacle, Quadrature, Simulation};

use crate::arguments::CheckOptions;
use crate::console::Console;
use crate::error::CliError;
use crate::plot;
use crate::recorder::extra_columns;
use crate::simulate;
use crate::stability::Stability;
use crate::verdict::{duration, seconds};

/// Time spent on measuring the speed.
const TRIAL: Duration = Duration::from_millis(500);

/// Defect of summation by parts, in faces, above which the boundary correction is worth a word: ten times
/// what boxes have with the default smoothing length and the widest that is usual.
const WORTH_CORRECTING: f64 = 0.05;

/// Validates a case and says what would run.
pub(crate) fn run(options: &CheckOptions, console: &mut Console<'_>) -> Result<u8, CliError> {
    let case = jstsph_case::load(&options.case, &options.overrides)?;
    extra_columns(&case)?;
    if let Some(path) = &options.draw {
        plot::before_run(&case, options.view, path)?;
    }
    let (pool, threads) = simulate::pool(&case, options.threads)?;
    let text = pool.install(|| {
        let simulation =
            Simulation::new(case.model.clone()).map_err(|error| case.setup_error(&error))?;
        Ok::<_, CliError>(if options.resolved {
            case.resolved.clone()
        } else {
            describe(&case, simulation, threads)
        })
    })?;
    console.print(text);
    if let Some(path) = options.draw.as_ref().filter(|_| !options.resolved) {
        console.print(format_args!("wrote {}\n", path.display()));
    }
    Ok(0)
}

/// What an obstacle does to particles, in the words of case files.
fn contact(obstacle: &ModelObstacle) -> String {
    let mut words = match obstacle.obstacle.law {
        Law::Inelastic { restitution: 0.0 } => "inelastic".to_owned(),
        Law::Inelastic { restitution } => format!("inelastic, restitution {restitution}"),
        Law::Reflection => "reflection".to_owned(),
    };
    match obstacle.obstacle.friction.coefficient {
        0.0 => words += ", frictionless",
        coefficient => words += &format!(", friction {coefficient}"),
    }
    if obstacle.velocity.is_some() {
        words += ", moving";
    }
    words
}

#[expect(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
fn describe(case: &Case, mut simulation: Simulation, threads: usize) -> String {
    let reference = simulation.reference();
    let mut text = format!("{}: {}\n", case.name, case.title);
    for (index, (body, input)) in reference.bodies.iter().zip(&case.model.bodies).enumerate() {
        let neighbours = body.gradient.entry_count() as f64 / body.gradient.points().max(1) as f64;
        let _ = writeln!(
            text,
            "  body {:<14} {} particles, {} evaluation points at the {}, {neighbours:.1} neighbours, spacing {:.4e} m, {} ({:.0} m/s)",
            body.name,
            body.particles.len(),
            body.points.len(),
            if case.model.scheme.quadrature == Quadrature::Bonds {
                "bonds"
            } else {
                "particles"
            },
            body.spacing,
            input.material.name(),
            body.wave_speed
        );
        // How far a constant stress is from giving no force inside: an error that does not converge.
        let inner = |a: usize| !input.body.boundary[a];
        let defect = reference.summation_defect(index, inner);
        let _ = write!(
            text,
            "    smoothing length {:.4e} m; summation by parts holds to {defect:.1e} of a face inside",
            body.support.smoothing_length,
        );
        let _ = match body.correction {
            Some(correction) => writeln!(
                text,
                " after {} rows of the gradient were corrected",
                correction.points
            ),
            None if defect > WORTH_CORRECTING => {
                writeln!(text, " (scheme.boundary_correction = true makes it hold)")
            }
            None => writeln!(text),
        };
    }
    for condition in &case.model.conditions {
        let _ = writeln!(
            text,
            "  condition {:<9} {} particles",
            condition.name,
            condition.particles.len()
        );
    }
    for obstacle in &case.model.obstacles {
        let _ = writeln!(
            text,
            "  obstacle {:<10} {}",
            obstacle.obstacle.name,
            contact(obstacle)
        );
    }
    let stability = Stability::new(case, &simulation);
    let step = simulation.stable_time_step();
    let steps = (case.time.end / step).ceil();
    // The first step finds the frequency of the bodies, which the others use for a while.
    let mut failure = simulation.advance_step(case.time.end).err();
    let (before, started) = (simulation.step_count(), Instant::now());
    while failure.is_none() && started.elapsed() < TRIAL && simulation.time() < case.time.end {
        failure = simulation.advance_step(case.time.end).err();
    }
    if let Some(error) = failure {
        let _ = writeln!(text, "  warning: the first steps fail: {error}");
    }
    let made = (simulation.step_count() - before).max(1) as f64;
    let each = started.elapsed().as_secs_f64() / made;
    let _ = writeln!(
        text,
        "  time               {} in about {steps:.0} steps of {}",
        seconds(case.time.end),
        seconds(step)
    );
    if let Some(stability) = &stability {
        let _ = writeln!(text, "  time step          {}", stability.description(case));
    }
    let _ = writeln!(
        text,
        "  estimate           {} or more with {threads} {} ({:.2e} s per step; compression shortens the steps)",
        duration(each * steps),
        if threads == 1 { "thread" } else { "threads" },
        each
    );
    if let Some(memory) = resident_memory() {
        let _ = writeln!(text, "  memory             {:.0} MB", memory / 1e6);
    }
    let slow = stability.and_then(|stability| stability.warning(case));
    for warning in case.warnings.iter().chain(&slow) {
        let _ = writeln!(text, "  warning: {warning}");
    }
    text
}

/// Memory of this process in bytes, where the system tells.
fn resident_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kilobytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024.0 * kilobytes)
}
