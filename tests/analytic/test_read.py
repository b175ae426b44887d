"""`Record.read`: a file of a recorded ground motion, or a ValueError that says why not."""

import numpy as np
import pytest

from analytic import Record
from studies.cases.accelerograms import read_record

AT2 = "PEER\nA\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS= 5, DT= .1 SEC\n0 .1 .3 -.4 0\n"
TABLE = "time_s,acceleration_g\n0,0\n0.1,0.1\n0.2,0.3\n0.3,-0.4\n0.4,0\n"
G = np.array([0.0, 0.1, 0.3, -0.4, 0.0])


@pytest.mark.parametrize(
    ("text", "units"), [(AT2, None), (TABLE, None), (TABLE.replace("_g", ""), "g")]
)
def test_an_at2_file_and_a_table_are_the_same_record(text, units, tmp_path):
    path = tmp_path / "a.txt"
    path.write_text(text)
    record = Record.read(str(path), units)
    assert record == Record.read(path, units) == read_record(path, units)
    assert record.dt == pytest.approx(0.1, rel=1e-15)
    np.testing.assert_array_equal(record.samples, 9.81 * G)


@pytest.mark.parametrize(
    ("text", "units", "problem"),
    [
        (TABLE.replace("_g", ""), None, "it does not state its units; units must: g, mg"),
        (TABLE, "feet", "units must be among g, mg, .*, not 'feet'"),
        (TABLE.replace("-0.4", "x"), None, "line 5: 'x' must be a number"),
        (None, None, "it must be a file that can be read"),
    ],
)
def test_what_leaves_a_doubt_is_refused_with_the_file_s_name(text, units, problem, tmp_path):
    """Each doubt: tests/studies."""
    path = tmp_path / "doubt.txt"
    if text:
        path.write_text(text)
    with pytest.raises(ValueError, match=problem) as error:
        Record.read(path, units)
    assert str(error.value).startswith(f"path is {str(path)!r}; ")
    assert "\n" not in str(error.value)
