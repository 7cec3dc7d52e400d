pub mod fixed_point; pub mod max_arc; pub mod max_arc_step; pub mod bundle;
