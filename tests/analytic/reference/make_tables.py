"""Solve the exact equations of rocking with 30 digits; write the tables beside this file.

Independent of the package: equations (1) and (2) as printed, by mpmath's own Taylor method, events
by bisection and the secant method, and free rocking by conservation of energy. Cases that the scan
cannot follow are left out, and named on the way, and so are pulses of hundreds of 1/p.

Run: python tests/analytic/reference/make_tables.py
"""

import csv
import math
import sys
from pathlib import Path

import mpmath as mp

from studies.cases.extreme import extremes

mp.mp.dps = 30
G = mp.mpf("9.81")
SCAN = 60

HERE = Path(__file__).parent
# taken as the doubles they are read as
with (HERE / "exact.csv").open(newline="") as kept:
    CASES = [(*map(float, row[:4]), int(row[4])) for row in [*csv.reader(kept)][1:]]


def solve(width, height, amplitude, omega, half_cycles, restitution=None):
    """Return (peak/alpha or inf, impact times during the pulse); Housner's ratio by default."""
    B, H, a, w = (mp.mpf(x) for x in (width, height, amplitude, omega))
    alpha, R = mp.atan(B / H), mp.sqrt(B * B + H * H) / 2
    p2 = 3 * G / (4 * R)
    eta = 1 - mp.mpf(3) / 2 * mp.sin(alpha) ** 2 if restitution is None else mp.mpf(restitution)
    end = half_cycles * mp.pi / w
    if abs(a) <= G * B / H:
        return mp.mpf(0), []
    t = mp.asin(G * B / H / abs(a)) / w
    side = -1 if a > 0 else 1
    theta, rate, peak, impacts = mp.mpf(0), mp.mpf(0), mp.mpf(0), []
    while True:

        def equation(time, state, s=side):
            z = s * alpha - state[0]
            return [state[1], -p2 * (mp.sin(z) + a * mp.sin(w * time) / G * mp.cos(z))]

        path = mp.odefun(equation, t, [theta, rate])
        grid = [t + (end - t) * i / SCAN for i in range(SCAN + 1)]
        values = [path(time) for time in grid]
        hit = next((i for i in range(1, SCAN + 1) if side * values[i][0] < 0), None)
        if hit == 1:
            raise ValueError("an excursion is shorter than the scan; choose another case")
        stop = end if hit is None else root(path, 0, grid[hit - 1], grid[hit])
        for i in range(1, SCAN + 1):
            if grid[i - 1] < stop and values[i - 1][1] * values[i][1] < 0:
                turn = root(path, 1, grid[i - 1], grid[i])
                peak = max(peak, side * path(turn)[0] if turn < stop else 0)
        theta, rate = path(stop)
        peak = max(peak, side * theta)
        if peak > mp.pi / 2:
            return mp.inf, impacts
        if hit is None:
            break
        impacts.append(stop)
        t, theta, rate, side = +stop, mp.mpf(0), eta * rate, -side
    energy = (rate**2 / 2 + p2 * mp.cos(alpha - side * theta)) / p2
    if side * rate < 0:
        energy = mp.cos(alpha) + eta**2 * (energy - mp.cos(alpha))
    ahead = mp.inf if energy >= 1 else alpha - mp.acos(energy)
    return max(peak, ahead) / alpha, impacts


def root(path, component, low, high):
    """Bisect to 1e-6 of the bracket, then use Anderson-Bjoerck in what is left."""

    def f(x):
        return path(x)[component]

    for _ in range(20):
        middle = (low + high) / 2
        if f(low) * f(middle) <= 0:
            high = middle
        else:
            low = middle
    return mp.findroot(f, (low, high), solver="anderson", tol=mp.mpf(10) ** -50, verify=False)


SIZES = ["width", "height", "amplitude", "omega", "half_cycles"]
SLOWEST = 0.1
"""Pulses of a lower ω/p take hours at 30 digits."""


def write(name, columns, rows):
    with (HERE / name).open("w", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(columns)
        for row in rows:
            table.writerow(row)
            file.flush()
            print(*row, flush=True)


def exact():
    for case in CASES:
        peak, impacts = solve(*case)
        yield *case, mp.nstr(peak, 25), " ".join(mp.nstr(time, 25) for time in impacts)


def extreme():
    for case in extremes(False):
        block, motion = case.block, case.motion
        restitution = None if math.isnan(case.restitution) else case.restitution
        asked = (block.width, block.height, motion.amplitude, motion.omega, motion.half_cycles)
        if case.omega_over_p < SLOWEST:
            print(f"{case.name}: left out, too long a pulse", file=sys.stderr, flush=True)
        elif case.applies("exact"):
            try:
                peak, _ = solve(*asked, restitution)
                yield case.name, *asked, restitution, mp.nstr(peak, 25)
            except ValueError as error:
                print(f"{case.name}: left out, {error}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    write("exact.csv", [*SIZES, "peak_ratio", "impact_times"], exact())
    write("extreme.csv", ["case", *SIZES, "restitution", "peak_ratio"], extreme())
