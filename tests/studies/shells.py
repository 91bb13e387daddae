"""Shells: obstacle course, membrane locking, large displacements load by load, snap-through, error against time."""
import re
import shutil
import subprocess
import sys

import matplotlib
import numpy

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import common
import interface_vtu

degrees = [2, 3, 4, 5]
meshes = [4, 8, 16, 32]
course = {  # deck, column, limit of refined meshes in the literature, a much finer run
    "Scordelis-Lo roof": ("scordelis_lo", "edge_uz", -0.3006, dict(p=6, n=40)),
    "pinched cylinder": ("pinched_cylinder", "load_uz", -1.8248e-5, dict(basis="T", p=5, n=24, levels=5, near=50)),
    "pinched hemisphere": ("pinched_hemisphere", "a_ux", 0.0924, dict(basis="T", p=5, n=16, levels=3, near=1)),
}

# K. Y. Sze, X. H. Liu, S. H. Lo 2004: displacements outward at A and inward at B over the load. All rows compared with the
# copy of their table in the tests of Elmer (fem/tests/Shell_OpenHemisphere_High_Order/runhemisphere.m).
hemisphere = {0.05: (0.855, 0.955), 0.1: (1.499, 1.840), 0.15: (1.969, 2.604), 0.2: (2.321, 3.261), 0.25: (2.596, 3.833),
              0.3: (2.819, 4.339), 0.35: (3.002, 4.790), 0.4: (3.158, 5.196), 0.45: (3.291, 5.565), 0.5: (3.406, 5.902),
              0.55: (3.508, 6.212), 0.6: (3.598, 6.497), 0.65: (3.678, 6.761), 0.7: (3.750, 7.006), 0.75: (3.816, 7.234),
              0.8: (3.875, 7.448), 0.85: (3.929, 7.647), 0.9: (3.979, 7.835), 0.95: (4.025, 8.011), 1.0: (4.067, 8.178)}


def run(deck, label, **parameters):
    done = common.Run(f"inputs/verify/{deck}.inp", label, **parameters)
    if done.status:
        raise SystemExit(f"{deck} {parameters}: {done.errors or done.log}")
    return done


def equations(done):
    return int(re.search(r"(\d+) equations", done.log)[1])


def obstacle_course():
    """Displacement over the limit value; the same runs as error against equations and processor time."""
    rows, costs = [], []
    figure, panels = plt.subplots(1, 3, figsize=(12, 4))
    trade, error_panels = plt.subplots(2, 3, figsize=(12, 7.5))
    finer = sorted([*meshes, 6, 12, 24])
    for k, (name, (deck, column, limit, finest)) in enumerate(course.items()):
        # errors against a finest run: the limits in books have four digits
        exact = run(deck, f"{deck}_finest", **finest).history[column][-1]
        for basis, p in [*(("N", p) for p in degrees), ("T", 3), ("T", 5)]:
            times, sizes, values = [], [], []
            for n in finer:
                # short runs: the quickest of three
                runs = [run(deck, f"{deck}_{basis}{p}_{n}_{repeat}", basis=basis, p=p, n=n) for repeat in range(3)]
                times.append(min(one.seconds for one in runs))
                sizes.append(equations(runs[0]))
                values.append(runs[0].history[column][-1])
            errors = [abs(value / exact - 1) for value in values]
            ratios = [values[finer.index(n)] / limit for n in meshes]
            rows.append([name, f"{basis}{p}", *(f"{ratio:.4f}" for ratio in ratios)])
            cost = [name, f"{basis}{p}"]
            for level in (1e-2, 1e-3):
                good = [m for m in range(len(finer)) if max(errors[m:]) < level]
                m = good[0] if good else None
                cost += [f"{finer[m]} x {finer[m]}", sizes[m], f"{times[m]:.2f}"] if good else ["", "", ""]
            costs.append(cost)
            style = dict(color=f"C{p - 2}", linestyle="-" if basis == "N" else "--", marker="o" if basis == "N" else "^",
                         markersize=4, label=f"{basis}{p}")
            panels[k].plot(meshes, ratios, **style)
            error_panels[0, k].loglog(sizes, errors, **style)
            error_panels[1, k].loglog(times, errors, **style)
        panels[k].set(title=name, xlabel="elements in each direction", ylabel="displacement over limit", ylim=(0, 1.1))
        panels[k].set_xscale("log", base=2)
        panels[k].axhline(1, color="grey", linewidth=0.5)
        error_panels[0, k].set(title=name, xlabel="equations", ylabel="relative error")
        error_panels[1, k].set(xlabel="processor time of the run [s]", ylabel="relative error")
    for panel in (panels[0], error_panels[0, 0]):
        panel.legend(fontsize=8)
    figure.tight_layout()
    common.figure(figure, "shells_convergence")
    trade.tight_layout()
    common.figure(trade, "shells_trade")
    common.table("shells_course", ["problem", "basis", *(f"{n} x {n}" for n in meshes)], rows)
    common.table("shells_course_cost", ["problem", "basis", "below 1 %", "equations", "time [s]", "below 0.1 %", "equations",
                                        "time [s]"], costs)


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


