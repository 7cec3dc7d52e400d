//! Whether a search goes across the laser line, as far as it is known how the sensor is mounted.

use nalgebra::UnitQuaternion;

use crate::calibrate::{Mount, best_available};
use crate::device::search::DirectionFrame;
use crate::device::{MotionRefusal, SearchSettings};
use crate::geometry::{Base, Flange, Rigid, Transform, Vec3};

use super::super::Workbench;
use super::proposals::rigid;

/// Further off the normal of the laser plane the section hardly changes on the way ...
const MOST_DEG: f64 = 45.0;
/// ... and from here on the search is longer than it has to be, and the arc wanders along the line.
const OBLIQUE_DEG: f64 = 20.0;

impl Workbench {
    /// Answers by how much a search from a pose is oblique, degrees, if it is worth a remark.
    pub(super) fn check_travel(
        &self,
        at: &Transform<Base, Flange>,
        search: &SearchSettings,
    ) -> Result<Option<f64>, MotionRefusal> {
        let solved = self.results().and_then(|results| best_available(&results.methods));
        let solved = solved.map(|solution| solution.flange_from_sensor.rotation());
        let said = || self.cell.view.settings.mounting.map(|mounting| rigid(&mounting).rotation);
        let mount = self.document.as_ref().map(|document| document.session.mount);
        let (Some(mounted), Some(mount)) = (solved.or_else(said), mount) else { return Ok(None) };
        check(at.rotation(), mounted, mount, search)
    }
}

fn check(
    base_from_flange: UnitQuaternion<f64>,
    mounted: UnitQuaternion<f64>,
    mount: Mount,
    search: &SearchSettings,
) -> Result<Option<f64>, MotionRefusal> {
    let base_from_sensor = match mount {
        Mount::OnFlange => base_from_flange * mounted,
        Mount::Fixed => mounted,
    };
    let normal = base_from_sensor * Vec3::y();
    let at = Rigid::from_parts(Vec3::zeros().into(), base_from_flange);
    let Some(direction) = search.direction_in_base(&at) else { return Ok(None) };
    let angle_deg = direction.dot(&normal).abs().min(1.0).acos().to_degrees();
    if angle_deg > MOST_DEG {
        let across = match search.frame {
            DirectionFrame::Tool => base_from_flange.inverse() * normal,
            DirectionFrame::Base => normal,
        };
        return Err(MotionRefusal::AlongLine { angle_deg, max_deg: MOST_DEG, across: across.into() });
    }
    Ok((angle_deg > OBLIQUE_DEG).then_some(angle_deg))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::so3;

    #[test]
    fn a_travel_along_the_line_is_refused_and_an_oblique_one_remarked() {
        // Turned by 90° about the flange's z the laser's normal is the flange's x.
        let mounted = so3::exp(Vec3::z() * 90_f64.to_radians());
        let flange = so3::exp(Vec3::x() * 180_f64.to_radians());
        for (direction_deg, expected) in [(0.0, Ok(None)), (30.0, Ok(Some(30))), (50.0, Err(50)), (90.0, Err(90))] {
            let (sin, cos) = f64::to_radians(direction_deg).sin_cos();
            let search = SearchSettings { direction: [cos, sin, 0.0], ..SearchSettings::default() };
            let found = check(flange, mounted, Mount::OnFlange, &search);
            #[expect(clippy::cast_possible_truncation, reason = "a small angle")]
            let whole = |angle_deg: f64| angle_deg.round() as i32;
            let told = match &found {
                Ok(oblique_deg) => Ok(oblique_deg.map(whole)),
                Err(MotionRefusal::AlongLine { angle_deg, across, .. }) => {
                    assert!((across[0].abs() - 1.0).abs() < 1e-9, "{across:?}");
                    Err(whole(*angle_deg))
                }
                Err(other) => panic!("{other}"),
            };
            assert_eq!(told, expected, "{direction_deg}");
        }
    }
}
