"""Two rocks on a shake table: the public folder of their tests, read or refused in one line.

Chen et al., https://github.com/ZhiangChen/virtual_shake_robot_pybullet (GPL-3), of which nothing
is kept here. Both specimens are one boulder of granite of 354 kg.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree
from zipfile import BadZipFile, ZipFile

import numpy as np
import pandas as pd
from scipy.spatial import ConvexHull, QhullError

from analytic.block import GRAVITY
from analytic.motion import FloatArray
from analytic.record import Record
from studies.cases.refusal import BadInputError

TABLE = Path("data", "Shake_Table_Response")
MESHES = {
    1: Path("models/SP1_PBRmodel/final_sp1.obj"),
    2: Path("models/SP2_PBRmodel/final_sp2_1.obj"),
}
DT = 1.0 / 800.0
"""Time between samples [s]; the files print it in five digits."""
FOOT = 5e-3
"""Height [m] above the lowest point of a mesh up to which its points belong to the footprint."""
CELL = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"


def refused(path: Path, why: str) -> BadInputError:
    """Return the line about a file of the folder."""
    clone = "--rocks must name a clone of ZhiangChen/virtual_shake_robot_pybullet"
    return BadInputError(f"{str(path)!r} {why}; {clone}")


def read_tests(folder: Path) -> pd.DataFrame:
    """Return a line for each test: test, pga_g, pgv_m_s, and of both rocks fell and authors.

    The authors are the one of their columns that is right most often.
    """
    strong = read_sheet(folder / TABLE / "PGVA-zchen.xlsx", ["Test Number", "PGA", "PGVA"])
    fell = [f"Experimental Results for response-Specimen {rock}" for rock in MESHES]
    path = folder / TABLE / "Results_Granite.xlsx"
    found = read_sheet(path, ["Test Number", *fell])
    tests = found.merge(strong, on="Test Number", validate="one_to_one")
    lines = {"test": tests["Test Number"].astype(int), "pga_g": tests["PGA"]}
    lines["pgv_m_s"] = GRAVITY * tests["PGA"] * tests["PGVA"]
    for rock, name in zip(MESHES, fell, strict=True):
        tried = tests.filter(like=f"Specimen {rock}-Numerical")
        if tried.empty:
            raise refused(path, f"has no column that begins with 'Specimen {rock}-Numerical'")
        right = tried.eq(tests[name], axis=0).mean()
        lines |= {f"fell_{rock}": tests[name], f"authors_{rock}": tried[right.idxmax()]}
    return pd.DataFrame(lines)


def read_sheet(path: Path, heads: Sequence[str]) -> pd.DataFrame:
    """Return the first sheet of a workbook, whose first line names columns of numbers."""
    try:
        with ZipFile(path) as book:
            words = ElementTree.fromstring(book.read("xl/sharedStrings.xml"))
            sheet = ElementTree.fromstring(book.read("xl/worksheets/sheet1.xml"))
    except (OSError, BadZipFile, KeyError, ElementTree.ParseError) as error:
        raise refused(path, "cannot be read as a workbook") from error
    texts = ["".join(part.text or "" for part in word.iter(f"{CELL}t")) for word in words]
    lines: list[dict[str, str]] = []
    for row in sheet.iter(f"{CELL}row"):
        cells = {cell.get("r", "").rstrip("0123456789"): cell for cell in row}
        values = {place: cell.findtext(f"{CELL}v") for place, cell in cells.items()}
        known = {place: value for place, value in values.items() if value is not None}
        kinds = {place: cells[place].get("t") == "s" for place in known}
        line = {place: texts[int(each)] if kinds[place] else each for place, each in known.items()}
        lines += [line] if line else []
    names = {place: name.strip() for place, name in (lines[0] if lines else {}).items()}
    if lacking := [name for name in heads if name not in names.values()]:
        raise refused(path, f"has no column {lacking[0]!r}")
    table = pd.DataFrame(lines[1:]).rename(columns=names).apply(pd.to_numeric, errors="coerce")
    if table[list(heads)].isna().to_numpy().any():
        raise refused(path, f"has a cell that is no number in {', '.join(heads)}")
    return table


def read_motion(folder: Path, test: int) -> Record | None:
    """Return what the table did in a test, its mean taken away; None where there is no file."""
    path = folder / TABLE / f"Test{test:03d}.txt"
    if not path.is_file():
        return None
    try:
        table = pd.read_csv(path, sep="\t", usecols=[0, 1, 7], dtype=float).to_numpy()
    except (OSError, ValueError) as error:
        raise refused(path, "is no table of eight columns of numbers") from error
    off = np.abs(table[:, 0] - DT * np.arange(len(table)))
    if len(table) < 2 or not np.isfinite(table).all() or off.max() > DT:
        raise refused(path, f"is cut, or its times are no steps of {DT:g} s from 0")
    return Record(dt=DT, samples=GRAVITY * table[:, 1]).detrended("constant")


def read_mesh(folder: Path, rock: int) -> list[tuple[float, float]]:
    """Return blocks with the mean of both sides of a mesh, and with its weak side on both.

    The sides are those of the footprint, across the edge of it next to the centre of mass, which
    is that of a homogeneous body.
    """
    path = folder / MESHES[rock]
    try:
        lines = [line.split() for line in path.read_text().splitlines()]
        points = np.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)
        corners = [
            [part.split("/")[0] for part in line[1:4]] for line in lines if line[:1] == ["f"]
        ]
        a, b, c = points[np.array(corners, dtype=int).T - 1]
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
        points -= volumes @ (a + b + c) / 4.0 / volumes.sum()
        height = -float(points[:, 2].min())
        foot: FloatArray = points[points[:, 2] < FOOT - height, :2]
        edges = ConvexHull(foot).equations
    except (OSError, ValueError, IndexError, QhullError) as error:
        raise refused(path, "is no mesh of triangles that stands on a face") from error
    weak, across = float(-edges[:, 2].max()), edges[edges[:, 2].argmax(), :2]
    both = 0.5 * (weak - float((foot @ across).min()))
    return [(float(np.arctan2(b, height)), float(np.hypot(b, height))) for b in (both, weak)]
