"""Recorded accelerograms: each form is read as its header says, scaled, corrected, and told."""

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
from studies.__main__ import run
from studies.cases.accelerograms import read_record

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
    """Return the rows of each source, and the text, in which a note is said once."""
    code, rows = compared(capsys, *ASKED, path, *options)
    assert code == run(["compare", *ASKED, str(path), *options]) == 0
    (message,) = {row["message"] for row in rows.values()}
    assert capsys.readouterr().out.count(message) == 1 or not message
    return rows["exact"], message


def test_a_velocity_that_does_not_end_at_zero_is_reported(tmp_path, capsys):
    """An offset of 0.01 g for 2 s is 0.1962 m/s. It is said, and nothing is changed."""
    path = shaken(tmp_path, 0.01)
    for options in ([], ["--baseline", "none"]):
        assert "velocity ends at 0.196 m/s, 0.21 of its largest" in told(path, capsys, *options)[1]
    assert told(shaken(tmp_path, 0.0), capsys)[1] == ""


@pytest.mark.parametrize("baseline", ["constant", "linear"])
def test_a_baseline_is_corrected_by_a_named_method(baseline, tmp_path, capsys):
    """As SciPy's detrend does, before the record is scaled; and the answer says so."""
    path, options = shaken(tmp_path, 0.03), ["--baseline", baseline, "--pga", "0.35"]
    left = detrend(read_record(path).samples, type=baseline)
    record = Record(dt=0.005, samples=left).scaled_to(0.35 * GRAVITY)
    expected = simulate(RigidBlock(width=0.5, height=1.5), record).peak_ratio
    exact, message = told(path, capsys, *options)
    assert exact["peak_ratio"] == pytest.approx(expected, rel=1e-9)
    assert message.startswith(f"baseline corrected by detrend, {baseline}")


def test_nothing_but_a_trend_is_refused(tmp_path, capsys):
    path = tmp_path / "motion.txt"
    path.write_text("# units: g\n0 0.3\n0.1 0.3\n0.2 0.3\n")
    asked = ["compare", *ASKED, path, "--baseline", "constant", "--pga", "1"]
    refused(capsys, asked, "--record is", "the record is its own constant trend")


@pytest.fixture
def written(tmp_path):
    """Return what writes a text into a file, its line ends as they are."""

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


@pytest.mark.parametrize(
    ("stated", "unit"),
    [
        ("IN UNITS OF CM/SEC/SEC", "cm/s2"),
        ("IN UNITS OF CM/SEC2.", "cm/s2"),
        ("IN UNITS OF M / S^2", "m/s2"),
        ("(M/S/S)", "m/s2"),
        ("IN MM/S2", "mm/s2"),
        ("[milli-g], UNITS=MG", "mg"),
        ("(Gal)", "gal"),
        ("IN cm s-2", "cm/s2"),
    ],
)
def test_units_are_read_as_the_header_states_them(stated, unit, written):
    head = f"{TITLE}ACCELERATION TIME HISTORY {stated}\nNPTS= 7, DT= .005 SEC\n"
    record = read_record(written(head + COLUMNS))
    assert record.samples == pytest.approx(UNITS[unit] * SAMPLES, rel=1e-15)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_an_asc_file_of_esm_or_itaca(end, written):
    text = (ASC_HEADER + ASC_COLUMN).replace("\n", end)
    record = read_record(written(text, "XX.ABC..HNE.D.19990102.030405.C.ACC.ASC"))
    assert record.dt == 0.005
    assert record.samples == pytest.approx(0.01 * SAMPLES, rel=1e-15)
    raw = ASC_HEADER.replace("ACCELERATION\n", "UNPROCESSED ACCELERATION\n")
    assert read_record(written(raw + ASC_COLUMN), "gal") == record


SPELLED = {"m/s²": "m/s2", "cm/s^2": "cm/s2", "CM/SEC/SEC": "cm/s2", "Gal": "gal"}


@pytest.mark.parametrize(
    "names",
    [
        "Time [sec], Acceleration [m/s²]",
        "# units: cm/s^2",
        "% UNITS OF CM/SEC/SEC",
        "time (s) acceleration (Gal)",
        "t / s,a / g",
        "t,a (g)",
        "Elapsed time (sec),Ground acceleration N-S (g)",
        '"Time (sec.)","Acceleration (g)"',
    ],
)
def test_names_above_the_columns_say_time_and_acceleration_with_its_unit(names, written):
    rows = "".join(f"{5 * i},{a}\n" for i, a in enumerate(SAMPLES))
    record = read_record(written(f"{names}\n{rows}"))
    unit = next((unit for word, unit in SPELLED.items() if word in names), "g")
    assert record.dt == 5.0
    assert record.samples == pytest.approx(UNITS[unit] * SAMPLES, rel=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "t,a (g)\n0,1\n1,2\n2,4\n",
        "# units: g\n0;1\n1;2\n2;4\n",
        "# units: g\n0 1\n1 2\n2 4\n",
        "El Centro, NS, units: g\n0 1\n1 2\n# a remark\n\n2 4\n",
        "# integrated from: velocity\nTime Acceleration(g)\n0 1\n1 2\n2 4\n",
        "\ufefft [s];a [g];\n0;1;\n1;2;\n2;4;\n",
    ],
)
def test_tables_that_leave_no_doubt(text, written):
    record = read_record(written(text))
    assert record.dt == 1.0
    assert record.samples[:2].tolist() == [9.81, 19.62]


@pytest.mark.parametrize(
    ("text", "dt"),
    [
        ("0.1\n0.2\n-0.3\n", 0.005),
        ("# a title, units: g\n0.1 0.2 -0.3\n", 0.005),
        ("3 0.0050\n0.1\n0.2\n-0.3\n", None),
        ("some label, units of g\n3 0.0050\n0.1\n0.2\n-0.3\n", 0.005),
    ],
)
def test_one_column_with_a_step(text, dt, written):
    """The step is given, or stands with the number of samples above them."""
    record = read_record(written(text), "g", None, dt)
    assert record.dt == 0.005
    assert record.samples == pytest.approx([0.981, 1.962, -2.943], rel=1e-15)


@pytest.mark.parametrize("text", [AT2["series"], "3 0.01\n1\n2\n3\n", "0 1\n0.1 2\n0.2 2\n"])
def test_a_step_that_the_file_states_otherwise_is_refused(text, written, capsys):
    asked = ["compare", *ASKED, written(text), "--units", "g", "--record-dt", "0.02"]
    refused(capsys, asked, "--record is", "--record-dt must not be 0.02")


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
    """Any samples in any form, unit and layout, to the last digit that is printed."""
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


def test_the_g_of_a_record_is_that_of_the_blocks(tmp_path):
    path = tmp_path / "record.csv"
    path.write_text("time_s,acceleration_g\n0,0\n0.1,1\n0.2,0\n")
    assert read_record(path, None).peak == GRAVITY == RigidBlock(width=1.0, height=2.0).gravity
    guide = (ROOT / "studies" / "GUIDE.md").read_text()
    assert f"{100.0 * (GRAVITY / standard_gravity - 1.0):.3f} % stronger" in guide
