"""A comparison: in JSON, as a table, from Python, as a picture; of a frame and a slide."""

import json
import math
import re

import pytest
from commanding import CASE, ROOT, compared, python
from given import BLOCK, PULSE

import studies
from analytic import RockingFrame, SinePulse, SlidingBlock, Still, simulate
from studies import respond, side_by_side
from studies.__main__ import run
from studies.kit.jobs import Job, Question, summary
from studies.measures.halving import published_trust
from studies.measures.published import PUBLISHED
from studies.scenes import measure

FIELDS = [
    *("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message"),
    *("error", "velocity_ratio", "impact_error", "kappa", "sensitivity"),
    *("min_normal", "friction_needed", "valid"),
]
WINDOW = PULSE.duration + 8.0 / BLOCK.p
NEEDED = simulate(BLOCK, PULSE).friction_needed


def text_of(capsys, *options, code=0):
    capsys.readouterr()
    assert run(["compare", *map(str, options)]) == code
    return capsys.readouterr().out


def test_json_is_one_object_a_line_and_nothing_else():
    sources = ["exact", "housner", "modified", "pybullet", "mujoco"]
    asked = ["compare", *CASE, "--pulse", "full-sine", "--sources", *sources, "--json"]
    done = python("-m", "studies", *asked)
    assert (done.returncode, done.stderr) == (0, "")
    rows = [json.loads(line, parse_constant=pytest.fail) for line in done.stdout.splitlines()]
    assert [row["source"] for row in rows] == sources
    assert all([name for name in row if name != "yaw_deg"] == FIELDS for row in rows)
    found = {row["source"]: row for row in rows}
    fallen, exact = found.pop("housner"), found["exact"]
    nothing = ("peak_ratio", "error", "impact_error")
    assert [fallen["outcome"], *(fallen[name] for name in nothing)] == ["overturned", *[None] * 3]
    late = {name: row["impact_error"] for name, row in found.items()}
    assert max(late["pybullet"], late["mujoco"]) < 1e-4 < late["modified"] < 0.3
    assert (exact["error"], late["exact"], exact["valid"]) == (0.0, 0.0, True)
    for row in found.values():
        assert (row["outcome"], row["friction_needed"]) == ("rocked", exact["friction_needed"])
        assert row["peak_ratio"] == pytest.approx(0.3852, rel=0.07)
        relative = row["peak_ratio"] / exact["peak_ratio"] - 1.0
        assert row["error"] == pytest.approx(relative, rel=1e-12)
        assert row["velocity_ratio"] == pytest.approx(0.85, rel=1e-4)
        assert row["impacts"] >= 3 and row["steps"] > 0 and row["wall_s"] > 0.0


def test_kappa_and_sensitivity_are_of_the_case_and_null_where_an_outcome_changes(capsys):
    near_onset = [
        *("--width", "1.5256313519414122", "--height", "9.174363250019729"),
        *("--pulse", "full-sine", "--omega", "2.10102467443576", "--sources", "exact", "housner"),
    ]
    code, rows = compared(capsys, *near_onset, "--amplitude", "0.17396032278997067")
    assert (code, len(rows)) == (0, 2)
    for row in rows.values():
        assert row["kappa"] == pytest.approx(45.237, abs=1e-3)
        assert row["sensitivity"] == pytest.approx(6775, abs=1)
    onset = 1.5256313519414122 / 9.174363250019729
    _, rows = compared(capsys, *near_onset, "--amplitude", onset * (1.0 + 5e-5))
    assert (rows["exact"]["outcome"], rows["exact"]["sensitivity"]) == ("rocked", None)


