#!/usr/bin/env python3
"""The LinuxCNC controller itself, with simulated drives and the virtual probe (scripts/linuxcnc.sh): the whole inspection, and
the faults that the controller makes on demand.

    tests/linuxcnc/running_controller_test.py build/dev

Exit code 77, with a message, where the controller is not installed or may not be started."""
import json
import math
import os
import pathlib
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
PROGRAM = BUILD / "trueblade"
LOOP = pathlib.Path(tempfile.gettempdir()) / "trueblade_loop_test"
ENVIRONMENT = {**os.environ, "TRUEBLADE_BUILD": str(BUILD), "TRUEBLADE_LOOP": str(LOOP)}
MACHINE_FAULT = 3
OUT_OF_RANGE = 1  # of a sample's flags
MIDDLE_BYTES = 2700  # of a journal of about 5,700: a scan in its middle

CONTROLLER = "host: 127.0.0.1, command_port: {port}, sample_port: 5008, reset_estop: true, enable_password: {password}"
SCENARIO = """name: running_controller
seed: 1
part: {{demonstration: turbine_blade, chord_tolerance_mm: 0.02}}
machine:
  {backend}
  lens: {{name: 25mm}}
  mcs_from_part: {{translation_mm: [0, 0, 32]}}
  simulation:
    errors: {{fixture_x: {{sigma_mm: 0.1}}, fixture_y: {{sigma_mm: 0.1}}, fixture_z: {{sigma_mm: 0.1}}, fixture_c: {{sigma_deg: 0.1}}}}
scan: {{views: [{{name: front, theta_deg: 0}}], spacing_mm: {spacing_mm}}}
"""


def scenario_text(backend="linuxcnc", spacing_mm=6, port=5007, password="EMCTOO"):
    text = "backend: " + backend
    if backend == "linuxcnc":
        text += f"\n  controller: {{{CONTROLLER.format(port=port, password=password)}}}"
    return SCENARIO.format(backend=text, spacing_mm=spacing_mm)


class Controller:
    """A second user interface beside the program's: it asks, and presses the e-stop."""

    def __init__(self):
        self.socket = socket.create_connection(("127.0.0.1", 5007), timeout=10)
        self.lines = self.socket.makefile("r", newline="\n")
        self.say("hello EMC test 1.0")

    def say(self, line):
        self.socket.sendall((line + "\r\n").encode())

    def ask(self, line):
        self.say(line)
        word = line.split()[1].upper()
        while True:
            answer = self.lines.readline().strip()
            if answer.upper().startswith(word):
                return answer

    def position(self):
        return self.ask("get abs_act_pos")

    def press_estop(self):
        self.say("set enable EMCTOO")
        self.say("set estop on")

    def close(self):
        self.socket.close()


def loop(*arguments):
    subprocess.run([ROOT / "scripts/linuxcnc.sh", *arguments], env=ENVIRONMENT, stdout=subprocess.DEVNULL, check=True, timeout=120)


def halcmd(*arguments):
    """Beside the controller, as its user."""
    as_user = ["runuser", "-u", "trueblade", "--"] if os.geteuid() == 0 else []
    subprocess.run([*as_user, "env", f"HOME={LOOP}", "halcmd", *arguments], check=True, capture_output=True, timeout=30)


