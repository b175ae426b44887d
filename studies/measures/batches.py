"""The paper's cases as one batch of worlds in MuJoCo Warp or MJX, or one by one in MuJoCo's C."""
# All worlds take the same step on a base at rest, whose acceleration is each world's own gravity.

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from importlib import import_module
from itertools import islice
from time import perf_counter
from timeit import repeat
from typing import Any

import numpy as np
from numpy.typing import NDArray

from analytic import Motion, RigidBlock, peak_ratios
from analytic.block import GRAVITY
from analytic.response import Outcome
from engines import ENGINES
from engines.run.ground import mean_velocity_of
from engines.run.run import build
from engines.run.steps import begin_of
from engines.run.watch import LYING, LYING_PART, PROPPED_PART, REST_RATE, REST_TIME, SLIDE_WIDTHS
from engines.scene import FREE_ROCKING
from engines.world import FloatArray
from studies.cases.drawn import RandomCase, draw
from studies.cases.paper import Case, sweep_cases
from studies.kit.jobs import Job, Row
from studies.kit.say import one_line
from studies.kit.tables import packed
from studies.sources.registry import run_engine, scene_of

EXACT, C, WARP, MJX, MJX32 = "exact", "c", "warp", "mjx, float64", "mjx, float32"
NAMES = {EXACT: "the exact solution", C: "MuJoCo in C", WARP: "MuJoCo Warp"}
NAMES |= {MJX: "MJX in float64", MJX32: "MJX in float32"}
BATCHED = {WARP: ("mujoco_warp", "warp"), **dict.fromkeys((MJX, MJX32), ("mujoco.mjx", "mjx"))}
"""What steps a batch -> its module, and the extra that installs it."""
FAULTS = ("overflows", "unconverged")
MEASURED = ("name", "steps", "compile_s", "wall_s", "cases_per_s", "memory_mb", *FAULTS)
SPREAD = ("bits_differ", "outcomes_differ", "largest_spread")
PAPER, RANDOM = "paper", "random"
EVERY = {PAPER: 960, RANDOM: 500}
"""Cases of a kind."""
SMALL, LARGE, LONG = 1.8891, 3.6279, 37.494  # the paper's p, and time to 8/p after the pulse [s]
CHUNK = 200
"""Steps between two looks at whether a world is undecided."""
ROOM = {"nconmax": 8, "njmax": 32}
"""Contacts and rows of constraints for each world."""
MOST, FINEST = 20, {"mjx, float64": 0.0, "mjx, float32": 1e-6}
"""Most steps of MJX's solver and line search: a batch takes its worst world's; least tolerance."""
UNUSED = "EULERDAMP", "DAMPER", "ACTUATION"
"""Flags of what no model has: with them MJX takes accelerations from forces, wrong in float32."""
TURNED = 1e-3
"""A turn at less than this part of alpha is a tremor of the contact."""

REST, END, AMPLITUDE, TURN, PHASE, FIRST, LAST, AFTER = range(8)
"""Columns of a world: steps of rest and of motion; the pull [m/s2] and its angle a step; ..."""
ALPHA, WIDTH, HEIGHT, CALM_RATE, CALM_STEPS, DT = range(8, 14)
"""... of the block; rate [rad/s] and steps after which it is at rest; the step [s]."""
COUNT, THETA, RATE, PEAK, CALM, STATE = range(6)
"""Columns of what was seen: steps; of the last one; peak [rad]; steps at rest; state."""
RUNNING, DECIDED, FALLEN, LOST = 0.0, 1.0, 2.0, 3.0


@cache
def all_cases(kind: str = PAPER) -> tuple[Case | RandomCase, ...]:
    """Return the paper's cases, or random ones that are no smaller, larger or longer."""
    if kind == PAPER:
        return tuple(sweep_cases([6, 7, 8, 9]))
    drawn = ((case, case.block.p) for case in draw(1))
    near = (case for case, p in drawn if SMALL < p < LARGE and case.motion.duration + 8 / p < LONG)
    return tuple(islice(near, EVERY[kind]))


