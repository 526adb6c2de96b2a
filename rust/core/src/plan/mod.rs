//! From the outputs requested to the steps that compute them.

pub(crate) mod explain;
pub mod output;
pub mod reduction;
pub(crate) mod steps;

pub use explain::Call;
pub use output::Output;
pub use reduction::Reduction;
pub use steps::{End, Plan, Request};
