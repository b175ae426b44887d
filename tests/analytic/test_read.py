"""`Record.read`: a file of a recorded ground motion, or a ValueError that says why not."""

import numpy as np
import pytest

from analytic import Record, RigidBlock, simulate
from studies.cases.accelerograms import read_record

AT2 = "PEER\nA\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 5, DT= .1 SEC\n0 .1 .3 -.4 0\n"
TABLE = "time_s,acceleration_g\n0,0\n0.1,0.1\n0.2,0.3\n0.3,-0.4\n0.4,0\n"
G = np.array([0.0, 0.1, 0.3, -0.4, 0.0])


@pytest.mark.parametrize("name", ["a.AT2", "a.csv"])
def test_an_at2_file_and_a_table_are_the_same_record(name, tmp_path):
    path = tmp_path / name
    path.write_text(AT2 if name == "a.AT2" else TABLE)
    record = Record.read(str(path))
    assert record == Record.read(path) == read_record(path)
    assert record.dt == pytest.approx(0.1, rel=1e-15)
    np.testing.assert_array_equal(record.samples, 9.81 * G)
    block = RigidBlock(width=0.5, height=1.5)
    by_hand = Record(dt=record.dt, samples=9.81 * G)
    assert simulate(block, record).peak_ratio == simulate(block, by_hand).peak_ratio


def test_units_are_those_that_are_given(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(TABLE.replace("_g", ""))
    np.testing.assert_allclose(Record.read(path, "cm/s2").samples, 0.01 * G, rtol=1e-15)


@pytest.mark.parametrize(
    ("text", "units", "problem"),
    [
        (TABLE.replace("_g", ""), None, "it does not state its units; units must: g, mg"),
        (TABLE, "feet", "units must be among g, mg, .*, not 'feet'"),
        (TABLE.replace("-0.4", "x"), None, "line 5: 'x' must be a number"),
    ],
)
def test_what_leaves_a_doubt_is_refused_with_the_file_s_name(text, units, problem, tmp_path):
    """Each doubt: tests/studies."""
    path = tmp_path / "doubt.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match=problem) as error:
        Record.read(path, units)
    assert str(error.value).startswith(f"path is {str(path)!r}; ")
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_there_is_a_value_error(tmp_path):
    with pytest.raises(ValueError, match="it must be a file that can be read"):
        Record.read(tmp_path / "none.AT2")