@cache
def exact_peaks(kind: str = PAPER) -> FloatArray:
    """Return the exact peaks of all cases over alpha, inf where a block overturns."""
    posed = [(case.block.alpha, case.amplitude_g, case.omega_over_p, case.motion.half_cycles)
             for case in all_cases(kind)]  # fmt: skip
    return peak_ratios(*np.array(posed, float).T)[0]


def numbers_of(worlds: int, every: int) -> NDArray[np.intp]:
    """Return which cases some worlds take: all of them, again and again, if there are fewer."""
    most = min(worlds, every)
    return np.resize(((np.arange(most) + 0.45) * every / most).astype(int), worlds)


def measure(job: Job) -> Row:
    """Return what a batch gave: its rate, its faults, its peaks, and how far they repeat."""
    asked = job.labels
    if job.lost is not None:
        return {"outcome": Outcome.FAILED.value, "message": job.lost.message}
    try:
        found = {**dict.fromkeys(MEASURED, math.nan), "name": "CPU, one core", **found_of(asked)}
    except Exception as error:
        return {"outcome": Outcome.FAILED.value, "message": one_line(error)}
    peaks = found.pop("peaks")
    first = peaks[0][: EVERY[asked["case_set"]]]
    return {
        **{"outcome": "measured", "message": "", **found},
        "cases_per_s": asked["worlds"] / found["wall_s"],
        **spread(peaks, np.resize(first, asked["worlds"])),
        "peaks": packed(first),
    }


def spread(found: FloatArray, first: FloatArray) -> Row:
    """Return how far worlds of one case differ from its first: bits, outcomes, and by how much."""
    bits = (found.view(np.int64) != first.view(np.int64)).any(axis=0)
    kinds = (np.isnan(found) != np.isnan(first)) | (np.isinf(found) != np.isinf(first))
    with np.errstate(invalid="ignore", divide="ignore"):
        apart = np.abs(found / first - 1.0)
    largest = float(np.max(apart, initial=0.0, where=np.isfinite(found * first * apart)))
    return dict(zip(SPREAD, (bits.sum(), kinds.any(axis=0).sum(), largest), strict=True))


def found_of(asked: Mapping[str, Any]) -> Row:
    """Step a batch; return times, and peaks over alpha of each run and world, inf of a fall."""
    kind, numbers = asked["case_set"], numbers_of(asked["worlds"], EVERY[asked["case_set"]])
    if asked["backend"] == EXACT:
        peaks = exact_peaks(kind)[None]  # what is compiled is loaded
        times = repeat(lambda: exact_peaks.__wrapped__(kind), number=1, repeat=20)
        return {"peaks": peaks, "wall_s": min(times)}
    preset, _, ratio = asked["preset"].partition(", impratio ")
    dt_s, settings = 1e-3 * asked["dt_ms"], {"impratio": float(ratio)} if ratio else {}
    cases = [all_cases(kind)[number] for number in numbers]
    posed = [
        (case.block, case.motion, preset,
         {"frame": "base", "step": dt_s * case.block.p, "settings": settings})
        for case in cases
    ]  # fmt: skip
    if asked["backend"] != C:
        models, rows, most = batch_of(posed, dt_s)
        given = models, rows, most, asked["device"], asked["runs"]
        return in_warp(*given) if asked["backend"] == WARP else in_mjx(*given, asked["backend"])

    def peak_of(block: RigidBlock, motion: Motion, preset: str, options: Row) -> tuple[float, int]:
        answer = run_engine(block, motion, engine="mujoco", preset=preset, **options)
        return answer.peak_ratio, answer.steps

    peak_of(*posed[0])  # what is compiled is loaded
    began = perf_counter()
    peaks, steps = np.array([peak_of(*each) for each in posed]).T
    return {"peaks": peaks[None], "wall_s": perf_counter() - began, "steps": int(steps.sum())}


