"""What the ironing studies read from a run."""
import numpy as np


def detrended(values, columns):
    """Largest minus smallest residual of a least-squares fit."""
    design = np.stack(columns, axis=1)
    rest = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    return np.ptp(rest)


class Slide:
    """What the sliding part of one history says."""

    def __init__(self, run):
        h = {name: np.array(column) for name, column in run.history.items()}
        sliding = h["step"] >= 20
        self.s, self.px, self.py = h["top_ux"][sliding], h["top_rx"][sliding], h["top_ry"][sliding]
        middle = self.s - 0.15
        # raw: all sliding steps (21 to 500); detrended: sliding steps 11 to 480, so that every run is treated alike
        self.raw = np.ptp(self.py[1:]), np.ptp(self.px[1:])
        late = slice(11, None)
        self.smooth = (detrended(self.py[late], [np.ones_like(middle[late]), middle[late] ** 2]),
                       detrended(self.px[late], [middle[late]]))
        self.mean = abs(self.py.mean())
        self.whole = len(self.s) == 481
        if self.whole:
            self.symmetry = (abs(self.py - self.py[::-1]).max(), abs(self.px + self.px[::-1]).max())
        self.penetration = h["penetration"].max()


def dofs(check):
    """All control values, those of the boundary conditions included, from the text of --check."""
    return next(int(line.split()[1]) for line in check.splitlines() if line.startswith("dofs"))
