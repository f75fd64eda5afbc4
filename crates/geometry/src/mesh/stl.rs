//! Reading STL files.

use std::io::Cursor;

use jstsph_tensor::Vec3;

use crate::GeometryError;

/// Bytes before the triangles of a binary file, and of each triangle.
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Points and triangles of an STL file, three points for every triangle.
pub(super) fn read(bytes: &[u8]) -> Result<(Vec<Vec3>, Vec<[usize; 3]>), GeometryError> {
    let unreadable = |reason: String| GeometryError::UnreadableMesh { reason };
    let mut bytes = bytes.to_vec();
    // Some programs begin binary files with the word that marks a text.
    if let Some(count) = bytes.get(HEADER - 4..HEADER) {
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]) as usize;
        if bytes.len() == HEADER + TRIANGLE * count {
            bytes[..5].fill(b' ');
        }
    }
    let mut cursor = Cursor::new(bytes);
    let reader =
        stl_io::create_stl_reader(&mut cursor).map_err(|error| unreadable(error.to_string()))?;
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for triangle in reader {
        let triangle = triangle.map_err(|error| unreadable(error.to_string()))?;
        let first = points.len();
        for corner in 0..3 {
            let [x, y, z] = triangle.vertices[corner].0;
            points.push(Vec3::new(f64::from(x), f64::from(y), f64::from(z)));
        }
        triangles.push([first, first + 1, first + 2]);
    }
    Ok((points, triangles))
}
