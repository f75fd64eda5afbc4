//! Fields of a stored frame by the names that people use for their parts.

use crate::StoredFrame;

/// Suffixes of the components of vectors and tensors.
const AXES: [&str; 3] = ["x", "y", "z"];

impl StoredFrame {
    /// Values for every particle of a scalar, of a component (`velocity_y`, `cauchy_stress_xy`) or of
    /// the magnitude of a vector (`velocity`), in the unit of the field; `None` if there is none.
    pub fn values(&self, name: &str) -> Option<Vec<f64>> {
        if let Some(values) = self.scalar(name) {
            return Some(values.to_vec());
        }
        if let Some(vectors) = self.vector(name) {
            return Some(vectors.iter().map(|vector| vector.norm()).collect());
        }
        let (base, suffix) = name.rsplit_once('_')?;
        if let Some(vectors) = self.vector(base) {
            let axis = AXES.iter().position(|axis| *axis == suffix)?;
            return Some(vectors.iter().map(|vector| vector[axis]).collect());
        }
        let (row, column) = component(suffix)?;
        let tensors = self.tensor(base)?;
        Some(tensors.iter().map(|tensor| tensor[(row, column)]).collect())
    }

    /// Every name that [`Self::values`] knows.
    pub fn value_names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.scalars.iter().map(|(name, _)| name.clone()).collect();
        for (name, _) in &self.vectors {
            names.push(name.clone());
            names.extend(AXES.map(|axis| format!("{name}_{axis}")));
        }
        for (name, _) in &self.tensors {
            for row in AXES {
                names.extend(AXES.map(|column| format!("{name}_{row}{column}")));
            }
        }
        names
    }
}

fn component(suffix: &str) -> Option<(usize, usize)> {
    let index = |letter: &str| AXES.iter().position(|axis| *axis == letter);
    Some((index(suffix.get(..1)?)?, index(suffix.get(1..)?)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_tensor::{Mat3, Vec3};

    fn frame() -> StoredFrame {
        StoredFrame {
            positions: vec![Vec3::zeros()],
            scalars: vec![("pressure".to_owned(), vec![-2.0])],
            vectors: vec![("velocity".to_owned(), vec![Vec3::new(3.0, 4.0, 0.0)])],
            tensors: vec![(
                "cauchy_stress".to_owned(),
                vec![Mat3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0)],
            )],
            ..StoredFrame::default()
        }
    }

    #[test]
    fn every_name_has_values_and_others_have_none() {
        let frame = frame();
        for name in frame.value_names() {
            assert_eq!(
                frame.values(&name).map(|values| values.len()),
                Some(1),
                "{name}"
            );
        }
        assert_eq!(frame.values("velocity"), Some(vec![5.0]));
        assert_eq!(frame.values("velocity_y"), Some(vec![4.0]));
        assert_eq!(frame.values("cauchy_stress_yz"), Some(vec![6.0]));
        for wrong in [
            "velocity_w",
            "cauchy_stress",
            "cauchy_stress_x",
            "heat",
            "\u{e9}_\u{e9}",
        ] {
            assert_eq!(frame.values(wrong), None, "{wrong}");
        }
    }
}
