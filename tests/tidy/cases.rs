//! Shipped cases.

use crate::{entries, read, root};

/// Each parses, says what it is, and can be set up as it stands.
#[test]
fn every_shipped_case_is_valid_and_can_be_set_up() {
    let cases: Vec<_> = entries(&root().join("cases"))
        .into_iter()
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .collect();
    assert!(!cases.is_empty(), "no case is shipped");
    for path in cases {
        let case = jstsph_case::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(
            read(&path).starts_with('#'),
            "{} does not begin with a comment that says what it shows",
            path.display()
        );
        let particles = case.particles();
        let simulation = jstsph_solver::Simulation::new(case.model)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        assert_eq!(
            simulation.reference().position.len(),
            particles,
            "{}",
            path.display()
        );
        assert!(simulation.stable_time_step() > 0.0, "{}", path.display());
    }
}
