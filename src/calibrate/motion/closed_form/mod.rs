//! Closed-form answers, each as its paper has it: shown beside the refined one, and its start.
//!
//! Those of A X = X B work on relative motions ([`Pair`]), those of A X B = Z on the poses themselves. None of them knows how
//! large the noise of rotations is against that of translations, which is why the refined answer is better.

mod andreff;
mod daniilidis;
mod horaud;
mod li;
mod park;
mod shah;
mod translation;
mod tsai;

pub(super) use translation::translation;

use nalgebra::UnitQuaternion;

use crate::geometry::Rigid;

use super::pair::Pair;
use super::pose::PosePair;

/// A published closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ClosedForm {
    /// Tsai & Lenz 1989.
    Tsai,
    /// Park & Martin 1994.
    Park,
    /// Horaud & Dornaika 1995.
    Horaud,
    /// Andreff, Horaud & Espiau 2001.
    Andreff,
    /// Daniilidis 1999.
    Daniilidis,
    /// Shah 2013: robot-world and hand-eye.
    Shah,
    /// Li, Wang & Wu 2010: robot-world and hand-eye.
    Li,
}

impl ClosedForm {
    /// In the order in which they are shown.
    pub const ALL: [Self; 7] =
        [Self::Tsai, Self::Park, Self::Horaud, Self::Andreff, Self::Daniilidis, Self::Shah, Self::Li];

    /// The name in files.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Tsai => "tsai",
            Self::Park => "park",
            Self::Horaud => "horaud",
            Self::Andreff => "andreff",
            Self::Daniilidis => "daniilidis",
            Self::Shah => "shah",
            Self::Li => "li",
        }
    }

    /// The sensor on the flange by this form; `None` where its equations are singular.
    #[must_use]
    pub fn solve(self, poses: &[PosePair], pairs: &[Pair]) -> Option<Rigid> {
        let with_translation = |rotation: Option<UnitQuaternion<f64>>| {
            let rotation = rotation?;
            Some(Rigid::from_parts(translation(poses, &rotation)?.into(), rotation))
        };
        let found = match self {
            Self::Tsai => with_translation(tsai::rotation(pairs)),
            Self::Park => with_translation(park::rotation(pairs)),
            Self::Horaud => with_translation(horaud::rotation(pairs)),
            Self::Andreff => with_translation(andreff::rotation(pairs)),
            Self::Daniilidis => daniilidis::motion(pairs),
            Self::Shah => with_translation(shah::rotation(poses)),
            Self::Li => li::motion(poses),
        }?;
        let is_finite =
            found.translation.vector.iter().chain(found.rotation.coords.iter()).all(|value| value.is_finite());
        is_finite.then_some(found)
    }
}
