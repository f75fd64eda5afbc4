//! Errors over resolutions, their observed orders, and assertions that show the whole table.

use std::fmt;

/// Order p in error = C / refinement^p between two resolutions, each (refinement, error).
///
/// `refinement` is anything proportional to one over the spacing or one over the time step.
#[must_use]
pub fn observed_order(coarse: (f64, f64), fine: (f64, f64)) -> f64 {
    (coarse.1 / fine.1).ln() / (fine.0 / coarse.0).ln()
}

/// One problem at several resolutions: one row per resolution, one column per quantity.
#[derive(Clone, Debug)]
pub struct Study {
    title: String,
    quantities: Vec<&'static str>,
    rows: Vec<(f64, Vec<f64>)>,
}

impl Study {
    /// An empty table.
    #[must_use]
    pub fn new(title: impl Into<String>, quantities: &[&'static str]) -> Self {
        Self {
            title: title.into(),
            quantities: quantities.to_vec(),
            rows: Vec::new(),
        }
    }

    /// A table filled by `errors(refinement)`, coarse to fine.
    #[must_use]
    pub fn over(
        title: impl Into<String>,
        quantities: &[&'static str],
        refinements: &[usize],
        mut errors: impl FnMut(usize) -> Vec<f64>,
    ) -> Self {
        let mut study = Self::new(title, quantities);
        for &refinement in refinements {
            study.add(refinement as f64, errors(refinement));
        }
        study
    }

    /// Adds a resolution; finer ones come later.
    ///
    /// # Panics
    /// If there is not one error per quantity.
    pub fn add(&mut self, refinement: f64, errors: Vec<f64>) {
        assert_eq!(
            errors.len(),
            self.quantities.len(),
            "one error per quantity"
        );
        self.rows.push((refinement, errors));
    }

    /// Error of a quantity at the finest resolution.
    ///
    /// # Panics
    /// If the quantity is unknown or the table is empty.
    #[must_use]
    pub fn finest_error(&self, quantity: &str) -> f64 {
        let column = self.column(quantity);
        self.rows
            .last()
            .map(|(_, errors)| errors[column])
            .expect("a study has resolutions")
    }

    /// Observed order of a quantity between the two finest resolutions.
    ///
    /// # Panics
    /// If the quantity is unknown or there are fewer than two resolutions.
    #[must_use]
    pub fn order(&self, quantity: &str) -> f64 {
        let column = self.column(quantity);
        let [.., coarse, fine] = self.rows.as_slice() else {
            panic!("{}: an order needs two resolutions", self.title)
        };
        observed_order((coarse.0, coarse.1[column]), (fine.0, fine.1[column]))
    }

    /// Asserts that the order between the two finest resolutions is in `range`.
    ///
    /// # Panics
    /// With the whole table if it is not.
    pub fn assert_order(&self, quantity: &str, range: std::ops::Range<f64>) {
        let order = self.order(quantity);
        assert!(
            range.contains(&order),
            "order of {quantity} is {order:.3}, expected {range:?}\n{self}"
        );
    }

    /// Asserts that the error at the finest resolution is below `limit`: an order says nothing
    /// about the size.
    ///
    /// # Panics
    /// With the whole table if it is not.
    pub fn assert_finest_error(&self, quantity: &str, limit: f64) {
        let error = self.finest_error(quantity);
        assert!(
            error < limit,
            "error of {quantity} at the finest resolution is {error:.3e}, expected below {limit:.3e}\n{self}"
        );
    }

    /// Shows the table (the test harness captures it; `--no-capture` lets it through).
    #[expect(
        clippy::print_stdout,
        reason = "measured orders are what a reader of these tests wants"
    )]
    pub fn show(&self) {
        println!("{self}");
    }

    fn column(&self, quantity: &str) -> usize {
        self.quantities
            .iter()
            .position(|known| *known == quantity)
            .unwrap_or_else(|| panic!("{}: no quantity {quantity}", self.title))
    }
}

impl fmt::Display for Study {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.title)?;
        write!(f, "{:>10}", "refinement")?;
        for quantity in &self.quantities {
            write!(f, "  {quantity:>14} order")?;
        }
        writeln!(f)?;
        for (i, (refinement, errors)) in self.rows.iter().enumerate() {
            write!(f, "{refinement:>10}")?;
            for (column, error) in errors.iter().enumerate() {
                write!(f, "  {error:>14.3e}")?;
                match i.checked_sub(1).map(|before| &self.rows[before]) {
                    Some((coarse, before)) => {
                        let order =
                            observed_order((*coarse, before[column]), (*refinement, *error));
                        write!(f, " {order:>5.2}")?;
                    }
                    None => write!(f, " {:>5}", "")?,
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_has_its_exponent_as_order() {
        let study = Study::over("power law", &["cubic"], &[4, 8, 12], |n| {
            vec![5.0 * (n as f64).powi(-3)]
        });
        assert!((study.order("cubic") - 3.0).abs() < 1e-12);
        study.assert_order("cubic", 2.9..3.1);
        study.assert_finest_error("cubic", 5.01 / 1728.0);
    }

    #[test]
    fn a_missed_order_shows_every_row_of_the_table() {
        let study = Study::over("halving", &["e"], &[10, 20, 40], |n| vec![1.0 / n as f64]);
        let caught = std::panic::catch_unwind(|| study.assert_order("e", 1.9..2.1)).unwrap_err();
        let message = caught.downcast_ref::<String>().unwrap();
        for part in ["order of e is 1.000", "1.000e-1", "5.000e-2", "2.500e-2"] {
            assert!(message.contains(part), "{message}");
        }
    }
}
