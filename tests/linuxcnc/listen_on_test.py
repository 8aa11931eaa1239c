#!/usr/bin/env python3
"""Where programs that mean every interface listen, started by the scripts of the controller's configuration; no controller.

    tests/linuxcnc/listen_on_test.py build/dev

Exit code 77, with a message, where the library is not built."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
SCRIPTS = ROOT / "hardware/linuxcnc/config/bin"

# Stands for a program of LinuxCNC: what it was called with, and where it came to listen.
LISTENS = """#!{python}
import socket, sys
family = socket.AF_INET6 if ":" in "{address}" else socket.AF_INET
with socket.socket(family) as listener:
    listener.bind(("{address}", 0))
    listener.listen()
    print(listener.getsockname()[0], *sys.argv[1:])
"""


class ListenOn(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())

    def tearDown(self):
        shutil.rmtree(self.folder)

    def program(self, name, address="0.0.0.0"):
        self.script(name, LISTENS.format(python=sys.executable, address=address))
        return self.folder / name

    def script(self, name, text):
        (self.folder / name).write_text(text)
        (self.folder / name).chmod(0o755)

    def run_it(self, *command, path=None):
        environment = {**os.environ, "PATH": path or f"{BUILD}:{self.folder}:/usr/bin:/bin"}
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=30)

    def listens(self, *command, path=None):
        ended = self.run_it(*command, path=path)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return ended.stdout.split()

    def test_every_interface_becomes_the_address(self):
        program = self.program("program")
        self.assertEqual(self.listens(program), ["0.0.0.0"])
        for address in ("127.0.0.1", "127.0.0.2", "0.0.0.0"):
            self.assertEqual(self.listens(SCRIPTS / "listen_on", address, program, "-x", "a b"), [address, "-x", "a", "b"])

    def test_an_address_that_is_named_stays(self):
        program = self.program("program", "127.0.0.3")
        self.assertEqual(self.listens(SCRIPTS / "listen_on", "127.0.0.1", program), ["127.0.0.3"])

    def test_what_cannot_be_done_listens_nowhere(self):
        for address, program in (("localhost", self.program("v4")), ("", self.program("v4")), ("127.0.0.1", self.program("v6", "::"))):
            ended = self.run_it(SCRIPTS / "listen_on", address, program)
            self.assertNotEqual(ended.returncode, 0)
            self.assertEqual(ended.stdout, "")

    def test_nothing_starts_without_the_library(self):
        program = self.program("program")
        self.assertIn("is not there", self.run_it(SCRIPTS / "listen_on", "127.0.0.1", program, path="/usr/bin:/bin").stderr)
        blank = self.folder / "a b"
        blank.mkdir()
        for name in ("trueblade-hal", "trueblade-listen-on.so"):
            (blank / name).symlink_to(BUILD / name)
        ended = self.run_it(SCRIPTS / "listen_on", "127.0.0.1", program, path=f"{blank}:/usr/bin:/bin")
        self.assertNotEqual(ended.returncode, 0)
        self.assertEqual(ended.stdout, "")
        self.assertIn("blank", ended.stderr)

    def test_the_text_interface_listens_where_the_ini_file_says(self):
        self.program("linuxcncrsh")
        self.script("inivar", '#!/bin/sh\n[ "$*" = "-ini x.ini -sec TRUEBLADE -var BIND" ] && echo 127.0.0.4\n')
        where = self.listens(SCRIPTS / "trueblade-rsh", "-ini", "x.ini", "--port", "5007", path=f"{self.folder}:{BUILD}:/usr/bin:/bin")
        self.assertEqual(where, ["127.0.0.4", "--port", "5007", "--", "-ini", "x.ini"])

    def test_the_message_server_listens_on_the_loopback(self):
        self.program("linuxcncsvr")
        path = f"{SCRIPTS}:{self.folder}:{SCRIPTS}:{BUILD}:/usr/bin:/bin"
        self.assertEqual(self.listens("linuxcncsvr", "-ini", "x.ini", path=path), ["127.0.0.1", "-ini", "x.ini"])


if __name__ == "__main__":
    if not (BUILD / "trueblade-listen-on.so").exists():
        print(f"skipped: {BUILD}/trueblade-listen-on.so is not built (Debian: linuxcnc-uspace-dev)")
        sys.exit(77)
    unittest.main(verbosity=2)
