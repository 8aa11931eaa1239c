#!/usr/bin/env python3
"""One study run in every way that a study can run: the rows and the statement must be the same, bit by bit.

    bench/study_identical.py build/release/trueblade --trials 400 --out results/studies/identical.md

A kill (SIGKILL) and a full disk (a limit of the file size) come while trials are being written; both runs are then resumed."""
import argparse
import hashlib
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

STUDY = pathlib.Path(__file__).parent.parent / "scenarios" / "studies" / "paper_case.yaml"
MPI_AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}  # in containers


class Runner:
    def __init__(self, program, trials, folder):
        self.program, self.trials, self.folder = program, trials, folder

    def command(self, out, *options, trials=None):
        return [self.program, "study", STUDY, "--trials", trials or f"0:{self.trials}", "--out", self.folder / out, *options]

    def run(self, command, expected=0, **more):
        ended = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, **more)
        if ended.returncode != expected:
            sys.exit(f"{' '.join(map(str, command))}: exit code {ended.returncode}\n{ended.stderr}")
        return ended.stderr

    def stored_bytes(self, out):
        return (self.folder / out / "trials.sqlite").stat().st_size

    def end_early(self, out, signal_number):
        """A part of the trials, then a run that is sent the signal as soon as its file grows."""
        self.run(self.command(out, trials=f"0:{self.trials // 4}"))
        before = self.stored_bytes(out)
        with subprocess.Popen(self.command(out, "--resume"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as child:
            while child.poll() is None and self.stored_bytes(out) == before:
                time.sleep(0.001)
            child.send_signal(signal_number)

    def fill_disk(self, out):
        self.run(self.command(out, trials=f"0:{self.trials // 4}"))
        limit = self.stored_bytes(out) + 20_000
        message = self.run(self.command(out, "--resume"), expected=2,
                           preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        if "cannot be written" not in message:
            sys.exit(f"the full disk is not named: {message}")

    def statement(self, out):
        text = (self.folder / out / "study.json").read_bytes()
        return json.loads(text)["rows_hash"], hashlib.sha256(text).hexdigest()[:16]


def ways(runner):
    third = runner.trials // 3
    yield "1 thread", "a", lambda: runner.run(runner.command("a", "--threads", "1"))
    yield "2 threads", "b", lambda: runner.run(runner.command("b", "--threads", "2"))
    yield "`mpirun -n 2`", "c", lambda: runner.run(
        ["mpirun", "-n", "2", "--oversubscribe", *runner.command("c")], env={**os.environ, **MPI_AS_ROOT})

    def resume_after(out, end):
        def run():
            end(out)
            runner.run(runner.command(out, "--resume"))
        return run

    yield "Ctrl-C, resumed", "d", resume_after("d", lambda out: runner.end_early(out, signal.SIGINT))
    yield "kill -9, resumed", "e", resume_after("e", lambda out: runner.end_early(out, signal.SIGKILL))
    yield "full disk, resumed", "f", resume_after("f", runner.fill_disk)

    def merge():
        parts = [(2 * third, runner.trials), (0, third), (third, 2 * third)]
        for k, (begin, end) in enumerate(parts):
            runner.run(runner.command(f"part_{k}", trials=f"{begin}:{end}"))
        files = [runner.folder / f"part_{k}" / "trials.sqlite" for k in range(len(parts))]
        runner.run([runner.program, "study", "merge", STUDY, *files, "--out", runner.folder / "g"])

    yield "merged from three ranges", "g", merge


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--trials", type=int, default=400)
    parser.add_argument("--out", type=pathlib.Path, default="results/studies/identical.md")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        runner = Runner(options.program.resolve(), options.trials, pathlib.Path(folder))
        rows = []
        for name, out, run in ways(runner):
            run()
            rows.append((name, *runner.statement(out)))
            print(*rows[-1], flush=True)
    same = len({row[1:] for row in rows}) == 1
    lines = ["# One study, run in every way", "",
             f"{STUDY.stem}, {options.trials} trials. Rows: hash of all rows in the order of trial and case; statement: of `study.json`.", "",
             f"    bench/study_identical.py build/release/trueblade --trials {options.trials}", "",
             "| run | rows | statement |", "|---|---|---|",
             *(f"| {name} | {rows_hash} | {statement} |" for name, rows_hash, statement in rows), "",
             "All are the same." if same else "**They differ.**", ""]
    options.out.write_text("\n".join(lines))
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
