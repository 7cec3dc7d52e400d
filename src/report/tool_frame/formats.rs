//! The table of formats. `docs/tool-frames.md` says where each row comes from.

use super::Comment::{self, Between, Line};
use super::{Format, Group};
use crate::geometry::PoseConvention;

const MM_DEG: &str = "mm, degrees";

const fn controller(
    id: &'static str,
    label: &'static str,
    extension: &'static str,
    comment: Comment,
    template: &'static str,
) -> Format {
    Format {
        id,
        label,
        group: Group::Controller,
        convention: None,
        units: MM_DEG,
        remark: None,
        extension,
        needs_flange: true,
        comment,
        template,
    }
}

const fn other(
    group: Group,
    id: &'static str,
    label: &'static str,
    units: &'static str,
    extension: &'static str,
    comment: Comment,
    template: &'static str,
) -> Format {
    Format {
        id,
        label,
        group,
        convention: None,
        units,
        remark: None,
        extension,
        needs_flange: false,
        comment,
        template,
    }
}

const fn program(
    id: &'static str,
    label: &'static str,
    extension: &'static str,
    comment: Comment,
    template: &'static str,
) -> Format {
    other(Group::Program, id, label, "mm", extension, comment, template)
}

const fn ros(
    id: &'static str,
    label: &'static str,
    extension: &'static str,
    comment: Comment,
    template: &'static str,
) -> Format {
    other(Group::Ros, id, label, "metres", extension, comment, template)
}

impl Format {
    const fn remark(self, remark: &'static str) -> Self {
        Self { remark: Some(remark), ..self }
    }

    const fn of_carried(self) -> Self {
        Self { needs_flange: true, ..self }
    }

    const fn units(self, units: &'static str) -> Self {
        Self { units, ..self }
    }
}

const PAYLOAD: &str = "the mass and its centre are placeholders: set them";
const OTHER_READING: &str = "sources differ on the order of the angles: jog the tool about one of its axes and compare";

