#!/usr/bin/env python3
"""Compares odometry and the calibration from motions with what OpenCV and Open3D make of the same data.

    python tests/clients/compare_motion.py target/release/handeye

It needs the packages of compare_requirements.txt; without Open3D (which needs the system's libusb) its rows are left out, and it
says so. Prints tables in Markdown:

A. RGB-D odometry of a simulated room, 640 × 480 pixels, 60 frames at 30 Hz, carried by hand, robot and vehicle. Errors of all by
   evo. Times are the mean over all frames, keyframes included, decoding apart, the alignment of depth to colour included.
B. Depth to colour, of the hand's first frame.
C. A X = X B from simulated poses of a board, the noise of robot and board stated and not stated. The bound is the covariance that
   ours states with the noise known.

Times are those of the processor, of one thread, and the least of a few runs: what else the machine does counts little. Of our
command's time the part is taken that its own clock gives to the motion. The times of our alignment and calibration without the start of the program are those that `cargo bench --bench odometry` and
`cargo bench --bench motion` left beside the program. Ends with 1 if another is more accurate than ours in a figure of A, or in C.
"""

import os

# Before the libraries are loaded, which read it then.
os.environ["OMP_NUM_THREADS"] = "1"

import csv
import json
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy
from evo.core import transformations

import rival_odometry
from evo_check import by_evo
from rival_odometry import inverse, matrix_of, pose_of

CARRIERS = {"hand": ["--hand-held"], "robot": ["--on-robot"], "vehicle": []}
NUM_FRAMES = 60
RIVALS = {
    "OpenCV: KLT + PnP": rival_odometry.KltPnp,
    "OpenCV: ORB + PnP": rival_odometry.OrbPnp,
    "OpenCV: RgbdOdometry": rival_odometry.OpencvRgbd,
    "Open3D: hybrid": rival_odometry.Open3dHybrid,
}
OUR_RUNS = 4
RIVAL_RUNS = 2
ALIGNMENT_RUNS = 100

# Poses of a problem, and how many problems: OpenCV takes a second for 500 poses.
PROBLEMS = {30: 50, 500: 4}
CALIBRATION_NOISE = ["--position-std-mm", "0.05", "--orientation-std-deg", "0.02"]
FORMS = {
    "OpenCV: Tsai": cv2.CALIB_HAND_EYE_TSAI,
    "OpenCV: Park": cv2.CALIB_HAND_EYE_PARK,
    "OpenCV: Horaud": cv2.CALIB_HAND_EYE_HORAUD,
    "OpenCV: Andreff": cv2.CALIB_HAND_EYE_ANDREFF,
    "OpenCV: Daniilidis": cv2.CALIB_HAND_EYE_DANIILIDIS,
}
# Of the problem with both unknowns, A X B = Z.
FORMS_OF_BOTH = {
    "OpenCV: Shah": cv2.CALIB_ROBOT_WORLD_HAND_EYE_SHAH,
    "OpenCV: Li": cv2.CALIB_ROBOT_WORLD_HAND_EYE_LI,
}


def run(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], check=True, capture_output=True, text=True)
    return done.stdout


def criterion_ms(program, *names):
    """The least that `cargo bench` measured last of a benchmark, beside this program."""
    path = Path(program).resolve().parent.parent.joinpath("criterion", *names, "new", "sample.json")
    if not path.exists():
        return None
    samples = json.loads(path.read_text())
    return min(time_ns / num for time_ns, num in zip(samples["times"], samples["iters"])) / 1e6


def as_ms(value):
    return "not measured" if value is None else f"{value:.2f}" if value < 10 else f"{value:.0f}"


class Table:
    """Markdown, a line at a time, so that one sees it grow."""

    def __init__(self, *heads):
        self.row(*heads)
        self.row(*["---"] * len(heads))

    @staticmethod
    def row(*cells):
        print(f"| {' | '.join(cells)} |", flush=True)


