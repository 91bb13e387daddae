"""Shells: obstacle course, membrane locking, large displacements load by load, snap-through, error against time."""
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common

degrees = [2, 3, 4, 5]
meshes = [4, 8, 16, 32]
course = {  # deck, column, limit of refined meshes
    "Scordelis-Lo roof": ("scordelis_lo", "edge_uz", -0.3006),
    "pinched cylinder": ("pinched_cylinder", "load_uz", -1.8248e-5),
    "pinched hemisphere": ("pinched_hemisphere", "a_ux", 0.0924),
}

# K. Y. Sze, X. H. Liu, S. H. Lo 2004: displacements outward at A and inward at B over the load
hemisphere = {0.05: (0.855, 0.955), 0.1: (1.499, 1.840), 0.15: (1.969, 2.604), 0.2: (2.321, 3.261), 0.25: (2.596, 3.833),
              0.3: (2.819, 4.339), 0.35: (3.002, 4.790), 0.4: (3.158, 5.196), 0.45: (3.291, 5.565), 0.5: (3.406, 5.902),
              0.55: (3.508, 6.212), 0.6: (3.598, 6.497), 0.65: (3.678, 6.761), 0.7: (3.750, 7.006), 0.75: (3.816, 7.234),
              0.8: (3.875, 7.448), 0.85: (3.929, 7.647), 0.9: (3.979, 7.835), 0.95: (4.025, 8.011), 1.0: (4.067, 8.178)}


def run(deck, label, **parameters):
    done = common.Run(f"inputs/verify/{deck}.inp", label, **parameters)
    if done.status:
        raise SystemExit(f"{deck} {parameters}: {done.errors or done.log}")
    return done


def obstacle_course():
    """Displacement over the limit value; the same runs as error against processor time."""
    rows = []
    figure, panels = plt.subplots(1, 3, figsize=(12, 4))
    times, time_panels = plt.subplots(1, 3, figsize=(12, 4))
    for panel, time_panel, (name, (deck, column, limit)) in zip(panels, time_panels, course.items()):
        runs = {p: [run(deck, f"{deck}_{p}_{n}", p=p, n=n) for n in meshes] for p in degrees}
        # errors against the finest run of a higher degree: the limits in books have four digits
        exact = run(deck, f"{deck}_6_40", p=6, n=40).history[column][-1]
        for p in degrees:
            ratios = [one.history[column][-1] / limit for one in runs[p]]
            rows.append([name, f"N{p}", *(f"{ratio:.4f}" for ratio in ratios)])
            panel.plot(meshes, ratios, "o-", label=f"p = {p}")
            errors = [abs(one.history[column][-1] / exact - 1) for one in runs[p]]
            time_panel.loglog([one.seconds for one in runs[p]], errors, "o-", label=f"p = {p}")
        if deck == "scordelis_lo":
            splines = [run(deck, f"{deck}_t_{n}", basis="T", n=n) for n in meshes]
            rows.append([name, "T3", *(f"{one.history[column][-1] / limit:.4f}" for one in splines)])
            panel.plot(meshes, [one.history[column][-1] / limit for one in splines], "k--", label="T, p = 3")
        panel.set(title=name, xlabel="elements in each direction", ylabel="displacement over limit", ylim=(0, 1.1))
        panel.set_xscale("log", base=2)
        panel.axhline(1, color="grey", linewidth=0.5)
        time_panel.set(title=name, xlabel="processor time of the run [s]", ylabel="relative error")
    panels[0].legend()
    time_panels[0].legend()
    figure.tight_layout()
    common.figure(figure, "shells_convergence")
    times.tight_layout()
    common.figure(times, "shells_trade")
    common.table("shells_course", ["problem", "basis", *(f"{n} x {n}" for n in meshes)], rows)


def locking():
    """A quarter ring: the ratio to the bending solution over slenderness, degree, mesh and Gauss points."""
    rows = []
    for slenderness in [10, 100, 1000, 10000]:
        for p in degrees:
            ratios = [run("curved_beam", "curved_beam", t=10 / slenderness, p=p, n=n).history["tip_uz"][-1]
                      for n in [2, 4, 8, 16]]
            fewer = run("curved_beam", "curved_beam", t=10 / slenderness, p=p, n=8, gp=p).history["tip_uz"][-1]
            rows.append([slenderness, p, *(f"{ratio:.4f}" for ratio in ratios), f"{fewer:.4f}"])
    common.table("shells_locking", ["R/t", "p", "2 elements", "4", "8", "16", "8, p Gauss points"], rows)


