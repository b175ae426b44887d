"""Whatever is asked: usable, or refused at once in a line that says what is allowed."""

import json
import os
import shlex
import time

import numpy as np
import pandas as pd
import pytest
from commanding import BLOCK, CASE, PULSE, refused
from records import AT2

from analytic.response import Response
from studies.__main__ import run
from studies.kit.arguments import EffortOptions
from studies.sources.registry import SOURCES, Source

REFUSED = """
# numbers of each kind, and words of a few
compare --width 0 --height 1.5 PULSE | --width is '0'; it must be a positive finite number
compare --width inf --height 1.5 PULSE | --width is 'inf' | finite
compare --width 0.5 --height nan PULSE | --height is 'nan' | finite
compare CASE --friction -1 | --friction is '-1'; it must be a finite number, 0 or more
compare CASE --friction 1_0 | --friction is '1_0' | 0 or more
compare CASE --tilt nan | --tilt is 'nan' | finite
compare CASE --rate 1e-400 | --rate is '1e-400'; it must be a finite number, 0, or at least
compare CASE --tilt 0,5 | --tilt is '0,5'; it must be a finite number, with a decimal point
blocks comma.csv --record X.AT2 --out DIR | height is 'x'; it must be from
compare CASE --jobs 0 | --jobs is '0' | positive whole number
compare CASE --half-cycles 1.5 | --half-cycles is '1.5' | whole
compare CASE --dt 0 --sources rk4 | --dt is '0'; it must be a positive
compare BLOCK --amplitude 1e308 --omega 6.2832 | --amplitude | inf | finite
compare CASE --pulse quarter | --pulse is 'quarter' | half-sine
compare CASE --accuracy none | --accuracy is 'none' | tight
sweep --figure 6.5 --out DIR | --figure is '6.5' | 6, 7, 8, 9
sweep --figure 6 6 --out DIR | --figure names 6 twice | once
histories --figure 3 --out DIR | --figure is '3' | 2, 4, 5
sweep --time-limit 1e150 --out DIR | --time-limit is '1e150' | up to 1e9
blocks list.csv --record X.AT2 --scale 2 2 --out DIR | --scale names 2.0 twice
blocks list.csv --record X.AT2 --scale --out DIR | --scale

# slips of a unit
compare --width 300 --height 1.5 PULSE | --width is 300; it must be at most 200
export --width 0.5 --height 200.001 PULSE --out DIR --engine dart | --height is 200.001; it must be
animate --width 200.001 --height 1.5 PULSE --out film.gif | at most 200, in metres
advise --width 0.5 --height 300 | --height is 300; it must be at most 200

# who is asked
compare CASE --sources mujoco:best | --sources | 'mujoco:best' | default
compare CASE --sources mujoco:tunde | 'mujoco:tunde', perhaps 'mujoco:tuned'; it must be one of
compare CASE --sources mujoco:fixed | 'mujoco:fixed', now 'mujoco:tuned'
compare CASE --sources engines:naive | now 'pybullet:default'
export CASE --out DIR --engine pybullet:naive | its preset must have equal steps: default
compare CASE --sources my_engine:World | ROCKING_ENGINES='mine=my_engine:World'
compare CASE --sources mujuco | 'mujuco', perhaps 'mujoco'; it must be one of exact
compare CASE --sources MuJoCo:tuned | 'MuJoCo:tuned', perhaps 'mujoco'
compare CASE --sources hausner:tuned | source is 'hausner:tuned', perhaps 'housner'
compare CASE --sources exact:tuned | 'exact:tuned'; it must be 'exact'
compare CASE --sources exact --p-dt 0.1 | --p-dt is 0.1 | a solver or an engine
compare CASE --sources mujoco:tuned --accuracy tight | --accuracy is tight | chooses its steps
contact --out DIR --engines mujuco | --engines is 'mujuco', perhaps 'mujoco'
export CASE --out DIR --engine mujuco:tuned | perhaps 'mujoco'
score mujuco --out DIR | ENGINE is 'mujuco', perhaps 'mujoco'
contact --out DIR --sources exact | --sources is no option of contact; it takes --out, --engines
compare CASE --sources exact exact | --sources names 'exact' twice | once
compare CASE --sources | --sources is empty | housner
compare CASE --hight 2 | --hight | --height
weep | weep | sweep
--version x | --version | alone

# what happens to a block
compare CASE --duration 0.5 | --duration is 0.5 | 0.999998 s
compare CASE --rate 1e-300 | --rate is 1e-300; it must be 0, or of a size 1e-150 to
compare CASE --phase 1e17 | --phase is 1e+17; it must be from -1e+06 to 1e+06
compare CASE --tilt -4.9 | --tilt is -4.9 | between -4.88
compare BLOCK --tilt -1 | --tilt is -1 | balances
compare BLOCK --tilt 1 --omega 3 | --amplitude missing | requires
compare BLOCK --tilt 0 | --amplitude and --omega missing | --tilt
compare --height 1.5 PULSE | --width missing | requires
compare BLOCK --record X.AT2 --omega 3 | --omega is 3; it may be given only without --record
compare BLOCK --record X.AT2 --scale 2 --pga 1 | --scale is 2 and --pga is 1; give one or the other
compare BLOCK --record X.AT2 --scale 1e308 | --record times --scale 1e+308 | finite
compare BLOCK --record X.AT2 --pga 1e308 | --record scaled to --pga 1e+308 | finite
compare BLOCK --record X.AT2 --units ft | --units is 'ft'
compare BLOCK --record X.AT2 --duration 0.01 | length of the motion, 0.03 s
compare BLOCK --record /nowhere/at.all | --record is | a file that can be read (No such file
compare BLOCK --record /dev/null | --record is | a file that can be read (it is a folder, a pipe
compare BLOCK --record . | --record is | a file that can be read (it is a folder, a pipe
compare BLOCK --record PIPE | --record is | a file that can be read (it is a folder, a pipe
compare CASE --baseline none | only with --record
compare CASE --vertical-omega 9 | --vertical-amplitude missing | requires both
compare CASE --vertical X.AT2 --vertical-omega 9 | --vertical-omega is 9; it may be given only
compare CASE --vertical X.AT2 --sources exact rk4 | rk4 takes no vertical motion; exact and
compare CASE --vertical-amplitude -1 --vertical-omega 9 | --vertical falls to -9.81 m/s2; it must
export CASE --out DIR --engine mujoco --record x | it may be given only without --record
blocks list.csv --record X.AT2 ./X.AT2 --out DIR | --record names 'X.AT2' twice
blocks list.csv --record list.csv --out DIR | --record is 'list.csv'
blocks list.csv --record X.AT2 --vertical X.AT2 still.csv --out DIR | --vertical names 2; it must
compare BLOCK --record X.AT2 --units m/s2 | it states g; --units must not be m/s2
blocks list.csv --record still.csv --units g --out DIR | it is zero throughout, and must not be
blocks list.csv --out DIR | --record requires an argument

# a reader's own friction and step
compare CASE --dt 0.002 | --dt is 0.002; | pybullet takes steps that land on impacts
compare CASE --dt 0.002 --sources exact | --dt is 0.002; it may be | names a solver or an engine
compare CASE --friction 1 --sources rk4 | --friction is 1; it may be | names at least one engine
compare CASE --friction 99 --sources pybullet | friction is 99.0; it must be from 0 to
compare CASE --dt 1e-12 --sources rk4 | --dt is 1e-12; it must be at least 3.6
compare CASE --dt 0.01 --p-dt 0.1 --sources rk4 | --dt is 0.01 and --p-dt is 0.1; give one or the
advise --engine pybullet --friction 99 | friction is 99.0; it must be from 0

# other scenes, exported or shown
export BLOCK --amplitude 0.1 --omega 6.2832 --out DIR --engine mujoco | stays at rest
export CASE --out DIR --engine bullet | --engine is 'bullet', perhaps 'pybullet'; it must be
export CASE --out DIR --engine mujoco:landing | its preset must have equal steps: default, default
export CASE --out DIR --engine mujoco --scene frame --load 2 --columns 1 | columns is 1; it must be
compare CASE --scene frame --load 2 --columns 100000 | columns is 100000; it must be a whole number
animate CASE --out film.gif --scene frame | --load missing
export CASE --out DIR --engine mujoco --scene slide | --friction missing
export CASE --out DIR --engine mujoco --scene slide --friction 0.4 | it must be below width/height
animate CASE --out film.gif --scene slide --friction 0.2 --tilt 0.1 | only where something rocks
compare CASE --load 2 | --load is 2; it may be given only with --scene frame
compare CASE --scene slide --friction 0 | --friction is 0
compare CASE --scene slide --friction 0.2 --plot x.png | only where something rocks
compare CASE --scene slide --friction 0.2 --sources dop853 | 'dop853' cannot be asked so
compare CASE --scene bridge | --scene is 'bridge'; it must be among block, frame, slide

# what else a study asks
overturning --out DIR --sources rk4 | --sources | 'rk4' | engines
overturning --out DIR --sources exact --aspect 1e4 | --aspect is 10000 | 0.1 to 100
contact --out DIR --engines mujoco mujoco | twice
contact --out DIR --scene frames | --scene | frames | block
contact --out DIR --scene frame --engines moreau | --scene | moreau
scenes --out DIR --sources housner | housner
advise --error 0 | --error is '0'; it must be a positive finite number
advise --error 0.1 0.1 | --error names 0.1 twice
advise --engine havok | --engines is 'havok'; it must be among
advise --engine mujoco --quick | --quick is True; it may be given only with --out
contact --out DIR --quickly | --quickly
restitution --out DIR --engines moreau | moreau | pybullet, mujoco
restitution --out DIR --engines drake | drake | no coefficient
restitution --out DIR --quick | --quick
validate --out DIR --halves --sources exact | 'exact'; with --halves it must be an engine
validate --out DIR --halves --sources drake | steps that can be halved
validate --out DIR --sources exact --p-dt 0.1 | only if --sources names a solver or an engine
validate --out DIR --scene slide | among block, frame
validate --out DIR --seed -1 | --seed is '-1'

# where the results go
compare CASE --plot a.txt | --plot is 'a.txt' | .png
compare CASE --plot /nowhere/a.png | --plot is '/nowhere/a.png' | written
sweep --out /dev/null/results | --out is '/dev/null/results' | folder
sweep --out ' ' | --out is empty | given
sweep --out list.csv | --out is | folder
sweep --out /proc/x | --out is '/proc/x'
sweep --out LONG | --out is 'x | File name too long
report --out LONG | --out is 'x | File name too long
readme --root . | --root
report --out /dev/null | --out is '/dev/null' | folder
animate CASE --out film.avi | --out | .gif
animate CASE --out nowhere/film.gif | --out | written
animate CASE --out /proc/film.gif | --out | written

# more than a computer has
compare CASE --half-cycles 1000000000 | --half-cycles is '1000000000' | memory
compare CASE --duration 1e300 | --duration is 1e+300 | at most 3.278e+05 s
compare CASE --p-dt 1e-300 | --p-dt is '1e-300' | at least 1e-07
compare CASE --duration 3e4 --p-dt 1e-6 | --p-dt is 1e-06 | 1e+09 steps
compare CASE --duration 3e4 --dt 1e-6 --sources rk4 | at least 3e-05 for a run of 3e+04 s
compare BLOCK --amplitude 0.4 --omega 1e-140 | --width is 0.5 | 1/p
export BLOCK --engine mujoco --out DIR --amplitude 0.4 --omega 1e-9 | --width is 0.5 | at most
"""
"""A command line, and parts of the line with which it is refused."""

