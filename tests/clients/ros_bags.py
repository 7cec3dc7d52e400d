#!/usr/bin/env python3
"""Holds the import of ROS 2 bags against writers that others made.

    python tests/clients/ros_bags.py target/debug/handeye
    python tests/clients/ros_bags.py --fixtures tests/data/bags

A simulated robot goes to a few places, stands still at each, and a profiler measures all the while. The session is written
by rosbags and by mcap-ros2-support, in all kinds of messages, storages, compressions and byte orders; `handeye import` has
to give the poses and profiles of the places back. With --fixtures the bags are written for the tests that need no Python.
"""

import json
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
from mcap.writer import CompressionType
from mcap_ros2.writer import Writer as McapRos2Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin
from rosbags.rosbag2 import Writer as Rosbag2Writer
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types
NUM_STATIONS = 3
RATE_HZ = 10
STANDING_S = 0.7
MOVING_S = 0.4
NUM_POINTS = 8
START_S = 1_700_000_000
# Clouds and scans have single precision: at 0.3 m that is 15 nm, some products on top.
PROFILE_MM = 2e-4
POSE_MM = 1e-6
POSE_DEG = 1e-6


def quaternion(axis, angle_deg):
    half = math.radians(angle_deg) / 2
    length = math.sqrt(sum(a * a for a in axis))
    return [a / length * math.sin(half) for a in axis] + [math.cos(half)]


def times(a, b):
    """Of quaternions with the real part last."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]


def turned(q, v):
    inverse = [-q[0], -q[1], -q[2], q[3]]
    return times(times(q, [*v, 0.0]), inverse)[:3]


def place(idx):
    """Where the flange is at a station: metres, quaternion."""
    position = [0.5 + 0.03 * idx, -0.1 + 0.02 * idx * (-1) ** idx, 0.3 + 0.01 * idx]
    return position, times([1.0, 0.0, 0.0, 0.0], quaternion([1 + idx, 2, 3 - idx], 10 + 7 * idx))


def line(idx):
    """A profile at a station: x and z in metres, with a missing point."""
    points = [[(k - NUM_POINTS / 2) * 0.001, 0.06 + 0.001 * idx + 0.0002 * (k - 5) ** 2 / 10] for k in range(NUM_POINTS)]
    points[3 + idx][1] = math.nan
    return points


def recording():
    """Times in ns with pose and profile; the profiler measures between the poses."""
    moments = []
    period = STANDING_S + MOVING_S
    total = NUM_STATIONS * period
    for tick in range(int(total * RATE_HZ)):
        for offset, is_pose in ((0.0, True), (0.4 / RATE_HZ, False)):
            t = tick / RATE_HZ + offset
            idx = min(int(t / period), NUM_STATIONS - 1)
            part = max(0.0, (t - idx * period - STANDING_S) / MOVING_S)
            here, q = place(idx)
            if part > 0 and idx + 1 < NUM_STATIONS:
                there, _ = place(idx + 1)
                here = [a + (b - a) * part for a, b in zip(here, there)]
                q = times(q, quaternion([0, 0, 1], 30 * part * (1 - part) + 2 * part))
            # Where no further station follows the robot goes on for good.
            elif part > 0:
                here = [here[0] + 0.05 * part, here[1], here[2]]
            stamp = START_S * 10**9 + round(t * 1e9)
            moments.append((stamp, is_pose, here, q, idx))
    return moments


def header(stamp, frame):
    time = TYPES["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    return TYPES["std_msgs/msg/Header"](stamp=time, frame_id=frame)


def pose_stamped(stamp, position, q):
    pose = TYPES["geometry_msgs/msg/Pose"](
        position=TYPES["geometry_msgs/msg/Point"](*position), orientation=TYPES["geometry_msgs/msg/Quaternion"](*q)
    )
    return TYPES["geometry_msgs/msg/PoseStamped"](header=header(stamp, "base_link"), pose=pose)


def transform(stamp, parent, child, position, q):
    inner = TYPES["geometry_msgs/msg/Transform"](
        translation=TYPES["geometry_msgs/msg/Vector3"](*position), rotation=TYPES["geometry_msgs/msg/Quaternion"](*q)
    )
    return TYPES["geometry_msgs/msg/TransformStamped"](
        header=header(stamp, parent), child_frame_id=child, transform=inner
    )


def frames(stamp, position, q):
    """The flange as a chain: base_link -> arm (moves) -> wrist (moves) -> tool0 (static, elsewhere)."""
    shift, turn = STATIC
    # arm: position alone; wrist: the rotation, less the static end.
    inverse = [-turn[0], -turn[1], -turn[2], turn[3]]
    wrist = times(q, inverse)
    back = turned(wrist, shift)
    arm = [p - b for p, b in zip(position, back)]
    unit = [0.0, 0.0, 0.0, 1.0]
    return TYPES["tf2_msgs/msg/TFMessage"](
        transforms=[
            transform(stamp, "base_link", "arm", arm, unit),
            transform(stamp, "arm", "wrist", [0.0, 0.0, 0.0], wrist),
        ]
    )


STATIC = ([0.01, -0.02, 0.08], quaternion([1, 1, 0], 90))


def static_frames(stamp):
    shift, turn = STATIC
    transforms = [
        transform(stamp, "wrist", "tool0", shift, turn),
        transform(stamp, "world", "base_link", [3.0, 2.0, 1.0], quaternion([0, 0, 1], 45)),
    ]
    return TYPES["tf2_msgs/msg/TFMessage"](transforms=transforms)


def laser_scan(stamp, idx):
    """The line as rays: x of the profile is y of the scan, z is x. Equal steps of angle: the points lie elsewhere."""
    points = rays(idx)
    return TYPES["sensor_msgs/msg/LaserScan"](
        header=header(stamp, "profiler"),
        angle_min=RAY_START,
        angle_max=RAY_START + RAY_STEP * (NUM_POINTS - 1),
        angle_increment=RAY_STEP,
        time_increment=0.0,
        scan_time=0.0,
        range_min=0.01,
        range_max=1.0,
        ranges=numpy.array(points, dtype=numpy.float32),
        intensities=numpy.array([], dtype=numpy.float32),
    )


RAY_START = float(numpy.float32(-0.12))
RAY_STEP = float(numpy.float32(0.015))


def rays(idx):
    ranges = [0.06 + 0.001 * idx + 0.0001 * (k % 5) for k in range(NUM_POINTS)]
    ranges[3 + idx] = math.inf
    return ranges


def field(name, offset, datatype):
    return TYPES["sensor_msgs/msg/PointField"](name=name, offset=offset, datatype=datatype, count=1)


def point_cloud(stamp, idx, is_double=False, with_intensity=False, is_column=False):
    """Points in the plane y = 0: x and z are the profile's own."""
    size, datatype, kind = (8, 8, "f8") if is_double else (4, 7, "f4")
    step = 3 * size + (8 if with_intensity else 0)
    data = b""
    for x, z in line(idx):
        data += numpy.array([x, 0.0, z], dtype="<" + kind).tobytes()
        data += b"\x2a" * (step - 3 * size)
    height, width = (NUM_POINTS, 1) if is_column else (1, NUM_POINTS)
    fields = [field(name, size * k, datatype) for k, name in enumerate("xyz")]
    if with_intensity:
        fields.insert(0, field("intensity", 3 * size, 7))
    return TYPES["sensor_msgs/msg/PointCloud2"](
        header=header(stamp, "profiler"),
        height=height,
        width=width,
        fields=fields,
        is_bigendian=False,
        point_step=step,
        row_step=step * width,
        data=numpy.frombuffer(data, dtype=numpy.uint8),
        is_dense=False,
    )


