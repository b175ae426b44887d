"""Which setting of which engine for which accuracy, and which one mends what users see."""

from studies.advise.advice import STUDY, command

__all__ = ["STUDY", "command"]
