"""The paper's cases as one batch of worlds, stepped by MuJoCo Warp, or one by one in MuJoCo's C."""
# All worlds take the same step on a base at rest, whose acceleration is each world's own gravity.

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields
from functools import cache
from importlib import import_module
from time import perf_counter
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
from studies.cases.paper import Case, sweep_cases
from studies.kit.jobs import Job, Row
from studies.kit.say import one_line
from studies.kit.tables import packed
from studies.sources.registry import run_engine, scene_of

EXACT, C, WARP = "exact", "c", "warp"
NAMES = {EXACT: "the exact solution", C: "MuJoCo in C", WARP: "MuJoCo Warp"}
MEASURED = ("name", "steps", "compile_s", "wall_s", "cases_per_s", "overflows", "unconverged")
SPREAD = ("bits_differ", "outcomes_differ", "largest_spread")
EVERY = 960
CHUNK = 200
"""Steps between two looks at whether a world is undecided."""
ROOM = {"nconmax": 8, "njmax": 32}
"""Contacts and rows of constraints for each world."""
TURNED = 1e-3
"""A turn at less than this part of alpha is a tremor of the contact."""

REST, END, AMPLITUDE, TURN, PHASE, FIRST, LAST, AFTER = range(8)
"""Columns of a world: steps of rest and of motion; the pull [m/s2] and its angle a step; ..."""
ALPHA, WIDTH, HEIGHT, CALM_RATE, CALM_STEPS, DT = range(8, 14)
"""... of the block; rate [rad/s] and steps after which it is at rest; the step [s]."""
COUNT, THETA, RATE, PEAK, CALM, STATE = range(6)
"""Columns of what was seen: steps; of the last one; peak [rad]; steps at rest; state."""
RUNNING, DECIDED, FALLEN, LOST = 0.0, 1.0, 2.0, 3.0
"""States of a world."""


@cache
def all_cases() -> tuple[Case, ...]:
    """Return the paper's cases."""
    return tuple(sweep_cases([6, 7, 8, 9]))


@cache
def exact_peaks() -> FloatArray:
    """Return the exact peaks of all cases over alpha, inf where a block overturns."""
    posed = [(case.block.alpha, case.amplitude_g, case.omega_over_p, case.motion.half_cycles)
             for case in all_cases()]  # fmt: skip
    return peak_ratios(*np.array(posed, float).T)[0]


def numbers_of(worlds: int) -> NDArray[np.intp]:
    """Return which cases some worlds take: all of them, again and again, if there are fewer."""
    most = min(worlds, EVERY)
    return np.resize(((np.arange(most) + 0.45) * EVERY / most).astype(int), worlds)


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
    first = peaks[0][:EVERY]
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
    if asked["backend"] == EXACT:
        exact_peaks()  # what is compiled is loaded
        began = perf_counter()
        peaks = exact_peaks.__wrapped__()[None]
        return {"peaks": peaks, "wall_s": perf_counter() - began}
    preset, _, ratio = asked["preset"].partition(", impratio ")
    dt_s, settings = 1e-3 * asked["dt_ms"], {"impratio": float(ratio)} if ratio else {}
    cases = [all_cases()[number] for number in numbers_of(asked["worlds"])]
    posed = [
        (case.block, case.motion, preset,
         {"frame": "base", "step": dt_s * case.block.p, "settings": settings})
        for case in cases
    ]  # fmt: skip
    if asked["backend"] == WARP:
        return in_warp(posed, dt_s, asked["device"], asked["runs"])

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


def in_warp(posed: Sequence[tuple[Any, ...]], dt_s: float, device: str, runs: int) -> Row:
    """Step a batch in MuJoCo Warp, on a GPU by a graph of one step."""
    wp, mjw = import_module("warp"), import_module("mujoco_warp")
    wp.config.quiet = True
    wp.set_device(device)
    models, rows, most = batch_of(posed, dt_s)
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
    look, known, seen = look_in(wp, rows)
    places = np.broadcast_to(model.qpos0.numpy(), (worlds, one.nq))

    def step() -> None:
        given = [known, seen, data.qpos, data.qvel, model.opt.gravity, int(one.nq == 3)]
        wp.launch(look, dim=worlds, inputs=given)
        mjw.step(model, data)

    def run(steps: int, graph: Any) -> int:
        mjw.reset_data(model, data)
        data.qpos.assign(places)
        seen.zero_()
        for taken in range(steps):
            if taken and taken % CHUNK == 0 and (seen.numpy()[:, STATE] > RUNNING).all():
                return taken
            wp.capture_launch(graph) if graph else step()
        return steps

    run(1, None)
    graph, on = None, wp.get_device()
    if on.is_cuda:
        with wp.ScopedCapture() as capture:
            step()
        graph = capture.graph
    wp.synchronize()
    compile_s, peaks, times = perf_counter() - began, [], []
    for _ in range(runs):
        began = perf_counter()
        steps = run(most, graph)
        wp.synchronize()
        times.append(perf_counter() - began)
        end = seen.numpy()
        states = [end[:, STATE] == FALLEN, end[:, STATE] == DECIDED]
        peaks.append(np.select(states, [math.inf, end[:, PEAK] / rows[:, ALPHA]], math.nan))
    bits, stuck = data.overflow.numpy(), int(mjw.OverflowType.ITERATIONS)
    known_bits = stuck | int(mjw.OverflowType.LS_ITERATIONS)
    return {
        **{"peaks": np.array(peaks), "wall_s": min(times), "steps": steps, "compile_s": compile_s},
        "overflows": int((bits & ~known_bits != 0).sum()),
        "unconverged": int((bits & stuck != 0).sum()),
        **({"name": on.name} if on.is_cuda else {}),
    }


