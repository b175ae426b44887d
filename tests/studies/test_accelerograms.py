"""Recorded accelerograms: each form is read as its header says, a doubt refused."""

import os

import numpy as np
import pytest
from commanding import BLOCK, ROOT, compared, refused
from hypothesis import given, settings
from hypothesis import strategies as st
from records import ASC_COLUMN, ASC_HEADER, AT2, COLUMNS, SAMPLES, TITLE, write_record
from scipy.constants import g as standard_gravity
from scipy.signal import detrend

from analytic import GRAVITY, Record, RigidBlock, simulate
from analytic.accelerograms import UNITS
from analytic.text import MOST_BYTES, MOST_WORDS
from studies.__main__ import run
from studies.cases.refusal import BadInputError
from studies.kit.scene_options import read_record

ASKED = [*BLOCK, "--sources", "exact", "housner", "--record"]


def test_compare_takes_a_record(tmp_path, capsys):
    """A pulse as AT2 file gives the pulse's answer, within its samples' (omega dt)^2/8."""
    samples = 0.2 * GRAVITY * np.sin(2.0 * np.pi * np.linspace(0.0, 1.0, 401))
    path = write_record(tmp_path / "pulse.AT2", Record(dt=0.0025, samples=samples))
    plot = tmp_path / "plot.png"
    asked = [*BLOCK, "--sources", "exact", "rk45", "--record", path]
    code, rows = compared(capsys, *asked, "--pga", "0.4")
    found = [row["peak_ratio"] for row in rows.values()]
    assert (code, found) == (0, pytest.approx([0.385153] * 2, rel=1e-3))
    assert run(["compare", *map(str, asked), "--scale", "2", "--plot", str(plot)]) == 0
    text = capsys.readouterr().out
    assert "ground  record, 0.4 g, 1.25 m/s, 401 samples every 0.0025 s, 1 s" in text
    assert plot.stat().st_size > 4_000


def shaken(folder, offset):
    """Write 2 s of a sine of 0.25 g at 1 Hz with an offset [g]."""
    samples = 0.25 * np.sin(2.0 * np.pi * np.linspace(0.0, 2.0, 401)) + offset
    record = Record(dt=0.005, samples=GRAVITY * samples)
    return write_record(folder / f"{offset}.AT2", record)


def told(path, capsys, *options):
    code, rows = compared(capsys, *ASKED, path, *options)
    assert code == run(["compare", *ASKED, str(path), *options]) == 0
    (message,) = {row["message"] for row in rows.values()}
    assert capsys.readouterr().out.count(message) == 1 or not message
    return rows["exact"], message


def test_a_velocity_that_does_not_end_at_zero_is_reported(tmp_path, capsys):
    path = shaken(tmp_path, 0.01)
    for options in ([], ["--baseline", "none"]):
        assert "velocity ends at 0.196 m/s, 0.21 of its largest" in told(path, capsys, *options)[1]
    assert told(shaken(tmp_path, 0.0), capsys)[1] == ""


@pytest.mark.parametrize("baseline", ["constant", "linear"])
def test_a_baseline_is_corrected_by_a_named_method(baseline, tmp_path, capsys):
    path, options = shaken(tmp_path, 0.03), ["--baseline", baseline, "--pga", "0.35"]
    left = detrend(read_record(path).samples, type=baseline)
    record = Record(dt=0.005, samples=left).scaled_to(0.35 * GRAVITY)
    expected = simulate(RigidBlock(width=0.5, height=1.5), record).peak_ratio
    exact, message = told(path, capsys, *options)
    assert exact["peak_ratio"] == pytest.approx(expected, rel=1e-9)
    assert message.startswith(f"baseline corrected by detrend, {baseline}")


@pytest.fixture
def written(tmp_path):

    def write(text, name="motion.txt"):
        path = tmp_path / name
        path.write_bytes(text.encode())
        return path

    return write


@pytest.mark.parametrize("form", AT2)
def test_an_at2_file_needs_no_units(form, written):
    record = read_record(written(AT2[form], "motion.AT2"))
    assert record.dt == 0.005
    assert record.samples == pytest.approx(9.81 * SAMPLES, rel=1e-15)
    assert record == read_record(written(AT2[form], "motion.AT2"), "g")


