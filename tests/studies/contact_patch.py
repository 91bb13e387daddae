"""Contact patch test: error of the pressure over Gauss points, basis, degree, slave side, in the plane and in space."""
import sys

import numpy

import common
import interface_vtu

cases = [("N2", "upper", {"basis": "N", "p": 2}), ("N2", "lower", {"basis": "N", "p": 2, "slave": "lower"}),
         ("N3", "upper", {"basis": "N", "p": 3}), ("N3", "lower", {"basis": "N", "p": 3, "slave": "lower"}),
         ("L1", "upper", {"basis": "L", "p": 1}), ("L1", "lower", {"basis": "L", "p": 1, "slave": "lower"}),
         ("L2", "upper", {"basis": "L", "p": 2}), ("L2", "lower", {"basis": "L", "p": 2, "slave": "lower"})]
# press, then the springs in series: both blocks and the penalty
exact = {"2d": 0.01 / (1 - 0.3**2 + 1e-3), "3d": 0.01 / (1 + 1e-3)}
points = {"2d": range(1, 9), "3d": range(1, 9) if "--all" in sys.argv else (1, 2, 3, 4, 6)}


def largest_error(dimension, gp, parameters):
    run = common.Run(f"inputs/verify/contact_patch_{dimension}.inp", f"contact_patch_{dimension}", gp=gp, **parameters)
    if run.status:
        return None
    return numpy.abs(-interface_vtu.read(run.folder)["traction"] / exact[dimension] - 1).max()


for dimension in ("2d", "3d"):
    rows = []
    for name, slave, parameters in cases:
        errors = [largest_error(dimension, gp, parameters) for gp in points[dimension]]
        rows.append([name, slave, *("fails" if error is None else f"{error:.1e}" for error in errors)])
    matching = {"upper": 4, "lower": 4}
    errors = [largest_error(dimension, gp, matching) for gp in points[dimension]]
    rows.append(["N2, matching", "upper", *("fails" if error is None else f"{error:.1e}" for error in errors)])
    common.table(f"contact_patch_{dimension}", ["basis", "slave", *(f"gp {gp}" for gp in points[dimension])], rows)
