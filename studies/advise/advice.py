"""Which published setting of an engine keeps an error at the least cost, and how it is set."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from textwrap import fill, indent
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import pandas as pd
from cyclopts import Parameter

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES
from engines.declaration import Preset, Stepping
from engines.settings import given
from studies.advise import symptoms as seen
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
from studies.kit.options import Running, check_written
from studies.kit.say import WIDTH, as_text, duration, listed, out_of
from studies.kit.scene_options import Height, Width, block_of
from studies.kit.store import engines_of, provenance_of
from studies.kit.study import Study, Tables
from studies.kit.tables import read_table
from studies.measures import published as known
from studies.measures.costs import OUTDATED, STEPPED
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.finer import cheapest_kept
from studies.measures.formulas import by_step
from studies.measures.presets import look_of, uses_of
from studies.measures.published import TARGETS, options_at, too_slippery
from studies.sources.registry import scene_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXTREME = "stability/stability.csv"
"""Cases that a setting is not chosen by."""
TABLES = (known.LADDER, *known.PAPER, EXTREME)
"""Tables without which there is no advice."""
NONE_FOUND: Row = {
    **dict.fromkeys(("value", "dt_s", "wall_s", "max_error"), math.nan),
    **dict.fromkeys(("runs", "cases", *known.COUNTS, "extreme_cases", "extreme_off"), 0),
}
"""Columns about a setting, where there is none."""
USE = ["target", "engine", "preset"]


def command(
    *,
    error: Annotated[tuple[Positive, ...], several] = TARGETS,
    engines: Annotated[Engines | None, Parameter(name=("--engines", "--engine"))] = None,
    symptoms: bool = False,
    dt: Positive | None = None,
    friction: NotNegative | None = None,
    width: Width = 0.5,
    height: Height = 1.5,
    published: Place | None = None,
    out: Place | None = None,
) -> int:
    """Name the cheapest setting of every engine with which all published cases keep an error.

    For each engine and preset the cheapest step that keeps the error with every finer one: on the
    24 cases along all steps, on the paper's with each preset as it is declared, and on random cases
    where κ is small. Beside it stands how many random and extreme cases are off there. It runs
    nothing: it reads the published tables.

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
    dt
        Your step [s], instead of errors: which error each preset with equal steps keeps with it,
        and its settings as formulas of the step DT, with their values. Beside --symptoms the step
        for which settings are written out; by default the library's own.
    friction
        Coefficient of friction for which settings are written out: some, as MuJoCo's impratio,
        belong to it. By default 0.8, beside --symptoms the library's own. The errors were measured
        with the presets' own.
    published
        Folder of the published tables; by default those that come with this project.
    out
        Folder for the table and its figure; none by default.
    """
    refuse_repeats("--error", error)
    check_written(dt)
    beside = {"error": None if error is TARGETS else error[0]}
    if symptoms:
        refuse_given(beside, "only without --symptoms")
    elif dt is not None:
        refuse_given({**beside, "out": out}, "only without --dt")
    block, names = block_of(width, height), seen.TABLES if symptoms else TABLES
    folder = known.published_in(published, names)
    asked = engines or tuple(known.along_steps(folder, list(ENGINES))["engine"].unique())
    at = 0.8 if friction is None else friction
    with as_bad_input():
        if symptoms:
            tables = {"symptoms": seen.find(folder, asked, block, dt, friction)}
            written = seen.write(tables["symptoms"])
        elif dt is None:
            tables = {"advice": find(folder, asked, error, block)}
            written = write(tables["advice"], block, at)
        else:
            tables = {"step": find_errors(folder, asked, block, dt)}
            written = write(tables["step"], block, at)
        alone = "Of one --engine alone its settings are written out, too, in the library's words."
        details = list(written) if len(asked) == 1 else [alone]
    if out is None:
        print(as_text(finding(tables), shown(tables)))
    else:
        how = {"dt": dt, "friction": friction} if symptoms else {"error": error}
        size = {"width": width, "height": height}
        study = replace(STUDY, name="symptoms" if symptoms else "advise", tabulate=lambda _: tables)
        study.carry_out(out, [], Running(), engines=asked, **size, **how)
    notes = [too_slippery(friction if symptoms else at), made(folder, names, asked)]
    about = {"advice": f"{STEPPED} {OUTDATED}", "step": "", "symptoms": seen.HALVES}
    notes += [about[name] for name in tables]
    print()
    print(*details, *(fill(note, WIDTH) for note in notes if note), sep="\n\n")
    return 0


def find(
    published: Path, engines: Sequence[str], targets: Sequence[float], block: RigidBlock
) -> pd.DataFrame:
    """Return the columns of advice.csv: for each error, engine and preset its cheapest setting.

    A setting counts if it keeps the error with every finer one: a coarse step may be lucky. Extreme
    cases are counted where they were run with the very setting.
    """
    settings, runs = known.settings(published, engines), known.random_runs(published)
    extreme = read_table(published / EXTREME)
    # neither rocking that is too small to be seen, nor what has no reference
    extreme = extreme[~extreme["verdict"].isin(("unseen", "invalid"))]
    rows: list[Row] = []
    for target in targets:
        table = known.counted(settings, runs, target)
        for engine, preset in ((name, use) for name in engines for use in uses_of(name)):
            mine = table[(table["engine"] == engine) & (table["preset"] == preset.name)]
            row = {"target": target, "engine": engine, "preset": preset.name, **NONE_FOUND}
            best = cheapest_kept(mine, keeps(mine, target))
            rows.append({**row, "message": "" if best is not None else why(mine, preset, target)})
            if best is None:
                continue
            value = float(best["value"])
            own = math.nan if preset.accuracy_knob else preset.step_s
            at = own if preset.accuracy_knob or math.isnan(value) else value / block.p
            rows[-1] |= {**{name: best[name] for name in row if name in best}, "dt_s": at}
            if np.array_equal(value, known.declared_value(preset), equal_nan=True):
                source = engine if preset is ENGINES[engine].best else f"{engine}:{preset.name}"
                told = extreme[extreme["source"] == source]
                off = (told["outcome"] != told["exact_outcome"]) | (told["error"].abs() > target)
                rows[-1] |= {"extreme_cases": len(told), "extreme_off": int(off.sum())}
    lines = pd.DataFrame(rows)
    least = lines.groupby(USE[:2])["wall_s"].transform("min")
    return lines.assign(cheapest=lines["wall_s"] == least)


def keeps(settings: pd.DataFrame, target: float) -> pd.Series[bool]:
    """Return which settings keep an error by themselves, whatever finer ones do."""
    return (settings["max_error"] <= target) & (settings["random_calm_off"] == 0)


def why(settings: pd.DataFrame, preset: Preset, target: float) -> str:
    """Say what keeps the settings of a preset, from coarse to fine, from keeping an error."""
    if settings.empty:
        return "it is not in the published tables"
    if not np.isfinite(settings["max_error"]).any():
        return "an outcome is wrong at every step"
    alone = keeps(settings, target)
    missing = settings[~alone] if alone.any() else settings.sort_values("max_error").head(1)
    first = "at best"
    if alone.any():
        first = f"{name_of(preset, settings.loc[alone, 'value'].iloc[-1])} keeps it, but"
    line = missing.iloc[-1]
    at, error = name_of(preset, line["value"]), float(line["max_error"])
    if math.isinf(error):
        return f"{first} an outcome is wrong at {at}"
    if error > target:
        return f"{first} the error is {100.0 * error:.3g} % at {at}"
    off, calm = out_of(line["random_off"], line["random_cases"]), line["random_calm_off"]
    small = f"{calm:.0f} of them with κ < {WELL_CONDITIONED:g}"
    return f"{first} {off} random cases are off at {at}, {small}"


def name_of(preset: Preset, value: float) -> str:
    """Return a setting in words: its p dt, its accuracy knob, or the library's own step."""
    if math.isnan(value):
        return "its own step"
    return f"{preset.accuracy_knob[0] if preset.accuracy_knob else 'p dt'} = {value:g}"