STATED = {
    "IN UNITS OF CM/SEC/SEC": "cm/s2",
    "IN UNITS OF CM/SEC2.": "cm/s2",
    "IN UNITS OF M / S^2": "m/s2",
    "(M/S/S)": "m/s2",
    "IN MM/S2": "mm/s2",
    "[milli-g], UNITS=MG": "mg",
    "(Gal)": "gal",
    "IN cm s-2": "cm/s2",
}
NAMED = {
    "Time [sec], Acceleration [m/s²]": "m/s2",
    "# units: cm/s^2": "cm/s2",
    "% UNITS OF CM/SEC/SEC": "cm/s2",
    "time (s) acceleration (Gal)": "gal",
    "t / s,a / g": "g",
    "t,a (g)": "g",
    "Elapsed time (sec),Ground acceleration N-S (g)": "g",
    '"Time (sec.)","Acceleration (g)"': "g",
}


@pytest.mark.parametrize("words", [*STATED, *NAMED])
def test_units_are_read_as_a_header_or_the_names_of_columns_state_them(words, written):
    unit = {**STATED, **NAMED}[words]
    head = f"{TITLE}ACCELERATION TIME HISTORY {words}\nNPTS= 7, DT= .005 SEC\n{COLUMNS}"
    rows = "".join(f"{0.005 * i:.3f},{a}\n" for i, a in enumerate(SAMPLES))
    record = read_record(written(head if words in STATED else f"{words}\n{rows}"))
    assert record.dt == pytest.approx(0.005, rel=1e-12)
    assert record.samples == pytest.approx(UNITS[unit] * SAMPLES, rel=1e-15)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_an_asc_file_of_esm_or_itaca(end, written):
    text = (ASC_HEADER + ASC_COLUMN).replace("\n", end)
    record = read_record(written(text, "XX.ABC..HNE.D.19990102.030405.C.ACC.ASC"))
    assert record.dt == 0.005
    assert record.samples == pytest.approx(0.01 * SAMPLES, rel=1e-15)
    raw = ASC_HEADER.replace("ACCELERATION\n", "UNPROCESSED ACCELERATION\n")
    assert read_record(written(raw + ASC_COLUMN), "gal") == record


TABLES = [
    "t,a (g)\n0,1\n1,2\n2,4\n",
    "# units: g\n0;1\n1;2\n2;4\n",
    "# units: g\n0 1\n1 2\n2 4\n",
    "El Centro, NS, units: g\n0 1\n1 2\n# a remark\n\n2 4\n",
    "# integrated from: velocity\nTime Acceleration(g)\n0 1\n1 2\n2 4\n",
    "\ufefft [s];a [g];\n0;1;\n1;2;\n2;4;\n",
]
ALONE = {
    "1\n2\n4\n": 1.0,
    "# a title, units: g\n1 2 4\n": 1.0,
    "3 1.00\n1\n2\n4\n": None,
    "some label, units of g\n3 1.00\n1\n2\n4\n": 1.0,
}


@pytest.mark.parametrize("text", [*TABLES, *ALONE])
def test_tables_that_leave_no_doubt_and_samples_alone_with_their_step(text, written):
    path = written(text)
    record = read_record(path, "g", None, ALONE[text]) if text in ALONE else read_record(path)
    assert record.dt == 1.0
    assert record.samples.tolist() == [9.81, 19.62, 39.24]


STEP = "--units g --record-dt 0.02", "--record-dt must not be 0.02"
CONTRARY = [
    ("# units: g\n0 0.3\n0.1 0.3\n0.2 0.3\n", "--baseline constant --pga 1", "own constant trend"),
    ("0 1 5\n0.1 2 5\n0.2 3 5\n", "--units g --record-dt 0.1", "has 3 columns"),
    *((text, *STEP) for text in (AT2["series"], "3 0.01\n1\n2\n3\n", "0 1\n0.1 2\n0.2 2\n")),
]


@pytest.mark.parametrize(("text", "options", "words"), CONTRARY)
def test_options_that_a_file_contradicts_are_refused(text, options, words, written, capsys):
    refused(capsys, ["compare", *ASKED, written(text), *options.split()], "--record is", words)


def test_times_printed_in_few_decimals_are_equal_steps(written):
    rows = "".join(f"{i / 256:.4f} {i % 3}\n" for i in range(600))
    assert read_record(written(rows), "m/s2").dt == pytest.approx(1 / 256, rel=1e-4)


