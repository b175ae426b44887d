"""An engine's page, from its three tables and the published ones."""

from __future__ import annotations

from pathlib import Path
from textwrap import fill
from typing import Any

import pandas as pd

from engines import ENGINES
from engines.declaration import Engine, Precision
from studies.advise.evidence import LADDER
from studies.drawing.kept import Pictures, keep
from studies.kit import provenance
from studies.kit.digests import check
from studies.kit.tables import in_columns, read_table
from studies.measures.costs import cost_text
from studies.measures.differences import scientific, summarize, summary_text, with_reference
from studies.measures.posed import posed
from studies.measures.published import PUBLISHED
from studies.measures.words import listed, meant, part, right_but
from studies.precision.choices import TARGETS, cheapest_below, engines_of, joint
from studies.precision.report import with_errors, work_precision
from studies.stability.findings import failures
from studies.stability.report import verdicts

WIDTH = 99
"""Of the page, in letters."""


def report(folder: Path) -> str:
    """Draw a folder's figures, and write and return its page."""
    engine = ENGINES[engine_of(folder)]
    along = ladder(folder)
    extremes = _table(folder, "extremes")
    text = "\n\n".join(
        [
            introduction(engine),
            asked_text(folder) + "\n" + summary_text(swept(folder)),
            "Along the step, on typical cases and near overturning together:\n" + along_text(along),
            "The cheapest setting below an error on all of these, and the published one:\n"
            + places_text(along),
            "Verdicts on extreme cases:\n" + in_columns(verdicts(extremes)),
            "Of these failures, and the first setting that avoids each:\n"
            + in_columns(failures(extremes)[["case", "source", "reason", "remedy"]]),
            help_text(engine),
        ]
    )
    return keep(folder, pictures(folder), text, "score.txt")


def asked_text(folder: Path) -> str:
    """Say what the paper's cases are, and what of them is counted."""
    asked = posed(_table(folder, "sweep")).words
    return fill(
        f"The paper's cases: {asked}. Errors of the peak are relative, over cases that survive. "
        f"Wrong are outcomes in three kinds, fall (falsely + missed), rest and none: {meant()}.",
        WIDTH,
    )


def engine_of(folder: Path) -> str:
    """Return the name of the engine that a folder is about."""
    return str(provenance.record_of(folder)["settings"]["engine"])


def headline(folder: Path) -> str:
    """Say how many outcomes the engine's presets get right, and how far peaks are off."""
    words = [
        f"{line['source']} gets {right_but(line, line['cases'])} outcomes right, "
        f"and peaks to {part(line['max_error'])}"
        for _, line in swept(folder).iterrows()
    ]
    return f"{listed(words)}."


def pictures(folder: Path) -> Pictures:
    """Draw the error-time diagram and the matrix of extremes, from the tables alone."""
    from studies.score.figure import draw_score
    from studies.stability.figure import draw_matrix

    return {
        "score": draw_score(ladder(folder), published()),
        "extremes": draw_matrix(_table(folder, "extremes")),
    }


def swept(folder: Path) -> pd.DataFrame:
    """Return the lines of all figures together, one for each preset."""
    lines = summarize(with_reference(_table(folder, "sweep")))
    found: pd.DataFrame = lines[lines["figure"] == lines["figure"].iloc[-1]]
    return found.reset_index(drop=True)


def ladder(folder: Path) -> pd.DataFrame:
    """Return errors and times of each method and setting; see `work_precision`."""
    return work_precision(with_errors(_table(folder, "steps")))


def published() -> pd.DataFrame:
    """Return the published table of the same; FolderError if it was edited."""
    check(PUBLISHED, [LADDER], "the published folder")
    return pd.read_csv(PUBLISHED / LADDER)


def _table(folder: Path, name: str) -> pd.DataFrame:
    return read_table(folder / f"score-{name}.csv")


def introduction(engine: Engine) -> str:
    """Say which engine this is, and what it can do."""
    versions = [f"{name} {provenance.version_of(name)}" for name in engine.packages]
    precision = "single" if engine.precision is Precision.SINGLE else "double"
    return fill(
        f"{engine.title}{f' ({listed(versions)})' if versions else ''}, in {precision} precision, "
        f"{'in space' if engine.spatial else 'in the plane'}; frames {listed(engine.frames)}, "
        f"geometries {listed(engine.geometries)}.",
        WIDTH,
    )


def along_text(along: pd.DataFrame) -> str:
    """Return the errors and the time of a case of every method and setting."""
    lines = joint(along)
    typical = along[along["set"] == "typical"].set_index(["method", "value"])
    keys = pd.MultiIndex.from_frame(lines[["method", "value"]])
    return pd.DataFrame(
        {
            "method": lines["method"].mask(lines["method"] == lines["method"].shift(), ""),
            "setting": lines["value"].map("{:g}".format),
            "median": typical["median_error"].reindex(keys).map(scientific).to_numpy(),
            "largest": lines["max_error"].map(scientific),
            "failed": lines["failed"],
            "ms a case": (1e3 * lines["wall_s"]).map("{:.3g}".format),
            "runs": lines["runs"],
            "loop": lines["driver"],
        }
    ).to_string(index=False)


def places_text(along: pd.DataFrame) -> str:
    """Return, for each error, the cheapest setting of this engine and of the published ones."""
    mine, others = joint(along), joint(engines_of(published()))
    return pd.DataFrame(
        {
            "error": f"{target:g}",
            "this engine": _setting(cheapest_below(mine, target)),
            "published": _setting(cheapest_below(others, target)),
        }
        for target in TARGETS
    ).to_string(index=False)


def _setting(line: pd.Series[Any] | None) -> str:
    if line is None:
        return "none"
    cost = cost_text(line["wall_s"], line["runs"])
    return f"{line['method']} at {line['value']:g}, {cost}, {line['driver']}"


def help_text(engine: Engine) -> str:
    """Say what each preset is helped by, and what the library's defaults are known to miss."""
    sentences = []
    for preset in engine.presets:
        helps = listed([help_.value for help_ in preset.helped_by]) if preset.helped_by else ""
        sentences.append(f"{preset.name} is helped by {helps or 'nothing'}.")
        sentences += [f"{preset.name} misses: {miss.value}." for miss in preset.misses]
    return "\n".join(fill(sentence, WIDTH) for sentence in sentences)