def batch_of(posed: Sequence[tuple[Any, ...]], dt_s: float) -> tuple[list[Any], FloatArray, int]:
    """Return a model and what is known of each world, at steps [s], and the most steps."""
    built: dict[Any, Any] = {}
    rows, most = [], 0.0
    for block, motion, preset, options in posed:
        use = ENGINES["mujoco"].use(scene_of(block, motion, preset, **options))
        if block not in built:
            world: Any = build(use)
            built[block] = world.model
            world.close()
        ground = mean_velocity_of(motion.segments().tolist())
        rest = round(-begin_of(use.scene, dt_s) / dt_s)
        end = math.ceil(motion.duration / dt_s * (1.0 - 1e-12))
        means = [ground(n * dt_s, (n + 1) * dt_s) for n in (0, end - 2, end - 1, end)]
        half = 0.5 * motion.omega * dt_s
        flattened = motion.amplitude * (math.sin(half) / half) ** 2
        still = REST_RATE * block.p * block.alpha, REST_TIME / block.p / dt_s
        pulls = (-kick / dt_s for kick in (means[0], means[2] - means[1], means[3] - means[2]))
        sizes = block.alpha, block.width, block.height
        rows.append([rest, end, -flattened, 2.0 * half, motion.phase, *pulls, *sizes, *still, dt_s])
        most = max(most, rest + end + FREE_ROCKING / block.p / dt_s)
    return [built[each[0]] for each in posed], np.array(rows), math.ceil(most)


def timed(run: Callable[[], FloatArray], rows: FloatArray, runs: int, began: float) -> Row:
    """Return times, steps and peaks over alpha of runs, each of which returns what was seen."""
    compile_s, peaks, times = perf_counter() - began, [], []
    for _ in range(runs):
        began = perf_counter()
        seen = run()
        times.append(perf_counter() - began)
        states = [seen[:, STATE] == FALLEN, seen[:, STATE] == DECIDED]
        peaks.append(np.select(states, [math.inf, seen[:, PEAK] / rows[:, ALPHA]], math.nan))
    found = {"peaks": np.array(peaks), "wall_s": min(times), "compile_s": compile_s}
    return {**found, "steps": int(seen[0, COUNT])}


def bytes_of(of: Any) -> int:
    """Return how long the arrays in dataclasses are."""
    if is_dataclass(of):
        return sum(bytes_of(getattr(of, each.name)) for each in fields(of))
    return int(getattr(of, "capacity", getattr(of, "nbytes", 0)))


def in_warp(models: Sequence[Any], rows: FloatArray, most: int, device: str, runs: int) -> Row:
    """Step a batch in MuJoCo Warp, on a GPU by a graph of one step."""
    wp, mjw = import_module("warp"), import_module("mujoco_warp")
    wp.config.quiet = True
    wp.set_device(device)
    began, worlds, one = perf_counter(), len(rows), models[0]
    able = {each.name for each in fields(mjw.Model) if getattr(each.type, "shape", ("",))[0] == "*"}
    of_all = {name: np.array([getattr(each, name) for each in models])
              for name in able if hasattr(one, name)}  # fmt: skip
    varied = {name: values for name, values in of_all.items() if (values != values[0]).any()}
    model = mjw.put_model(one, batch_sizes=dict.fromkeys(varied, worlds))
    model.opt.warn_overflow = 0
    for name, values in varied.items():
        field = getattr(model, name)
        field.assign(values.reshape(field.numpy().shape))
    model.opt.gravity = wp.zeros(worlds, dtype=wp.vec3)
    data = mjw.make_data(one, nworld=worlds, **ROOM)
    look, known, seen = kernel_of(wp, rows, one.nq == 3)
    places = np.broadcast_to(model.qpos0.numpy(), (worlds, one.nq))

    def step() -> None:
        wp.launch(look, dim=worlds, inputs=[known, seen, data.qpos, data.qvel, model.opt.gravity])
        mjw.step(model, data)

    def run() -> Any:
        mjw.reset_data(model, data)
        data.qpos.assign(places)
        seen.zero_()
        for taken in range(most):
            if taken and taken % CHUNK == 0 and (seen.numpy()[:, STATE] > RUNNING).all():
                break
            wp.capture_launch(graph) if graph else step()
        return seen.numpy()

    step()
    graph, on = None, wp.get_device()
    if on.is_cuda:
        with wp.ScopedCapture() as capture:
            step()
        graph = capture.graph
    wp.synchronize()
    found = timed(run, rows, runs, began)
    found["memory_mb"] = 1e-6 * (bytes_of(model) + bytes_of(data))
    bits, stuck = data.overflow.numpy(), int(mjw.OverflowType.ITERATIONS)
    masks = ~(stuck | int(mjw.OverflowType.LS_ITERATIONS)), stuck
    found |= {name: int((bits & mask != 0).sum()) for name, mask in zip(FAULTS, masks, strict=True)}
    return found | ({"name": on.name} if on.is_cuda else {})


