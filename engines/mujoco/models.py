"""MuJoCo's models, each used for one run after another on the same block: most runs are as short.

A run sets the contact, gravity and the step, and these arrays alone (`EDITED`); they are put back,
and the data reset, before the next.
"""

from collections import OrderedDict
from typing import Any, NamedTuple

from engines.parts.compiled import FloatArray

EDITED = (
    "pair_solref",
    "pair_solreffriction",
    "pair_margin",
    "geom_solref",
    "geom_surfacevel",
)
"""What a run edits of a model, beside two of its options; releases before 3.11 lack the last."""

MOST_IDLE = 8
"""Models kept for later runs."""


class Built(NamedTuple):
    """A model, its data, and what the model was like when it was new."""

    xml: str
    model: Any
    data: Any
    new: tuple[Any, ...]


idle: "OrderedDict[str, Built]" = OrderedDict()
"""Models of this process whose run has ended, by what they were made of."""


def edited(model: Any) -> list[FloatArray]:
    """Return what a run may edit of a model."""
    return [getattr(model, name) for name in EDITED if hasattr(model, name)]


def taken(mj: Any, xml: str) -> Built:
    """Return a model in the library's own language that no run uses, as good as new.

    Parameters
    ----------
    mj : module, mujoco
    xml : str, the model, by which one that is idle is known again

    Raises
    ------
    ValueError
        If the library cannot read the model.
    """
    if xml in idle:
        return idle.pop(xml)
    model = mj.MjModel.from_xml_string(xml)
    new = tuple(array.copy() for array in edited(model))
    return Built(xml, model, mj.MjData(model), (*new, model.opt.gravity.copy(), model.opt.timestep))


def given_back(mj: Any, built: Built) -> None:
    """Make a model as it was, and keep it for a later run.

    Parameters
    ----------
    mj : module, mujoco
    built : Built, from `taken`; its run has ended
    """
    *arrays, gravity, timestep = built.new
    for array, new in zip(edited(built.model), arrays, strict=True):
        array[:] = new
    built.model.opt.gravity[:], built.model.opt.timestep = gravity, timestep
    mj.mj_resetData(built.model, built.data)
    idle[built.xml] = built
    if len(idle) > MOST_IDLE:
        idle.popitem(last=False)
