//! Pictures as SVG.

use std::fmt::Write;

use super::MARK;
use super::canvas::{Anchor, Canvas, Colour, INK, PAPER, Shape, Stroke};
use crate::vtu::escape_xml;

/// The picture as a self-contained SVG document.
pub(crate) fn svg(canvas: &Canvas) -> String {
    let (width, height) = (number(canvas.width), number(canvas.height));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" \
         font-family=\"DejaVu Sans, Verdana, sans-serif\" fill=\"{}\">\n<!-- {MARK} -->\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>\n",
        hex(INK),
        hex(PAPER),
    );
    for shape in &canvas.shapes {
        // Writing to a string cannot fail.
        let _ = draw(&mut svg, shape);
    }
    svg.push_str("</svg>\n");
    svg
}

fn draw(svg: &mut String, shape: &Shape) -> std::fmt::Result {
    match shape {
        Shape::Polygon {
            points,
            fill,
            outline,
        } => {
            let fill = hex(*fill);
            write!(svg, "<path d=\"{}Z\" fill=\"{fill}\"", path(points))?;
            write_outline(svg, *outline)
        }
        Shape::Patch { points, fill } => {
            // The stroke hides the seams that viewers leave between neighbours.
            let fill = hex(*fill);
            writeln!(
                svg,
                "<path d=\"{}Z\" fill=\"{fill}\" stroke=\"{fill}\" stroke-width=\"0.4\"/>",
                path(points)
            )
        }
        Shape::Polyline { points, stroke } => {
            write!(svg, "<path d=\"{}\" fill=\"none\"", path(points))?;
            write_outline(svg, Some(*stroke))
        }
        Shape::Circle {
            centre: [x, y],
            radius,
            fill,
            outline,
        } => {
            let [x, y, r] = [*x, *y, *radius].map(number);
            let fill = hex(*fill);
            write!(
                svg,
                "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\""
            )?;
            write_outline(svg, *outline)
        }
        Shape::Text {
            at: [x, y],
            size,
            anchor,
            upward,
            content,
        } => {
            let [x, y, size] = [*x, *y, *size].map(number);
            write!(svg, "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"")?;
            match anchor {
                Anchor::Start => {}
                Anchor::Middle => write!(svg, " text-anchor=\"middle\"")?,
                Anchor::End => write!(svg, " text-anchor=\"end\"")?,
            }
            if *upward {
                write!(svg, " transform=\"rotate(-90 {x} {y})\"")?;
            }
            writeln!(svg, ">{}</text>", escape_xml(content))
        }
    }
}

fn write_outline(svg: &mut String, outline: Option<Stroke>) -> std::fmt::Result {
    if let Some(stroke) = outline {
        let width = number(stroke.width);
        let colour = hex(stroke.colour);
        write!(
            svg,
            " stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\""
        )?;
        let lengths = stroke.dash.pattern().iter();
        let lengths: Vec<String> = lengths.map(|l| number(l * stroke.width)).collect();
        if !lengths.is_empty() {
            write!(svg, " stroke-dasharray=\"{}\"", lengths.join(" "))?;
        }
    }
    svg.push_str("/>\n");
    Ok(())
}

fn path(points: &[[f64; 2]]) -> String {
    let mut path = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        path.push(if i == 0 { 'M' } else { 'L' });
        path.push_str(&number(*x));
        path.push(' ');
        path.push_str(&number(*y));
    }
    path
}

/// A hundredth of a pixel is finer than any screen or printer shows.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Dash;
    use super::*;

    #[test]
    fn shapes_become_elements() {
        let mut canvas = Canvas::new(20.0, 10.0);
        canvas.circle([5.0, 2.5], 1.0 / 3.0, [255, 0, 16], None);
        let dashed = Stroke {
            dash: Dash::Dashes,
            ..Stroke::solid([0, 0, 0], 2.0)
        };
        canvas.line([0.0, 0.0], [1.0, 1.001], dashed);
        canvas.upward_text([3.0, 4.0], 11.0, "a < b");
        let text = svg(&canvas);
        for expected in [
            "viewBox=\"0 0 20 10\"",
            "<circle cx=\"5\" cy=\"2.5\" r=\"0.33\" fill=\"#ff0010\"/>",
            "<path d=\"M0 0L1 1\" fill=\"none\" stroke=\"#000000\"",
            "stroke-dasharray=\"8 5\"",
            "transform=\"rotate(-90 3 4)\">a &lt; b</text>",
        ] {
            assert!(text.contains(expected), "{expected} in {text}");
        }
        assert!(text[..1024.min(text.len())].contains(MARK));
    }
}
