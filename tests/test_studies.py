"""The studies: sources, cases, runner, results folder, figures, findings."""

import fcntl
import json
import math
import os
import signal
import subprocess
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analytic import RigidBlock, SinePulse, simulate
from analytic.response import Impact, Outcome, Response
from engines import ENGINES, PRESETS
from studies import histories, respond, sweep
from studies.__main__ import run
from studies.cases import HISTORIES, sweep_cases
from studies.differences import summarize, with_reference, worst_cases
from studies.findings import findings
from studies.journal import FolderError, open_journal
from studies.provenance import identity
from studies.runner import Job, Local, run_jobs, summary
from studies.sources import SOURCES, Source, UnknownSourceError, resolve

BLOCK = RigidBlock(width=0.5, height=1.5)
PULSE = SinePulse(amplitude=0.4 * 9.81, omega=2.0 * math.pi, half_cycles=2)
HERE = Path(__file__).parent


# sources that misbehave; they stand at the top of the module so that a worker finds them
def exits(block, motion, *, duration, times):
    os._exit(3)


def segfaults(block, motion, *, duration, times):
    os.kill(os.getpid(), signal.SIGSEGV)


def hangs(block, motion, *, duration, times):
    time.sleep(60.0)


def raises(block, motion, *, duration, times):
    raise RuntimeError("the engine\nsaid no")


def slow(block, motion, *, duration, times):
    time.sleep(0.005)
    return simulate(block, motion, duration=duration, times=times)


def slow_sweep(folder):
    """What a killed run runs: figure 6 through a source of 5 ms a case."""
    SOURCES["slow"] = Source("engine", slow)
    arguments = ["sweep", "--figure", "6", "--sources", "slow", "--out", folder, "--jobs", "1"]
    raise SystemExit(run(arguments))


def job(source, **labels):
    return Job(labels=labels, block=BLOCK, motion=PULSE, source=source)


EVERY_NAME = [*SOURCES, *(f"{engine}:{preset}" for engine in ENGINES for preset in PRESETS)]


@pytest.mark.parametrize("name", EVERY_NAME)
def test_every_source_answers_figure_5b(name):
    times = np.linspace(0.0, 1.5, 16)
    response = respond(name, BLOCK, PULSE, duration=3.0, times=times)
    assert isinstance(response, Response)
    # the paper: 5-b overturns by Housner's linearization alone. With the onset matched the block
    # survives, so it is the onset that overturns it.
    if name == "housner":
        assert response.outcome is Outcome.OVERTURNED
        assert response.peak_ratio == math.inf
        assert all(response.history.time <= 3.0)
    else:
        assert response.outcome is Outcome.ROCKED
        # out of the box an engine is wrong by a quarter; everything else is within the 7 % by
        # which the modified linearization misses
        allowed = 0.3 if name.endswith(":naive") else 0.07
        assert response.peak_ratio == pytest.approx(0.3852, rel=allowed)
        np.testing.assert_allclose(response.history.time, times)
    assert all(isinstance(impact, Impact) for impact in response.impacts)
    assert response.impacts
    assert response.steps > 0


def test_an_unknown_source_is_refused_with_the_list():
    for name in ("nonsense", "exact:fixed", "mujoco:", "mujoco:best", ":fixed"):
        with pytest.raises(UnknownSourceError, match="mujoco") as error:
            respond(name, BLOCK, PULSE)
        assert repr(name) in str(error.value)


def test_options_reach_the_source():
    coarse = respond("rk4", BLOCK, PULSE, step=1e-2)
    assert coarse.steps < respond("rk4", BLOCK, PULSE, step=1e-3).steps / 5


