"""What cannot be used is refused in one line."""


class BadInputError(Exception):
    """One line that names the argument, its value and what is allowed."""
