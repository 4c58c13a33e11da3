//! Phase 5: finds the dependences between passes, the passes that run, their order, and the
//! resources that share memory. Each file is one step, in this order.

pub(crate) mod view;

pub(crate) mod arrange;

pub(crate) mod order;

pub(crate) mod cull;

pub(crate) mod schedule;

pub(crate) mod lifetimes;

pub(crate) mod conditions;

mod placing;

pub(crate) mod aliases;

pub(crate) mod discard;

#[cfg(test)]
mod tests;

pub use aliases::{Aliases, Allocation, Alone};
pub use conditions::{Conditions, When};
pub use lifetimes::{Lifetime, Lifetimes};
pub use order::{Dependences, Hazard};
pub use schedule::Schedule;

pub(crate) use order::Order;
pub(crate) use view::GraphView;
