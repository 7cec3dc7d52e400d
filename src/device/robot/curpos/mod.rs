//! FANUC by its web page `CURPOS.DG`: reads only.

pub mod http;
pub mod page;
