"""Exported scenes: they run without this project, and find the peak that it finds."""

import re

import pytest
from commanding import CASE, compared, python, refused, run_scripts
from declared import run
from given import BLOCK, PULSE

from analytic import Record, RockingFrame, SinePulse, SlidingBlock
from analytic.motion import BothWays
from engines import ENGINES, Scene, installed_engines
from engines.declaration import UNTUNED, Stepping
from engines.run.export import Notes
from studies import export
from studies.__main__ import run as rocking
from studies.kit.identity import version_of
from studies.kit.store import project_version

USES = {
    name: [use.name for use in ENGINES[name].presets if use.stepping is Stepping.FIXED]
    for name in installed_engines()
    if ENGINES[name].script is not None
}
PAIRS = [(name, preset) for name, presets in USES.items() for preset in presets]
FRAME = RockingFrame(width=0.5, height=1.5, columns=3, load=2.0)
SLIDE = SlidingBlock(width=1.0, height=0.5, friction=0.2)
KINDS = {
    "block": {},
    "floor": {"preset": "default"},  # on each way to move one that carries
    "record": {"motion": Record(samples=(0.0, 3.0, 4.5, -2.0, -5.0, 1.0, 0.0), dt=0.15)},
    "lifted at once": {"motion": SinePulse(amplitude=4.5, omega=6.0, half_cycles=2, phase=1.5)},
    "released": {"start": (0.1, -0.3)},
    "both ways": {"motion": BothWays(PULSE, SinePulse.in_g(0.3, omega=11.0, half_cycles=5))},
    "frame": {"system": FRAME, "motion": SinePulse.in_g(0.35, omega=6.2832, half_cycles=2),
              "start": (-0.02, 0.0)},
    "slide": {"system": SLIDE, "motion": SinePulse.in_g(0.4, omega=6.2832, half_cycles=2),
              "start": (0.0, 0.5)},
}  # fmt: skip
LEFT_OUT = {
    ("drake", "slide", "recommended"),  # its solver gives up
    ("pymunk", "frame", "recommended"),  # its columns part
    ("rapier", "frame", "pasted"),  # so do its, of lines for one box
    ("newton", "frame", "tuned"),  # so do its, of three
    ("rapier", "lifted at once", "default-at-rest"),  # it is put to sleep aloft
    # where Dantzig's solver fails, PGS starts from what is known again by addresses
    ("dart", "frame", "tuned"),
}
QUICK = [("pybullet", "both ways"), ("mujoco", "frame"), ("pymunk", "slide"), ("pymunk", "floor")]
SLOW = [(engine, kind) for engine in USES for kind in KINDS if (engine, kind) not in QUICK]


def scene(preset, **options):
    step = {} if preset in UNTUNED else {"step": 2e-3}
    asked = {"system": BLOCK, "motion": PULSE, "preset": preset, "duration": 1.8, **step}
    return Scene(**asked | options)


def scenes_of(engine, kind):
    if kind == "floor":
        levels = ENGINES[engine].presets[0].settings.__dataclass_fields__["floor"]
        floors = set(levels.metadata["allowed"].names) - {"position"}
        return [scene("default", settings={"floor": floor}) for floor in sorted(floors)]
    presets = [preset for preset in USES[engine] if (engine, kind, preset) not in LEFT_OUT]
    asked = [scene(preset, **KINDS[kind]) for preset in presets]
    return [each for each in asked if not (each.heaves and ENGINES[engine].use(each).lacking)]


def write(folder, engine, asked, expected):
    folder.mkdir(exist_ok=True)
    for name, text in export.files(ENGINES[engine].use(asked), expected, expected).items():
        (folder / name).write_text(text)
    return folder / "block.py"


@pytest.mark.parametrize(
    ("engine", "kind"), [*QUICK, *(pytest.param(*each, marks=pytest.mark.slow) for each in SLOW)]
)
def test_exported_scenes_find_alone_what_the_runs_do(engine, kind, tmp_path):
    scripts, expected = [], []
    for number, asked in enumerate(scenes_of(engine, kind)):
        response = run(engine, asked)
        found = response.slips if kind == "slide" else response.peak_ratio
        each = found if kind == "slide" else (found,)
        assert max(map(abs, each)) > 0.01 and response.reason is None
        scripts.append(write(tmp_path / f"{number}", engine, asked, found))
        expected.append(" ".join(f"{it:.12g}{' m' * (kind == 'slide')}" for it in each))
    done = run_scripts(ENGINES[engine].library, *scripts)
    assert done.returncode == 0, done.stdout + done.stderr
    line = r"^slips (.*)$" if kind == "slide" else r"largest rotation (\S+); "
    assert re.findall(line, done.stdout, re.MULTILINE) == expected


