//! Handeye: a workbench for the hand-eye calibration of robot-mounted laser profilers.
//!
//! # Map
//! Data flows one way: file → profile → fit → method → result → panel. A module names only floors below its own;
//! `tests/architecture.rs` checks that.
//!
//! | floor | module | holds |
//! | --- | --- | --- |
//! | 10 | `main.rs` | arguments, then the window or a command |
//! | 9 | [`cli`] | the commands without a window |
//! | 8 | [`ui`] | egui panels: the only code that names egui |
//! | 7 | [`app`] | the workbench: document, history, results, jobs, notices |
//! | 6 | [`report`] | what was computed of a session as files, pages, tables and figures; tool frames |
//! | 5 | [`text`] | wording |
//! | 4 | [`device`], [`diagnose`], [`simulate`] | robots and sensors, the search for the largest arc, the simulated cell · what is wrong with a session, and its remedies · simulated sessions |
//! | 3 | [`session`], [`plan`], [`verify`] | the document: model, edits, history, table, file format, imports, checks, measuring · where to measure next · what a calibration is worth on other data |
//! | 2 | [`calibrate`], [`odometry`], [`scan`] | hand-eye methods, least squares on SE(3), uncertainty, validation · the motion of a camera from its images · points of a scanned part: clouds, planes, teeth, cylinders |
//! | 1 | [`fit`], [`scene`], `sheet` | circle fits, the extraction of arcs and edges · what a laser line sees · numbers in text of any origin |
//! | 0 | [`geometry`], [`watch`], `whole_file` | frames, rotations, conventions, profile, statistics · progress and cancel · files replaced in one step |
//!
//! # Invariants
//! - `geometry`, `fit`, `calibrate`, `odometry`, `plan`, `verify` and `diagnose` are pure: no I/O, threads, clock or unseeded randomness. Same input, same bits.
//! - Every transform is named `dst_from_src`. Millimetres and radians inside; degrees only at the edges, in the name.
//! - A poor result is not an error: it is a solution with warnings. An error means that nothing could be computed.

pub mod app;
pub mod calibrate;
pub mod cli;
pub mod device;
pub mod diagnose;
pub mod fit;
pub mod geometry;
pub mod odometry;
pub mod plan;
pub mod report;
pub mod scan;
pub mod scene;
pub mod session;
mod sheet;
pub mod simulate;
pub mod text;
pub mod ui;
pub mod verify;
pub mod watch;
mod whole_file;
