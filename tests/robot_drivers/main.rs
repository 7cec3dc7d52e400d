//! Robots over loopback: golden bytes, split and slow replies, early close, silence, garbage, refusals. Each server here is
//! a small one of its own, so that drivers are not only held against the simulated cell.
#![expect(clippy::expect_used, reason = "a test ends where its cell does not stand")]

mod bridge;
mod curpos;
mod fake;
mod fuzz;
mod mappdk;
mod messages;
mod simulated;
mod ur;
mod wire;
