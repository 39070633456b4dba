"""Runs a program and measures its processor time, user and system, over all of its threads."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass

from .errors import RunFailed, ToolMissing

# Wall-clock time after which a run is ended, in seconds.
LIMIT = 1800.0


@dataclass(frozen=True)
class Usage:
    """What a child process took in seconds, and what it printed."""

    processor: float
    wall: float
    output: str


def run(command, env=None, cwd=None, limit=LIMIT):
    """Runs `command` to its end. The processor time is that of wait4(2), so of this child and those it waited for."""
    command = [str(part) for part in command]
    with tempfile.TemporaryFile() as written:
        begun = time.monotonic()
        try:
            child = subprocess.Popen(command, stdout=written, stderr=subprocess.STDOUT, env=env, cwd=cwd)
        except OSError as error:
            cause = f"{command[0]} cannot be started ({error.strerror})"
            raise ToolMissing(cause, "install it or give its path") from None
        timer = threading.Timer(limit, child.kill)
        timer.start()
        try:
            _, status, used = os.wait4(child.pid, 0)
        except BaseException:
            child.kill()
            raise
        finally:
            timer.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        wall = time.monotonic() - begun
        written.seek(0)
        output = written.read().decode(errors="replace")
    if child.returncode != 0:
        last = "\n  ".join(output.strip().splitlines()[-8:])
        cause = f"{' '.join(command)} ended with {child.returncode} after {wall:.0f} s"
        raise RunFailed(cause, f"its last lines are\n  {last}")
    return Usage(used.ru_utime + used.ru_stime, wall, output)


def run_module(name, job, env=None):
    """Runs `main(job)` of a module of this package in a new interpreter; returns its usage and the JSON it printed.

    Renderers with a Python interface run this way, so that their time is that of a process of their own.
    """
    package = __package__.split(".")
    root = pathlib.Path(__file__).resolve().parents[len(package)]
    env = dict(os.environ if env is None else env)
    env["PYTHONPATH"] = os.pathsep.join([str(root), *filter(None, [env.get("PYTHONPATH")])])
    code = f"import sys, json; from {__package__} import {name}; {name}.main(json.loads(sys.argv[1]))"
    usage = run([sys.executable, "-c", code, json.dumps(job)], env=env)
    for line in reversed(usage.output.splitlines()):
        if line.startswith("{"):
            return usage, json.loads(line)
    raise RunFailed(f"{name} printed no result", f"it printed\n  {usage.output[-500:]}")
