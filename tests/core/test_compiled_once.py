"""No kernel is compiled twice: each is called with arguments of one kind, whatever the scene."""

import subprocess
import sys

SCENES = ("default", "ghosts", "raw-record", "rough-tow", "sediments", "targets", "thermocline", "wreck")
COUNT = f"""
import sys
import numpy as np
from insonify.compiler.dispatch import Kernel
from insonify.compiler.separate import SeparateKernel
from insonify.scene import edit, load_scene
from insonify.simulation import prepare

for name in {SCENES}:
    simulation = prepare(edit(load_scene(name), {{"track.pings": 2}}))
    simulation.intensity(np.arange(2))
    simulation.truth(np.arange(1))
for name, module in list(sys.modules.items()):
    if name.startswith("insonify"):
        for word, found in vars(module).items():
            # What is fused into its callers is compiled by them.
            kernel = isinstance(found, Kernel) and not found.options.get("forceinline")
            if kernel and found.__module__ == name:
                signatures = {{*found.entry.signatures, *found.part.signatures}}
                signatures |= {{*found.machine_code.signatures}} if isinstance(found, SeparateKernel) else set()
                if len(signatures) > 1:
                    print(f"{{name}}.{{word}}", *signatures, sep="\\n  ")
"""


def test_no_kernel_is_compiled_for_two_kinds_of_arguments() -> None:
    # A process of its own: other tests call kernels with arguments of their own making.
    done = subprocess.run([sys.executable, "-c", COUNT], capture_output=True, text=True, check=True)
    assert done.stdout == ""
