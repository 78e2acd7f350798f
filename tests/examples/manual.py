#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The pages "Use perihom from ..." as they are printed. Prints TAP.

Of a page, in its order: a block after a line that ends with "`name`:" is that file; a block `sh`
is run; a block `text` is what the run before it must have printed; the blocks `python` are one
program. Instead of an installation: the build folder, by PATH, PKG_CONFIG_PATH, LD_LIBRARY_PATH
and PYTHONPATH, and tools/fortran for its installed copy.

usage: manual.py ROOT BUILD PAGE...
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile

root, build = (os.path.abspath(p) for p in sys.argv[1:3])
env = dict(os.environ, OMP_NUM_THREADS="1", PKG_CONFIG_PATH=build + "/meson-uninstalled", LD_LIBRARY_PATH=build + "/lib",
           PYTHONPATH=build + "/tools/python", PATH=build + "/tools:" + os.environ["PATH"])
NEEDS = {"fortran.md": "gfortran", "calculix.md": "ccx", "c-api.md": "cc"}


def run(command, folder):
    p = subprocess.run(command, cwd=folder, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=120)
    text = p.stdout.decode("utf-8", "replace")
    assert p.returncode == 0, text[-1500:]
    return text


def page(path):
    """Runs a page; how many blocks did something."""
    text = open(path, encoding="utf-8").read()
    program, printed, done = "", None, 0
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(root + "/data", folder + "/data")
        for before, kind, body in re.findall(r"([^\n]*)\n*^```(\w+)\n(.*?)^```$", text, re.S | re.M):
            name = re.search(r"`([\w.]+)`:$", before)
            if name:
                with open(os.path.join(folder, name[1]), "w") as f:
                    f.write(body)
            elif kind == "sh":
                printed = run(["sh", "-euc", body.replace("/usr/local/share/perihom/fortran", root + "/tools/fortran")], folder)
            elif kind == "text":
                assert printed == body, "printed\n%s, the page says\n%s" % (printed, body)
            elif kind == "python":
                program += body
            else:
                continue
            done += 1
        if program:
            run(["/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable, "-c", program], folder)
    return done


failed = 0
for number, path in enumerate(sys.argv[3:], 1):
    name = os.path.basename(path)
    if name in NEEDS and not shutil.which(NEEDS[name]):
        print("ok %d - %s # SKIP no %s" % (number, name, NEEDS[name]))
        continue
    try:
        blocks = page(path)
        assert blocks > 1, "no blocks"
        print("ok %d - %s, %d blocks" % (number, name, blocks))
    except (AssertionError, subprocess.TimeoutExpired) as error:
        failed += 1
        print("not ok %d - %s\n%s" % (number, name, re.sub("^", "# ", str(error), flags=re.M)))
print("1..%d" % (len(sys.argv) - 3))
sys.exit(failed > 0)