class Sequence:
    """The decoded pictures of a folder."""

    def __init__(self, folder):
        self.folder = folder
        self.camera = json.loads((folder / "camera.json").read_text())
        lines = (folder / "associations.txt").read_text().splitlines()
        entries = [line.split() for line in lines if not line.startswith("#")]
        self.frames = [
            (float(time_s), cv2.imread(str(folder / color)), cv2.imread(str(folder / depth), cv2.IMREAD_UNCHANGED))
            for time_s, color, _, depth in entries
        ]


def by_ours(program, folder, options):
    """The trajectory, and the time a frame, ms."""
    with tempfile.TemporaryDirectory() as out:
        before_s = os.times().children_user
        file = json.loads(run(program, "odometry", folder, "--json", "--out", out, *options))
        used_ms = 1000 * (os.times().children_user - before_s)
        with (Path(out) / "frames.csv").open() as lines:
            frames = list(csv.DictReader(lines))
    motion_ms, decode_ms = (sum(float(frame[column]) for frame in frames) for column in ("motion_ms", "decode_ms"))
    return file["trajectory"], used_ms * motion_ms / (motion_ms + decode_ms) / len(frames)


def by_rival(rival, sequence):
    """The same of another estimator."""
    estimator = rival(matrix_of(sequence.camera["color"]))
    registration = rival_odometry.Registration(sequence.camera)
    trajectory = []
    started = time.process_time()
    for time_s, color, depth in sequence.frames:
        pose = estimator.pose(color, registration.metres(depth))
        if pose is not None:
            trajectory.append((time_s, pose))
    used_ms = 1000 * (time.process_time() - started)
    rows = []
    for time_s, pose in trajectory:
        w, x, y, z = transformations.quaternion_from_matrix(pose)
        rows.append([time_s, *pose[:3, 3], x, y, z, w])
    return rows, used_ms / len(sequence.frames)


def compare_odometry(program, folder):
    """Returns the sequence of the hand, and whether nothing is more accurate than ours."""
    print(f"\n### RGB-D odometry, 640 × 480, {NUM_FRAMES} frames\n")
    if rival_odometry.open3d is None:
        print(f"Open3D is not there: {rival_odometry.WITHOUT_OPEN3D}.\n")
    table = Table("camera", "estimator", "ATE mm", "RPE mm", "RPE °", "tracked", "ms a frame")
    all_well, sequences = True, {}
    for carrier, options in CARRIERS.items():
        session = folder / f"{carrier}.json"
        run(program, "simulate", "--target", "room", "--frames", NUM_FRAMES, *options, "--out", session)
        sequence = sequences[carrier] = Sequence(folder / json.loads(session.read_text())["sequence"])
        estimators = {
            "ours": (OUR_RUNS, by_ours, program, sequence.folder, []),
            "published": (OUR_RUNS, by_ours, program, sequence.folder, ["--published"]),
        }
        for name, rival in RIVALS.items():
            if "Open3D" not in name or rival_odometry.open3d is not None:
                estimators[name] = (RIVAL_RUNS, by_rival, rival, sequence)
        figures = {}
        for name, (num_runs, estimate, *arguments) in estimators.items():
            outcomes = [estimate(*arguments) for _ in range(num_runs)]
            rows = outcomes[0][0]
            errors = by_evo(sequence.folder, rows)
            found = figures[name] = (
                1000 * errors["ate_rmse_m"],
                1000 * errors["rpe_trans_rmse_m"],
                errors["rpe_rot_rmse_deg"],
            )
            cells = [f"{found[0]:.2f}", f"{found[1]:.3f}", f"{found[2]:.4f}", f"{len(rows)} of {NUM_FRAMES}"]
            table.row(carrier, name, *cells, f"{min(frame_ms for _, frame_ms in outcomes):.1f}")
            all_well &= not any(theirs < ours for theirs, ours in zip(found, figures["ours"]))
    return sequences["hand"], all_well


