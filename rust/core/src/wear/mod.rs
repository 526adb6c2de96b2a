//! Wear of the pins of the joints: friction and fatigue, from means over a turn.

pub mod life;
pub mod pins;
