//! What can be wrong with the description of an obstacle.

/// A mistake in the description of an obstacle. Points and fillets are counted from zero in the
/// order in which they were given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContactError {
    /// A profile without a single chain.
    #[error("a profile needs at least one chain of points, but has none")]
    NoChains,
    /// A chain that does not enclose or bound anything.
    #[error("a chain has {count} points, but needs at least {needed}")]
    TooFewPoints {
        /// Points given.
        count: usize,
        /// Points needed: two for an open chain, three for a closed one.
        needed: usize,
    },
    /// The list of fillets does not match the list of points.
    #[error(
        "a chain of {points} points has {fillets} fillet radii; give one per point, 0 for a sharp corner"
    )]
    FilletCount {
        /// Radii given.
        fillets: usize,
        /// Points given.
        points: usize,
    },
    /// A number that is infinite or not a number.
    #[error("{what} is {value}, but must be finite")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Two neighbouring points are the same.
    #[error("point {index} at ({x}, {y}) m coincides with the next point of its chain; remove one")]
    CoincidentPoints {
        /// The first of the two.
        index: usize,
        /// Its coordinate, m.
        x: f64,
        /// Its coordinate, m.
        y: f64,
    },
    /// The chain turns back on itself, so that it has no sides there.
    #[error("the chain doubles back on itself at point {index} at ({x}, {y}) m")]
    DoublesBack {
        /// The point where it turns.
        index: usize,
        /// Its coordinate, m.
        x: f64,
        /// Its coordinate, m.
        y: f64,
    },
    /// The chain crosses or touches itself, so that one side is not well defined.
    #[error(
        "the chain crosses itself near ({x}, {y}) m; an open chain is extended straight beyond both ends: close it, or end it elsewhere"
    )]
    CrossesItself {
        /// Coordinate of the crossing, m.
        x: f64,
        /// Coordinate of the crossing, m.
        y: f64,
    },
    /// The point that should say which side is free is on neither.
    #[error("the point ({x}, {y}) m lies on a line of the drawing; give one beside all of them")]
    FreePointOnWall {
        /// Its coordinate, m.
        x: f64,
        /// Its coordinate, m.
        y: f64,
    },
    /// A negative fillet radius.
    #[error("the fillet radius at point {index} is {radius} m, but must not be negative")]
    NegativeFillet {
        /// The point.
        index: usize,
        /// Its radius, m.
        radius: f64,
    },
    /// A fillet where there is no corner.
    #[error(
        "point {index} is an end of an open chain: its fillet radius is {radius} m, but must be 0"
    )]
    EndFillet {
        /// The point.
        index: usize,
        /// Its radius, m.
        radius: f64,
    },
    /// A fillet, together with its neighbour's, is longer than the edge it lies on.
    #[error(
        "the edge after point {index} is {available} m long, but the fillets at its ends take {needed} m of it; reduce a radius"
    )]
    FilletTooLarge {
        /// The point before the edge.
        index: usize,
        /// What the fillets take, m.
        needed: f64,
        /// The length of the edge, m.
        available: f64,
    },
    /// A direction that is not a unit vector.
    #[error("{what} has length {length}, but must have length 1; normalise it")]
    NotUnit {
        /// Which direction.
        what: &'static str,
        /// Its length.
        length: f64,
    },
    /// A length that must be positive.
    #[error("{what} is {value} m, but must be positive")]
    NotPositive {
        /// Which length.
        what: &'static str,
        /// Its value, m.
        value: f64,
    },
    /// A box that is empty along one axis.
    #[error("the box reaches from {min} m to {max} m along {axis}, but min must be below max")]
    EmptyBox {
        /// x, y or z.
        axis: char,
        /// Lower limit, m.
        min: f64,
        /// Upper limit, m.
        max: f64,
    },
    /// A coefficient of restitution out of range.
    #[error("the restitution is {value}, but must lie between 0 (no rebound) and 1 (full rebound)")]
    Restitution {
        /// Its value.
        value: f64,
    },
    /// A coefficient of friction out of range.
    #[error(
        "the coefficient of friction is {value}, but must be 0 (no friction) or a finite positive number"
    )]
    Friction {
        /// Its value.
        value: f64,
    },
}