def by_z_buffer(camera):
    """The alignment as one writes it with numba; None without numba. A depth pixel covers one colour pixel: there are holes."""
    try:
        import numba
    except ImportError:
        return None
    of_color, of_depth = matrix_of(camera["color"]), matrix_of(camera["depth"])
    color_from_depth = pose_of(camera["color_from_depth"])
    by_pixel = (of_color @ color_from_depth[:3, :3] @ numpy.linalg.inv(of_depth)).astype(numpy.float32)
    shift = (of_color @ color_from_depth[:3, 3] * camera["depth_scale"] / 1000).astype(numpy.float32)
    height, width = camera["color"]["height"], camera["color"]["width"]

    @numba.njit(fastmath=True)
    def aligned(depth):
        nearest = numpy.full((height, width), 65535, numpy.uint16)
        for row in range(depth.shape[0]):
            for column in range(depth.shape[1]):
                d = numpy.float32(depth[row, column])
                if d > 0:
                    x = d * (by_pixel[0, 0] * column + by_pixel[0, 1] * row + by_pixel[0, 2]) + shift[0]
                    y = d * (by_pixel[1, 0] * column + by_pixel[1, 1] * row + by_pixel[1, 2]) + shift[1]
                    z = d * (by_pixel[2, 0] * column + by_pixel[2, 1] * row + by_pixel[2, 2]) + shift[2]
                    u, v = int(x / z + numpy.float32(0.5)), int(y / z + numpy.float32(0.5))
                    if 0 <= u < width and 0 <= v < height and z < nearest[v, u]:
                        nearest[v, u] = numpy.uint16(z)
        for row in range(height):
            for column in range(width):
                if nearest[row, column] == 65535:
                    nearest[row, column] = 0
        return nearest

    return aligned


def compare_alignment(program, sequence):
    print("\n### Depth to colour, 640 × 480\n")
    depth = sequence.frames[0][2]
    registration = rival_odometry.Registration(sequence.camera)
    ways = {
        "OpenCV: registerDepth, dilated": lambda: registration.units(depth),
        "OpenCV: registerDepth, with holes": lambda: registration.units(depth, is_dilated=False),
    }
    z_buffer = by_z_buffer(sequence.camera)
    if z_buffer is not None:
        ways["numba: z-buffer, with holes"] = lambda: z_buffer(depth)
    table = Table("", "ms", "pixels with depth")
    table.row("ours (criterion)", as_ms(criterion_ms(program, "640 x 480", "depth to colour")), "")
    for name, align in ways.items():
        covered = numpy.count_nonzero(align()) / depth.size
        table.row(name, as_ms(1000 * least_s(align, ALIGNMENT_RUNS)), f"{100 * covered:.1f} %")


def least_s(task, num_runs):
    def timed():
        started = time.process_time()
        task()
        return time.process_time() - started

    return min(timed() for _ in range(num_runs))


def in_metres(poses):
    """As OpenCV takes them: rotations, translations."""
    return [pose[:3, :3] for pose in poses], [pose[:3, 3] / 1000 for pose in poses]


def of_metres(rotation, shift_m):
    pose = numpy.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, 1000 * shift_m.ravel()
    return pose