def in_mjx(
    models: Sequence[Any], rows: FloatArray, most: int, device: str, runs: int, precision: str
) -> Row:
    """Step a batch in MJX, by one loop on the device."""
    jax, mjx, mujoco = map(import_module, ("jax", "mujoco.mjx", "mujoco"))
    jnp, one, worlds, on = jax.numpy, models[0], len(rows), jax.devices(device)[0]
    began, kinds = perf_counter(), list({id(each): each for each in models}.values())
    for each in kinds:
        each.opt.iterations = each.opt.ls_iterations = MOST
        each.opt.tolerance = max(each.opt.tolerance, FINEST[precision])
        for flag in UNUSED:
            each.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))

    def step(model: Any, data: Any, gravity: Any) -> Any:
        return mjx.step(model.replace(opt=model.opt.replace(gravity=gravity)), data)

    def go_on(now: Any) -> Any:
        return (now[2][COUNT, 0] < most) & (now[2][STATE] == RUNNING).any()

    def advance(now: Any) -> Any:
        (model, known), data, seen = now
        *seen, pull, weight = look(known, seen, data.qpos.T, data.qvel.T)
        gravity = jnp.stack([pull, jnp.zeros(worlds), -weight], axis=1)
        return now[0], jax.vmap(step, (axes, 0, 0))(model, data, gravity), jnp.stack(seen)

    with jax.enable_x64(precision == MJX), jax.default_device(on):
        look, order = look_of(jnp, one.nq == 3), [kinds.index(each) for each in models]
        put = [jax.tree.flatten(mjx.put_model(each)) for each in kinds]
        values = [np.stack(each) for each in zip(*(leaves for leaves, _ in put), strict=True)]
        varied = [0 if (each != each[0]).any() else None for each in values]
        axes, pairs = put[0][1].unflatten(varied), zip(values, varied, strict=True)
        model = [each[0 if axis is None else order] for each, axis in pairs]
        places = jnp.array([each.qpos0 for each in models])
        data = jax.vmap(lambda place: mjx.make_data(one).replace(qpos=place))(places)
        given = jax.tree.map(jnp.asarray, (put[0][1].unflatten(model), rows.T))
        begin = given, data, jnp.zeros((STATE + 1, worlds))
        run = jax.jit(lambda now: jax.lax.while_loop(go_on, advance, now)[2]).lower(begin).compile()
        found = timed(lambda: np.array(run(begin), float).T, rows, runs, began)
        found["memory_mb"] = 1e-6 * sum(map(bytes_of, jax.tree.leaves((given, data))))
    return found | ({"name": on.device_kind} if device != "cpu" else {})