/// Formats with a syntax of their own, each with the id of its convention, if it has angles.
const TABLE: &[(Option<&str>, Format)] = &[
    (
        Some("fanuc-wpr"),
        controller(
            "fanuc-ls",
            "FANUC TP program",
            "ls",
            Comment::None,
            "/PROG  HANDEYE\n/ATTR\nCOMMENT\t\t= \"sensor tool\";\nDEFAULT_GROUP\t= 1,*,*,*,*;\n/MN\n   \
             1:  !{name}: sensor in flange ;\n   2:  !mm, deg, R=Rz(R)Ry(P)Rx(W) ;\n   \
             3:  PR[81]=UTOOL[{number}] ;\n   4:  PR[81,1]={x!} ;\n   5:  PR[81,2]={y!} ;\n   6:  PR[81,3]={z!} ;\n   \
             7:  PR[81,4]={a!} ;\n   8:  PR[81,5]={b!} ;\n   9:  PR[81,6]={c!} ;\n  10:  UTOOL[{number}]=PR[81] ;\n  \
             11:  UTOOL_NUM={number} ;\n/POS\n/END\n",
        )
        .remark("overwrites position register 81, which it makes Cartesian by copying the tool into it first"),
    ),
    (
        Some("fanuc-wpr"),
        controller(
            "fanuc-rmi",
            "FANUC RMI command",
            "json",
            Comment::None,
            "{\"Command\":\"FRC_WriteUToolData\",\"ToolNumber\":{number},\"Frame\":{\"X\":{x},\"Y\":{y},\"Z\":{z},\
             \"W\":{a},\"P\":{b},\"R\":{c}}}\n",
        ),
    ),
    (
        None,
        controller(
            "abb-rapid",
            "ABB RAPID tooldata",
            "mod",
            Line("!"),
            "MODULE Handeye\n  PERS tooldata {name}:=[TRUE,[[{x},{y},{z}],[{qw},{qx},{qy},{qz}]],\
             [1,[0,0,50],[1,0,0,0],0,0,0]];\nENDMODULE\n",
        )
        .units("mm, quaternion w x y z")
        .remark(PAYLOAD),
    ),
    (
        Some("kuka-abc"),
        controller(
            "kuka-config",
            "KUKA $config.dat",
            "dat",
            Line(";"),
            "TOOL_DATA[{number}]={X {x},Y {y},Z {z},A {a},B {b},C {c}}\nTOOL_NAME[{number},]=\"{name}\"\n",
        ),
    ),
    (
        Some("kuka-abc"),
        controller(
            "kuka-krl",
            "KUKA KRL",
            "src",
            Line(";"),
            "$TOOL={FRAME: X {x},Y {y},Z {z},A {a},B {b},C {c}}\n",
        ),
    ),
    (
        Some("ur-rotvec"),
        controller(
            "ur-script",
            "Universal Robots URScript",
            "script",
            Line("#"),
            "set_tcp(p[{x_m},{y_m},{z_m},{a_rad},{b_rad},{c_rad}])\n",
        )
        .units("metres, radians"),
    ),
    (
        Some("yaskawa-rxryrz"),
        controller(
            "yaskawa-inform",
            "Yaskawa INFORM (DX200, YRC1000)",
            "jbi",
            Line("'"),
            "SETE P00100 (1) {x_um}\nSETE P00100 (2) {y_um}\nSETE P00100 (3) {z_um}\nSETE P00100 (4) {a_e4}\n\
             SETE P00100 (5) {b_e4}\nSETE P00100 (6) {c_e4}\nSETTOOL TL#({number}) P00100\n",
        )
        .units("0.001 mm, 0.0001 deg")
        .remark("lines for a job of your own; P100 must be a Cartesian position variable"),
    ),
    (
        Some("yaskawa-rxryrz"),
        controller(
            "yaskawa-dx100",
            "Yaskawa INFORM (DX100)",
            "jbi",
            Line("'"),
            "SETE P00100 (1) {x_um}\nSETE P00100 (2) {y_um}\nSETE P00100 (3) {z_um}\nSETE P00100 (4) {a_e2}\n\
             SETE P00100 (5) {b_e2}\nSETE P00100 (6) {c_e2}\nSETTOOL TL#({number}) P00100\n",
        )
        .units("0.001 mm, 0.01 deg")
        .remark("rounds angles to 0.01 deg: 0.05 mm at 300 mm from the flange"),
    ),
    (
        Some("staubli-rxryrz"),
        controller(
            "staubli-val3",
            "Stäubli VAL 3 data",
            "dtx",
            Comment::None,
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n\
             <Database xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
             xmlns=\"http://www.staubli.com/robotics/VAL3/Data/2\">\n  <Datas>\n    \
             <!-- sensor frame in the flange: mm, degrees, R = Rx(rx) Ry(ry) Rz(rz) -->\n    \
             <Data name=\"{name}\" access=\"public\" xsi:type=\"array\" type=\"tool\" size=\"1\">\n      \
             <Value key=\"0\" x=\"{x}\" y=\"{y}\" z=\"{z}\" rx=\"{a}\" ry=\"{b}\" rz=\"{c}\" fatherId=\"flange[0]\" />\n    \
             </Data>\n  </Datas>\n</Database>\n",
        ),
    ),
    (
        Some("kawasaki-oat"),
        controller(
            "kawasaki-as",
            "Kawasaki AS",
            "as",
            Line(";"),
            "TOOL TRANS({x},{y},{z},{a},{b},{c})\n",
        ),
    ),
    (
        Some("mitsubishi-abc"),
        controller(
            "mitsubishi-melfa",
            "Mitsubishi MELFA-BASIC",
            "prg",
            Line("'"),
            "Tool ({x},{y},{z},{a},{b},{c})\n",
        ),
    ),
    (
        Some("denso-rxryrz"),
        controller(
            "denso-pac",
            "Denso PacScript, angles about fixed X Y Z",
            "pcs",
            Line("'"),
            "Tool {number}, P({x},{y},{z},{a},{b},{c})\nChangeTool {number}\n",
        )
        .remark(OTHER_READING),
    ),
    (
        Some("denso-zyz"),
        controller(
            "denso-pac-zyz",
            "Denso PacScript, angles Z Y Z",
            "pcs",
            Line("'"),
            "Tool {number}, P({x},{y},{z},{a},{b},{c})\nChangeTool {number}\n",
        )
        .remark(OTHER_READING),
    ),
    (
        Some("epson-uvw"),
        controller(
            "epson-spel",
            "Epson SPEL+, R = Rz(U) Ry(V) Rx(W)",
            "prg",
            Line("'"),
            "TLSet {number}, XY({x},{y},{z},{a},{b},{c})\n",
        )
        .remark(OTHER_READING),
    ),
    (
        Some("epson-uvw-xyz"),
        controller(
            "epson-spel-xyz",
            "Epson SPEL+, R = Rx(W) Ry(V) Rz(U)",
            "prg",
            Line("'"),
            "TLSet {number}, XY({x},{y},{z},{a},{b},{c})\n",
        )
        .remark(OTHER_READING),
    ),
    (
        Some("comau-aer"),
        controller(
            "comau-pdl2",
            "Comau PDL2",
            "pdl",
            Line("--"),
            "$TOOL := POS({x},{y},{z},{a},{b},{c},'')\n",
        ),
    ),
    (
        Some("nachi-rpy"),
        controller(
            "nachi-slim",
            "Nachi SLIM",
            "txt",
            Line("'"),
            "LETVF V11!,{x}\nLETVF V12!,{y}\nLETVF V13!,{z}\nLETVF V14!,{a}\nLETVF V15!,{b}\nLETVF V16!,{c}\n\
             SETTOOL {number},1,V11!\n",
        )
        .remark("uses the real variables V11! to V16!"),
    ),
    (
        None,
        ros(
            "ros2-command",
            "ROS 2 static transform, command",
            "sh",
            Line("#"),
            "ros2 run tf2_ros static_transform_publisher --x {x_m} --y {y_m} --z {z_m} \
             --qx {qx} --qy {qy} --qz {qz} --qw {qw} --frame-id {parent} --child-frame-id {name}\n",
        ),
    ),
    (
        None,
        ros(
            "ros2-launch",
            "ROS 2 static transform, launch file (MoveIt)",
            "launch.py",
            Line("#"),
            "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n\
             def generate_launch_description():\n    return LaunchDescription([\n        Node(\n            \
             package=\"tf2_ros\",\n            executable=\"static_transform_publisher\",\n            arguments=[\n                \
             \"--x\", \"{x_m}\", \"--y\", \"{y_m}\", \"--z\", \"{z_m}\",\n                \
             \"--qx\", \"{qx}\", \"--qy\", \"{qy}\", \"--qz\", \"{qz}\", \"--qw\", \"{qw}\",\n                \
             \"--frame-id\", \"{parent}\", \"--child-frame-id\", \"{name}\",\n            ],\n        ),\n    ])\n",
        ),
    ),
    (
        None,
        ros(
            "ros2-yaml",
            "ROS 2 TransformStamped as YAML",
            "yaml",
            Line("#"),
            "header:\n  frame_id: {parent}\nchild_frame_id: {name}\ntransform:\n  translation:\n    x: {x_m}\n    y: {y_m}\n    \
             z: {z_m}\n  rotation:\n    x: {qx}\n    y: {qy}\n    z: {qz}\n    w: {qw}\n",
        ),
    ),
    (
        None,
        ros(
            "easy-handeye",
            "easy_handeye (ROS 1)",
            "yaml",
            Line("#"),
            "parameters:\n  eye_on_hand: true\n  robot_effector_frame: {parent}\n  tracking_base_frame: {name}\n\
             transformation:\n  qw: {qw}\n  qx: {qx}\n  qy: {qy}\n  qz: {qz}\n  x: {x_m}\n  y: {y_m}\n  z: {z_m}\n",
        )
        .of_carried(),
    ),
    (
        None,
        ros(
            "easy-handeye2",
            "easy_handeye2 (ROS 2)",
            "calib",
            Line("#"),
            "parameters:\n  name: {name}\n  calibration_type: eye_in_hand\n  robot_base_frame: base_link\n  \
             robot_effector_frame: {parent}\n  tracking_base_frame: {name}\n  tracking_marker_frame: ''\n  \
             freehand_robot_movement: true\n  move_group_namespace: /\n  move_group: manipulator\n\
             transform:\n  translation:\n    x: {x_m}\n    y: {y_m}\n    z: {z_m}\n  rotation:\n    x: {qx}\n    y: {qy}\n    \
             z: {qz}\n    w: {qw}\n",
        )
        .of_carried(),
    ),
    (
        Some("extrinsic-xyz"),
        ros(
            "urdf",
            "URDF origin",
            "urdf",
            Between("<!--", "-->"),
            "<origin xyz=\"{x_m} {y_m} {z_m}\" rpy=\"{a_rad} {b_rad} {c_rad}\"/>\n",
        )
        .units("metres, radians"),
    ),
    (
        None,
        program(
            "matrix",
            "4 × 4 matrix, plain (CloudCompare, Open3D)",
            "txt",
            Comment::None,
            "{r00} {r01} {r02} {x}\n{r10} {r11} {r12} {y}\n{r20} {r21} {r22} {z}\n0 0 0 1\n",
        ),
    ),
    (
        None,
        program(
            "matrix-column-major",
            "4 × 4 matrix, column by column (OpenGL, Eigen)",
            "txt",
            Comment::None,
            "{r00} {r10} {r20} 0\n{r01} {r11} {r21} 0\n{r02} {r12} {r22} 0\n{x} {y} {z} 1\n",
        )
        .remark("each line is a column"),
    ),
    (
        None,
        program(
            "matlab",
            "4 × 4 matrix, MATLAB",
            "m",
            Line("%"),
            "{name} = [{r00} {r01} {r02} {x}; {r10} {r11} {r12} {y}; {r20} {r21} {r22} {z}; 0 0 0 1];\n",
        ),
    ),
    (
        None,
        program(
            "numpy",
            "4 × 4 matrix, NumPy",
            "py",
            Line("#"),
            "import numpy as np\n\n{name} = np.array([\n    [{r00}, {r01}, {r02}, {x}],\n    [{r10}, {r11}, {r12}, {y}],\n    \
             [{r20}, {r21}, {r22}, {z}],\n    [0, 0, 0, 1],\n])\n",
        ),
    ),
    (
        None,
        program(
            "c",
            "4 × 4 matrix, C and C++",
            "h",
            Line("//"),
            "static const double {name}[4][4] = {\n    { {r00}, {r01}, {r02}, {x} },\n    { {r10}, {r11}, {r12}, {y} },\n    \
             { {r20}, {r21}, {r22}, {z} },\n    { 0, 0, 0, 1 },\n};\n",
        ),
    ),
    (
        None,
        program(
            "quaternion-wxyz",
            "Translation and quaternion, w first",
            "txt",
            Line("#"),
            "{x} {y} {z} {qw} {qx} {qy} {qz}\n",
        )
        .units("x y z mm, quaternion w x y z"),
    ),
    (
        None,
        program(
            "quaternion-xyzw",
            "Translation and quaternion, w last",
            "txt",
            Line("#"),
            "{x} {y} {z} {qx} {qy} {qz} {qw}\n",
        )
        .units("x y z mm, quaternion x y z w"),
    ),
];

