//! The table of conventions: how each maker's pendant names and multiplies its three angles, and every order without a
//! maker's name. `docs/conventions.md` says where each row comes from.

use super::angle_order::AngleOrder;
use super::angle_order::Axis::{X, Y, Z};
use super::convention::PoseConvention;
use super::notation::AngleUnit;

const EXTRINSIC_XYZ: AngleOrder = AngleOrder::Extrinsic([X, Y, Z]);
const INTRINSIC_ZYX: AngleOrder = AngleOrder::Intrinsic([Z, Y, X]);
const INTRINSIC_XYZ: AngleOrder = AngleOrder::Intrinsic([X, Y, Z]);
const INTRINSIC_ZYZ: AngleOrder = AngleOrder::Intrinsic([Z, Y, Z]);

const fn convention(
    id: &'static str,
    label: &'static str,
    angle_names: [&'static str; 3],
    formula: &'static str,
    order: AngleOrder,
) -> PoseConvention {
    PoseConvention { id, label, angle_names, formula, order, usual_angle_unit: AngleUnit::Degrees }
}

/// A maker of this family: three angles about the fixed axes x, y, z in this order, named after the axes.
const fn fixed_xyz(id: &'static str, label: &'static str) -> PoseConvention {
    convention(id, label, ["Rx", "Ry", "Rz"], "Rz(Rz) Ry(Ry) Rx(Rx)", EXTRINSIC_XYZ)
}

/// A maker that writes A B C as KUKA does.
const fn like_kuka(id: &'static str, label: &'static str) -> PoseConvention {
    convention(id, label, ["A", "B", "C"], "Rz(A) Ry(B) Rx(C)", INTRINSIC_ZYX)
}

/// Of each three axes the conventions about fixed and about moving ones, each axis with the name of its angle; at the end
/// the rotation vector.
macro_rules! neutral {
    ($($x:ident $first:ident $a:literal, $y:ident $second:ident $b:literal, $z:ident $third:ident $c:literal;)*) => {
        &[
            $(
                convention(
                    concat!("extrinsic-", stringify!($x), stringify!($y), stringify!($z)),
                    concat!("Extrinsic ", stringify!($first), " ", stringify!($second), " ", stringify!($third)),
                    [$a, $b, $c],
                    concat!(
                        "R", stringify!($z), "(", $c, ") R", stringify!($y), "(", $b, ") R", stringify!($x), "(", $a, ")"
                    ),
                    AngleOrder::Extrinsic([$first, $second, $third]),
                ),
                convention(
                    concat!("intrinsic-", stringify!($x), stringify!($y), stringify!($z)),
                    concat!("Intrinsic ", stringify!($first), " ", stringify!($second), " ", stringify!($third)),
                    [$a, $b, $c],
                    concat!(
                        "R", stringify!($x), "(", $a, ") R", stringify!($y), "(", $b, ") R", stringify!($z), "(", $c, ")"
                    ),
                    AngleOrder::Intrinsic([$first, $second, $third]),
                ),
            )*
            convention(
                "rotation-vector",
                "Rotation vector",
                ["rx", "ry", "rz"],
                "rotation vector",
                AngleOrder::RotationVector,
            ),
        ]
    };
}

impl PoseConvention {
    /// Under makers' names, the default first.
    pub const MAKERS: &'static [Self] = &[
        convention("fanuc-wpr", "FANUC W P R", ["W", "P", "R"], "Rz(R) Ry(P) Rx(W)", EXTRINSIC_XYZ),
        convention("abb-ezeyex", "ABB EZ EY EX", ["EZ", "EY", "EX"], "Rz(EZ) Ry(EY) Rx(EX)", INTRINSIC_ZYX),
        like_kuka("kuka-abc", "KUKA A B C"),
        Self {
            usual_angle_unit: AngleUnit::Radians,
            ..convention("ur-rotvec", "UR RX RY RZ", ["RX", "RY", "RZ"], "rotation vector", AngleOrder::RotationVector)
        },
        fixed_xyz("yaskawa-rxryrz", "Yaskawa Rx Ry Rz"),
        convention("staubli-rxryrz", "Stäubli Rx Ry Rz", ["Rx", "Ry", "Rz"], "Rx(Rx) Ry(Ry) Rz(Rz)", INTRINSIC_XYZ),
        convention("kawasaki-oat", "Kawasaki O A T", ["O", "A", "T"], "Rz(O) Ry(A) Rz(T)", INTRINSIC_ZYZ),
        convention("mitsubishi-abc", "Mitsubishi A B C", ["A", "B", "C"], "Rz(C) Ry(B) Rx(A)", EXTRINSIC_XYZ),
        convention("comau-aer", "Comau A E R", ["A", "E", "R"], "Rz(A) Ry(E) Rz(R)", INTRINSIC_ZYZ),
        convention("denso-rxryrz", "Denso RX RY RZ", ["RX", "RY", "RZ"], "Rz(RZ) Ry(RY) Rx(RX)", EXTRINSIC_XYZ),
        convention("nachi-rpy", "Nachi r p y", ["r", "p", "y"], "Rz(r) Ry(p) Rx(y)", INTRINSIC_ZYX),
        convention("epson-uvw", "Epson U V W", ["U", "V", "W"], "Rz(U) Ry(V) Rx(W)", INTRINSIC_ZYX),
        fixed_xyz("hans-rxryrz", "Hans Rx Ry Rz"),
        fixed_xyz("jaka-rxryrz", "JAKA Rx Ry Rz"),
        fixed_xyz("dobot-rxryrz", "Dobot Rx Ry Rz"),
        convention("aubo-rxryrz", "AUBO RX RY RZ", ["RX", "RY", "RZ"], "Rz(RZ) Ry(RY) Rx(RX)", EXTRINSIC_XYZ),
        Self { usual_angle_unit: AngleUnit::Radians, ..fixed_xyz("elite-rxryrz", "Elite Rx Ry Rz") },
        like_kuka("estun-abc", "ESTUN A B C"),
        like_kuka("efort-abc", "EFORT A B C"),
        like_kuka("inovance-abc", "INOVANCE A B C"),
        convention("rokae-abc", "ROKAE A B C", ["A", "B", "C"], "Rz(C) Ry(B) Rx(A)", EXTRINSIC_XYZ),
        convention("siasun-abc", "SIASUN A B C", ["A", "B", "C"], "Rz(C) Ry(B) Rx(A)", EXTRINSIC_XYZ),
        fixed_xyz("tm-rxryrz", "TM (Techman) Rx Ry Rz"),
        fixed_xyz("hyundai-rxryrz", "Hyundai Rx Ry Rz"),
        fixed_xyz("flexiv-rxryrz", "Flexiv Rx Ry Rz"),
        fixed_xyz("delta-rxryrz", "Delta Rx Ry Rz"),
        fixed_xyz("fairino-rxryrz", "FAIRINO Rx Ry Rz"),
        convention(
            "xarm-rpy",
            "xArm (UFACTORY) roll pitch yaw",
            ["roll", "pitch", "yaw"],
            "Rz(yaw) Ry(pitch) Rx(roll)",
            EXTRINSIC_XYZ,
        ),
        convention("doosan-abc", "Doosan A B C", ["A", "B", "C"], "Rz(A) Ry(B) Rz(C)", INTRINSIC_ZYZ),
        convention("qjar-abc", "QJAR A B C", ["A", "B", "C"], "Rz(A) Ry(B) Rz(C)", INTRINSIC_ZYZ),
        convention(
            "adept-ypr",
            "Adept V+ yaw pitch roll",
            ["yaw", "pitch", "roll"],
            "Rz(yaw) Ry(pitch) Rz(roll)",
            INTRINSIC_ZYZ,
        ),
    ];

    /// Other readings of makers that stand above, which some sources give; the labels say how they differ.
    pub const DISPUTED: &'static [Self] = &[
        convention(
            "denso-zyz",
            "Denso RX RY RZ, read as Z Y Z",
            ["RX", "RY", "RZ"],
            "Rz(RX) Ry(RY) Rz(RZ)",
            INTRINSIC_ZYZ,
        ),
        convention(
            "epson-uvw-xyz",
            "Epson U V W, read as X Y Z",
            ["U", "V", "W"],
            "Rx(W) Ry(V) Rz(U)",
            AngleOrder::Extrinsic([Z, Y, X]),
        ),
    ];

    /// Each order of three numbers once, without a maker's name, as in [`AngleOrder::ALL`].
    pub const NEUTRAL: &'static [Self] = neutral! {
        z Z "rz", y Y "ry", x X "rx";
        x X "rx", y Y "ry", z Z "rz";
        x X "rx", z Z "rz", y Y "ry";
        y Y "ry", x X "rx", z Z "rz";
        y Y "ry", z Z "rz", x X "rx";
        z Z "rz", x X "rx", y Y "ry";
        z Z "rz1", y Y "ry", z Z "rz2";
        z Z "rz1", x X "rx", z Z "rz2";
        x X "rx1", y Y "ry", x X "rx2";
        x X "rx1", z Z "rz", x X "rx2";
        y Y "ry1", x X "rx", y Y "ry2";
        y Y "ry1", z Z "rz", y Y "ry2";
    };
}
