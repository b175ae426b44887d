"""Exported scenes: they run without this project, and find the peak that it finds."""

import math
import re
import resource
import subprocess
import sys
from dataclasses import replace

import commanding
import pytest
from commanding import CASE, refused, run_scripts
from declared import run
from given import BLOCK, PULSE

from analytic import RockingFrame, SinePulse, SlidingBlock
from analytic.record import Record
from analytic.response import Reason
from engines import ENGINES, Scene, installed_engines
from engines.declaration import UNTUNED, Stepping
from studies.__main__ import run as rocking
from studies.export import files, script_of, unwritten
from studies.kit.identity import version_of
from studies.kit.store import project_version

USES = {
    name: [use.name for use in ENGINES[name].presets if use.stepping is Stepping.FIXED]
    for name in installed_engines()
    if ENGINES[name].script is not None
}
PAIRS = [(name, preset) for name, presets in USES.items() for preset in presets]
STARTS = {
    "record": (Record(samples=(0.0, 3.0, 4.5, -2.0, -5.0, 1.0, 0.0), dt=0.15), (0.0, 0.0)),
    "lifted at once": (SinePulse(amplitude=4.5, omega=6.0, half_cycles=2, phase=1.5), (0.0, 0.0)),
    "released": (PULSE, (0.1, -0.3)),
}
BEYOND = {
    "frame": (RockingFrame(width=0.5, height=1.5, columns=3, load=2.0), 0.35, (-0.02, 0.0)),
    "slide": (SlidingBlock(width=1.0, height=0.5, friction=0.2), 0.4, (0.0, 0.5)),
}
"""What stands on the base, the pulse [g], and how it begins."""
FAULTS = {("drake", "slide")}  # as recommended, whose solver gives up
# where Dantzig's solver fails, PGS starts from what is known again by addresses
TREMBLES = ("dart", "frame", "fixed")
QUICK = [("mujoco", "block"), ("mujoco", "frame"), ("pymunk", "slide"), ("pymunk", "floor")]
KINDS = [
    *QUICK,
    *(
        pytest.param(engine, kind, marks=pytest.mark.slow)
        for engine in USES
        for kind in ("block", "floor", *STARTS, *BEYOND)
        if (engine, kind) not in QUICK
    ),
]


def scene(motion, preset, system=BLOCK, **options):
    if preset not in UNTUNED:
        options = {"step": 2e-3, **options}
    return Scene(system=system, motion=motion, preset=preset, duration=1.8, **options)


def scenes_of(engine, kind):
    """Return what is exported of a kind: with each preset, or on each floor that carries."""
    presets = USES[engine]
    if kind == "block":
        return [scene(PULSE, preset) for preset in presets]
    if kind in STARTS:
        motion, start = STARTS[kind]
        return [scene(motion, preset, start=start) for preset in presets]
    if kind == "floor":
        levels = ENGINES[engine].presets[0].settings.__dataclass_fields__["floor"]
        floors = [floor for floor in levels.metadata["allowed"].names if floor != "position"]
        return [scene(PULSE, "naive", settings={"floor": floor}) for floor in floors]
    system, amplitude_g, start = BEYOND[kind]
    pulse = SinePulse.in_g(amplitude_g, omega=6.2832, half_cycles=2)
    chosen = [preset for preset in presets if (engine, kind, preset) != TREMBLES]
    return [scene(pulse, preset, system=system, start=start) for preset in chosen]


def write(folder, engine, asked, expected):
    folder.mkdir(exist_ok=True)
    for name, text in files(ENGINES[engine], asked, expected, expected).items():
        (folder / name).write_text(text)
    return folder / "block.py"


@pytest.mark.parametrize(("engine", "kind"), KINDS)
def test_exported_scenes_find_alone_what_the_runs_do(engine, kind, tmp_path):
    scripts, expected, declared = [], [], ENGINES[engine]
    for number, asked in enumerate(scenes_of(engine, kind)):
        if unwritten(declared, declared.use(asked).preset, asked):
            assert (engine, kind) == ("newton", "frame")
            continue
        response = run(engine, asked)
        if response.reason:
            assert response.reason is Reason.FAULT and (engine, kind) in FAULTS
            continue
        found = response.slips if kind == "slide" else response.peak_ratio
        each = found if kind == "slide" else (found,)
        assert max(map(abs, each)) > 0.01 and (math.inf not in each or asked.system is BLOCK)
        scripts.append(write(tmp_path / f"{number}", engine, asked, found))
        expected.append(" ".join(f"{it:.12g}{' m' * (kind == 'slide')}" for it in each))
    done = run_scripts(declared.library, *scripts)
    assert done.returncode == 0, done.stdout + done.stderr
    line = r"^slips (.*)$" if kind == "slide" else r"largest rotation (\S+); "
    assert re.findall(line, done.stdout, re.MULTILINE) == expected


