"""Axes that a notebook shows."""

from io import BytesIO

from matplotlib.axes import Axes


class ShownAxes(Axes):
    """Axes of a figure that pyplot does not know, which a notebook would show as a line of text."""

    def _repr_png_(self) -> bytes:
        """Return the picture of the figure."""
        picture = BytesIO()
        if (figure := self.get_figure(root=True)) is not None:
            figure.savefig(picture, format="png")
        return picture.getvalue()
