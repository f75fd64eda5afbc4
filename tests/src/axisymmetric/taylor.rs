//! The Taylor bars of `cases/taylor-bar.toml` and `taylor-bar-324.toml`, one row of a table each.

use std::fmt;

use super::{Base, Energies, Impact, Inverted, Mesh, Metal, Shape, outline_radius};

/// A copper bar of radius 3.2 mm that hits the wall at 227 m/s.
#[derive(Clone, Copy, Debug)]
pub struct TaylorBar {
    /// Undeformed length, m.
    pub height: f64,
    /// What the base may do.
    pub base: Base,
    /// Elements per radius; ten times as many along the axis.
    pub radial: usize,
}

/// The bar after 80 µs.
#[derive(Clone, Debug)]
pub struct TaylorRow {
    bar: TaylorBar,
    /// What is measured.
    pub shape: Shape,
    /// Radii of the outline at [`HEIGHTS`](Self::HEIGHTS), m; zero where the side does not reach.
    pub outline: [f64; 9],
    /// The books.
    pub energies: Energies,
    steps: usize,
}

impl TaylorBar {
    /// The columns by which a row is found, as they are written.
    #[must_use]
    pub fn key(&self) -> String {
        let base = match self.base {
            Base::Free => "free",
            Base::Held => "held",
        };
        format!("{:.1},{base},{},", self.height * 1e3, self.radial)
    }

    /// The bar at 80 µs.
    ///
    /// # Errors
    /// If an element is inverted.
    pub fn run(self, courant: f64) -> Result<TaylorRow, Inverted> {
        let mesh = Mesh::cylinder(3.2e-3, self.height, self.radial, 10 * self.radial);
        let mut impact = Impact::new(mesh, Metal::copper(), self.base, -227.0, courant);
        impact.run_to(80e-6)?;
        let body = &impact.body;
        Ok(TaylorRow {
            bar: self,
            shape: Shape::of(body),
            outline: TaylorRow::HEIGHTS.map(|height| {
                outline_radius(&body.mesh, &body.position, height).unwrap_or_default()
            }),
            energies: impact.energies(),
            steps: impact.steps(),
        })
    }
}

impl TaylorRow {
    /// Heights above the wall at which the outline is measured, m.
    pub const HEIGHTS: [f64; 9] = [
        0.4e-3, 0.5e-3, 0.75e-3, 1e-3, 1.5e-3, 2e-3, 3e-3, 5e-3, 10e-3,
    ];

    /// Names of the columns; lengths in mm, `balance` in parts of the initial energy.
    pub const HEADER: &str = "height,base,radial,corner_radius,corner_height,largest_radius,\
        contact_radius,folded_nodes,length,centre_strain,largest_strain,r_0.4,r_0.5,r_0.75,r_1,r_1.5,\
        r_2,r_3,r_5,r_10,balance,steps";
}

impl fmt::Display for TaylorRow {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shape = &self.shape;
        let mm = |length: f64| format!("{:.5}", length * 1e3);
        let mut cells = vec![
            mm(shape.corner_radius),
            mm(shape.corner_height),
            mm(shape.largest_radius),
            mm(shape.contact_radius),
            shape.folded.to_string(),
            mm(shape.length),
            format!("{:.4}", shape.centre_strain),
            format!("{:.4}", shape.largest_strain),
        ];
        cells.extend(self.outline.map(mm));
        cells.push(format!("{:.2e}", self.energies.balance()));
        cells.push(self.steps.to_string());
        write!(formatter, "{}{}", self.bar.key(), cells.join(","))
    }
}
