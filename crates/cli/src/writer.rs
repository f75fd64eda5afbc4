//! Frames, and restart files, are written by a thread of their own while the run goes on; those of large runs by the threads
//! of the run, field by field.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;

use jstsph_geometry::{Body, Cells};
use jstsph_output::{Frame, FrameSeries, Lattice, OutputError};
use jstsph_solver::Simulation;

/// Cells of all bodies with indices into the whole simulation.
pub(crate) enum OwnedCells {
    None,
    /// Those of the only body.
    Of(Arc<Body>),
    Quads(Vec<[u32; 4]>),
    Hexahedra(Vec<[u32; 8]>),
}

impl OwnedCells {
    pub(crate) fn of(simulation: &Simulation) -> Self {
        if let [only] = &simulation.reference().bodies[..] {
            return if only.body.cells.is_empty() {
                Self::None
            } else {
                Self::Of(Arc::clone(&only.body))
            };
        }
        let (mut quads, mut hexes) = (Vec::new(), Vec::new());
        for body in &simulation.reference().bodies {
            let first = body.particles.start as u32;
            match &body.body.cells {
                Cells::Quads(cells) => {
                    quads.extend(cells.iter().map(|cell| cell.map(|a| a + first)))
                }
                Cells::Hexes(cells) => {
                    hexes.extend(cells.iter().map(|cell| cell.map(|a| a + first)))
                }
            }
            if body.body.cells.is_empty() {
                return Self::None;
            }
        }
        if hexes.is_empty() {
            Self::Quads(quads)
        } else {
            Self::Hexahedra(hexes)
        }
    }

    fn borrowed(&self) -> Lattice<'_> {
        match self {
            Self::None => Lattice::None,
            Self::Of(body) => match &body.cells {
                Cells::Quads(cells) => Lattice::Quads(cells),
                Cells::Hexes(cells) => Lattice::Hexahedra(cells),
            },
            Self::Quads(cells) => Lattice::Quads(cells),
            Self::Hexahedra(cells) => Lattice::Hexahedra(cells),
        }
    }
}

/// Writes the frames of a run.
pub(crate) enum Writer {
    /// Of a small run.
    Beside(Box<Thread>),
    /// Of a large run: a copy of its fields would need a fifth of the memory of all the rest.
    Within(Box<Series>),
}

/// A series of frames and the cells of every one of them.
pub(crate) struct Series {
    frames: FrameSeries,
    cells: OwnedCells,
    last_frame: Option<f64>,
}

impl Series {
    pub(crate) fn new(frames: FrameSeries, cells: OwnedCells) -> Self {
        Self {
            last_frame: frames.last_time(),
            frames,
            cells,
        }
    }

    /// Writes a frame, which comes without its cells.
    ///
    /// # Errors
    /// Those of [`FrameSeries::write`].
    fn write(&mut self, frame: Frame<'_>) -> Result<PathBuf, OutputError> {
        self.last_frame = Some(frame.time);
        self.frames.write(&frame.lattice(self.cells.borrowed()))
    }
}

impl Writer {
    /// Time (s) of the last frame given to it.
    pub(crate) fn last_frame(&self) -> Option<f64> {
        match self {
            Self::Beside(thread) => thread.last_frame,
            Self::Within(series) => series.last_frame,
        }
    }

    /// Waits until everything is written.
    ///
    /// # Errors
    /// The first error there was.
    pub(crate) fn wait(&mut self) -> Result<(), OutputError> {
        match self {
            Self::Beside(thread) => thread.wait(),
            Self::Within(_) => Ok(()),
        }
    }

    /// Has a frame, without its cells, written: `whole` makes one that holds all its fields, `lazy` one
    /// that computes them while they are written.
    ///
    /// # Errors
    /// Of this frame, if it is not finite; of an earlier one.
    pub(crate) fn frame<'a>(
        &mut self,
        whole: impl FnOnce() -> Frame<'static>,
        lazy: impl FnOnce() -> Frame<'a>,
    ) -> Result<(), OutputError> {
        match self {
            Self::Beside(thread) => thread.frame(whole()),
            Self::Within(series) => series.write(lazy()).map(|_| ()),
        }
    }
}

/// Something to be written.
type Job = Box<dyn FnOnce(&mut Series) -> Result<PathBuf, OutputError> + Send>;

/// Writes what it is given in that order, one thing at a time. Another is only accepted when none waits but
/// one, so that no more than three are held in memory.
///
/// An error reaches whoever gives it the next, or waits for the last; nothing is written after it.
pub(crate) struct Thread {
    /// Where it writes, for its messages.
    folder: PathBuf,
    jobs: Option<SyncSender<Job>>,
    done: Receiver<Result<PathBuf, OutputError>>,
    handle: Option<JoinHandle<()>>,
    /// Frames given whose outcome has not been received.
    open: usize,
    last_frame: Option<f64>,
}

