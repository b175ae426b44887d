"""Overturning maps: which pulses overturn a block, and who predicts that wrongly."""

from studies.overturning.study import STUDY, command

__all__ = ["STUDY", "command"]
