"""550 cubes tossed on a board: engines' worlds for them, and how far they are off."""
# The tosses are those of github.com/DAIRLab/contact-nets (BSD-3), cleaned by Acosta et al. (2022);
# nothing of them is kept here. Velocities at the start are fitted to the flight, as there.

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile, ZipFile

import numpy as np
import pandas as pd

from analytic.block import GRAVITY, RigidBlock
from analytic.motion import SinePulse
from analytic.response import Outcome
from engines import ENGINES, installed_engines
from engines.world import FloatArray
from studies.cases.refusal import BadInputError
from studies.kit.jobs import Job, Question, Row
from studies.kit.say import one_line
from studies.kit.study import Figures, Tables
from studies.kit.tables import packed, unpacked

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

CLEANED = "the folder of the cleaned cube tosses (branch contact_model_verification of dairlib)"
HALF, MASS, INERTIA, FRICTION = 0.0524, 0.37, 0.00081, 0.18
"""Half the edge of the cube [m], its mass [kg], moment of inertia [kg m2] and friction."""
HZ, SUBSTEPS, BEFORE = 148.0, 10, 3
"""Frames a second; steps a frame; frames before the first possible contact that are watched."""
COLUMNS = 19
"""Numbers of a frame: place in half edges, quaternion w x y z, velocities in the cube's axes."""
LOSS, PLACE, ANGLE, FACE = range(4)
"""What is found of a toss: loss, mean distance [m], mean angle [rad], whether the face is right."""


@cache
def read_tosses(folder: Path) -> tuple[FloatArray, ...]:
    """Return the tosses of a folder, in the order of their numbers: 13 numbers a frame, in m."""
    paths = sorted(folder.glob("*.pt"), key=lambda path: (len(path.stem), path.stem))
    if not paths:
        raise BadInputError(f"--cubes is {str(folder)!r}; it must name {CLEANED}")
    return tuple(map(_read_toss, paths))


def _read_toss(path: Path) -> FloatArray:
    try:
        with ZipFile(path) as archive:
            (name,) = (name for name in archive.namelist() if "/data/" in name)
            frames = np.frombuffer(archive.read(name)).reshape(-1, COLUMNS)[:, :13].copy()
        frames[:, [0, 1, 2, 7, 8, 9]] *= HALF
        first = max(0, int(np.argmax(frames[:, 2] <= HALF * np.sqrt(3.0))) - BEFORE)
        if not np.isfinite(frames).all() or len(frames) < first + 2:
            raise ValueError
    except (OSError, ValueError, BadZipFile) as error:
        raise BadInputError(f"{str(path)!r} is no toss; --cubes must name {CLEANED}") from error
    if first > BEFORE:  # it flew: a line along the board, a parabola upwards, a steady turn
        times = np.arange(first) / HZ
        along = (frames[first - 1, :2] - frames[0, :2]) / times[-1]
        rise = np.polyfit(times, frames[:first, 2] + 0.5 * GRAVITY * times**2, 1)[0]
        turns = turned(frames[[0, first]])
        frames[first, 7:10] = *along, rise - GRAVITY * times[-1]
        frames[first, 10:13] = (turns[0].inv() * turns[1]).as_rotvec() * HZ / first
    return frames[first:]


def turned(frames: FloatArray) -> Rotation:
    """Return the rotations of frames."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(frames[..., [4, 5, 6, 3]])


def off(found: FloatArray, toss: FloatArray) -> list[float]:
    """Return the loss of a motion, its mean distance and angle, and whether the face is right."""
    apart = ((found[:, :3] - toss[:, :3]) ** 2).sum(axis=1)
    mine, its = turned(found), turned(toss)
    angles = (its.inv() * mine).magnitude()
    up = [turns[-1].inv().apply([0.0, 0.0, 1.0]) for turns in (mine, its)]
    same = float(np.abs(up[0]).argmax() == np.abs(up[1]).argmax() and up[0] @ up[1] > 0.0)
    loss = (apart / HALF + angles**2).mean()
    return [float(loss), float(np.sqrt(apart).mean()), float(angles.mean()), same]


World = Callable[[FloatArray], FloatArray]
"""Takes a toss, and returns the motion of a cube that starts as it does."""


def in_mujoco(asked: Mapping[str, Any]) -> World:
    """Return MuJoCo's world: a box on a box."""
    import mujoco

    contact = f'friction="{asked["friction"]}"'
    if asked["stiffness"]:
        contact += f' solref="-{asked["stiffness"]} -{asked["damping"]}"'
    sizes = f"{HALF} {HALF} {HALF}"
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option timestep="{1.0 / HZ / SUBSTEPS}" cone="{asked["cone"]}">
        <flag refsafe="disable"/></option>
        <default><geom {contact}/></default>
        <worldbody><geom type="box" pos="0 0 -0.2" size="5 5 0.2"/><body><freejoint/>
        <inertial pos="0 0 0" mass="{MASS}" diaginertia="{INERTIA} {INERTIA} {INERTIA}"/>
        <geom type="box" size="{sizes}"/></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)

    def world(toss: FloatArray) -> FloatArray:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = toss[0, :7], toss[0, 7:]
        found = np.empty((len(toss), 7))
        for frame in found:
            frame[:] = data.qpos
            mujoco.mj_step(model, data, SUBSTEPS)
        return found

    return world


