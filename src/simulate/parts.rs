//! Stations before a plate or a pin, and scans of workpieces.

use std::f64::consts::FRAC_PI_4;
use std::sync::Arc;

use nalgebra::{Point3, UnitQuaternion};

use crate::calibrate::{Edge, Mount, SideChoice};
use crate::geometry::{Rigid, Transform, Vec3, so3};
use crate::scene::{
    CYLINDER_DIAMETER_MM, LINE_WIDTH_MM, Line, PITCH_MM, PLATE_EDGE_MM, Part, PartKind, TOOTH_HEIGHT_MM, rounded,
    rounded_rotation,
};
use crate::session::model::{Capture, Known, Reading, Station, Target, UnknownFields};

use super::options::SimulationOptions;
use super::path::{STANDOFF_MM, Setup};
use super::{Measurement, Randoms, reported};

/// Decimals of a part's true orientation.
const ORIENTATION_DECIMALS: u8 = 12;
/// Half of the measuring range along z, about the standoff, mm.
const HALF_RANGE_MM: f64 = 40.0;
/// No edge is crossed nearer to its ends than this, mm: the line would meet the other one as well.
const EDGE_MARGIN_MM: f64 = 30.0;

/// A station before it is measured.
struct Plan {
    label: String,
    edge: Option<Edge>,
    world_from_sensor_rotation: UnitQuaternion<f64>,
    /// What is aimed at, one place a capture, in the part, mm.
    aims: Vec<Vec3>,
    /// Where that is in the sensor, mm.
    aim_in_sensor: Vec3,
}

/// A part that stands where the setup has its target.
pub(super) fn measured(
    options: &SimulationOptions,
    setup: &Setup,
    kind: PartKind,
    randoms: &mut Randoms,
) -> Measurement {
    let part = Part::new(kind, world_from_part(setup, kind));
    let plans: Vec<Plan> = match kind {
        PartKind::Plate => [(Edge::P, "p", Vec3::x()), (Edge::Q, "q", Vec3::y())]
            .into_iter()
            .flat_map(|edge| (0..options.num_stations).map(move |idx| (edge, idx)))
            .enumerate()
            .map(|(station_idx, ((edge, letter, along), idx))| {
                let aim = along * place_on_edge_mm(idx, options.num_stations, randoms);
                let label = format!("{letter}{}", idx + 1);
                let plan = Plan::towards(options, setup, station_idx, label, randoms);
                Plan { edge: Some(edge), aims: vec![aim; options.num_steps], ..plan }
            })
            .collect(),
        PartKind::Pin => (0..options.num_stations)
            .map(|station_idx| {
                let label = (station_idx + 1).to_string();
                let mut plan = Plan::towards(options, setup, station_idx, label, randoms);
                plan.aim_in_sensor.y = options.aim_std_mm * randoms.aim.normal();
                Plan { aims: vec![Vec3::zeros(); options.num_steps], ..plan }
            })
            .collect(),
        PartKind::Square | PartKind::Teeth | PartKind::Cylinder => (0..options.num_stations)
            .map(|station_idx| {
                let label = format!("scan {}", station_idx + 1);
                let plan = Plan::towards(options, setup, station_idx, label, randoms);
                Plan { aims: along_scan(options), ..plan }
            })
            .collect(),
    };
    let stations =
        plans.into_iter().enumerate().map(|(idx, plan)| plan.station(options, setup, &part, idx, randoms)).collect();
    let touched = |randoms: &mut Randoms| {
        let error_mm = randoms.aim.normal3() * options.touch_std_mm;
        (setup.target_in_world + error_mm).map(|value| rounded(value, options.decimals))
    };
    let (target, known) = match kind {
        PartKind::Plate => (Target::RightAnglePlate, Known::default()),
        PartKind::Pin => {
            // On the flange there is no place in the base to touch.
            let point_in_base_mm = (options.mount == Mount::OnFlange).then(|| touched(randoms));
            (Target::Point, Known { point_in_base_mm, ..Known::default() })
        }
        PartKind::Square => (Target::Workpiece, Known { angle_deg: Some(90.0), ..Known::default() }),
        PartKind::Teeth => {
            let sizes = Known { pitch_mm: Some(PITCH_MM), height_mm: Some(TOOTH_HEIGHT_MM), ..Known::default() };
            (Target::Workpiece, sizes)
        }
        PartKind::Cylinder => {
            (Target::Workpiece, Known { diameter_mm: Some(CYLINDER_DIAMETER_MM), ..Known::default() })
        }
    };
    let base_from_plate = (kind == PartKind::Plate).then_some(part.world_from_part);
    Measurement { target, known, stations, base_from_plate }
}

