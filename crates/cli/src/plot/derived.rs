//! Columns that are computed from those of `history.csv`: rates and running means.

use jstsph_output::Table;

/// What is written around the name of a column to mean its rate.
const RATE: (&str, &str) = ("rate(", ")");

/// The column whose rate a name such as `rate(plastic_energy)` means.
pub(super) fn rated(name: &str) -> Option<&str> {
    name.strip_prefix(RATE.0)?.strip_suffix(RATE.1)
}

/// Unit of the rate of a quantity.
pub(super) fn rate_unit(unit: &str) -> String {
    match unit {
        "" => "1/s".to_owned(),
        "J" => "W".to_owned(),
        "J/m" => "W/m".to_owned(),
        "m/s" => "m/s²".to_owned(),
        other => format!("{other}/s"),
    }
}

/// The table with a running mean over `window` (s) in place of every column but time and step, if a
/// window is given, and with the rates among `names` as further columns.
pub(super) fn derived(table: &Table, names: &[&str], window: Option<f64>) -> Table {
    let mut table = table.clone();
    let Some(times) = table.column("time") else {
        return table;
    };
    if let Some(window) = window {
        for (index, name) in table.columns.iter().enumerate() {
            if name == "time" || name == "step" {
                continue;
            }
            let values: Vec<f64> = table.rows.iter().map(|row| row[index]).collect();
            let means = running_mean(&times, &values, window);
            for (row, mean) in table.rows.iter_mut().zip(means) {
                row[index] = mean;
            }
        }
    }
    for name in names {
        let Some(values) = rated(name).and_then(|column| table.column(column)) else {
            continue;
        };
        table.columns.push((*name).to_owned());
        for (row, rate) in table.rows.iter_mut().zip(rate(&times, &values)) {
            row.push(rate);
        }
    }
    table
}

/// Mean of the values within half a window around each time; where there is none, none.
fn running_mean(times: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    // Rounding must not drop the values at the ends of the window.
    let half = 0.5 * window * (1.0 + 1e-9);
    let mean = |(time, value): (&f64, &f64)| {
        if !value.is_finite() {
            return f64::NAN;
        }
        let first = times.partition_point(|other| *other < time - half);
        let end = times.partition_point(|other| *other <= time + half);
        let (sum, count) = values[first..end]
            .iter()
            .filter(|value| value.is_finite())
            .fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
        sum / count
    };
    times.iter().zip(values).map(mean).collect()
}

/// Differences between the neighbours of each row over the time between them; at the ends
/// one-sided.
fn rate(times: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    (0..values.len())
        .map(|row| {
            let (before, after) = (row.saturating_sub(1), (row + 1).min(last));
            // One row alone has no rate: 0/0 is NaN, which is not drawn.
            (values[after] - values[before]) / (times[after] - times[before])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_slopes_and_means_keep_straight_lines() {
        let table = Table {
            columns: ["time", "step", "energy"].map(str::to_owned).to_vec(),
            rows: (0..5)
                .map(|i| {
                    let t = f64::from(i) * 0.1;
                    vec![t, f64::from(i), 1.0 + 3.0 * t]
                })
                .collect(),
        };
        let derived = derived(&table, &["energy", "rate(energy)"], Some(0.2));
        assert_eq!(derived.columns[3], "rate(energy)");
        let energy = derived.column("energy").unwrap();
        // The mean of three values of a straight line is the middle one; at the end, of two.
        assert!((energy[2] - 1.6).abs() < 1e-12 && (energy[0] - 1.15).abs() < 1e-12);
        let rate = derived.column("rate(energy)").unwrap();
        assert!((rate[2] - 3.0).abs() < 1e-12, "{rate:?}");
        assert_eq!(derived.column("step"), table.column("step"));
        assert_eq!(rate_unit("J/m"), "W/m");
    }

    #[test]
    fn what_has_no_value_gets_none() {
        let mean = running_mean(&[0.0, 1.0, 2.0], &[f64::NAN, 2.0, 4.0], 2.0);
        assert!(mean[0].is_nan() && mean[1..] == [3.0, 3.0], "{mean:?}");
        assert!(rate(&[0.0], &[1.0])[0].is_nan());
    }
}
