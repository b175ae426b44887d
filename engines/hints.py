"""What landing steps know of the block before the run, and how to falsify it."""

from dataclasses import dataclass

from analytic.checks import positive


@dataclass(frozen=True, slots=True, kw_only=True)
class Hints:
    """By how much what landing steps expect is wrong: for measuring what they lean on.

    Steps that land expect an uplift where the base's acceleration passes g tan(alpha), about the
    corner that it pushes towards, and a swing from one impact to the next as long as a block falls
    from one corner with p^2 sin(alpha). They choose how long a step is by it, and how the contact
    holds; what then happens is the engine's.

    Parameters
    ----------
    onset : float, optional
        The acceleration that is expected to lift the block, over g tan(alpha).
    fall : float, optional
        The angular acceleration of a block on one corner, over p^2 sin(alpha).
    swapped : bool, optional
        Expect every uplift about the other corner.

    Raises
    ------
    ValueError
        If a factor is not positive.
    """

    onset: float = 1.0
    fall: float = 1.0
    swapped: bool = False

    def __post_init__(self) -> None:
        for name in ("onset", "fall"):
            object.__setattr__(self, name, positive(name, getattr(self, name)))


TRUE = Hints()
"""What is so."""
