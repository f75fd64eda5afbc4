//! Frames as VTKHDF files, in programs built with the feature `vtkhdf`.
//!
//! Source: VTK's documentation, "VTKHDF file format", version 2.2, unstructured grids.

use std::path::Path;

use crate::{Frame, FrameOptions, OutputError};

/// Whether this program can write VTKHDF files: it was built with the feature `vtkhdf`.
pub const HAS_VTKHDF: bool = cfg!(feature = "vtkhdf");

/// Writes one frame as a VTKHDF unstructured grid, atomically.
///
/// The field data `TimeValue` (s) and `Step` carry the instant. Points, cells, fields and their components are those of [`write_vtu`](crate::write_vtu), with the
/// same bits.
///
/// # Errors
/// Those of [`write_vtu`](crate::write_vtu); [`OutputError::NoVtkhdf`] unless [`HAS_VTKHDF`].
///
/// # Cost
/// The arrays are held in memory until the file is complete.
pub fn write_vtkhdf(path: &Path, frame: &Frame, options: FrameOptions) -> Result<(), OutputError> {
    #[cfg(feature = "vtkhdf")]
    return file::write(path, frame, options);
    #[cfg(not(feature = "vtkhdf"))]
    {
        let _ = (path, frame, options);
        Err(OutputError::NoVtkhdf)
    }
}

#[cfg(feature = "vtkhdf")]
mod file {
    use std::io;
    use std::path::Path;

    use hdf5_pure::{AttrValue, DatasetBuilder, Error, FileBuilder};

    use crate::frame::{Components, flatten_range};
    use crate::vtu::CellArrays;
    use crate::{Frame, FrameOptions, OutputError, Precision, Values, atomic_write};

    /// Values of a compressed chunk, at most.
    const CHUNK: usize = 1 << 16;

    pub(super) fn write(
        path: &Path,
        frame: &Frame,
        options: FrameOptions,
    ) -> Result<(), OutputError> {
        frame.check_form()?;
        let cells = CellArrays::new(frame, options.cells)?;
        let file = build(frame, &cells, options)?;
        atomic_write(path, |writer| {
            file.finish_to(writer).map_err(|error| match error {
                Error::Io(error) => error,
                other => io::Error::other(other),
            })
        })
    }

    fn build(
        frame: &Frame,
        cells: &CellArrays,
        options: FrameOptions,
    ) -> Result<FileBuilder, OutputError> {
        let mut file = FileBuilder::new();
        let mut grid = file.create_group("VTKHDF");
        grid.set_attr("Version", AttrValue::I64Array(vec![2, 2]));
        grid.set_attr(
            "Type",
            AttrValue::AsciiString("UnstructuredGrid".to_owned()),
        );
        let mut count = |name: &str, number: usize| {
            grid.create_dataset(name).with_i64_data(&[number as i64]);
        };
        count("NumberOfPoints", frame.positions.len());
        count("NumberOfCells", cells.count());
        count("NumberOfConnectivityIds", cells.corners());
        let whole = |dataset: &mut DatasetBuilder, values: usize| {
            compress(dataset, &[values], options);
        };
        let connectivity = grid.create_dataset("Connectivity");
        let corners = cells.connectivity(0..cells.corners());
        whole(connectivity.with_i64_data(&corners), corners.len());
        // Here the list of ends has a beginning.
        let ends = cells.ends(0..cells.count());
        let offsets: Vec<i64> = [0].into_iter().chain(ends).collect();
        whole(
            grid.create_dataset("Offsets").with_i64_data(&offsets),
            offsets.len(),
        );
        let types = vec![cells.kind(); cells.count()];
        whole(
            grid.create_dataset("Types").with_u8_data(&types),
            types.len(),
        );
        floats(
            grid.create_dataset("Points"),
            "position",
            &frame.positions,
            options,
        )?;

        let mut data = grid.create_group("PointData");
        for (name, values) in &frame.scalars {
            floats(data.create_dataset(name), name, values, options)?;
        }
        for (name, values) in &frame.vectors {
            floats(data.create_dataset(name), name, values, options)?;
        }
        for (name, values) in &frame.tensors {
            floats(data.create_dataset(name), name, values, options)?;
        }
        grid.add_group(data.finish());

        // VTK reads no time from steps unless there are two.
        let mut instant = grid.create_group("FieldData");
        instant
            .create_dataset("TimeValue")
            .with_f64_data(&[frame.time]);
        instant
            .create_dataset("Step")
            .with_i64_data(&[frame.step as i64]);
        grid.add_group(instant.finish());
        file.add_group(grid.finish());
        Ok(file)
    }

