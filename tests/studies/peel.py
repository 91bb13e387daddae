"""Peel of square laminae: reaction against beam theory; oscillation and cost over meshes and Gauss points; a picture."""
import functools
import re
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common

width, length, rigidity = 20, 20, 1e6 * 0.2**3 / 12
toughness = {"printed": 0.3, "figure": 0.1}
expected = {"printed": ((0.2, 90.9), (0.5, 56.9), (1, 40.1), (2, 28.3), (3, 23.1), (4, 21.6), ("peak", 206)),
            "figure": ((0.2, 39.8), (0.5, 24.9), (1, 17.6), (2, 12.5), (3, 15.5), (4, 20.3), ("peak", 99))}
branch = {"printed": (0.4, 3.4), "figure": (0.4, 1.8)}  # lifts with a crack longer than its zone, shorter than the lamina


def beam(case, u):
    """Force of the peeled beam, then of the cantilever that it has become."""
    peeling = width * (2 * toughness[case]) ** 0.75 * rigidity**0.25 / numpy.sqrt(3 * u)
    return numpy.maximum(peeling, 3 * width * rigidity * u / length**3)


class Peel(common.Run):
    """A run, its forces at the lifts that the deck names, and the oscillation of its descending branch."""

    def __init__(self, label, **parameters):
        super().__init__("inputs/peel_square.inp", label, **parameters)
        self.case = parameters.get("case", "printed")
        self.label = label
        self.u = numpy.array(self.history["edge_uz"])
        self.force = numpy.array(self.history["edge_rz"])
        self.balance = numpy.abs(self.history["energy_error"]).max()
        self.cutbacks = int(sum(self.history["cutbacks"]))
        first, last = branch[self.case]
        self.total = float(re.search(r"^total +([0-9.]+) s", self.log, re.M)[1])
        self.oscillation = numpy.nan
        if self.u.max() > last:
            part = (self.u > first) & (self.u < last)
            crack = numpy.sqrt(self.u[part])   # its length, to a factor
            ratio = self.force[part] / beam(self.case, self.u[part])
            rest = ratio - numpy.polyval(numpy.polyfit(crack, ratio, 5), crack)
            self.oscillation = 100 * (rest.max() - rest.min())

    def at(self, lift):
        if lift == "peak":
            return self.force.max()
        return numpy.interp(lift, self.u, self.force) if self.u.max() >= lift - 1e-9 else numpy.nan


def digits(value, form=".1f"):
    return "" if numpy.isnan(value) else format(value, form)


def equations(run):
    return re.search(r"(\d+) equations, (\d+) interface points", run.log).groups()


def shares(run):
    """Per cents of the time: elements, interface, equations."""
    phases = [("elements",), ("contact", "search"), ("pattern", "analyse", "factorise", "solve")]
    return [f"{100 * sum(run.share(name) for name in names) / run.total:.0f}" for names in phases]


@functools.cache
def curves():
    return {case: Peel(f"peel_{case}", case=case, basis="N") for case in toughness}


def against_beams():
    """The force at some lifts: of the beam, of a strip that is one, of the laminae."""
    runs = curves()
    strips = {case: Peel(f"peel_strip_{case}", case=case, basis="N", nu=0, E_lower=1e12, columns=40, rows=1, path="auto")
              for case in toughness}
    rows = []
    for lift in (0.2, 0.5, 1, 2, 3, 4, "peak"):
        row = [lift]
        for case, run in runs.items():
            theory = dict(expected[case])[lift]
            row += [theory, digits(strips[case].at(lift)), digits(run.at(lift)),
                    digits(100 * (run.at(lift) / theory - 1), "+.1f")]
        rows.append(row)
    header = ["lift [mm]"]
    for case in runs:
        header += [f"{case}: beam [N]", "strip [N]", "laminae [N]", "difference [%]"]
    common.table("peel_history", header, rows)
    common.mesh_picture(runs["figure"].label, "peel_square_deformed", "uz", int(runs["figure"].history["step"][-1]) // 2)


def mesh_row(case, basis, elements, **parameters):
    """Control of the lift; where that stops, the path through what snaps."""
    label = "_".join(["peel", case, basis, *(str(value) for value in parameters.values())])
    first = parameters == {"mesh": 1} and basis == "N"
    run = curves()[case] if first else Peel(label, case=case, basis=basis, **parameters)
    control = "400 steps"
    if run.status:
        run, control = Peel(label + "_auto", case=case, basis=basis, path="auto", **parameters), "path"
    end = run.u.max()
    return [case, basis, elements, *equations(run), control if not run.status else f"stops at {end:.2f} mm",
            digits(run.oscillation, ".2f"), digits(run.at("peak")), int(run.iterations), run.cutbacks,
            f"{100 * run.balance:.2f}", f"{run.seconds:.0f}", *shares(run)]


def over_meshes():
    """NURBS and T-splines, both cases: oscillation and cost."""
    rows = []
    for case in toughness:
        for rows_across in (2, 6):
            rows.append(mesh_row(case, "N", f"20 x {rows_across}", columns=20, rows=rows_across))
        for basis, sizes in (("N", ("40 x 4", "60 x 6", "80 x 10")), ("T", ("40 x 4", "60 x 6", "80 x 8"))):
            for mesh, size in enumerate(sizes, 1):
                rows.append(mesh_row(case, basis, size, mesh=mesh))
                print(rows[-1], flush=True)
    common.table("peel_meshes", ["case", "basis", "elements", "equations", "interface points", "control", "oscillation [%]",
                                 "peak [N]", "iterations", "cut-backs", "energy error [%]", "time [s]", "elements [%]",
                                 "interface [%]", "equations [%]"], rows)


def over_gauss_points():
    """Elements of 1 mm, where the front goes on by jumps."""
    rows, series = [], []
    for gp in (2, 4, 6, 8):
        run = Peel(f"peel_gp{gp}", basis="N", columns=20, rows=2, path="auto", gp=gp)
        series.append((gp, run))
        rows.append([f"{gp} x {gp}", digits(run.oscillation, ".2f"), digits(run.at("peak")), int(run.iterations), run.cutbacks,
                     len(run.u), f"{100 * run.balance:.2f}", f"{run.seconds:.0f}", shares(run)[1]])
    common.table("peel_gauss", ["Gauss points", "oscillation [%]", "peak [N]", "iterations", "cut-backs", "steps",
                                "energy error [%]", "time [s]", "interface [%]"], rows)
    chart, panels = plt.subplots(1, 2, figsize=(11, 4.4))
    for case, run in curves().items():
        line, = panels[0].plot(run.u, run.force, linewidth=1.2, label=f"{case}")
        u = numpy.linspace(0.02, 4, 400)
        panels[0].plot(u, beam(case, u), "--", linewidth=0.8, color=line.get_color(), label=f"{case}, beam theory")
    panels[0].set(xlabel="lift [mm]", ylabel="edge_rz [N]", ylim=(0, 220))
    for gp, run in series:
        part = run.u > 0.1
        panels[1].plot(run.u[part], run.force[part] / beam(run.case, run.u[part]), linewidth=0.9, label=f"{gp} x {gp}")
    panels[1].set(xlabel="lift [mm]", ylabel="edge_rz / beam theory", ylim=(0.9, 1.3))
    for panel in panels:
        panel.legend(fontsize=8)
        panel.grid(alpha=0.3)
    chart.tight_layout()
    common.figure(chart, "peel_square")


parts = {"beams": against_beams, "meshes": over_meshes, "gauss": over_gauss_points}
for name in sys.argv[1:] or parts:
    parts[name]()