@cache
def _client() -> int:
    """Return a client of PyBullet for cubes alone."""
    import pybullet

    return int(pybullet.connect(pybullet.DIRECT))


def in_pybullet(asked: Mapping[str, Any]) -> World:
    """Return PyBullet's world: a box on a box, whose contact the board alone has."""
    import pybullet as p

    own = {"physicsClientId": _client()}  # the runs of blocks have theirs
    p.resetSimulation(**own)
    p.setGravity(0.0, 0.0, -GRAVITY, **own)
    p.setTimeStep(1.0 / HZ / SUBSTEPS, **own)
    sides = ([2.5, 2.5, 0.5], 3 * [HALF])
    shapes = [p.createCollisionShape(p.GEOM_BOX, halfExtents=each, **own) for each in sides]
    board = p.createMultiBody(0.0, shapes[0], basePosition=[0.0, 0.0, -0.5], **own)
    cube = p.createMultiBody(MASS, shapes[1], **own)
    p.changeDynamics(cube, -1, localInertiaDiagonal=3 * [INERTIA], **own)
    other = p.getDynamicsInfo(cube, -1, **own)[1]  # of both friction is the product
    p.changeDynamics(board, -1, lateralFriction=asked["friction"] / other, **own)
    if asked["stiffness"]:
        contact = {"contactStiffness": asked["stiffness"], "contactDamping": asked["damping"]}
        p.changeDynamics(board, -1, **contact, **own)

    def world(toss: FloatArray) -> FloatArray:
        start, turn = toss[0], turned(toss[0])
        p.resetBasePositionAndOrientation(cube, start[:3].tolist(), turn.as_quat().tolist(), **own)
        p.resetBaseVelocity(cube, start[7:10].tolist(), turn.apply(start[10:13]).tolist(), **own)
        found = np.empty((len(toss), 7))
        for frame in found:
            frame[:3], turn = p.getBasePositionAndOrientation(cube, **own)
            frame[3:] = np.roll(turn, 1)
            for _ in range(SUBSTEPS):
                p.stepSimulation(**own)
        return found

    return world


WORLDS = {"mujoco": in_mujoco, "pybullet": in_pybullet}
AUTHORS = {
    "mujoco": (3294.162195453933, 45.1052410182306, 0.2180675752744882, "pyramidal"),
    "pybullet": (1783.7652890360182, 27.221707506471567, 0.1790210332261291, ""),
}
"""Stiffness, damping, friction and cone of Acosta et al. (2022), mujoco_2022_02_23_15_29_10 and
bullet_2022_02_22_00_36_10; PyBullet's friction is that of the board times 0.5. Their log of
PyBullet says a loss of 0.271898, which this world gives with the inertia of a solid box: their
loader takes that for the one of the file."""
DRAWN, SEED = 32, 0
RANGES = np.log([(300.0, 20.0, 0.1), (30_000.0, 300.0, 0.4)])
"""Settings that are tried: so many, from and to these (Sobol points in their logarithms)."""
SETTINGS = ("stiffness", "damping", "friction", "cone")
MEANS: tuple[str, ...] = ("tosses", "loss", "loss_low", "loss_high", "place_mm", "angle_deg")
MEANS += ("face", "face_low", "face_high", "loss_of_all")
DEFAULT, FITTED, CONE = "default", "fitted", "authors, elliptic cone"


