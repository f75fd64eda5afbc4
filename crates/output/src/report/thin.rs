//! Which particles a report carries when not even one frame of all of them fits.

use crate::StoredFrame;

/// The kept particles in ascending order, and the faces between them.
pub(super) struct Thinned {
    pub(super) particles: Vec<usize>,
    /// Faces with corners counted among the kept particles; none if a corner of any was left out.
    pub(super) faces: Vec<[u32; 4]>,
}

impl Thinned {
    /// About `count` of all particles: those of the outer faces of a solid if they are no more than
    /// that, and of the others an even sample.
    pub(super) fn choose(all: usize, faces: &[[u32; 4]], count: usize) -> Self {
        let mut is_kept = vec![false; all];
        for &corner in faces.iter().flatten() {
            is_kept[corner as usize] = true;
        }
        let outer = is_kept.iter().filter(|kept| **kept).count();
        let has_faces = outer > 0 && outer <= count;
        let (inner, wanted) = if has_faces {
            (all - outer, count - outer)
        } else {
            is_kept.fill(false);
            (all, count)
        };
        let part = wanted as f64 / inner.max(1) as f64;
        for (particle, kept) in is_kept.iter_mut().enumerate() {
            *kept = *kept || scattered(particle as u64) < part;
        }
        let mut places = vec![0_u32; all];
        let mut particles = Vec::with_capacity(count);
        for particle in (0..all).filter(|particle| is_kept[*particle]) {
            #[expect(
                clippy::cast_possible_truncation,
                reason = "faces count in 32 bits, and there are fewer particles than before"
            )]
            {
                places[particle] = particles.len() as u32;
            }
            particles.push(particle);
        }
        let moved = |face: &[u32; 4]| face.map(|corner| places[corner as usize]);
        Self {
            particles,
            faces: if has_faces {
                faces.iter().map(moved).collect()
            } else {
                Vec::new()
            },
        }
    }

    /// The kept particles of a frame, without cells.
    pub(super) fn frame(&self, frame: &StoredFrame) -> StoredFrame {
        fn rows<T: Copy>(values: &[T], particles: &[usize]) -> Vec<T> {
            particles.iter().map(|particle| values[*particle]).collect()
        }
        fn fields<T: Copy>(all: &[(String, Vec<T>)], kept: &[usize]) -> Vec<(String, Vec<T>)> {
            let field = |(name, values): &(String, Vec<T>)| (name.clone(), rows(values, kept));
            all.iter().map(field).collect()
        }
        StoredFrame {
            time: frame.time,
            step: frame.step,
            positions: rows(&frame.positions, &self.particles),
            scalars: fields(&frame.scalars, &self.particles),
            vectors: fields(&frame.vectors, &self.particles),
            tensors: fields(&frame.tensors, &self.particles),
            ..StoredFrame::default()
        }
    }
}

/// A number from 0 to 1 that is the same for a particle in every report, and shows no pattern of
/// the lattice as every k-th particle would: splitmix64's finaliser of a counter.
fn scattered(particle: u64) -> f64 {
    let mut word = particle.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (word ^ (word >> 31)) as f64 / 2.0_f64.powi(64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sample_is_even_and_has_about_the_number_asked_for() {
        let thinned = Thinned::choose(100_000, &[], 20_000);
        assert!(thinned.particles.len().abs_diff(20_000) < 500);
        // Of every stretch the same part: five standard deviations of a binomial sample.
        for start in (0..100_000).step_by(10_000) {
            let inside = thinned
                .particles
                .iter()
                .filter(|p| (start..start + 10_000).contains(*p));
            assert!(inside.count().abs_diff(2_000) < 200);
        }
        assert!(thinned.particles.is_sorted());
    }

    #[test]
    fn the_outer_faces_stay_whole_or_go() {
        let faces = [[1, 3, 5, 7], [7, 9, 11, 1]];
        let whole = Thinned::choose(1000, &faces, 100);
        for (before, after) in faces.iter().zip(&whole.faces) {
            assert_eq!(
                after.map(|place| whole.particles[place as usize] as u32),
                *before
            );
        }
        assert!(whole.particles.len() > 50 && whole.particles.len() < 160);
        let without = Thinned::choose(1000, &faces, 3);
        assert!(without.faces.is_empty());
    }
}
