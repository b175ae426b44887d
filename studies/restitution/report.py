"""What was found of restitution, in words and as a table."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import pandas as pd

from engines.parts.drop import SHOWN, Drop
from engines.run.strike import Strike
from studies.measures.words import listed
from studies.restitution import drops, strikes
from studies.restitution.asked import PHASES

GOOD = 0.05
"""A coefficient that comes out within this is kept."""

USUAL = f"{drops.BASE.dt_s:g} s, {drops.BASE.speed:g} m/s and {drops.BASE.radius:g} m"
"""From which one thing at a time is varied."""


def _ranges(base: Drop | Strike, varied: Mapping[str, Sequence[float]], words: str) -> str:
    """Return from where to where things are varied; words name them in their order."""
    ends = [(*values, getattr(base, name)) for name, values in varied.items()]
    parts = zip(words.split(", "), ends, strict=True)
    return listed([word.format(f"{min(e):.2g} to {max(e):.2g}") for word, e in parts])


RANGES = _ranges(drops.BASE, drops.VARIED, "steps of {} s, speeds of {} m/s, radii of {} m")
BLOCK_RANGES = _ranges(
    strikes.BASE, strikes.VARIED, "steps of {}/p, rates of {} α p, heights of {} m, H/B of {}"
)
"""Over what drops and strikes are varied."""

LOST = (
    "Slow bounces are lost where the weight takes their speed within a step, or where a library "
    "lets nothing bounce below a speed that it has set."
)
"""Why a way that holds at first does not over all that is varied."""


def findings_text(lines: pd.DataFrame, blocks: pd.DataFrame) -> str:
    """Return both tables as text."""
    drop, block = drops.BASE, strikes.BASE
    return f"""\
Largest difference of the speed of a dropped sphere after over before its impact from
the coefficient that is wanted, 0 to 1, at {drop.dt_s:g} s, {drop.speed:g} m/s and a radius of
{drop.radius:g} m, wherever in a step the impact falls ({len(PHASES)} places); over
{RANGES}. DT is the step in seconds:
{kept_text(lines)}

