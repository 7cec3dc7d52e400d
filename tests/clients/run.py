#!/usr/bin/env python3
"""Holds the simulated cell, the exported tool frames, the import of ROS 2 bags and the errors of trajectories against programs
that others wrote.

    python3 tests/clients/run.py target/debug/handeye [FOLDER]

Makes a virtual environment in FOLDER (a temporary one if none is named), installs the clients of requirements.txt there,
starts `handeye cell` for each protocol, runs checks.py, and runs tool_frames.py, ros_bags.py and evo_check.py. Ends with 0 if all is well, 1 if a check failed or a cell did not
start, and 3 with lines "skipped: ..." if something could not be checked: no clients, or no free ports.

compare_motion.py is run by itself: it takes minutes, large packages of its own, and a release build.
"""

import os
import queue
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

HERE = Path(__file__).resolve().parent
SKIPPED = 3
START_TIMEOUT_S = 30
INSTALL_TIMEOUT_S = 300
CHECK_TIMEOUT_S = 120
# Tried one after the other until the ports of a cell are free.
OFFSETS = range(7000, 30000, 1777)


# What a cell says of itself when it ends because of its ports.
PORT_PROBLEM = "--port-offset"


class Skipped(Exception):
    """Why nothing can be checked."""


class Failed(Exception):
    """What is wrong with a cell."""


def python_with_clients(folder):
    """Makes the environment, unless it is there already, and returns its Python."""
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    steps = [
        [sys.executable, "-m", "venv", str(folder)],
        [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", str(HERE / "requirements.txt")],
    ]
    for step in steps:
        try:
            done = subprocess.run(step, capture_output=True, text=True, timeout=INSTALL_TIMEOUT_S)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise Skipped(f"{step[1:4]} failed: {error}") from error
        if done.returncode != 0:
            reason = (done.stderr or done.stdout).strip().splitlines()
            raise Skipped(f"the clients cannot be installed: {reason[-1] if reason else 'no reason given'}")
    return python


class Cell:
    """A simulated cell that runs while it is used."""

    def __init__(self, program, robot, sensor, offsets):
        problems = []
        for self.offset in offsets:
            command = [program, "cell", "--robot", robot, "--sensor", sensor, "--noise-free"]
            command += ["--port-offset", str(self.offset)]
            self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            problem = self.wait_until_ready()
            if problem is None:
                return
            self.end()
            if PORT_PROBLEM not in problem:
                raise Failed(f"a cell with {robot} and {sensor} did not start: {problem}")
            problems.append(problem)
        raise Skipped(f"no cell with {robot} and {sensor} could be started: {problems[-1]}")

    def wait_until_ready(self):
        lines = queue.Queue()

        def read():
            for line in self.process.stdout:
                lines.put(line.strip())
            lines.put(None)

        threading.Thread(target=read, daemon=True).start()
        while True:
            try:
                line = lines.get(timeout=START_TIMEOUT_S)
            except queue.Empty:
                return f"it was not ready within {START_TIMEOUT_S} s"
            if line == "ready":
                return None
            if line is None:
                return self.process.stderr.read().strip() or "it ended without a word"

    def end(self):
        self.process.kill()
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()


def check(python, program, robot, sensor, names, offsets=OFFSETS):
    """Runs the named checks against a cell; returns whether they passed."""
    try:
        with Cell(program, robot, sensor, offsets) as cell:
            command = [str(python), str(HERE / "checks.py"), str(cell.offset), *names]
            return subprocess.run(command, timeout=CHECK_TIMEOUT_S).returncode == 0
    except subprocess.TimeoutExpired:
        print(f"failed: {', '.join(names)}: no end within {CHECK_TIMEOUT_S} s", flush=True)
        return False
    except Failed as reason:
        print(f"failed: {', '.join(names)}: {reason}", flush=True)
        return False
    except Skipped as reason:
        print(f"skipped: {', '.join(names)}: {reason}", flush=True)
        return None


def check_with(script, python, program):
    """Runs a script that needs no cell."""
    done = subprocess.run([str(python), str(HERE / script), program], timeout=CHECK_TIMEOUT_S, check=False)
    return done.returncode == 0


def main():
    if len(sys.argv) not in (2, 3):
        print(__doc__)
        return 2
    program = str(Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[2]).resolve() if len(sys.argv) == 3 else Path(temporary) / "clients"
        try:
            python = python_with_clients(folder)
        except Skipped as reason:
            print(f"skipped: {reason}", flush=True)
            return SKIPPED
        outcomes = [
            check(python, program, "mappdk", "ljv", ["fanucpy", "fanuc-python", "fanuc-logger", "ljv"]),
            # The receiving half of ur_rtde knows one port only.
            check(python, program, "ur", "ljv", ["ur-receive", "ur-dashboard", "ur-script"], offsets=[0]),
            check_with("tool_frames.py", python, program),
            check_with("ros_bags.py", python, program),
            check_with("evo_check.py", python, program),
        ]
    if False in outcomes:
        return 1
    return SKIPPED if None in outcomes else 0


if __name__ == "__main__":
    sys.exit(main())