@pytest.mark.parametrize("module", ["studies", "studies.__main__"])
def test_importing_loads_nothing_heavy(module):
    program = (
        f"import sys, {module}\n"
        "print(*[n for n in ('engines', 'pandas', 'matplotlib', 'numba') if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.stdout.strip(), done.stderr) == ("", "")


def test_the_paper_has_960_cases():
    cases = list(sweep_cases((6, 7, 8, 9)))
    assert len(cases) == len(set(cases)) == 960
    last = cases[-1]
    assert (last.figure, last.pulse, last.aspect, last.width_m) == (9, "full-sine", 4, 1.0)
    assert last.block.height == 4.0
    assert last.motion.amplitude == pytest.approx((0.25 + 0.125) * 9.81)
    assert last.motion.omega == pytest.approx(4.0 * last.block.p)
    assert last.motion.half_cycles == 2


# published with the project's description of the paper, as exact / Housner / modified
HISTORY_PEAKS = {
    (4, "a"): (0.0197, 0.0219, 0.0197),
    (4, "b"): (0.0391, 0.0578, 0.0388),
    (4, "c"): (0.2249, 0.3824, 0.2138),
    (5, "a"): (0.1750, 0.2119, 0.1737),
    (5, "b"): (0.3852, math.inf, 0.3605),
    (5, "c"): (0.5558, math.inf, 0.4446),
}


def test_the_histories_have_their_known_peaks():
    for case in HISTORIES[4] + HISTORIES[5]:
        names = ("exact", "housner", "modified")
        found = [respond(name, case.block, case.motion).peak_ratio for name in names]
        # four published decimals
        assert found == pytest.approx(HISTORY_PEAKS[case.figure, case.panel], abs=5.1e-5)


def test_whatever_an_engine_does_becomes_a_row(monkeypatch):
    for misbehaving in (exits, segfaults, hangs, raises, slow):
        monkeypatch.setitem(SOURCES, misbehaving.__name__, Source("engine", misbehaving))
    names = ["exits", "segfaults", "hangs", "raises", "slow", "exact"]
    # the limit also covers a worker's imports, which share the machine with other tests
    rows = run_jobs(
        [job(name) for name in names],
        executor=Local(workers=2, time_limit_s=8.0),
        reduce=summary,
    )
    assert [row["source"] for row in rows] == names
    assert [row["outcome"] for row in rows] == ["failed"] * 4 + ["rocked"] * 2
    assert all(math.isnan(row["peak_ratio"]) for row in rows[:4])
    for row, reason in zip(rows, ("code 3", "SIGSEGV", "limit of 8 s", "said no"), strict=False):
        assert reason in row["message"]
        assert "\n" not in row["message"]


def test_failures_are_tried_again_and_successes_are_not(tmp_path, monkeypatch):
    asked = []

    def sometimes(block, motion, *, duration, times):
        asked.append(len(asked))
        # the first call only loads the source; the second is the job's
        if len(asked) <= 2:
            raise RuntimeError("not yet")
        return simulate(block, motion)

    monkeypatch.setitem(SOURCES, "sometimes", Source("model", sometimes))
    outcomes = []
    for _ in range(3):
        with open_journal(tmp_path, identity("test"), ()) as journal:
            (row,) = run_jobs(
                [job("sometimes")], executor=Local(1, 1.0), reduce=summary, journal=journal
            )
        outcomes.append(row["outcome"])
    assert outcomes == ["failed", "rocked", "rocked"]
    assert len(asked) == 4


def test_a_job_is_known_by_everything_that_changes_it():
    base = job("mujoco")
    wider = RigidBlock(width=0.6, height=1.5)
    bouncy = RigidBlock(width=0.5, height=1.5, restitution=0.9)
    longer = SinePulse(amplitude=PULSE.amplitude, omega=PULSE.omega, half_cycles=3)
    others = [
        job("mujoco:naive"),
        job("pybullet"),
        Job(labels={}, block=wider, motion=PULSE, source="mujoco"),
        Job(labels={}, block=bouncy, motion=PULSE, source="mujoco"),
        Job(labels={}, block=BLOCK, motion=longer, source="mujoco"),
        Job(labels={}, block=BLOCK, motion=PULSE, source="mujoco", duration=2.0),
        Job(labels={}, block=BLOCK, motion=PULSE, source="mujoco", times=np.arange(3.0)),
        Job(labels={}, block=BLOCK, motion=PULSE, source="mujoco", options={"step": 1e-3}),
        Job(labels={"figure": 6}, block=BLOCK, motion=PULSE, source="mujoco"),
    ]
    assert base.key == job("mujoco").key
    assert len({base.key, *(other.key for other in others)}) == len(others) + 1


def test_the_key_knows_which_preset_a_plain_name_means(monkeypatch):
    before = job("mujoco").key
    monkeypatch.setitem(SOURCES, "mujoco", resolve("mujoco:naive"))
    assert job("mujoco").key != before


def lines_of(folder):
    return (folder / "journal.jsonl").read_bytes().splitlines()


def start_slow_sweep(folder):
    program = f"import test_studies; test_studies.slow_sweep({str(folder)!r})"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), str(HERE.parent)])}
    return subprocess.Popen(
        [sys.executable, "-c", program],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def wait_for_rows(folder, process, number):
    journal = folder / "journal.jsonl"
    deadline = time.monotonic() + 40.0
    while not journal.exists() or len(lines_of(folder)) < number:
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < deadline
        time.sleep(0.005)


def test_a_killed_run_goes_on_where_it_stopped(tmp_path):
    with start_slow_sweep(tmp_path) as first:
        wait_for_rows(tmp_path, first, 30)
        first.kill()
    finished = lines_of(tmp_path)
    assert 30 <= len(finished) < 241
    with (tmp_path / "journal.jsonl").open("ab") as journal:
        journal.write(b'{"key": "torn in the mid')
    with start_slow_sweep(tmp_path) as second:
        output, errors = second.communicate(timeout=60.0)
    assert (second.returncode, errors) == (0, "")
    assert "not tested" in output
    lines = lines_of(tmp_path)
    assert lines[: len(finished)] == finished
    keys = [json.loads(line)["key"] for line in lines[1:]]
    assert len(keys) == len(set(keys)) == 240
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 240


def test_an_interrupted_run_says_how_to_go_on(tmp_path):
    with start_slow_sweep(tmp_path) as process:
        wait_for_rows(tmp_path, process, 30)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=30.0)
    assert process.returncode == 130
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert "the same command goes on" in errors
    assert len(lines_of(tmp_path)) >= 30


