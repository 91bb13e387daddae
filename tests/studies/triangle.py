"""Debonding of triangular laminae: force at the corner against beam theory, smoothness, meshes, pictures.

`tests/study triangle fine` runs the finest mesh as well (ten minutes), and keeps it for later calls with --reuse.
"""
import re
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common
import interface_vtu
import shell_pictures

expected = {1: 16.33, 2: 16.33, 3.2: 17, 4: 22, 5: 29, 7.5: 51, 10: 93}   # tapered elastica
branch = (0.6, 2.6)        # lifts with a front inside the laminae


class Pull(common.Run):
    def __init__(self, label, **parameters):
        super().__init__("inputs/peel_triangle.inp", label, **parameters)
        self.u = numpy.array(self.history["corner_uz"])
        self.force = numpy.array(self.history["corner_rz"])
        self.sizes = [int(number) for number in re.search(r"(\d+) equations, (\d+) interface points", self.log).groups()]
        self.total = float(re.search(r"^total +([0-9.]+) s", self.log, re.M)[1])
        # what a quintic in the root of the lift leaves of the force, largest - smallest
        part = (self.u > branch[0]) & (self.u < branch[1])
        x = numpy.sqrt(self.u[part])
        rest = self.force[part] - numpy.polyval(numpy.polyfit(x, self.force[part], 5), x)
        self.roughness = 100 * (rest.max() - rest.min()) / self.force[part].mean()

    def at(self, lift):
        """The force where the lift is reached first: path following may go back."""
        k = int(numpy.argmax(self.u > lift - 1e-9))
        return numpy.interp(lift, self.u[k - 1:k + 1], self.force[k - 1:k + 1]) if self.u[k] > lift - 1e-9 else numpy.nan

    def part(self, *phases):
        return f"{100 * sum(self.share(phase) for phase in phases) / self.total:.0f}"


def text(value, form):
    return "" if numpy.isnan(value) else format(value, form)


runs = [("mesh 1", Pull("triangle_1", mesh=1)),
        ("mesh 2 (default)", Pull("triangle_2", mesh=2))]
if "fine" in sys.argv or (common.reuse and (common.work / "triangle_3.json").exists()):
    runs.append(("mesh 3", Pull("triangle_3", mesh=3)))
meshes = list(runs)
runs += [("mesh 1, 2 x 2 points", Pull("triangle_1_gp2", mesh=1, gp=2)),
         ("mesh 1, 6 x 6 points", Pull("triangle_1_gp6", mesh=1, gp=6)),
         ("mesh 2, 2 x 2 points", Pull("triangle_2_gp2", mesh=2, gp=2, path="auto")),
         ("mesh 2, nu = 0", Pull("triangle_2_nu0", mesh=2, nu=0))]

rows = []
for lift, theory in expected.items():
    row = [lift, theory]
    for name, run in meshes + runs[-1:]:
        row += [text(run.at(lift), ".2f"), text(100 * (run.at(lift) / theory - 1), "+.1f")]
    rows.append(row)
header = ["lift [mm]", "beam theory [N]"]
for name, _ in meshes + runs[-1:]:
    header += [f"{name} [N]", "[%]"]
common.table("triangle_history", header, rows)

rows = [[name, *run.sizes, f"{run.roughness:.2f}", f"{run.force[run.u < branch[1]].max():.2f}", f"{100 * abs(run.history['energy_error'][-1]):.2f}",
         int(run.iterations), int(sum(run.history["cutbacks"])), f"{run.seconds:.0f}", run.part("elements"), run.part("contact", "search"),
         run.part("pattern", "analyse", "factorise", "solve")] for name, run in runs]
common.table("triangle_meshes", ["run", "equations", "interface points", "roughness [%]", "peak [N]", "energy error [%]", "iterations",
                                 "cut-backs", "time [s]", "elements [%]", "interface [%]", "solver [%]"], rows)

chart, panels = plt.subplots(1, 2, figsize=(11, 4.2))
for axes, last in zip(panels, (10, 3)):
    for name, run in meshes:
        part = run.u <= last
        axes.plot(run.u[part], run.force[part], linewidth=1, label=name)
    if last == 3:
        run = dict(runs)["mesh 2, 2 x 2 points"]
        axes.plot(run.u[run.u <= last], run.force[run.u <= last], linewidth=0.7, label="mesh 2, 2 x 2 points")
    points = [(lift, force) for lift, force in expected.items() if lift <= last]
    axes.plot(*zip(*points), "ko", markersize=4, label="beam theory")
    axes.set(xlabel="lift of a corner [mm]", ylabel="corner_rz [N]")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
panels[1].set_ylim(8, 20)
chart.tight_layout()
common.figure(chart, "peel_triangle")

# the paper's figure 23, and below it the bond seen from above
run = dict(runs)["mesh 2 (default)"]
found = shell_pictures.results(run.folder)
chart, panels = plt.subplots(2, 5, figsize=(13, 5.6), height_ratios=(1.25, 1))
norm = matplotlib.colors.Normalize(-10, 10)
for column, step in zip(panels.T, (50, 100, 150, 250, 500)):
    shell_pictures.panel(column[0], found, step, "uz", norm, (-20, 14), fine=3)
    column[0].set_title(f"step {step}: {step / 50:g} mm", fontsize=10)
    column[0].set_xlim(-0.5, 20)
    column[0].set_ylim(-10.5, 13)
    points = interface_vtu.read(run.folder, step)
    place = points["Points"]
    column[1].tripcolor(place[:, 0], place[:, 1], points["damage"], shading="gouraud", cmap="inferno_r", vmin=0, vmax=1, rasterized=True)
    for level, style in ((0.005, "--"), (0.995, "-")):     # both fronts: where the bond begins to yield, where it is spent
        if points["damage"].min() < level < points["damage"].max():
            column[1].tricontour(place[:, 0], place[:, 1], points["damage"], [level], colors="deepskyblue", linewidths=1.2, linestyles=style)
    column[1].set_aspect("equal")
    column[1].set_xlim(-0.5, 20.5)
    column[1].set_ylim(-0.5, 18)
    column[1].axis("off")
chart.colorbar(plt.cm.ScalarMappable(norm, "turbo"), ax=panels[0].tolist(), shrink=0.7, label="uz [mm]", pad=0.01)
chart.colorbar(plt.cm.ScalarMappable(matplotlib.colors.Normalize(0, 1), "inferno_r"), ax=panels[1].tolist(), shrink=0.8, label="damage",
               pad=0.01)
common.figure(chart, "peel_triangle_fronts")
