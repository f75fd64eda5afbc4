//! Pictures as PNG.

use std::io;

use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, StrokeDash, Transform,
};

use super::canvas::{Anchor, Canvas, Colour, PAPER, Shape, Stroke};
use super::{MARK, text};

/// CSS pixels per inch.
const CSS: f32 = 96.0;
/// Pixels per CSS pixel in animations, whose files are large enough.
const MOVING_SCALE: f32 = 1.0;

/// Pixels without transparency, three bytes each.
pub(crate) struct Raster {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgb: Vec<u8>,
}

/// Renders the shapes with so many pixels per inch and encodes them.
pub(crate) fn png(canvas: &Canvas, pixels_per_inch: u16) -> io::Result<Vec<u8>> {
    let size = [canvas.width, canvas.height];
    let resolution = f32::from(pixels_per_inch);
    let Raster { width, height, rgb } = render(canvas, size, resolution / CSS)?;
    let per_metre = (resolution / 0.0254) as u32;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // Pictures are looked at more often than drawn.
    encoder.set_compression(png::Compression::High);
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    encoder.add_text_chunk("Software".to_owned(), MARK.to_owned())?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&rgb)?;
    writer.finish()?;
    Ok(bytes)
}

/// Renders a picture of an animation on a page of the given size.
pub(crate) fn moving(canvas: &Canvas, page: [f64; 2]) -> io::Result<Raster> {
    render(canvas, page, MOVING_SCALE)
}

fn render(canvas: &Canvas, page: [f64; 2], scale: f32) -> io::Result<Raster> {
    let [width, height] = page.map(|size| (size as f32 * scale) as u32);
    let mut pixels = Pixmap::new(width, height)
        .ok_or_else(|| io::Error::other(format!("a picture of {width} x {height} pixels")))?;
    pixels.fill(tiny_skia::Color::from_rgba8(
        PAPER[0], PAPER[1], PAPER[2], 255,
    ));
    for shape in &canvas.shapes {
        draw(&mut pixels, shape, Transform::from_scale(scale, scale));
    }
    // The background is opaque everywhere, so that the alpha channel tells nothing.
    let rgb = pixels
        .data()
        .chunks_exact(4)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2]])
        .collect();
    Ok(Raster { width, height, rgb })
}

fn draw(pixels: &mut Pixmap, shape: &Shape, scale: Transform) {
    match shape {
        Shape::Polygon {
            points,
            fill,
            outline,
        } => draw_path(pixels, polygon(points, true), Some(*fill), *outline, scale),
        Shape::Patch { points, fill } => {
            if let Some(path) = polygon(points, true) {
                // Without anti-aliasing a pixel belongs to exactly one of two neighbours.
                let paint = Paint {
                    anti_alias: false,
                    ..paint(*fill)
                };
                pixels.fill_path(&path, &paint, FillRule::Winding, scale, None);
            }
        }
        Shape::Polyline { points, stroke } => {
            draw_path(pixels, polygon(points, false), None, Some(*stroke), scale);
        }
        Shape::Circle {
            centre,
            radius,
            fill,
            outline,
        } => {
            let path = PathBuilder::from_circle(centre[0] as f32, centre[1] as f32, *radius as f32);
            draw_path(pixels, path, Some(*fill), *outline, scale);
        }
        Shape::Text {
            at,
            size,
            anchor,
            upward,
            content,
        } => {
            let shift = text::width(content, *size)
                * match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => -0.5,
                    Anchor::End => -1.0,
                };
            let turn = if *upward { -90.0 } else { 0.0 };
            let place = Transform::from_translate(shift as f32, 0.0)
                .post_rotate(turn)
                .post_translate(at[0] as f32, at[1] as f32);
            let path = text::outline(content, *size).and_then(|path| path.transform(place));
            draw_path(pixels, path, Some(super::canvas::INK), None, scale);
        }
    }
}

/// The path through the points; none if they do not span anything.
fn polygon(points: &[[f64; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (i, point) in points.iter().enumerate() {
        let (x, y) = (point[0] as f32, point[1] as f32);
        if i == 0 {
            builder.move_to(x, y);
        } else {
            builder.line_to(x, y);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn draw_path(
    pixels: &mut Pixmap,
    path: Option<Path>,
    fill: Option<Colour>,
    outline: Option<Stroke>,
    scale: Transform,
) {
    let Some(path) = path else { return };
    if let Some(colour) = fill {
        pixels.fill_path(&path, &paint(colour), FillRule::Winding, scale, None);
    }
    if let Some(stroke) = outline {
        let width = stroke.width as f32;
        let style = tiny_skia::Stroke {
            width,
            line_cap: LineCap::Butt,
            line_join: LineJoin::Round,
            dash: dash(stroke),
            ..tiny_skia::Stroke::default()
        };
        pixels.stroke_path(&path, &paint(stroke.colour), &style, scale, None);
    }
}

fn dash(stroke: Stroke) -> Option<StrokeDash> {
    let lengths = stroke.dash.pattern().iter();
    let lengths: Vec<f32> = lengths
        .map(|length| (length * stroke.width) as f32)
        .collect();
    // None for an empty list.
    StrokeDash::new(lengths, 0.0)
}

fn paint(colour: Colour) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(colour[0], colour[1], colour[2], 255);
    paint.anti_alias = true;
    paint
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_land_where_they_belong() {
        let mut canvas = Canvas::new(20.0, 10.0);
        canvas.circle([5.0, 5.0], 3.0, [200, 10, 20], None);
        canvas.text([19.0, 9.0], 8.0, Anchor::End, "I");
        let bytes = png(&canvas, 192).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&bytes))
            .read_info()
            .unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        assert_eq!((info.width, info.height), (40, 20));
        assert_eq!(reader.info().pixel_dims.map(|dims| dims.xppu), Some(7559));
        let pixel = |x: usize, y: usize| &data[3 * (40 * y + x)..][..3];
        assert_eq!(pixel(10, 10), [200, 10, 20]);
        assert_eq!(pixel(18, 10), [255, 255, 255]);
        // The stem of the letter is the only dark place on the right half.
        let dark: Vec<usize> = (20..40).filter(|&x| pixel(x, 14)[0] < 128).collect();
        assert!((1..=3).contains(&dark.len()) && dark[0] > 33, "{dark:?}");
        let head = &bytes[..bytes.len().min(1024)];
        assert!(head.windows(MARK.len()).any(|w| w == MARK.as_bytes()));
    }
}
