"""A bridge for Handeye, as an example: a pretend robot and a pretend profiler that looks at a ball.

    python3 bridge_example.py [ROBOT_PORT PROFILER_PORT]      (27015 and 27016; 0 takes any free port)

Python's standard library only. To make a bridge of it, replace the classes Robot and Profiler by calls to your
controller; what is below them is the protocol (docs/bridge.md) and can stay as it is.
"""

import contextlib
import json
import math
import socketserver
import sys
import threading
import time

BALL_IN_BASE, BALL_RADIUS = (500.0, 20.0, 30.0), 12.7  # mm
FLANGE_FROM_SENSOR = (40.0, 0.0, 60.0)  # mm; the sensor's axes are those of the flange
RANGE = 120.0  # from the head to the middle of its range, where z = 0, mm


def rotated(q, v):
    """The vector v turned by the unit quaternion q = (w, x, y, z)."""
    w, u = q[0], q[1:]
    c = cross(u, v)
    d = cross(u, c)
    return tuple(v[i] + 2 * (w * c[i] + d[i]) for i in range(3))


def cross(a, b):
    return tuple(a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3))


class Robot:
    """Goes straight, at the speed that it is told."""

    def __init__(self):
        self.lock = threading.RLock()
        self.start = self.target = ((460.0, 20.0, 210.0), (0.0, 1.0, 0.0, 0.0))  # flange in base, facing down
        self.began, self.takes = 0.0, 0.0

    def share(self):
        """How much of the way is done."""
        return 1.0 if self.takes <= 0 else min(1.0, (time.monotonic() - self.began) / self.takes)

    def pose(self):
        with self.lock:
            share, (p0, q0), (p1, q1) = self.share(), self.start, self.target
        if share >= 1.0:
            return p1, q1
        sign = 1.0 if sum(a * b for a, b in zip(q0, q1)) >= 0 else -1.0
        q = [a + (sign * b - a) * share for a, b in zip(q0, q1)]
        length = math.sqrt(sum(value * value for value in q))
        return tuple(a + (b - a) * share for a, b in zip(p0, p1)), tuple(value / length for value in q)

    def hello(self):
        return {"name": "pretend robot", "can_move": True, "resolution_mm": 0.001, "tool": "flange in base"}

    def state(self, _):
        position, quaternion = self.pose()
        pose = {"position_mm": position, "quaternion_wxyz": quaternion}
        return {"reply": "state", "pose": pose, "is_moving": self.share() < 1.0}

    def move(self, ask):
        position, quaternion = ask["pose"]["position_mm"], ask["pose"]["quaternion_wxyz"]
        if math.dist(position, (0.0, 0.0, 0.0)) > 900.0:
            return {"reply": "refused", "found": "the pose is out of reach", "remedy": "stay within 900 mm"}
        with self.lock:
            self.start = self.pose()
            self.target = (tuple(position), tuple(quaternion))
            cosine = abs(sum(a * b for a, b in zip(self.start[1], self.target[1])))
            turn_deg = math.degrees(2 * math.acos(min(1.0, cosine)))
            by_way = math.dist(self.start[0], position) / ask["speed_mm_s"]
            by_turn = turn_deg / ask["rotation_speed_deg_s"]
            self.began, self.takes = time.monotonic(), max(by_way, by_turn)
        return {"reply": "accepted"}

    def stop(self, _):
        with self.lock:
            self.start = self.target = self.pose()
            self.takes = 0.0
        return {"reply": "accepted"}


class Profiler:
    """Sees the ball from wherever the robot holds it."""

    def __init__(self, robot):
        self.robot, self.count = robot, 0

    def hello(self):
        return {"name": "pretend profiler"}

    def newest(self, _):
        position, q = self.robot.pose()
        self.count = (self.count + 1) % 2**32
        # The ball in the sensor's frame: the head is RANGE before z = 0, and z grows away from it.
        sensor = [p + d for p, d in zip(position, rotated(q, FLANGE_FROM_SENSOR))]
        back = (q[0], -q[1], -q[2], -q[3])
        ball = rotated(back, tuple(b - s for b, s in zip(BALL_IN_BASE, sensor)))
        x_mm = [round(-15.0 + 0.05 * i, 3) for i in range(601)]
        z_mm = []
        for x in x_mm:
            below = BALL_RADIUS**2 - ball[1] ** 2 - (x - ball[0]) ** 2
            z_mm.append(round(ball[2] - math.sqrt(below) - RANGE, 4) if below > 0 else None)
        return {"reply": "profile", "trigger_count": self.count, "x_mm": x_mm, "z_mm": z_mm}

    def forget(self, _):
        return {"reply": "accepted"}  # each profile is taken when it is asked for


class Bridge(socketserver.StreamRequestHandler):
    """One connection: a line of JSON comes, a line of JSON goes."""

    def handle(self):
        try:
            for line in self.rfile:
                ask = json.loads(line)
                reply = {"bridge": 1, "id": ask["id"]} | self.answer(ask)
                self.wfile.write(json.dumps(reply, allow_nan=False).encode() + b"\n")
        finally:
            if self.server.kind == "robot":
                self.server.device.stop(None)  # nobody looks after it any more

    def answer(self, ask):
        kind, device = self.server.kind, self.server.device
        if ask["bridge"] != 1:
            return {"reply": "refused", "found": f"version {ask['bridge']}", "remedy": "speak version 1"}
        if ask["request"] == "hello":
            return {"reply": "hello", "device": kind} | device.hello()
        if ask["request"] in {"robot": ("state", "move", "stop"), "profiler": ("newest", "forget")}[kind]:
            return getattr(device, ask["request"])(ask)
        return {"reply": "refused", "found": f"the request {ask['request']}", "remedy": "ask another device"}


def serve(kind, device, port):
    server = socketserver.ThreadingTCPServer(("127.0.0.1", port), Bridge, bind_and_activate=False)
    server.allow_reuse_address, server.daemon_threads = True, True
    server.server_bind()
    server.server_activate()
    server.kind, server.device = kind, device
    threading.Thread(target=server.serve_forever, daemon=True).start()
    print(f"{kind} at 127.0.0.1:{server.server_address[1]}", flush=True)


if __name__ == "__main__":
    ports = [int(port) for port in sys.argv[1:3]] or [27015, 27016]
    robot = Robot()
    serve("robot", robot, ports[0])
    serve("profiler", Profiler(robot), ports[1])
    with contextlib.suppress(KeyboardInterrupt):
        began = time.monotonic()
        if sys.stdin:
            sys.stdin.read()  # until its input ends, or Ctrl-C
        if time.monotonic() - began < 0.2:
            print("no input to wait for: serving until it is stopped (Ctrl-C, kill)", flush=True)
            threading.Event().wait()
