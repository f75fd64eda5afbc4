//! Does a number agree with the paper's?

use serde::{Deserialize, Serialize};

/// What the paper leads one to expect, in the unit of the quantity.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub(super) enum Expectation {
    /// A number, with the relative differences up to which ours is met or close.
    Value { paper: f64, met: f64, close: f64 },
    /// Ranges in which a number is met or close.
    Range { met: [f64; 2], close: [f64; 2] },
    /// The values converge monotonically over the resolution: met when they change in one direction by
    /// less and less, close when in one direction only.
    Monotone,
    /// The values of a run, at several times, rise.
    Rising,
    /// A picture without numbers: nothing to compare but by eye.
    Shown,
}

/// How it compares.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Verdict {
    /// It agrees.
    Met,
    /// It nearly agrees; the page gives the difference.
    Close,
    /// It does not agree.
    Differs,
    /// Drawn beside what the paper describes, without a number to compare.
    Shown,
    /// The run broke down or has no value.
    Failed,
    /// The run was not made.
    NotRun,
}

impl Verdict {
    /// On the page.
    pub(super) fn text(self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::Close => "close",
            Self::Differs => "differs",
            Self::Shown => "shown",
            Self::Failed => "failed",
            Self::NotRun => "not run",
        }
    }

    /// All of them, best first.
    pub(super) const ALL: [Self; 6] = [
        Self::Met,
        Self::Close,
        Self::Differs,
        Self::Shown,
        Self::Failed,
        Self::NotRun,
    ];
}

impl Expectation {
    /// Relative difference of a value from the paper's number, if it prints one.
    pub(super) fn difference(&self, value: f64) -> Option<f64> {
        match self {
            Self::Value { paper, .. } => Some(value / paper - 1.0),
            _ => None,
        }
    }

    /// Whether the values of one run agree (every one of them); `None` where runs are judged
    /// together.
    pub(super) fn judge(&self, values: &[f64]) -> Option<Verdict> {
        let worst = |is: &dyn Fn(f64) -> Verdict| {
            let rank = |verdict: &Verdict| Verdict::ALL.iter().position(|other| other == verdict);
            values.iter().map(|value| is(*value)).max_by_key(rank)
        };
        match self {
            Self::Value { paper, met, close } => worst(&|value| {
                graded(
                    (value - paper).abs(),
                    met * paper.abs(),
                    close * paper.abs(),
                )
            }),
            Self::Range { met, close } => {
                let within = |value: f64, [from, to]: &[f64; 2]| (*from..=*to).contains(&value);
                worst(&|value| {
                    if within(value, met) {
                        Verdict::Met
                    } else if within(value, close) {
                        Verdict::Close
                    } else {
                        Verdict::Differs
                    }
                })
            }
            Self::Rising if values.len() < 2 => None,
            Self::Rising => Some(if values.windows(2).all(|pair| pair[1] > pair[0]) {
                Verdict::Met
            } else {
                Verdict::Differs
            }),
            Self::Shown => Some(Verdict::Shown),
            Self::Monotone => None,
        }
    }

    /// Whether the values of several resolutions, coarse to fine, agree; fewer than three show no
    /// convergence.
    pub(super) fn judge_series(&self, values: &[f64]) -> Verdict {
        let steps: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        if steps.len() < 2 {
            return Verdict::NotRun;
        }
        let mut pairs = steps.windows(2);
        if !steps.windows(2).all(|pair| pair[0] * pair[1] > 0.0) {
            Verdict::Differs
        } else if pairs.all(|pair| pair[1].abs() < pair[0].abs()) {
            Verdict::Met
        } else {
            Verdict::Close
        }
    }

    /// Whether runs are judged together, as a series over the resolution.
    pub(super) fn is_of_series(&self) -> bool {
        matches!(self, Self::Monotone)
    }
}

fn graded(distance: f64, met: f64, close: f64) -> Verdict {
    if distance <= met {
        Verdict::Met
    } else if distance <= close {
        Verdict::Close
    } else {
        // A value that is not a number is neither.
        Verdict::Differs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_graded_by_their_relative_difference() {
        let radius = Expectation::Value {
            paper: 6.98,
            met: 0.01,
            close: 0.05,
        };
        for (value, verdict) in [
            (6.98, Verdict::Met),
            (7.04, Verdict::Met),
            (7.05, Verdict::Close),
            (6.64, Verdict::Close),
            (7.34, Verdict::Differs),
            (f64::NAN, Verdict::Differs),
        ] {
            assert_eq!(radius.judge(&[value]), Some(verdict), "{value}");
        }
        let difference = radius.difference(7.329).unwrap();
        assert!((difference - 0.05).abs() < 1e-12, "{difference}");
        assert_eq!(radius.judge(&[]), None);
    }

    #[test]
    fn the_worst_of_several_values_counts() {
        let range = Expectation::Range {
            met: [0.0, 0.02],
            close: [0.0, f64::INFINITY],
        };
        assert_eq!(range.judge(&[0.02, 0.0]), Some(Verdict::Met));
        assert_eq!(range.judge(&[0.02, 0.5]), Some(Verdict::Close));
        assert_eq!(range.judge(&[-0.1, 0.5]), Some(Verdict::Differs));
        assert_eq!(range.difference(0.1), None);
        assert_eq!(Expectation::Rising.judge(&[1.0, 2.0]), Some(Verdict::Met));
        assert_eq!(
            Expectation::Rising.judge(&[1.0, 1.0]),
            Some(Verdict::Differs)
        );
        assert_eq!(Expectation::Shown.judge(&[1.0]), Some(Verdict::Shown));
    }

    #[test]
    fn trends_need_resolutions() {
        let monotone = Expectation::Monotone;
        for (values, verdict) in [
            (&[3.0, 2.0, 1.9][..], Verdict::Met),
            (&[1.0, 2.0, 2.5, 2.6], Verdict::Met),
            (&[3.0, 2.9, 1.9], Verdict::Close),
            (&[3.0, 2.0, 2.1], Verdict::Differs),
            (&[3.0, 2.0, 2.0], Verdict::Differs),
            (&[3.0, f64::NAN, 2.0], Verdict::Differs),
            (&[3.0, 2.0], Verdict::NotRun),
        ] {
            assert_eq!(monotone.judge_series(values), verdict, "{values:?}");
        }
        assert_eq!(monotone.judge(&[3.0]), None);
    }
}
