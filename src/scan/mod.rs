//! Points of a scanned part, in the base: profiles along a path become a cloud, and regions of it planes, teeth, cylinders
//! and balls.
