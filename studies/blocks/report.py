"""What a list of blocks shows: in words, as a short table, and as a page to hand on."""

from __future__ import annotations

import math
import shlex
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader

from analytic.response import Outcome
from studies.blocks import STUDY, strength
from studies.drawing.kept import tell
from studies.old import provenance
from studies.old.tables import quoted, unquoted
from studies.measures.words import capital, listed, out_of
from studies.sources.registry import resolve

WORDS = (
    *("name", "record", "record_digest", "source"),
    *("outcome", "message", "islands", "no_margin"),
)
"""Columns of text: a block may be called nan, or 007."""

SLIDES, SLIDES_FIRST = "slides", "slides first"
"""Why a block has no margin: its friction is below B/H, or less than its rocking needs."""

QUOTED = (
    "In blocks.csv an apostrophe stands before each name that a spreadsheet would take for a "
    "formula."
)

NEAR = 0.01
"""An answer hangs on its amplitude where its scale is so near to the margin, relative to it."""


def read(folder: Path) -> pd.DataFrame:
    """Read a blocks.csv back."""
    table = pd.read_csv(folder / "blocks.csv", dtype=str, keep_default_na=False).map(unquoted)
    return table.astype({name: float for name in table if name not in WORDS})


def report(folder: Path, places: Mapping[str, str]) -> str:
    """Draw a folder's blocks.csv, write its page and its findings; return these.

    Parameters
    ----------
    folder : Path
    places : mapping
        Name of a record -> the path of its file, with which the page's commands work anywhere.
    """
    rows, made = read(folder), provenance.record_of(folder)
    lines, sources = ranked(rows), list(dict.fromkeys(rows["source"]))
    answers = answered(rows)
    beside = [answers[pair] for pair in zip(lines["name"], lines["record"], strict=True)]
    factors = lines[["name", "width_m", "height_m", "record", "lifts", "margin"]]
    if lines["no_margin"].any():
        factors = factors.assign(no_margin=lines["no_margin"])
    table = factors.reset_index(drop=True).join(pd.DataFrame(beside))
    counts, doubt = counted(rows), doubts(rows)
    said = f"{finding(folder)} {capital('; '.join(counts))}. {capital(listed(doubt))}."
    if any(quoted(word) != word for word in (*lines["name"], *lines["record"])):
        said += f" {QUOTED}"
    title = "Factors on a record that lift and overturn each block, and outcomes with peaks"
    text = tell(STUDY, folder, {title: table}, said)
    environment = Environment(loader=PackageLoader("studies.blocks", "."), autoescape=True)
    environment.filters["shown"] = shown
    page = environment.get_template("page.html.jinja").render(
        finding=finding(folder),
        said=[f"{capital(words)}." for words in (*counts, *doubt)],
        picture=f"data:image/png;base64,{b64encode((folder / 'blocks.png').read_bytes()).decode()}",
        scales=sorted(set(rows["scale"])),
        sources=sources,
        lines=[
            {
                **line,
                "answers": found,
                "command": command_of(line, places, sources, made["settings"]),
            }
            for line, found in zip(lines.to_dict("records"), beside, strict=True)
        ],
        messages=messages(rows),
        rules=strength,
        made=made,
    )
    provenance.write_text(folder / "blocks.html", page)
    return text


def finding(folder: Path) -> str:
    """Say how many blocks overturn under a record as it is, and which does so first."""
    return f"{first_words(ranked(read(folder)))}."


