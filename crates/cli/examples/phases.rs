//! What each phase of a step costs when nothing disturbs it: the fastest of many steps, phase by phase.
//!
//! ```text
//! cargo run --release -p jstsph-cli --example phases -- CASE [STEPS] [THREADS] [KEY=VALUE]...
//! ```
//!
//! A busy machine makes most steps slow and hardly ever all of them, so that this can be measured beside
//! other work, unlike the sums of `jstsph run --profile`. STEPS that are not counted come first, as many.
#![allow(clippy::print_stdout, reason = "an example talks to its reader")]

use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use jstsph_solver::{Phase, PhaseObserver, Simulation};

/// The step under way.
#[derive(Debug)]
struct Laps {
    /// When the last phase ended.
    last: Instant,
    /// The time of each phase.
    times: [Duration; Phase::ALL.len()],
    /// The phases in their order.
    order: Vec<Phase>,
}

impl Laps {
    fn start() -> Self {
        Self {
            last: Instant::now(),
            times: Default::default(),
            order: Vec::new(),
        }
    }
}

#[derive(Debug)]
struct Clock(Mutex<Laps>);

impl PhaseObserver for Clock {
    // `docs/figures/instructions` counts the instructions between two calls of this function.
    #[inline(never)]
    fn finished(&self, phase: Phase) {
        if let Ok(mut laps) = self.0.lock() {
            let now = Instant::now();
            let passed = now - laps.last;
            laps.last = now;
            laps.times[phase as usize] += passed;
            laps.order.push(phase);
        }
    }
}

impl Clock {
    /// The phases since the last call.
    fn take(&self) -> Laps {
        self.0.lock().map_or_else(
            |_| Laps::start(),
            |mut laps| std::mem::replace(&mut *laps, Laps::start()),
        )
    }
}

/// What is said when something is wrong; it may come from another thread.
type Problem = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<(), Problem> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let path = arguments.first().ok_or("which case?")?;
    let steps: usize = arguments.get(1).map_or(Ok(200), |text| text.parse())?;
    let threads: usize = arguments.get(2).map_or(Ok(1), |text| text.parse())?;
    let overrides: Vec<(String, String)> = arguments
        .iter()
        .skip(3)
        .filter_map(|text| text.split_once('='))
        .map(|(key, value)| (key.to_owned(), value.to_owned()))
        .collect();
    let case = jstsph_case::load(Path::new(path), &overrides)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    pool.install(|| measure(Simulation::new(case.model)?, case.time.end, steps))
}

fn measure(mut simulation: Simulation, end: f64, steps: usize) -> Result<(), Problem> {
    let clock = Arc::new(Clock(Mutex::new(Laps::start())));
    for _ in 0..steps {
        simulation.advance_step(end)?;
    }
    simulation.watch(clock.clone());
    let mut fastest = [Duration::MAX; Phase::ALL.len()];
    let mut step = Duration::MAX;
    let mut order = Vec::new();
    for _ in 0..steps {
        clock.take();
        simulation.advance_step(end)?;
        let laps = clock.take();
        step = step.min(laps.times.iter().sum());
        for (fastest, lap) in fastest.iter_mut().zip(laps.times) {
            *fastest = (*fastest).min(lap);
        }
        order = laps.order;
    }
    let reference = simulation.reference();
    let (particles, points) = (reference.position.len(), reference.point_volume.len());
    println!(
        "{particles} particles, {points} points, {:.1} particles in the sum of a point",
        reference.neighbours_per_point()
    );
    println!("{:<14} {:>12} {:>10}", "phase", "ns/particle", "ns/point");
    let row = |name: &str, time: Duration| {
        let nanoseconds = time.as_secs_f64() * 1e9;
        let [particle, point] = [particles, points].map(|count| nanoseconds / count as f64);
        println!("{name:<14} {particle:>12.1} {point:>10.1}");
    };
    for (phase, time) in Phase::ALL.iter().zip(fastest) {
        row(phase.name(), time);
    }
    row("all", fastest.iter().sum());
    row("fastest step", step);
    let order: Vec<&str> = order.into_iter().map(Phase::name).collect();
    println!("order: {}", order.join(", "));
    Ok(())
}