def thick_rings():
    """A quarter ring: closed form and points over the thickness against Winkler's theory of curved beams."""
    rows = []
    radius = 10
    for slenderness in [50, 20, 10, 5, 2.5]:
        t = radius / slenderness
        logarithm = radius * numpy.log((2 * radius + t) / (2 * radius - t))
        exact = t**3 / (12 * radius**2 * (logarithm - t))
        found = [run("curved_beam", "curved_beam", t=t, p=5, n=16, through=points).history["tip_uz"][-1]
                 for points in (0, 2, 3, 5, 8)]
        rows.append([slenderness, f"{exact:.6f}", *(f"{100 * (value / exact - 1):+.4f}" for value in found)])
    common.table("shells_thick", ["R/t", "Winkler", "closed form [%]", "2 points [%]", "3", "5", "8"], rows)


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
        path = run("hinged_panel", f"hinged_panel_{thickness}", t=thickness, steps=400,
                   step=0.02 if thickness > 10 else 0.005, until=1 if thickness > 10 else 0.4)
        w = [0, *(-u for u in path.history["middle_uz"])]
        load = [0, *(3 * time for time in path.history["time"])]
        panel.plot(w, load, "-", label=f"t = {thickness}, path")
        print(f"t = {thickness}: highest load before w = 15: {max(f for f, x in zip(load, w) if x < 15):.4f} kN", flush=True)
    held = run("hinged_panel", "hinged_panel_held", drive="displacement", step=0.02, steps=50)
    panel.plot([-u for u in held.history["middle_uz"]], [-4e-3 * f for f in held.history["middle_rz"]], "k.",
               label="t = 12.7, displacement prescribed")
    panel.set(xlabel="w at the middle [mm]", ylabel="load [kN]", xlim=(0, 32), ylim=(-0.6, 3.4))
    panel.legend(loc="upper left")
    figure.tight_layout()
    common.figure(figure, "shells_snap")


def contact_patch():
    """Two deformable shells pressed together, meshes that do not match: the largest error of the pressure."""
    rows = []
    cases = [("N2, 3 x 3 on 4 x 4", dict(p=2)), ("N3, 3 x 3 on 4 x 4", dict()), ("N4, 3 x 3 on 4 x 4", dict(p=4)),
             ("N3, 4 x 4 on 3 x 3", dict(slave="lower")), ("N3, 6 x 6 on 8 x 8", dict(n_upper=6, n_lower=8)),
             ("T3, refined in a corner", dict(basis="T")), ("N3, two halves, one turned", dict(cut="turned")),
             ("N3, matching, 4 x 4", dict(n_upper=4))]
    points = (1, 2, 3, 4, 6, 8)
    for name, parameters in cases:
        errors = []
        for gp in points:
            one = run("shell_patch", "shell_patch", gp=gp, **parameters)
            errors.append(numpy.abs(numpy.abs(interface_vtu.read(one.folder)["traction"]) / 0.5 - 1).max())
        rows.append([name, *(f"{error:.1e}" for error in errors)])
    common.table("shells_patch", ["slave on master", *(f"gp {gp}" for gp in points)], rows)


# A process starts with the peak of the one that it comes from, so a small one stands between.
measure = """import os, sys
process = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, usage = os.wait4(process, 0)
print("used", usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)
sys.exit(os.waitstatus_to_exitcode(status))"""


def measured(deck, label, **parameters):
    """Processor seconds, peak memory [MB] and log of one run."""
    arguments = [f"{name}={value}" for name, value in parameters.items()]
    common.work.mkdir(parents=True, exist_ok=True)
    done = subprocess.run([sys.executable, "-c", measure, common.build / "bezel",
                           common.root / "inputs" / "verify" / f"{deck}.inp", *arguments, "--out", common.work / label],
                          capture_output=True, text=True, cwd=common.work)
    if done.returncode:
        raise SystemExit(done.stderr)
    seconds, memory = re.search(r"^used (\S+) (\S+)", done.stdout, re.M).groups()
    return float(seconds), float(memory), done.stdout