def messages(poses, profiles, has_stamp=True):
    """(topic, type, log time, message) of the whole recording."""
    moments = recording()
    first = moments[0][0]
    if poses == "tf":
        yield "/tf_static", "tf2_msgs/msg/TFMessage", first, static_frames(first)
    for stamp, is_pose, position, q, idx in moments:
        # The recorder is a little late, unless its time is all there is.
        log_time = stamp + 2_000_000 if has_stamp else stamp
        said = stamp if has_stamp else 0
        if is_pose and poses == "tf":
            yield "/tf", "tf2_msgs/msg/TFMessage", log_time, frames(said, position, q)
        elif is_pose:
            yield "/tcp_pose", "geometry_msgs/msg/PoseStamped", log_time, pose_stamped(said, position, q)
        elif profiles == "scan":
            yield "/scan", "sensor_msgs/msg/LaserScan", log_time, laser_scan(said, idx)
        else:
            yield "/points", "sensor_msgs/msg/PointCloud2", log_time, point_cloud(said, idx, **profiles)


NUM_SWEEPS = 2
NUM_STEPS = 5


def sweep_places():
    """A robot that steps over a ball along its tool's y, with another orientation the second time."""
    for sweep in range(NUM_SWEEPS):
        position, q = place(sweep)
        along = turned(q, [0.0, 1.0, 0.0])
        for step in range(NUM_STEPS):
            yield [p + 0.001 * step * a for p, a in zip(position, along)], q, sweep


