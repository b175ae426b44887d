"""Which published setting keeps an error at the least cost, and what halves a symptom."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from textwrap import fill, indent
from typing import Annotated

import pandas as pd
from cyclopts import Parameter

from analytic.block import RigidBlock
from engines import ENGINES
from engines.declaration import Preset
from studies.advise import symptoms as seen
from studies.advise.symptoms import settings_in_words
from studies.kit.arguments import (
    Engines,
    NotNegative,
    Place,
    Positive,
    as_bad_input,
    refuse_given,
    refuse_repeats,
    several,
)
from studies.kit.jobs import Row
from studies.kit.options import Running
from studies.kit.say import WIDTH, as_text, duration
from studies.kit.scene_options import Height, Width, block_of
from studies.kit.store import check
from studies.kit.study import Figures, Study, Tables
from studies.measures import published as known
from studies.measures.costs import RETIRED, STEPPED, cheapest_kept
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.presets import look_of, uses_of
from studies.measures.published import PUBLISHED, TARGETS, options_at

TABLES = (known.LADDER, *known.PAPER, known.RANDOM)
NONE_FOUND: Row = {
    **dict.fromkeys(("value", "dt_s", "wall_s", "max_error"), math.nan),
    **dict.fromkeys(("runs", "cases", *known.COUNTS), 0),
}
"""Columns about a setting, where there is none."""
OWN_FRICTION = "The errors were measured with each preset's own friction."


def command(
    *,
    error: Annotated[tuple[Positive, ...], several] = TARGETS,
    engines: Annotated[Engines | None, Parameter(name=("--engines", "--engine"))] = None,
    symptoms: bool = False,
    friction: NotNegative | None = None,
    width: Width = 0.5,
    height: Height = 1.5,
    out: Place | None = None,
) -> int:
    """Name the cheapest setting of every engine with which all published cases keep an error.

    For each engine and preset the cheapest step that keeps the error with every finer one: on the
    24 cases along all steps, on the paper's with each preset as it is declared, and on random cases
    where κ is small. Beside it stands how many random cases are off there. It runs nothing: it
    reads the published tables.

    Parameters
    ----------
    error
        Largest relative errors [-] of the peak rotation that are to be kept.
    engines
        Names of engines, without a preset, of those in the published tables. Of one alone the
        settings are written out.
    symptoms
        Instead, what users see (a block creeps, sinks, bounces, tips too early, ...): its size with
        the library's defaults, with the one setting that helps most, and with all that is tuned.
    friction
        Coefficient of friction for which settings are written out: some, as MuJoCo's impratio,
        belong to it. By default 0.8, beside --symptoms the library's own.
    out
        Folder for the table and the figure of advice; none by default.
    """
    refuse_repeats("--error", error)
    if symptoms:
        refuse_given({"error": None if error is TARGETS else error[0]}, "only without --symptoms")
    check(PUBLISHED, seen.TABLES if symptoms else TABLES, "the published tables")
    asked = engines or tuple(known.along_steps(PUBLISHED, list(ENGINES))["engine"].unique())
    block, note = block_of(width, height), OWN_FRICTION
    with as_bad_input():
        if symptoms:
            tables = {"symptoms": seen.find(asked)}
            written, note = seen.write(tables["symptoms"], block, friction), seen.HALVES
        else:
            tables = {"advice": find(asked, error, block)}
            written, note = write(tables["advice"], block, friction), f"{STEPPED} {RETIRED} {note}"
        alone = "With one --engine its settings are written out, too, in the library's words."
        details = list(written) if len(asked) == 1 else [alone]
    if out is None:
        print(as_text(finding(tables), shown(tables)))
    else:
        how = {"friction": friction} if symptoms else {"error": error}
        size = {"width": width, "height": height}
        study = replace(STUDY, name="symptoms" if symptoms else "advise", tabulate=lambda _: tables)
        study.carry_out(out, [], Running(), engines=asked, **size, **how)
    print()
    print(*details, fill(note, WIDTH), sep="\n\n")
    return 0


def find(engines: Sequence[str], targets: Sequence[float], block: RigidBlock) -> pd.DataFrame:
    """Return the columns of advice.csv: for each error, engine and preset its cheapest setting."""
    settings, runs = known.settings(PUBLISHED, engines), pd.read_csv(PUBLISHED / known.RANDOM)
    rows: list[Row] = []
    for target in targets:
        table = known.counted(settings, runs, target)
        for engine, preset in ((name, use) for name in engines for use in uses_of(name)):
            mine = table[(table["engine"] == engine) & (table["preset"] == preset.name)]
            row = {"target": target, "engine": engine, "preset": preset.name, **NONE_FOUND}
            best = cheapest_kept(mine, keeps(mine, target))
            if best is None:
                rows.append({**row, "message": why(mine, preset, target)})
                continue
            value = float(best["value"])
            own = math.nan if preset.accuracy_knob else preset.step_s
            at = own if preset.accuracy_knob or math.isnan(value) else value / block.p
            rows.append(row | {name: best[name] for name in NONE_FOUND if name in best})
            rows[-1] |= {"dt_s": at, "message": ""}
    lines = pd.DataFrame(rows)
    least = lines.groupby(["target", "engine"])["wall_s"].transform("min")
    return lines.assign(cheapest=lines["wall_s"] == least)


def keeps(settings: pd.DataFrame, target: float) -> pd.Series[bool]:
    """Return which settings keep an error by themselves, whatever finer ones do."""
    return (settings["max_error"] <= target) & (settings["random_calm_off"] == 0)


def why(settings: pd.DataFrame, preset: Preset, target: float) -> str:
    """Say how near to an error the settings of a preset come, from coarse to fine."""
    if settings.empty:
        return "it is not in the published tables"
    alone = settings[keeps(settings, target)]
    if len(alone):
        return f"{name_of(preset, alone['value'].iloc[-1])} keeps it, but not every finer one"
    best = settings.sort_values("max_error").iloc[0]
    error, calm = float(best["max_error"]), best["random_calm_off"]
    if math.isinf(error):
        return "an outcome is wrong at every step"
    off = f"; random cases with κ < {WELL_CONDITIONED:g} that are off: {calm}" if calm else ""
    return f"at best the error is {100.0 * error:.3g} % at {name_of(preset, best['value'])}{off}"


def name_of(preset: Preset, value: float) -> str:
    """Return a setting in words: its p dt, its accuracy knob, or the library's own step."""
    if math.isnan(value):
        return "its own step"
    return f"{preset.accuracy_knob[0] if preset.accuracy_knob else 'p dt'} = {value:g}"