def test_two_runs_never_share_a_folder(tmp_path):
    with (tmp_path / ".lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(FolderError, match="in use"):
            sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    assert sorted(path.name for path in tmp_path.iterdir()) == [".lock"]


MODELS_AND_SOLVERS = [name for name, source in SOURCES.items() if source.kind != "engine"]


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    began = time.perf_counter()
    rows = sweep.sweep([6, 7, 8, 9], MODELS_AND_SOLVERS, folder, executor=Local(1, 1.0))
    seconds = time.perf_counter() - began
    text = sweep.report(folder)
    return folder, rows, text, seconds


def test_the_models_sweep_has_its_columns_and_rows(swept):
    folder, rows, _, seconds = swept
    table = pd.read_csv(folder / "sweep.csv")
    assert list(table.columns) == [
        *("figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p", "source"),
        *("outcome", "peak_ratio", "impacts", "steps", "wall_s", "message"),
    ]
    assert len(table) == len(rows) == 960 * len(MODELS_AND_SOLVERS)
    assert (table["peak_ratio"].eq(math.inf) == table["outcome"].eq("overturned")).all()
    assert not table["outcome"].eq("failed").any()
    # 1.7 s on two cores; the margin is for compiling on a first use
    assert seconds < 30.0


def test_the_conclusions_of_the_paper_fall_as_they_fall(swept):
    folder, _, text, _ = swept
    table = sweep.read(folder)
    compared = with_reference(table)
    summary_table = summarize(compared).set_index(["figure", "source"])
    assert summary_table.loc[("all", "exact"), "agree"] == 960
    assert summary_table.loc[("all", "exact"), "max_error"] < 1e-10
    assert summary_table.loc[("all", "housner"), "false_overturnings"] > 0
    assert summary_table.loc[("all", "modified"), "missed_overturnings"] > 0
    holds = {item.statement.split(" (")[0]: item.holds for item in findings(compared)}
    verdicts = list(holds.values())
    assert verdicts[:6] == [True, False, True, False, True, True]
    assert all(verdicts[6:])
    assert len(verdicts) == 6 + len(MODELS_AND_SOLVERS)
    assert (folder / "findings.txt").read_text().strip() in text
    assert max(len(line) for line in text.splitlines()) <= 100


def test_findings_report_what_breaks_them(swept):
    compared = with_reference(sweep.read(swept[0]))
    calm = compared[compared["aspect"] == 4].assign(false_overturning=False)
    assert findings(calm)[0].holds is False
    wide = compared["width_m"].eq(1.0) & compared["source"].eq("exact")
    scaled = compared.assign(peak_ratio=compared["peak_ratio"].where(~wide, 2.0))
    coincide = {item.statement: item.holds for item in findings(scaled)}
    assert coincide["the left and right panels coincide for exact (within 1e-6)"] is False
    assert coincide["the left and right panels coincide for rk4 (within 1e-6)"] is True
    alone = findings(compared[compared["source"] == "exact"])
    assert [item.holds for item in alone] == [None] * 6 + [True]


def test_errors_are_counted_against_the_exact_solution():
    rows = pd.DataFrame(run_sweep_row(omega) for omega in (0.1, 1.0, 4.0))
    rows["outcome"] = ["rocked", "overturned", "rocked"]
    rows["peak_ratio"] = [0.5, math.inf, 2.0 * rows["peak_ratio"][2]]
    line = summarize(with_reference(rows)).iloc[0]
    assert (line["agree"], line["missed_overturnings"], line["false_overturnings"]) == (1, 1, 1)
    assert line["max_error"] == pytest.approx(1.0)


def test_the_worst_case_comes_with_its_conditioning(swept):
    worst = worst_cases(with_reference(sweep.read(swept[0]))).set_index("source")
    assert list(worst.index) == MODELS_AND_SOLVERS
    case = worst.loc["housner"]
    block = RigidBlock(width=case["width_m"], height=case["aspect"] * case["width_m"])
    excess, half_cycles = {6: (0.05, 1), 7: (0.1, 1), 8: (0.1, 2), 9: (0.125, 2)}[case["figure"]]

    def peak(scale):
        amplitude = scale * (1.0 / case["aspect"] + excess) * 9.81
        omega = case["omega_over_p"] * block.p
        motion = SinePulse(amplitude=amplitude, omega=omega, half_cycles=half_cycles)
        return simulate(block, motion).peak_ratio

    # two difference quotients of different width agree to their second order
    slope = (peak(1.0001) / peak(0.9999) - 1.0) / 2e-4
    assert case["kappa"] == pytest.approx(slope, rel=1e-2)
    assert case["exact_peak"] == pytest.approx(peak(1.0), rel=1e-10)


def run_sweep_row(omega_over_p):
    jobs = sweep.sweep_jobs([6], ["exact"], None)
    chosen = next(item for item in jobs if item.labels["omega_over_p"] == omega_over_p)
    return run_jobs([chosen], executor=Local(1, 1.0), reduce=summary)[0]


def test_figures_are_drawn_from_the_csv_alone(swept, tmp_path):
    folder = swept[0]
    (tmp_path / "sweep.csv").write_bytes((folder / "sweep.csv").read_bytes())
    drawn = sweep.redraw(tmp_path)
    assert [path.name for path in drawn] == [f"figure-{n}.png" for n in (6, 7, 8, 9)]
    for path in drawn:
        assert path.read_bytes() == (folder / path.name).read_bytes()
        assert path.stat().st_size > 50_000


def test_a_rerun_computes_nothing(swept):
    folder = swept[0]
    before = lines_of(folder)
    sweep.sweep([6, 7, 8, 9], MODELS_AND_SOLVERS, folder, executor=refuse_any)
    assert lines_of(folder) == before


def refuse_any(jobs):
    assert not jobs
    yield from ()


def test_provenance_says_what_ran(swept):
    record = json.loads((swept[0] / "provenance.json").read_text())
    project = tomllib.loads((HERE.parent / "pyproject.toml").read_text())["project"]
    assert record["version"] == project["version"]
    for name, version in record["engines"].items():
        assert f"{name}=={version}" in project["dependencies"]
    assert record["settings"] == {"step": None}
    assert set(record["machine"]) == {"cpu", "cores", "os"}
    assert record["packages"]["numpy"] == np.__version__
    assert record["python"] == ".".join(map(str, sys.version_info[:3]))
    first = record["runs"][0]
    assert first["rows"] == 960 * len(MODELS_AND_SOLVERS)
    assert first["duration_s"] > 0.0
    assert str(Path.home()) not in json.dumps(record)


@pytest.mark.parametrize(
    ("change", "named"),
    [({"version": "0.0.9"}, "0.0.9"), ({"journal": 0}, "journal"), ({"code": "old"}, "old")],
)
def test_a_folder_of_another_version_is_left_alone(tmp_path, change, named):
    sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    path = tmp_path / "journal.jsonl"
    header, rest = path.read_bytes().split(b"\n", 1)
    path.write_bytes(json.dumps(json.loads(header) | change).encode() + b"\n" + rest)
    before = {item.name: item.read_bytes() for item in tmp_path.iterdir()}
    with pytest.raises(FolderError, match=named):
        sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    assert {item.name: item.read_bytes() for item in tmp_path.iterdir()} == before


def test_a_folder_grows_and_never_shrinks(tmp_path):
    executor = Local(1, 1.0)
    sweep.sweep([6], ["exact"], tmp_path, executor=executor)
    sweep.sweep([6, 7], ["exact", "modified"], tmp_path, executor=executor)
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 960
    for figures, sources, missing in (
        ([6, 7], ["exact"], "modified"),
        ([6], ["exact", "modified"], "figure 7"),
    ):
        with pytest.raises(FolderError, match=missing):
            sweep.sweep(figures, sources, tmp_path, executor=executor)
    with pytest.raises(FolderError, match="settings"):
        sweep.sweep([6, 7], ["exact", "modified"], tmp_path, executor=executor, step=1e-2)
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 960


def test_a_strangers_results_are_left_alone(tmp_path):
    (tmp_path / "sweep.csv").write_text("mine\n")
    with pytest.raises(FolderError, match="unknown origin"):
        sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    assert (tmp_path / "sweep.csv").read_text() == "mine\n"


def test_another_provenance_is_left_alone(tmp_path):
    sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    path = tmp_path / "provenance.json"
    for text in (path.read_text().replace('"version": "', '"version": "9.'), "{}", "?"):
        path.write_text(text)
        with pytest.raises(FolderError, match="provenance"):
            sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
        assert path.read_text() == text


def test_a_damaged_journal_is_named(tmp_path):
    sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    path = tmp_path / "journal.jsonl"
    lines = path.read_bytes().splitlines(keepends=True)
    lines[5] = b"?\n"
    path.write_bytes(b"".join(lines))
    with pytest.raises(FolderError, match="line 6"):
        sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))


