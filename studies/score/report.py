"""An engine's page, from its tables and the published ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd

from engines import ENGINES
from engines.declaration import Engine
from studies.advise.evidence import LADDER
from studies.drawing.kept import tell
from studies.old import provenance
from studies.old.provenance import check
from studies.old.tables import read_table
from studies.measures.differences import summarize, with_reference
from studies.measures.finer import joint
from studies.measures.posed import posed
from studies.measures.published import PUBLISHED
from studies.measures.words import listed, part, right_but
from studies.precision.choices import TARGETS, TYPICAL, cheapest_below, engines_of
from studies.precision.report import with_errors, work_precision
from studies.scenes.told import SCENES, lines_of
from studies.score import STUDY
from studies.score.moments import accusation, judged
from studies.score.release import suspicion
from studies.stability.study import failures, verdicts


def report(folder: Path) -> str:
    """Draw a folder's figures, and write and return its page."""
    engine = scored(provenance.record_of(folder)["settings"]["engine"])
    asked, extremes = posed(table_of(folder, "sweep")).words, table_of(folder, "extremes")
    wrong = failures(extremes)[["case", "source", "reason", "remedy"]]
    along = ladder(folder)
    typical = along.loc[along["set"] == TYPICAL, ["method", "value", "median_error"]]
    tables = {
        f"The paper's cases ({asked}); errors of the peak are relative, over those that survive": (
            swept(folder).drop(columns=["figure", "max_difference"])
        ),
        "Along the step, on typical cases and near overturning together": (
            joint(along).merge(typical, how="left", on=["method", "value"])
        ),
        "The cheapest setting below an error there, and the published one": places(along),
        "Verdicts on extreme cases": verdicts(extremes),
        "Of these failures, and the first setting that avoids each": wrong,
        "What each preset is helped by, and misses": helps(engine),
    }
    moments = table_of(folder, "moments")
    tables["The moment of a step at which its velocities hold, of which 1 is the end"] = judged(
        moments
    )
    tables |= beyond(folder)
    wrongs = accusation(moments), suspicion(moments)
    said = " ".join(filter(None, (*wrongs, introduction(engine), finding(folder))))
    return tell(STUDY, folder, tables, said)


def scored(source: str) -> Engine:
    """Return an engine, with one of its presets alone where that is named.

    Raises
    ------
    ValueError
        If it has no such preset.
    """
    name, colon, preset = source.partition(":")
    engine = ENGINES[name]
    return replace(engine, presets=(engine.preset(preset),)) if colon else engine


def finding(folder: Path) -> str:
    """Say how many outcomes are right with the best of its presets, and how far off peaks are."""
    order = ["agree", "max_error"]
    best = swept(folder).sort_values(order, ascending=[True, False], kind="stable").iloc[-1]
    return (
        f"{best['source']} gets {right_but(best, best['cases'])} outcomes right, "
        f"and peaks within {part(best['max_error'])}."
    )


def beyond(folder: Path) -> dict[str, pd.DataFrame]:
    """Return by title the errors in each further scene that the engine holds."""
    paths = {name: folder / f"score-{name}.csv" for name in SCENES}
    return {
        SCENES[name].title.capitalize(): lines_of(path, name)
        for name, path in paths.items()
        if path.is_file()
    }


def swept(folder: Path) -> pd.DataFrame:
    """Return the lines of all figures together, one for each preset."""
    return summarize(with_reference(table_of(folder, "sweep")).assign(figure="all"))


def ladder(folder: Path) -> pd.DataFrame:
    """Return errors and times of each method and setting; see `work_precision`."""
    return work_precision(with_errors(table_of(folder, "steps")))


def published() -> pd.DataFrame:
    """Return the published table of the same; FolderError if it was edited."""
    check(PUBLISHED, [LADDER], "the published folder")
    return pd.read_csv(PUBLISHED / LADDER)


def table_of(folder: Path, name: str) -> pd.DataFrame:
    """Return one of the tables of a score.

    Parameters
    ----------
    folder : Path
    name : str
        sweep, steps, extremes or moments.

    Raises
    ------
    FileNotFoundError
        If the folder has no such table.
    """
    return read_table(folder / f"score-{name}.csv")


def introduction(engine: Engine) -> str:
    """Say which engine this is, and what it can do."""
    versions = [f"{name} {provenance.version_of(name)}" for name in engine.packages]
    return (
        f"{engine.title}{f' ({listed(versions)})' if versions else ''}, in "
        f"{engine.precision.name.lower()} precision, "
        f"{'in space' if engine.spatial else 'in the plane'}; frames {listed(engine.frames)}, "
        f"geometries {listed(engine.geometries)}; beyond one body "
        f"{listed([ability.value for ability in engine.abilities])}."
    )


def places(along: pd.DataFrame) -> pd.DataFrame:
    """Return, for each error, the cheapest setting of this engine and of the published ones."""
    among = {"this engine": joint(along), "published": joint(engines_of(published()))}
    return pd.DataFrame(
        {"error": target, "among": whose, **best}
        for target in TARGETS
        for whose, lines in among.items()
        if (best := cheapest_below(lines, target)) is not None
    )


def helps(engine: Engine) -> pd.DataFrame:
    """Return what each preset is helped by, and what the library's defaults are known to miss."""
    return pd.DataFrame(
        {"preset": preset.name, "is": word, "what": what.value}
        for preset in engine.presets
        for word, named in (("helped by", preset.helped_by), ("misses", preset.deviations))
        for what in named
    )
