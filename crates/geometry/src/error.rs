//! What can be wrong with a shape, a lattice or a selection.

use crate::Dimension;

/// Everything that the constructors and selections of this crate refuse.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeometryError {
    /// A length or coordinate is NaN or infinite.
    #[error("{quantity} of the {item} is {value}; it must be a finite number of metres")]
    NotFinite {
        /// Shape or lattice the quantity belongs to.
        item: &'static str,
        /// The quantity's name.
        quantity: &'static str,
        /// The value given, m.
        value: f64,
    },
    /// A length that must be positive is not.
    #[error("{quantity} of the {item} is {value} m; it must be positive")]
    NotPositive {
        /// Shape or lattice the quantity belongs to.
        item: &'static str,
        /// The quantity's name.
        quantity: &'static str,
        /// The value given, m.
        value: f64,
    },
    /// The shape does not exist in this dimension.
    #[error("a {shape} cannot be used in {dimension}; use {remedy}")]
    WrongDimension {
        /// The shape's name.
        shape: &'static str,
        /// The dimension asked for.
        dimension: Dimension,
        /// What can be used instead.
        remedy: &'static str,
    },
    /// The lattice does not fit the kind of shape.
    #[error("a lattice given by {lattice} cannot fill a {shape}; give {remedy}")]
    LatticeMismatch {
        /// How the lattice was given.
        lattice: &'static str,
        /// The shape's name.
        shape: &'static str,
        /// What can be given instead.
        remedy: &'static str,
    },
    /// No whole number of intervals of about the requested spacing fits.
    #[error(
        "spacing {spacing} m does not divide the {direction} of {length} m: the nearest is \
         {nearest} m, more than {limit_percent} % off; choose another spacing or give counts"
    )]
    SpacingDeviates {
        /// Spacing asked for, m.
        spacing: f64,
        /// Which length of the shape.
        direction: &'static str,
        /// That length, m.
        length: f64,
        /// Nearest spacing that fits, m.
        nearest: f64,
        /// Largest accepted deviation, percent.
        limit_percent: f64,
    },
    /// A count of nodes, rings or layers is too small.
    #[error("{quantity} is {value}; at least {minimum} needed")]
    TooFew {
        /// What is counted.
        quantity: &'static str,
        /// The count given.
        value: usize,
        /// The smallest accepted count.
        minimum: usize,
    },
    /// The lattice would not fit into memory.
    #[error("the lattice would have {count:.3e} nodes, the limit is {limit}; enlarge the spacing")]
    TooManyNodes {
        /// Nodes asked for (of the bounding lattice).
        count: f64,
        /// Largest accepted number.
        limit: usize,
    },
    /// The body has no face of this name.
    #[error("a {shape} has no face \"{face}\"; its faces are {}", available.join(", "))]
    UnknownFace {
        /// The name asked for.
        face: String,
        /// The shape's name.
        shape: &'static str,
        /// The names there are.
        available: &'static [&'static str],
    },
    /// The face is an edge: its nodes can be selected, but it has no area.
    #[error("\"{face}\" is an edge without area; give tractions on \"{instead}\"")]
    FaceWithoutArea {
        /// The name asked for.
        face: String,
        /// A face beside it that has an area.
        instead: &'static str,
    },
    /// Two neighbouring corners of a polygon are the same.
    #[error("corner {index} of the polygon at ({x}, {y}) m coincides with the next; remove one")]
    CoincidentCorners {
        /// The first of the two, counted from zero.
        index: usize,
        /// Its coordinate, m.
        x: f64,
        /// Its coordinate, m.
        y: f64,
    },
    /// Two edges of a polygon meet where they should not.
    #[error(
        "edges {first} and {second} of the polygon cross or touch near ({x}, {y}) m; edge k runs \
         from corner k to the next one"
    )]
    CrossesItself {
        /// One edge, counted from zero.
        first: usize,
        /// The other edge.
        second: usize,
        /// Where they meet, m.
        x: f64,
        /// Where they meet, m.
        y: f64,
    },
    /// A file that cannot be read as STL.
    #[error("this is no readable STL file: {reason}")]
    UnreadableMesh {
        /// What the reader says.
        reason: String,
    },
    /// A file that cannot be read as the drawing it should be.
    #[error("line {line} of the drawing: {reason}")]
    UnreadableDrawing {
        /// Line of the file, from 1.
        line: usize,
        /// What is wrong there.
        reason: String,
    },
    /// Something in a drawing that has an outline but cannot be used.
    #[error("line {line} of the drawing: {item} cannot be used; {remedy}")]
    UnsupportedDrawing {
        /// Line of the file, from 1.
        line: usize,
        /// What stands there.
        item: String,
        /// What to do instead.
        remedy: &'static str,
    },
    /// A drawing has no layer or element of this name.
    #[error("the drawing has no layer \"{layer}\"; its layers with lines are {}", available.join(", "))]
    UnknownLayer {
        /// The name asked for.
        layer: String,
        /// The names there are.
        available: Vec<String>,
    },
    /// A drawing without a line.
    #[error("the drawing has no lines to use")]
    EmptyDrawing,
    /// Lines of a drawing fork.
    #[error(
        "{count} lines of the drawing end at ({}, {}) m, where only two can be joined; remove lines \
         drawn twice, put what is no outline onto another layer, or reduce the tolerance (now \
         {tolerance:.1e} m)", at[0], at[1]
    )]
    BranchingContour {
        /// Lines that end there.
        count: usize,
        /// Place, m.
        at: [f64; 2],
        /// How far ends may lie apart to be joined, m.
        tolerance: f64,
    },
    /// The outline of a body does not close.
    #[error(
        "the outline is open: it begins at ({}, {}) m and ends at ({}, {}) m, {gap:.3e} m apart; \
         close it, or raise the tolerance above this", start[0], start[1], end[0], end[1]
    )]
    OpenContour {
        /// One end, m.
        start: [f64; 2],
        /// The other end, m.
        end: [f64; 2],
        /// Their distance, m.
        gap: f64,
    },
    /// Outlines that are not one body with holes.
    #[error(
        "the drawing has {count} outlines, and that at ({}, {}) m is no hole of the largest, or \
         meets another; put one body (with its holes) onto a layer", at[0], at[1]
    )]
    SeveralContours {
        /// Outlines found.
        count: usize,
        /// A point of the one in question, m.
        at: [f64; 2],
    },
    /// A surface without triangles.
    #[error("the surface has no triangles")]
    EmptyMesh,
    /// Triangles are missing, or their corners do not meet exactly.
    #[error(
        "the surface is not closed: {count} edges have triangles on one side only, the first \
         around ({x}, {y}, {z}) m; fill the holes, and write corners that coincide with equal \
         coordinates"
    )]
    OpenMesh {
        /// Number of such edges.
        count: usize,
        /// Middle of one of them, m.
        x: f64,
        /// Middle of one of them, m.
        y: f64,
        /// Middle of one of them, m.
        z: f64,
    },
    /// Triangles at an edge disagree about what is outside.
    #[error(
        "the triangles of the surface face different sides at {count} edges, the first around \
         ({x}, {y}, {z}) m; orient all of them outwards"
    )]
    InconsistentMesh {
        /// Number of such edges.
        count: usize,
        /// Middle of one of them, m.
        x: f64,
        /// Middle of one of them, m.
        y: f64,
        /// Middle of one of them, m.
        z: f64,
    },
    /// A surface that is not that of a solid.
    #[error(
        "the surface cuts through itself or lies on itself: {count} pairs of triangles, the first \
         around ({x}, {y}, {z}) m; join the parts in the program that wrote it"
    )]
    SelfIntersectingMesh {
        /// Number of pairs.
        count: usize,
        /// A common point of one pair, m.
        x: f64,
        /// A common point of one pair, m.
        y: f64,
        /// A common point of one pair, m.
        z: f64,
    },
    /// A part of the shape is too thin for the lattice.
    #[error(
        "{lost_percent:.1} % of the volume of the {shape} lies in parts too thin for the lattice, \
         allowed are {limit_percent} %; reduce the spacing (now {spacing:.3e} m)"
    )]
    Unresolved {
        /// The shape's name.
        shape: &'static str,
        /// Volume far from every bond, percent.
        lost_percent: f64,
        /// Accepted volume far from every bond, percent.
        limit_percent: f64,
        /// Spacing of the lattice, m.
        spacing: f64,
    },
    /// The normal of a half-space has no direction.
    #[error("normal ({x}, {y}, {z}) of a half-space has no direction; give a non-zero vector")]
    NoDirection {
        /// First component.
        x: f64,
        /// Second component.
        y: f64,
        /// Third component.
        z: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_state_value_and_remedy() {
        let error = GeometryError::UnknownFace {
            face: "lid".into(),
            shape: "box",
            available: &["left", "right"],
        };
        assert_eq!(
            error.to_string(),
            "a box has no face \"lid\"; its faces are left, right"
        );
        let error = GeometryError::WrongDimension {
            shape: "disc",
            dimension: Dimension::Solid,
            remedy: "a cylinder",
        };
        assert_eq!(
            error.to_string(),
            "a disc cannot be used in 3d; use a cylinder"
        );
    }
}