@settings(max_examples=200, deadline=None)
@given(
    samples=st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=40),
    unit=st.sampled_from(list(UNITS)),
    columns=st.integers(1, 9),
    end=st.sampled_from(["\n", "\r\n", "  \n"]),
    form=st.sampled_from(["at2", "asc", "comma", "semicolon", "blank"]),
)
def test_what_is_written_is_read(samples, unit, columns, end, form, tmp_path_factory):
    words = [repr(sample) for sample in samples]
    count = len(samples)
    if form == "at2":
        rows = [" ".join(words[at : at + columns]) for at in range(0, count, columns)]
        said = [f"ACCELERATION IN UNITS OF {unit.upper()}", f"NPTS= {count}, DT= .0050 SEC"]
    elif form == "asc":
        kind, step = "DATA_TYPE: ACCELERATION", "SAMPLING_INTERVAL_S: 0.005"
        said, rows = [kind, f"NDATA: {count}", f"UNITS: {unit}", step], words
    else:
        mark = {"comma": ",", "semicolon": ";", "blank": " "}[form]
        said = [f"t (s){mark}a ({unit})"]
        rows = [f"{at * 0.005:.4f}{mark}{word}" for at, word in enumerate(words)]
    path = tmp_path_factory.getbasetemp() / "form.txt"
    path.write_bytes("".join(f"{line}{end}" for line in (*said, *rows)).encode())
    record = Record.read(path)
    assert record.dt == pytest.approx(0.005, rel=1e-12)
    assert record.samples.tolist() == (UNITS[unit] * np.array(samples)).tolist()


def test_the_g_of_a_record_is_that_of_the_blocks(written):
    path = written("time_s,acceleration_g\n0,0\n0.1,1\n0.2,0\n")
    assert read_record(path, None).peak == GRAVITY == RigidBlock(width=1.0, height=2.0).gravity
    guide = (ROOT / "studies" / "GUIDE.md").read_text()
    assert f"{100.0 * (GRAVITY / standard_gravity - 1.0):.3f} % more" in guide


GOOD = AT2["series"]
ROWS = "0.0 0.1\n0.1 0.2\n0.2 -0.3\n"
COMMAS = ROWS.replace(" ", ",")
TWICE = AT2["said twice"]


def table(*times, header="# units: g\n"):
    return header + "".join(f"{time} 0.1\n" for time in times)


def at2(line):
    return f"{TITLE}{line}\nNPTS= 7, DT= .005 SEC\n{COLUMNS}"


def asc(old, new):
    assert old in ASC_HEADER
    return ASC_HEADER.replace(old, new) + ASC_COLUMN


