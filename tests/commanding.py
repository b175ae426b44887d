"""Command lines as tests run them: in this process or in one of their own."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

from studies.__main__ import run

ROOT = Path(__file__).parents[1]
PUBLISHED_PAGES = ("README.md", "engines.md", "scenes.md")
PAGES = ("README.md", *(f"studies/published/{name}" for name in PUBLISHED_PAGES))
PROSE = (*PAGES, "studies/GUIDE.md", ".github/CONTRIBUTING.md")
"""Pages of the published results; those that are made from tables; all that people read."""
BLOCK = ["--width", "0.5", "--height", "1.5"]
PULSE = ["--amplitude", "0.4", "--omega", "6.2832"]
CASE = [*BLOCK, *PULSE]
PATIENCE_S = 900.0
"""Guards against a test that hangs; nothing is expected within it."""


def refused(capsys, arguments, *parts):
    """Assert that a command ends with 2 and one line, which has some parts; return the line."""
    assert run([str(argument) for argument in arguments]) == 2
    output = capsys.readouterr()
    assert output.out == ""
    (line,) = output.err.splitlines()
    for part in parts:
        assert part in line
    return line


def compared(capsys, *options):
    """Run a comparison; return its exit code, and its rows as it tells them in JSON, by source."""
    capsys.readouterr()
    code = run(["compare", *map(str, options), "--json"])
    rows = map(json.loads, capsys.readouterr().out.splitlines())
    return code, {row["source"]: row for row in rows}


def python(*arguments, before=None, path=(), **options):
    """Run Python in a process of its own, where the signals that end a run do so."""

    def prepare():
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            # whoever runs the tests may ignore it
            signal.signal(number, signal.SIG_DFL)
        if before:
            before()

    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([*map(str, path), str(ROOT)])}
        | options.pop("env", {}),
        stdout=options.pop("stdout", subprocess.PIPE),
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=prepare,
        timeout=PATIENCE_S,
        **options,
    )


ALONE = """
import importlib, os, runpy, sys
sys.modules.update(analytic=None, engines=None, studies=None)
importlib.import_module(sys.argv[1])
for script in sys.argv[2:]:
    sys.stdout.flush()
    child = os.fork()
    if not child:
        runpy.run_path(script)
    if os.waitpid(child, 0)[1]:
        sys.exit(1)
"""


def run_scripts(library, *scripts):
    """Run scripts where this project cannot be imported, each in a process with its library."""
    command = [sys.executable, "-c", ALONE, library, *map(str, scripts)]
    return subprocess.run(command, cwd="/", capture_output=True, text=True, timeout=PATIENCE_S)
