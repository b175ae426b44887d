"""The options that all studies share, explained once."""

from typing import Literal

from cyclopts import App, Parameter

from studies.kit.arguments import Running, Sources


def command(topic: Literal["run"] = "run") -> int:
    """Explain the options that every study takes.

    Parameters
    ----------
    topic
        run: what a study runs, where, and for how long.
    """
    app = App(
        name="rocking STUDY",
        help="Options of every study.",
        help_flags=(),
        version_flags=(),
        default_parameter=Parameter(negative=(), show_default=False),
    )

    @app.default
    def study(*, sources: Sources = ("exact",), running: Running = Running()) -> None:  # noqa: B008
        pass

    app.help_print([])
    return 0
