"""Compiled plain-float code under the friendly modules: no unit, class or plot is known here."""
