"""What the clients of others find in a simulated cell; run by run.py in its environment: checks.py OFFSET NAME..."""

import statistics
import socket
import struct
import sys
import threading
import time
import traceback

HOST = "127.0.0.1"
STEP_MM = 0.5
# The wire has three decimals; the cell is free of noise.
READ_BACK_MM = 0.002
OUT_OF_REACH_MM = 4000.0
DEADLINE_S = 30.0


def expect(is_true, message):
    if not is_true:
        raise AssertionError(message)


def median_ms(ask, times=50):
    """Median time of a question, ms."""
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        ask()
        taken.append(1000 * (time.perf_counter() - start))
    return statistics.median(taken)


def wait_for(is_done, what):
    start = time.monotonic()
    while not is_done():
        expect(time.monotonic() - start < DEADLINE_S, f"{what}: not within {DEADLINE_S} s")
        time.sleep(0.01)
    return time.monotonic() - start


# FANUC MAPPDK


def check_step_back(step, before, after):
    moved = [b - a for a, b in zip(before[:3], after[:3])]
    off = max(abs(m - s) for m, s in zip(moved, [0.0, step, 0.0]))
    expect(off <= READ_BACK_MM, f"a step of {step} mm along Y was read back as {moved}")
    turned = max(abs((b - a + 180) % 360 - 180) for a, b in zip(before[3:6], after[3:6]))
    expect(turned <= READ_BACK_MM, f"the step turned the tool by {turned}°")
    return off


def fanucpy_check(offset):
    from fanucpy import Robot
    from fanucpy.robot import FanucError

    robot = Robot(robot_model="Fanuc", host=HOST, port=18735 + offset, socket_timeout=30)
    expect(robot.connect() == (0, "success"), "no greeting")
    joints = robot.get_curjpos()
    expect(len(joints) == 6, f"{len(joints)} joints")
    worst = 0.0
    for step in (STEP_MM, -STEP_MM):
        before = robot.get_curpos()
        expect(len(before) == 6, f"{len(before)} coordinates")
        target = [before[0], before[1] + step, *before[2:]]
        robot.move("pose", vals=target, velocity=20, acceleration=100, cnt_val=0, linear=True)
        worst = max(worst, check_step_back(step, before, robot.get_curpos()))
    robot.move("joint", vals=joints, velocity=20, acceleration=100, cnt_val=0, linear=False)
    back = max(abs(a - b) for a, b in zip(joints, robot.get_curjpos()))
    expect(back <= READ_BACK_MM, f"a move to the joints that were read is off by {back}°")
    try:
        robot.move("pose", vals=[OUT_OF_REACH_MM, *before[1:]], velocity=20, linear=True)
        expect(False, "a pose out of reach was accepted")
    except FanucError as error:
        expect(str(error) == "position-is-not-reachable", f"out of reach: {error}")
    answer_ms = median_ms(robot.get_curpos)
    robot.disconnect()
    return f"steps of ±{STEP_MM} mm read back to {worst:.4f} mm, curpos in {answer_ms:.2f} ms"


def fanuc_python_check(offset):
    from fanuc import FanucRobot
    from fanuc.exceptions import UnreachableError

    with FanucRobot(host=HOST, port=18735 + offset, timeout=30) as robot:
        expect(robot.driver_version is None, "plain MAPPDK knows no version")
        expect(robot.get_curjpos() is not None, "no joints")
        worst = 0.0
        for step in (STEP_MM, -STEP_MM):
            before = list(vars_of(robot.get_curpos()))
            robot.move_pose([before[0], before[1] + step, *before[2:]], velocity=20, linear=True)
            worst = max(worst, check_step_back(step, before, list(vars_of(robot.get_curpos()))))
        try:
            robot.move_pose([OUT_OF_REACH_MM, *before[1:]], velocity=20, linear=True)
            expect(False, "a pose out of reach was accepted")
        except UnreachableError:
            pass
        answer_ms = median_ms(robot.get_curpos)
    return f"steps of ±{STEP_MM} mm read back to {worst:.4f} mm, curpos in {answer_ms:.2f} ms"


def vars_of(pose):
    return (pose.x, pose.y, pose.z, pose.w, pose.p, pose.r)