def jobs(sources: Sequence[str], folder: Path) -> list[Job]:
    """Return a job for each engine and settings."""
    from scipy.stats.qmc import Sobol

    here = [name for name in WORLDS if name in installed_engines()]
    engines = [name for name in sources if name != "exact"] or here
    if other := set(engines) - set(WORLDS):
        raise BadInputError(f"--sources is {sorted(other)[0]!r}; it may be {' or '.join(WORLDS)}")
    read_tosses(folder)
    points = np.exp(RANGES[0] + Sobol(3, rng=SEED).random(DRAWN) * np.diff(RANGES, axis=0))
    cube = RigidBlock(width=2.0 * HALF, height=2.0 * HALF)
    case = Question(system=cube, motion=SinePulse(amplitude=0.0, omega=1.0, half_cycles=1))
    found = []
    for engine in engines:
        *authors, cone = AUTHORS[engine]
        best = cone and "elliptic"
        asked: dict[str, list[Any]] = {
            DEFAULT: [0.0, 0.0, FRICTION, cone],
            "authors": [*authors, cone],
        }
        if cone:
            asked[CONE] = [*authors, best]
        asked |= {f"{FITTED} {n}": [*map(float, it), best] for n, it in enumerate(points)}
        for name, numbers in asked.items():
            labels = {"folder": str(folder), "engine": engine, "settings": name}
            labels |= dict(zip(SETTINGS, numbers, strict=True))
            found.append(Job(labels=labels, case=case, source=f"{engine}:default"))
    return found


def measure(job: Job) -> Row:
    """Return what an engine makes of every toss with some settings, as text to the bit."""
    if job.lost is not None:
        return {"outcome": Outcome.FAILED.value, "message": job.lost.message}
    try:
        world = WORLDS[job.labels["engine"]](job.labels)
        tosses = read_tosses(Path(job.labels["folder"]))
        found = np.array([off(world(toss), toss) for toss in tosses])
    except Exception as error:
        return {"outcome": Outcome.FAILED.value, "message": one_line(error)}
    return {"outcome": "measured", "message": "", "found": packed(found)}


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return how far each engine and settings are off, in the tosses that no fit here has seen."""
    # fitted are those drawn settings that lose least in the other half
    lines = []
    for engine, mine in rows[rows["outcome"] == "measured"].groupby("engine", sort=False):
        found = {row["settings"]: (row, unpacked(row["found"]).reshape(-1, 4))
                 for row in mine.to_dict("records")}  # fmt: skip
        drawn = {name: each for name, each in found.items() if name.startswith(FITTED)}
        kept = {name: each for name, each in found.items() if name not in drawn}
        if drawn:
            kept[FITTED] = min(drawn.values(), key=lambda each: each[1][::2, LOSS].mean())
        for name, (row, every) in kept.items():
            line = {"engine": engine, "settings": name, **{key: row[key] for key in SETTINGS}}
            lines.append(line | told(every[1::2]) | {"loss_of_all": every[:, LOSS].mean()})
    columns = ["engine", "settings", *SETTINGS, *MEANS]
    return {"settings": pd.DataFrame(lines, columns=columns)}


def told(found: FloatArray) -> Row:
    """Return the means of what is found of tosses, two of them within 95 %."""
    from scipy.stats import binomtest

    tosses, faces = len(found), int(found[:, FACE].sum())
    half = 1.96 * found[:, LOSS].std(ddof=1) / math.sqrt(tosses)
    loss, place, angle, face = found.mean(axis=0)
    low, high = binomtest(faces, tosses).proportion_ci(method="wilson")
    return {
        **{"tosses": tosses, "loss": loss, "loss_low": loss - half, "loss_high": loss + half},
        **{"place_mm": 1e3 * place, "angle_deg": math.degrees(angle)},
        **{"face": face, "face_low": low, "face_high": high},
    }


def finding(tables: Tables) -> str:
    """Say how often each engine ends on the right face."""
    lines = tables["settings"].set_index(["engine", "settings"])
    if lines.empty:
        return "No engine gave a result."
    faces = (100.0 * lines["face"]).map("{:.0f} %".format).unstack(sort=False)
    faces = faces.reindex(columns=[DEFAULT, FITTED]).fillna("no result")
    said = [
        f"{ENGINES[str(engine)].title} {line[DEFAULT]} and {line[FITTED]}"
        for engine, line in faces.iterrows()
    ]
    return (
        "With default contact, and with contact fitted to other tosses, engines predict the final"
        f" face of {lines['tosses'].max()} tosses of a cube: {', '.join(said)}."
    )


def shown(tables: Tables) -> Tables:
    """Return the only table."""
    return {
        "Loss (mean square distance over half an edge, plus mean square angle), mean distance and "
        "angle, part of the tosses that end on the right face; the settings fitted here have not "
        "seen these tosses, those of the authors have": tables["settings"]
    }


def figures(tables: Tables) -> Figures:
    """Draw the losses and the shares of right faces."""
    from studies.drawing.experiments import draw_cubes

    return {"cubes": draw_cubes(tables["settings"])}