def write(lines: pd.DataFrame, block: RigidBlock, friction: float | None) -> Iterator[str]:
    """Yield each setting of some lines in the library's words; ValueError of a bad friction."""
    at = 0.8 if friction is None else friction
    found = lines[lines["message"] == ""].drop_duplicates(["engine", "preset", "value"])
    for _, line in found.iterrows():
        preset, value = ENGINES[line["engine"]].preset(line["preset"]), float(line["value"])
        here = "" if math.isnan(line["dt_s"]) else f", DT = {line['dt_s']:.6g} s"
        title = f"{ENGINES[line['engine']].title}, {preset.title}"
        options = {"friction": at, "frame": "base", **options_at(preset, value)}
        parts = settings_in_words(line["engine"], preset.name, block, **options)
        if helps := "; ".join(each.value for each in preset.helped_by):
            parts += (f"and at every step, by no setting of the library: {helps}",)
        text = indent("\n".join(parts), "  ")
        yield f"{title}, {name_of(preset, value)}{here}, friction {at:g}\n{text}"


def finding(tables: Tables) -> str:
    """Say which engine keeps the smallest error at the least cost, or what one setting halves."""
    if "symptoms" in tables:
        return seen.finding(tables["symptoms"])
    lines = tables["advice"]
    kept = lines[lines["message"] == ""]
    if kept.empty:
        return f"No published setting keeps an error of {100.0 * lines['target'].max():g} %."
    best = kept[kept["target"] == kept["target"].min()].nsmallest(1, "wall_s").iloc[0]
    return (
        f"{ENGINES[best['engine']].title} ({look_of(best['preset']).short}) keeps an error of "
        f"{100.0 * best['target']:g} % at the least cost, {duration(best['wall_s'])} a case."
    )


def shown(tables: Tables) -> Tables:
    """Return the cheapest settings that keep each error, and what no setting keeps."""
    if "symptoms" in tables:
        return seen.shown(tables["symptoms"])
    lines, use = tables["advice"], ["target", "engine", "preset"]
    kept = lines[lines["message"] == ""]
    return {
        "The least cost of each error": (
            kept.sort_values("wall_s").drop_duplicates("target").sort_index()
        )[[*use, "value", "wall_s", "runs"]],
        "The cheapest setting that keeps each error with every finer one (value: p dt, or an "
        "engine's own accuracy;\ndt_s for your block), and how many random cases are off at this "
        "very setting": kept.drop(columns=["random_calm_off", "message"]),
        "The largest error that no setting of a preset keeps, and why": (
            lines.loc[lines["message"] != "", [*use, "message"]].drop_duplicates(use[1:])
        ),
    }


def figures(tables: Tables) -> Figures:
    """Draw the time of a case with each preset that keeps an error."""
    from studies.drawing.advise import draw_advice

    lines = tables.get("advice")
    return {} if lines is None else {"advice": draw_advice(lines, finding(tables))}


STUDY = Study(
    name="advise",
    question="Which setting of which engine for which accuracy?",
    help="It runs nothing: it reads the published tables.",
    jobs=lambda *_: (),
    tabulate=lambda _: {},
    finding=finding,
    shown=shown,
    figures=figures,
    texts=seen.TEXTS,
    captions={
        "advice": "Time of a case with each preset that keeps an error with every finer step, a "
        "panel for each error, a row for each engine; at the points their steps, p dt, or the "
        "accuracy of an engine's own.",
    },
)