def test_the_text_fits_the_screen_and_has_the_columns_of_json(capsys, tmp_path):
    plot = tmp_path / "histories.png"
    asked = [*CASE, "--duration", 2.5, "--sources", "rk4", "average-acceleration", "housner"]
    text, rows = text_of(capsys, *asked, "--plot", plot), compared(capsys, *asked)[1]
    assert max(len(line) for line in text.splitlines()) <= 100
    head, lines = text.split("\n\n")
    assert "2.5 s" in head and f"kappa {rows['rk4']['kappa']:.3g}" in head
    names, *lines = (line.split() for line in lines.splitlines())
    assert {*names} <= {*FIELDS} and [line[0] for line in lines] == [*rows]
    found = dict(zip(names, lines[0], strict=False))
    assert found["peak_ratio"] == f"{rows['rk4']['peak_ratio']:.6f}"
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_a_block_is_released_from_a_tilt_in_units_of_alpha(capsys):
    options = ["--tilt", "-0.6", "--duration", "2", "--sources"]
    _, found = compared(capsys, *CASE[:4], *options, "exact", "dop853", "pybullet", "mujoco")
    rows = [*found.values()]
    assert [row["peak_ratio"] for row in rows] == pytest.approx([0.6] * 4, rel=1e-12)
    # landing steps of p dt = 1/200 are of second order
    assert all(row["impact_error"] < 200**-2 for row in rows)
    exact = simulate(BLOCK, Still(), start=(-0.6 * BLOCK.alpha, 0.0), duration=2.0)
    assert rows[0]["impacts"] == len(exact.impacts)
    assert rows[0]["min_normal"] == exact.min_normal


def test_rate_and_phase(capsys):
    theta, rate = 0.2 * BLOCK.alpha, -0.3 * BLOCK.alpha * BLOCK.p
    start = ["--tilt", "0.2", "--rate", "-0.3", "--phase", "2", "--half-cycles", "2"]
    row = compared(capsys, *CASE, *start, "--sources", "exact")[1]["exact"]
    pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2, phase=2.0)
    exact = simulate(BLOCK, pulse, start=(theta, rate), duration=pulse.duration + 8.0 / BLOCK.p)
    assert row["peak_ratio"] == pytest.approx(exact.peak_ratio, rel=1e-9)
    assert row["impacts"] == len(exact.impacts)
    assert "θ = 0.2 α, θ' = -0.3 αp" in text_of(capsys, *CASE, *start, "--sources", "exact")


def test_where_the_reference_is_not_valid(capsys):
    """A squat block would have to be held down; of one that falls its fall does not count."""
    squat = ["--width", "1", "--height", "1", "--amplitude", "2.5", "--omega", "15"]
    row = compared(capsys, *squat, "--sources", "exact")[1]["exact"]
    assert (row["valid"], row["min_normal"] < 0.0) == (False, True)
    slender = [*CASE[:4], "--amplitude", "1.0", "--omega", "3", "--sources", "exact"]
    assert compared(capsys, *slender)[1]["exact"]["valid"] is True


SHAKEN = [*CASE[:4], "--amplitude", "0.5", "--omega", "9"]
OF_A_FRAME = ["--scene", "frame", "--columns", "2", "--load", "2"]
OF_A_SLIDE = ["--scene", "slide", "--friction", "0.2"]
FRAME = RockingFrame(width=0.5, height=1.5, columns=2, load=2.0)
STRONGER = SinePulse.in_g(0.5, omega=9.0, half_cycles=2)


def test_a_slide_is_compared(capsys):
    code, rows = compared(capsys, "--width", 1, "--height", 0.5, *OF_A_SLIDE, *CASE[4:])
    assert (code, {*rows}) == (0, {"exact", "pybullet", "mujoco"})
    exact = rows["exact"]["slips"]
    for row in rows.values():
        off = max(abs(a - b) for a, b in zip(row["slips"], exact, strict=True))
        assert row["error"] == pytest.approx(off / max(map(abs, exact)), rel=1e-12)
        assert row["error"] < 1e-3 and row["kappa"] is None
    code, rows = compared(capsys, *SHAKEN, *OF_A_SLIDE, "--sources", "exact", "pymunk")
    exact, found = rows.values()
    box = SlidingBlock(width=0.5, height=1.5, friction=0.2)
    assert (code, exact["slips"]) == (0, list(simulate(box, STRONGER).slips))
    assert exact["outcome"] == found["outcome"] == "slid"
    # a step of 1e-4 s gives up g mu dt^2 of a slip, where it starts and where it stops
    assert found["slips"] == pytest.approx(exact["slips"], abs=1e-4)
    assert found["message"] == "as pymunk:tuned"


