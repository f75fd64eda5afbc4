//! The last words of a run, and numbers for people.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use jstsph_output::{Status, Summary};

/// Balance beyond which a run deserves a word, as a fraction of the largest energy.
const BALANCE_TO_MENTION: f64 = 0.01;

/// A time with a unit that makes it readable.
pub(crate) fn seconds(time: f64) -> String {
    let (scale, unit) = match time.abs() {
        t if t == 0.0 || t >= 1.0 => (1.0, "s"),
        t if t >= 1e-3 => (1e3, "ms"),
        t if t >= 1e-6 => (1e6, "us"),
        _ => (1e9, "ns"),
    };
    format!("{:.4} {unit}", time * scale)
}

/// A wall-clock duration.
pub(crate) fn duration(wall: f64) -> String {
    if wall < 60.0 {
        return format!("{wall:.1} s");
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "rounded and positive"
    )]
    let whole = wall.round() as u64;
    let (hours, minutes, rest) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 {
        format!("{hours} h {minutes:02} min")
    } else {
        format!("{minutes} min {rest:02} s")
    }
}

/// What came out, what looks wrong, and what to do next.
pub(crate) fn verdict(
    summary: &Summary,
    columns: &[String],
    folder: &Path,
    pictures: &[PathBuf],
) -> String {
    let mut text = String::new();
    let status = match summary.status {
        Status::Completed => "completed",
        Status::Failed => "failed at",
        Status::Interrupted => "interrupted at",
    };
    let _ = writeln!(
        text,
        "{}: {status} {} after {} steps, {} ({:.3e} particle steps per second)",
        summary.case,
        seconds(summary.simulated_time),
        summary.steps,
        duration(summary.wall_seconds),
        summary.particle_steps_per_second
    );
    let energies = &summary.energies;
    let _ = writeln!(
        text,
        "  energy balance      {:+.4} % of the largest energy",
        100.0 * energies.balance
    );
    let _ = writeln!(
        text,
        "  energies, J         kinetic {:.4e}, elastic {:.4e}, plastic {:.4e}, numerical {:.4e}, hourglass {:.4e}, friction {:.4e}",
        energies.kinetic,
        energies.elastic,
        energies.plastic,
        energies.numerical,
        energies.hourglass,
        energies.friction
    );
    let extremes = &summary.extremes;
    let _ = writeln!(
        text,
        "  extremes            plastic strain up to {:.4}, J from {:.4} to {:.4}, inverted cells {}",
        extremes.equivalent_plastic_strain,
        extremes.jacobian_min,
        extremes.jacobian_max,
        summary.inverted_cells
    );
    let mut missing = 0;
    for column in columns {
        match summary.probes.get(column) {
            Some(value) if value.is_nan() => missing += 1,
            Some(value) => {
                let _ = writeln!(text, "  {column:<18}  {value:.6e}");
            }
            None => {}
        }
    }
    if missing > 0 {
        let _ = writeln!(
            text,
            "  {missing} probe values are missing: no particle is near their points"
        );
    }
    for warning in &summary.warnings {
        let _ = writeln!(text, "  warning: {warning}");
    }
    let frames = folder.join("frames").join("frames.pvd");
    let _ = writeln!(
        text,
        "  results in {}; open {} in ParaView",
        folder.display(),
        frames.display()
    );
    if !pictures.is_empty() {
        let names: Vec<String> = pictures
            .iter()
            .filter_map(|path| path.file_name())
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        let _ = writeln!(text, "  pictures in it: {}", names.join(", "));
    }
    let folder = folder.display().to_string();
    // As it can be pasted into a shell.
    let folder = if folder.contains(char::is_whitespace) {
        format!("'{folder}'")
    } else {
        folder
    };
    let _ = writeln!(
        text,
        "  next: jstsph report {folder}   (one page with curves and a view to turn and play)\n        \
         jstsph plot {folder} --field von_mises_stress --time first,last"
    );
    text
}

/// What in the numbers of a finished run the user should know.
pub(crate) fn warnings(summary: &Summary, corrections: u64) -> Vec<String> {
    let mut found = Vec::new();
    if summary.energies.balance.abs() > BALANCE_TO_MENTION {
        found.push(format!(
            "the energy balance is off by {:+.2} % of the largest energy; reduce time.cfl",
            100.0 * summary.energies.balance
        ));
    }
    if summary.inverted_cells > 0 {
        found.push(format!(
            "{} lattice cells are turned inside out: the deformation is not resolved there",
            summary.inverted_cells
        ));
    }
    if corrections > 0 {
        found.push(format!(
            "particles were put back onto an obstacle {corrections} times"
        ));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_shown_in_readable_units() {
        assert_eq!(seconds(80e-6), "80.0000 us");
        assert_eq!(seconds(0.0), "0.0000 s");
        assert_eq!(seconds(45e-3), "45.0000 ms");
        assert_eq!(seconds(5e-9), "5.0000 ns");
        assert_eq!(duration(12.34), "12.3 s");
        assert_eq!(duration(75.0), "1 min 15 s");
        assert_eq!(duration(7325.0), "2 h 02 min");
    }
}
