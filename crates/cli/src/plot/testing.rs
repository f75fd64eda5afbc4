//! The case of the tests of plots.

use jstsph_case::Case;

const BLOCK: &str = r#"
dimension = "plane-strain"
[time]
end = 1e-3
[[body]]
name = "block"
shape = { box = { min = [0, 0], max = [0.004, 0.006] } }
lattice = { counts = [5, 7] }
material = "copper_taylor"
"#;

/// A copper block of 4 mm by 6 mm, with more tables.
pub(super) fn block(more: &str) -> Case {
    jstsph_case::parse("b", "b.toml", &format!("{BLOCK}{more}"), &[]).expect("a case")
}
