"""The ironing problem: oscillation of the reactions over basis, order and mesh, cost against accuracy [bases=L1,N3 meshes=1,2,3]."""
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import common

bases = ["L1", "L2", "L3", "L4", "N2", "N3", "N4"]
meshes = [1, 2, 3]
for argument in sys.argv[1:]:
    name, value = argument.split("=")
    if name == "bases":
        bases = value.split(",")
    elif name == "meshes":
        meshes = [int(item) for item in value.split(",")]
    else:
        sys.exit(f"unknown argument {argument}; known: bases=, meshes=")
partial = bases != ["L1", "L2", "L3", "L4", "N2", "N3", "N4"] or meshes != [1, 2, 3]


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


def dofs(run):
    """All control values, those of the boundary conditions included."""
    return next(int(line.split()[1]) for line in run.check.splitlines() if line.startswith("dofs"))


rows, slides = [], {}
for basis in bases:
    for mesh in meshes:
        label = f"ironing_{basis}_{mesh}"
        run = common.Run("inputs/ironing.inp", label, basis=basis[0], p=basis[1], mesh=mesh)
        run.check = common.check("inputs/ironing.inp", basis=basis[0], p=basis[1], mesh=mesh)
        if not run.history or max(run.history["step"]) < 40:
            rows.append([basis, mesh, dofs(run), "failed", "", "", "", "", "", ""])
            continue
        slide = Slide(run)
        slides[basis, mesh] = dofs(run), slide, run
        steps = int(max(run.history["step"]))
        rows.append([
            basis, mesh, dofs(run), "" if run.status == 0 else f"stops at step {steps}",
            f"{slide.raw[0]:.2e}", f"{slide.raw[1]:.2e}", f"{slide.smooth[0]:.2e}", f"{slide.smooth[1]:.2e}",
            f"{slide.symmetry[0]:.0e} / {slide.symmetry[1]:.0e}" if slide.whole else "",
            int(run.iterations), int(sum(run.history["cutbacks"])),
            f"{run.seconds:.1f}", f"{1e3 * run.seconds / run.iterations:.1f}"])
        print(rows[-1], flush=True)

header = ["basis", "mesh", "dofs", "end", "raw Py", "raw Px", "detrended Py", "detrended Px", "symmetry Py / Px",
          "iterations", "cut-backs", "time [s]", "per iteration [ms]"]
if partial:
    print(*header, sep="\t")
    for row in rows:
        print(*row, sep="\t")
    sys.exit()
common.table("ironing", header, rows)

colours = dict(zip(bases, ["#bbbbbb", "#e0a030", "#d06020", "#a01010", "#80b0e0", "#3070c0", "#103080"]))
for mesh in meshes:
    figure, axes = plt.subplots(1, 2, figsize=(11, 4))
    for basis in bases:
        if (basis, mesh) not in slides:
            continue
        slide = slides[basis, mesh][1]
        axes[0].plot(slide.s, -slide.py, lw=0.9, color=colours[basis], label=basis)
        axes[1].plot(slide.s, slide.px, lw=0.9, color=colours[basis], label=basis)
    axes[0].set(xlabel="slide s", ylabel="vertical reaction", title=f"mesh {mesh}")
    axes[1].set(xlabel="slide s", ylabel="horizontal reaction", title=f"mesh {mesh}")
    axes[0].legend(ncol=2, fontsize=8)
    figure.tight_layout()
    common.figure(figure, f"ironing_history_{mesh}")

figure, axes = plt.subplots(1, 3, figsize=(14, 4.2))
for basis in bases:
    done = [slides[basis, mesh] for mesh in meshes if (basis, mesh) in slides]
    if not done:
        continue
    n = [item[0] for item in done]
    style = dict(marker="o" if basis[0] == "N" else "s", color=colours[basis], label=basis)
    axes[0].loglog(n, [item[1].smooth[0] for item in done], **style)
    axes[1].loglog(n, [item[1].smooth[1] for item in done], **style)
    axes[2].loglog([item[2].seconds for item in done], [item[1].smooth[0] for item in done], **style)
axes[0].set(xlabel="dofs", ylabel="oscillation of Py, detrended")
axes[1].set(xlabel="dofs", ylabel="oscillation of Px, detrended")
axes[2].set(xlabel="run time [s]", ylabel="oscillation of Py, detrended")
axes[0].legend(fontsize=8)
figure.tight_layout()
common.figure(figure, "ironing_oscillation")
