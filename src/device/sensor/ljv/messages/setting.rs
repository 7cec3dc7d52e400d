//! The settings of the controller.

/// The data of a request for a setting; the reply is its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SettingRequest {
    /// 0: those being written, 1: those that run, 2: those that are saved.
    pub level: u8,
    /// 1 the environment, 2 what all programs share, [`Self::FIRST_PROGRAM`] and on the programs.
    pub kind: u8,
    /// Within the kind.
    pub category: u8,
    /// Within the category.
    pub item: u8,
    /// Within the item. Clients leave garbage in the last.
    pub targets: [u8; 4],
}

impl SettingRequest {
    /// The kind of the first program.
    pub const FIRST_PROGRAM: u8 = 0x10;
    /// A trigger mode: a profile is taken on a signal or a request. 0 is continuous, 2 by the encoder.
    pub const EXTERNAL_TRIGGER: u8 = 1;

    const LEN: usize = 16;
    const RUNNING: u8 = 1;

    /// What triggers a profile in a program, as it runs.
    #[must_use]
    pub const fn trigger_mode(program: u8) -> Self {
        let kind = Self::FIRST_PROGRAM | (program & 0x0f);
        Self { level: Self::RUNNING, kind, category: 0, item: 1, targets: [0; 4] }
    }

    /// Its bytes.
    #[must_use]
    pub fn encode(&self) -> Vec<u8> {
        let mut data = Vec::with_capacity(Self::LEN);
        data.extend([0, 0, 0, 0, self.level, 0, 0, 0, self.kind, self.category, self.item, 0]);
        data.extend(self.targets);
        data
    }

    /// Reads the data of a request; `None` if it has another length.
    #[must_use]
    pub fn parse(data: &[u8]) -> Option<Self> {
        let data: &[u8; Self::LEN] = data.try_into().ok()?;
        Some(Self {
            level: data[4],
            kind: data[8],
            category: data[9],
            item: data[10],
            targets: [data[12], data[13], data[14], data[15]],
        })
    }
}
