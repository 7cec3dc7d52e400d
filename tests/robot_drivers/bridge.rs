//! Any robot by the text bridge.
