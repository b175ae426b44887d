"""Which setting of which engine for which accuracy, and which one mends what users see."""

from studies.advise.advice import STUDY, command
from studies.advise.symptoms import STUDY as SYMPTOMS

__all__ = ["STUDY", "SYMPTOMS", "command"]
