//! A valid case and a way to make mistakes in it.
#![expect(unreachable_pub, reason = "shared by several test programs")]

use jstsph_case::{CaseError, parse};

/// A valid case; mistakes are made by replacing one piece of it. Line numbers count in this text.
pub const GOOD: &str = r#"title = "billet"
dimension = "plane-strain"
[time]
end = "45 ms"
cfl = 0.3
[[body]]
name = "billet"
shape = { box = { min = ["0 mm", "1 mm"], max = ["8 mm", "57 mm"] } }
lattice = { counts = [8, 50] }
material = "al"
[material.al.hencky_von_mises]
density = "2800 kg/m^3"
young_modulus = "69 GPa"
poisson_ratio = 0.33
hardening = { swift = { coefficient = "159 MPa", offset = 0.02, exponent = 0.27 } }
[[boundary]]
where = "billet.top"
velocity = { y = "-1 m/s" }
[[obstacle]]
name = "floor"
plane = { point = [0, 0], normal = [0, 1] }
[[probe]]
name = "length"
extent = { where = "billet", axis = "y" }
"#;

/// The message for a mistake.
pub fn message(from: &str, to: &str) -> String {
    assert!(
        GOOD.matches(from).count() == 1,
        "`{from}` must stand exactly once in the good case"
    );
    match parse("c", "c.toml", &GOOD.replace(from, to), &[]) {
        Err(error @ CaseError::Input(_)) => error.to_string(),
        Err(other) => panic!("another error: {other}"),
        Ok(_) => panic!("`{to}` was accepted"),
    }
}

/// Asserts that the message for a mistake has these pieces.
#[track_caller]
pub fn expect(from: &str, to: &str, pieces: &[&str]) {
    let message = message(from, to);
    for piece in pieces {
        assert!(message.contains(piece), "`{piece}` is not in:\n{message}");
    }
}
