//! Shared helpers of the verification and validation tests.