def preset_of(line: Mapping[Any, Any] | pd.Series[Any]) -> Preset:
    """Return the preset of a line of a table."""
    return ENGINES[str(line["engine"])].preset(str(line["preset"]))


def made(published: Path, names: Sequence[str], engines: Sequence[str]) -> str:
    """Say from which published tables an answer follows, and with which versions they were made."""
    versions = engines_of(provenance_of((published / names[0]).parent))
    packages = [package for name in engines for package in ENGINES[name].packages]
    kept = [f"{name} {versions[name]}" for name in packages if name in versions]
    tables = [*names, *([known.RANDOM] if EXTREME in names else [])]
    found = [name for name in tables if (published / name).is_file()]
    return f"From {listed(found)}, made with {listed(kept)}."


def finding(tables: Tables) -> str:
    """Say which engine keeps the smallest error at the least cost, or what a step or setting is."""
    if "symptoms" in tables:
        return seen.finding(tables["symptoms"])
    if "step" in tables:
        line = tables["step"].iloc[0]
        return f"A step of {line['dt_s']:g} s is p dt = {line['value']:.3g} for your block."
    lines = tables["advice"]
    kept = lines[lines["message"] == ""]
    if kept.empty:
        return f"No published setting keeps an error of {100.0 * lines['target'].max():g} %."
    best = kept[kept["target"] == kept["target"].min()].nsmallest(1, "wall_s").iloc[0]
    return (
        f"{ENGINES[best['engine']].title} ({look_of(best['preset']).short}) keeps an error of "
        f"{100.0 * best['target']:g} % at the least cost, {duration(best['wall_s'])} a case."
    )


