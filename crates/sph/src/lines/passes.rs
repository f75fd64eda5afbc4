//! Bringing fields into lines, and the two sums.

use jstsph_tensor::lanes::{Lanes, Simd, WithSimd, vectorised};

use super::{EMPTY, LaneRow, LineOperator, Lines, Side, WIDTH};

impl Lines<'_> {
    /// Brings a field into the lines of a piece, whose rows `out` are: `value(item)` has its components.
    ///
    /// # Panics
    /// If there are not as many rows: a bug in the caller.
    pub fn arrange<const N: usize>(
        &self,
        piece: usize,
        value: impl Fn(usize) -> [f64; N],
        out: &mut [LaneRow<N>],
    ) {
        let side = self.0;
        let (length, repeated) = (side.parts.length, side.parts.repeated);
        let lines = side.of_piece(piece);
        let rows = side.parts.rows_of_line();
        let items = &side.items[lines.start * length * WIDTH..lines.end * length * WIDTH];
        let items = items.chunks_exact(length * WIDTH);
        for (out, items) in out[..lines.len() * rows].chunks_exact_mut(rows).zip(items) {
            let own = &mut out[repeated..repeated + length];
            for (row, items) in own.iter_mut().zip(items.chunks_exact(WIDTH)) {
                for (lane, &item) in items.iter().enumerate() {
                    if item == EMPTY {
                        continue;
                    }
                    let components = value(item as usize);
                    for (lanes, component) in row.0.iter_mut().zip(components) {
                        lanes[lane] = component;
                    }
                }
            }
            for k in 0..repeated {
                // The end of the part before, one lane on, and the beginning of that after.
                let (before, after) = (out[length + k], out[repeated + k]);
                for (lanes, before) in out[k].0.iter_mut().zip(before.0) {
                    lanes[1..].copy_from_slice(&before[..WIDTH - 1]);
                }
                let last = &mut out[repeated + length + k];
                for (lanes, after) in last.0.iter_mut().zip(after.0) {
                    lanes[..WIDTH - 1].copy_from_slice(&after[1..]);
                }
            }
        }
    }
}

impl LineOperator {
    /// Gradients of a vector field of the particles, times `factor`, at the points of a piece, whose rows
    /// `out` are: columns of tensors, in space 11, 21, 31, 12, 22, 32, 13, 23, 33. Vectors have D
    /// components and tensors T = D², with D = 2 in plane strain and 3 in space.
    ///
    /// # Panics
    /// If there are not as many rows: a bug in the caller.
    pub fn gradients<const D: usize, const T: usize>(
        &self,
        piece: usize,
        field: &[LaneRow<D>],
        factor: f64,
        out: &mut [LaneRow<T>],
    ) {
        const { assert!(T == D * D && (D == 2 || D == 3)) };
        vectorised(Gradients {
            side: &self.points,
            piece,
            field,
            factor,
            out,
        });
    }

    /// Σ_q S_q B_qc of a tensor field of the points at the particles of a piece, whose rows `out` are.
    ///
    /// # Panics
    /// If there are not as many rows: a bug in the caller.
    pub fn divergences<const D: usize, const T: usize>(
        &self,
        piece: usize,
        tensors: &[LaneRow<T>],
        out: &mut [LaneRow<D>],
    ) {
        const { assert!(T == D * D && (D == 2 || D == 3)) };
        vectorised(Divergences {
            side: &self.particles,
            piece,
            tensors,
            out,
        });
    }
}

struct Gradients<'a, const D: usize, const T: usize> {
    side: &'a Side,
    piece: usize,
    field: &'a [LaneRow<D>],
    factor: f64,
    out: &'a mut [LaneRow<T>],
}

impl<const D: usize, const T: usize> WithSimd for Gradients<'_, D, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let side = self.side;
        for (block, at) in side.blocks(self.piece) {
            let row = side.sums.row(block);
            let field = &self.field[row.first..];
            for pack in (0..WIDTH).step_by(S::F64_LANES) {
                let mut sums = [Lanes::splat(simd, 0.0); T];
                for (&step, w) in row.steps.iter().zip(row.weights) {
                    let from = &field[step as usize].0;
                    let mut f = [Lanes::splat(simd, 0.0); D];
                    for i in 0..D {
                        f[i] = Lanes::from_slice(simd, &from[i][pack..]);
                    }
                    for j in 0..D {
                        for i in 0..D {
                            sums[D * j + i] = sums[D * j + i] + f[i] * w[j];
                        }
                    }
                }
                for (sum, lanes) in sums.into_iter().zip(&mut self.out[at].0) {
                    (sum * self.factor).to_slice(&mut lanes[pack..]);
                }
            }
        }
    }
}

struct Divergences<'a, const D: usize, const T: usize> {
    side: &'a Side,
    piece: usize,
    tensors: &'a [LaneRow<T>],
    out: &'a mut [LaneRow<D>],
}

impl<const D: usize, const T: usize> WithSimd for Divergences<'_, D, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let side = self.side;
        for (block, at) in side.blocks(self.piece) {
            let row = side.sums.row(block);
            let tensors = &self.tensors[row.first..];
            for pack in (0..WIDTH).step_by(S::F64_LANES) {
                // In the order of the single rows: column by column in space, row by row in the plane.
                let mut sums = [Lanes::splat(simd, 0.0); T];
                for (&step, w) in row.steps.iter().zip(row.weights) {
                    let from = &tensors[step as usize].0;
                    if D == 3 {
                        for k in 0..T {
                            let s = Lanes::from_slice(simd, &from[k][pack..]);
                            sums[k] = sums[k] + s * w[k / D];
                        }
                    } else {
                        for i in 0..D {
                            let first = Lanes::from_slice(simd, &from[i][pack..]);
                            let second = Lanes::from_slice(simd, &from[D + i][pack..]);
                            sums[i] = sums[i] + (first * w[0] + second * w[1]);
                        }
                    }
                }
                for i in 0..D {
                    let sum = if D == 3 {
                        sums[i] + sums[D + i] + sums[T - D + i]
                    } else {
                        sums[i]
                    };
                    sum.to_slice(&mut self.out[at].0[i][pack..]);
                }
            }
        }
    }
}

impl Side {
    /// Blocks of a piece, and their rows from the first of the piece.
    #[inline(always)]
    fn blocks(&self, piece: usize) -> impl Iterator<Item = (usize, usize)> {
        let (parts, lines) = (self.parts, self.of_piece(piece));
        let first = lines.start;
        lines.flat_map(move |line| {
            let at = (line - first) * parts.rows_of_line() + parts.repeated;
            (0..parts.length).map(move |row| (line * parts.length + row, at + row))
        })
    }
}
