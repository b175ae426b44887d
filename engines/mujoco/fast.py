"""MuJoCo stepped from a compiled loop: the library's own C function, on the memory of its objects.

The library's Python objects know their addresses, and its introspection knows what stands where.
Both are held against what Python reads before they are used; where they disagree, or the library
cannot be found, runs are stepped from Python.
"""

import ctypes
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from engines.mujoco.contact import notice, prepare, read
from engines.mujoco.contact_state import Arrays, ContactState, Forces
from engines.parts.compiled import (
    SWITCHED_OFF,
    CFunction,
    FloatArray,
    interpreted,
    kernel,
    shared,
    switched_off,
)
from engines.run.monitor import Lists, Run, onward, undecided

mj_step = CFunction("mj_step", "void", "intp", "intp")

C_TYPES: Mapping[str, Any] = {
    "int": ctypes.c_int,
    "mjtBool": ctypes.c_bool,
    "mjtNum": ctypes.c_double,
    "mjtSize": ctypes.c_int64,
    "size_t": ctypes.c_size_t,
    "uint64_t": ctypes.c_uint64,
    "uintptr_t": ctypes.c_size_t,
}
"""The library's names of plain C types."""

PROBE = """<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 0.09"><freejoint/>
<geom type="sphere" size="0.1"/></body></worldbody></mujoco>"""


class Memory(NamedTuple):
    """Where the library keeps what Python would ask it for, as arrays that share its memory.

    Attributes
    ----------
    model, data : int
        Addresses of both.
    timestep : array (1,)
        The step [s].
    contacts, rows : array (1,)
        Numbers of contacts, and of rows of the solver.
    resistance, force : array (1,)
        Where the arena holds R and the force of each row: addresses.
    base : int
        The address at which the arena begins.
    arena : array
        It, as numbers.
    """

    model: int
    data: int
    timestep: FloatArray
    contacts: NDArray[np.int32]
    rows: NDArray[np.int32]
    resistance: NDArray[np.int64]
    force: NDArray[np.int64]
    base: int
    arena: FloatArray


@kernel
def drive(
    holds: Sequence[ContactState],
    lent: tuple[FloatArray, ...],
    memory: Memory,
    runs: Sequence[Run],
    lists: Lists,
    most: int,
) -> int:
    """Take up to so many steps while the run goes on; return how many were taken.

    Parameters
    ----------
    holds : sequence of ContactState (1,), updated
    lent : tuple of ndarray, in the order of `Arrays`, written
    memory : Memory, of the same model and data
    runs, lists
        As for `engines.run.monitor.onward`, updated.
    most : int, how many; with 0 the state is read, and nothing is taken
    """
    held, arrays = holds[0], Arrays(*lent)
    read(held, arrays)
    for taken in range(most):
        step = onward(runs, lists, arrays.state)
        prepare(held, arrays, step)
        memory.timestep[0] = step.dt_s
        mj_step(memory.model, memory.data)
        notice(held, arrays, forces_in(memory), step)
        read(held, arrays)
        if not undecided(runs, lists, arrays.state):
            return taken + 1
    return most


@shared
def forces_in(memory: Memory) -> Forces:
    """Return what the solver says of the last step."""
    rows = memory.rows[0]
    first_r = (memory.resistance[0] - memory.base) // 8
    first_f = (memory.force[0] - memory.base) // 8
    return Forces(
        memory.contacts[0],
        rows,
        memory.arena[first_r : first_r + rows],
        memory.arena[first_f : first_f + rows],
    )


def memory_of(model: Any, data: Any) -> Memory | None:
    """Return the memory of a model and its data; None where it is not what it should be.

    Parameters
    ----------
    model, data : MjModel, MjData
        They must outlive what is returned, which has no memory of its own.
    """
    return None if interpreted() or obstacle() else _memory(model, data)


@cache
def obstacle() -> str:
    """Say why the library's function or memory cannot be used from compiled code, if so."""
    if switched_off():
        return SWITCHED_OFF
    try:
        import llvmlite.binding

        mj: Any = import_module("mujoco")
        (library,) = Path(mj.__file__).parent.glob("*mujoco.*[!y]")
        llvmlite.binding.load_library_permanently(str(library))
        if llvmlite.binding.address_of_symbol("mj_step") is None:
            return "the library has no mj_step"
        model = mj.MjModel.from_xml_string(PROBE)
        data = mj.MjData(model)
        memory = _memory(model, data)
        agrees = all(_agrees(mj, model, data, memory, dt) for dt in (0.002, 0.0007))
    except Exception as error:  # whatever is different about another build
        return f"the library is another build ({type(error).__name__})"
    return "" if agrees else "its memory is not what Python reads"


def _agrees(mj: Any, model: Any, data: Any, memory: Memory, dt: float) -> bool:
    """Take a step, and return whether Python reads of it what stands in memory."""
    memory.timestep[0] = dt
    before = data.time
    mj.mj_step(model, data)
    forces = forces_in(memory)
    pairs = (
        (model.opt.timestep, dt),
        (data.time, before + dt),
        (data.ncon, forces.contacts),
        (data.nefc, forces.rows),
        (data.narena, memory.arena.nbytes),
    )
    arrays = ((data.efc_R, forces.resistance), (data.efc_force, forces.force))
    return (
        data.nefc > 0
        and all(found == read for found, read in pairs)
        and all(np.array_equal(found, read) for found, read in arrays)
    )


def _memory(model: Any, data: Any) -> Memory:
    option, inside = layout("mjOption"), layout("mjData")
    pull = model.opt.gravity.__array_interface__["data"][0]
    at = data._address

    def word(name: str, kind: type[np.generic]) -> NDArray[Any]:
        return _shared(at + getattr(inside, name).offset, 1, kind)

    base = int(word("arena", np.int64)[0])
    return Memory(
        model=model._address,
        data=at,
        timestep=_shared(pull - option.gravity.offset + option.timestep.offset, 1, np.float64),
        contacts=word("ncon", np.int32),
        rows=word("nefc", np.int32),
        resistance=word("efc_R", np.int64),
        force=word("efc_force", np.int64),
        base=base,
        arena=_shared(base, int(word("narena", np.int64)[0]) // 8, np.float64),
    )


def _shared(address: int, count: int, kind: type[np.generic]) -> NDArray[Any]:
    size = count * np.dtype(kind).itemsize
    memory: Any = (ctypes.c_char * size).from_address(address)
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
