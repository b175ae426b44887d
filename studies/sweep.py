"""The paper's sensitivity analysis, figures 6 to 9: every case through every named source."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Annotated

import pandas as pd

from engines.factors import BEST
from studies.cases.paper import sweep_cases
from studies.kit import arguments
from studies.kit.jobs import Job, Question
from studies.kit.say import capital, listed, out_of, part
from studies.kit.study import Figures, Study, Tables, claim, stages
from studies.measures.differences import summarize, with_reference
from studies.measures.presets import engine_of, in_order, look_of, preset_of
from studies.measures.wrongness import KINDS
from studies.sources.registry import core_sources

WHICH = "Figures of the paper: 6, 7 (half-sine), 8, 9 (full-sine); all by default."


@dataclass(frozen=True, kw_only=True)
class Options(arguments.EffortOptions):
    """Which figures, and how finely the sources step."""

    figure: Annotated[tuple[int, ...], arguments.figures(WHICH, 6, 7, 8, 9)] = (6, 7, 8, 9)


MOST_DRAWN = 15
"""Sources that a figure of all cases still shows apart."""


def jobs(sources: Iterable[str], quick: bool, options: Options) -> list[Job]:
    """Return the jobs in the order of the table: case by case, source by source."""
    options.refuse_idle(sources := tuple(sources))
    effort = {source: options.options(source) for source in sources}
    return [
        Job(labels=labels, case=case, source=source, options=effort[source])
        for labels, case in [
            (asdict(case), Question(system=case.block, motion=case.motion))
            for case in sweep_cases(options.figure)
        ]
        for source in sources
    ]


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the rows, a line for each figure and source, and the paper's conclusions."""
    compared = with_reference(rows)
    found = pd.DataFrame([test(compared) for test in CONCLUSIONS])
    return {"sweep": rows, "summary": summarize(compared), "findings": found}


