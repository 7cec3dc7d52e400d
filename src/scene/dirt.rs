//! What real profiles hold besides the ball.

/// What real profiles hold besides the ball.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "independent switches, any of which may be on")]
pub struct Dirt {
    /// The table below the ball.
    pub has_table: bool,
    /// Single points that are off by millimetres.
    pub has_spikes: bool,
    /// Runs of missing points, and single ones.
    pub has_holes: bool,
    /// Flanks that are measured too high, as steep surfaces are.
    pub has_flank_bias: bool,
}

impl Dirt {
    /// Everything at once.
    #[must_use]
    pub const fn all() -> Self {
        Self { has_table: true, has_spikes: true, has_holes: true, has_flank_bias: true }
    }
}
