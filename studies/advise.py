"""Which lines to paste so that a body of one's own rocks right, and what they are worth."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from functools import cache
from itertools import islice
from pathlib import Path
from textwrap import wrap
from typing import Annotated, Any, TypeAlias, cast

import pandas as pd
from cyclopts import Parameter

from analytic import RigidBlock, SinePulse, conditioning, sensitivity, simulate
from engines import ENGINES
from engines.declaration import AT_REST, PASTED
from engines.factors import DEFAULT
from engines.registry import OWN
from engines.run.run import YAW
from studies.cases.drawn import Kind, free_boxes
from studies.kit import arguments
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.say import aligned, as_text, duration, out_of, part
from studies.kit.scene_options import Height, Width, block_of
from studies.kit.store import check
from studies.kit.study import Study, Tables, stages
from studies.kit.tables import table_in
from studies.measures import published as known
from studies.measures.costs import cheapest_kept
from studies.measures.differences import WELL_CONDITIONED, beside, sensitivity_of
from studies.measures.presets import pasted_of
from studies.measures.wrongness import KINDS, counted, in_kinds, wrong_in
from studies.sources.registry import scene_of

Line: TypeAlias = "Mapping[Any, Any]"
"""A line of a table."""
SEED, FRICTION = 55, 0.8
"""Of the random boxes."""
CASES: Mapping[Kind, tuple[int, int]] = {"pulse": (60, 10), "record": (20, 1), "lean": (20, 3)}
"""How many boxes in full, and quickly, by what moves them."""
IN_WORDS = {"pulse": "under pulses", "record": "under a record", "lean": "let go leaning"}
"""What moves a box, in words."""
STEPS_S = 1e-3, 2e-3
"""A user's step [s]; the second where the first is the library's own."""
BLOCK = RigidBlock(width=0.5, height=1.5)
"""Of which lines are published."""
ROWS = 24
"""Of a screen."""
ADVICE, LINES, BY_KIND = "advice", "lines", "kinds"
SETTING = "engine", "dt_s", "preset"
"""Columns that tell one setting from another."""
NEEDED = tuple(f"advice/{name}.csv" for name in (ADVICE, LINES, BY_KIND))
"""The tables of advice."""


def command(
    *,
    engines: Annotated[arguments.Engines | None, Parameter(name=("--engines", "--engine"))] = None,
    dt: arguments.Positive | None = None,
    friction: arguments.NotNegative = FRICTION,
    width: Width = BLOCK.width,
    height: Height = BLOCK.height,
    error: Annotated[tuple[arguments.Positive, ...], arguments.several_or_none] = (),
    out: arguments.Place | None = None,
    quick: bool = False,
    running: arguments.Running = arguments.Running(),  # noqa: B008
) -> int:
    """Print the lines with which a free box on a floor at rest rocks accurately, and their errors.

    For one engine it prints the lines to paste, their errors on 60 random boxes, where they fail,
    and their sources; for several engines the errors only. It reads the published tables, and runs
    nothing. With --out it measures them again, in an hour.

    Parameters
    ----------
    engines
        Names of engines, without a preset; by default all.
    dt
        Your step [s]; by default the library's own.
    friction
        Your coefficient of friction between box and floor.
    error
        Print instead the cheapest setting of each preset with relative errors below these values
        in all published cases, at its step and at every finer one.
    out
        Folder for the tables of a new run; none by default.
    quick
        With --out: 14 boxes instead of 100.
    """
    asked = engines or tuple(OWN)
    if out is not None:
        return STUDY.carry_out(out, jobs(asked, quick), running, engines=asked, quick=quick)
    arguments.refuse_given({"quick": quick or None}, "only with --out")
    block = block_of(width, height)
    if error:
        arguments.refuse_repeats("--error", error)
        check(known.PUBLISHED, (known.LADDER, *known.PAPER), "the published tables")
        found = cheapest(known.PUBLISHED, asked, error, block)
        title = "The cheapest setting that keeps each error, with every finer step (value: p dt, or"
        print(as_text("", {f"{title}\nan accuracy; dt_s for your block)": found}).strip())
        return 0
    check(known.PUBLISHED, NEEDED, "the published tables")
    if len(asked) == 1:
        own = ENGINES[asked[0]].preset(AT_REST).step_s
        with arguments.as_bad_input():
            print(*screen(asked[0], block, dt or own, friction), sep="\n")
        return 0
    advice = table_in(known.PUBLISHED / "advice", ADVICE)
    mine = {ADVICE: advice[advice["engine"].isin(asked)]}
    print(as_text(finding(mine), shown(mine)))
    print("\nWith one --engine: the lines to paste, in the library's words.")
    return 0


def jobs(engines: Sequence[str], quick: bool) -> list[Job]:
    """Return the jobs: engine by engine, at its own step and a user's, by default and pasted."""
    boxes = [
        box
        for kind, counts in CASES.items()
        for box in islice(free_boxes(SEED, kind), counts[quick])
    ]
    return [
        Job(
            labels={"engine": engine, "preset": preset, "dt_s": dt_s, **asdict(box)},
            case=Question(system=box.block, motion=box.shaking, start=box.start),
            source=f"{engine}:{preset}",
            options={"friction": FRICTION, "step": dt_s * box.block.p},
        )
        for engine in engines
        for dt_s in steps_of(engine)
        for preset in (AT_REST, pasted_of(engine))
        for box in boxes
    ]