def processes_of_the_loop(name):
    """Their numbers, by the program file that they run: no process of another loop."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(entry / "exe") == str(LOOP / "bin" / name):
                found.append(int(entry.name))
        except OSError:
            continue  # ended meanwhile, or another user's
    return found


def listeners_of_the_loop():
    """Address and port, as /proc/net/tcp writes them, of every socket on which a process started by linuxcnc listens."""
    sockets = set()
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if f"CONFIG_DIR={LOOP}".encode() in (entry / "environ").read_bytes().split(b"\0"):
                sockets |= {os.readlink(descriptor) for descriptor in (entry / "fd").iterdir()}
        except OSError:
            continue  # ended meanwhile, or another user's
    found = []
    for table in ("tcp", "tcp6"):
        for line in pathlib.Path("/proc/net", table).read_text().splitlines()[1:]:
            _, local, _, state, *_, inode = line.split()[:10]
            address, port = local.split(":")
            if state == "0A" and f"socket:[{inode}]" in sockets:
                found.append((address, int(port, 16)))
    return sorted(found)


def setUpModule():
    subprocess.run([ROOT / "scripts/linuxcnc.sh", "stop"], env=ENVIRONMENT, stdout=subprocess.DEVNULL, check=False)
    setUpModule.folder = pathlib.Path(tempfile.mkdtemp())
    setUpModule.folder.chmod(0o755)  # the virtual probe reads the scenario as another user
    file = setUpModule.folder / "loop.yaml"
    file.write_text(scenario_text())
    subprocess.run([ROOT / "scripts/linuxcnc.sh", "start", file], env=ENVIRONMENT, check=True)


def tearDownModule():
    subprocess.run([ROOT / "scripts/linuxcnc.sh", "stop"], env=ENVIRONMENT, check=True)
    shutil.rmtree(setUpModule.folder)


class RunningController(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=setUpModule.folder))

    def command(self, scenario, *options):
        file = self.folder / "scenario.yaml"
        file.write_text(scenario)
        return [PROGRAM, "inspect", file, "--out", self.folder / "run", *options]

    def inspect(self, scenario, *options):
        return subprocess.run(self.command(scenario, *options), capture_output=True, text=True, check=False, timeout=300)

    def result(self):
        return json.loads((self.folder / "run/result.json").read_text())["views"][0]

    def journalled_lines(self):
        """The flags of the samples of every line, by its height; lines are 6 mm apart (docs/formats.md, journal)."""
        record = (self.folder / "run/scan.journal").read_bytes()
        at = record.index(b"\n") + 1
        lines = {}
        while at < len(record):
            kind, length = struct.unpack_from("<BI", record, at)
            if kind == 2:
                *axes, flags = struct.unpack_from("<7dB", record, at + 5)
                lines.setdefault(round(axes[2]), []).append(flags)
            at += 5 + length + 4
        return lines

    def started_scan(self):
        """The process, in the middle of its scan."""
        process = subprocess.Popen(self.command(scenario_text()), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while self.journal_bytes() < MIDDLE_BYTES:
            self.assertIsNone(process.poll(), "ended before the scan began")
            time.sleep(0.02)
        return process

    def journal_bytes(self):
        journal = self.folder / "run/scan.journal"
        return journal.stat().st_size if journal.exists() else 0

    def ends_as_a_fault(self, process, words):
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, MACHINE_FAULT, errors)
        self.assertRegex(errors.lower(), words)
        self.assertRegex(errors, "the machine is (stopped|unknown)")
        self.assertGreaterEqual(self.journal_bytes(), MIDDLE_BYTES, errors)

    def machine_file(self):
        machine = self.folder / "machine.yaml"
        machine.write_text("backend: linuxcnc\nlens: {name: 25mm}\ncontroller: {" +
                           CONTROLLER.format(port=5007, password="EMCTOO") + "}\n")
        return machine

    def machine(self, *arguments):
        return subprocess.run([PROGRAM, "machine", arguments[0], "--machine", self.machine_file(), *arguments[1:]],
                              capture_output=True, text=True, check=False, timeout=120)

    def stands_still(self):
        controller = Controller()
        before = controller.position()
        time.sleep(0.5)
        after = controller.position()
        controller.close()
        self.assertEqual(before, after)

    def completes(self, scenario=scenario_text()):
        resumed = self.inspect(scenario, "--resume")
        self.assertEqual(resumed.returncode, 0, resumed.stderr)
        samples = self.result()["samples"]
        self.assertEqual(samples["points"] + samples["out_of_range"] + samples["missed"], samples["planned"])
        self.assertLess(self.result()["rms_mm"], 0.004)  # 3 um of noise: nothing was mixed up

    def test_the_report_is_that_of_the_simulated_machine(self):
        through = self.inspect(scenario_text(spacing_mm=4))
        self.assertEqual(through.returncode, 0, through.stderr)
        real = self.result()
        self.inspect(scenario_text("simulated", spacing_mm=4))
        simulated = self.result()
        for count in ("planned", "points", "out_of_range", "missed"):
            self.assertEqual(real["samples"][count], simulated["samples"][count], count)
        # Same part, same errors, same noise at every planned position; the samples lie up to 0.03 mm beside it (docs/linuxcnc.md), so
        # that few of them read another part of the surface. 200 points of 3 um determine the pose to about a micrometre.
        apart = [a - b for a, b in zip(real["pose"]["translation_mm"], simulated["pose"]["translation_mm"])]
        self.assertLess(max(map(abs, apart)), 0.004)
        turned = [a - b for a, b in zip(real["pose"]["rotation_wxyz"], simulated["pose"]["rotation_wxyz"])]
        self.assertLess(max(map(abs, turned)), 3e-5)
        self.assertAlmostEqual(real["rms_mm"], simulated["rms_mm"], delta=0.0005)

    def test_estop_in_the_middle_of_a_line(self):
        process = self.started_scan()
        controller = Controller()
        controller.press_estop()
        self.ends_as_a_fault(process, "the controller says: e-stop")
        controller.close()
        self.stands_still()
        self.completes()

    def test_following_error_in_the_middle_of_a_line(self):
        process = self.started_scan()
        # The encoder of x stands still while the axis is told to move.
        halcmd("unlinkp", "joint.0.motor-pos-fb")
        try:
            self.ends_as_a_fault(process, "joint 0 following error")
        finally:
            halcmd("linkps", "joint.0.motor-pos-fb", "x-motor")
        self.stands_still()
        self.completes()

    def test_limit_switch_in_the_middle_of_a_line(self):
        process = self.started_scan()
        halcmd("setp", "joint.0.pos-lim-sw-in", "1")
        try:
            self.ends_as_a_fault(process, "joint 0 on limit switch")
        finally:
            halcmd("setp", "joint.0.pos-lim-sw-in", "0")
        self.stands_still()
        self.completes()

    def test_full_disk_in_the_middle_of_a_line(self):
        scenario = scenario_text(spacing_mm=4)  # the journal outgrows the files written before it
        # A limit on the size of files stands for the disk.
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (6500, resource.RLIM_INFINITY))

        process = subprocess.Popen(self.command(scenario), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   preexec_fn=limit, restore_signals=False)
        self.ends_as_a_fault(process, "the journal cannot be written")
        self.stands_still()
        self.completes(scenario)

    def test_silent_sensor_and_controller_restarted(self):
        process = self.started_scan()
        probes = processes_of_the_loop("trueblade-virtual-probe")
        self.assertEqual(len(probes), 1)
        os.kill(probes[0], signal.SIGSTOP)
        try:
            self.ends_as_a_fault(process, "sensor is silent")
        finally:
            os.kill(probes[0], signal.SIGCONT)
        self.stands_still()
        loop("stop")
        loop("start", setUpModule.folder / "loop.yaml")
        jog = self.machine("jog", "--axis", "x", "--by", "1")
        self.assertEqual(jog.returncode, MACHINE_FAULT, jog.stderr)
        self.assertIn("not homed", jog.stderr)
        self.completes()

    def test_controller_ends_in_the_middle_of_a_line(self):
        process = self.started_scan()
        loop("stop")
        try:
            self.ends_as_a_fault(process, "connection|closed")
        finally:
            loop("start", setUpModule.folder / "loop.yaml")
        self.completes()

    def test_killed_in_the_middle_of_a_line(self):
        process = self.started_scan()
        process.send_signal(signal.SIGKILL)
        process.communicate()
        time.sleep(1.0)  # the watchdog's 0.5 s, and the way to a stand
        self.stands_still()
        self.completes()

    def test_interrupted_in_the_middle_of_a_line(self):
        process = self.started_scan()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.stands_still()
        self.completes()

    def test_beyond_a_limit(self):
        self.assertEqual(self.machine("home").returncode, 0)
        jog = self.machine("jog", "--axis", "x", "--by", "100000")
        self.assertEqual(jog.returncode, MACHINE_FAULT, jog.stderr)
        self.assertIn("limit", jog.stderr)
        self.stands_still()

    def test_nothing_in_range_over_whole_lines(self):
        # Believed half a degree tilted, the part is up to 0.5 mm beside where it is looked for; the lens reads 0.35 mm around.
        half_rad = math.radians(0.25)
        tilted = scenario_text().replace("{translation_mm", f"{{rotation_wxyz: [{math.cos(half_rad)}, {math.sin(half_rad)}, 0, 0], translation_mm")
        through = self.inspect(tilted)
        self.assertEqual(through.returncode, 0, through.stderr)
        lines = self.journalled_lines()
        whole = [flags for flags in lines.values() if all(flag & OUT_OF_RANGE for flag in flags)]
        self.assertGreaterEqual(len(whole), 3, lines)
        self.assertLess(len(whole), len(lines), lines)
        samples = self.result()["samples"]
        out_of_range = sum(bool(flag & OUT_OF_RANGE) for flags in lines.values() for flag in flags)
        self.assertEqual(samples["out_of_range"], out_of_range)
        self.assertEqual(samples["planned"], sum(map(len, lines.values())))
        self.assertEqual(samples["points"], samples["planned"] - out_of_range - samples["missed"])
        self.assertIn(f"{out_of_range} fell out of the working range", through.stderr)
        self.assertLess(self.result()["rms_mm"], 0.004)

    def test_what_is_no_request_closes_the_connection(self):
        with socket.create_connection(("127.0.0.1", 5008), timeout=10) as connection:
            connection.sendall(b"GET / HTTP/1.1\r\n\r\n")
            try:
                while connection.recv(4096):
                    pass
            except ConnectionResetError:
                pass
        self.assertIn("trueblade-hal: connection closed: a line is no request", (LOOP / "linuxcnc.log").read_text())
        self.assertEqual(self.machine("status").returncode, 0)

    def test_nothing_listens_beyond_the_loopback(self):
        loopback = "0100007F"
        # linuxcncsvr, linuxcncrsh and trueblade-hal, and no other.
        self.assertEqual(listeners_of_the_loop(), [(loopback, 5005), (loopback, 5007), (loopback, 5008)])

    def test_refused_connection_and_wrong_password(self):
        for scenario, word in ((scenario_text(port=5009), "5009"), (scenario_text(password="WRONG"), "password")):
            refused = self.inspect(scenario)
            self.assertEqual(refused.returncode, MACHINE_FAULT, refused.stderr)
            self.assertIn(word, refused.stderr)


def reason_to_skip():
    if not shutil.which("linuxcnc"):
        return "LinuxCNC is not installed (Debian: linuxcnc-uspace)"
    if not (BUILD / "trueblade-hal").exists():
        return f"{BUILD}/trueblade-hal is not built (Debian: linuxcnc-uspace-dev)"
    try:
        socket.create_connection(("127.0.0.1", 5007), timeout=1).close()
        return "something listens on port 5007 already"
    except OSError:
        return None


if __name__ == "__main__":
    reason = reason_to_skip()
    if reason:
        print("skipped:", reason)
        sys.exit(77)
    unittest.main(verbosity=2)