def look_in(wp: Any, rows: FloatArray) -> tuple[Any, Any, Any]:
    """Return Warp's kernel that looks at every world before a step, and what it knows and saw."""

    def look(known: Any, seen: Any, q: Any, v: Any, gravity: Any, planar: int) -> None:
        i = wp.tid()
        k, s = known[i], seen[i]
        theta, rate = float(q[i, 2]), float(v[i, 2])  # numbers that Warp lets vary
        if planar == 0:
            theta, rate = 2.0 * wp.atan2(q[i, 5], q[i, 3]), float(v[i, 4])
        since, size = s[COUNT] - k[REST], wp.abs(theta)
        if since > 0.5 and s[STATE] == RUNNING:
            side = wp.where(s[THETA] < 0.0, -1.0, 1.0)
            turns = s[RATE] * side > 0.0 and rate * side <= 0.0
            top = float(size)
            if turns:
                mean, bend = 0.5 * (s[RATE] + rate), (s[RATE] - rate) * side / k[DT]
                top = wp.max(size, wp.abs(s[THETA]) + 0.5 * mean * mean / bend)
            s[PEAK] = wp.max(s[PEAK], top)
            s[CALM] = wp.where(wp.abs(rate) > k[CALM_RATE], 0.0, s[CALM] + 1.0)
            still, over = s[CALM] >= k[CALM_STEPS], since >= k[END]
            turned = turns and wp.abs(s[THETA]) > TURNED * k[ALPHA] and since >= k[END] + 1.0
            if turned or (over and still and size < PROPPED_PART * k[ALPHA]):
                s[STATE] = DECIDED
            lies = size >= LYING or (still and size > LYING_PART * LYING)
            if lies or (over and size > k[ALPHA] and theta * rate > 0.0):
                s[STATE] = FALLEN
            inward = 0.5 * k[WIDTH] * side * (1.0 - wp.cos(theta))
            slid = q[i, 0] - 0.5 * k[HEIGHT] * wp.sin(theta) - inward
            if size <= k[ALPHA] and wp.abs(slid) > SLIDE_WIDTHS * k[WIDTH]:
                s[STATE] = LOST
            if not wp.isfinite(q[i, 0] + theta + rate):
                s[STATE] = LOST
            s[THETA] = theta
            s[RATE] = rate
        pull = wp.where(since > 0.5, k[AMPLITUDE] * wp.sin(k[TURN] * since + k[PHASE]), 0.0)
        pull = wp.where(since > k[END] - 0.5, 0.0, pull)
        pull = wp.where(wp.abs(since) < 0.5, k[FIRST], pull)
        pull = wp.where(wp.abs(since - k[END] + 1.0) < 0.5, k[LAST], pull)
        pull = wp.where(wp.abs(since - k[END]) < 0.5, k[AFTER], pull)
        weight = wp.where(s[COUNT] < 0.5, 0.5 * GRAVITY, GRAVITY)
        goes_on = wp.where(s[STATE] == RUNNING, 1.0, 0.0)
        gravity[i] = goes_on * wp.vec3(pull, 0.0, -weight)
        s[COUNT] = s[COUNT] + 1.0
        seen[i] = s

    of_world, of_sight = (wp.types.vector(length, wp.float32) for length in (rows.shape[1], 6))
    look.__annotations__ = {
        **{"known": wp.array(dtype=of_world), "seen": wp.array(dtype=of_sight)},
        **dict.fromkeys(("q", "v"), wp.array2d(dtype=float)),
        **{"gravity": wp.array(dtype=wp.vec3), "planar": int},
    }
    known = wp.array(rows.astype(np.float32), dtype=of_world)
    return wp.kernel(look), known, wp.zeros(len(rows), dtype=of_sight)
