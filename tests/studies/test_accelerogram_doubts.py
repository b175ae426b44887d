"""Files that leave a doubt are refused with one line, which names the file and the place."""

import os
import re

import numpy as np
import pytest
from commanding import BLOCK, python, refused
from hypothesis import given, settings
from hypothesis import strategies as st
from records import ASC_COLUMN, ASC_HEADER, AT2, COLUMNS, TITLE

from analytic.text import MOST_BYTES, MOST_SAMPLES
from studies.cases.accelerograms import read_record
from studies.cases.refusal import BadInputError

GOOD = AT2["series"]
ROWS = "0.0 0.1\n0.1 0.2\n0.2 -0.3\n"
COMMAS = ROWS.replace(" ", ",")
TWICE = AT2["said twice"]
UNLIKE = "VELOCITY TIME SERIES IN UNITS OF CM/S"


def table(*times, header="# units: g\n"):
    return header + "".join(f"{time} 0.1\n" for time in times)


def at2(line):
    return f"{TITLE}{line}\nNPTS= 7, DT= .005 SEC\n{COLUMNS}"


def asc(old, new):
    assert old in ASC_HEADER
    return ASC_HEADER.replace(old, new) + ASC_COLUMN


# (what is the matter, text or bytes, --units, words of the refusal)
DOUBTS = [
    ("velocity", at2(UNLIKE), None, "line 3 speaks of velocity"),
    ("displacement", at2("DISPLACEMENT TIME HISTORY IN UNITS OF CM"), "g", "displacement"),
    ("units of velocity", at2("ACCELERATION TIME SERIES IN UNITS OF CM/S"), "g", "'cm/s'"),
    ("a column of velocity", f"t (s), v (m/s)\n{COMMAS}", "g", "'v (m/s)'"),
    ("mg and g", at2("ACCELERATION IN UNITS OF MG"), "g", "states mg; --units must not be g"),
    ("mg in a table", f"t (s)  a (mg)\n{ROWS}", "g", "states mg; --units must not be g"),
    ("feet", at2("ACCELERATION IN UNITS OF FT/S2"), "g", "line 3 states 'ft/s2'; it must be among"),
    ("decimal commas", "1,5\n2,7\n3,1\n", "g", "its commas may be decimal ones"),
    ("decimal commas in AT2", GOOD.replace(".1\n", ",1\n"), None, "line 6: '-,1' must be a number"),
    ("Arabic digits", "٠ ٠\n١ ٢\n٢ ٤\n", "g", "0 rows of numbers"),
    ("digits in groups", ROWS.replace("0.2\n", "1_000\n"), "g", "'1_000' must be a number"),
    ("NaN among samples", GOOD.replace("-.1\n", "NaN\n"), None, "line 6: NaN must be a finite"),
    ("NaN after the last", f"{GOOD}NaN\n", None, "line 8: NaN must be a finite number"),
    ("too large", ROWS.replace("0.2\n", "1e999\n"), "g", "line 2: 1e999 must be a finite number"),
    ("too large to integrate", GOOD.replace("-.1", "1e307"), None, "must be finite"),
    ("too long", GOOD.replace(".0050", "1e300"), None, "it must be from"),
    ("a long word", ROWS.replace("0.2\n", "9x" * 3000 + "\n"), "g", "must be a number"),
    ("UTF-16", ROWS.encode("utf-16"), "g", "line 1: the byte 0xff is not text"),
    ("times in ms", f"t_ms,acc_g\n{COMMAS}", None, "its times are in 'ms'"),
    ("a step in ms", GOOD.replace("SEC,", "MSEC,"), None, "line 4: the step is in MSEC"),
    ("swapped names", f"a (g), t (s)\n{COMMAS}", None, "'a (g)' and 't (s)'; they must be time"),
    ("swapped numbers", "0.1 0.00\n0.2 0.01\n0.3 0.02\n", "g", "both columns increase in equal"),
    ("two counts", TWICE.replace("7 points", "8 points"), None, "says 8 and 7 as number"),
    ("two steps", TWICE.replace("DT= .005", "DT= .006"), None, "says 0.005 and 0.006"),
    ("no step", GOOD.replace(", DT=   .0050 SEC,", ""), None, "says NPTS; it must say DT, too"),
    ("no end", AT2["no count"].replace("*** End Data ***", ""), None, "columns"),
    ("after the end", f"{AT2['begin and end']}0.1\n", None, "line 10: '***' must be a number"),
    ("VT2", GOOD, None, "it must be a file of acceleration, as AT2 files are"),
    ("ASC, velocity", asc("DATA_TYPE: ACCELERATION", "DATA_TYPE: VELOCITY"), "g", "'VELOCITY'"),
    ("ASC, spectrum", asc(": ACCELERATION", ": ACCELERATION SPECTRUM"), None, "SPECTRUM"),
    ("ASC, cm/s", asc("UNITS: cm/s^2", "UNITS: cm/s"), None, "line 14 states 'cm/s'"),
    ("ASC, no units", asc("UNITS: cm/s^2\n", ""), None, "does not state its units"),
    ("ASC, odd count", asc("NDATA: 7", "NDATA: 7.5"), None, "line 11: NDATA is '7.5'; it must be"),
    ("ASC, twice", asc("USER1:\nUSER1:", "NDATA: 7"), None, "line 19: NDATA must not be said"),
    ("ASC, short", ASC_HEADER + ASC_COLUMN[:30], None, "holds 4 samples; it must hold the 7"),
    ("ASC, NaN", ASC_HEADER + ASC_COLUMN.replace("0.4", "NaN"), None, "line 24: 'NaN00000' must"),
    ("ASC, two columns", ASC_HEADER + ASC_COLUMN.replace("\n", " 1\n"), None, "'0.000000 1'"),
    ("other units", GOOD, "m/s2", "it states g; --units must not be m/s2"),
    ("one too many", GOOD + "0.1\n", None, "holds 8 samples; it must hold the 7 of its header"),
    ("a word", GOOD.replace("-.1", "x"), None, "line 6: 'x' must be a number"),
    ("no units", GOOD.replace("UNITS OF G", "V"), None, "does not state its units; --units must"),
    ("a gap", table(0, 0.1, 0.2, 0.4), None, "line 5: a gap from 0.2 to 0.4 s; steps must all be"),
    ("uneven", table(0, 0.1, 0.2, 0.31, 0.4, 0.5), None, "line 5: the time 0.31 s is not a whole"),
    ("twice", table(0, 0.1, 0.1, 0.2), None, "line 4: the time 0.1 s must be later than 0.1 s"),
    ("one row", table(0), None, "1 rows of numbers; it must have two"),
    ("nothing", "", None, "0 rows"),
    ("two units", table(0, 0.1, header="a (g) and b (gal)\n"), None, "several units, g, gal"),
    ("three columns", "0 1 2\n1 2 3\n", None, "line 1 has 3 columns; it must have two"),
    ("words at the end", "0 0.1\nend of data\n", None, "line 2 has 3 columns"),
    ("COSMOS", "Corrected acceleration   (Format v01.20 with 13 text lines)\n", "g", "COSMOS file"),
    ("SMC", "2 CORRECTED ACCELEROGRAM\n*\n", "g", "it is a SMC file, which is not read"),
    ("SMC, unknown", "0 UNKNOWN                 ORIGIN\n*\n", "g", "it is a SMC file"),
    ("SIMBAD", "SIMBAD v06, record 12, acceleration in m/s2\n0.1\n0.2\n", None, "a SIMBAD file"),
    ("touching", GOOD.replace("0.0000000E+00", "1.8E-06-1.2E-06"), None, "must stand apart"),
    ("one column", "# units: g\n0.1\n0.2\n0.3\n", None, "it has one column; --record-dt, or a"),
    ("npts dt, short", "4 0.01\n0.1\n0.2\n0.3\n", "g", "3 samples; it must hold the 4 of its"),
    ("CSMIP", "Corrected Accelerogram Caltech Vol II\n", "g", "it is a CSMIP file"),
    ("K-NET", "Origin Time       1999/01/02 03:04:05\n", "g", "it is a K-NET file"),
]


