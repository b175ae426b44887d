"""Where compiled kernels are kept: never beside other sources than their own, never required."""

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from numba.core import caching

from analytic.kernels import forms, kept

KERNELS = {
    "__init__.py": "",
    "inner/__init__.py": "",
    "kernels/__init__.py": "",
    "inner/law.py": """
def law(x):
    return x + 1.0
""",
    "steps.py": """
from analytic.kernels.forms import Kernel
from analytic.inner.law import law

def steps(x):
    return 10.0 * law(x)

STEPS = Kernel(steps)
""",
}
PLACES = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "HOME", "TMPDIR")
PROGRAM = """
from analytic.steps import STEPS
from analytic.kernels import forms, kept
value = STEPS.compiled(1.0)
hits = sum(STEPS._compiled.stats.cache_hits.values())
print(value, hits, kept.kept_in(forms.SOURCES))
"""


@pytest.fixture
def package(tmp_path):
    """A package of two kernels, the one in need of the other."""
    for name, text in KERNELS.items():
        path = tmp_path / "package" / "analytic" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for module in (forms, kept):
        shutil.copy(module.__file__, tmp_path / "package" / "analytic" / "kernels")
    return tmp_path / "package"


def asked(package, **variables):
    """Return the kernel's answer, whether it was read from disk, and from where."""
    inherited = {k: v for k, v in os.environ.items() if k not in PLACES}
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM],
        env={**inherited, **variables},
        cwd=package,
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    value, hits, folder = done.stdout.split(maxsplit=2)
    return float(value), bool(int(hits)), Path(folder.strip())


@pytest.mark.parametrize(
    "place",
    [
        *(pytest.param(it, marks=pytest.mark.slow) for it in ("the package", "HOME")),
        "NUMBA_CACHE_DIR",
    ],
)
def test_a_kernel_is_never_older_than_what_it_calls(place, package, tmp_path):
    variables, kept = {}, package / "analytic" / "__pycache__"
    if place == "NUMBA_CACHE_DIR":
        kept = tmp_path / "chosen"
        variables = {"NUMBA_CACHE_DIR": str(kept)}
    if place == "HOME":
        # a package folder in which nothing can be made
        kept.write_text("")
        kept = tmp_path / ".cache" / "rocking"
        variables = {"HOME": str(tmp_path)}
    first, again = asked(package, **variables), asked(package, **variables)
    assert first == (20.0, False, first[2])
    assert first[2].parent == kept
    assert again == (20.0, True, first[2])
    law = package / "analytic" / "inner" / "law.py"
    law.write_text(law.read_text().replace("1.0", "2.0"))
    edited = asked(package, **variables)
    assert edited == (30.0, False, edited[2])
    # the package's own folder does not fill up; others may be shared
    assert first[2].exists() == (place != "the package")


def test_kernels_run_where_nothing_can_be_written(package, tmp_path):
    (package / "analytic" / "__pycache__").write_text("")
    closed = {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null", "NUMBA_CACHE_DIR": "/dev/null"}
    value, _, folder = asked(package, **closed, TMPDIR=str(tmp_path))
    assert (value, folder.parent) == (20.0, tmp_path / f"rocking-{os.getuid()}")
    assert folder.parent.stat().st_mode & 0o777 == 0o700
    folder.parent.chmod(0o777)
    value, hit, folder = asked(package, **closed, TMPDIR=str(tmp_path))
    assert (value, hit, str(folder)) == (20.0, False, "None")


def test_a_folder_is_named_by_all_sources(package, tmp_path, monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))

    def name():
        return kept.kept_in.__wrapped__(package / "analytic").name

    names = [name()]
    for path in ("steps.py", "inner/law.py", "inner/more.py"):
        with (package / "analytic" / path).open("a") as file:
            file.write("\n# edited")
        names.append(name())
    assert len(set(names)) == 4


def test_a_kernel_runs_where_the_disk_is_full(monkeypatch):
    def save(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(caching.IndexDataCacheFile, "save", save)

    def thrice(x):
        return 3.0 * x

    kernel = forms.Kernel(thrice)
    assert kernel.compiled(2.0) == 6.0
    assert kernel.compiled(3.0) == 9.0


def half(x):
    return 0.5 * x


def test_who_waits_is_told_once_and_only_where_something_is_compiled(monkeypatch, tmp_path):
    told = []
    monkeypatch.setattr(forms, "kept_in", lambda _: tmp_path)

    for count in (1, 0):
        monkeypatch.setattr(forms.Kernel, "tell", told.append)
        assert forms.Kernel(half).compiled(2.0) == 1.0
        assert len(told) == count
        told.clear()
