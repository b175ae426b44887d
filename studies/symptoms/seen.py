"""What users of engines see and ask, and the column of a table that measures it."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Symptom:
    """Something that a user sees.

    Attributes
    ----------
    name : str
        In a user's words.
    column : str
        Of variants.csv: what measures it, by its size; the smaller the better.
    threads : tuple of str
        Threads of trackers in which it is asked.
    """

    name: str
    column: str
    threads: tuple[str, ...]


SYMPTOMS = (
    Symptom(
        name="it tips too early or too late",
        column="max_error",
        threads=("bullet3 #1485",),
    ),
    Symptom(
        name="it bounces, or loses nothing, at an impact without restitution",
        column="newton_e",
        threads=("mujoco #2080", "mujoco #1124", "bullet3 #3094", "newton #1137"),
    ),
    Symptom(
        name="it creeps",
        column="slip_widths",
        threads=("bullet3 #3049", "mujoco #2638"),
    ),
    Symptom(name="it sinks into the base", column="sink_widths", threads=("bullet3 #4428",)),
    Symptom(
        name="it gains energy in free rocking",
        column="energy_growth",
        threads=("bullet3 #1530", "rapier #934"),
    ),
)
"""What is measured of every way to set an engine."""

UNMOVED = "a moved base carries nothing"
HULL = "a hull behaves unlike a box"
STEP = "the step changes the answer"
BOUNCE = "a coefficient of restitution does nothing, or too much"

THREADS = {
    UNMOVED: ("bullet3 #1204",),
    HULL: ("bullet3 #4341",),
    STEP: ("mujoco #1240", "mujoco #954"),
    BOUNCE: ("bullet3 #3094", "bullet3 #1530", "mujoco #2080", "mujoco #1124"),
}
"""What is measured by two settings that are held against each other."""

STUDIES = {STEP: "precision", BOUNCE: "restitution"}
"""What another study than that of contacts has measured."""