def look_of(xp: Any, planar: bool) -> Any:
    """Return what looks at a world before a step, in the functions of a library for arrays."""

    def look(k: Any, s: Any, q: Any, v: Any) -> Any:
        if planar:
            theta, rate = q[2], v[2]
        else:
            theta, rate = 2.0 * xp.atan2(q[5], q[3]), v[4]
        since, size = s[COUNT] - k[REST], xp.abs(theta)
        looks = xp.where(since > 0.5, s[STATE] == RUNNING, False)
        side = xp.where(s[THETA] < 0.0, -1.0, 1.0)
        turns = xp.where(s[RATE] * side > 0.0, rate * side <= 0.0, False)
        mean, bend = 0.5 * (s[RATE] + rate), (s[RATE] - rate) * side / k[DT]
        between = xp.where(turns, xp.abs(s[THETA]) + 0.5 * mean * mean / bend, size)
        top = xp.where(between > size, between, size)
        calm = xp.where(xp.abs(rate) > k[CALM_RATE], 0.0, s[CALM] + 1.0)
        still, over = calm >= k[CALM_STEPS], since >= k[END]
        late = xp.where(since >= k[END] + 1.0, xp.abs(s[THETA]) > TURNED * k[ALPHA], False)
        propped = xp.where(still, size < PROPPED_PART * k[ALPHA], False)
        ends = xp.where(xp.where(turns, late, False), True, xp.where(over, propped, False))
        parts = xp.where(size > k[ALPHA], theta * rate > 0.0, False)
        falls = xp.where(size >= LYING, True, xp.where(over, parts, False))
        falls = xp.where(falls, True, xp.where(still, size > LYING_PART * LYING, False))
        inward = 0.5 * k[WIDTH] * side * (1.0 - xp.cos(theta))
        slid = xp.abs(q[0] - 0.5 * k[HEIGHT] * xp.sin(theta) - inward)
        far = xp.where(size <= k[ALPHA], slid > SLIDE_WIDTHS * k[WIDTH], False)
        state = xp.where(falls, FALLEN, xp.where(ends, DECIDED, s[STATE]))
        state = xp.where(xp.isfinite(q[0] + theta + rate), xp.where(far, LOST, state), LOST)
        state = xp.where(looks, state, s[STATE])
        peak = xp.where(top > s[PEAK], top, s[PEAK])
        pull = xp.where(since > 0.5, k[AMPLITUDE] * xp.sin(k[TURN] * since + k[PHASE]), 0.0)
        pull = xp.where(since > k[END] - 0.5, 0.0, pull)
        pull = xp.where(xp.abs(since) < 0.5, k[FIRST], pull)
        pull = xp.where(xp.abs(since - k[END] + 1.0) < 0.5, k[LAST], pull)
        pull = xp.where(xp.abs(since - k[END]) < 0.5, k[AFTER], pull)
        on, part = xp.where(state == RUNNING, 1.0, 0.0), xp.where(s[COUNT] < 0.5, 0.5, 1.0)
        last, swift = xp.where(looks, theta, s[THETA]), xp.where(looks, rate, s[RATE])
        peak, calm = xp.where(looks, peak, s[PEAK]), xp.where(looks, calm, s[CALM])
        return s[COUNT] + 1.0, last, swift, peak, calm, state, on * pull, on * part * GRAVITY

    return look


def kernel_of(wp: Any, rows: FloatArray, planar: bool) -> tuple[Any, Any, Any]:
    """Return Warp's kernel that looks at every world before a step, and what it knows and saw."""
    of_world, of_sight = (wp.types.vector(length, wp.float32) for length in (rows.shape[1], 6))
    numbers, places = wp.array(dtype=float), wp.array2d(dtype=float)
    look = look_of(wp, planar)
    look.__annotations__ = {"k": of_world, "s": of_sight, "q": numbers, "v": numbers}
    look = wp.func(look)

    def look_at(known: Any, seen: Any, q: Any, v: Any, gravity: Any) -> None:
        i = wp.tid()
        n, a, b, c, d, e, pull, weight = look(known[i], seen[i], q[i], v[i])
        seen[i] = of_sight(n, a, b, c, d, e)
        gravity[i] = wp.vec3(pull, 0.0, -weight)

    worlds, sights, pulls = (wp.array(dtype=kind) for kind in (of_world, of_sight, wp.vec3))
    kinds = worlds, sights, places, places, pulls
    look_at.__annotations__ = dict(zip(look_at.__annotations__, kinds, strict=False))
    known = wp.array(rows.astype(np.float32), dtype=of_world)
    return wp.kernel(look_at), known, wp.zeros(len(rows), dtype=of_sight)