def sweep_messages():
    """Stays of 0.7 s at 10 Hz, one behind the other, each with profiles between its poses."""
    stamp = START_S * 10**9
    yield "/tf_static", "tf2_msgs/msg/TFMessage", stamp, static_frames(stamp)
    for position, q, sweep in sweep_places():
        for _ in range(int(STANDING_S * RATE_HZ)):
            yield "/tf", "tf2_msgs/msg/TFMessage", stamp, frames(stamp, position, q)
            between = stamp + 40_000_000
            yield "/points", "sensor_msgs/msg/PointCloud2", between, point_cloud(between, sweep)
            stamp += 10**9 // RATE_HZ
        # On the way nothing is sent; it is short.
        stamp += 10**9 // RATE_HZ


def check_sweeps(session, is_joined):
    places = list(sweep_places())
    captures = [capture for station in session["stations"] for capture in station["captures"]]
    counts = [len(station["captures"]) for station in session["stations"]]
    assert counts == ([NUM_STEPS] * NUM_SWEEPS if is_joined else [1] * len(places)), f"captures: {counts}"
    for capture, (position, _, _) in zip(captures, places):
        found = capture["base_from_flange"]["translation_mm"]
        apart = max(abs(a - 1000 * b) for a, b in zip(found, position))
        assert apart < POSE_MM, f"{apart} mm"


def write_rosbags(folder, written, plugin, compression=None, is_little_endian=True):
    writer = Rosbag2Writer(folder, version=9, storage_plugin=plugin)
    if compression:
        writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for topic, kind, time, message in written:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], time, STORE.serialize_cdr(message, kind, little_endian=is_little_endian))


def plain(message):
    """As mcap-ros2-support takes it."""
    if hasattr(message, "__dataclass_fields__"):
        names = [name for name in message.__dataclass_fields__ if name != "__msgtype__"]
        return {name: plain(getattr(message, name)) for name in names}
    if isinstance(message, numpy.ndarray):
        return message.tolist()
    if isinstance(message, list):
        return [plain(part) for part in message]
    return message


def write_mcap(path, written, compression, is_indexed=True):
    with open(path, "wb") as stream:
        writer = McapRos2Writer(stream, compression=compression, chunk_size=4096)
        schemas = {}
        for topic, kind, time, message in written:
            if kind not in schemas:
                text, _ = STORE.generate_msgdef(kind, ros_version=2)
                schemas[kind] = writer.register_msgdef(kind, text)
            writer.write_message(topic=topic, schema=schemas[kind], message=plain(message), log_time=time, publish_time=time)
        writer.finish()
    if not is_indexed:
        cut_summary(path)


def cut_summary(path):
    """What a recorder that was killed leaves: everything up to the end of the data, and half a record."""
    raw = path.read_bytes()
    summary = int.from_bytes(raw[-28:-20], "little")
    path.write_bytes(raw[: summary - 13 - 5])


# Name, how it is written, whether scans or clouds.
SCAN = "scan"
CASES = {
    "pose_scan_zstd": (
        lambda to: write_mcap(to.with_suffix(".mcap"), messages("pose", SCAN), CompressionType.ZSTD),
        SCAN,
    ),
    "tf_cloud_db3": (lambda to: write_rosbags(to, messages("tf", {}), StoragePlugin.SQLITE3), "cloud"),
    "pose_cloud_f64_lz4": (
        lambda to: write_mcap(to.with_suffix(".mcap"), messages("pose", {"is_double": True}), CompressionType.LZ4),
        "cloud",
    ),
    "tf_scan_unstamped_plain": (
        lambda to: write_mcap(to.with_suffix(".mcap"), messages("tf", SCAN, has_stamp=False), CompressionType.NONE),
        SCAN,
    ),
    "big_endian": (
        lambda to: write_rosbags(
            to, messages("pose", {"with_intensity": True, "is_column": True}), StoragePlugin.MCAP, is_little_endian=False
        ),
        "cloud",
    ),
    "cut_off": (
        lambda to: write_mcap(to.with_suffix(".mcap"), messages("pose", SCAN), CompressionType.ZSTD, is_indexed=False),
        SCAN,
    ),
}
# Of a robot that stood still at each step of a sweep.
SWEEPS = {
    "sweep_mcap": lambda to: write_mcap(to.with_suffix(".mcap"), sweep_messages(), CompressionType.ZSTD),
    "sweep_db3": lambda to: write_rosbags(to, sweep_messages(), StoragePlugin.SQLITE3),
}
# Bags that have to be refused, with a word of the reason.
REFUSED = {
    "zstd_messages": (
        lambda to: write_rosbags(to, messages("pose", SCAN), StoragePlugin.SQLITE3, CompressionMode.MESSAGE),
        "compressed",
    ),
    "zstd_file": (
        lambda to: write_rosbags(to, messages("pose", SCAN), StoragePlugin.SQLITE3, CompressionMode.FILE),
        "zstd -d",
    ),
}


