//! x
/// x
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[error("x")]
pub struct SessionError;