def test_a_script_runs_from_any_folder_and_tells_versions_and_another_peak(tmp_path):
    asked = scene("tuned", step=5e-3)
    peak = run("pymunk", asked).peak_ratio
    script = write(tmp_path / "right", "pymunk", asked, peak)
    (tmp_path / "ground.py").write_text("raise ImportError('the ground of another folder')")
    done = python("-I", script, cwd=tmp_path)  # knows no folder of the script's
    assert done.returncode == 0, done.stdout + done.stderr
    now = version_of("pymunk")
    assert f"pymunk {now}, written with {now}" in done.stdout
    assert f"`rocking export` of rocking {project_version()}" in script.read_text()
    other = write(tmp_path / "other", "pymunk", asked, peak * (1.0 + 1e-8))
    assert run_scripts("pymunk", other).returncode == 1


@pytest.mark.parametrize(("engine", "preset"), PAIRS)
def test_settings_stand_in_the_files_letter_by_letter(engine, preset):
    use = ENGINES[engine].use(scene(preset))
    script = use.engine.script(use.scene, use.settings, use.dt_s)
    whole = "\n".join((*script.build, *script.step, *script.files.values()))
    whole = whole.replace("DT", repr(use.dt_s))
    assert script.settings and [line for line in script.settings if line not in whole] == []
    assert any(repr(float(use.settings.friction)) in line for line in script.settings)


@pytest.mark.parametrize(
    ("source", "options", "expected", "held"),
    [
        ("pymunk:tuned", "--p-dt 5e-4", "0.3", ""),
        ("pymunk:tuned", "--p-dt 5e-4 --scene frame --load 2", "0.2056", ""),
        ("pymunk:tuned", "--p-dt 5e-4 --scene slide --friction 0.2", "-0.1258", ""),
        ("pymunk:recommended", "--p-dt 5e-4", "0.3", ""),
        ("mujoco:default", "--friction 0.8 --dt 0.002", "", 'DT = 0.002 |friction="0.8 '),
    ],
)
def test_the_command_writes_what_runs_and_does_not_write_over_it(
    source, options, expected, held, tmp_path, capsys
):
    row = compared(capsys, *CASE, *options.split(), "--sources", source)[1][source]
    place = ["--engine", source.removesuffix(":tuned"), "--out", str(tmp_path / "scene")]
    assert rocking(["export", *CASE, *options.split(), *place]) == 0
    told = re.search(r"to expect: (\S+)", capsys.readouterr().out)[1]
    assert told.startswith(expected)
    found = row["slips"][0] if "slide" in options else row["peak_ratio"]
    assert float(told) == pytest.approx(found, rel=1e-11)
    files = "".join(path.read_text() for path in (tmp_path / "scene").iterdir())
    assert all(words in files for words in held.split("|"))
    engine = source.partition(":")[0]
    assert run_scripts(engine, tmp_path / "scene/block.py").returncode == 0
    asked = ["export", *CASE, *options.split(), *place]
    refused(capsys, asked, "it must be a new or an empty folder")


def test_what_no_call_made_cannot_be_written_down():
    pymunk = pytest.importorskip("pymunk")
    notes = Notes()
    space = notes.of(pymunk, "pymunk").Space()
    with pytest.raises(TypeError, match="no value that can be written down"):
        space.add(pymunk.Body(1.0, 1.0))
    with pytest.raises(TypeError, match="was not made by a call"):
        notes.name(own=space.static_body)


def test_a_file_that_cannot_be_written_leaves_no_part_of_a_script(tmp_path, monkeypatch):
    monkeypatch.setattr(export, "files", lambda *_: {"block.py": "1", "ground.py": "\ud800"})
    with pytest.raises(UnicodeEncodeError):
        rocking(["export", *CASE, "--engine", "pymunk", "--out", str(tmp_path / "scene")])
    assert list((tmp_path / "scene").iterdir()) == []