def test_a_base_that_moves_vertically_is_compared(capsys):
    code, rows = compared(capsys, *CASE, "--vertical-amplitude", 0.3, "--vertical-omega", 11)
    assert (code, [*rows]) == (0, ["exact", "pybullet", "mujoco"])
    assert max(abs(row["error"]) for row in rows.values()) < 1e-2


def test_a_frame_is_compared(capsys):
    asked = [*SHAKEN, *OF_A_FRAME, "--duration", 1.5, "--sources", "exact", "mujoco"]
    code, rows = compared(capsys, *asked)
    exact, found = rows.values()
    assert (code, found["outcome"], abs(found["error"]) < 2e-5) == (0, "rocked", True)
    right = simulate(FRAME, STRONGER, duration=1.5).peak_ratio
    assert exact["peak_ratio"] == pytest.approx(right, rel=1e-12)
    assert max(found["peak_1"], found["peak_2"]) == found["peak_ratio"]
    assert found["parting"] < 1e-6 and {"tilt", "drift_m"} <= {*found}
    assert found["kappa"] == exact["kappa"] > 0.0


@pytest.mark.slow
def test_a_frame_is_followed_as_long_by_every_command():
    """Columns part by 0.4 of alpha: DART's in the motion, Box2D's when their peak is over."""
    frame = RockingFrame(width=0.5, height=1.5, columns=3, load=2.0)
    sources = ["exact", "dart:tuned", "box2d:tuned"]
    case = Question(system=frame, motion=STRONGER)
    asked = [Job(labels={"scene": "frame"}, case=case, source=name) for name in sources]
    compared = side_by_side(frame, STRONGER, sources).set_index("source")
    for job in asked:
        row, alone = measure(job), summary(respond(job.source, frame, STRONGER))
        others = alone, compared.loc[job.source]
        assert row["outcome"] == others[0]["outcome"] == others[1]["outcome"]
        peaks = [other["peak_ratio"] for other in others]
        assert peaks == pytest.approx([row["peak_ratio"]] * 2, rel=1e-12, nan_ok=True)
        assert (row["reason"] == "PARTED") == (job.source == "dart:tuned")


def test_a_floor_that_lags_has_a_column_of_its_own(capsys):
    asked = [*SHAKEN, "--sources", "exact", "rapier:default", "pybullet:default"]
    code, rows = compared(capsys, *asked)
    assert code == 0
    lags = [rows[f"{engine}:default"]["floor_lag_m"] for engine in ("pybullet", "rapier")]
    assert lags[0] > 1e-3 > lags[1] > 0.0


def test_an_engine_is_asked_with_the_friction_and_the_step_that_are_given(capsys):
    own = ["--friction", "0.8", "--dt", "0.002"]
    code, rows = compared(capsys, *CASE, *own, "--sources", "exact", "mujoco:default", "rk4")
    assert (code, rows["exact"]["message"]) == (0, "")
    given = {"step": 0.002 * BLOCK.p, "duration": WINDOW}
    for name, options in (("mujoco:default", {**given, "friction": 0.8}), ("rk4", given)):
        answer = respond(name, BLOCK, PULSE, **options)
        assert (rows[name]["peak_ratio"], rows[name]["steps"]) == (answer.peak_ratio, answer.steps)
    other = respond("mujoco:default", BLOCK, PULSE, **given)
    assert other.peak_ratio != rows["mujoco:default"]["peak_ratio"]


@pytest.mark.parametrize(("part", "slides"), [(0.5, True), (1.1, False)])
def test_the_exact_row_says_where_friction_is_too_low_for_it(part, slides, capsys):
    given = ["--friction", str(part * NEEDED), "--sources", "exact", "pymunk:tuned"]
    code, rows = compared(capsys, *CASE, *given)
    assert (f"{NEEDED:.3g}" in rows["exact"]["message"]) == slides
    assert ("slid" in rows["pymunk:tuned"]["message"]) == slides
    assert code == int(slides)


