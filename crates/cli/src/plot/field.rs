//! Fields of a frame by name: values, unit, how they are shown.

use jstsph_output::StoredFrame;
use jstsph_output::plot::{ColourMap, Quantity};

use crate::error::CliError;

/// Part of the largest magnitude from which a sign counts as more than noise.
const BOTH_SIGNS: f64 = 0.02;

/// Values of a field for every particle: a scalar, a component (`velocity_y`, `cauchy_stress_xy`)
/// or the magnitude of a vector (`velocity`).
///
/// # Errors
/// [`CliError::UnknownName`] with the names there are.
pub(super) fn values(frame: &StoredFrame, name: &str) -> Result<Vec<f64>, CliError> {
    frame.values(name).ok_or_else(|| CliError::UnknownName {
        what: "field",
        name: name.to_owned(),
        allowed: frame.value_names(),
    })
}

/// Name and SI unit as shown.
pub(crate) fn quantity(frame: &StoredFrame, name: &str) -> Quantity {
    let base = name.rsplit_once('_').map_or(name, |(base, _)| base);
    let is_component = frame.vector(base).is_some() || frame.tensor(base).is_some();
    let unit = match if is_component { base } else { name } {
        "von_mises_stress" | "pressure" | "cauchy_stress" => "Pa",
        "displacement" => "m",
        "velocity" | "wave_speed" => "m/s",
        "temperature" => "K",
        _ => "",
    };
    let mut text = match name {
        "pressure" => "pressure, tension positive".to_owned(),
        "jacobian" => "volume ratio J".to_owned(),
        "determinant" => "det F".to_owned(),
        _ => name.replace('_', " "),
    };
    for (plain, proper) in [("von mises", "von Mises"), ("cauchy", "Cauchy")] {
        text = text.replace(plain, proper);
    }
    if frame.vector(name).is_some() {
        text += " magnitude";
    }
    Quantity::new(text, unit)
}

/// Colours and range for some values: symmetric about zero if both signs occur, from zero if the
/// values come near it, else their own extremes (`None`).
pub(super) fn colours(values: impl Iterator<Item = f64>) -> (ColourMap, Option<(f64, f64)>) {
    let (least, most) = values.fold((f64::MAX, f64::MIN), |(least, most), value| {
        (least.min(value), most.max(value))
    });
    let magnitude = least.abs().max(most.abs());
    if least < -BOTH_SIGNS * magnitude && most > BOTH_SIGNS * magnitude {
        return (ColourMap::CoolWarm, None);
    }
    let from_zero = least >= 0.0 && most > 0.0 && least < 0.3 * most;
    (ColourMap::Viridis, from_zero.then_some((0.0, most)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_tensor::{Mat3, Vec3};

    fn frame() -> StoredFrame {
        StoredFrame {
            positions: vec![Vec3::zeros()],
            scalars: vec![("von_mises_stress".to_owned(), vec![4e8])],
            vectors: vec![("velocity".to_owned(), vec![Vec3::new(3.0, -4.0, 0.0)])],
            tensors: vec![(
                "cauchy_stress".to_owned(),
                vec![Mat3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0)],
            )],
            ..StoredFrame::default()
        }
    }

    #[test]
    fn scalars_magnitudes_and_components_are_found() {
        let frame = frame();
        for (name, value, label, unit) in [
            ("von_mises_stress", 4e8, "von Mises stress", "Pa"),
            ("velocity", 5.0, "velocity magnitude", "m/s"),
            ("velocity_y", -4.0, "velocity y", "m/s"),
            ("cauchy_stress_xz", 3.0, "Cauchy stress xz", "Pa"),
        ] {
            assert_eq!(values(&frame, name).unwrap(), [value]);
            assert_eq!(quantity(&frame, name), Quantity::new(label, unit));
        }
    }

    #[test]
    fn every_name_in_the_message_exists() {
        let frame = frame();
        let message = values(&frame, "velocity_w").unwrap_err().to_string();
        assert!(
            message.starts_with("unknown field `velocity_w`"),
            "{message}"
        );
        assert!(message.contains("von_mises_stress, velocity, velocity_x"));
        assert!(message.contains("did you mean `velocity_x`?"), "{message}");
        for name in frame.value_names() {
            assert!(values(&frame, &name).is_ok(), "{name}");
        }
        for name in [
            "cauchy_stress",
            "cauchy_stress_x",
            "velocity_xx",
            "_",
            "é_é",
        ] {
            assert!(values(&frame, name).is_err(), "{name}");
        }
    }

    #[test]
    fn the_range_starts_at_zero_or_is_symmetric_where_that_helps() {
        let of = |values: &[f64]| colours(values.iter().copied());
        assert_eq!(of(&[0.1, 2.0]), (ColourMap::Viridis, Some((0.0, 2.0))));
        assert_eq!(of(&[1.5, 2.0]), (ColourMap::Viridis, None));
        assert_eq!(of(&[-1.0, 2.0]), (ColourMap::CoolWarm, None));
        assert_eq!(of(&[-1e-9, 2.0]).0, ColourMap::Viridis);
    }
}
