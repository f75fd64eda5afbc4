//! A column of `history.csv` over time.

use super::measure::MeasureError;

/// Values over ascending times; a value that is not there is NaN.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
}

/// A value and when it was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extreme {
    pub(super) time: f64,
    pub(super) value: f64,
}

impl Series {
    fn end(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    fn missing(&self, time: f64) -> MeasureError {
        MeasureError::NoValue {
            time,
            end: self.end(),
        }
    }

    /// The value at the row nearest to a time.
    ///
    /// # Errors
    /// [`MeasureError::NoValue`] after the last row, or where the row is empty. Rows are written at the
    /// first step past an interval: the last one may be a little before the nominal end.
    pub(super) fn at(&self, time: f64) -> Result<f64, MeasureError> {
        let distance = |row: &usize| (self.times[*row] - time).abs();
        let nearest = (0..self.times.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest
            .filter(|_| time <= self.end() * (1.0 + 1e-6))
            .map(|row| self.values[row])
            .filter(|value| value.is_finite())
            .ok_or_else(|| self.missing(time))
    }

    /// The rows between two times that have a value.
    ///
    /// # Errors
    /// [`MeasureError::NoValue`] when the run ended before the second time or no row is left.
    pub(super) fn within(&self, [from, to]: [f64; 2]) -> Result<Self, MeasureError> {
        if to > self.end() * (1.0 + 1e-6) {
            return Err(self.missing(to));
        }
        let rows = self.times.iter().zip(&self.values);
        let (times, values): (Vec<f64>, Vec<f64>) = rows
            .filter(|(time, value)| (from..=to).contains(*time) && value.is_finite())
            .unzip();
        if times.is_empty() {
            return Err(self.missing(from));
        }
        Ok(Self { times, values })
    }

    /// The running mean over a window centred at every row; near the ends over what there is.
    #[expect(clippy::cast_precision_loss, reason = "rows are far below 2^53")]
    pub(super) fn smooth(&self, window: f64) -> Self {
        let (mut first, mut last) = (0, 0);
        let values = self.times.iter().map(|time| {
            while self.times[first] < time - 0.5 * window {
                first += 1;
            }
            while last < self.times.len() && self.times[last] <= time + 0.5 * window {
                last += 1;
            }
            let rows = &self.values[first..last];
            rows.iter().sum::<f64>() / rows.len() as f64
        });
        Self {
            values: values.collect(),
            times: self.times.clone(),
        }
    }

    /// The largest value; there is one after [`Self::within`].
    pub(super) fn largest(&self) -> Extreme {
        let rows = self.times.iter().zip(&self.values);
        rows.max_by(|a, b| a.1.total_cmp(b.1)).map_or(
            Extreme {
                time: f64::NAN,
                value: f64::NAN,
            },
            |(time, value)| Extreme {
                time: *time,
                value: *value,
            },
        )
    }

    /// Mean of the magnitudes.
    #[expect(clippy::cast_precision_loss, reason = "rows are far below 2^53")]
    pub(super) fn mean_magnitude(&self) -> f64 {
        self.values.iter().map(|value| value.abs()).sum::<f64>() / self.values.len() as f64
    }

    /// First time at which the magnitude exceeds a part of the largest magnitude.
    ///
    /// # Errors
    /// [`MeasureError::NoValue`] for a series that is zero or empty.
    pub(super) fn time_above(&self, part: f64) -> Result<f64, MeasureError> {
        let largest = self.values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let mut rows = self.times.iter().zip(&self.values);
        rows.find(|(_, value)| value.abs() > part * largest)
            .map(|(time, _)| *time)
            .ok_or_else(|| self.missing(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(values: &[f64]) -> Series {
        Series {
            times: (0..values.len()).map(|row| row as f64).collect(),
            values: values.to_vec(),
        }
    }

    #[test]
    fn the_nearest_row_counts_and_the_end_is_the_end() {
        let series = series(&[5.0, f64::NAN, 7.0]);
        assert_eq!(series.at(0.4).unwrap(), 5.0);
        assert_eq!(series.at(1.6).unwrap(), 7.0);
        assert_eq!(series.at(2.000_000_1).unwrap(), 7.0);
        let message = series.at(2.5).unwrap_err().to_string();
        assert!(message.contains("it ended at 2.0000e0 s"), "{message}");
        assert!(series.at(1.0).is_err());
    }

    #[test]
    fn a_range_needs_a_run_that_reaches_its_end() {
        let rows = series(&[1.0, -4.0, f64::NAN, 3.0]);
        let within = rows.within([0.5, 3.0]).unwrap();
        assert_eq!(within.values, [-4.0, 3.0]);
        assert_eq!(within.mean_magnitude(), 3.5);
        assert_eq!(
            within.largest(),
            Extreme {
                time: 3.0,
                value: 3.0
            }
        );
        assert!(rows.within([0.0, 4.0]).is_err());
        assert!(rows.within([1.5, 2.5]).is_err());
    }

    #[test]
    fn the_running_mean_is_centred_and_moves_a_lone_peak_to_a_broad_one() {
        let noisy = series(&[0.0, 9.0, 0.0, 4.0, 5.0, 4.0, 0.0]);
        let smooth = noisy.smooth(2.0);
        assert_eq!(smooth.values[1], 3.0);
        assert_eq!(smooth.values[0], 4.5);
        assert_eq!(smooth.values[6], 2.0);
        assert_eq!(noisy.largest().time, 1.0);
        assert_eq!(smooth.within([1.0, 6.0]).unwrap().largest().time, 4.0);
    }

    #[test]
    fn the_first_rise_is_found_whatever_its_sign() {
        assert_eq!(series(&[0.0, -0.1, -8.0]).time_above(0.05).unwrap(), 2.0);
        assert_eq!(series(&[0.0, -0.1, -8.0]).time_above(0.01).unwrap(), 1.0);
        assert!(series(&[0.0, 0.0]).time_above(0.5).is_err());
    }
}
