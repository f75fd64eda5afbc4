//! What every registered hardening law is held to, on each of its examples.

use super::HardeningLaw;

pub(super) fn check<L: HardeningLaw>() {
    let examples = L::examples();
    assert!(!examples.is_empty());
    for law in examples {
        law.validate().expect("an example is valid");
        let initial = law.flow_stress(0.0).value;
        assert!(initial > 0.0, "{law:?} yields at {initial} Pa");

        // Points of no special place, so that no kink of a table lies inside the difference.
        for strain in [1e-4, 0.013, 0.0777, 0.33, 0.91, 4.7] {
            let flow = law.flow_stress(strain);
            assert!(
                flow.value >= initial && flow.slope >= 0.0,
                "{law:?} softens at {strain}"
            );
            // Truncation (h × rate)²/6 of the slope, round-off 2e-16/h of the value.
            let h = 1e-5 * strain;
            let difference =
                (law.flow_stress(strain + h).value - law.flow_stress(strain - h).value) / (2.0 * h);
            let tolerance = 1e-7 * flow.slope + 1e-15 * flow.value / h;
            assert!(
                (flow.slope - difference).abs() <= tolerance,
                "{law:?} at {strain}: slope {} is not {difference}",
                flow.slope
            );
        }
    }
}
