"""Tests to which engines are held by their authors, where the scene has an exact answer.

Scenes and bounds were read in their repositories, at the commits named.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analytic.block import GRAVITY as G
from analytic.record import Record
from analytic.response import Response
from analytic.slide import SlidingBlock
from studies.kit.jobs import Job, ask
from studies.kit.journal import Row
from studies.literature.readings import reduce, solve_problem
from studies.sources.registry import Source, resolve

RAMP = "newton-physics/newton 00e7f285, newton/tests/test_rigid_friction_ramp.py, test_friction_"
DEMO = "gazebosim/gazebo-classic 06c21a34, test/integration/physics_friction.cc, FrictionDemo"
DROP = "dartsim/dart 24025e89, tests/integration/constraint/test_friction.cpp, FrictionPerShapeNode"
SLIDE = "Genesis-Embodied-AI/Genesis 0f006603, tests/rigid/test_friction.py, test_kinetic_friction"
LAB = (
    "isaac-sim/IsaacLab 0118ea7d, source/isaaclab_physx/test/assets/test_rigid_object.py, "
    "test_rigid_body_with_static_friction"
)
BY_NEWTON = {
    "newton:naive": {"solver": "xpbd", "iterations": 10},
    "mujoco:naive": {"cone": "elliptic", "impratio": 10.0, "iterations": 200},
}
UNDAMPED, ELLIPTIC = {"pybullet:naive": {"damping": 0.0}}, {"mujoco:naive": {"cone": "elliptic"}}
WAY, RATE = "way [m]", "rate [m/s]"


class PeerTest(NamedTuple):
    """A test of an engine: what, where it stands, its number and bounds, and what these let pass.

    held is what is asked of its scene, by source, as it is held here: without a fall at first,
    which adds `more` to the exact number. Where nothing is asked, answer is the exact number.
    `passes`, `more` and `answer` are in the unit that `quantity` names.
    """

    name: str
    work: str
    quantity: str
    passes: tuple[float, float]
    says: str
    held: Mapping[str, Mapping[str, Any]] = {}
    more: float = 0.0
    answer: float = math.nan

    def jobs(self, engines: Collection[str]) -> Iterator[Job]:
        """Yield the jobs of the exact solution, and of those engines that the test is of."""
        for source, asked in self.held.items():
            if resolve(source).engine in ("", *engines):
                labels = {"problem": self.name, "model": "exact"}
                yield Job(labels=labels, source=source, **asked)


def _slide(
    size: tuple[float, float],
    friction: float,
    times: tuple[float, float],
    step_s: float,
    settings: Mapping[str, Mapping[str, Any]],
    *,
    pull: float = 0.0,
    speed: float = 0.0,
    slope: float = 0.0,
    gravity: float = G,
) -> Mapping[str, Mapping[str, Any]]:
    """Return what is asked: pull over the mass [m/s2], rate at first [m/s], and slope [rad]."""
    weight = gravity * math.cos(slope)
    box = SlidingBlock(width=size[0], height=size[1], friction=friction, gravity=weight)
    motion = Record(dt=times[1], samples=np.full(2, pull + gravity * math.sin(slope)))
    asked = {"block": box, "motion": motion, "duration": times[1], "times": np.array(times)}
    start = {"start": (0.0, speed)}
    own = {**start, "step": box.p * step_s, "frame": "base"}
    engines = {name: {**asked, "options": {**own, "settings": s}} for name, s in settings.items()}
    return {"exact": {**asked, "options": start}, **engines}


def _stops(mu: float) -> PeerTest:
    ideal, more = 2.0**2 / (2.0 * mu * G), mu * 1e-3
    return PeerTest(
        f"Newton: a cube launched at 2 m/s, friction {mu:g}",
        f"{RAMP}stopping_distance",
        WAY,
        (0.99 * ideal, 1.01 * ideal),
        f"v²/(2 μ g) is {more / ideal:.2%} short: the cube first falls by h = 1 mm, for μ h more",
        _slide((0.5, 0.5), mu, (0.0, 1.53), 1.0 / 1800.0, BY_NEWTON, speed=2.0),
        more,
    )


PEERS = (
    *map(_stops, (0.2, 0.4, 0.7)),
    PeerTest(
        "Newton: a slab on 20 degrees, friction 0.3, from 0.5 to 0.75 s",
        f"{RAMP}ramp",
        WAY,
        (0.02, math.inf),
        "friction up to 0.350 passes; on 40 degrees, friction 0.1, up to 0.822",
        _slide((0.4, 0.1), 0.3, (0.5, 0.75), 1.0 / 1800.0, BY_NEWTON, slope=math.radians(20.0)),
    ),
    PeerTest(
        "Gazebo: a box on a slope of 45 degrees for 10 s, friction 0.998",
        DEMO,
        RATE,
        (0.019, 0.021),
        "with Bullet in single precision within 0.022, with ODE's Dantzig solver within 0.84: "
        "a box that stands still passes both",
        _slide((1.0, 0.5), 0.998, (9.99, 10.01), 1e-3, UNDAMPED, pull=1.0, gravity=1.0),
    ),
    PeerTest(
        "Genesis: a cube launched at 6 m/s for 0.2 s, friction 0.5",
        SLIDE,
        RATE,
        (6.0 - 1.01 * 0.1 * G, 6.0 - 0.99 * 0.1 * G),
        "MuJoCo's contact lifts the cube, as Genesis did (its issue 3115); with friction 2, which "
        "should tip it, no rigid cube has an answer: from 5/3 on its edge jams (Painlevé)",
        _slide((0.1, 0.1), 0.5, (0.195, 0.205), 5e-3, ELLIPTIC, speed=6.0),
    ),
    PeerTest(
        "Isaac Lab: a cube pulled for 2 s by 1.01 of a friction of 0.5",
        LAB,
        WAY,
        (0.02, math.inf),
        "friction up to 0.504 passes; pulled by 0.99 of it, held within 2 mm, from 0.495 on",
        _slide((0.0625, 0.0625), 0.5, (0.0, 2.0), 1e-2, {"physx:naive": {}}, pull=0.505 * G),
    ),
    PeerTest(
        "DART: a box falls by 0.35 m, is pulled aside by 5 m/s2, and stays",
        DROP,
        WAY,
        (0.17789, 0.17989),
        "0.17889 is the sum of 267 steps of 1 ms: it takes half of what may be off",
        answer=0.35 * 5.0 / G,
    ),
    PeerTest(
        "DART: the same without friction along a diagonal, after 0.302 s",
        DROP,
        WAY,
        (0.20381, math.inf),
        "the bound is the sum of 302 steps of 1 ms: the exact number fails",
        # along the diagonal until then, and across it until the box lands
        answer=0.25 * 5.0 * (0.302**2 + 2.0 * 0.35 / G),
    ),
)


def put(job: Job, source: Source) -> Response:
    """Put a job of this study to its source: a test's scene, which slides, or a printed problem.

    Parameters
    ----------
    job : Job
        Of `PeerTest.jobs`, or of a problem as for `solve_problem`.
    source : Source

    Returns
    -------
    Response
        Of a printed problem a `Reading`, or a failed response; nothing that a source raises is
        passed on.
    """
    return (ask if isinstance(job.block, SlidingBlock) else solve_problem)(job, source)


def read_off(job: Job, response: Response) -> Row:
    """Return the columns that follow the labels and source of a row.

    Parameters
    ----------
    job : Job
    response : Response
        From `put`.

    Returns
    -------
    dict
        As of `studies.literature.readings.reduce`. Of a test that was sampled at two times, value
        is the way [m] between them, other_side the mean rate [m/s].
    """
    row, seen = reduce(job, response), response.history
    if isinstance(job.block, SlidingBlock) and seen and len(seen.time) == 2:
        way = float(np.ptp(seen.theta))
        row |= {"value": way, "other_side": way / float(np.ptp(seen.time))}
    return row


def peers(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each test and engine: its bounds, the exact number and the engine's."""
    lines = []
    for test in PEERS:
        (low, high), part = test.passes, rows[rows["problem"] == test.name].set_index("source")
        if test.held and part.empty:
            continue
        seen = part["other_side" if test.quantity == RATE else "value"].to_dict()
        exact = seen.pop("exact", math.nan) + test.more if test.held else test.answer
        told = {"test": test.name, "quantity": test.quantity, "low": low, "high": high}
        told |= {"exact": exact, "exact_passes": str(low <= exact <= high)}
        for source, value in (seen or {"": math.nan}).items():
            passes = str(low <= value <= high) if source else ""
            found = {"source": source, "found": value, "found_passes": passes}
            lines.append({**told, **found, "says": test.says, "work": test.work})
    return pd.DataFrame(lines)