def expected_profile(idx, kind):
    """x and z in mm; None where there is no point."""
    if kind == SCAN:
        ranges = rays(idx)
        angles = [RAY_START + RAY_STEP * k for k in range(NUM_POINTS)]
        points = [
            (r * math.sin(a), r * math.cos(a)) if math.isfinite(r) else (None, None) for r, a in zip(ranges, angles)
        ]
    else:
        points = line(idx)
    return [[v if v is None or math.isnan(v) else 1000 * v for v in point] for point in points]


def check_session(session, kind):
    stations = session["stations"]
    assert len(stations) == NUM_STATIONS, f"{len(stations)} stations"
    for idx, station in enumerate(stations):
        (capture,) = station["captures"]
        position, q = place(idx)
        pose = capture["base_from_flange"]
        apart = max(abs(a - 1000 * b) for a, b in zip(pose["translation_mm"], position))
        w, x, y, z = pose["quaternion_wxyz"]
        inverse = [-x, -y, -z, w]
        turn = times(q, inverse)
        angle = math.degrees(2 * math.asin(min(1.0, math.sqrt(sum(part * part for part in turn[:3])))))
        assert apart < POSE_MM and angle < POSE_DEG, f"station {idx}: {apart} mm, {angle} deg"
        points = list(zip(capture["profile"]["x_mm"], capture["profile"]["z_mm"]))
        expected = expected_profile(idx, kind)
        assert len(points) == len(expected), f"station {idx}: {len(points)} points"
        for found, wanted in zip(points, expected):
            if wanted[1] is None or math.isnan(wanted[1]):
                assert found[1] is None, f"station {idx}: a point where none is"
            else:
                off = max(abs(a - b) for a, b in zip(found, wanted))
                assert off < PROFILE_MM, f"station {idx}: {off} mm"


def written_path(folder, name):
    for path in (folder / name, (folder / name).with_suffix(".mcap")):
        if path.exists():
            return path
    raise AssertionError(f"{name} was not written")


def check(program):
    failed = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)

        def run(name, *options):
            out = folder / f"{name}{len(options)}.json"
            command = [program, "import", str(written_path(folder, name)), "--target", "point", "--out", str(out), *options]
            return subprocess.run(command, capture_output=True, text=True, timeout=60), out

        for name, (write, kind) in CASES.items():
            write(folder / name)
            done, out = run(name)
            try:
                assert done.returncode == 0, done.stderr
                check_session(json.loads(out.read_text()), kind)
                print(f"ok: {name}")
            except AssertionError as error:
                print(f"failed: {name}: {error}")
                failed += 1
        for name, write in SWEEPS.items():
            write(folder / name)
            for options in ([], ["--separate-stays"]):
                done, out = run(name, *options)
                try:
                    assert done.returncode == 0, done.stderr
                    check_sweeps(json.loads(out.read_text()), not options)
                    print(f"ok: {name} {' '.join(options)}")
                except AssertionError as error:
                    print(f"failed: {name} {options}: {error}")
                    failed += 1
        for name, (write, reason) in REFUSED.items():
            write(folder / name)
            done, _ = run(name)
            is_right = done.returncode == 2 and reason in done.stderr and len(done.stderr.splitlines()) == 1
            print(f"{'ok' if is_right else 'failed'}: {name} is refused: {done.stderr.strip()}")
            failed += not is_right
    return 1 if failed else 0


def write_fixtures(folder):
    folder.mkdir(parents=True, exist_ok=True)
    expected = []
    for idx in range(NUM_STATIONS):
        position, q = place(idx)
        profiles = {kind: expected_profile(idx, kind) for kind in (SCAN, "cloud")}
        clean = {
            kind: [[None if v is None or math.isnan(v) else v for v in point] for point in points]
            for kind, points in profiles.items()
        }
        expected.append({"translation_mm": [1000 * p for p in position], "quaternion_xyzw": q, **clean})
    (folder / "expected.json").write_text(json.dumps(expected))
    for name, (write, _) in CASES.items():
        path = folder / name
        shutil.rmtree(path, ignore_errors=True)
        write(path)


if __name__ == "__main__":
    if len(sys.argv) == 3 and sys.argv[1] == "--fixtures":
        write_fixtures(Path(sys.argv[2]))
    else:
        sys.exit(check(sys.argv[1]))
