#!/usr/bin/env python3
"""The LinuxCNC controller itself, with simulated drives and the virtual probe (scripts/linuxcnc.sh): the whole inspection, and
the faults that the controller makes on demand.

    tests/linuxcnc/running_controller_test.py build/dev

Exit code 77, with a message, where the controller is not installed or may not be started."""
import json
import math
import os
import pathlib
import re
import resource
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
PROGRAM = BUILD / "trueblade"
LOOP = pathlib.Path(tempfile.gettempdir()) / "trueblade_loop_test"
ENVIRONMENT = {**os.environ, "TRUEBLADE_BUILD": str(BUILD), "TRUEBLADE_LOOP": str(LOOP)}
MACHINE_FAULT = 3
INTERRUPTED = 130
OUT_OF_RANGE = 1  # of a sample's flags
GREETING = 1  # type of a frame of trueblade-hal
TCP_REPAIR = 19  # of Linux; the socket module does not name it
MIDDLE_BYTES = 2700  # of a journal of about 5,700: a scan in its middle

CONTROLLER = "host: 127.0.0.1, command_port: {port}, sample_port: {sample_port}, reset_estop: true, enable_password: {password}"
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


def scenario_text(backend="linuxcnc", spacing_mm=6, port=5007, sample_port=5008, password="EMCTOO"):
    text = "backend: " + backend
    if backend == "linuxcnc":
        text += f"\n  controller: {{{CONTROLLER.format(port=port, sample_port=sample_port, password=password)}}}"
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


class Wire:
    """Between the program and trueblade-hal: it can hold back what the program sends, and be cut."""

    def __init__(self, test):
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.ends = ()
        test.addCleanup(self.close)
        self.open = threading.Event()
        self.open.set()
        threading.Thread(target=self.carry, daemon=True).start()

    def carry(self):
        program, _ = self.listener.accept()
        component = socket.create_connection(("127.0.0.1", 5008))
        self.ends = (program, component)
        threading.Thread(target=self.pass_on, args=(component, program), daemon=True).start()
        self.pass_on(program, component, self.open)

    def pass_on(self, source, sink, gate=None):
        try:
            while data := source.recv(65536):
                if gate:
                    gate.wait()
                sink.sendall(data)
        except OSError:
            pass
        self.cut()

    def cut(self):
        for end in self.ends:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                continue  # cut already

    def close(self):
        self.cut()
        for end in (self.listener, *self.ends):
            end.close()

    def is_slow_for(self, seconds):
        self.open.clear()
        time.sleep(seconds)
        self.open.set()


def loop(*arguments):
    subprocess.run([ROOT / "scripts/linuxcnc.sh", *arguments], env=ENVIRONMENT, stdout=subprocess.DEVNULL, check=True, timeout=120)


def halcmd(*arguments):
    """Beside the controller, as its user."""
    as_user = ["runuser", "-u", "trueblade", "--"] if os.geteuid() == 0 else []
    return subprocess.run([*as_user, "env", f"HOME={LOOP}", "halcmd", *arguments], check=True, capture_output=True, text=True,
                          timeout=30).stdout


def x_of_the_encoder():
    """In mm, from wherever: homing does not change it."""
    return float(halcmd("getp", "joint.0.motor-pos-fb"))


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


