"""One response as a picture."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analytic.response import Response


def draw_response(response: Response, axes: Axes | None = None) -> Axes:
    """Draw the rotation of a response over time, with ticks at its impacts; return the axes.

    Raises
    ------
    ValueError
        If it has no history.
    """
    if response.history is None:
        raise ValueError("the response has no history; ask for one with times=...")
    if axes is None:
        axes = Figure(figsize=(7.0, 2.8), layout="constrained").subplots()
    history = response.history
    (line,) = axes.plot(history.time, history.theta)
    axes.axhline(0.0, color="#999999", linewidth=0.6)
    impacts = [impact.time for impact in response.impacts if impact.time <= history.time[-1]]
    axes.plot(impacts, [0.0] * len(impacts), "|", color=line.get_color(), markersize=9)
    peak = f", {response.peak_ratio:.4g} θcr at most" if response.outcome.value == "rocked" else ""
    axes.set(title=f"{response.outcome.value}{peak}, {len(response.impacts)} impacts",
             xlabel="time  t  [s]", ylabel="rotation  θ  [rad]")  # fmt: skip
    return axes
