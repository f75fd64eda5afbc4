//! Shapes, particle lattices with exact volumes, selections and neighbour search for particle methods.