ROWS = [line.split(" | ") for line in REFUSED.splitlines() if line and not line.startswith("#")]
MEANT = {"BLOCK": BLOCK, "PULSE": PULSE, "CASE": CASE, "LONG": [256 * "x"]}


def words_of(line):
    return [meant for word in shlex.split(line) for meant in MEANT.get(word, [word])]


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "list.csv").write_text("name,width,height\nA,0.5,1.5\n")
    (tmp_path / "X.AT2").write_text(AT2["series"])
    (tmp_path / "comma.csv").write_text("name;width;height\nA;0,5;x\n")
    os.mkfifo("PIPE")  # who waits for it waits for ever
    (tmp_path / "still.csv").write_text("time_s,acceleration\n0,0\n0.1,0\n0.2,0\n")
    return tmp_path


@pytest.mark.parametrize("row", ROWS, ids=[line for line, *_ in ROWS])
def test_what_cannot_be_asked_is_one_line_at_once(row, place, capsys):
    line, *parts = row
    before, begin = sorted(place.iterdir()), time.process_time()
    assert "Path" not in refused(capsys, words_of(line), *parts)
    assert time.process_time() - begin < 2.0
    assert sorted(place.iterdir()) == before


@pytest.mark.parametrize("name", ["thesis.tex", ".hidden", "sweep", "report.html", "kind.txt"])
def test_a_report_is_not_written_among_what_is_not_its_own(name, tmp_path, capsys):
    (tmp_path / name).write_bytes(b"\xff\xfe")  # no known kind of a report
    refused(capsys, ["report", "--out", tmp_path], "--out is", *[repr(name)] * (name[0] != "k"))
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_failed_row_is_named_and_the_exit_code_is_1(monkeypatch, capsys, tmp_path):
    def never(block, motion, *, duration, times):
        return Response.failure("it never converged")

    monkeypatch.setitem(SOURCES, "never", Source("model", never))
    assert run(["compare", *CASE, "--sources", "exact", "never", "--json"]) == 1
    output = capsys.readouterr()
    assert output.err.splitlines() == ["failed: never: it never converged"]
    assert json.loads(output.out.splitlines()[1])["peak_ratio"] is None
    monkeypatch.setitem(SOURCES, "neither", Source("model", never))
    asked = ["--figure", "6", "7", "--sources", "never", "neither", "--jobs", "2"]
    assert run(["sweep", *asked, "--out", str(tmp_path / "made" / "here")]) == 1
    errors = capsys.readouterr().err.splitlines()
    assert "figure 6, aspect 2, width_m 0.5, omega_over_p 0.1" in errors[0]
    assert (len(errors), errors[-1]) == (11, "failed: 950 more")
    table = pd.read_csv(tmp_path / "made" / "here" / "sweep.csv", keep_default_na=False)
    assert not table.duplicated(["figure", "aspect", "width_m", "omega_over_p", "source"]).any()
    assert table.groupby(["figure", "source"]).size().tolist() == [240] * 4
    told = table[["outcome", "peak_ratio", "message"]].drop_duplicates().to_numpy().tolist()
    assert told == [["failed", "nan", "it never converged"]]


