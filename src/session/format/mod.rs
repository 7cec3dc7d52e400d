//! x
use std::path::Path;
use super::{Session, SessionError};
/// x
/// # Errors
/// x
pub fn load(_path: &Path) -> Result<Session, SessionError> { Err(SessionError) }
/// x
/// # Errors
/// x
pub fn parse(_bytes: &[u8], _origin: &str) -> Result<Session, SessionError> { Err(SessionError) }
/// x
/// # Errors
/// x
pub fn save(_session: &Session, _path: &Path) -> Result<(), SessionError> { Err(SessionError) }
/// x
pub fn to_json(_session: &Session) -> String { String::new() }
