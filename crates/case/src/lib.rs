//! Case files of jstsph: a TOML schema with units, checked and turned into a simulation.
