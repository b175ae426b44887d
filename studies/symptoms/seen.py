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
        What measures it, by its size; the smaller the better.
    threads : tuple of str
        Threads of trackers in which it is asked.
    study : str
        Which has measured it.
    """

    name: str
    column: str = "max_error"
    threads: tuple[str, ...]
    study: str = "contact"


MEASURED = (
    Symptom(name="it tips too early or too late", threads=("bullet3 #1485",)),
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

UNMOVED = Symptom(name="a moved base carries nothing", threads=("bullet3 #1204",))
HULL = Symptom(name="a hull behaves unlike a box", threads=("bullet3 #4341",))
STEP = Symptom(
    name="the step changes the answer",
    threads=("mujoco #1240", "mujoco #954"),
    study="precision",
)
BOUNCE = Symptom(
    name="a coefficient of restitution does nothing, or too much",
    column="off_over_all",
    threads=("bullet3 #3094", "bullet3 #1530", "mujoco #2080", "mujoco #1124"),
    study="restitution",
)

SYMPTOMS = (*MEASURED, UNMOVED, HULL, STEP, BOUNCE)
"""All of them; the last four are measured by two settings that are held against each other."""
