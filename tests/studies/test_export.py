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
from given import BLOCK, PULSE

from analytic import RockingFrame, SinePulse, SlidingBlock
from analytic.record import Record
from analytic.response import Reason
from engines import ENGINES, Scene, installed_engines
from engines.declaration import UNTUNED, Stepping
from engines.run.drive import run
from studies.__main__ import run as rocking
from studies.export.study import Exported, files, script_of, unwritten
from studies.old.provenance import project_version, version_of
from studies.scenes.cases import ways

RECORD = Record(samples=(0.0, 3.0, 4.5, -2.0, -5.0, 1.0, 0.0), dt=0.15)
WINDOW = 1.8

USES = [
    (name, use.name)
    for name in installed_engines()
    if ENGINES[name].script is not None
    for use in ENGINES[name].presets
    if use.stepping is Stepping.FIXED
]
WRITING = list(dict.fromkeys(name for name, _ in USES))
FIRST = [(name, dict(reversed(USES))[name]) for name in WRITING]
"""A preset of each engine."""
ONE_EACH = [pytest.param(*use, marks=[] if use in FIRST else pytest.mark.slow) for use in USES]
"""Each preset, quickly where it is the first, for what depends on the engine alone."""


def scene(motion, preset, system=BLOCK, **options):
    return Scene(system=system, motion=motion, preset=preset, duration=WINDOW, **options)


def written(folder, engine, what, expected):
    exported = Exported(
        engine=ENGINES[engine],
        preset=ENGINES[engine].preset(what.preset),
        scene=what,
        watched_s=WINDOW,
        expected=expected,
        exact=expected,
    )
    for name, text in files(exported).items():
        (folder / name).write_text(text)


def run_alone(engine, *folders):
    scripts = [folder / "block.py" for folder in folders]
    return run_scripts(ENGINES[engine].library, *scripts)


COSINE = SinePulse(amplitude=4.5, omega=6.0, half_cycles=2, phase=1.5)
"""It lifts the block at once."""

SCENES = {
    "pulse": (PULSE, (0.0, 0.0)),
    "record": (RECORD, (0.0, 0.0)),
    "lifted at once": (COSINE, (0.0, 0.0)),
    "released": (PULSE, (0.1, -0.3)),
}

BEYOND = {
    "frame": (RockingFrame(width=0.5, height=1.5, columns=3, load=2.0), 0.35, (-0.02, 0.0)),
    "slide": (SlidingBlock(width=1.0, height=0.5, friction=0.2), 0.4, (0.0, 0.5)),
}
"""What stands on the base, the pulse [g], and how it begins."""
NO_ANSWER = {
    ("drake", "slide"): Reason.FAULT,  # as recommended, whose solver gives up
}
TREMBLING = "frame of DART's tuned contact"
# where Dantzig's solver fails, PGS starts from what is known again by addresses
DIFFERS = "DART's forces on a frame depend on where in memory it is: dart_addresses.py"
KINDS = [
    *((engine, kind) for engine in WRITING for kind in ("block", "floor")),
    *(("mujoco", kind) for kind in BEYOND),
    *(
        pytest.param(engine, kind, marks=pytest.mark.slow)
        for engine in WRITING
        for kind in ("other starts", *BEYOND)
        if engine != "mujoco" or kind not in BEYOND
    ),
    pytest.param("dart", TREMBLING, marks=pytest.mark.xfail(reason=DIFFERS, strict=False)),
]


def stepped(preset, motion, **options):
    step = {} if preset in UNTUNED else {"step": 2e-3}
    return scene(motion, preset, **step, **options)


def scenes_of(engine, kind):
    """Return what is exported of a kind.

    A pulse with each preset, and all starts with the first; the first on each floor that carries;
    a frame or a slide with each preset.
    """
    presets = [preset for name, preset in USES if name == engine]
    if kind in ("block", "other starts"):
        first = {(presets[0], name) for name in SCENES} | {(preset, "pulse") for preset in presets}
        return [
            stepped(preset, motion, start=start)
            for preset in presets
            for name, (motion, start) in SCENES.items()
            if ((preset, name) in first) == (kind == "block")
        ]
    if kind == "floor":
        floors = ways(ENGINES[engine].presets[0].settings)
        carrying = [floor for floor in floors if floor != "position"]
        return [scene(PULSE, "naive", settings={"floor": floor}) for floor in carrying]
    system, amplitude_g, start = BEYOND["slide" if kind == "slide" else "frame"]
    pulse = SinePulse.in_g(amplitude_g, omega=6.2832, half_cycles=2)
    if kind == TREMBLING:
        presets = ["fixed"]
    elif (engine, kind) == ("dart", "frame"):
        presets.remove("fixed")
    return [stepped(preset, pulse, system=system, start=start) for preset in presets]


@pytest.mark.parametrize(("engine", "kind"), KINDS)
def test_exported_scenes_find_alone_what_the_runs_do(engine, kind, tmp_path):
    folders, expected = [], []
    for number, asked in enumerate(scenes_of(engine, kind)):
        declared = ENGINES[engine]
        if unwritten(declared, declared.used_for(asked), asked):
            assert (engine, kind) == ("newton", "frame")
            continue
        row = run(engine, asked)
        if row.reason:
            assert NO_ANSWER[engine, kind] is row.reason
            continue
        found = row.slips if kind == "slide" else (row.peak_ratio,)
        largest = max(map(abs, found))
        assert largest > 0.01 and (largest < math.inf or asked.system is BLOCK)
        folders.append(tmp_path / f"{number}")
        folders[-1].mkdir()
        written(folders[-1], engine, asked, found if kind == "slide" else row.peak_ratio)
        unit = " m" if kind == "slide" else ""
        expected.append(" ".join(f"{each:.12g}{unit}" for each in found))
    done = run_alone(engine, *folders)
    assert done.returncode == 0, done.stdout + done.stderr
    said = r"^slips (.*)$" if kind == "slide" else r"largest rotation (\S+); "
    assert re.findall(said, done.stdout, re.MULTILINE) == expected


