//! Plans: the requested outputs, the steps that compute them, and the routes of a run.

pub(crate) mod forces;
pub mod output;
pub(crate) mod planning;
pub mod reduction;
pub(crate) mod request;
pub(crate) mod route;
pub(crate) mod steps;

pub use output::{Output, Per, Row};
pub use reduction::Reduction;
pub use request::{Axes, End, Request};
pub use route::Route;
pub use steps::Plan;
