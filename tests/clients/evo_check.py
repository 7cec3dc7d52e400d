#!/usr/bin/env python3
"""Holds the errors that `handeye odometry` states against those of the package evo.

    python tests/clients/evo_check.py target/debug/handeye

A simulated room is recorded, and its ground truth spoilt in several ways: with noise, with poses missing, with other times.
Of the trajectory that handeye finds, evo and handeye have to state the same ATE and RPE against each of them.
"""

import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
from evo.core import metrics, sync
from evo.core.trajectory import PoseTrajectory3D
from evo.tools import file_interface

SEED = 20261
NUM_FRAMES = 24
# Six digits of each figure, and the last digit of what is printed of a trajectory in metres.
RELATIVE = 1e-6
ABSOLUTE = 1e-9


def by_handeye(program, folder):
    done = subprocess.run([program, "odometry", str(folder), "--json"], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def by_evo(folder, rows):
    truth = file_interface.read_tum_trajectory_file(str(folder / "groundtruth.txt"))
    table = numpy.array(rows)
    found = PoseTrajectory3D(
        positions_xyz=table[:, 1:4], orientations_quat_wxyz=table[:, [7, 4, 5, 6]], timestamps=table[:, 0]
    )
    truth, found = sync.associate_trajectories(truth, found, max_diff=0.01)

    def rmse(metric, pair):
        metric.process_data(pair)
        return metric.get_statistic(metrics.StatisticsType.rmse)

    relations = metrics.PoseRelation
    relative = [
        rmse(metrics.RPE(relation, delta=1, delta_unit=metrics.Unit.frames, all_pairs=False), (truth, found))
        for relation in (relations.translation_part, relations.rotation_angle_deg)
    ]
    found.align(truth, correct_scale=False)
    return {
        "ate_rmse_m": rmse(metrics.APE(relations.translation_part), (truth, found)),
        "rpe_trans_rmse_m": relative[0],
        "rpe_rot_rmse_deg": relative[1],
        "compared_poses": truth.num_poses,
    }


def spoilt(lines, rng, noise_m, noise_rad, keep, late_s):
    """The ground truth with other numbers."""
    for line in lines:
        if rng.random() > keep:
            continue
        time, *numbers = [float(word) for word in line.split()]
        position = [value + rng.gauss(0, noise_m) for value in numbers[:3]]
        quaternion = [value + rng.gauss(0, noise_rad / 2) for value in numbers[3:]]
        norm = math.sqrt(sum(value * value for value in quaternion))
        words = [time + late_s * rng.random(), *position, *(value / norm for value in quaternion)]
        yield " ".join(f"{word:.9f}" for word in words)


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    program = str(Path(sys.argv[1]).resolve())
    rng = random.Random(SEED)
    all_well = True
    with tempfile.TemporaryDirectory() as temporary:
        session = Path(temporary) / "room.json"
        command = [program, "simulate", "--target", "room", "--hand-held", "--out", str(session)]
        command += ["--frames", str(NUM_FRAMES), "--size", "160x120"]
        subprocess.run(command, check=True, capture_output=True)
        folder = session.parent / json.loads(session.read_text())["sequence"]
        path = folder / "groundtruth.txt"
        lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
        cases = {
            "the truth": (0.0, 0.0, 1.0, 0.0),
            "a noisy truth": (0.02, 0.03, 1.0, 0.0),
            "a truth with poses missing": (0.005, 0.01, 0.6, 0.0),
            "a truth of other times": (0.005, 0.01, 0.9, 0.015),
        }
        for name, case in cases.items():
            path.write_text("\n".join(spoilt(lines, rng, *case)) + "\n")
            found = by_handeye(program, folder)
            expected = by_evo(folder, found["trajectory"])
            for field, value in expected.items():
                if not math.isclose(found[field], value, rel_tol=RELATIVE, abs_tol=ABSOLUTE):
                    print(f"failed: evo, {name}: {field} is {found[field]}, evo has {value}", flush=True)
                    all_well = False
            figures = ", ".join(f"{field} {value:.7g}" for field, value in expected.items())
            print(f"evo, {name}: {figures}", flush=True)
    return 0 if all_well else 1


if __name__ == "__main__":
    sys.exit(main())