BY_NUMBERS = [
    *(ZeroDivisionError("float division"), OverflowError(34, "too large"), FloatingPointError()),
    *(MemoryError(), np.linalg.LinAlgError("singular"), ValueError("math domain error")),
    ValueError("samples[3] is inf; it must be a finite number"),
]
BY_MISTAKE = [TypeError("x"), KeyError("x"), AttributeError("x"), ValueError("shapes differ")]


@pytest.mark.parametrize("error", [*BY_NUMBERS, *BY_MISTAKE], ids=repr)
def test_what_arithmetic_raises_is_one_line_and_what_a_mistake_does_is_not(
    error, monkeypatch, capsys
):
    def broken(*_, **__):
        raise error

    monkeypatch.setattr("studies.compare.compare", broken)
    line = ["compare", *CASE, "--sources", "exact"]
    if error in BY_MISTAKE:
        with pytest.raises(type(error)):
            run(line)
    else:
        refused(capsys, line, str(error) or type(error).__name__)


def test_accuracy_and_step_reach_only_the_sources_they_are_for():
    effort = EffortOptions(p_dt=1e-3, accuracy="tight")
    assert effort.options("exact") == {}
    assert effort.options("rk4") == {"step": 1e-3}
    assert effort.options("pybullet:tuned") == {"step": 1e-3}
    assert effort.options("mujoco") == {"step": 1e-3, "accuracy": "tight"}