    fn floats<T: Components>(
        dataset: &mut DatasetBuilder,
        name: &str,
        values: &Values<'_, T>,
        options: FrameOptions,
    ) -> Result<(), OutputError> {
        let width = T::NAMES.len().max(1);
        let largest = options.precision.largest();
        let flat = flatten_range(name, values, 0..values.len() * width, largest)?;
        match options.precision {
            #[expect(clippy::cast_possible_truncation, reason = "asked for, and in range")]
            Precision::F32 => {
                let single: Vec<f32> = flat.iter().map(|value| *value as f32).collect();
                dataset.with_f32_data(&single)
            }
            Precision::F64 => dataset.with_f64_data(&flat),
        };
        match T::NAMES.len() {
            0 => compress(dataset, &[values.len()], options),
            components => compress(dataset, &[values.len(), components], options),
        }
        Ok(())
    }

    /// Shape of an array, in compressed chunks of whole rows if asked for.
    fn compress(dataset: &mut DatasetBuilder, shape: &[usize], options: FrameOptions) {
        let wide = |shape: &[usize]| -> Vec<u64> { shape.iter().map(|n| *n as u64).collect() };
        dataset.with_shape(&wide(shape));
        if options.compression && shape[0] > 0 {
            let mut chunk = shape.to_vec();
            let row: usize = shape[1..].iter().product();
            chunk[0] = chunk[0].min(CHUNK / row);
            dataset
                .with_chunks(&wide(&chunk))
                .with_shuffle()
                .with_deflate(1);
        }
    }

    #[cfg(test)]
    mod tests {
        use super::*;
        use crate::frame::flatten;
        use crate::{CellKind, Lattice};
        use jstsph_tensor::{Mat3, Vec3};

        #[test]
        fn every_bit_comes_back() {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a.vtkhdf");
            let positions: Vec<Vec3> = (0..4)
                .map(|i| Vec3::new(0.1, f64::from(i), 1e-300))
                .collect();
            let stress = vec![Mat3::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0); 4];
            let frame = Frame::new(0.1 + 0.2, 7, &positions[..])
                .scalar("jacobian", vec![0.1, 0.2, 0.3, -0.4])
                .tensor("stress", &stress[..])
                .lattice(Lattice::Quads(&[[0, 1, 2, 3]]));
            for compression in [false, true] {
                let options = FrameOptions {
                    compression,
                    cells: CellKind::Lattice,
                    ..FrameOptions::default()
                };
                write(&path, &frame, options).unwrap();
                let file = hdf5_pure::File::open(&path).unwrap();
                let numbers = |name: &str| file.dataset(&format!("VTKHDF/{name}")).unwrap();
                assert_eq!(numbers("Points").read_f64().unwrap(), flatten(&positions));
                assert_eq!(numbers("Points").shape().unwrap(), [4, 3]);
                assert_eq!(numbers("PointData/stress").shape().unwrap(), [4, 9]);
                assert_eq!(
                    numbers("PointData/stress").read_f64().unwrap(),
                    flatten(&stress)
                );
                assert_eq!(numbers("PointData/jacobian").read_f64().unwrap()[3], -0.4);
                assert_eq!(numbers("Offsets").read_i64().unwrap(), [0, 4]);
                assert_eq!(numbers("Connectivity").read_i64().unwrap(), [0, 1, 2, 3]);
                assert_eq!(
                    numbers("FieldData/TimeValue").read_f64().unwrap(),
                    [0.1 + 0.2]
                );
            }
        }
    }
}

#[cfg(all(test, not(feature = "vtkhdf")))]
mod tests {
    use super::*;

    #[test]
    fn a_program_without_the_feature_says_how_to_build_one_with_it() {
        let frame = Frame::new(0.0, 0, Vec::new());
        let error = write_vtkhdf(Path::new("a"), &frame, FrameOptions::default()).unwrap_err();
        assert!(error.to_string().contains("--features vtkhdf"), "{error}");
    }
}