def steps_of(engine: str) -> tuple[float, float]:
    """Return the library's own step and a user's [s]."""
    own, (usual, other) = ENGINES[engine].preset(AT_REST).step_s, STEPS_S
    return own, other if own == usual else usual


def measure(job: Job) -> Row:
    """Return the columns of a row, with how far a box slid and turned, and the exact answer."""
    response = ask(job)
    slid, yaw = response.slip_m / job.case.system.width, response.observables.get(YAW, math.nan)
    return {**summary(response), "slip_widths": slid, "yaw_deg": yaw, **_exact(job.case)}


@cache  # one for all sources
def _exact(case: Question) -> Row:
    block = cast(RigidBlock, case.system)
    exact = simulate(block, case.motion, start=case.start)
    kappas = conditioning(block, case.motion, start=case.start)
    return {
        **dict(zip(("kappa", "kappa_eta"), kappas, strict=True)),
        "sensitivity": sensitivity(block, case.motion, start=case.start),
        "exact_peak": exact.peak_ratio,
        "exact_outcome": exact.outcome.value,
    }


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the rows with their errors, a line for each setting, and lines to paste."""
    boxes = beside(rows)
    advice = _lines(boxes[boxes["kind"] == "pulse"], *SETTING)
    lines = [
        {"engine": engine, "dt_s": dt_s, "literal": line}
        for engine, dt_s in advice[["engine", "dt_s"]].drop_duplicates().itertuples(index=False)
        for line in pasted_lines(engine, BLOCK, dt_s, FRICTION)
    ]
    tables = {"boxes": boxes, ADVICE: advice, BY_KIND: _lines(boxes, *SETTING, "kind")}
    return {**tables, LINES: pd.DataFrame(lines)}


def _lines(boxes: pd.DataFrame, *keys: str) -> pd.DataFrame:
    groups = boxes.groupby([*keys], sort=False)
    return pd.DataFrame([dict(zip(keys, key, strict=True)) | _line(of) for key, of in groups])


def _line(group: pd.DataFrame) -> Row:
    sizes, parts = group["error"].abs(), group["difference"].abs()
    calm, both = sensitivity_of(group) < WELL_CONDITIONED, sizes.notna()
    return {
        **{"cases": len(group), **counted(wrong_in(group)), "survivors": int((calm & both).sum())},
        **{"median_error": sizes[calm].median(), "max_error": sizes[calm].max()},
        **{"median_difference": parts[calm].median(), "max_difference": parts[calm].max()},
        **{"ill": int((both & ~calm).sum()), "ill_max_error": sizes[~calm].max()},
        **{name: group.loc[both, name].max() for name in ("yaw_deg", "slip_widths")},
        "wall_s": group["wall_s"].mean(),
    }


def pairs(advice: pd.DataFrame) -> Iterator[tuple[str, float, Line, Line]]:
    """Yield an engine, a step [s], and the lines of its defaults and of what is pasted."""
    lines = advice.to_dict("records")
    for before, after in zip(lines[::2], lines[1::2], strict=True):
        yield str(before["engine"]), float(before["dt_s"]), before, after


def worse(before: Line, after: Line) -> list[str]:
    """Say by how much pasted lines are no better: in the median, the largest error, outcomes."""
    columns = {"median_error": "the typical error", "max_error": "the largest error"}
    said = [
        f"{words} goes from {100 * before[name]:.3g} % to {100 * after[name]:.3g} %"
        for name, words in columns.items()
        if not after[name] < before[name]
    ]
    wrong = [sum(line[kind] for kind in KINDS) for line in (before, after)]
    more = [f"wrong outcomes go from {wrong[0]} to {wrong[1]}"] if wrong[1] > wrong[0] else []
    return said + more


def unadvised(advice: pd.DataFrame) -> dict[str, str]:
    """Return why a setting is not advised, of each engine where it is not."""
    found: dict[str, list[str]] = {}
    for engine, dt_s, before, after in pairs(advice):
        if words := worse(before, after):
            found.setdefault(engine, []).append(f"at {dt_s:.3g} s {' and '.join(words)}")
    return {engine: "; ".join(words) for engine, words in found.items()}


def finding(tables: Tables) -> str:
    """Say for how many engines pasted lines lower the errors, and from what to what."""
    advice = tables[ADVICE]
    engines, bad = advice["engine"].unique(), unadvised(advice)
    ends = [[each["median_error"] for each in (old, new)] for *_, old, new in pairs(advice)]
    before, after = pd.DataFrame(ends).median()
    return (
        f"Pasted lines lower the errors of a free box in "
        f"{out_of(len(engines) - len(bad), len(engines))} engines at both steps; its median error "
        f"falls from {part(before)} to {part(after)}."
    )


def shown(tables: Tables) -> Tables:
    """Return what pasted lines are worth, and which are not advised."""
    columns = ["engine", "dt_s", "preset", *KINDS, "median_error", "max_error", "ill_max_error"]
    bad = unadvised(tables[ADVICE])
    return {
        "Random boxes, under pulses, friction 0.8; ill_max_error where S ≥ 10": tables[ADVICE][
            [*columns, "yaw_deg", "slip_widths", "wall_s"]
        ],
        "By what moves the box, all engines": by_kind(tables[BY_KIND]),
        "Not advised": pd.DataFrame({"engine": [*bad], "why": [*bad.values()]}),
    }


def by_kind(kinds: pd.DataFrame) -> pd.DataFrame:
    """Return outcomes and the typical engine's errors before and after, by what moves a box."""
    before = kinds["preset"].eq(AT_REST).map({True: DEFAULT, False: PASTED})
    wrong = kinds[list(KINDS)].sum(axis=1)
    groups = kinds.assign(settings=before, wrong=wrong).groupby(["kind", "settings"], sort=False)
    return groups.agg(
        cases=("cases", "sum"),
        wrong=("wrong", "sum"),
        median_error=("median_error", "median"),
        max_error=("max_error", "median"),
    ).reset_index()


