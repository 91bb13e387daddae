"""Hertz contact: pressure and half-width against the closed form over basis, mesh, Gauss points, penalty and time."""
import re
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common
import interface_vtu

stiffness = 1 / (2 * (1 - 0.3**2))       # E* of both decks: E = 1, nu = 0.3 on either side; R = 1
trapezoid = numpy.trapz


class Hertz(common.Run):
    """A run and how far its pressure is from the closed form under the load that it found."""

    def __init__(self, deck="hertz_2d", label="hertz", **parameters):
        super().__init__(f"inputs/verify/{deck}.inp", label, **parameters)
        found = re.search(r"(\d+) equations", self.log)
        self.equations = int(found[1]) if found else 0
        self.cutbacks = int(sum(self.history.get("cutbacks", [])))
        if self.status:
            return
        points = interface_vtu.read(self.folder)
        place, pressure = points["Points"], -points["traction"]
        if deck == "hertz_2d":
            load = -2 * self.history["top_ry"][-1]
            self.a = numpy.sqrt(4 * load / (numpy.pi * stiffness))
            self.p0 = numpy.sqrt(load * stiffness / numpy.pi)
            radius = place[:, 0]
        else:
            load = -4 * self.history["top_rz"][-1]
            self.a = (3 * load / (4 * stiffness)) ** (1 / 3)
            self.p0 = 1.5 * load / (numpy.pi * self.a**2)
            radius = numpy.hypot(place[:, 0], place[:, 1])
        order = numpy.argsort(radius)
        self.r, self.p = radius[order], pressure[order]
        exact = self.p0 * numpy.sqrt(numpy.maximum(0, 1 - (self.r / self.a) ** 2))
        inner = self.r < 0.7 * self.a
        ratio = self.p[inner] / exact[inner]
        self.oscillation = ratio.max() - ratio.min()
        self.peak = self.p.max() / self.p0 - 1
        self.centre = ratio[self.r[inner] < self.a / 2].mean() - 1
        self.profile = numpy.linalg.norm(self.p - exact) / numpy.linalg.norm(exact)
        # the mean of x^2 under the pressure is a^2/4 in the plane; in space the width is not integrated, but seen
        if deck == "hertz_2d":
            x, p = numpy.append(0, self.r), numpy.append(self.p[0], self.p)
            self.width = 2 * numpy.sqrt(trapezoid(p * x**2, x) / trapezoid(p, x)) / self.a - 1
        else:
            self.width = self.r[self.p > 0].max() / self.a - 1


def percent(value):
    return f"{100 * value:.2f}"


full = "--all" in sys.argv
meshes = (1, 2, 3) if full else (1, 2)
rows, runs = [], []
for basis in ("N1", "N2", "N3", "N4", "L2", "L3", "L4"):
    for mesh in meshes:
        for gp in (2, 3, 4) if basis in ("N2", "L2") else (3,):
            for penalty in (300, 1000, 3000) if basis == "N2" and gp == 3 else (1000,):
                run = Hertz(basis=basis[0], p=basis[1], mesh=mesh, gp=gp, penalty=penalty)
                if run.status:
                    rows.append([basis, mesh, run.equations, gp, penalty, "fails", "", "", "", ""])
                    continue
                runs.append((basis, mesh, gp, penalty, run))
                rows.append([basis, mesh, run.equations, gp, penalty, percent(run.peak), percent(run.centre),
                             percent(run.width), percent(run.profile), f"{run.seconds:.2f}"])
errors = ["peak [%]", "middle [%]", "half-width [%]", "profile [%]"]
common.table("hertz", ["basis", "mesh", "equations", "gp", "penalty", *errors, "time [s]"], rows)

rows, profiles, oscillates, fails = [], [], None, None
for penalty in (10, 30, 100, 300, 1e3, 3e3, 1e4, 1e5, 1e6, 1e7):
    if fails:
        break                    # beyond, runs are all cut-backs and take minutes
    run = Hertz(penalty=penalty)
    if run.status or run.cutbacks:
        fails = penalty
    if run.status:
        rows.append([f"{penalty:.0e}", "fails", "", "", "", "", run.cutbacks])
        continue
    profiles.append((penalty, run))
    if run.oscillation > 0.1:
        oscillates = oscillates or penalty
    rows.append([f"{penalty:.0e}", percent(run.peak), percent(run.width), percent(run.profile), percent(run.oscillation),
                 int(run.iterations), run.cutbacks])
common.table("hertz_penalty", ["penalty", "peak [%]", "half-width [%]", "profile [%]", "oscillation within 0.7 a [%]",
                               "iterations", "cut-backs"], rows)
print(f"The pressure oscillates by more than 10 % from penalty {oscillates}, Newton cuts back or fails from {fails}")

rows = []
for basis, mesh, gp, penalty in (("N2", 1, 3, 100), ("N2", 1, 3, 300), ("L1", 1, 3, 100), ("L2", 1, 3, 100),
                                 *((("N2", 2, 3, 100), ("N2", 2, 3, 300)) if full else ())):
    run = Hertz("hertz_3d", "hertz_3d", basis=basis[0], p=basis[1], mesh=mesh, gp=gp, penalty=penalty)
    results = ["fails"] * 4 if run.status else map(percent, (run.peak, run.centre, run.width, run.profile))
    rows.append([basis, mesh, run.equations, gp, penalty, *results, f"{run.seconds:.1f}"])
common.table("hertz_3d", ["basis", "mesh", "equations", "gp", "penalty", *errors, "time [s]"], rows)

chart, panels = plt.subplots(1, 2, figsize=(11, 4.4))
r = numpy.linspace(0, 1, 400)
panels[0].plot(r, numpy.sqrt(1 - r**2), "k", linewidth=1, label="Hertz")
for penalty, run in profiles:
    if penalty in (1e2, 1e3, 1e5):
        near = run.r < 1.3 * run.a
        panels[0].plot(run.r[near] / run.a, run.p[near] / run.p0, ".-", linewidth=0.6, markersize=4,
                       label=f"N2, mesh 1, penalty {penalty:.0e}")
panels[0].set(xlabel="x / a", ylabel="pressure / $p_0$", ylim=(0, 1.6))
for basis in ("N1", "N2", "N3", "N4", "L2", "L3", "L4"):
    series = [run for name, _, gp, penalty, run in runs if name == basis and gp == 3 and penalty == 1000]
    panels[1].loglog([run.seconds for run in series], [run.profile for run in series], "o-" if basis[0] == "N" else "s--",
                     markersize=4, label=basis)
panels[1].set(xlabel="time [s]", ylabel="error of the pressure profile (L2, relative)")
for panel in panels:
    panel.legend(fontsize=8)
chart.tight_layout()
common.figure(chart, "hertz")