@pytest.mark.parametrize(
    "engine",
    [pytest.param(each, marks=[] if each == "pymunk" else pytest.mark.slow) for each in USES],
)
def test_a_script_runs_from_any_folder_and_tells_versions_and_another_peak(engine, tmp_path):
    asked = scene(PULSE, "fixed", step=5e-3)
    peak = run(engine, asked).peak_ratio
    script = write(tmp_path / "right", engine, asked, peak)
    (tmp_path / "ground.py").write_text("raise ImportError('the ground of another folder')")
    # as a reader starts it, and in Python's isolated mode, which knows no folder of the script's
    for options in ([], ["-I"]):
        command = [sys.executable, *options, str(script)]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
        for package in ENGINES[engine].packages:
            now = version_of(package)
            assert f"{package} {now}, written with {now}" in done.stdout
    assert f"`rocking export` of rocking {project_version()}" in script.read_text()
    other = write(tmp_path / "other", engine, asked, peak * (1.0 + 1e-8))
    assert run_scripts(ENGINES[engine].library, other).returncode == 1


@pytest.mark.parametrize(("engine", "preset"), PAIRS)
def test_settings_stand_in_the_files_letter_by_letter(engine, preset):
    asked, declared = scene(PULSE, preset), ENGINES[engine]
    script = script_of(declared, asked)
    whole = "\n".join((*script.build, *script.step, *script.files.values()))
    whole = whole.replace("DT", repr(declared.use(replace(asked, preset=preset)).dt_s))
    assert script.settings and [line for line in script.settings if line not in whole] == []
    friction = repr(float(declared.preset(preset).settings.friction))
    assert any(friction in line for line in script.settings)
    with pytest.raises(ValueError, match="writes no scripts"):
        script_of(replace(declared, script=None), asked)


def test_the_preset_is_an_option_or_stands_after_a_colon(tmp_path, capsys):
    texts = []
    for asked in (["mujoco:naive"], ["mujoco", "--preset", "naive"]):
        out = tmp_path / str(len(asked))
        assert rocking(["export", *CASE, "--engine", *asked, "--out", str(out)]) == 0
        texts.append([(out / name).read_text() for name in ("block.py", "block.xml")])
        assert "preset: " not in capsys.readouterr().out
    assert texts[0] == texts[1]


FRAME, SLIDE = ["--scene", "frame", "--load", "2"], ["--scene", "slide", "--friction", "0.2"]


@pytest.mark.parametrize(
    ("options", "expected"), [([], "0.3"), (FRAME, "0.2056"), (SLIDE, "-0.1258")]
)
def test_the_command_writes_what_runs_and_does_not_write_over_it(
    options, expected, tmp_path, capsys
):
    out = ["--engine", "pymunk", "--step", "5e-4", "--out", str(tmp_path / "scene")]
    assert rocking(["export", *CASE, *options, *out]) == 0
    output = capsys.readouterr().out
    assert f"to expect: {expected}" in output and "preset: fixed" in output
    assert ("pymunk:landing" in output) == (options is not SLIDE)  # what compare would ask
    assert run_scripts("pymunk", tmp_path / "scene/block.py").returncode == 0
    refused(capsys, ["export", *CASE, *options, *out], "it must be a new or an empty folder")


def test_what_stays_at_rest_is_refused(tmp_path, capsys):
    still = ["export", *commanding.BLOCK, "--amplitude", "0.1", "--omega", "6.2832"]
    out = tmp_path / "scene"
    refused(capsys, [*still, "--engine", "pymunk", "--out", out], "and stays at rest")
    assert not out.exists()


def test_no_room_for_a_file_leaves_no_part_of_a_script(tmp_path, capsys):
    """A ground motion that is too long for the disk; the folder may then be asked for again."""
    rows = (f"{0.005 * i:.3f},{0.4 * math.sin(0.03 * i)}" for i in range(1200))
    record = tmp_path / "record.csv"
    record.write_text("\n".join(["time_s,acceleration_g", *rows, "6,0"]))
    asked = ["export", *commanding.BLOCK, "--record", str(record), "--engine", "mujoco", "--out"]
    assert rocking([*asked, str(tmp_path / "before")]) == 0  # whatever compiles is kept by now
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (32_000, hard))
    try:
        capsys.readouterr()
        refused(capsys, [*asked, tmp_path / "scene"], "File too large")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert list((tmp_path / "scene").iterdir()) == []
    assert rocking([*asked, str(tmp_path / "scene")]) == 0


def test_what_an_engine_cannot_hold_is_one_line(tmp_path, capsys):
    out = ["--engine", "newton", "--out", str(tmp_path / "scene")]
    assert rocking(["export", *CASE, *FRAME, *out]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("failed: newton:fixed: not available: ")
    assert "several bodies on one base" in line and not (tmp_path / "scene").exists()