def shown(tables: Tables) -> Mapping[str, pd.DataFrame]:
    """Return what each error costs at the least, what keeps it, and which one no setting keeps."""
    if "symptoms" in tables:
        return seen.shown(tables["symptoms"])
    if "step" in tables:
        title = (
            "Largest error of the peak in published cases at the next coarser published p dt and "
            "every finer one,\nfor presets with equal steps (inf: an outcome is wrong)"
        )
        return {title: tables["step"].drop(columns=["dt_s", "value"])}
    lines = tables["advice"]
    found = lines["message"] == ""
    helped = pd.Series([bool(preset_of(line).helped_by) for _, line in lines.iterrows()])
    costs = [
        of.nsmallest(1, "wall_s").assign(settings=words)
        for words, among in (("any", found), ("the library's own", found & ~helped))
        for _, of in lines[among].groupby("target", sort=False)
    ]
    return {
        "The least cost of each error, with any setting and with a library's own alone": (
            pd.concat([lines[:0], *costs]).reindex(
                columns=["settings", *USE, "value", "wall_s", "runs"]
            )
        ),
        "The cheapest setting that keeps each error with every finer one (value: p dt, or an "
        "engine's own accuracy;\ndt_s for your block), and how many random and extreme cases are "
        "off at this very setting": lines[found].drop(columns=["random_calm_off", "message"]),
        "The largest error that no setting of a preset keeps, and why": (
            lines.loc[~found, [*USE, "message"]].drop_duplicates(USE[1:])
        ),
    }


def figures(tables: Tables) -> Mapping[str, Figure]:
    """Draw the time of a case with each preset that keeps an error, or the size of symptoms."""
    from studies.drawing.advise import draw_advice, draw_symptoms

    drawings = {"advice": draw_advice, "symptoms": draw_symptoms}
    return {name: drawings[name](table, finding(tables)) for name, table in tables.items()}


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
        "symptoms": "What users of an engine see, a panel for each symptom, a row for each engine, "
        "its size on a logarithmic scale: as documented, with the one setting that helps most, "
        "with all of a contact tuned at equal steps, and with steps that land on impacts.",
    },
)


def find_errors(
    published: Path, engines: Sequence[str], block: RigidBlock, dt_s: float
) -> pd.DataFrame:
    """Return for each preset with equal steps the largest errors at the next coarser step [s].

    Columns: engine, preset, dt_s; value, its p dt; coarser, p dt of the finest published step that
    is no finer, nan where there is none; and for both sets of cases the largest error of the peak
    at it and every finer published step, inf where an outcome is wrong.
    """
    table, value = pd.read_csv(published / known.LADDER), dt_s * block.p
    table["max_error"] = table["max_error"].where(table["failed"] == 0, math.inf)
    lines = []
    for engine, use in ((name, use) for name in engines for use in uses_of(name)):
        if use.stepping is Stepping.FIXED:
            mine = table[table["method"] == f"{engine} {use.name}"]
            at = mine.loc[mine["value"] >= value * (1.0 - 1e-9), "value"].min()
            worst = mine[mine["value"] <= at].groupby("set")["max_error"].max()
            line = {"engine": engine, "preset": use.name, "dt_s": dt_s, "value": value}
            sets = worst.reindex(["typical", "near overturning"])
            lines.append({**line, "coarser": at, **sets})
    return pd.DataFrame(lines)


def write(lines: pd.DataFrame, block: RigidBlock, friction: float) -> Iterator[str]:
    """Yield each setting of some lines in the library's words; for a given step as formulas, too.

    Raises
    ------
    ValueError
        If the engine does not take such a friction.
    """
    given_step = "message" not in lines
    found = lines if given_step else lines[lines["message"] == ""]
    for _, line in found.drop_duplicates(["engine", "preset", "value"]).iterrows():
        preset, value, dt_s = preset_of(line), float(line["value"]), float(line["dt_s"])
        here = "" if math.isnan(dt_s) else f", DT = {dt_s:.6g} s"
        title = f"{ENGINES[line['engine']].title}, {preset.title}"
        head = f"{title}, {name_of(preset, value)}{here}, friction {friction:g}"
        at = partial(in_library_words, line, block, friction)
        parts = [at(value)]
        if given_step:
            try:
                parts.insert(0, by_step(lambda step_s: at(step_s * block.p)))  # noqa: B023
            except ValueError:  # a number that follows the step otherwise than as a power of it
                head = f"{head}; at another step other numbers"
        texts = [indent(each, "  ") for each in dict.fromkeys(parts)]
        yield f"{head}\n" + "\nthat is\n".join(texts)


def in_library_words(line: pd.Series[Any], block: RigidBlock, friction: float, value: float) -> str:
    """Return the settings of a line's preset at a value, a line each."""
    engine, preset = ENGINES[line["engine"]], preset_of(line)
    motion, options = SinePulse(amplitude=1.0, omega=1.0), options_at(preset, value)
    scene = scene_of(block, motion, preset.name, friction=friction, **options)
    use = engine.use(scene)
    dt_s, chosen = use.dt_s, use.settings
    if engine.script is not None and engine.installed:
        lines = list(engine.script(scene, chosen, dt_s).settings)
    else:
        named = ", ".join(f"{name}={each!r}" for name, each in given(asdict(chosen)).items())
        lines = [f"a step of {dt_s!r} s, and in this project's names", named]
    if helps := "; ".join(each.value for each in preset.helped_by):
        lines.append(f"and at every step, by no setting of the library: {helps}")
    return "\n".join(lines)
