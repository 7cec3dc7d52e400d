#!/usr/bin/env python3
"""Holds the tool frames that `handeye tool-frame` writes against robodk's conventions.

    python tests/clients/tool_frames.py target/debug/handeye

Takes random poses, and the half turns and right angles at which angles are ambiguous, writes each in every format that
robodk knows, reads the numbers from the text, and turns them back into a matrix with robodk.
"""

import math
import random
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from robodk import robomath

SEED = 20260101
NUM_RANDOM = 40
# Three decimals of a millimetre and four of a degree, at most three of them added up.
TRANSLATION_MM = 0.0009
ROTATION_DEG = 0.0002
NUMBER = r"[-+]?\d+(?:\.\d+)?"


def degrees(angles):
    return [math.degrees(angle) for angle in angles]


def of_quaternion(x, y, z, quaternion_wxyz):
    pose = robomath.quaternion_2_pose(quaternion_wxyz)
    pose.setPos([x, y, z])
    return pose


def metres(numbers):
    return [1000 * number for number in numbers]


# Format: the lines that hold its six or seven numbers, in order, and how robodk reads them.
FORMATS = {
    "fanuc-ls": (r"PR\[81,\d\]=\(?(NUMBER)\)?", lambda n: robomath.Fanuc_2_Pose(n)),
    "fanuc-rmi": (r'"[XYZWPR]":(NUMBER)', lambda n: robomath.Fanuc_2_Pose(n)),
    "abb-rapid": (
        r"\[\[(NUMBER),(NUMBER),(NUMBER)\],\[(NUMBER),(NUMBER),(NUMBER),(NUMBER)\]\]",
        lambda n: of_quaternion(*n[:3], n[3:]),
    ),
    "kuka-config": (r"[XYZABC] (NUMBER)", lambda n: robomath.KUKA_2_Pose(n)),
    "ur-script": (
        r"p\[(NUMBER),(NUMBER),(NUMBER),(NUMBER),(NUMBER),(NUMBER)\]",
        lambda n: robomath.UR_2_Pose(metres(n[:3]) + n[3:]),
    ),
    "yaskawa-inform": (
        r"SETE P00100 \(\d\) (NUMBER)",
        lambda n: robomath.Motoman_2_Pose([v / 1e3 for v in n[:3]] + [v / 1e4 for v in n[3:]]),
    ),
    "staubli-val3": (r' (?:x|y|z|rx|ry|rz)="(NUMBER)"', lambda n: robomath.Staubli_2_Pose(n)),
    "kawasaki-as": (r"[(,](NUMBER)", lambda n: robomath.Adept_2_Pose(n)),
    "comau-pdl2": (r"[(,](NUMBER)", lambda n: robomath.Comau_2_Pose(n)),
    "mitsubishi-melfa": (r"[(,](NUMBER)", lambda n: robomath.Fanuc_2_Pose(n)),
    "urdf": (
        r'[" ](NUMBER)(?=[" ])',
        lambda n: robomath.xyzrpw_2_pose(metres(n[:3]) + degrees(n[3:])),
    ),
    "ros2-command": (
        r"--q?[xyzw] (NUMBER)",
        lambda n: of_quaternion(*metres(n[:3]), [n[6], n[3], n[4], n[5]]),
    ),
}
COMMENTS = ("!", ";", "#", "'", "--", "<!--")


def poses():
    rng = random.Random(SEED)
    for _ in range(NUM_RANDOM):
        quaternion = [rng.gauss(0, 1) for _ in range(4)]
        norm = math.sqrt(sum(q * q for q in quaternion))
        yield of_quaternion(*[rng.uniform(-500, 500) for _ in range(3)], [q / norm for q in quaternion])
    for idx in range(64):
        x, y, z = [math.pi / 2 * (idx // 4**power % 4) for power in range(3)]
        yield robomath.transl(12.3456, -0.0004, 250) * robomath.rotz(z) * robomath.roty(y) * robomath.rotx(x)


def numbers_of(text, name, pattern):
    body = text if name == "fanuc-ls" else "\n".join(
        line for line in text.splitlines() if not line.lstrip().startswith(COMMENTS)
    )
    found = re.findall(pattern.replace("NUMBER", NUMBER), body)
    return [float(number) for match in found for number in ([match] if isinstance(match, str) else match)]


def difference(a, b):
    off = a.inv() * b
    trace = sum(off[i, i] for i in range(3))
    # By the sine of the half angle, which is exact where the angle is small.
    skew = [off[2, 1] - off[1, 2], off[0, 2] - off[2, 0], off[1, 0] - off[0, 1]]
    angle = math.atan2(math.sqrt(sum(s * s for s in skew)), trace - 1)
    return math.dist(a.Pos(), b.Pos()), math.degrees(angle)


def main(binary):
    worst = {name: [0.0, 0.0] for name in FORMATS}
    with tempfile.TemporaryDirectory() as folder:
        matrix = Path(folder) / "matrix.txt"
        for pose in poses():
            matrix.write_text("\n".join(" ".join(repr(float(pose[row, column])) for column in range(4)) for row in range(4)))
            arguments = [argument for name in FORMATS for argument in ("--format", name)]
            subprocess.run(
                [binary, "tool-frame", matrix, *arguments, "--out", folder, "--force"], check=True, capture_output=True
            )
            for name, (pattern, read) in FORMATS.items():
                [file] = Path(folder).glob(f"{name}.*")
                again = read(numbers_of(file.read_text(encoding="utf-8"), name, pattern))
                for idx, off in enumerate(difference(pose, again)):
                    worst[name][idx] = max(worst[name][idx], off)
    failed = False
    for name, (translation_mm, rotation_deg) in worst.items():
        is_good = translation_mm <= TRANSLATION_MM and rotation_deg <= ROTATION_DEG
        failed = failed or not is_good
        print(f"{'ok  ' if is_good else 'FAIL'} {name}: off by at most {translation_mm:.5f} mm, {rotation_deg:.6f}°")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
