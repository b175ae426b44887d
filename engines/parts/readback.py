"""Reading back: a library that takes a setting and does not keep it makes a failed run."""

import math
from collections.abc import Mapping
from typing import Any

from engines.world import ROUNDINGS


def disagreement(pairs: Mapping[str, tuple[Any, Any]], rounding: float = 2.0**-53) -> str:
    """Name the first setting that reads back as something else, or return an empty string.

    Parameters
    ----------
    pairs : mapping
        Name -> what was set, and what was read. What was left to the library, None, is not held.
    rounding : float, optional
        Relative rounding of the engine's numbers.
    """
    near = max(1e-9, ROUNDINGS * rounding)
    for name, (wanted, found) in pairs.items():
        if wanted is None or wanted == found:
            continue
        if isinstance(wanted, str) or not math.isclose(wanted, found, rel_tol=near):
            return f"{name} was set to {wanted!r} but reads {found!r}"
    return ""