const SIX_IN_DEGREES: &str = "X = {x}\nY = {y}\nZ = {z}\n{a_name} = {a}\n{b_name} = {b}\n{c_name} = {c}\n";
const SIX_IN_RADIANS: &str = "X = {x}\nY = {y}\nZ = {z}\n{a_name} = {a_rad}\n{b_name} = {b_rad}\n{c_name} = {c_rad}\n";

/// Six numbers to be typed, with the names that the pendant gives them.
fn six_numbers(convention: &'static PoseConvention) -> Format {
    use crate::geometry::notation::AngleUnit;
    let (units, template) = match convention.usual_angle_unit {
        AngleUnit::Degrees => (MM_DEG, SIX_IN_DEGREES),
        AngleUnit::Radians => ("mm, radians", SIX_IN_RADIANS),
    };
    Format {
        convention: Some(convention),
        ..other(Group::Pendant, convention.id, convention.label, units, "txt", Line("#"), template)
    }
}

/// All formats: controllers, ROS and programs, then six numbers for the pendant of every maker and order of angles.
pub fn formats() -> impl Iterator<Item = Format> + Clone {
    let table = TABLE
        .iter()
        .map(|(convention, format)| Format { convention: convention.and_then(PoseConvention::by_id), ..*format });
    table.chain(PoseConvention::all().map(six_numbers))
}