def test_estimates_are_of_half_the_step_where_asked_for(capsys):
    asked = [*CASE, "--sources", "exact", "mujoco:tuned", "--dt", "0.001", "--estimate"]
    rows = compared(capsys, *asked)[1]
    assert rows["exact"]["estimate"] is None is rows["exact"]["bound"]
    engine, step = rows["mujoco:tuned"], 0.5e-3 * BLOCK.p
    finer = respond("mujoco:tuned", BLOCK, PULSE, duration=WINDOW, step=step).peak_ratio
    assert engine["estimate"] == abs(engine["peak_ratio"] / finer - 1.0) > 0.0
    assert engine["bound"] == published_trust("mujoco:tuned").factor * engine["estimate"]
    found = side_by_side(BLOCK, PULSE, ["mujoco:tuned"], dt=0.001, estimate=True).iloc[0]
    assert [found["estimate"], found["bound"]] == [engine["estimate"], engine["bound"]]


def test_side_by_side_is_what_compare_tells(capsys):
    names = ["exact", "housner", "mujoco:tuned"]
    _, rows = compared(capsys, *CASE, "--friction", "0.8", "--sources", *names)
    kept = side_by_side(BLOCK, PULSE, (name for name in names), friction=0.8)
    assert list(kept["source"]) == names
    assert list(kept.columns) == list(rows["exact"])
    for row in kept.drop(columns="wall_s").to_dict("records"):
        for name, value in row.items():
            finite = not isinstance(value, float) or math.isfinite(value)
            assert rows[row["source"]][name] == (value if finite else None)
    assert kept.set_index("source").loc["housner", "peak_ratio"] == math.inf


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"sources": []}, r"sources is \[\]; it must be a list of one name or more"),
        ({"sources": ["exat"]}, "source is 'exat', perhaps 'exact'; it must be one of exact"),
        ({"sources": ["mujoco"], "dt": 0.002}, "^dt is 0.002; its steps must be equal"),
        ({"sources": ["mujoco"], "friction": math.nan}, "friction is nan; it must be a finite"),
        ({"sources": ["exact"], "start": (0.1, 0.0, 0.0)}, "^start is .* must be theta"),
    ],
)
def test_side_by_side_refuses_what_cannot_be(options, problem):
    with pytest.raises(ValueError, match=problem):
        side_by_side(BLOCK, PULSE, **options)


def test_the_guide_s_python_runs_as_a_script_of_one_s_own_and_reads_a_table(tmp_path):
    """It has no guard by which other processes could be started from it."""
    guide = (ROOT / "studies/GUIDE.md").read_text()
    code, reads = re.findall(r"^```python\n(.*?)^```$", guide, flags=re.DOTALL | re.MULTILINE)
    script = tmp_path / "mine.py"
    script.write_text(code + "print(table['peak_ratio'].tolist())\n")
    done = python(script)
    assert done.returncode == 0, done.stderr
    (line,) = done.stdout.splitlines()
    exact, engine = json.loads(line)
    assert exact == pytest.approx(simulate(BLOCK, PULSE).peak_ratio, rel=1e-12)
    assert 0.0 < engine < 1.0
    exec(reads.replace("studies/published", PUBLISHED.as_posix()), known := {})
    assert "studies" not in re.findall(r"(?:from|import) (\w+)", reads)
    assert known["summary"]["cases"].max() == 960
    assert set(known["meaning"].index) == set(known["summary"].columns)


def test_responses_with_a_history_are_a_picture_of_as_many_lines():
    exact, engine = [studies.respond(n, BLOCK, PULSE, history=True) for n in ("exact", "mujoco")]
    assert exact.history.time.size == 1001 and engine.history.time.size > 900
    assert len(studies.plot(exact).axes[0].lines) == 1
    drawing = studies.plot([exact, engine])
    assert len(drawing.axes[0].lines) == 2
    assert drawing._repr_png_().startswith(b"\x89PNG")
    for given in (studies.respond("exact", BLOCK, PULSE), []):
        with pytest.raises(ValueError, match=r"response 1 has no history|responses is empty"):
            studies.plot(given)


@pytest.mark.parametrize("number", [4, pytest.param(6, marks=pytest.mark.slow)])
def test_figures_of_the_paper_are_pictures(number):
    assert studies.figure(number)._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="figure is 3"):
        studies.figure(3)