def fanuc_logger_check(offset):
    """The pose on the second port while the first is busy with a move."""
    from fanucpy import Robot

    way_mm = 30.0
    mover, logger = (Robot("Fanuc", HOST, port=port + offset, socket_timeout=30) for port in (18735, 18736))
    mover.connect()
    logger.connect()
    start = logger.get_curpos()
    target = [start[0], start[1] + way_mm, *start[2:]]
    moving = threading.Thread(target=lambda: mover.move("pose", vals=target, velocity=30, linear=True))
    moving.start()
    seen = []
    while moving.is_alive():
        seen.append(logger.get_curpos()[1] - start[1])
        time.sleep(0.01)
    end = logger.get_curpos()
    expect(abs(end[1] - target[1]) <= READ_BACK_MM, f"stopped at {end}")
    underway = [y for y in seen if 0.5 < y < way_mm - 0.5]
    expect(len(underway) >= 5, f"only {len(underway)} poses under way")
    expect(all(b >= a - READ_BACK_MM for a, b in zip(seen, seen[1:])), "the pose went back")
    mover.move("pose", vals=start, velocity=60, linear=True)
    mover.disconnect()
    logger.disconnect()
    return f"{len(underway)} poses under way of a move of {way_mm:.0f} mm"


# Keyence LJ-V7000, with nothing but the description of the wire


class LjvClient:
    def __init__(self, offset):
        self.socket = socket.create_connection((HOST, 24691 + offset), timeout=DEADLINE_S)

    def take(self, length):
        data = b""
        while len(data) < length:
            part = self.socket.recv(length - len(data))
            expect(part, "the connection was closed")
            data += part
        return data

    def ask_raw(self, request):
        self.socket.sendall(request)
        prefix = self.take(4)
        return prefix + self.take(struct.unpack("<I", prefix)[0])

    def ask(self, command, data=b""):
        body = struct.pack("<B3x", command) + data
        return self.ask_raw(struct.pack("<IHHII", 12 + len(body), 1, 0x00F0, 0, len(body)) + body)


def check_reply(reply, command, code=0):
    prefix, version, direction, header_code, body_len = struct.unpack_from("<IHHB3xI", reply)
    expect(prefix == len(reply) - 4 == 12 + body_len, f"lengths {prefix}, {len(reply)}, {body_len}")
    expect((version, direction, header_code) == (1, 0xF000, 0), f"header {reply[:16].hex()}")
    expect((reply[16], reply[17]) == (command, code), f"command and code {reply[16:18].hex()}")


