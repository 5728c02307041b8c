"""The program as a folder that needs no Python (`insonify.spec`): the command, and the processes that it starts."""

import sys
from importlib import import_module
from multiprocessing import freeze_support

freeze_support()  # processes of multiprocessing begin here too, and do not come back from it

from insonify.__main__ import run  # noqa: E402
from insonify.child_process import CHILD  # noqa: E402

if sys.argv[1:2] == [CHILD]:
    import_module(sys.argv[2]).main()
else:
    run()
