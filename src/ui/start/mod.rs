//! Step Session: the start page with samples and files, and the overview of an open session.

pub mod form;
pub mod form_model;
pub mod model;
pub mod offers;
pub mod overview;
pub mod paint;
pub mod panel;
