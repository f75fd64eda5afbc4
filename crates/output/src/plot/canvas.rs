//! A picture as a list of shapes in drawing order; lengths in CSS pixels, y downward.

/// Red, green and blue, 0 to 255.
pub(crate) type Colour = [u8; 3];

/// Colour of text and axes.
pub(crate) const INK: Colour = [38, 38, 38];
/// Colour of obstacles.
pub(crate) const STEEL: Colour = [70, 78, 88];
/// Colour of grid lines.
pub(crate) const GRID: Colour = [226, 228, 231];
/// Background.
pub(crate) const PAPER: Colour = [255, 255, 255];

/// Mixes `share` of `b` into `a`.
pub(crate) fn mix(a: Colour, b: Colour, share: f64) -> Colour {
    std::array::from_fn(|i| {
        (f64::from(a[i]) + share * (f64::from(b[i]) - f64::from(a[i]))).round() as u8
    })
}

/// A line's look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: Colour,
    pub(crate) width: f64,
    pub(crate) dash: Dash,
}

/// How a line is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum Dash {
    /// Not at all.
    #[default]
    None,
    /// Dashes.
    Dashes,
    /// Dots.
    Dots,
    /// A dash and a dot by turns.
    DashesAndDots,
}

impl Dash {
    /// Lengths drawn and left out by turns, over the width of the line; empty for a full line.
    pub(crate) fn pattern(self) -> &'static [f64] {
        match self {
            Self::None => &[],
            Self::Dashes => &[4.0, 2.5],
            Self::Dots => &[1.2, 1.8],
            Self::DashesAndDots => &[5.0, 2.0, 1.2, 2.0],
        }
    }
}

impl Stroke {
    pub(crate) fn solid(colour: Colour, width: f64) -> Self {
        Self {
            colour,
            width,
            dash: Dash::None,
        }
    }
}

/// Which point of a text its position is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// One shape.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Shape {
    Polygon {
        points: Vec<[f64; 2]>,
        fill: Colour,
        outline: Option<Stroke>,
    },
    /// A piece of a coloured surface, which joins its neighbours without a seam.
    Patch { points: Vec<[f64; 2]>, fill: Colour },
    Polyline {
        points: Vec<[f64; 2]>,
        stroke: Stroke,
    },
    Circle {
        centre: [f64; 2],
        radius: f64,
        fill: Colour,
        outline: Option<Stroke>,
    },
    /// Text on a baseline through `at`; `upward` turns it by a quarter to read from below.
    Text {
        at: [f64; 2],
        size: f64,
        anchor: Anchor,
        upward: bool,
        content: String,
    },
}

/// A picture being drawn.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Canvas {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) shapes: Vec<Shape>,
}

impl Canvas {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self {
            width: width.ceil(),
            height: height.ceil(),
            shapes: Vec::new(),
        }
    }

    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.polyline(vec![from, to], stroke);
    }

    pub(crate) fn polyline(&mut self, points: Vec<[f64; 2]>, stroke: Stroke) {
        self.shapes.push(Shape::Polyline { points, stroke });
    }

    pub(crate) fn patch(&mut self, points: Vec<[f64; 2]>, fill: Colour) {
        self.shapes.push(Shape::Patch { points, fill });
    }

    pub(crate) fn polygon(&mut self, points: Vec<[f64; 2]>, fill: Colour, outline: Option<Stroke>) {
        self.shapes.push(Shape::Polygon {
            points,
            fill,
            outline,
        });
    }

    pub(crate) fn circle(
        &mut self,
        centre: [f64; 2],
        radius: f64,
        fill: Colour,
        outline: Option<Stroke>,
    ) {
        self.shapes.push(Shape::Circle {
            centre,
            radius,
            fill,
            outline,
        });
    }

    pub(crate) fn text(&mut self, at: [f64; 2], size: f64, anchor: Anchor, content: &str) {
        self.shapes.push(Shape::Text {
            at,
            size,
            anchor,
            upward: false,
            content: content.to_owned(),
        });
    }

    pub(crate) fn upward_text(&mut self, at: [f64; 2], size: f64, content: &str) {
        self.shapes.push(Shape::Text {
            at,
            size,
            anchor: Anchor::Middle,
            upward: true,
            content: content.to_owned(),
        });
    }
}

/// An upright rectangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Rect {
    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// Whether a point lies inside or, up to rounding, on the edge.
    pub(crate) fn contains(&self, point: [f64; 2]) -> bool {
        const SLACK: f64 = 0.01;
        (self.left - SLACK..=self.right + SLACK).contains(&point[0])
            && (self.top - SLACK..=self.bottom + SLACK).contains(&point[1])
    }

    pub(crate) fn corners(&self) -> Vec<[f64; 2]> {
        vec![
            [self.left, self.top],
            [self.right, self.top],
            [self.right, self.bottom],
            [self.left, self.bottom],
        ]
    }

    /// The closed outline.
    pub(crate) fn outline(&self) -> Vec<[f64; 2]> {
        let mut points = self.corners();
        points.push([self.left, self.top]);
        points
    }
}
