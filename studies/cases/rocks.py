"""Two rocks on a shake table: their tests, read from a clone (GPL-3) that is not kept here."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree
from zipfile import BadZipFile, ZipFile

import numpy as np
import pandas as pd

from analytic.block import GRAVITY, RigidBlock
from analytic.record import Record
from studies.cases.refusal import BadInputError

CLONE = "a clone of ZhiangChen/virtual_shake_robot_pybullet"
TABLE = Path("data", "Shake_Table_Response")
MESHES = {1: "models/SP1_PBRmodel/final_sp1.obj", 2: "models/SP2_PBRmodel/final_sp2_1.obj"}
FELL = "Experimental Results for response-Specimen {}"
TUNED = {1: "Specimen 1-Numerical KN=10 KS=1", 2: "Specimen 2-Numerical KN=15 p=50"}
"""Of the authors' predictions for each rock those that are right most often."""
DT = 1.0 / 800.0  # [s] between samples; the files print it in five digits
FOOT = 5e-3  # [m] above the lowest point of a mesh: as high up its points belong to the footprint
CELL = "{http://schemas.openxmlformats.org/spreadsheetml/2006/main}"


@contextmanager
def reading(path: Path, kind: str) -> Iterator[None]:
    """Refuse a file that is something else."""
    from scipy.spatial import QhullError

    wrong = (OSError, ValueError, TypeError, LookupError, BadZipFile, QhullError)
    try:
        yield
    except (*wrong, ElementTree.ParseError) as error:
        raise BadInputError(f"{str(path)!r} is not {kind}; --rocks must name {CLONE}") from error


def read_tests(folder: Path) -> pd.DataFrame:
    """Return a line for each test: test, pga_g, pgv_m_s, and of both rocks fell and authors."""
    heads = [FELL.format(rock) for rock in MESHES] + [*TUNED.values()]
    found = read_sheet(folder / TABLE / "Results_Granite.xlsx", heads)
    tests = found.join(read_sheet(folder / TABLE / "PGVA-zchen.xlsx", ["PGA", "PGVA"]), how="inner")
    tests.insert(0, "pgv_m_s", GRAVITY * tests["PGA"] * tests.pop("PGVA"))
    names = [f"{word}_{rock}" for word in ("fell", "authors") for rock in MESHES]
    renamed = dict(zip([*heads, "PGA"], [*names, "pga_g"], strict=True))
    return tests.rename(columns=renamed).rename_axis("test").reset_index()


def read_sheet(path: Path, heads: list[str]) -> pd.DataFrame:
    """Return columns of numbers of a workbook's first sheet, by their heads and the test."""
    with reading(path, f"a workbook with numbers in the columns {', '.join(heads)}"):
        with ZipFile(path) as book:
            words = ElementTree.fromstring(book.read("xl/sharedStrings.xml"))
            sheet = ElementTree.fromstring(book.read("xl/worksheets/sheet1.xml"))
        lines = [
            {cell.get("r", "").rstrip("0123456789"): cell.findtext(f"{CELL}v") for cell in row}
            for row in sheet.iter(f"{CELL}row")
        ]
        first, *rest = (line for line in lines if any(line.values()))
        names = {
            place: "".join(words[int(n)].itertext()).strip() for place, n in first.items() if n
        }
        table = pd.DataFrame(rest).rename(columns=names)[["Test Number", *heads]]
        numbers: pd.DataFrame = table.where(table.notna(), "none").apply(pd.to_numeric)
        return numbers.set_index("Test Number")


def read_motion(path: Path) -> Record:
    """Return what the table did in a test, its mean taken away."""
    with reading(path, f"a whole table of eight columns of numbers, in steps of {DT:g} s from 0"):
        found = pd.read_csv(path, sep="\t", usecols=[0, 1, 7], skiprows=1, header=None)
        times, samples, last = found.to_numpy(dtype=float).T
        off = np.abs(times - DT * np.arange(len(times)))
        if not (off.max() <= DT and np.isfinite([samples, last]).all()):
            raise ValueError
        return Record(dt=DT, samples=GRAVITY * samples).detrended("constant")


def read_mesh(path: Path) -> list[RigidBlock]:
    """Return blocks of a mesh with its height and inertia: weak side right, left, on both sides."""
    from scipy.spatial import ConvexHull

    # its sides are those of the footprint, across the edge next to the centre of mass
    with reading(path, "a mesh of triangles that stands on a face"):
        lines = [line.split() for line in path.read_text().splitlines()]
        points = np.array([line[1:4] for line in lines if line[:1] == ["v"]], dtype=float)
        faces = [line[1:4] for line in lines if line[:1] == ["f"]]
        places = [[int(part.split("/")[0]) - 1 for part in face] for face in faces]
        volumes = np.linalg.det(points[places])  # of tetrahedra: a triangle and the origin
        points -= volumes @ points[places].sum(axis=1) / 4.0 / volumes.sum()
        height = -points[:, 2].min()
        foot = points[points[:, 2] < FOOT - height, :2]
        edge = max(ConvexHull(foot).equations, key=lambda edge: edge[2])
        weak, strong = -edge[2], -(foot @ edge[:2]).min()
        across = points @ np.array([[*edge[:2], 0.0], [0.0, 0.0, 1.0]]).T
        corners, volumes = across[places], np.linalg.det(points[places])
        squares = (corners**2).sum(axis=(1, 2)) + (corners.sum(axis=1) ** 2).sum(axis=1)
        inertia = volumes @ squares / 20.0 / volumes.sum()
        off = 0.5 * (strong - weak)
        sizes = ((weak + strong, off), (weak + strong, -off), (2.0 * weak, 0.0))
        return [
            RigidBlock(width=width, height=2.0 * height, offset=offset, inertia=inertia)
            for width, offset in sizes
        ]