/// The part lies as the line of an upright sensor would have it: halfway between the plate's edges, so that it crosses both
/// alike, and across the path of a scan.
fn world_from_part(setup: &Setup, kind: PartKind) -> Rigid {
    let line = setup.upright() * Vec3::x();
    let halfway = if kind == PartKind::Plate { FRAC_PI_4 } else { 0.0 };
    let turn = so3::exp(Vec3::z() * (line.y.atan2(line.x) - halfway));
    Rigid::from_parts(setup.target_in_world.into(), rounded_rotation(&turn, ORIENTATION_DECIMALS))
}

/// Spread over the edge, from its corner on, mm.
#[expect(clippy::cast_precision_loss, reason = "a session has far fewer than 2^52 stations")]
fn place_on_edge_mm(idx: usize, num_stations: usize, randoms: &mut Randoms) -> f64 {
    let part = (idx as f64 + 0.5 + 0.3 * randoms.aim.signed_unit()) / num_stations as f64;
    EDGE_MARGIN_MM + part * (PLATE_EDGE_MM - 2.0 * EDGE_MARGIN_MM)
}

/// The places of a scan along the part's y, its middle over the part's.
#[expect(clippy::cast_precision_loss, reason = "a scan has far fewer than 2^52 profiles")]
fn along_scan(options: &SimulationOptions) -> Vec<Vec3> {
    let middle = (options.num_steps - 1) as f64 / 2.0;
    (0..options.num_steps).map(|idx| Vec3::y() * ((idx as f64 - middle) * options.step_mm)).collect()
}

impl Plan {
    /// Aims at nothing yet.
    fn towards(
        options: &SimulationOptions,
        setup: &Setup,
        station_idx: usize,
        label: String,
        randoms: &mut Randoms,
    ) -> Self {
        let world_from_sensor_rotation = setup.orientation(options, station_idx, &mut randoms.path);
        let across_mm = 0.15 * LINE_WIDTH_MM * randoms.path.signed_unit();
        let away_mm = STANDOFF_MM + 10.0 * randoms.path.signed_unit();
        Self {
            label,
            edge: None,
            world_from_sensor_rotation,
            aims: Vec::new(),
            aim_in_sensor: Vec3::new(across_mm, 0.0, options.range_sign() * away_mm),
        }
    }

    fn station(
        self,
        options: &SimulationOptions,
        setup: &Setup,
        part: &Part,
        station_idx: usize,
        randoms: &mut Randoms,
    ) -> Station {
        let is_bad = options.bad_pose_station == Some(station_idx);
        let mut captures: Vec<Capture> = Vec::with_capacity(self.aims.len());
        let mut last_aim = None;
        for aim in &self.aims {
            let aim_in_world = (part.world_from_part * Point3::from(*aim)).coords;
            let origin = aim_in_world - self.world_from_sensor_rotation * self.aim_in_sensor;
            let world_from_sensor = Rigid::from_parts(origin.into(), self.world_from_sensor_rotation);
            // Where the robot has not moved, it says what it said before.
            let stood_still = captures.last().filter(|_| last_aim == Some(*aim)).map(|last| last.base_from_flange);
            let base_from_flange = stood_still.unwrap_or_else(|| {
                let exact = setup.base_from_flange(options.mount, &world_from_sensor);
                Transform::from_rigid(reported(&exact, options, is_bad, &mut randoms.pose))
            });
            captures.push(Capture {
                base_from_flange,
                written_angles: None,
                reading: self.reading(options, part, &world_from_sensor, randoms),
                step_mm: last_aim.filter(|_| stood_still.is_none()).map(|_| options.step_mm),
                unknown: UnknownFields::new(),
            });
            last_aim = Some(*aim);
        }
        Station {
            label: self.label,
            enabled: true,
            side: SideChoice::Auto,
            edge: self.edge,
            captures,
            unknown: UnknownFields::new(),
        }
    }

    /// The profile, or the point of it that matters.
    fn reading(
        &self,
        options: &SimulationOptions,
        part: &Part,
        world_from_sensor: &Rigid,
        randoms: &mut Randoms,
    ) -> Reading {
        if options.has_points && !options.target.is_workpiece() {
            let error = randoms.profile.normal3() * options.profile_std_mm;
            let seen = Vec3::new(self.aim_in_sensor.x + error.x, 0.0, self.aim_in_sensor.z + error.z);
            return Reading::Point(seen.map(|value| rounded(value, options.decimals)));
        }
        let line = Line {
            num_points: options.num_points,
            width_mm: LINE_WIDTH_MM,
            profile_std_mm: options.profile_std_mm,
            dirt: options.dirt,
            decimals: options.decimals,
        };
        let range_sign = options.range_sign();
        let profile = line.profile(&mut randoms.profile, &mut randoms.dirt, |x| {
            part.seen_z_mm(x, range_sign, world_from_sensor)
                .filter(|z| (z * range_sign - STANDOFF_MM).abs() <= HALF_RANGE_MM)
        });
        Reading::Profile(Arc::new(profile))
    }
}
