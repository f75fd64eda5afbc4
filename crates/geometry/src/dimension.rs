//! Plane strain or three dimensions, and the coordinate axes.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Number of space dimensions that the particles fill.
///
/// Plane strain lies in the plane z = 0; its volumes and areas are those of 1 m thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Dimension {
    /// d = 2: no displacement and no gradient along z.
    #[serde(rename = "plane-strain")]
    PlaneStrain,
    /// d = 3.
    #[serde(rename = "3d")]
    Solid,
}

impl Dimension {
    /// d: 2 or 3.
    #[must_use]
    pub const fn count(self) -> usize {
        match self {
            Self::PlaneStrain => 2,
            Self::Solid => 3,
        }
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::PlaneStrain => "plane-strain",
            Self::Solid => "3d",
        })
    }
}

/// A coordinate axis, towards its positive side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Axis {
    /// First axis.
    X,
    /// Second axis.
    Y,
    /// Third axis.
    Z,
}

impl Axis {
    /// Component of this axis in a vector: 0, 1 or 2.
    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Self::X => 0,
            Self::Y => 1,
            Self::Z => 2,
        }
    }

    /// Components of the two other axes, so that (first, second, this one) is right-handed.
    #[must_use]
    pub const fn across(self) -> [usize; 2] {
        match self {
            Self::X => [1, 2],
            Self::Y => [2, 0],
            Self::Z => [0, 1],
        }
    }
}