def test_the_histories_are_drawn_and_judged(tmp_path, capsys):
    assert histories.command(out=tmp_path) == 0
    text = capsys.readouterr().out
    assert text.count("holds: ") == 3
    assert "does not hold" not in text
    for figure, panels in HISTORIES.items():
        samples = pd.read_csv(tmp_path / f"figure-{figure}.csv")
        assert set(samples["panel"]) == {case.panel for case in panels}
        before = (tmp_path / f"figure-{figure}.png").read_bytes()
        assert len(before) > 30_000
        assert histories.redraw(tmp_path, figure).read_bytes() == before


def test_histories_of_named_sources_can_be_run_again(tmp_path, capsys, monkeypatch):
    for _ in range(2):
        assert histories.command(out=tmp_path, figure=(5,), sources=("exact",)) == 0
        assert "not tested: In 5-b and 5-c" in capsys.readouterr().out
    with pytest.raises(FolderError, match="sources"):
        histories.command(out=tmp_path, figure=(5,), sources=("housner",))


def test_a_history_that_failed_leaves_the_others(tmp_path, capsys, monkeypatch):
    monkeypatch.setitem(SOURCES, "raises", Source("model", raises))
    assert histories.command(out=tmp_path, figure=(4,), sources=("raises", "exact")) == 1
    assert "failed" in capsys.readouterr().out
    assert set(pd.read_csv(tmp_path / "figure-4.csv")["source"]) == {"exact"}


def test_a_long_solve_has_a_time_limit_too():
    long = SinePulse(amplitude=0.34 * 9.81, omega=100.0, half_cycles=10**9)
    jobs = [Job(labels={}, block=BLOCK, motion=long, source=name) for name in ("rk4",)]
    rows = run_jobs(jobs, executor=Local(2, 0.5), reduce=summary)
    assert ["time limit" in row["message"] for row in rows] == [True]