def over_all(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of a summary that are about all its figures."""
    lines: pd.DataFrame = summary[summary["figure"] == summary["figure"].iloc[-1]]
    return lines.reset_index(drop=True)


def preset_table(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each preset and engine: outcomes, errors of the peak, time of a case."""
    lines = lines.assign(preset=lines["source"].map(preset_of))
    groups = [lines[lines["preset"] == name] for name in in_order(lines["preset"]) if name]
    if not groups:
        return pd.DataFrame()
    found = pd.concat(groups, ignore_index=True)
    errors = {name: found[f"{name}_error"] for name in ("median", "p90", "max")}
    errors["share"] = found["median_difference"]
    named = found["source"].map(engine_of)
    found = found.assign(engine=named, right=found["agree"], **errors)
    found["ms"] = 1e3 * found["wall_s"] / found["cases"]
    return found[
        ["preset", "engine", "source", "right", *KINDS, "cases", "survivors", *errors, "ms"]
    ]


def finding(tables: Tables) -> str:
    """Say what engines predict with default, tuned and best settings, or what a model does."""
    lines = over_all(tables["summary"])
    presets = preset_table(lines)
    if len(presets):
        order, cases = in_order(presets["preset"]), presets["cases"].iloc[0]
        ends = [name for name in order if name in (order[0], BEST, order[-1])]
        known = presets.groupby("preset").agg({"right": "min", "max": "max"}).loc[ends]
        least = ["all" if n == cases else f"at least {n}" for n in known["right"]]
        least[0] += f"{' of' * (least[0] != 'all')} {cases} outcomes"
        words = listed(f"{n} {look_of(name).words}" for n, name in zip(least, ends, strict=True))
        errors = listed(map(part, known["max"]))
        return f"Engines predict {words}; their peaks err by up to {errors}."
    others = lines[lines["source"] != "exact"].sort_values("agree", kind="stable")
    if others.empty:
        return f"The exact solution gives the peaks of {lines['cases'].iloc[0]} cases."
    worst = others.iloc[0]
    return (
        f"{capital(str(worst['source']))} predicts {out_of(worst['agree'], worst['cases'])} "
        f"outcomes, and half of its peaks within {part(worst['median_error'])}."
    )


def shown(tables: Tables) -> Tables:
    """Return a line for each source, and the paper's conclusions."""
    columns = ["source", "cases", "agree", *KINDS, "median_error", "max_error"]
    return {
        "All figures": over_all(tables["summary"])[[*columns, "wall_s"]],
        "The paper's conclusions": tables["findings"][["holds", "statement"]],
    }


def figures(tables: Tables) -> Figures:
    """Draw figures 6 to 9 of a few sources; engines with several presets as an overview."""
    from studies.drawing.figures import draw_sweep
    from studies.drawing.rows import draw_overview

    compared = with_reference(tables["sweep"])
    lines = preset_table(over_all(tables["summary"]))
    several = len(lines) and lines["preset"].nunique() > 1
    wrong = lines.reindex(columns=KINDS).sum(axis=1)
    drawn = {"overview": draw_overview(lines.assign(wrong=wrong))} if several else {}
    if compared["source"].nunique() > MOST_DRAWN:
        return drawn
    each = compared.groupby("figure", sort=False)
    return drawn | {f"figure-{n}": draw_sweep(rows) for n, rows in each}


PAPER_PAIR = ("housner", "modified")


@claim("Housner's linearization overturns blocks that survive, even at H/B = 3", "housner")
def false_overturnings(compared: pd.DataFrame) -> tuple[bool, str]:
    """Count the falsely overturned, and look for them at H/B = 3."""
    housner = _of(compared, "housner")
    wrong = housner[housner["false_overturning"]]
    words = f"{len(wrong)} of {len(housner)} cases{_where(wrong)}"
    return bool((wrong["aspect"] >= 3).any()), words


@claim("The modified linearization never lets a block survive that overturns", "modified")
def missed_overturnings(compared: pd.DataFrame) -> tuple[bool, str]:
    """Count the overturnings that are missed."""
    modified = _of(compared, "modified")
    wrong = modified[modified["missed_overturning"]]
    return wrong.empty, f"{len(wrong)} of {len(modified)} cases missed{_where(wrong)}"


@claim("The modified linearization stays closer to the exact solution than Housner's", *PAPER_PAIR)
def modified_is_closer(compared: pd.DataFrame) -> tuple[bool, str]:
    """Compare the errors of both linearizations over what survives in both."""
    case = ["figure", "aspect", "width_m", "omega_over_p"]
    sizes = compared.assign(size=compared["error"].abs())
    both = sizes.pivot(index=case, columns="source", values="size")[[*PAPER_PAIR]].dropna()
    right, cases = compared.groupby("source")["agrees"].sum(), len(sizes.drop_duplicates(case))
    closer = int((both["modified"] < both["housner"]).sum())
    h, m = both.quantile([0.5, 0.9]).T.to_numpy()
    return (
        bool(m[0] < h[0] and closer > len(both) / 2),
        f"closer in {closer} of {len(both)} cases where all three survive; median error "
        f"{m[0]:.2%} against {h[0]:.2%}, p90 {m[1]:.2%} against {h[1]:.2%}; outcomes right in "
        f"{right['modified']} against {right['housner']} of {cases} cases",
    )


NEAR = "Both linearizations come close at high frequency (median error below 5 %, ω/p ≥ 3)"
SQUAT = "The smaller the aspect ratio, the larger Housner's error in the median of its figure"


@claim(NEAR, *PAPER_PAIR)
def agreement_at_high_frequency(compared: pd.DataFrame) -> tuple[bool, str]:
    """Look at the errors at high and at middle frequencies."""
    medians, words = [], []
    for name in PAPER_PAIR:
        rows = _of(compared, name)
        sizes = rows[["error", "difference"]].abs()
        high, apart = sizes[rows["omega_over_p"] >= 3.0].median()
        middle = sizes.loc[rows["omega_over_p"].between(0.5, 1.5), "error"].median()
        medians.append(high)
        words.append(
            f"{name} {high:.2%}, that is {apart:.4f} of θcr (at ω/p from 0.5 to 1.5: {middle:.2%})"
        )
    return max(medians) < 0.05, "; ".join(words)


@claim(SQUAT, "housner")
def squat_blocks_differ_more(compared: pd.DataFrame) -> tuple[bool, str]:
    """Look whether the median errors fall as blocks become slender."""
    housner = _of(compared, "housner")
    medians = housner["error"].abs().groupby([housner["figure"], housner["aspect"]]).median()
    table = medians.unstack("aspect")
    falling = bool((table.diff(axis=1).iloc[:, 1:] <= 0.0).all(axis=None))
    words = [
        f"figure {figure}: "
        + ", ".join(f"{value:.2%} at {aspect:g}" for aspect, value in row.items())
        for figure, row in table.iterrows()
    ]
    return falling, "; ".join(words)


CONCLUSIONS = (
    *(false_overturnings, missed_overturnings, modified_is_closer),
    *(agreement_at_high_frequency, squat_blocks_differ_more),
)
"""The paper's conclusions."""


def _of(compared: pd.DataFrame, source: str) -> pd.DataFrame:
    return compared[compared["source"] == source]


def _where(wrong: pd.DataFrame) -> str:
    places = [
        f"figure {figure} H/B {aspect:g}: ω/p {_ranges(group['omega_over_p'].unique())}"
        for (figure, aspect), group in wrong.groupby(["figure", "aspect"])
    ]
    return ("; " + "; ".join(places)) if places else ""


def _ranges(values: Iterable[float]) -> str:
    """Return tenths as ranges: 0.3, 0.4, 0.5, 0.8 -> "0.3–0.5, 0.8"."""
    runs: list[list[int]] = []
    for tenth in sorted(round(10.0 * value) for value in values):
        if runs and tenth == runs[-1][-1] + 1:
            runs[-1].append(tenth)
        else:
            runs.append([tenth])
    ends = (dict.fromkeys((run[0], run[-1])) for run in runs)
    return ", ".join("–".join(f"{tenth / 10:g}" for tenth in end) for end in ends)


STUDY = Study(
    name="sweep",
    question="Do the engines and the linearizations predict the paper's cases?",
    help="""The paper's sensitivity analysis, figures 6 to 9.

Each figure has 240 cases: 120 problems, each in two similar sizes. Takes half a minute with the
default sources. To continue an interrupted run, give the same command again. Writes sweep.csv,
summary.csv, findings.csv, findings.txt and a picture of each figure.""",
    sources=("exact", "housner", "modified", "onset-matched", *core_sources()),
    options=Options,
    rows="sweep",
    captions={
        "overview": "Each engine and preset: the median and the largest error of the peak, the "
        "number of wrong outcomes, and the run time of a case.",
        "figure": "Largest rotation against the frequency of the pulse. Marks in the band: the "
        "source overturns the block. Lowest panels: the errors.",
    },
    **stages(jobs, tabulate, finding, shown, figures),
)
command = STUDY.command()