Largest difference of the angular rate of a block after over before an impact from
1 - 3/2 (1 + e) sin^2(alpha), H/B {block.aspect:g}, {block.height:g} m high, {block.rate:g} alpha p
at the impact, in steps of {block.step:g}/p, wherever in a step the impact falls; over
{BLOCK_RANGES}; that of the corner's speed upwards over that of its
approach from e; and its largest speed along the base, over the same:
{struck_text(blocks)}"""


def struck_text(blocks: pd.DataFrame) -> str:
    """Return what blocks keep, engine by engine."""
    return _by_engine(
        blocks,
        lambda row: (
            f"{_off(row['off'])}; over steps {_off(row['off_p_dt'])}, rates "
            f"{_off(row['off_rate_over_alpha_p'])}, heights {_off(row['off_height_m'])}, "
            f"slenderness {_off(row['off_aspect'])}; corner {_off(row['corner'])}, along "
            f"{_off(row['slide'])}"
        ),
    )


def kept_text(lines: pd.DataFrame) -> str:
    """Return how far off each way is, engine by engine, and what is set."""
    return _by_engine(
        lines,
        lambda row: (
            f"{_off(row['off'])}; over steps {_off(row['off_dt_s'])}, speeds "
            f"{_off(row['off_speed'])}, sizes {_off(row['off_radius'])}{_broken(row['broken'])}\n"
            f"    for {SHOWN:g}: {row['literal']}"
        ),
    )


def _by_engine(lines: pd.DataFrame, words: Callable[["pd.Series[Any]"], str]) -> str:
    """Return what is said of each way, below the name of its engine."""
    parts = []
    for engine, group in lines.groupby("engine", sort=False):
        ways = [f"  {row['way']}: {words(row)}" for _, row in group.iterrows()]
        parts += [str(engine), *ways]
    return "\n".join(parts)


def _off(value: float) -> str:
    return "broken" if value == math.inf else f"{value:.3f}"


def _broken(count: int) -> str:
    return f"; {count} drops broken" if count else ""


def best_of(lines: pd.DataFrame, by: str = "off_over_all") -> pd.DataFrame:
    """Return the way of each engine that is off least in a column."""
    return lines.loc[lines.groupby("engine", sort=False)[by].idxmin()]


def first_claim(lines: pd.DataFrame) -> str:
    """Say how well the engines keep a coefficient at best, and who does not as first asked."""
    best = best_of(lines)
    first = lines.drop_duplicates("engine")
    lost = list(first.loc[first["off"] > 10.0 * GOOD, "engine"])
    beside = f"; asked in the first way that comes to mind, {listed(lost)} miss it" if lost else ""
    return (
        "Of a coefficient of restitution from 0 to 1 a dropped sphere keeps, with each engine's "
        f"best setting, all but {_ends(best, 'off_over_all')} over {RANGES}, and all but "
        f"{_ends(best, 'off')} at {USUAL}{beside}."
    )


def _ends(best: pd.DataFrame, column: str) -> str:
    """Return the least and the largest of a column, and of which engine."""
    ends = best.sort_values(column).iloc[[0, -1]].to_dict("records")
    return " to ".join(dict.fromkeys(f"{_off(row[column])} in {row['engine']}" for row in ends))


def settings_claim(lines: pd.DataFrame) -> str:
    """Say with which setting each engine keeps a coefficient best."""
    words = [
        f"in {row['engine']} to {_off(row['off_over_all'])} ({_off(row['off'])}) by "
        f"{row['literal']}"
        for row in best_of(lines).to_dict("records")
    ]
    return (
        f"It is kept, here one of {SHOWN:g}, over {RANGES} (at {USUAL}), DT being the step in "
        f"seconds, {'; '.join(words)}."
    )


def block_claim(blocks: pd.DataFrame) -> str:
    """Say by which engines a rocking block keeps what the theory says, and by which it does not.

    Each is asked in the way in which its corner comes off best.
    """
    best = best_of(blocks, "corner")
    near, far = best[best["off"] <= GOOD], best[best["off"] > GOOD]
    words = [
        f"within {near['off'].max():.3f} in {listed(list(near['engine']))}, and within "
        f"{near['off_over_all'].max():.3f} over {BLOCK_RANGES}"
    ] * bool(len(near))
    for row in far.to_dict("records"):
        slides = f", its corner sliding at {_off(row['slide'])} times the speed of its approach"
        words.append(
            f"off by up to {_off(row['off'])} in {row['engine']}"
            + slides * bool(row["slide"] > GOOD)
        )
    return (
        "A block that strikes with a corner should keep 1 - 3/2 (1 + e) sin² α of its rate, "
        f"Housner's for e = 0: it does {'; it is '.join(words)}."
    )


OVER = {
    "a sphere": ("off", "off_dt_s", "off_speed", "off_radius"),
    "a block's rate": ("off", "off_p_dt", "off_rate_over_alpha_p", "off_height_m", "off_aspect"),
}
"""What was asked -> the columns of how far off it is, at first and over what is varied."""


def told(lines: pd.DataFrame, asked: str) -> str:
    """Say which ways hold over steps, speeds and sizes, and which would but for slow impacts."""
    columns = list(OVER[asked])
    ways = lines["engine"] + "'s " + '"' + lines["way"] + '"'
    all_over = lines[columns].max(axis=1) <= GOOD
    at_first = (lines["off"] <= GOOD) & ~all_over
    held = listed(list(ways[all_over])) if all_over.any() else "no way"
    sentence = f"Within {GOOD:g} of what {asked} should keep, over all that is varied: {held}"
    if at_first.any():
        sentence += f"; at the first step, speed and size alone: {listed(list(ways[at_first]))}"
    return f"{sentence}."
