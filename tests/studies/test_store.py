"""A results folder: what it keeps, what it computes again, and what it refuses."""

import dataclasses
import json
import resource
import signal
import sqlite3
import subprocess
import sys
import time
from functools import partial

import pandas as pd
import pytest
from commanding import ROOT, python
from given import BLOCK, FULL_SINE

from analytic.response import Response
from studies import sweep
from studies.__main__ import run as command
from studies.kit import identity, run, store
from studies.kit.identity import changed, maker_of
from studies.kit.jobs import Job, Question, answer
from studies.kit.store import FolderError, Store
from studies.kit.tables import read_table, write_table
from studies.sources.registry import SOURCES, Source, resolve

CASE = Question(system=BLOCK, motion=FULL_SINE)
JOBS = [
    Job(labels={"case": n}, case=CASE, source=name) for n in (1, 2) for name in ("exact", "rk4")
]


def filled(folder, jobs=JOBS, measure=answer, also=(), table=""):
    with Store(folder, "sweep", table) as kept:
        rows = run.run(jobs, measure, store=kept, also=also)
        makers = run.makers_of(jobs, measure)
        kept.finish({"sweep": pd.DataFrame(rows)}, makers, len(rows))
    return rows, json.loads((folder / "provenance.json").read_text())["runs"][-1]["computed"]


def test_a_finished_folder_computes_nothing_and_a_new_job_alone(tmp_path, monkeypatch):
    rows, computed = filled(tmp_path, JOBS[:2])
    assert computed == 2
    again, computed = filled(tmp_path, JOBS)
    assert (again[:2], computed) == (rows, 2)
    here = store.provenance_of(tmp_path)["machine"]
    monkeypatch.setattr(store, "machine", lambda: {"cpu": "another"})
    assert filled(tmp_path)[1] == 0
    assert store.provenance_of(tmp_path)["machine"] == here


def test_a_failure_is_kept_but_one_of_its_process_is_tried_again(tmp_path, monkeypatch):
    lost = Response.failure("the process was ended by signal SIGSEGV")
    answers = iter([lost, Response.failure("it diverged")])
    source = Source("model", lambda *_, **__: next(answers))
    monkeypatch.setitem(SOURCES, "never", source)
    jobs = [dataclasses.replace(JOBS[0], source="never")]
    assert filled(tmp_path, jobs)[0][0]["message"] == lost.message
    for computed in (1, 0):
        rows, count = filled(tmp_path, jobs)
        assert (rows[0]["message"], count) == ("it diverged", computed)


def test_other_code_and_other_versions_make_rows_old(tmp_path, monkeypatch, capsys):
    filled(tmp_path)
    made = identity.version_of
    monkeypatch.setattr(identity, "version_of", lambda name: made(name) + "1" * (name == "numpy"))
    maker_of.cache_clear()
    try:
        assert filled(tmp_path)[1] == 4
    finally:
        maker_of.cache_clear()
    assert "computed again: exact: other numpy" in capsys.readouterr().err


def test_what_makes_a_row_old(tmp_path):
    assert changed({"box2d": "2.3.10"}, {"box2d": identity.NOT_INSTALLED}) == []
    assert changed({"box2d": "2.3.10"}, {"box2d": "2.3.11"}) == ["box2d"]
    texts = ("def f(): return 1", "def f():\n    'A'\n    return 1  # b", "def f(): return 2")
    digests = []
    for number, text in enumerate(texts):
        (tmp_path / str(number)).mkdir()
        (tmp_path / str(number) / "a.py").write_text(text)
        digests.append(identity.code_in(tmp_path / str(number) / "a.py"))
    assert digests[0] == digests[1] != digests[2]
    finer = dataclasses.replace(JOBS[1], options={"step": 1e-4})
    assert len({job.key for job in [*JOBS, finer]}) == len(JOBS) + 1


def test_an_engine_depends_on_its_own_files_and_a_model_on_none():
    exact, bullet, mujoco = (maker_of(resolve(n), answer) for n in ("exact", "pybullet", "mujoco"))
    assert not [name for name in exact if "code of" in name or name == "engines"]
    assert bullet["code of pybullet"] != mujoco["code of mujoco"]
    assert "code of mujoco" not in bullet
    assert bullet["engines"] == mujoco["engines"]


def test_a_measure_of_a_study_depends_on_the_files_that_it_imports():
    files = {path.relative_to(ROOT).as_posix() for path in identity.files_of("studies.sweep")}
    assert {"studies/sweep.py", "studies/cases/paper.py", "studies/measures/wrongness.py"} <= files
    assert not [path for path in files if path.startswith(("studies/kit", "studies/drawing"))]
    assert (
        maker_of(resolve("exact"), sweep.jobs)["studies"]
        != maker_of(resolve("exact"), answer)["studies"]
    )


def test_rows_that_are_not_asked_for_are_refused(tmp_path):
    filled(tmp_path)
    with pytest.raises(FolderError, match="holds results of case 2, source exact; ask for those"):
        filled(tmp_path, JOBS[:2])
    with pytest.raises(FolderError, match="holds results of case 1, source rk4"):
        filled(tmp_path, JOBS[::2])
    finer = [dataclasses.replace(job, options={"step": 1e-4}) for job in JOBS[1::2]]
    with pytest.raises(FolderError, match="holds results of case 1, source rk4"):
        filled(tmp_path, [*JOBS[::2], *finer])