@pytest.mark.parametrize(
    ("name", "content", "units", "words"), DOUBTS, ids=[doubt[0] for doubt in DOUBTS]
)
def test_a_doubt_is_refused_with_one_line(name, content, units, words, tmp_path):
    path = tmp_path / ("motion.VT2" if name == "VT2" else "motion.txt")
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(BadInputError) as refusal:
        read_record(path, units)
    message = str(refusal.value)
    assert message.startswith(f"--record is {str(path)!r}; ")
    assert words in message
    assert "\n" not in message
    assert len(message) < len(str(path)) + 300


MARKS = "0123456789.,;:eE+-= \t\r\n#%()[]_/*gmscANPTSDT\x00\x1a\u0663\u00e9\ufeff"
EDITS = st.lists(st.tuples(st.integers(0, 600), st.integers(0, 9), st.text(MARKS, max_size=9)))


@settings(max_examples=400, deadline=None)
@given(
    content=st.binary(max_size=60)
    | st.text(MARKS, max_size=60).map(str.encode)
    | st.sampled_from([*AT2.values(), ASC_HEADER + ASC_COLUMN, f"t (s), a (g)\n{ROWS}"]),
    edits=EDITS,
    units=st.sampled_from([None, "g", "cm/s2"]),
)
def test_whatever_a_file_holds_it_is_a_record_or_refused(content, edits, units, tmp_path_factory):
    """A file of any bytes, or a good one with some of its characters changed."""
    if isinstance(content, str):
        for begin, length, text in edits:
            content = content[:begin] + text + content[begin + length :]
        content = content.encode()
    path = tmp_path_factory.getbasetemp() / "any.txt"
    path.write_bytes(content)
    try:
        record = read_record(path, units)
    except BadInputError as refusal:
        assert len(str(refusal).splitlines()) == 1
    else:
        assert np.isfinite(record.samples).all()


