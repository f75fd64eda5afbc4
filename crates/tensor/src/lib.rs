//! 3 × 3 tensor vocabulary of finite-strain mechanics on top of nalgebra.
//!
//! Tensors are always 3 × 3; plane strain is a tensor whose third row and column are those of the
//! identity (or zero), and the spectral routines take a closed form when they see one.
//!
//! ```
//! use jstsph_tensor::{Mat3, cofactor, double_dot, symmetric_eigen, tensor_cross};
//!
//! let f = Mat3::new(1.2, 0.1, 0.0, 0.0, 0.9, 0.0, 0.0, 0.0, 1.0);
//! let h = cofactor(&f);
//! assert!((h - tensor_cross(&f, &f) * 0.5).norm() < 1e-15); // H = ½ F × F
//! assert!((double_dot(&h, &f) / 3.0 - f.determinant()).abs() < 1e-15); // J = ⅓ H : F
//!
//! let eigen = symmetric_eigen(&(f * f.transpose()));
//! assert!((eigen.values.product() - f.determinant().powi(2)).abs() < 1e-14);
//! ```

mod algebra;
mod function;
pub mod lanes;
mod power;
mod spectral;

pub use algebra::{
    cofactor, deviator, double_dot, inverse_transpose, mean_trace, norm_squared, symmetric_part,
    tensor_cross, von_mises,
};
pub use function::{exp_symmetric, log_symmetric};
pub use power::{exponential, exponentials, logarithm, logarithms, power, powers};
pub use spectral::{Spectral, largest_eigenvalue, symmetric_eigen};

/// A vector of three components.
pub type Vec3 = nalgebra::Vector3<f64>;
/// A second-order tensor; row index spatial, column index material for two-point tensors.
pub type Mat3 = nalgebra::Matrix3<f64>;
