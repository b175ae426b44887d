"""Where compiled kernels are kept: never beside other sources than their own, never required."""

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import numba
import pytest
from numba.core import caching

from analytic.kernels import compiled, kept

KERNELS = {
    "__init__.py": "",
    "inner/__init__.py": "",
    "kernels/__init__.py": "",
    "inner/law.py": """
from analytic.kernels.compiled import kernel

@kernel
def law(x):
    return x + 1.0
""",
    "steps.py": """
from analytic.kernels.compiled import kernel
from analytic.inner.law import law

@kernel
def steps(x):
    return 10.0 * law(x)
""",
}
PLACES = ("NUMBA_CACHE_DIR", "XDG_CACHE_HOME", "HOME", "TMPDIR")
PROGRAM = """
from analytic import steps
from analytic.kernels import compiled, kept
compiled.compile_all()
value = steps.steps(1.0)
hits = sum(steps.steps.compiled.stats.cache_hits.values())
print(value, hits, kept.kept_in(compiled.SOURCES))
"""


@pytest.fixture
def package(tmp_path):
    """A package of two kernels, the one in need of the other."""
    for name, text in KERNELS.items():
        path = tmp_path / "package" / "analytic" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for module in (compiled, kept):
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


def test_a_folder_is_named_by_all_sources(package, tmp_path):
    sources = package / "analytic"

    def name():
        return kept.folder_for(sources, [tmp_path / "kept"]).name

    names = [name()]
    for path in ("steps.py", "inner/law.py", "inner/more.py"):
        with (sources / path).open("a") as file:
            file.write("\n# edited")
        names.append(name())
    assert len(set(names)) == 4
    assert kept.folder_for(sources, [Path("/dev/null"), Path("/proc/none")]) is None


def test_other_kernels_of_the_user_are_kept_where_they_were():
    before = numba.config.CACHE_DIR

    @compiled.kernel
    def twice(x):
        return 2.0 * x

    assert twice.run(2.0) == 4.0
    assert before == numba.config.CACHE_DIR
    folder = str(kept.kept_in(compiled.SOURCES))
    assert twice.compiled.stats.cache_path.startswith(folder)


def test_a_kernel_runs_where_the_disk_is_full(monkeypatch):
    def save(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(caching.IndexDataCacheFile, "save", save)

    @compiled.kernel
    def thrice(x):
        return 3.0 * x

    assert thrice.run(2.0) == 6.0
    assert thrice.run(3.0) == 9.0


def test_who_waits_is_told_once_and_only_where_something_is_compiled(monkeypatch, tmp_path):
    told = []
    monkeypatch.setattr(compiled.Kernel, "tell", told.append)
    monkeypatch.setattr(compiled, "kept_in", lambda _: tmp_path)

    def again():
        @compiled.kernel
        def half(x):
            return 0.5 * x

        @compiled.kernel
        def quarter(x):
            return 0.5 * half(x)

        return quarter

    assert again().run(2.0) == 0.5
    assert len(told) == 1
    told.clear()
    monkeypatch.setattr(compiled.Kernel, "tell", told.append)
    assert again().run(2.0) == 0.5
    assert not told
