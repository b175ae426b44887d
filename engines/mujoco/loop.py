"""MuJoCo's steps taken by a compiled loop over its public `mj_step`, on the memory of its objects.

The library's Python objects know their addresses, and its introspection knows what stands where.
Both are compared with what Python reads before they are used; where they disagree, Python steps.
"""

import ctypes
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import llvmlite.binding
import numpy as np
from numba import types
from numpy.typing import NDArray

from engines.mujoco.contact import Arrays, ContactState, Forces, notice, prepare, read
from engines.run.look import Lists, Run, next_step, undecided
from engines.world import FloatArray

mj_step: Any = types.ExternalFunction("mj_step", types.void(types.intp, types.intp))

C_TYPES: Mapping[str, Any] = {
    **{"int": ctypes.c_int, "mjtBool": ctypes.c_bool, "mjtNum": ctypes.c_double},
    **{"mjtSize": ctypes.c_int64, "uint64_t": ctypes.c_uint64},
    **dict.fromkeys(("size_t", "uintptr_t"), ctypes.c_size_t),
}
"""The library's names of plain C types."""


class Memory(NamedTuple):
    """Addresses of a model and its data, and arrays that share the memory of what they name."""

    model: int
    data: int
    timestep: FloatArray
    contacts: NDArray[np.int32]
    rows: NDArray[np.int32]
    resistance: NDArray[np.int64]
    force: NDArray[np.int64]
    base: int
    arena: FloatArray


def drive(
    holds: Sequence[ContactState],
    arrays: Arrays,
    memory: Memory,
    runs: Sequence[Run],
    lists: Lists,
    most: int,
) -> int:
    """Take up to so many steps while the run goes on; return how many; with 0 read the state."""
    held = holds[0]
    read(held, arrays)
    for taken in range(most):
        step = next_step(runs, lists, arrays.state)
        prepare(held, arrays, step)
        memory.timestep[0] = step.dt_s
        mj_step(memory.model, memory.data)
        notice(held, arrays, forces_in(memory), step)
        read(held, arrays)
        if not undecided(runs, lists, arrays.state):
            return taken + 1
    return most


def forces_in(memory: Memory) -> Forces:
    """Return what the solver says of the last step."""
    rows = memory.rows[0]
    r = (memory.resistance[0] - memory.base) // 8
    f = (memory.force[0] - memory.base) // 8
    return Forces(memory.contacts[0], rows, memory.arena[r : r + rows], memory.arena[f : f + rows])


def memory_of(model: Any, data: Any) -> Memory:
    """Return the memory of a model and its data, which must outlive it."""
    option, inside = layout("mjOption"), layout("mjData")
    pull = model.opt.gravity.__array_interface__["data"][0]

    def word(name: str, kind: type[np.generic]) -> NDArray[Any]:
        return _shared(data._address + getattr(inside, name).offset, 1, kind)

    base = int(word("arena", np.int64)[0])
    return Memory(
        model=model._address,
        data=data._address,
        timestep=_shared(pull - option.gravity.offset + option.timestep.offset, 1, np.float64),
        contacts=word("ncon", np.int32),
        rows=word("nefc", np.int32),
        resistance=word("efc_R", np.int64),
        force=word("efc_force", np.int64),
        base=base,
        arena=_shared(base, int(word("narena", np.int64)[0]) // 8, np.float64),
    )


def _shared(address: int, count: int, kind: type[np.generic]) -> NDArray[Any]:
    memory: Any = (ctypes.c_char * (count * np.dtype(kind).itemsize)).from_address(address)
    return np.frombuffer(memory, dtype=kind)


@cache
def layout(name: str) -> Any:
    """Return one of the library's structures, by its own introspection, as ctypes lays it out."""
    declared = import_module("mujoco.introspect.structs").STRUCTS[name]
    fields = [(field.name, _c_type(field.type)) for field in declared.fields]
    return type(name, (ctypes.Structure,), {"_fields_": fields})


def _c_type(found: Any) -> Any:
    if hasattr(found, "extents"):
        kind = _c_type(found.inner_type)
        for extent in reversed(found.extents):
            kind *= extent
        return kind
    if hasattr(found, "inner_type"):
        return ctypes.c_void_p
    return C_TYPES[found.name] if found.name in C_TYPES else layout(found.name)


@cache
def usable() -> bool:
    """Return whether memory holds what Python reads, after a step of a sphere in the ground."""
    try:
        mj: Any = import_module("mujoco")
        (library,) = Path(mj.__file__).parent.glob("*mujoco.*[!y]")
        llvmlite.binding.load_library_permanently(str(library))
        model = mj.MjModel.from_xml_string(
            '<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 0.09"><freejoint/>'
            '<geom type="sphere" size="0.1"/></body></worldbody></mujoco>'
        )
        data = mj.MjData(model)
        memory = memory_of(model, data)
        memory.timestep[0] = 0.0007
        mj.mj_step(model, data)
        forces = forces_in(memory)
    except Exception:  # whatever is different about another build
        return False
    found = (model.opt.timestep, data.time, data.ncon, data.nefc, data.narena)
    rows = (data.efc_R.tolist(), data.efc_force.tolist())
    expected = (0.0007, 0.0007, forces.contacts, forces.rows, memory.arena.nbytes)
    there = (forces.resistance.tolist(), forces.force.tolist())
    return data.nefc > 0 and (found, rows) == (expected, there)