def pasted_lines(engine: str, block: RigidBlock, dt_s: float, friction: float) -> list[str]:
    """Return what is set for pasting and not by default, in the library's words, recorded."""
    declared, found = ENGINES[engine], list[list[str]]()
    if declared.script is None or not declared.installed:
        return [f"{declared.title} writes its lines where it is installed"]
    pulse = SinePulse(amplitude=1.0, omega=1.0)
    for preset in (AT_REST, pasted_of(engine)):
        options = {"friction": friction, "step": dt_s * block.p}
        use = declared.use(scene_of(block, pulse, preset, **options))
        text = "\n".join(declared.script(use.scene, use.settings, use.dt_s).settings)
        text = re.sub(r"\n +", " ", text)
        found.append(re.sub(r" mass=[0-9.]+,", "", text).split("\n"))  # a reader's has its own
    return [line for line in found[1] if line not in found[0]]


def screen(engine: str, block: RigidBlock, dt_s: float, friction: float) -> list[str]:
    """Return a screen about an engine: lines to paste, their worth, where they fail, sources."""
    use = ENGINES[engine].preset(pasted_of(engine))
    advice = table_in(known.PUBLISHED / "advice", ADVICE)
    advice = advice[advice["engine"] == engine]
    below = ["No published table says what that is worth."]
    if len(advice):
        boxes = f"{advice['cases'].max()} random boxes, friction {FRICTION:g}"
        below = [f"{boxes}; errors of the {advice['survivors'].max()} survivors with S < 10:"]
        below += worth(advice).splitlines()
        below += _filled("NOT ADVISED", unadvised(advice).get(engine, ""))
        kinds = table_in(known.PUBLISHED / "advice", BY_KIND)
        below += _filled("Fails", fails(kinds[kinds["engine"] == engine]))
    sources = [f"{it.setting}: {it.value} ({it.where})" for it in use.documented]
    below += _filled("Sources", "; ".join(sources) or "measured here, `rocking contact`")
    below += _filled("YOUR FLOOR MOVES", moving(engine))
    where = f"steps of {dt_s:.4g} s, friction {friction:g}"
    lines = [
        f"  {row}"
        for line in pasted_lines(engine, block, dt_s, friction)
        for row in wrap(line, 77, subsequent_indent="    ")
    ]
    room = ROWS - 1 - len(below)
    if len(lines) > room:
        more = (
            f"  and {len(lines) - room + 1} more rows: rocking export --engine {engine}:{use.name}"
        )
        lines = [*lines[: room - 1], more]
    return [*_filled("YOUR FLOOR RESTS", f"{engine}:{use.name}, {where}. Paste:"), *lines, *below]


