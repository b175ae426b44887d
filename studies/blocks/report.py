"""What a list of blocks shows: in words, as a short table, and as a page to hand on."""

from __future__ import annotations

import math
from base64 import b64encode
from pathlib import Path

import pandas as pd
from jinja2 import Environment, PackageLoader

from studies.blocks import strength
from studies.blocks.ranking import command_of, counted, doubts, first_words, ranked
from studies.drawing.kept import Pictures, tell
from studies.kit import provenance
from studies.measures.words import capital, listed

WORDS = ("name", "record", "source", "outcome", "message", "islands")
"""Columns of text: a block may be called nan, or 007."""


def read(folder: Path) -> pd.DataFrame:
    """Read a blocks.csv back."""
    table = pd.read_csv(folder / "blocks.csv", dtype=str, keep_default_na=False)
    return table.astype({name: float for name in table if name not in WORDS})


def report(folder: Path) -> str:
    """Draw a folder's blocks.csv, write its page and its findings; return these."""
    rows, made = read(folder), provenance.record_of(folder)
    lines, sources = ranked(rows), list(dict.fromkeys(rows["source"]))
    answers = answered(rows)
    beside = [answers[pair] for pair in zip(lines["name"], lines["record"], strict=True)]
    factors = lines[["name", "width_m", "height_m", "record", "lifts", "margin"]]
    table = factors.reset_index(drop=True).join(pd.DataFrame(beside))
    counts, doubt = counted(rows), doubts(rows)
    finding = f"{headline(folder)} {capital('; '.join(counts))}. {listed(doubt)}."
    title = "Factors on a record that lift and overturn each block, and outcomes with peaks"
    text = tell(folder, pictures(folder), finding, {title: table})
    environment = Environment(loader=PackageLoader("studies.blocks", "."), autoescape=True)
    environment.filters["shown"] = shown
    page = environment.get_template("page.html.jinja").render(
        headline=headline(folder),
        said=[f"{capital(words)}." for words in (*counts, *doubt)],
        picture=f"data:image/png;base64,{b64encode((folder / 'blocks.png').read_bytes()).decode()}",
        scales=sorted(set(rows["scale"])),
        sources=sources,
        lines=[
            {**line, "answers": found, "command": command_of(line, sources, made["settings"])}
            for line, found in zip(lines.to_dict("records"), beside, strict=True)
        ],
        messages=messages(rows),
        rules=strength,
        made=made,
    )
    provenance.write_text(folder / "blocks.html", page)
    return text


def headline(folder: Path) -> str:
    """Say how many blocks overturn under a record as it is, and which does so first."""
    return f"{first_words(ranked(read(folder)))}."


def pictures(folder: Path) -> Pictures:
    """Draw the ranking of a folder's blocks from its blocks.csv alone."""
    from studies.blocks.figure import draw_blocks

    return {"blocks": draw_blocks(read(folder))}


def answered(rows: pd.DataFrame) -> dict[tuple[str, str], dict[str, str]]:
    """Return for each block and record what each source answers at each scale."""
    found: dict[tuple[str, str], dict[str, str]] = {}
    for row in rows.to_dict("records"):
        peak = f" {row['peak_ratio']:.4g}" if row["outcome"] == "rocked" else ""
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
