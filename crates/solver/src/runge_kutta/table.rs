//! Explicit Runge-Kutta methods as lists of stages.

use crate::model::Integrator;

/// What becomes of u + Δt R(u) in a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Combination {
    /// u ← share uⁿ + (1 − share)(u + Δt R(u)): the form of Shu & Osher 1988.
    WithStart {
        /// Share of uⁿ; zero leaves the Euler step as it is.
        share: f64,
    },
    /// d ← memory d + Δt R(u), u ← u + share d: the form of Williamson 1980 with two registers.
    Increment {
        /// Part of the last increment that is kept.
        memory: f64,
        /// Part of the increment that is added.
        share: f64,
    },
}

/// One evaluation of R and what is made of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StageRule {
    pub(crate) combination: Combination,
    /// Time of the result, in steps from tⁿ.
    pub(crate) end: f64,
}

/// A method.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Method {
    pub(crate) stages: &'static [StageRule],
    /// Whether the torques of the last stage are removed about xⁿ⁺¹, which is then known, in place of
    /// the positions of the stage.
    pub(crate) lever_at_end: bool,
}

const fn with_start(share: f64, end: f64) -> StageRule {
    StageRule {
        combination: Combination::WithStart { share },
        end,
    }
}

const fn increment(memory: f64, share: f64, end: f64) -> StageRule {
    StageRule {
        combination: Combination::Increment { memory, share },
        end,
    }
}

/// (3.16), `[eq:tvd-rk2]`.
const TVD_RK2: Method = Method {
    stages: &[with_start(0.0, 1.0), with_start(0.5, 1.0)],
    lever_at_end: true,
};

/// Shu & Osher 1988: third order, strong stability preserving. `[eq:ssp-rk3]`
const SSP_RK3: Method = Method {
    stages: &[
        with_start(0.0, 1.0),
        with_start(0.75, 0.5),
        with_start(1.0 / 3.0, 1.0),
    ],
    lever_at_end: false,
};

/// Carpenter & Kennedy 1994 (NASA TM-109112), fourth order in five stages. `[eq:rk4]`
const RK4: Method = Method {
    stages: &[
        increment(
            0.0,
            1_432_997_174_477.0 / 9_575_080_441_755.0,
            1_432_997_174_477.0 / 9_575_080_441_755.0,
        ),
        increment(
            -567_301_805_773.0 / 1_357_537_059_087.0,
            5_161_836_677_717.0 / 13_612_068_292_357.0,
            2_526_269_341_429.0 / 6_820_363_962_896.0,
        ),
        increment(
            -2_404_267_990_393.0 / 2_016_746_695_238.0,
            1_720_146_321_549.0 / 2_090_206_949_498.0,
            2_006_345_519_317.0 / 3_224_310_063_776.0,
        ),
        increment(
            -3_550_918_686_646.0 / 2_091_501_179_385.0,
            3_134_564_353_537.0 / 4_481_467_310_338.0,
            2_802_321_613_138.0 / 2_924_317_926_251.0,
        ),
        increment(
            -1_275_806_237_668.0 / 842_570_457_699.0,
            2_277_821_191_437.0 / 14_882_151_754_819.0,
            1.0,
        ),
    ],
    lever_at_end: false,
};

impl Method {
    /// `None` for integrators that are no Runge-Kutta methods.
    pub(crate) fn of(integrator: Integrator) -> Option<Self> {
        match integrator {
            Integrator::Leapfrog => None,
            Integrator::TvdRungeKutta => Some(TVD_RK2),
            Integrator::SspRungeKutta => Some(SSP_RK3),
            Integrator::RungeKutta4 => Some(RK4),
        }
    }

    /// Whether a stage remembers the increment of the one before.
    pub(crate) fn has_increment(&self) -> bool {
        self.stages
            .iter()
            .any(|rule| matches!(rule.combination, Combination::Increment { .. }))
    }

    /// Part of a jump of the result of stage `i` that is left at the end of the step.
    pub(crate) fn remaining(&self, i: usize) -> f64 {
        self.stages[i + 1..]
            .iter()
            .map(|rule| match rule.combination {
                Combination::WithStart { share } => 1.0 - share,
                Combination::Increment { .. } => 1.0,
            })
            .product()
    }

    /// Weight b of the rates of stage `i` in the step: uⁿ⁺¹ = uⁿ + Δt Σ b_i R(u_i).
    pub(crate) fn weight(&self, i: usize) -> f64 {
        match self.stages[i].combination {
            Combination::WithStart { share } => (1.0 - share) * self.remaining(i),
            Combination::Increment { share, .. } => {
                let (mut kept, mut weight) = (1.0, share);
                for rule in &self.stages[i + 1..] {
                    if let Combination::Increment { memory, share } = rule.combination {
                        kept *= memory;
                        weight += kept * share;
                    }
                }
                weight
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const METHODS: [(Integrator, i32, &[f64]); 3] = [
        (Integrator::TvdRungeKutta, 2, &[0.5, 0.5]),
        (
            Integrator::SspRungeKutta,
            3,
            &[1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
        ),
        (Integrator::RungeKutta4, 4, &[]),
    ];

    /// One step of size `h` of a scalar equation u' = r(u), with the times at the stages.
    fn step(method: &Method, start: f64, h: f64, rate: impl Fn(f64) -> f64) -> f64 {
        let (mut u, mut d) = (start, 0.0);
        for rule in method.stages {
            match rule.combination {
                Combination::WithStart { share } => {
                    u = share * start + (1.0 - share) * (u + h * rate(u));
                }
                Combination::Increment { memory, share } => {
                    d = memory * d + h * rate(u);
                    u += share * d;
                }
            }
        }
        u
    }

    #[test]
    fn every_method_has_its_order_on_a_nonlinear_equation() {
        // u' = −u², u = 1/(1 + t).
        for (integrator, order, _) in METHODS {
            let method = Method::of(integrator).unwrap();
            let error = |steps: i32| {
                let h = 1.0 / f64::from(steps);
                let end = (0..steps).fold(1.0, |u, _| step(&method, u, h, |u| -u * u));
                (end - 0.5).abs()
            };
            let observed = (error(20) / error(40)).log2();
            assert!(
                (observed - f64::from(order)).abs() < 0.15,
                "{integrator:?}: {observed}"
            );
        }
    }

    #[test]
    fn weights_are_those_of_the_method_and_times_follow_from_the_stages() {
        for (integrator, _, weights) in METHODS {
            let method = Method::of(integrator).unwrap();
            let count = method.stages.len();
            let found: Vec<f64> = (0..count).map(|i| method.weight(i)).collect();
            assert!((found.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{found:?}");
            for (found, expected) in found.iter().zip(weights) {
                assert!((found - expected).abs() < 1e-15);
            }
            // u' = 1 ends every stage at its time.
            for i in 1..=count {
                let part = Method {
                    stages: &method.stages[..i],
                    ..method
                };
                let time = method.stages[i - 1].end;
                // Where the next stage averages, the paper's second stage starts from t + Δt.
                assert!((step(&part, 0.0, 1.0, |_| 1.0) - time).abs() < 1e-10, "{i}");
            }
            assert_eq!(method.remaining(count - 1), 1.0);
        }
    }
}
