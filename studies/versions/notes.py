"""What release notes say of what may move a rocking block, kept by hand."""

from collections.abc import Mapping
from typing import NamedTuple

from studies.versions.releases import Release


class Note(NamedTuple):
    """A note of a release: what it says in short, and where it stands."""

    release: str
    text: str
    link: str


MUJOCO = "https://mujoco.readthedocs.io/en/{}/changelog.html"
MUJOCO_RELEASE = "https://github.com/google-deepmind/mujoco/releases/tag/{}"
PYMUNK = "https://github.com/viblo/pymunk/blob/master/CHANGELOG.rst"
DART = "https://github.com/dartsim/dart/releases/tag/v{}"

NOTES: Mapping[str, tuple[Note, ...]] = {
    "mujoco": (
        Note(
            "3.11.0",
            "free bodies are no longer integrated by the midpoint rule",
            MUJOCO.format("3.11.0"),
        ),
        Note(
            "4.0.1",
            "mends the sparse Cholesky factor of 4.0.0, with which the Newton solver had a wrong "
            "Hessian",
            MUJOCO_RELEASE.format("4.0.1"),
        ),
    ),
    "pymunk": (
        Note("6.5.0", "takes in the latest Chipmunk", PYMUNK),
        Note("6.8.0", "a newer fork of Chipmunk, with a number of issues fixed", PYMUNK),
        Note("7.0.0", "Chipmunk is replaced by its fork Munk2D", PYMUNK),
    ),
    "dart": (
        Note(
            "6.17.0",
            "contact normals of FCL are stabilized, finite solutions of the Dantzig solver kept",
            DART.format("6.17.0"),
        ),
        Note("6.19.0", "bodies at rest are put to sleep", DART.format("6.19.0")),
        Note(
            "6.20.0",
            "FCL, the default detector, collides exact primitive shapes; more bodies at rest sleep",
            DART.format("6.20.0"),
        ),
        Note(
            "6.20.0",
            "DARTCollisionDetector, that of our other presets, has a new engine",
            "https://github.com/dartsim/dart/pull/3381",
        ),
    ),
}
"""Engine -> notes on its releases, in their order."""


def notes_between(before: Release, after: Release) -> list[Note]:
    """Return the notes on the releases after one, up to another."""
    return [
        note
        for note in NOTES.get(after.engine, ())
        if before.order < Release(after.engine, note.release).order <= after.order
    ]
