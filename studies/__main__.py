"""The command line: `rocking`, and `python -m studies`."""

import io
import itertools
import os
import signal
import sys

from cyclopts import App, CycloptsError, Parameter

from studies.arguments import BadInputError
from studies.journal import FolderError

COMMANDS = {
    "compare": """One block and one pulse or record through every source, side by side.

For each source: the outcome, the largest rotation over the critical one θcr = atan(B/H), its
relative difference from the exact solution, the impacts and their velocity ratio beside Housner's
η, the steps and the run time. All sources observe the same window of time.""",
    "histories": """The paper's time histories, figures 2, 4 and 5.

Writes for each figure its samples (CSV), its drawing (PNG) and what was found (text).""",
    "sweep": """The paper's sensitivity analysis, figures 6 to 9.

240 cases a figure through every named source. Writes sweep.csv (a row for each case and source), a
PNG for each figure, summary.csv, findings.txt and provenance.json. Finished cases are stored at
once: a run that was interrupted goes on where it stopped when the same command is given again.""",
    "validate": """Random cases that nothing was tuned on, held against the exact solution.

Outcomes, quantiles of the error, and the condition number κ of each case: how far a small error of
the pulse moves its peak. And what landing steps lean on: the first cases with false hints. Writes
validate.csv, errors.csv, hints.csv, leaning.csv and provenance.json; resumable.""",
    "precision": """Error against run time: every method along its own setting, on the same cases.

Writes precision.csv, work-precision.csv, a work-precision diagram (PNG) and findings.txt;
resumable. The full study takes about twenty minutes on one core, --quick one.""",
    "cost": """What a scene costs, and what each thing left out of it would cost and change.

Where the time of a step goes, and the price of a free body, a full box, a moving base, a recorded
history, ... measured by putting them back. Writes shares.csv, scenes.csv and reference.csv.""",
    "linearizations": """What in a linearization matters: onset, frequency and saddle, each alone.

All eight combinations against the exact solution, on the paper's cases and on a wider grid, and
the paper's conclusions (a), (b), (c). Writes linearizations.csv, quantiles.csv, a PNG and
findings.txt. A few seconds.""",
    "free": """Free rocking: quarter periods and decay of each source against the closed forms.

Over the rotation from which the block falls and over H/B. Writes free.csv, free.png and
findings.txt; resumable. Less than a minute.""",
    "stability": """Stiff and extreme cases: who stays finite, keeps the outcome and the energy.

Writes stability.csv with its matrix (PNG), steps.csv (the largest stable and accurate steps),
sensitivity.csv and findings.txt; resumable. A failure is an answer: the exit code is 1 only where
a source gives no result at all. The full study takes about six minutes on two cores, --quick half
a minute.""",
    "contact": """Contact models: what each setting of an engine's contact costs and buys.

One factor at a time, from the best fixed-step setting and from the library's defaults. Writes
contact.csv, variants.csv, contact.png and findings.txt; resumable. The full study takes
about four minutes on one core, --quick less than one.""",
    "overturning": """Overturning maps: which pulses overturn a block, after how many impacts.

Amplitude over frequency, slenderness or size, for each model; the engines on a coarse grid and
beside the edges; where each differs from the exact solution. Writes map.csv, boundaries.csv,
differences.csv, checks.csv, the engines' tables, PNGs and findings.txt; the engines' runs are
resumable. The full study takes about two minutes on one core, --quick a quarter of one.""",
    "ensemble": """Many motions, blocks and intensities: single responses and their statistics.

Distributions of the peak, fragility curves with their bounds, and the agreement of each source with
the exact solution case by case and in distribution. Writes ensemble.csv, stripes.csv, curves.csv,
agreement.csv, confusion.csv, ensemble.png and findings.txt; resumable. The full study takes about a
quarter of an hour on one core, --quick half a minute.""",
    "validity": """Where the reference is valid, and what engines do beyond: slide, lift off.

The smallest normal force and the friction needed over amplitude, frequency and H/B, and the engines
on squat blocks and with low friction. Writes validity.csv, map.csv, compared.csv, validity.png and
findings.txt; resumable. The full study takes about a minute on one core, --quick a quarter of
one.""",
    "report": """Every study, and one self-contained page (report.html) about them.

The quick studies take about four minutes on two cores, the full ones about fifty. A report that
was interrupted goes on where it stopped when the same command is given again.""",
    "animate": """A block rocking in several sources side by side, on the same clock, as a film.

For one block and pulse, or for the case of a sweep's results in which the sources differ most. A
GIF, or an MP4 with the extra [video].""",
    "throughput": """Cases per second of an overturning map, beside general-purpose integrators.

A million cases of each pulse through every model, on all cores and on one; SciPy's DOP853 and
heyoka.py, where it is installed, on a sample of them. Writes throughput.csv.""",
    "redraw": "Draw a results folder again, from its CSVs alone.",
}
"""Each is the function `command` of the module of that name, loaded when it is asked for."""


def make_app() -> App:
    """Return the command line."""
    app = App(
        name="rocking",
        help="A rocking block: the exact solution, its linearizations, PyBullet and MuJoCo.",
        help_format="markdown",
        help_formatter="default",
        version=_version,
        default_parameter=Parameter(negative=()),
        suppress_keyboard_interrupt=False,
    )
    for name, help_text in COMMANDS.items():
        app.command(f"studies.{name}:command", name=name, help=help_text)
    return app


def _version() -> str:
    from studies.provenance import project_version

    return project_version()


def run(arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    for name, value in itertools.pairwise(["", *arguments]):
        if not value:
            return _refuse(f"{name} is empty; it must be given")
    try:
        code = make_app()(
            arguments,
            exit_on_error=False,
            print_error=False,
            verbose=False,
            result_action="return_value",
        )
        sys.stdout.flush()
    except (CycloptsError, BadInputError, FolderError) as error:
        return _refuse(str(error))
    except KeyboardInterrupt as stop:
        print(f"rocking: interrupted; {stop}".rstrip("; "), file=sys.stderr)
        return 128 + signal.SIGINT
    except BrokenPipeError:
        # whoever read the output has gone: nothing more can be said there, not even on exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except OSError as error:
        return _refuse(str(error))
    return code if isinstance(code, int) else 0


def _refuse(message: str) -> int:
    print(f"rocking: {' '.join(message.split())}", file=sys.stderr)
    return 2


def main() -> None:
    """Run the command that the arguments name, and exit."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # a terminal without Greek letters shows question marks instead
            stream.reconfigure(errors="replace")
    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
