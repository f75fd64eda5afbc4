//! The entries of a field: all at once, or piece by piece.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Appends the entries of some particles.
type Read<'a, T> = dyn Fn(Range<usize>, &mut Vec<T>) + Send + Sync + 'a;

/// One entry per particle.
#[derive(Clone)]
pub enum Values<'a, T: Clone> {
    /// All of them in memory, borrowed or owned.
    Slice(Cow<'a, [T]>),
    /// Computed when they are written.
    Pieces(Pieces<'a, T>),
}

/// Entries that are computed when they are read, so that a field of a large run is never in memory as
/// a whole.
#[derive(Clone)]
pub struct Pieces<'a, T> {
    length: usize,
    read: Arc<Read<'a, T>>,
}

impl<'a, T: Clone> Values<'a, T> {
    /// `length` entries of which `read` appends those of a range, always the same; ranges are read in any
    /// order, and by several threads.
    pub fn pieces(
        length: usize,
        read: impl Fn(Range<usize>, &mut Vec<T>) + Send + Sync + 'a,
    ) -> Self {
        Self::Pieces(Pieces {
            length,
            read: Arc::new(read),
        })
    }

    /// Number of entries.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Slice(values) => values.len(),
            Self::Pieces(pieces) => pieces.length,
        }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Some of the entries.
    ///
    /// # Panics
    /// If there are not as many.
    #[must_use]
    pub fn get(&self, range: Range<usize>) -> Cow<'_, [T]> {
        match self {
            Self::Slice(values) => Cow::Borrowed(&values[range]),
            Self::Pieces(pieces) => {
                let mut values = Vec::with_capacity(range.len());
                (pieces.read)(range, &mut values);
                Cow::Owned(values)
            }
        }
    }
}

impl<T: Clone> fmt::Debug for Values<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} values", self.len())
    }
}

impl<'a, T: Clone> From<Vec<T>> for Values<'a, T> {
    fn from(values: Vec<T>) -> Self {
        Self::Slice(Cow::Owned(values))
    }
}

impl<'a, T: Clone> From<&'a [T]> for Values<'a, T> {
    fn from(values: &'a [T]) -> Self {
        Self::Slice(Cow::Borrowed(values))
    }
}

impl<'a, T: Clone> From<&'a Vec<T>> for Values<'a, T> {
    fn from(values: &'a Vec<T>) -> Self {
        Self::Slice(Cow::Borrowed(values))
    }
}

impl<'a, T: Clone, const N: usize> From<&'a [T; N]> for Values<'a, T> {
    fn from(values: &'a [T; N]) -> Self {
        Self::Slice(Cow::Borrowed(values))
    }
}
