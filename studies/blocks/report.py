"""What a list of blocks shows: in words, as a short table, and as a page to hand on."""

from __future__ import annotations

import math
from base64 import b64encode
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
from jinja2 import Environment, PackageLoader

from studies.blocks import strength
from studies.blocks.ranking import command_of, counted, doubts, first_words, ranked
from studies.kit import provenance
from studies.kit.tables import in_columns
from studies.measures.words import capital, listed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WORDS = ("name", "record", "source", "outcome", "message", "islands")
"""Columns of text: a block may be called nan, or 007."""
SHOWN = 20
"""Lines of a report: the blocks that overturn first."""


def read(folder: Path) -> pd.DataFrame:
    """Read a blocks.csv back."""
    table = pd.read_csv(folder / "blocks.csv", dtype=str, keep_default_na=False)
    return table.astype({name: float for name in table if name not in WORDS})


def report(folder: Path) -> str:
    """Draw a folder's blocks.csv, write its page and its findings; return these."""
    from studies.drawing.figures import save_all

    rows = read(folder)
    (picture,) = save_all(pictures(folder), folder)
    text = f"{table_text(rows)}\n\n{paragraph(folder)}"
    provenance.write_text(folder / "findings.txt", text + "\n")
    environment = Environment(loader=PackageLoader("studies.blocks", "."), autoescape=True)
    environment.filters["shown"] = shown
    page = environment.get_template("page.html.jinja").render(
        headline=headline(folder),
        said=[f"{capital(words)}." for words in (*counted(rows), *doubts(rows))],
        picture=f"data:image/png;base64,{b64encode(picture.read_bytes()).decode()}",
        scales=sorted(set(rows["scale"])),
        sources=list(dict.fromkeys(rows["source"])),
        lines=lines_of_page(rows, provenance.record_of(folder)["settings"]),
        messages=messages(rows),
        rules=strength,
        made=provenance.record_of(folder),
    )
    provenance.write_text(folder / "blocks.html", page)
    return text


def headline(folder: Path) -> str:
    """Say how many blocks overturn under a record as it is, and which does so first."""
    return f"{first_words(ranked(read(folder)))}."


def paragraph(folder: Path) -> str:
    """Say the same, how each source's cases end, and what of the answers is in doubt."""
    rows = read(folder)
    return f"{headline(folder)} {capital('; '.join(counted(rows)))}. {listed(doubts(rows))}."


def pictures(folder: Path) -> dict[str, Figure]:
    """Draw the ranking of a folder's blocks from its blocks.csv alone."""
    from studies.blocks.figure import draw_blocks

    return {"blocks": draw_blocks(read(folder))}


def table_text(rows: pd.DataFrame) -> str:
    """Return the blocks that overturn first, a line for each record."""
    lines = ranked(rows)
    answers = answered(rows)
    table = pd.DataFrame(
        [
            {
                "block": line["name"],
                "B × H [m]": f"{line['width_m']:g} × {line['height_m']:g}",
                "record": line["record"],
                "lifts": f"{line['lifts']:.4g}",
                "overturns": shown(line["margin"], 4),
                **answers[line["name"], line["record"]],
            }
            for _, line in lines.head(SHOWN).iterrows()
        ]
    )
    more = len(lines) - SHOWN
    head = "Factors on a record that lift and overturn each block, and outcomes with θmax/θcr:"
    return "\n".join(
        [head, in_columns(table), *([f"and {more} more in blocks.csv"] if more > 0 else [])]
    )


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


def lines_of_page(rows: pd.DataFrame, settings: dict[str, str]) -> list[dict[str, Any]]:
    """Return the lines of the page's table, each with the command that makes it again."""
    answers, sources = answered(rows), list(dict.fromkeys(rows["source"]))
    return [
        {
            **{str(name): value for name, value in line.items()},
            "answers": answers[line["name"], line["record"]],
            "command": command_of(line, sources, settings),
        }
        for _, line in ranked(rows).iterrows()
    ]


def messages(rows: pd.DataFrame) -> list[tuple[str, int, str]]:
    """Return what was said of answers, how often, and of which block first."""
    said = rows[rows["message"] != ""]
    return [
        (str(words), len(group), f"{group['name'].iloc[0]}, {group['source'].iloc[0]}")
        for words, group in said.groupby("message", sort=False)
    ]
