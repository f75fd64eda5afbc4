//! The frames of a run and the collection that gives ParaView their times.

use std::io;
use std::path::{Path, PathBuf};

use crate::stored::attribute;
use crate::vtu::{escape_xml, unescape_xml};
use crate::{Frame, FrameOptions, HAS_VTKHDF, OutputError, atomic_write, write_vtkhdf, write_vtu};

/// Name of the collection inside the frames folder.
const COLLECTION: &str = "frames.pvd";

/// A `.pvd` collection: which file shows which time.
///
/// The file is rewritten atomically by [`Self::add`], so that it can be opened in ParaView while
/// the run goes on.
#[derive(Debug, Clone, PartialEq)]
pub struct Collection {
    path: PathBuf,
    entries: Vec<(f64, String)>,
}

impl Collection {
    /// An empty collection, to be written at `path` with the first frame.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_path_buf(),
            entries: Vec::new(),
        }
    }

    /// Reads the collection at `path` and forgets frames later than `time` (s); empty if there is no file.
    ///
    /// # Errors
    /// [`OutputError::Io`], [`OutputError::Collection`] for a file of another program.
    pub fn resume(path: &Path, time: f64) -> Result<Self, OutputError> {
        let mut collection = Self::new(path);
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(collection),
            Err(error) => return Err(OutputError::io("read", path)(error)),
        };
        for (index, line) in text.lines().enumerate() {
            if line.trim_start().starts_with("<DataSet") {
                let entry = parse_entry(line).ok_or_else(|| OutputError::Collection {
                    path: path.to_path_buf(),
                    line: index + 1,
                })?;
                collection.entries.push(entry);
            }
        }
        collection.entries.retain(|(t, _)| *t <= time);
        Ok(collection)
    }

    /// Reads the whole collection at `path`; empty if there is no file.
    ///
    /// # Errors
    /// Those of [`Self::resume`].
    pub fn read(path: &Path) -> Result<Self, OutputError> {
        Self::resume(path, f64::INFINITY)
    }

    /// Times (s) and files, relative to the collection, in the order they were added.
    pub fn entries(&self) -> &[(f64, String)] {
        &self.entries
    }

    /// Adds a frame and rewrites the file; an entry of the same file is replaced.
    ///
    /// # Errors
    /// [`OutputError::Io`].
    pub fn add(&mut self, time: f64, file: &str) -> Result<(), OutputError> {
        self.entries.retain(|(_, other)| other != file);
        self.entries.push((time, file.to_owned()));
        self.write()
    }

    fn write(&self) -> Result<(), OutputError> {
        atomic_write(&self.path, |writer| {
            writeln!(writer, "<?xml version=\"1.0\"?>")?;
            writeln!(
                writer,
                "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">"
            )?;
            writeln!(writer, "  <Collection>")?;
            for (time, file) in &self.entries {
                writeln!(
                    writer,
                    "    <DataSet timestep=\"{time:?}\" group=\"\" part=\"0\" file=\"{}\"/>",
                    escape_xml(file)
                )?;
            }
            writeln!(writer, "  </Collection>")?;
            writeln!(writer, "</VTKFile>")
        })
    }
}

fn parse_entry(line: &str) -> Option<(f64, String)> {
    let time = attribute(line, "timestep")?.parse().ok()?;
    Some((time, unescape_xml(attribute(line, "file")?)))
}

/// Writes `frame_000000.vtu`, `frame_000001.vtu`, ... and their collection `frames.pvd`.
#[derive(Debug)]
pub struct FrameSeries {
    folder: PathBuf,
    options: FrameOptions,
    collection: Collection,
    has_vtkhdf: bool,
}

impl FrameSeries {
    /// A new series in an existing folder.
    pub fn create(folder: &Path, options: FrameOptions) -> Self {
        Self {
            folder: folder.to_path_buf(),
            options,
            collection: Collection::new(&folder.join(COLLECTION)),
            has_vtkhdf: false,
        }
    }

    /// Writes every further frame as `frame_000000.vtkhdf` ... too.
    ///
    /// # Errors
    /// [`OutputError::NoVtkhdf`] unless [`HAS_VTKHDF`].
    pub fn with_vtkhdf(mut self) -> Result<Self, OutputError> {
        if !HAS_VTKHDF {
            return Err(OutputError::NoVtkhdf);
        }
        self.has_vtkhdf = true;
        Ok(self)
    }

    /// Continues a series after the frame at or before `time` (s); later frames, and a frame that a
    /// killed run had not yet put into the collection, are removed.
    ///
    /// # Errors
    /// Those of [`Collection::resume`]; [`OutputError::Io`].
    pub fn resume(folder: &Path, options: FrameOptions, time: f64) -> Result<Self, OutputError> {
        let collection = Collection::resume(&folder.join(COLLECTION), time)?;
        // First the list, then the files: the list never names a file that is not there.
        collection.write()?;
        let stem = |name: &str| name.split('.').next().unwrap_or_default().to_owned();
        let kept = |name: &str| {
            let is_listed = |(_, file): &(f64, String)| stem(file) == stem(name);
            name == COLLECTION || collection.entries.iter().any(is_listed)
        };
        let listing = std::fs::read_dir(folder).map_err(OutputError::io("list", folder))?;
        for entry in listing {
            let entry = entry.map_err(OutputError::io("list", folder))?;
            let name = entry.file_name();
            if name.to_str().is_some_and(|n| is_frame_file(n) && !kept(n)) {
                let path = entry.path();
                std::fs::remove_file(&path).map_err(OutputError::io("remove", &path))?;
            }
        }
        Ok(Self {
            folder: folder.to_path_buf(),
            options,
            collection,
            has_vtkhdf: false,
        })
    }