class Problem:
    """Simulated poses of a board, mm, and what calibrations of them are off."""

    def __init__(self, program, folder, num_poses, seed):
        self.program, self.path = program, folder / "poses.json"
        options = ["--stations", num_poses, "--seed", seed, *CALIBRATION_NOISE, "--out", self.path]
        run(program, "simulate", "--target", "pose", *options)
        self.session = json.loads(self.path.read_text())
        captures = [station["captures"][0] for station in self.session["stations"]]
        self.truth = pose_of(self.session["truth"]["flange_from_sensor"])
        self.base_from_flange = [pose_of(capture["base_from_flange"]) for capture in captures]
        self.sensor_from_target = [pose_of(capture["sensor_from_target"]) for capture in captures]
        self.covariance = None

    def by_opencv(self, method):
        """The calibration in mm, and the time, ms."""
        lists = [*in_metres(self.base_from_flange), *in_metres(self.sensor_from_target)]
        started = time.process_time()
        rotation, shift_m = cv2.calibrateHandEye(*lists, method=method)
        used_ms = 1000 * (time.process_time() - started)
        return of_metres(rotation, shift_m), used_ms

    def by_opencv_of_both(self, method):
        """The same."""
        lists = [*in_metres(self.sensor_from_target), *in_metres([inverse(pose) for pose in self.base_from_flange])]
        started = time.process_time()
        _, _, rotation, shift_m = cv2.calibrateRobotWorldHandEye(*lists, method=method)
        used_ms = 1000 * (time.process_time() - started)
        return inverse(of_metres(rotation, shift_m)), used_ms

    def by_ours(self, is_stated):
        if not is_stated:
            for part, fields in {
                "robot": ("position_std_mm", "orientation_std_deg"),
                "target": ("translation_std_mm", "rotation_std_deg"),
            }.items():
                for field in fields:
                    del self.session[part][field]
            self.path.write_text(json.dumps(self.session))
        result = json.loads(run(self.program, "solve", self.path, "--json", "--no-diagnosis"))
        [method] = [method for method in result["methods"] if method["method"] == "motion"]
        if is_stated:
            # With the noise known, the covariance is the Cramér–Rao bound.
            self.covariance = numpy.array(method["uncertainty"]["covariance"])
        return pose_of(method["flange_from_sensor"])

    def errors(self, found):
        """Rotation (°), translation (mm), and both as a multiple of the bound, squared."""
        turn = cv2.Rodrigues(self.truth[:3, :3].T @ found[:3, :3])[0].ravel()
        shift = found[:3, 3] - self.truth[:3, 3]
        both = numpy.concatenate([turn, shift])
        over_bound = both @ numpy.linalg.solve(self.covariance, both) / 6
        return [math.degrees(numpy.linalg.norm(turn)), numpy.linalg.norm(shift), math.sqrt(over_bound)]


def compare_calibration(program, folder):
    """Returns whether nothing is more accurate than ours."""
    all_well = True
    for num_poses, num_problems in PROBLEMS.items():
        print(f"\n### A X = X B, {num_poses} poses, {num_problems} problems\n")
        errors, least_ms = {}, {}
        for seed in range(1, num_problems + 1):
            problem = Problem(program, folder, num_poses, seed)
            found = {"ours, noise stated": problem.by_ours(is_stated=True)}
            found["ours, noise found"] = problem.by_ours(is_stated=False)
            for solve, forms in ((problem.by_opencv, FORMS), (problem.by_opencv_of_both, FORMS_OF_BOTH)):
                for name, method in forms.items():
                    found[name], used_ms = solve(method)
                    least_ms[name] = min(used_ms, least_ms.get(name, math.inf))
            for name, pose in found.items():
                errors.setdefault(name, []).append(problem.errors(pose))
        for name in ("noise stated", "noise found"):
            least_ms[f"ours, {name}"] = criterion_ms(program, "motion", f"refined, {name}", str(num_poses))
        table = Table("", "RMS °", "RMS mm", "over the bound (largest)", "ms")
        over_bound = {}
        for name, rows in errors.items():
            rms, largest = numpy.sqrt(numpy.mean(numpy.square(rows), axis=0)), numpy.max(rows, axis=0)
            over_bound[name] = rms[2]
            table.row(name, f"{rms[0]:.4f}", f"{rms[1]:.3f}", f"{rms[2]:.2f} ({largest[2]:.1f})", as_ms(least_ms[name]))
        best = min(over_bound[name] for name in [*FORMS, *FORMS_OF_BOTH])
        all_well &= max(over_bound["ours, noise stated"], over_bound["ours, noise found"]) < best
    return all_well


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    program = str(Path(sys.argv[1]).resolve())
    cv2.setNumThreads(1)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        sequence, is_best_odometry = compare_odometry(program, folder)
        compare_alignment(program, sequence)
        is_best_calibration = compare_calibration(program, folder)
    for task, is_best in (("odometry", is_best_odometry), ("calibration", is_best_calibration)):
        if not is_best:
            print(f"failed: in a figure of {task} another is more accurate than ours")
    return 0 if is_best_odometry and is_best_calibration else 1


if __name__ == "__main__":
    sys.exit(main())
