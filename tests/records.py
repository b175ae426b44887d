"""Records in the forms of their archives: made-up samples below headers with other facts."""

import numpy as np

from analytic import GRAVITY

SAMPLES = np.array([0.0, 0.1, -0.25, 0.4, 0.05, -0.1, 0.0])
COLUMNS = "  0.0000000E+00  1.0000000E-01 -2.5000000E-01\n   .4000000E+00  .5000000E-01 -.1\n 0\n"
TITLE = "PEER STRONG MOTION DATABASE RECORD. PROCESSING BY SOMEBODY.\nSOMEWHERE 01/02/99, ABC, N\n"

AT2 = {
    "filter points": (
        f"{TITLE}ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.02 Hz LP=20.0 Hz\n"
        f"NPTS= 7, DT= .00500 SEC\n{COLUMNS}"
    ),
    "lower case": (
        f"{TITLE}ACCELERATION TIME HISTORY IN UNITS OF G. \nNPTS= 7, dt= .005\n{COLUMNS}"
    ),
    "series": (
        f"{TITLE}ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=      7, DT=   .0050 SEC,\n{COLUMNS}"
    ),
    "poles": (
        f"{TITLE}ACCELERATION TIME SERIES IN UNITS OF G\n"
        f"NPTS=   7, DT=   .0050 SEC, 0 POLE @ 30.00000 HZ, 4 POLE @ .1 HZ\n{COLUMNS}"
    ),
    "rotated": (
        "Orig PEER filename = SOME/WHERE_233_FN.acc, Scale factor = 2.5 \n"
        "  rotation angle - clockwise   -37.0\n  FN component, azimuth =   233.0\n"
        f"  Acceleration in g\n7 0.0050 NPTS, DT \n{COLUMNS}"
    ),
    "capitals, CRLF": (
        f"{TITLE}ACCELERATION IN G\n  7    0.0050   NPTS, DT\n{COLUMNS}".replace("\n", "\r\n")
    ),
    "trailing blanks": (
        f"{TITLE}ACCELERATION TIME SERIES IN UNITS OF G   \nNPTS= 7, DT= .0050 SEC   \n"
        f"{COLUMNS}".replace("\n", "  \n")
        + "\n \n"
    ),
    "begin and end": (
        "Data for somewhere, North South Component\n7 points at equal spacing of 0.005 sec\n"
        "Points are listed in the format of 8F10.5, i.e., 8 points across in\na row\n"
        f"The units are (g)\n*** Begin data ***\n{COLUMNS}*** End Data ***\n\n"
    ),
    "said twice": (
        "7 points at equal spacing of 0.005 sec\nThe units are (g)\n*** Begin data ***\n"
        f"NPTS=  7, DT= .00500 SEC\n{COLUMNS}*** End Data ***\n"
    ),
    "step first": f"{TITLE}ACCELERATION IN G\nDT=.005 NPTS=7\n{COLUMNS}",
    "no count": (
        f"{TITLE}ACCELERATION TIME HISTORY IN UNITS OF G\nDT= .005 SEC\n{COLUMNS}*** End Data ***\n"
    ),
}

ASC_HEADER = """\
EVENT_NAME: SOMEWHERE: A TEST
EVENT_ID: XX-1999-0001
EVENT_DATE_YYYYMMDD: 19990102
MAGNITUDE_L:
NETWORK: XX
STATION_NAME: ABC
STATION_ELEVATION_M: 12
SITE_CLASSIFICATION_EC8: B*
DATE_TIME_FIRST_SAMPLE_YYYYMMDD_HHMMSS: 19990102_030405.000
SAMPLING_INTERVAL_S: 0.005000
NDATA: 7
DURATION_S: 0.030
STREAM: HNE
UNITS: cm/s^2
FULL_SCALE_G:
PGA_CM/S^2: 0.4
BASELINE_CORRECTION: BASELINE REMOVED
DATA_TYPE: ACCELERATION
USER1:
USER1:
"""
ASC_COLUMN = "".join(f"{sample:.6f}\n" for sample in SAMPLES)


def write_record(path, record):
    """Write a record as an AT2 file, in g."""
    words = " ".join(repr(float(a)) for a in record.samples / GRAVITY)
    count, dt = record.samples.size, float(record.dt)
    path.write_text(f"{TITLE}ACCELERATION IN UNITS OF G\nNPTS= {count}, DT= {dt!r} SEC\n{words}\n")
    return path
