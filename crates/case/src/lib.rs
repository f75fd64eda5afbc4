//! Case files of jstsph: TOML with units, checked and turned into a simulation.
//!
//! [`load`] reads a file, [`parse`] a text; both give a [`Case`] or a [`CaseError`] that names file,
//! line, value and what is allowed. A plain number is in SI units, a text carries its unit and is
//! checked for its dimension. [`lists`] says everything that can be written.
//!
//! ```
//! let text = r#"
//! title = "A block pushed down"
//! dimension = "plane-strain"
//!
//! [time]
//! end = "10 ms"
//!
//! [[body]]
//! name = "block"
//! shape = { box = { min = [0, 0], max = ["1 m", "50 cm"] } }
//! lattice = { counts = [21, 11] }
//! material = "copper_taylor"
//!
//! [[boundary]]
//! where = "block.bottom"
//! roller = "y"
//!
//! [[boundary]]
//! where = { and = ["top", { half_space = { point = [0.5, 0], normal = [1, 0] } }] }
//! velocity = { y = { expression = "-10 * tanh(t / 1e-4)" } }
//! "#;
//! let overrides = [("time.end".to_owned(), "5 ms".to_owned())];
//! let case = jstsph_case::parse("block", "block.toml", text, &overrides)?;
//! assert_eq!(case.particles(), 231);
//! assert_eq!(case.time.end, 5e-3);
//! assert_eq!(case.model.conditions[1].particles.len(), 11);
//!
//! let mistake = jstsph_case::parse("block", "block.toml", &text.replace("counts", "conuts"), &[]).unwrap_err();
//! let message = mistake.to_string();
//! assert!(message.starts_with("block.toml:11:13: unknown key `conuts` in body.block.lattice"));
//! assert!(message.ends_with("did you mean `counts`?"));
//! # Ok::<(), jstsph_case::CaseError>(())
//! ```

mod body;
mod boundary;
mod case;
mod document;
mod drawing;
mod error;
mod include;
mod inputs;
mod json_schema;
mod list;
mod markdown;
mod material;
mod obstacle;
mod parameters;
mod plausibility;
mod probe;
mod resolved;
mod scheme;
mod section;
mod selection;
mod shape;
mod signal;
mod stl;
mod suggestion;
mod value;

pub mod expression;
pub mod schema;
pub mod units;

pub use case::{
    Case, FrameCells, FrameFormat, Interval, OutputSettings, Precision, TimeSettings, load, parse,
};
pub use error::{CaseError, InputError, Place};
pub use inputs::InputFile;
pub use json_schema::json_schema;
pub use list::{List, ListEntry, lists};
pub use markdown::markdown;
pub use suggestion::nearest;
