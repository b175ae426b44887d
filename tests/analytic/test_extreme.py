"""The exact solution of the extreme cases against 30 digits (reference/make_extreme_table.py)."""

import csv
from pathlib import Path

import pytest

from analytic import RigidBlock, SinePulse, simulate
from studies.cases.extreme import extremes

with (Path(__file__).parent / "reference" / "extreme.csv").open(newline="") as file:
    ROWS = list(csv.DictReader(file))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row["case"])
def test_an_extreme_peak_has_its_digits(row):
    restitution = float(row["restitution"] or "nan")
    block = RigidBlock(
        width=float(row["width"]), height=float(row["height"]), restitution=restitution
    )
    pulse = SinePulse(
        amplitude=float(row["amplitude"]),
        omega=float(row["omega"]),
        half_cycles=int(row["half_cycles"]),
    )
    found, right = simulate(block, pulse).peak_ratio, float(row["peak_ratio"])
    # a millionth below overturning the pulse's own rounding, 1e-16, grows ten thousandfold
    near = "boundary" in row["case"]
    # 0 and inf are met as they are
    assert found == pytest.approx(right, rel=1e-11 if near else 1e-13, abs=0.0)


def test_the_table_is_of_the_cases_that_are_asked():
    named = {case.name: case for case in extremes(False)}
    assert len(ROWS) > 12
    for row in ROWS:
        case = named[row["case"]]
        assert float(row["amplitude"]) == pytest.approx(case.motion.amplitude, rel=1e-12)
        assert float(row["omega"]) == pytest.approx(case.motion.omega, rel=1e-12)