def ranked(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each block and record, the least margin of a block first.

    Parameters
    ----------
    rows : DataFrame
        The columns of blocks.csv.
    """
    lines = rows.drop_duplicates(["name", "record"])
    least = lines.groupby("name")["margin"].transform("min")
    order = lines.assign(least=least, place=range(len(lines)))
    by = ["least", "name", "margin", "place"]
    return order.sort_values(by, kind="stable").drop(columns=["least", "place"])


def first_words(lines: pd.DataFrame) -> str:
    """Say how many blocks overturn under a record as it is, which first, and how many slide."""
    blocks = lines["name"].nunique()
    fallen = lines.loc[lines["margin"] <= 1.0, "name"].nunique()
    sliding = lines.loc[lines["no_margin"].isin([SLIDES, SLIDES_FIRST]), "name"].nunique()
    finite = lines[lines["margin"].map(math.isfinite)]
    words = [f"none of {blocks} blocks was found to overturn under any factor on a record"]
    if not finite.empty:
        first = finite.iloc[0]
        words = [
            f"{out_of(fallen, blocks)} blocks overturn under a record as it is, or weaker",
            f"the first is {first['name']}, at {first['margin']:.4g} times {first['record']}",
        ]
    if sliding:
        words.append(f"{out_of(sliding, blocks)} slide before they overturn and have no margin")
    return capital("; ".join(words))


def counted(rows: pd.DataFrame) -> list[str]:
    """Say for each scale and source how many cases end in which way."""
    said = []
    for (scale, source), group in rows.groupby(["scale", "source"], sort=False):
        counts = group["outcome"].value_counts()
        words = [f"{count} {outcome}" for outcome, count in counts.items()]
        words = [word.replace(SLIDES_FIRST, "sliding first") for word in words]
        said.append(f"at scale {scale:g} {source} has {listed(words)}")
    return said


def doubts(rows: pd.DataFrame) -> list[str]:
    """Say how many blocks slide or lift off the pivot, and how many answers hang on a hundredth."""
    case = ["name", "record", "scale"]
    cases, ends = rows.drop_duplicates(case), rows.groupby(case, sort=False)["outcome"].agg(set)
    flat = np.array([Outcome.SLID.value in outcomes for outcomes in ends])
    first = np.array([SLIDES_FIRST in outcomes for outcomes in ends]) & ~flat
    near = (cases["scale"] / cases["margin"] - 1.0).abs() < NEAR
    unknown, needed = cases["friction"].isna(), cases["friction_needed"]
    words = {
        "slide flat, since their friction is below B/H": flat,
        "slide first, since their rocking needs more friction than they have": first,
        "have no friction given: they slide if it is less than they need, up to "
        f"{needed[unknown].max():.3g}": unknown & needed.notna(),
        "would lift their pivot off, where no answer holds": cases["min_normal"] < 0.0,
        f"are within {100.0 * NEAR:g} % of the factor that first overturns them": near,
    }
    said = [
        f"{out_of(where.sum(), len(cases))} {what}" for what, where in words.items() if where.any()
    ]
    return said or ["none slides, lifts off its pivot or is near the factor that overturns it"]


def command_of(
    line: Mapping[Any, Any],
    places: Mapping[str, str],
    sources: Sequence[str],
    settings: Mapping[str, str],
) -> str:
    """Return the command that compares the sources on a case of the list."""
    engines = any(resolve(name).engine for name in sources)
    asked = ("width", "width_m"), ("height", "height_m"), ("scale", "scale"), ("tilt", "tilt")
    values = {name: line[column] for name, column in asked}
    slides = line["no_margin"] == SLIDES
    values["friction"] = line["friction"] if engines or slides else math.nan
    known = {name: value for name, value in values.items() if not math.isnan(value)}
    known |= {name: word for name, word in settings.items() if word}
    if slides:
        known["scene"] = "slide"
        sources = [name for name in sources if name == "exact" or resolve(name).engine]
    said = " ".join(f"--{name} {value}" for name, value in known.items())
    record = shlex.quote(places[line["record"]])
    return f"rocking compare {said} --record {record} --sources {' '.join(sources or ['exact'])}"


def answered(rows: pd.DataFrame) -> dict[tuple[str, str], dict[str, str]]:
    """Return for each block and record what each source answers at each scale."""
    found: dict[tuple[str, str], dict[str, str]] = {}
    for row in rows.to_dict("records"):
        peak = f" {row['peak_ratio']:.4g}" if row["outcome"] == "rocked" else ""
        peak = f" {1e3 * row['slid_m']:.3g} mm" if row["outcome"] == "slid" else peak
        mine = found.setdefault((row["name"], row["record"]), {})
        mine[f"{row['source']} × {row['scale']:g}"] = f"{row['outcome']}{peak}"
    return found


def shown(value: float, digits: int) -> str:
    """Return a number as the page shows it."""
    return "–" if math.isnan(value) else "∞" if math.isinf(value) else f"{value:.{digits}g}"


def messages(rows: pd.DataFrame) -> list[tuple[str, int, str]]:
    """Return what was said of answers, how often, and of which block first."""
    said = rows[rows["message"] != ""]
    return [
        (str(words), len(group), f"{group['name'].iloc[0]}, {group['source'].iloc[0]}")
        for words, group in said.groupby("message", sort=False)
    ]
