//! Particles coloured by the group they belong to, and the names of the groups.

use super::axis::{HALF_HEIGHT, TICK_SIZE};
use super::canvas::{Anchor, Canvas, Colour, INK, Rect, STEEL, Stroke, mix};
use super::{lines, text};

/// Height of a row of the legend.
const ROW: f64 = 22.0;
/// Length of a key.
const KEY: f64 = 20.0;
/// Colour of the first group: what is not singled out.
const PLAIN: Colour = [190, 197, 206];

/// A row of the legend of groups.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// Its name.
    pub label: String,
    /// Whether it stands for lines of obstacles, not for particles.
    pub is_wall: bool,
}

/// Colour of the particles whose value is the number of their group.
pub(super) fn colour(value: f64) -> Colour {
    match value.max(0.0) as usize {
        0 => PLAIN,
        number => lines::colour(number - 1),
    }
}

/// Space right of the plot.
pub(super) fn space(groups: &[Group]) -> f64 {
    let widths = groups
        .iter()
        .map(|group| text::width(&group.label, TICK_SIZE));
    KEY + 8.0 + widths.fold(0.0, f64::max)
}

/// Draws the names beside the plot, in the middle of its height.
pub(super) fn draw(canvas: &mut Canvas, groups: &[Group], left: f64, frame: &Rect) {
    let top = 0.5 * (frame.top + frame.bottom - ROW * groups.len() as f64);
    for (number, group) in groups.iter().enumerate() {
        let y = top.max(frame.top) + ROW * (number as f64 + 0.5);
        if group.is_wall {
            canvas.line([left, y], [left + KEY, y], Stroke::solid(STEEL, 2.0));
        } else {
            let fill = colour(number as f64);
            let rim = Stroke::solid(mix(fill, INK, 0.45), 0.8);
            canvas.circle([left + 0.5 * KEY, y], 5.5, fill, Some(rim));
        }
        let at = [left + KEY + 8.0, y + HALF_HEIGHT * TICK_SIZE];
        canvas.text(at, TICK_SIZE, Anchor::Start, &group.label);
    }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Shape;
    use super::super::{ParticlePlot, particles};
    use super::*;
    use jstsph_tensor::Vec3;

    #[test]
    fn groups_have_their_colours_and_names_instead_of_a_colour_bar() {
        let positions = [Vec3::zeros(), Vec3::x(), Vec3::y()];
        let group = |label: &str, is_wall| Group {
            label: label.to_owned(),
            is_wall,
        };
        let groups = [
            group("body", false),
            group("clamp", false),
            group("die", true),
        ];
        let plot = ParticlePlot {
            groups: &groups,
            ..ParticlePlot::new(&positions, &[0.0, 1.0, 0.0], "group", "", 0.5)
        };
        let canvas = particles::draw("", 1, &[plot]).unwrap();
        let of = |wanted: Colour| {
            let shapes = canvas.shapes.iter();
            shapes
                .filter(|shape| matches!(shape, Shape::Circle { fill, .. } if *fill == wanted))
                .count()
        };
        // Two particles and a key; one particle and a key.
        assert_eq!((of(PLAIN), of(lines::colour(0))), (3, 2));
        let texts = canvas.shapes.iter().filter_map(|shape| match shape {
            Shape::Text { content, .. } => Some(content.as_str()),
            _ => None,
        });
        let texts: Vec<&str> = texts.collect();
        assert!(
            groups
                .iter()
                .all(|group| texts.contains(&group.label.as_str()))
        );
        assert!(!texts.contains(&"group"));
    }
}