@pytest.mark.parametrize(("engine", "preset"), ONE_EACH)
def test_a_script_runs_from_any_folder_and_says_the_versions(engine, preset, tmp_path):
    asked = scene(PULSE, preset, **({} if preset in UNTUNED else {"step": 5e-3}))
    written(tmp_path, engine, asked, run(engine, asked).peak_ratio)
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "ground.py").write_text("raise ImportError('the ground of another folder')")
    (elsewhere / "block.xml").write_text("no model")
    # as a reader starts it, and in Python's isolated mode, which knows no folder of the script's
    for options in ([], ["-I"]):
        command = [sys.executable, *options, str(tmp_path / "block.py")]
        done = subprocess.run(command, cwd=elsewhere, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
        for package in ENGINES[engine].packages:
            now = version_of(package)
            assert f"{package} {now}, written with {now}" in done.stdout
    text = (tmp_path / "block.py").read_text()
    assert f"Written by `rocking export` of rocking {project_version()}" in text


@pytest.mark.parametrize(("engine", "preset"), USES[:1])
def test_a_script_says_when_its_peak_is_another(engine, preset, tmp_path):
    asked = scene(PULSE, preset)
    written(tmp_path, engine, asked, run(engine, asked).peak_ratio * (1.0 + 1e-8))
    done = run_alone(engine, tmp_path)
    assert done.returncode == 1
    assert "expected" in done.stdout


@pytest.mark.parametrize(("engine", "preset"), USES)
def test_settings_are_in_the_library_s_words(engine, preset):
    """What a reader would copy stands in the files, letter by letter."""
    asked = scene(PULSE, preset)
    used = ENGINES[engine].preset(preset)
    script = script_of(ENGINES[engine], used, asked)
    whole = "\n".join((*script.build, *script.step, *script.files.values()))
    whole = whole.replace("DT", repr(used.ordinary_step_s(asked)))
    assert script.settings
    assert [line for line in script.settings if line not in whole] == []
    assert any(repr(asked.friction or float(used.settings.friction)) in s for s in script.settings)


CALL = ["export", *CASE]
SIZED = ["export", *commanding.BLOCK]
SHAKEN = commanding.PULSE


def test_an_engine_takes_its_preset_after_a_colon(tmp_path, capsys):
    said = []
    for name, out in (("mujoco:naive", "colon"), ("mujoco", "option")):
        preset = [] if ":" in name else ["--preset", "naive"]
        engine = ["--engine", name, *preset, "--out", str(tmp_path / out)]
        assert rocking([*CALL, *engine]) == 0
        said.append(capsys.readouterr().out.replace(out, ""))
    assert said[0] == said[1]
    assert (tmp_path / "colon/block.xml").read_text() == (tmp_path / "option/block.xml").read_text()


FRAME = ["--scene", "frame", "--load", "2"]


@pytest.mark.parametrize("scene", [[], FRAME])
def test_an_engine_without_a_preset_says_which_one_is_written(scene, tmp_path, capsys):
    """Elsewhere its name stands for steps that land, which no script can take."""
    engine = ["--engine", "mujoco", "--step", "0.01", "--out", str(tmp_path / "scene")]
    assert rocking([*CALL, *scene, *engine]) == 0
    told = capsys.readouterr().out
    assert "preset: fixed" in told and "mujoco:landing" in told


SLIDE = ["--scene", "slide", "--friction", "0.2"]


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ([], "largest rotation to expect: 0.3"),
        (FRAME, "largest rotation to expect: 0.2056"),
        (SLIDE, "; exact -0.125811146765 0.132109573149 m"),
    ],
)
def test_the_command_writes_files_and_refuses_to_write_over_them(options, told, tmp_path, capsys):
    out = ["--engine", "pymunk", "--step", "5e-4", "--out", str(tmp_path / "scene")]
    assert rocking([*CALL, *options, *out]) == 0
    said = capsys.readouterr().out
    assert told in said and ("slips to expect: -0.1258" in said) == (options is SLIDE)
    assert run_alone("pymunk", tmp_path / "scene").returncode == 0
    refused(capsys, [*CALL, *options, *out], "it must be a new or an empty folder")


def test_no_room_for_a_file_leaves_no_part_of_a_script(tmp_path, capsys):
    """A ground motion that is too long for the disk; the folder may then be asked for again."""
    rows = (f"{0.005 * i:.3f},{0.4 * math.sin(0.03 * i)}" for i in range(1200))
    record = tmp_path / "record.csv"
    record.write_text("\n".join(["time_s,acceleration_g", *rows, "6,0"]))
    asked = [*SIZED, "--record", str(record), "--engine", "mujoco", "--out"]
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
    arguments = [*CALL, *FRAME, "--engine", "newton", "--out", str(tmp_path / "scene")]
    assert rocking(arguments) == 1
    told = capsys.readouterr().err
    assert told.startswith("failed: newton:fixed: not available: ")
    assert "several bodies on one base" in told
    assert len(told.strip().splitlines()) == 1
    assert not (tmp_path / "scene").exists()


def test_an_engine_without_a_script_says_so():
    mute = replace(ENGINES["mujoco"], script=None)
    with pytest.raises(ValueError, match="MuJoCo writes no scripts"):
        script_of(mute, mute.preset("fixed"), scene(PULSE, "fixed"))