    /// Time (s) of the last frame, if there is one.
    pub fn last_time(&self) -> Option<f64> {
        self.collection.entries.last().map(|(time, _)| *time)
    }

    /// Writes the next frame, then the collection; returns the frame's path.
    ///
    /// # Errors
    /// Those of [`write_vtu`].
    pub fn write(&mut self, frame: &Frame) -> Result<PathBuf, OutputError> {
        let name = format!("frame_{:06}.vtu", self.collection.entries.len());
        let path = self.folder.join(&name);
        write_vtu(&path, frame, self.options)?;
        if self.has_vtkhdf {
            write_vtkhdf(&path.with_extension("vtkhdf"), frame, self.options)?;
        }
        self.collection.add(frame.time, &name)?;
        Ok(path)
    }
}

/// Whether a file of the frames folder is one this module writes.
pub(crate) fn is_frame_file(name: &str) -> bool {
    let number = name
        .strip_prefix("frame_")
        .and_then(|rest| rest.strip_suffix(".vtu").or(rest.strip_suffix(".vtkhdf")));
    name == COLLECTION
        || number.is_some_and(|n| n.len() >= 6 && n.bytes().all(|b| b.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use jstsph_tensor::Vec3;

    #[test]
    fn a_collection_is_resumed_without_the_frames_after_the_restart() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        let mut collection = Collection::new(&path);
        for (i, time) in [0.0, 0.1 + 0.2, 1e-300].into_iter().enumerate() {
            collection.add(time, &format!("a&b_{i}.vtu")).unwrap();
        }
        assert_eq!(Collection::read(&path).unwrap(), collection);
        let resumed = Collection::resume(&path, 0.3).unwrap();
        assert_eq!(
            resumed.entries(),
            [
                (0.0, "a&b_0.vtu".to_owned()),
                (1e-300, "a&b_2.vtu".to_owned())
            ]
        );
    }

    #[test]
    fn a_collection_is_well_formed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        Collection::new(&path).add(0.5, "frame_000000.vtu").unwrap();
        let expected = "<?xml version=\"1.0\"?>\n\
            <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  \
            <Collection>\n    \
            <DataSet timestep=\"0.5\" group=\"\" part=\"0\" file=\"frame_000000.vtu\"/>\n  \
            </Collection>\n\
            </VTKFile>\n";
        assert_eq!(std::fs::read_to_string(path).unwrap(), expected);
    }

    #[test]
    fn a_foreign_collection_is_refused_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.pvd");
        std::fs::write(&path, "<VTKFile>\n<DataSet file=\"x\"/>\n").unwrap();
        assert!(matches!(
            Collection::resume(&path, 1.0),
            Err(OutputError::Collection { line: 2, .. })
        ));
    }

    #[test]
    fn a_resumed_series_removes_the_frames_it_forgot() {
        let folder = tempfile::tempdir().unwrap();
        let positions = [Vec3::zeros()];
        let options = FrameOptions::default();
        let mut series = FrameSeries::create(folder.path(), options);
        for step in 0..4_u64 {
            let frame = Frame::new(step as f64, step, &positions);
            series.write(&frame).unwrap();
        }
        for number in [1, 3] {
            let name = format!("frame_00000{number}.vtkhdf");
            std::fs::write(folder.path().join(name), "x").unwrap();
        }
        let mut series = FrameSeries::resume(folder.path(), options, 1.5).unwrap();
        assert!(folder.path().join("frame_000001.vtkhdf").exists());
        assert!(!folder.path().join("frame_000003.vtkhdf").exists());
        assert_eq!(series.last_time(), Some(1.0));
        assert!(!folder.path().join("frame_000002.vtu").exists());
        assert_eq!(
            Collection::read(&folder.path().join(COLLECTION))
                .unwrap()
                .entries()
                .len(),
            2
        );
        let path = series.write(&Frame::new(1.75, 9, &positions)).unwrap();
        assert!(path.ends_with("frame_000002.vtu"));
        let collection = Collection::resume(&folder.path().join(COLLECTION), 10.0).unwrap();
        let times: Vec<f64> = collection.entries().iter().map(|(t, _)| *t).collect();
        assert_eq!(times, [0.0, 1.0, 1.75]);
    }

    #[test]
    fn only_our_own_files_are_recognised() {
        assert!(is_frame_file("frame_000012.vtkhdf") && !is_frame_file("frame_000012.hdf"));
        assert!(is_frame_file("frame_000012.vtu") && is_frame_file("frames.pvd"));
        assert!(!is_frame_file("frame_old.vtu") && !is_frame_file("view.pvsm"));
        assert!(!is_frame_file("frame_12.vtu") && !is_frame_file("other.pvd"));
    }
}