# (what is the matter, text or bytes, --units, words of the refusal)
DOUBTS = [
    ("velocity", at2("VELOCITY TIME SERIES IN UNITS OF CM/S"), None, "line 3 speaks of velocity"),
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
    ("digits and a letter", ROWS.replace("0.2\n", f"{40 * '9'}x\n"), "g", "must be a number"),
    ("a long word", ROWS.replace("0.2\n", "9x" * 3000 + "\n"), "g", "must be a number"),
    ("UTF-16", ROWS.encode("utf-16"), "g", "line 1: the byte 0xff is not text"),
    ("times in ms", f"t_ms,acc_g\n{COMMAS}", None, "its times are in 'ms'"),
    ("a step in ms", GOOD.replace("SEC,", "MSEC,"), None, "says nothing as dt; it must"),
    ("swapped names", f"a (g), t (s)\n{COMMAS}", None, "'a (g)' and 't (s)'; they must be time"),
    ("swapped numbers", "0.1 0.00\n0.2 0.01\n0.3 0.02\n", "g", "both columns increase in equal"),
    ("two counts", TWICE.replace("7 points", "8 points"), None, "says 8 and 7 as count"),
    ("two steps", TWICE.replace("DT= .005", "DT= .006"), None, "says 0.005 and 0.006"),
    ("no step", GOOD.replace(", DT=   .0050 SEC,", ""), None, "says nothing as dt"),
    ("no end", AT2["no count"].replace("*** End Data ***", ""), None, "columns"),
    ("after the end", f"{AT2['begin and end']}0.1\n", None, "line 10: '***' must be a number"),
    ("VT2", GOOD, None, "it must be a file of acceleration, as AT2 files are"),
    ("ASC, velocity", asc("DATA_TYPE: ACCELERATION", "DATA_TYPE: VELOCITY"), "g", "TYPE: VELOCITY"),
    ("ASC, spectrum", asc(": ACCELERATION", ": ACCELERATION SPECTRUM"), None, "SPECTRUM"),
    ("ASC, cm/s", asc("UNITS: cm/s^2", "UNITS: cm/s"), None, "line 14 states 'cm/s'"),
    ("ASC, no units", asc("UNITS: cm/s^2\n", ""), None, "does not state its units"),
    ("ASC, odd count", asc("NDATA: 7", "NDATA: 7.5"), None, "must hold the 7.5 of its header"),
    ("ASC, twice", asc("USER1:\nUSER1:", "NDATA: 8"), None, "says 7 and 8 as count"),
    ("ASC, short", ASC_HEADER + ASC_COLUMN[:30], None, "holds 4 samples; it must hold the 7"),
    ("ASC, NaN", ASC_HEADER + ASC_COLUMN.replace("0.4", "NaN"), None, "line 24: 'NaN00000' must"),
    ("ASC, two columns", ASC_HEADER + ASC_COLUMN.replace("\n", " 1\n"), None, "holds 14 samples"),
    ("other units", GOOD, "m/s2", "it states g; --units must not be m/s2"),
    ("one too many", GOOD + "0.1\n", None, "holds 8 samples; it must hold the 7 of its header"),
    ("a word", GOOD.replace("-.1", "x"), None, "line 6: 'x' must be a number"),
    ("no units", GOOD.replace("UNITS OF G", "V"), None, "does not state its units; --units must"),
    ("a gap", table(0, 0.1, 0.2, 0.4), None, "line 5: the time 0.4 s follows 0.2 s"),
    ("uneven", table(0, 0.1, 0.2, 0.31, 0.4, 0.5), None, "line 5: the time 0.31 s"),
    ("twice", table(0, 0.1, 0.1, 0.2), None, "line 4: the time 0.1 s follows 0.1 s"),
    ("one row", table(0), None, "1 rows of numbers; it must have two"),
    ("two units", table(0, 0.1, header="a (g) and b (gal)\n"), None, "several units, g, gal"),
    ("words at the end", "0 0.1\nend of data\n", None, "line 2: 'end' must be a number"),
    ("COSMOS", "Corrected acceleration   (Format v01.20 with 13 text lines)\n", "g", "COSMOS"),
    ("SMC", "2 CORRECTED ACCELEROGRAM\n*\n", "g", "another format, SMC"),
    ("SMC, unknown", "0 UNKNOWN                 ORIGIN\n*\n", "g", "another format, SMC"),
    ("SIMBAD", "SIMBAD v06, record 12, acceleration in m/s2\n0.1\n0.2\n", None, "format, SIMBAD"),
    ("touching", GOOD.replace("0.0000000E+00", "1.8E-06-1.2E-06"), None, "that stand apart"),
    ("one column", "# units: g\n0.1\n0.2\n0.3\n", None, "it has one column; --record-dt, or a"),
    ("npts dt, short", "4 0.01\n0.1\n0.2\n0.3\n", "g", "3 samples; it must hold the 4 of its"),
    ("CSMIP", "Corrected Accelerogram Caltech Vol II\n", "g", "another format, CSMIP"),
    ("GeoNet", "Uncorrected accelerogram 1999_ABC GNS Science\n", "g", "CSMIP or GeoNet"),
    ("K-NET", "Origin Time       1999/01/02 03:04:05\n", "g", "another format, K-NET"),
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
    assert len(message.replace("\n", 300 * " ")) < len(str(path)) + 300
    with pytest.raises(ValueError, match=r"^path is "):
        Record.read(path, units)


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


IN_G = ["compare", *BLOCK, "--units", "g", "--record"]
BEGIN = "rocking: --record is "


@pytest.mark.parametrize("content", [b"0 0\n" * (MOST_WORDS // 2 + 1), MOST_BYTES + 1])
def test_a_file_that_is_too_long_is_refused_at_once(content, tmp_path, capsys):
    path = tmp_path / "long.AT2"
    path.write_bytes(b"" if isinstance(content, int) else content)
    if isinstance(content, int):
        os.truncate(path, content)
    refused(capsys, [*IN_G, path], BEGIN, "it must hold at most 2500000 words, in 64000000 bytes")