def instructions(p, kernel):
    """Of one call [thousands], counted by callgrind: whatever else the machine does. Empty where there is no valgrind."""
    if not shutil.which("valgrind"):
        return ""
    counts = common.work / "callgrind.out"
    name = f"__shell_kernel_MOD_shell_{kernel}"
    subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={counts}", f"--toggle-collect={name}",
                    common.build / "tests" / "benchmark", common.root, common.work, str(p)], check=True, capture_output=True)
    text = counts.read_text()
    number = re.search(rf"\((\d+)\) {name}$", text, re.M)[1]     # a name is written once, then its number
    calls = sum(int(count) for count in re.findall(rf"^cfn=\({number}\).*\ncalls=(\d+)", text, re.M))
    counted = int(re.search(r"^summary: (\d+)", text, re.M)[1])
    return f"{counted / calls / 1000:.1f}"


def one_element():
    """Time and instructions of the kernels."""
    rows = []
    for p in degrees:
        program = [common.build / "tests" / "benchmark", common.root, common.work, str(p)]
        one = {}
        for options in ([], ["layers"]) * 3:
            for line in subprocess.run(program + options, check=True, capture_output=True, text=True).stdout.splitlines():
                _, _, column, value = line.split("|")
                one[column] = min(float(value), one.get(column, numpy.inf))
        rows.append([p, (p + 1)**2, f"{one['residual, kernel [us]']:.3g}", f"{one['residual and tangent, kernel [us]']:.3g}",
                     f"{one['the same, 3 points over the thickness [us]']:.3g}",
                     instructions(p, "force"), instructions(p, "tangent"), f"{one['preparation, once [us]']:.3g}",
                     f"{one['memory of the table [kB]']:.3g}"])
    common.table("shells_element", ["p", "Gauss points", "residual [us]", "residual and tangent [us]",
                                    "3 points over the thickness [us]", "residual [1000 instructions]",
                                    "residual and tangent [1000 instructions]", "preparation, once [us]", "its table [kB]"], rows)


def whole_runs():
    """The hemisphere with hole over elements, degree and Gauss points: time, shares of the phases, memory."""
    def row(p, n, gp):
        best = None
        for _ in range(2 if n <= 16 else 1):
            found = measured("hemisphere_hole", "shell_cost", p=p, n=n, gp=gp)
            if best is None or found[0] < best[0]:
                best = found
        seconds, memory, log = best
        count = int(re.search(r"^total .* s, (\d+) iterations", log, re.M)[1])
        total = float(re.search(r"^total +([0-9.]+) s", log, re.M)[1])
        spent = {name: float(time) for name, time in re.findall(r"^  (\w+) +([0-9.]+) s +[0-9.]+ %", log, re.M)}
        shares = [sum(spent.get(name, 0) for name in names) for names in
                  [("elements",), ("factorise", "solve"), ("pattern", "analyse", "input", "prepare"), ("output",)]]
        size = int(re.search(r"(\d+) equations", log)[1])
        return [f"N{p}", f"{n} x {n}", (gp or p + 1)**2, size, count, f"{seconds:.2f}", f"{1e3 * seconds / count:.2f}",
                f"{1e6 * seconds / count / n**2:.1f}", *(f"{100 * share / total:.0f}" for share in shares), f"{memory:.0f}",
                f"{1024 * memory / size:.1f}"]

    rows = [row(p, n, 0) for p in (2, 3, 4) for n in (8, 16, 32, 64) if p * n < 256]
    rows += [row(3, 16, gp) for gp in (2, 3, 5, 6, 8)]
    common.table("shells_runs", ["basis", "elements", "Gauss points", "equations", "iterations", "time [s]", "an iteration [ms]",
                                 "per element [us]", "elements [%]", "factorise, solve [%]", "set-up [%]", "output [%]",
                                 "peak memory [MB]", "kB per equation"], rows)


parts = {"course": obstacle_course, "locking": locking, "thick": thick_rings, "cantilevers": cantilevers,
         "hole": pinched_with_hole, "snap": snap_through, "patch": contact_patch,
         "element": one_element, "runs": whole_runs}
for name in sys.argv[1:] or parts:
    parts[name]()
