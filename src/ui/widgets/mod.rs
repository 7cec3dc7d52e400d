//! Small building blocks that every panel shares.

mod card;
mod controls;
mod number;
pub mod tables;
mod tabs;

pub use card::{card, card_with_height, chip};
pub use controls::{FromTop, name_field, named_checkbox, nothing, primary_button, symbol_button};
pub use number::{fixed, number, number_text, signed, split_row, value_row};
pub use tabs::tabs;
