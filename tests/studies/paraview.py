"""What VTK shows of the result files against the splines themselves [PYTHON ...: interpreters that have vtk, numpy, h5py]."""
import subprocess
import sys
import venv

import common

samples = common.work / "vtk_samples"
samples.mkdir(parents=True, exist_ok=True)
subprocess.run([common.build / "tests" / "vtk_samples", samples], check=True)

interpreters = sys.argv[1:]
if not interpreters:
    # VTK's newest wheel in an environment of its own, made once
    folder = common.work / "vtk_python"
    interpreter = folder / "bin" / "python3"
    if not interpreter.exists():
        print("bezel: installing vtk, numpy and h5py with pip into", folder, flush=True)
        venv.create(folder, with_pip=True)
        subprocess.run([interpreter, "-m", "pip", "install", "--quiet", "vtk", "numpy", "h5py"], check=True)
    interpreters = [interpreter]
wrong = 0
for interpreter in interpreters:
    wrong += subprocess.run([interpreter, common.root / "tests" / "studies" / "check_vtk.py", samples]).returncode != 0
sys.exit(wrong)