def test_a_folder_of_another_kind_is_refused(tmp_path):
    (tmp_path / "mine.csv").write_text("a\n1\n")
    with pytest.raises(FolderError, match="must be new or empty"):
        filled(tmp_path)
    other = tmp_path / "other"
    with Store(other, "contact"):
        pass
    with pytest.raises(FolderError, match="results of contact"):
        filled(other)


def test_a_second_run_at_the_same_time_is_refused(tmp_path):
    with Store(tmp_path, "sweep"), pytest.raises(FolderError, match="in use by another run"):
        Store(tmp_path, "sweep")
    Store(tmp_path, "sweep")


def test_a_signal_that_compiled_code_lost_ends_a_run_all_the_same(tmp_path, monkeypatch):
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(run, "ended", [2])
        filled(tmp_path)
    assert filled(tmp_path)[1] == len(JOBS) - 1


def test_a_damaged_store_is_refused(tmp_path):
    filled(tmp_path)
    (tmp_path / store.ROWS).write_bytes(b"no database at all, but long enough to be read" * 99)
    with pytest.raises(FolderError, match=r"rows\.sqlite"):
        filled(tmp_path)
    (tmp_path / store.ROWS).unlink()
    filled(tmp_path / "b")
    base = sqlite3.connect(tmp_path / "b" / store.ROWS)
    base.execute("UPDATE rows SET row = '{'")
    base.commit()
    base.close()
    with pytest.raises(FolderError, match="damaged"):
        filled(tmp_path / "b")


def test_a_folder_without_a_store_goes_on_from_its_table(tmp_path):
    rows, _ = filled(tmp_path, table="sweep")
    (tmp_path / store.ROWS).unlink()
    again, computed = filled(tmp_path, table="sweep")
    assert (again, computed) == (rows, 0)
    (tmp_path / store.ROWS).unlink()
    with pytest.raises(FolderError, match="case 2"):
        filled(tmp_path, JOBS[:2], table="sweep")


def test_rows_of_another_folder_are_taken_over(tmp_path):
    rows, _ = filled(tmp_path / "there", JOBS[:3])
    mine, computed = filled(tmp_path / "here", JOBS, also=[tmp_path / "there"])
    assert (mine[:3], computed) == (rows, 1)
    taken = json.loads((tmp_path / "here" / "provenance.json").read_text())["runs"][0]["also"]
    assert [each["rows"] for each in taken] == [3]
    with pytest.raises(FolderError, match=r"--also is .* must be a results folder"):
        filled(tmp_path / "c", also=[tmp_path])
    with pytest.raises(FolderError, match="no row of what is asked"):
        filled(tmp_path / "d", JOBS[3:], also=[tmp_path / "there"])


def test_a_table_that_was_edited_is_no_longer_published(tmp_path):
    filled(tmp_path)
    store.check(tmp_path, ["sweep.csv", "missing.csv"], "--published")
    (tmp_path / "sweep.csv").write_text("edited")
    with pytest.raises(FolderError, match=r"its sweep\.csv is not what its provenance"):
        store.check(tmp_path, ["sweep.csv"], "--published")


def test_tables_come_back_to_the_bit(tmp_path):
    table = pd.DataFrame(
        {"word": ["=1+1", "", "-3", "x"], "x": [0.1 + 0.2, float("nan"), float("inf"), -0.0]}
    )
    write_table(tmp_path / "t.csv", table)
    pd.testing.assert_frame_equal(read_table(tmp_path / "t.csv", "word"), table, check_exact=True)


SWEEP = ("-m", "studies", "sweep", "--figure", "6", "--sources", "exact", "mujoco")


def waiting(folder, count, *arguments):
    process = subprocess.Popen([sys.executable, *arguments, "--out", str(folder)], cwd=ROOT)
    while sum(path.stat().st_size for path in folder.glob("*-wal")) < 5000 * count:
        assert process.poll() is None
        time.sleep(0.02)
    return process


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    assert python(*SWEEP, "--out", folder).returncode == 0
    return folder


@pytest.mark.slow
@pytest.mark.processes
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT, signal.SIGTERM])
def test_a_run_that_is_ended_goes_on_with_equal_rows(number, whole, tmp_path):
    halved = tmp_path / "halved"
    process = waiting(halved, 20, *SWEEP)
    process.send_signal(number)
    began = time.monotonic()
    assert process.wait(60.0) == (-number if number == signal.SIGKILL else 128 + number)
    assert number == signal.SIGKILL or time.monotonic() - began < 5.0
    assert python(*SWEEP, "--out", halved).returncode == 0
    last = json.loads((halved / "provenance.json").read_text())["runs"][-1]
    assert 0 < last["computed"] < last["rows"] == 480
    pd.testing.assert_frame_equal(
        *(pd.read_csv(f / "sweep.csv").drop(columns="wall_s") for f in (whole, halved)),
        check_exact=True,
    )


@pytest.mark.slow
@pytest.mark.processes
def test_a_full_disk_is_a_line_and_loses_no_row(tmp_path):
    limit = partial(resource.setrlimit, resource.RLIMIT_FSIZE, (100_000, 100_000))
    done = python(*SWEEP[:-1], "--out", tmp_path / "out", before=limit)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "rows are kept" in line and "cannot be written" in line
    assert command([*SWEEP[2:-1], "--out", str(tmp_path / "out")]) == 0