class OnTheController(unittest.TestCase):
    """A controller of its own for every class, by the configuration with what `edits` changes in it."""
    edits = ()  # file, what stands there, what takes its place

    @classmethod
    def setUpClass(cls):
        loop("stop")
        cls.class_folder = pathlib.Path(tempfile.mkdtemp())
        cls.class_folder.chmod(0o755)  # the virtual probe reads the scenario as another user
        (cls.class_folder / "loop.yaml").write_text(scenario_text())
        config = cls.class_folder / "config"
        shutil.copytree(ROOT / "hardware/linuxcnc/config", config)
        for file, old, new in cls.edits:
            text = (config / file).read_text()
            assert old in text, old
            (config / file).write_text(text.replace(old, new, 1))
        ENVIRONMENT["TRUEBLADE_CONFIG"] = str(config)
        cls.start_controller()

    @classmethod
    def start_controller(cls):
        loop("start", cls.class_folder / "loop.yaml")

    @classmethod
    def tearDownClass(cls):
        loop("stop")
        shutil.rmtree(cls.class_folder)

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(dir=self.class_folder))

    def machine_file(self, sample_port=5008):
        machine = self.folder / "machine.yaml"
        machine.write_text("backend: linuxcnc\nlens: {name: 25mm}\ncontroller: {" +
                           CONTROLLER.format(port=5007, sample_port=sample_port, password="EMCTOO") + "}\n")
        return machine

    def machine(self, *arguments):
        return subprocess.run([PROGRAM, "machine", arguments[0], "--machine", self.machine_file(), *arguments[1:]],
                              capture_output=True, text=True, check=False, timeout=120)

    def begun(self, *arguments, sample_port=5008):
        """`trueblade machine` with these, while it runs."""
        return subprocess.Popen([PROGRAM, "machine", arguments[0], "--machine", self.machine_file(sample_port), *arguments[1:]],
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def stands_still(self):
        controller = Controller()
        before = controller.position()
        time.sleep(0.5)
        after = controller.position()
        controller.close()
        self.assertEqual(before, after)

    def started(self, *arguments, sample_port=5008):
        """The same, once the x axis is 20 mm on its way."""
        x_mm = x_of_the_encoder()
        process = self.begun(*arguments, sample_port=sample_port)
        self.wait_for_way_from(x_mm, process)
        return process

    def wait_for_way_from(self, x_mm, process):
        while abs(x_of_the_encoder() - x_mm) < 20:
            if process.poll() is not None:
                self.fail("ended before it moved: " + process.communicate()[1])
            time.sleep(0.02)

    def ends_interrupted(self, process):
        process.send_signal(signal.SIGINT)
        asked = time.monotonic()
        _, errors = process.communicate(timeout=60)
        self.assertLess(time.monotonic() - asked, 3)
        self.assertEqual(process.returncode, INTERRUPTED, errors)
        self.assertIn("the machine is stopped", errors)
        self.stands_still()

    def ends_for_want_of_signs_of_life(self, process, errors):
        self.assertEqual(process.returncode, MACHINE_FAULT, errors)
        self.assertIn("no sign of life came for 0.5 s", errors)
        self.assertIn("the machine is stopped", errors)
        self.stands_still()

    def ends_killed(self, process):
        process.kill()
        process.communicate()
        time.sleep(1.0)  # the watchdog's 0.5 s, and the way to a stand
        self.stands_still()


class RunningController(OnTheController):
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

    def started_scan(self, **scenario):
        """The process, in the middle of its scan."""
        process = subprocess.Popen(self.command(scenario_text(**scenario)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while self.journal_bytes() < MIDDLE_BYTES:
            if process.poll() is not None:
                self.fail("ended before the scan began: " + process.communicate()[1])
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
        # that few of them read another part of the surface. 200 points of 3 um determine the pose to about a micrometre, which over
        # 30 mm is 3.3e-5 rad, half of it in the quaternion. Four times that.
        apart = [a - b for a, b in zip(real["pose"]["translation_mm"], simulated["pose"]["translation_mm"])]
        self.assertLess(max(map(abs, apart)), 0.004)
        turned = [a - b for a, b in zip(real["pose"]["rotation_wxyz"], simulated["pose"]["rotation_wxyz"])]
        self.assertLess(max(map(abs, turned)), 6.7e-5)
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
        self.start_controller()
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
            self.start_controller()
        self.completes()

    def test_slow_network_in_the_middle_of_a_line(self):
        wire = Wire(self)
        process = self.started_scan(sample_port=wire.port)
        wire.is_slow_for(1.0)
        _, errors = process.communicate(timeout=10)
        self.ends_for_want_of_signs_of_life(process, errors)
        self.completes()

    def test_a_second_program_is_refused_and_takes_nothing_away(self):
        process = self.started_scan()
        status = self.machine("status")
        self.assertEqual(status.returncode, MACHINE_FAULT, status.stderr)
        self.assertIn("another driver is connected", status.stderr)
        _, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, errors)

    def test_recording_keeps_what_came_before_the_cut(self):
        wire = Wire(self)
        samples = self.folder / "samples.csv"
        record = self.begun("record", "--seconds", "30", "--out", samples, sample_port=wire.port)
        time.sleep(2)
        wire.cut()
        _, errors = record.communicate(timeout=10)
        self.assertEqual(record.returncode, MACHINE_FAULT, errors)
        kept = int(re.search(r"the (\d+) samples that came before are in", errors)[1])
        self.assertGreater(kept, 100)
        self.assertEqual(len(samples.read_text().splitlines()), 1 + kept)

    def test_who_comes_back_at_once_is_let_in(self):
        for _ in range(200):
            with socket.create_connection(("127.0.0.1", 5008), timeout=10) as connection:
                self.assertEqual(self.first_frame(connection), GREETING)

    def test_who_vanished_is_given_up(self):
        vanishing = socket.create_connection(("127.0.0.1", 5008), timeout=10)
        self.assertEqual(self.first_frame(vanishing), GREETING)
        try:
            vanishing.setsockopt(socket.IPPROTO_TCP, TCP_REPAIR, 1)
        except PermissionError:
            self.skipTest("only root can close a connection without a word")
        vanishing.close()  # as by a computer that has lost its power
        gone = time.monotonic()
        while True:
            with socket.create_connection(("127.0.0.1", 5008), timeout=10) as connection:
                if self.first_frame(connection) == GREETING:
                    break
            self.assertLess(time.monotonic() - gone, 10)
            time.sleep(0.2)

    def first_frame(self, connection):
        """The type of the frame that trueblade-hal sends first."""
        head = b""
        while len(head) < 5:
            received = connection.recv(5 - len(head))
            self.assertNotEqual(received, b"", "closed without a word")
            head += received
        return head[4]

    def test_killed_in_the_middle_of_a_line(self):
        self.ends_killed(self.started_scan())
        self.completes()

    def test_interrupted_in_the_middle_of_a_line(self):
        self.ends_interrupted(self.started_scan())
        self.completes()

    def test_interrupted_on_the_way_to_a_line(self):
        home = self.machine("home")
        self.assertEqual(home.returncode, 0, home.stderr)
        x_mm = float(re.search(r"x (\S+)", home.stdout)[1])
        self.assertEqual(self.machine("jog", "--axis", "x", "--by", str(-200 - x_mm)).returncode, 0)  # the part is around zero
        x_mm = x_of_the_encoder()
        process = subprocess.Popen(self.command(scenario_text()), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.wait_for_way_from(x_mm, process)
        self.ends_interrupted(process)
        self.assertLess(x_of_the_encoder() - x_mm, 150)
        self.completes()

    def test_jog_interrupted_and_killed(self):
        for end in (self.ends_interrupted, self.ends_killed):
            self.assertEqual(self.machine("home").returncode, 0)
            x_mm = x_of_the_encoder()
            end(self.started("jog", "--axis", "x", "--by", "-200"))
            self.assertLess(abs(x_of_the_encoder() - x_mm), 150)

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


class ControllerAsOnSite(OnTheController):
    """Homing moves the axes, and the encoders are latched directly; the sensor is not connected."""
    # Homing takes x 300 mm away, at 50 mm/s; every time that the machine was off. And few samples wait for who reads them.
    edits = (("trueblade.ini", "\nHOME = 0\n", "\nHOME = 300\nVOLATILE_HOME = 1\n"),
             ("trueblade.ini", "probe_virtual.hal\n", "probe_sensor.hal\n"),
             ("probe_sensor.hal", "depth=60000", "depth=200"))

    def setUp(self):
        super().setUp()
        self.panel("machine off")

    def panel(self, *commands):
        controller = Controller()
        for command in ("enable EMCTOO", "set_wait received", *commands):
            controller.say("set " + command)
            time.sleep(0.2)  # the controller's task takes it over
        controller.ask("get estop")  # it has read all of them
        controller.close()

    def comes_home(self):
        home = self.machine("home")
        self.assertEqual(home.returncode, 0, home.stderr)
        self.assertIn("homed, at x 300.00", home.stdout)

    def test_interrupted_while_homing(self):
        self.ends_interrupted(self.started("home"))
        self.assertIn("NO", self.machine("status").stdout)
        self.comes_home()

    def test_killed_while_homing(self):
        process = self.started("home")
        x_mm = x_of_the_encoder()
        self.ends_killed(process)
        self.assertLess(x_of_the_encoder() - x_mm, 50)
        self.comes_home()

    def test_hanging_while_homing(self):
        process = self.started("home")
        process.send_signal(signal.SIGSTOP)
        time.sleep(1.0)  # as killed, but its connections stay open
        self.stands_still()
        process.send_signal(signal.SIGCONT)
        _, errors = process.communicate(timeout=60)
        self.ends_for_want_of_signs_of_life(process, errors)
        self.comes_home()

    def test_slow_network_while_homing(self):
        wire = Wire(self)
        process = self.started("home", sample_port=wire.port)
        wire.is_slow_for(1.0)  # the controller has ended homing and says nothing of it
        _, errors = process.communicate(timeout=10)
        self.ends_for_want_of_signs_of_life(process, errors)
        self.comes_home()

    def test_homing_against_a_stop_that_stands(self):
        with socket.create_connection(("127.0.0.1", 5008), timeout=10) as connection:
            connection.sendall(b"hold\n")
            time.sleep(0.5)
            x_mm = x_of_the_encoder()
            self.panel("machine on", "mode manual", "home -1")
            time.sleep(0.5)
            self.stands_still()
            self.assertLess(abs(x_of_the_encoder() - x_mm), 20)
        self.comes_home()

    def test_a_move_needs_no_sensor_and_a_measurement_does(self):
        self.comes_home()
        jog = self.machine("jog", "--axis", "x", "--by", "-100")  # two seconds, the sensor may be silent for one
        self.assertEqual(jog.returncode, 0, jog.stderr)
        self.assertIn("at x 200.00", jog.stdout)
        measured = self.machine("measure")
        self.assertEqual(measured.returncode, MACHINE_FAULT, measured.stderr)
        self.assertIn("the sensor is silent", measured.stderr)
        self.assertIn("the machine is stopped", measured.stderr)

    def test_samples_that_find_no_place_are_seen_as_lost(self):
        component, = processes_of_the_loop("trueblade-hal")
        record = self.begun("record", "--seconds", "3", "--out", self.folder / "samples.csv")
        time.sleep(1)
        os.kill(component, signal.SIGSTOP)
        time.sleep(0.5)
        os.kill(component, signal.SIGCONT)
        _, errors = record.communicate(timeout=60)
        self.assertEqual(record.returncode, MACHINE_FAULT, errors)
        self.assertIn("samples were lost", errors)


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
