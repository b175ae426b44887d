"""A cylinder that rolls: asked of the exact solution or of an engine, and what is seen of it."""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from analytic.cylinder import RollingCylinder
from analytic.motion import FloatArray, Motion, Still
from analytic.response import History, Reason, Response, RollingOutcome
from engines.run.drive import NotAvailableError
from engines.scene import one_of
from engines.space import Cylinder, SpaceScene, Track, axes, energies, lowest, roll

TURNS = 5.0
"""Turns of the foot about the centre for which a cylinder is watched by default."""

LOOKS = 32
"""States that are kept of a turn: what its phase is late or early by changes little in between."""

DENSITY = 1000.0
"""[kg/m3], as of blocks."""

LOST = 0.5
"""A cylinder is lost when its tilt goes this part of the way to lying flat, or on its side."""

OPTIONS = frozenset({"friction", "max_steps", "preset", "settings", "step", "time_limit_s"})
"""Those of a `SpaceScene` that a source takes, and `density`."""


def rolled(
    cylinder: RollingCylinder,
    motion: Motion,
    *,
    engine: str = "",
    preset: str | None = None,
    duration: float | None = None,
    times: FloatArray | None = None,
    **options: Any,
) -> Response:
    """Ask an engine, or the exact solution, for a cylinder that sets out to roll steadily.

    Parameters
    ----------
    cylinder : RollingCylinder
    motion : Still
    engine, preset : str, optional
        Whose answer it is; without an engine that of the exact solution.
    duration : float, optional
        Watch until this time [s], by default for `TURNS` turns.
    times : array, optional
        Times [s] at which the history has the tilt [rad] and its rate [rad/s].
    **options
        Of the engine, as in `studies.respond`.

    Returns
    -------
    Response
        Its observables are those of `seen`.
    """
    scene = space_scene(cylinder, motion, preset=preset, duration=duration, **options)
    if not engine:
        count = max(math.ceil(scene.duration / scene.every), 1)
        moments = np.linspace(0.0, scene.duration, count + 1)
        track = Track(moments, steady_states(cylinder, moments), 0, 0.0, 0.0, None, "")
    else:
        try:
            track = roll(engine, scene)
        except NotAvailableError as error:
            return Response.failure(str(error), reason=Reason.UNAVAILABLE)
    if track.problem:
        reason, message = track.problem
        return Response.failure(message, reason=reason, steps=track.steps, wall_s=track.wall_s)
    tilts, observed = seen(cylinder, scene, track)
    return Response(
        outcome=_outcome(cylinder, tilts),
        peak_ratio=float(tilts.max()) / cylinder.tilt,
        steps=track.steps,
        wall_s=track.wall_s,
        setup_s=track.setup_s,
        message=f"as {engine}:{track.preset}" if engine and preset is None else "",
        history=None if times is None else _history(track, tilts, np.asarray(times)),
        observables=observed,
    )


def space_scene(
    cylinder: RollingCylinder,
    motion: Motion,
    *,
    duration: float | None = None,
    density: float = DENSITY,
    **options: Any,
) -> SpaceScene:
    """Return the scene that an engine is asked about: the cylinder as it rolls steadily at time 0.

    Parameters
    ----------
    cylinder : RollingCylinder
    motion : Still
    duration : float, optional
        Watch until this time [s]; by default for `TURNS` turns.
    density : float, optional
        [kg/m3]
    **options
        Those of `OPTIONS`, in the units of `engines.scene.Scene`: `step` is p dt.

    Raises
    ------
    ValueError
        If the base moves, there is no such option, or a value is not allowed.
    """
    if not isinstance(motion, Still):
        words = "a cylinder that rolls is on a base at rest: it must be Still()"
        raise ValueError(f"motion is a {type(motion).__name__}; {words}")
    for name in options:
        one_of("option", name, sorted({*OPTIONS, "density"}))
    state = steady_states(cylinder, np.zeros(1))[0].tolist()
    body = Cylinder(
        radius=cylinder.radius,
        height=cylinder.height,
        density=density,
        place=tuple(state[:3]),
        turn=tuple(state[3:7]),
        velocity=tuple(state[7:10]),
        spin=tuple(state[10:]),
    )
    return SpaceScene(
        cylinder=body,
        gravity=cylinder.gravity,
        p=cylinder.p,
        duration=TURNS * cylinder.turn if duration is None else duration,
        every=cylinder.turn / LOOKS,
        **options,
    )


def steady_states(cylinder: RollingCylinder, times: FloatArray) -> FloatArray:
    """Return the states (n, 13) of the exact solution at times [s], as of `engines.space.Track`."""
    from scipy.spatial.transform import Rotation

    exact = cylinder.at(times)
    x, y, z, w = Rotation.from_matrix(exact.turned).as_quat().T
    still, place = np.zeros((len(times), 3)), np.zeros((len(times), 3))
    place[:, 2] = cylinder.centre_height
    return np.column_stack((place, w, x, y, z, still, exact.rates))


def seen(
    cylinder: RollingCylinder, scene: SpaceScene, track: Track
) -> tuple[FloatArray, Mapping[str, float]]:
    """Return the tilts [rad] of a cylinder, and what is seen of it at the end.

    Returns
    -------
    ndarray (n,), mapping
        tilt_error_rad, phase_error_rad: of the axis, positive where it leans too far or is ahead;
        height_drift_m, aside_m: of its centre, which should stay, upwards and along the base;
        energy_change: relative to what it should be; sink_m: how deep its lowest point was at most.
    """
    axis, states = axes(track.states), track.states
    tilts = np.arctan2(np.hypot(axis[:, 0], axis[:, 1]), axis[:, 2])
    azimuth = np.arctan2(axis[:, 1], axis[:, 0])
    late = np.unwrap(azimuth - cylinder.precession * track.times)
    energy = energies(states[-1:], scene.cylinder, scene.gravity)[0] / scene.cylinder.mass
    observed = {
        "tilt_error_rad": tilts[-1] - cylinder.tilt,
        "phase_error_rad": late[-1],
        "height_drift_m": states[-1, 2] - cylinder.centre_height,
        "aside_m": math.hypot(*states[-1, :2]),
        "energy_change": energy / cylinder.energy - 1.0,
        "sink_m": max(-lowest(states, scene.cylinder).min(), 0.0),
    }
    return tilts, {name: float(value) for name, value in observed.items()}


def _outcome(cylinder: RollingCylinder, tilts: FloatArray) -> RollingOutcome:
    off = tilts - cylinder.tilt
    if off.min() < -LOST * cylinder.tilt:
        return RollingOutcome.LAY_DOWN
    if off.max() > LOST * (0.5 * math.pi - cylinder.tilt):
        return RollingOutcome.FELL_OVER
    return RollingOutcome.ROLLED


def _history(track: Track, tilts: FloatArray, times: FloatArray) -> History:
    """Return tilts and their rates at times, between the states that were kept."""
    axis, spin = axes(track.states), track.states[:, 10:13]
    sunk = spin[:, 0] * axis[:, 1] - spin[:, 1] * axis[:, 0]
    rates = -sunk / np.maximum(np.sin(tilts), np.finfo(float).tiny)
    inside = times[times <= track.times[-1] * (1.0 + 1e-12)]
    known = [np.interp(inside, track.times, values) for values in (tilts, rates)]
    return History(inside, *known)
