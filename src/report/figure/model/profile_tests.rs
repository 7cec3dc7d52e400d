//! The model of a profile against profiles made by hand.

use std::sync::Arc;

use super::*;
use crate::fit::ArcRefusal;
use crate::geometry::Mat3;

const RADIUS_MM: f64 = 10.0;

/// Half a circle seen from above (`away` = 1: z grows away from the sensor) with one outlier and one unused point.
fn half_circle(away: f64) -> (Profile, calibrate::Reading) {
    let (mut x_mm, mut z_mm) = (Vec::new(), Vec::new());
    for idx in 0..=20 {
        let angle = std::f64::consts::PI * f64::from(idx) / 20.0;
        x_mm.push(3.0 + RADIUS_MM * angle.cos());
        z_mm.push(away * (80.0 - RADIUS_MM * angle.sin()));
    }
    let (inlier_x_mm, inlier_z_mm) = (x_mm.clone(), z_mm.clone());
    let mut classes = vec![PointClass::Inlier; x_mm.len()];
    x_mm.extend([3.0, 40.0]);
    z_mm.extend([away * 65.0, away * 90.0]);
    classes.extend([PointClass::Outlier, PointClass::Unused]);
    let valid: Vec<Option<f64>> = z_mm.iter().copied().map(Some).collect();
    let arc = ArcFit {
        circle: Circle { x_mm: 3.0, z_mm: away * 80.0, radius_mm: RADIUS_MM },
        covariance: Mat3::identity() * 4e-6,
        point_std_mm: 0.01,
        rms_mm: 0.01,
        angle_rad: std::f64::consts::PI,
        classes,
        inlier_x_mm,
        inlier_z_mm,
    };
    (Profile::new(x_mm, &valid).expect("valid"), calibrate::Reading::Arc(Arc::new(arc)))
}

#[test]
fn the_sensor_is_at_the_top_whichever_way_z_points() {
    for away in [1.0, -1.0] {
        let (profile, reading) = half_circle(away);
        let model = profile_model(&profile, Some(&reading), Some(12.0), CircleMethod::Robust);
        assert_eq!(model.z_grows_away, away > 0.0);
    }
}

#[test]
fn points_keep_their_class_and_residual() {
    let (profile, reading) = half_circle(1.0);
    let model = profile_model(&profile, Some(&reading), Some(12.0), CircleMethod::Robust);
    assert_eq!(
        [PointClass::Inlier, PointClass::Outlier, PointClass::Unused].map(|class| model.count(class)),
        [21, 1, 1]
    );
    // The outlier lies 15 mm from the centre of a circle of 10 mm.
    assert!((model.points[21].residual_um - 5000.0).abs() < 1e-6);
    let section = model.section().expect("a section");
    assert!(section.rms_um < 1e-6 && section.shift_um.iter().all(|shift| shift.abs() < 1e-9));
}

#[test]
fn a_refused_profile_keeps_its_points_and_says_why() {
    let (profile, _) = half_circle(1.0);
    let refusal = ArcRefusal::TooFewPoints { found: 3, needed: 8 };
    let reading = calibrate::Reading::Refused(refusal.clone().into());
    let model = profile_model(&profile, Some(&reading), None, CircleMethod::Robust);
    assert_eq!(model.found, Err(refusal.to_string()));
    assert_eq!(model.points.len(), 23);
}

#[test]
fn a_plates_profile_has_its_flanks_and_the_distances_from_them() {
    let x_mm: Vec<f64> = (0..200).map(|idx| f64::from(idx) * 0.1).collect();
    let z_mm: Vec<Option<f64>> = x_mm.iter().map(|x| Some(60.0 + (x - 8.0).abs())).collect();
    let profile = Profile::new(x_mm, &z_mm).expect("valid");
    let found = crate::fit::extract_edge(&profile, &crate::fit::EdgeOptions::default()).expect("a corner");
    let reading = calibrate::Reading::Edge(Arc::new(found));
    let model = profile_model(&profile, Some(&reading), None, CircleMethod::Robust);
    let edge = model.edge().expect("a corner");
    assert!(model.section().is_none() && model.has_residuals());
    assert_eq!((edge.feature, edge.flanks.len()), (Feature::Corner, 2));
    assert!((edge.point_mm[0] - 8.0).abs() < 1e-6);
    // On either flank.
    assert!(model.points.iter().all(|point| point.residual_um.abs() < 1e-3));
}