def elastica(force, length, stiffness, pieces=400):
    """Tip of a cantilever under a dead force across it: th'' = - F/EI cos th, th(0) = 0, th'(L) = 0."""
    h = length / pieces

    def shoot(bend):
        state = numpy.array([0.0, bend, 0.0, 0.0])
        for _ in range(pieces):
            def rate(s):
                return numpy.array([s[1], -force / stiffness * numpy.cos(s[0]), numpy.cos(s[0]), numpy.sin(s[0])])
            k1 = rate(state)
            k2 = rate(state + h / 2 * k1)
            k3 = rate(state + h / 2 * k2)
            k4 = rate(state + h * k3)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return state

    low, high = 0.0, 2 * force * length / stiffness
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if shoot(middle)[1] < 0 else (low, middle)
    tip = shoot(low)
    return length - tip[2], tip[3]


def at(history, time, column):
    return history[column][min(range(len(history["time"])), key=lambda k: abs(history["time"][k] - time))]


def cantilevers():
    """End shear against the elastica, end moment against the circle, at each load."""
    shear = run("cantilever_shear", "cantilever_shear", p=4).history
    moment = run("cantilever_moment", "cantilever_moment", p=4).history
    rows = []
    for k in range(1, 21):
        load = k / 20
        u, w = elastica(4 * load, 10, 100)
        angle = 2 * numpy.pi * load
        rows.append([f"{load:.2f}", f"{-at(shear, load, 'tip_ux'):.4f}", f"{u:.4f}", f"{at(shear, load, 'tip_uz'):.4f}",
                     f"{w:.4f}", f"{-at(moment, load, 'tip_ux'):.4f}", f"{12 * (1 - numpy.sin(angle) / angle):.4f}",
                     f"{at(moment, load, 'tip_uz'):.4f}", f"{12 * (1 - numpy.cos(angle)) / angle:.4f}"])
    common.table("shells_cantilever", ["load", "shear: -u", "elastica", "w", "elastica", "moment: -u", "circle", "w", "circle"],
                 rows)


def pinched_with_hole():
    fine = run("hemisphere_hole", "hemisphere_hole", p=4, n=24)
    rows = []
    for load, (v, u) in hemisphere.items():
        found = at(fine.history, load, "a_uy"), -at(fine.history, load, "b_ux")
        rows.append([f"{load:.2f}", f"{found[0]:.3f}", v, f"{100 * (found[0] / v - 1):.2f}", f"{found[1]:.3f}", u,
                     f"{100 * (found[1] / u - 1):.2f}"])
    common.table("shells_hole", ["load", "v at A", "Sze et al.", "difference [%]", "-u at B", "Sze et al.", "difference [%]"],
                 rows)
    rows = []
    for p in degrees:
        for n in [8, 16, 24]:
            one = run("hemisphere_hole", f"hemisphere_hole_{p}_{n}", p=p, n=n)
            rows.append([f"N{p}", f"{n} x {n}", f"{at(one.history, 1, 'a_uy'):.3f}", f"{-at(one.history, 1, 'b_ux'):.3f}",
                         int(one.iterations), f"{one.seconds:.1f}"])
    common.table("shells_hole_meshes", ["basis", "elements", "v at A", "-u at B", "iterations", "time [s]"], rows)
    common.mesh_picture("hemisphere_hole", "shells_hole", "mises_top", 20)


def snap_through():
    """The hinged panel by path following and by prescribed displacement."""
    figure, panel = plt.subplots(figsize=(6, 4))
    for thickness in [12.7, 6.35]:
        path = run("hinged_panel", f"hinged_panel_{thickness}", t=thickness, steps=160,
                   step=0.05 if thickness > 10 else 0.02, until=1 if thickness > 10 else 0.4)
        w = [-u for u in path.history["middle_uz"]]
        load = [3 * time for time in path.history["time"]]
        panel.plot(w, load, "-", label=f"t = {thickness}, path")
        print(f"t = {thickness}: highest load before w = 15: {max(f for f, x in zip(load, w) if x < 15):.4f} kN", flush=True)
    held = run("hinged_panel", "hinged_panel_held", drive="displacement", step=0.02, steps=50)
    panel.plot([-u for u in held.history["middle_uz"]], [-4e-3 * f for f in held.history["middle_rz"]], "k.",
               label="t = 12.7, displacement prescribed")
    panel.set(xlabel="w at the middle [mm]", ylabel="load [kN]", xlim=(0, 32), ylim=(-0.6, 3.4))
    panel.legend(loc="upper left")
    figure.tight_layout()
    common.figure(figure, "shells_snap")


parts = {"course": obstacle_course, "locking": locking, "cantilevers": cantilevers, "hole": pinched_with_hole,
         "snap": snap_through}
for name in sys.argv[1:] or parts:
    parts[name]()
