"""The studies as chapters of a report: what each asks, how it is run, what it leaves behind."""

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, slots=True, kw_only=True)
class Chapter:
    """A study in a report.

    Its module has, beside `command`, a function `pictures` that draws a results folder's figures
    from its CSVs, and a function `headline` that says what they show in a sentence or two.

    Attributes
    ----------
    study : str
        Its command and module.
    folder : str
        Where a report keeps its results.
    question : str
    source : str
        Pattern of the table by which its folder is known.
    tables : tuple of str
        Tables short enough to be read.
    quick, full : tuple of str
        Further arguments of its command.
    minutes : tuple of float
        About how long quick and full take on two cores.
    """

    study: str
    folder: str
    question: str
    source: str
    tables: tuple[str, ...]
    quick: tuple[str, ...] = ("--quick",)
    full: tuple[str, ...] = ()
    minutes: tuple[float, float] = (1.0, 1.0)

    def command_line(self, folder: Path, full: bool) -> list[str]:
        """Return the words after `rocking` that fill a folder."""
        return [self.study, "--out", str(folder), *(self.full if full else self.quick)]

    def pictures(self, folder: Path) -> dict[str, "Figure"]:
        """Draw the figures of a folder, by name."""
        drawn: dict[str, Figure] = import_module(f"studies.{self.study}").pictures(folder)
        return drawn

    def headline(self, folder: Path) -> str:
        """Return what a folder's tables show, in a sentence or two."""
        return str(import_module(f"studies.{self.study}").headline(folder))


CHAPTERS: tuple[Chapter, ...] = (
    Chapter(
        study="sweep",
        folder="sweep",
        question="Do the engines and the linearizations get the paper's 960 cases right?",
        source="sweep.csv",
        tables=("summary.csv",),
        quick=("--accuracy", "loose"),
        minutes=(0.3, 0.6),
    ),
    Chapter(
        study="sweep",
        folder="presets",
        question="And the engines as they come, or with a tuned contact and a fixed step?",
        source="sweep.csv",
        tables=("summary.csv",),
        quick=("--figure", "8", "--sources", "exact", "pybullet:naive", "mujoco:naive"),
        full=(
            *("--sources", "exact", "pybullet:naive", "pybullet:fixed"),
            *("mujoco:naive", "mujoco:fixed"),
        ),
        minutes=(0.2, 3.0),
    ),
    Chapter(
        study="histories",
        folder="histories",
        question="Do the paper's time histories come out, and what it says about them?",
        source="figure-[245].csv",
        tables=(),
        quick=(),
        minutes=(0.1, 0.1),
    ),
    Chapter(
        study="linearizations",
        folder="linearizations",
        question="What in a linearization matters, and do the paper's conclusions hold?",
        source="linearizations.csv",
        tables=("linearizations.csv",),
        quick=(),
        minutes=(0.1, 0.1),
    ),
    Chapter(
        study="free",
        folder="free",
        question="Is free rocking as the closed forms say?",
        source="free.csv",
        tables=(),
        minutes=(0.1, 0.3),
    ),
    Chapter(
        study="validate",
        folder="validate",
        question="And cases that nothing was tuned on?",
        source="validate.csv",
        tables=("leaning.csv",),
        quick=("--cases", "100"),
        minutes=(0.1, 0.3),
    ),
    Chapter(
        study="precision",
        folder="precision",
        question="Which error does which run time buy, and what does a scene not need?",
        source="precision.csv",
        tables=("work-precision.csv", "scenes.csv", "shares.csv", "reference.csv"),
        minutes=(1.1, 20.0),
    ),
    Chapter(
        study="contact",
        folder="contact",
        question="What does each setting of a contact cost and buy?",
        source="contact.csv",
        tables=("variants.csv",),
        minutes=(0.8, 4.0),
    ),
    Chapter(
        study="stability",
        folder="stability",
        question="What stays finite, right and accurate in stiff and extreme cases?",
        source="stability.csv",
        tables=("steps.csv",),
        minutes=(0.6, 6.0),
    ),
    Chapter(
        study="overturning",
        folder="overturning",
        question="Which pulses overturn a block, and who draws that map wrongly?",
        source="boundaries.csv",
        tables=("differences.csv", "checks.csv"),
        minutes=(0.5, 5.0),
    ),
    Chapter(
        study="validity",
        folder="validity",
        question="Where is the reference itself valid, and what do engines do beyond?",
        source="validity.csv",
        tables=(),
        minutes=(0.5, 3.0),
    ),
    Chapter(
        study="ensemble",
        folder="ensemble",
        question="Are statistics predicted where single responses are not?",
        source="ensemble.csv",
        tables=("agreement.csv", "confusion.csv"),
        minutes=(0.5, 15.0),
    ),
)
"""In the order of the report."""