def unpacked(packed, count):
    values = []
    for pair in range(count // 2):
        b0, b1, b2, b3, b4 = packed[5 * pair : 5 * pair + 5]
        for raw in (b0 | b1 << 8 | (b2 & 15) << 16, b2 >> 4 | b3 << 4 | b4 << 12):
            values.append(raw - (1 << 20) if raw & 0x80000 else raw)
    return values


def ljv_check(offset):
    client = LjvClient(offset)
    reply = client.ask_raw(bytes.fromhex("14000000 0100f000 00000000 08000000 39000000 07000000"))
    golden = bytes.fromhex("18000000 010000f0 00000000 0c000000 39000000 00000000 07000000")
    expect(reply == golden, f"change of program: {reply.hex(' ', 4)}")
    golden = bytes.fromhex("20000000 0100f000 00000000 14000000 42000000 00000000 00000000 01000000 01010000")
    counts, num_valid = [], 0
    while len(counts) < 20:
        reply = client.ask_raw(golden)
        check_reply(reply, 0x42)
        expect(reply[24] == 7, "the program is not the one that was set")
        num, points, unit, first_x, pitch = struct.unpack_from("<B11xHHii", reply, 40)
        if num == 0:
            expect(len(reply) == 64, f"no profile in {len(reply)} bytes")
            continue
        expect((num, points, len(reply)) == (1, 800, 2092), f"{num} profiles of {points} points in {len(reply)} bytes")
        words = struct.unpack_from("<507I", reply, 64)
        expect(sum(words[:-1]) & 0xFFFFFFFF == words[-1], "the sum of the words differs")
        counts.append(words[1])
        raw = unpacked(reply[88:2088], points)
        num_valid = sum(value > -524285 for value in raw)
        expect(unit > 0 and pitch > 0 and first_x < 0, f"unit {unit}, x0 {first_x}, pitch {pitch}")
    expect(all(b > a for a, b in zip(counts, counts[1:])), f"trigger counts {counts}")
    none = golden[:32] + bytes(4)
    expect(len(client.ask_raw(none)) == 64, "a question for no profile has another answer")
    check_reply(client.ask(0x27), 0x27)
    check_reply(client.ask(0x7E), 0x7E, code=0x31)
    check_reply(client.ask(0x42, b"\0"), 0x42, code=0x32)
    # The newest may be asked for again where it is not to be forgotten.
    again_and_again = golden[:-3] + bytes(3)
    wait_for(lambda: len(client.ask_raw(again_and_again)) == 2092, "a profile after the memory was cleared")
    answer_ms = median_ms(lambda: expect(len(client.ask_raw(again_and_again)) == 2092, "no profile"))
    client.socket.close()
    for _ in range(3):
        again = LjvClient(offset)
        check_reply(again.ask_raw(golden), 0x42)
        again.socket.close()
    return f"20 profiles with {num_valid} of 800 points valid in the last, get profile in {answer_ms:.2f} ms"


# Universal Robots


def pose_error(a, b):
    return max(abs(x - y) for x, y in zip(a[:3], b[:3]))


def ur_receive_check(offset):
    import rtde_receive

    expect(offset == 0, "this client knows one port only")
    receive = rtde_receive.RTDEReceiveInterface(HOST)
    expect(receive.isConnected(), "not connected")
    first = receive.getTimestamp()
    wait_for(lambda: receive.getTimestamp() > first + 0.5, "half a second of timestamps")
    pose, joints = receive.getActualTCPPose(), receive.getActualQ()
    expect(len(pose) == 6 and len(joints) == 6, f"pose {pose}, joints {joints}")
    expect(any(abs(value) > 0.05 for value in pose[:3]), f"pose {pose}")
    mode, safety = receive.getRobotMode(), receive.getSafetyMode()
    expect((mode, safety) == (7, 1), f"robot mode {mode}, safety mode {safety}")
    speed = max(abs(value) for value in receive.getActualTCPSpeed())
    expect(speed < 1e-3, f"speed {speed} while it stands")
    receive.disconnect()
    return f"pose {[round(1000 * value, 2) for value in pose[:3]]} mm, mode {mode}"


def ur_dashboard_check(offset):
    import dashboard_client

    dashboard = dashboard_client.DashboardClient(HOST, 29999 + offset)
    dashboard.connect()
    expect(dashboard.isConnected(), "not connected")
    said = {
        "robotmode": dashboard.robotmode(),
        "safetystatus": dashboard.safetystatus(),
        "version": dashboard.polyscopeVersion(),
        "serial number": dashboard.getSerialNumber(),
    }
    expect("RUNNING" in said["robotmode"], f"{said}")
    expect("NORMAL" in said["safetystatus"], f"{said}")
    expect(all(said.values()), f"{said}")
    expect(dashboard.isInRemoteControl() is True, "not in remote control")
    expect(dashboard.running() is False, "a program runs though none was sent")
    dashboard.disconnect()
    return ", ".join(f"{key} {value!r}" for key, value in said.items())


def ur_script_check(offset):
    import rtde_receive
    import script_client

    receive = rtde_receive.RTDEReceiveInterface(HOST)
    script = script_client.ScriptClient(HOST, 5, 12, 30003 + offset)
    script.connect()
    expect(script.isConnected(), "not connected")
    worst, taken = 0.0, []
    for step_mm in (STEP_MM, -STEP_MM, 20.0, -20.0):
        start = receive.getActualTCPPose()
        target = [start[0], start[1] + step_mm / 1000, *start[2:]]
        numbers = ",".join(f"{value:.9f}" for value in target)
        expect(script.sendScriptCommand(f"movel(p[{numbers}],a=0.3,v=0.05)\n"), "the script was not sent")

        def is_done():
            pose, speed = receive.getActualTCPPose(), receive.getActualTCPSpeed()
            return pose_error(pose, target) < 1e-5 and max(map(abs, speed)) < 1e-4

        taken.append(wait_for(is_done, f"a step of {step_mm} mm"))
        worst = max(worst, 1000 * pose_error(receive.getActualTCPPose(), target))
    wait_for(lambda: receive.getRuntimeState() == 1, "the end of the script")
    receive.disconnect()
    return f"four straight moves read back to {worst:.4f} mm, the longest in {max(taken):.2f} s"


CHECKS = {
    "fanucpy": fanucpy_check,
    "fanuc-python": fanuc_python_check,
    "fanuc-logger": fanuc_logger_check,
    "ljv": ljv_check,
    "ur-receive": ur_receive_check,
    "ur-dashboard": ur_dashboard_check,
    "ur-script": ur_script_check,
}


def main():
    offset, names = int(sys.argv[1]), sys.argv[2:]
    num_failed = 0
    for name in names:
        try:
            print(f"passed: {name}: {CHECKS[name](offset)}", flush=True)
        except Exception as error:  # Whatever a client throws is a finding.
            num_failed += 1
            print(f"failed: {name}: {error.__class__.__name__}: {error}", flush=True)
            traceback.print_exc()
    return 1 if num_failed else 0


if __name__ == "__main__":
    sys.exit(main())
