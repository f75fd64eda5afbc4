//! Text with the font that is compiled in.

use std::sync::LazyLock;

use tiny_skia::{Path, PathBuilder, Transform};
use ttf_parser::{Face, OutlineBuilder};

/// DejaVu Sans, from the crate `dejavu`; the bytes are part of the program.
static FACE: LazyLock<Face<'static>> = LazyLock::new(|| {
    Face::parse(dejavu::sans::regular(), 0).expect("the compiled-in font is a TrueType font")
});

/// Width of a text of the given size, in the unit of the size.
pub(crate) fn width(content: &str, size: f64) -> f64 {
    let units: f64 = content.chars().map(advance).sum();
    units * size / f64::from(FACE.units_per_em())
}

/// Outline of a text whose baseline starts at the origin, x to the right and y downward.
pub(crate) fn outline(content: &str, size: f64) -> Option<Path> {
    let mut builder = Outline {
        path: PathBuilder::new(),
        x: 0.0,
    };
    for character in content.chars() {
        if let Some(glyph) = FACE.glyph_index(character) {
            // A glyph without outline, such as a space, draws nothing.
            let _ = FACE.outline_glyph(glyph, &mut builder);
        }
        builder.x += advance(character) as f32;
    }
    let scale = size as f32 / f32::from(FACE.units_per_em());
    builder
        .path
        .finish()?
        .transform(Transform::from_scale(scale, -scale))
}

fn advance(character: char) -> f64 {
    let glyph = FACE.glyph_index(character);
    f64::from(glyph.and_then(|g| FACE.glyph_hor_advance(g)).unwrap_or(0))
}

/// Collects glyphs side by side, in font units.
struct Outline {
    path: PathBuilder,
    x: f32,
}

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + x1, y1, self.x + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path
            .cubic_to(self.x + x1, y1, self.x + x2, y2, self.x + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_equally_wide_and_text_adds_up() {
        assert_eq!(width("0000", 12.0), width("7531", 12.0));
        let together = width("ab", 10.0);
        assert!((together - width("a", 10.0) - width("b", 10.0)).abs() < 1e-12);
        assert!((width("ab", 20.0) - 2.0 * together).abs() < 1e-12);
    }

    #[test]
    fn the_outline_stands_on_the_baseline() {
        let bounds = outline("E", 100.0).unwrap().bounds();
        // Height of a capital of DejaVu Sans: 1493 of 2048 units.
        assert!((bounds.top() + 72.9).abs() < 0.1, "{bounds:?}");
        assert!(bounds.bottom().abs() < 0.1, "{bounds:?}");
        assert!(outline("  ", 10.0).is_none());
    }

    #[test]
    fn the_font_has_every_character_that_figures_use() {
        for character in "0123456789−⁰¹²³⁴⁵⁶⁷⁸⁹⁻×·µ°εσφκ".chars() {
            assert!(FACE.glyph_index(character).is_some(), "{character}");
        }
    }
}