ASKED = ["compare", *BLOCK, "--units", "g", "--record"]
BEGIN = "rocking: --record is "


def test_a_named_pipe_is_not_waited_for(tmp_path):
    """In a process of its own, for one that waits would wait for ever."""
    path = tmp_path / "pipe"
    os.mkfifo(path)
    done = python("-m", "studies", *ASKED, path)
    assert (done.returncode, done.stdout) == (2, "")
    assert "it must be a file that can be read (it is a named pipe)" in done.stderr


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("/dev/null", "it is a device"),
        (".", "it is a folder"),
        ("a" * 300, "File name too long"),
        ("no.file", "No such file or directory"),
    ],
)
def test_what_is_no_file_is_not_opened(path, words, capsys):
    refused(capsys, [*ASKED, path], BEGIN, f"it must be a file that can be read ({words})")


def test_a_record_of_ten_million_samples_is_refused_at_once(tmp_path, capsys):
    """By what its header says, before its samples are looked at."""
    path = tmp_path / "long.AT2"
    for text in (GOOD.replace("7,", "10000000,"), asc("NDATA: 7", "NDATA: 10000000")):
        path.write_text(text)
        words = "it holds 10000000 samples, for which one exact solution would take"
        message = refused(capsys, [*ASKED, path], BEGIN, words)
        assert re.search(r"some [\d.]+ min and [\d.]+ GB; it must hold 1000000 at most", message)


@pytest.mark.parametrize("content", [b"0 0\n" * (MOST_SAMPLES + 5001), MOST_BYTES + 1])
def test_a_file_that_is_too_long_is_refused_by_its_size_or_its_words(content, tmp_path, capsys):
    path = tmp_path / "long.txt"
    path.write_bytes(b"" if isinstance(content, int) else content)
    if isinstance(content, int):
        os.truncate(path, content)
    refused(capsys, [*ASKED, path], BEGIN, "samples")


@pytest.mark.parametrize("form", ["no count", "table"])
def test_samples_are_counted_where_no_header_says_how_many(form, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("analytic.accelerograms.MOST_SAMPLES", 6)
    rows = "".join(f"{0.1 * at:.1f} 0.1\n" for at in range(7))
    path = tmp_path / "long.txt"
    path.write_text({**AT2, "table": rows}[form])
    refused(capsys, [*ASKED, path], BEGIN, "it holds 7 samples")