def _filled(head: str, text: str) -> list[str]:
    return wrap(f"{head}: {text}", 79, subsequent_indent="  ") if text else []


def worth(advice: pd.DataFrame) -> str:
    """Return a table of errors before and after."""
    heads = ["  step", "settings", "typical", "worst", "wrong", "S ≥ 10", "turns", "a case"]
    cells = [
        [
            f"  {line['dt_s']:.3g} s",
            PASTED if line["preset"] != AT_REST else DEFAULT,
            *(part(line[name]) for name in ("median_error", "max_error")),
            str(sum(line[kind] for kind in KINDS) or "-"),
            part(line["ill_max_error"]),
            "-" if math.isnan(line["yaw_deg"]) else f"{line['yaw_deg']:.2g}°",
            duration(line["wall_s"]),
        ]
        for line in advice.to_dict("records")
    ]
    return aligned([heads, *cells], [False, False, *[True] * 6])


def fails(kinds: pd.DataFrame) -> str:
    """Say where pasted lines still fail."""
    lines = kinds[kinds["preset"] != AT_REST]
    found = [
        f"{in_kinds(of[list(KINDS)].sum())} {IN_WORDS[str(kind)]}"
        for kind, of in lines.groupby("kind", sort=False)
    ]
    slid = f"the pivot slides by up to {part(lines['slip_widths'].max())} of B"
    plane = "; the library is planar" if lines["yaw_deg"].isna().all() else ""
    return f"{'; '.join(found)}; {slid}{plane}"


def moving(engine: str) -> str:
    """Say by how much the defaults err on a floor that moves, and on one at rest."""
    table = table_in(known.PUBLISHED / "presets", "summary")
    table = table[table["figure"] == "all"].set_index("source")
    names = [f"{engine}:{preset}" for preset in (DEFAULT, AT_REST)]
    if not set(names) <= set(table.index):
        return ""
    (moves, rests), cases = table.loc[names, "median_error"], table["cases"].max()
    return (
        f"the defaults err by {part(moves)} in the median of {cases:.0f} cases of the paper, "
        f"on a floor at rest by {part(rests)}. Let the floor rest, and add -a to gravity."
    )


def cheapest(
    published: Path, engines: Sequence[str], errors: Sequence[float], block: RigidBlock = BLOCK
) -> pd.DataFrame:
    """Return for each error, engine and preset the cheapest published setting that keeps it."""
    rows: list[Row] = []
    for error in errors:
        for _, mine in known.settings(published, engines).groupby(known.SETTING[:2], sort=False):
            engine, name, *_ = mine.iloc[0]
            preset = ENGINES[engine].preset(name)
            if (best := cheapest_kept(mine, mine["max_error"] <= error)) is None:
                continue
            own = math.nan if preset.accuracy_knob else preset.step_s
            value = float(best["value"])
            dt_s = own if preset.accuracy_knob or math.isnan(value) else value / block.p
            row = {"target": error, "engine": engine, "preset": name, "value": value, "dt_s": dt_s}
            rows.append(row | {n: best[n] for n in ("wall_s", "runs", "cases", "max_error")})
    return pd.DataFrame(rows)


STUDY = Study(
    name="advise",
    question="Which lines make a free box on a floor at rest rock accurately?",
    help="Random boxes of six degrees of freedom, at each library's own step and at 1 ms.",
    jobs=lambda *_: (),
    texts=("literal",),
    **stages(measure, tabulate, finding, shown),
)