impl Thread {
    /// Starts the thread for a series of frames in a folder.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub(crate) fn start(mut series: Series, folder: PathBuf) -> Result<Self, OutputError> {
        let last_frame = series.last_frame;
        // One waits, so that a state that follows a frame does not make the run wait.
        let (jobs, queue) = sync_channel::<Job>(1);
        let (report, done) = channel();
        let handle = std::thread::Builder::new()
            .name("writer".to_owned())
            .spawn(move || {
                for job in queue {
                    let outcome = job(&mut series);
                    let failed = outcome.is_err();
                    if report.send(outcome).is_err() || failed {
                        return;
                    }
                }
            })
            .map_err(|source| OutputError::Io {
                action: "start a thread that writes",
                path: folder.clone(),
                source,
            })?;
        Ok(Self {
            folder,
            jobs: Some(jobs),
            done,
            handle: Some(handle),
            open: 0,
            last_frame,
        })
    }

    /// Has a frame, without its cells, written.
    ///
    /// # Errors
    /// Of this frame, if it is not finite; of an earlier one.
    fn frame(&mut self, frame: Frame<'static>) -> Result<(), OutputError> {
        frame.check()?;
        self.last_frame = Some(frame.time);
        self.give(Box::new(move |series| series.write(frame)))
    }

    /// Has something written after everything that was given before.
    ///
    /// # Errors
    /// Of an earlier one.
    pub(crate) fn give(&mut self, job: Job) -> Result<(), OutputError> {
        while let Ok(outcome) = self.done.try_recv() {
            self.received(outcome)?;
        }
        let jobs = self.jobs.as_ref();
        if jobs.is_some_and(|jobs| jobs.send(job).is_ok()) {
            self.open += 1;
            return Ok(());
        }
        // The thread has ended, with an error that may have come while this one waited.
        self.wait()?;
        Err(self.lost())
    }

    /// Waits until everything is written.
    ///
    /// # Errors
    /// The first error there was.
    pub(crate) fn wait(&mut self) -> Result<(), OutputError> {
        while self.open > 0 {
            let outcome = self.done.recv().map_err(|_| self.lost())?;
            self.received(outcome)?;
        }
        Ok(())
    }

    /// Takes note of an outcome; after an error nothing more is accepted.
    fn received(&mut self, outcome: Result<PathBuf, OutputError>) -> Result<(), OutputError> {
        self.open -= 1;
        if outcome.is_err() {
            self.jobs = None;
        }
        outcome.map(|_| ())
    }

    fn lost(&self) -> OutputError {
        OutputError::Io {
            action: "write",
            path: self.folder.clone(),
            source: std::io::Error::other("the thread that writes has ended"),
        }
    }
}

impl Drop for Thread {
    /// Lets the thread finish what it was given.
    fn drop(&mut self) {
        self.jobs = None;
        if let Some(handle) = self.handle.take() {
            // A panic of the thread has been printed and shows as a lost thread above.
            let _ = handle.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_output::FrameOptions;
    use jstsph_tensor::Vec3;

    fn series(folder: &std::path::Path) -> Series {
        let frames = FrameSeries::create(folder, FrameOptions::default());
        Series::new(frames, OwnedCells::None)
    }

    fn writer(folder: &std::path::Path) -> Thread {
        Thread::start(series(folder), folder.to_path_buf()).unwrap()
    }

    fn frame(time: f64) -> Frame<'static> {
        Frame::new(time, 0, vec![Vec3::x() * time; 1000])
    }

    #[test]
    fn frames_are_written_in_the_order_they_are_given() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = writer(folder.path());
        for step in 0..5 {
            writer.frame(frame(f64::from(step))).unwrap();
        }
        writer.wait().unwrap();
        assert_eq!(writer.last_frame, Some(4.0));
        let collection =
            jstsph_output::Collection::read(&folder.path().join("frames.pvd")).unwrap();
        let times: Vec<f64> = collection.entries().iter().map(|(time, _)| *time).collect();
        assert_eq!(times, [0.0, 1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn dropping_it_finishes_what_it_was_given() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = writer(folder.path());
        writer.frame(frame(1.0)).unwrap();
        drop(writer);
        assert!(folder.path().join("frame_000000.vtu").exists());
    }

    #[test]
    fn an_error_reaches_the_next_that_comes() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = writer(&folder.path().join("missing"));
        writer.frame(frame(1.0)).unwrap();
        let error = writer.wait().unwrap_err();
        assert!(error.to_string().contains("missing"), "{error}");
        let error = writer.frame(frame(2.0)).unwrap_err();
        assert!(error.to_string().contains("has ended"), "{error}");
    }

    #[test]
    fn a_frame_that_is_not_finite_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = writer(folder.path());
        let error = writer.frame(frame(f64::NAN)).unwrap_err();
        assert!(matches!(error, OutputError::NotFinite { .. }), "{error}");
        writer.frame(frame(1.0)).unwrap();
        writer.wait().unwrap();
    }

    #[test]
    fn both_ways_write_the_same_file() {
        let folders = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
        let lazy = || {
            let read = |range: std::ops::Range<usize>, out: &mut Vec<Vec3>| {
                out.extend(range.map(|_| Vec3::x() * 2.0));
            };
            Frame::new(2.0, 0, jstsph_output::Values::pieces(1000, read))
        };
        let mut writers = [
            Writer::Beside(Box::new(writer(folders[0].path()))),
            Writer::Within(Box::new(series(folders[1].path()))),
        ];
        let bytes: Vec<Vec<u8>> = writers
            .iter_mut()
            .zip(&folders)
            .map(|(writer, folder)| {
                writer.frame(|| frame(2.0), lazy).unwrap();
                writer.wait().unwrap();
                assert_eq!(writer.last_frame(), Some(2.0));
                std::fs::read(folder.path().join("frame_000000.vtu")).unwrap()
            })
            .collect();
        assert_eq!(bytes[0], bytes[1]);
    }
}
