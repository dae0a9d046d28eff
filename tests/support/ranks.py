"""The program on the ranks of an MPI job."""

import os
import shutil
import subprocess
import unittest

from rodwake import PROGRAM, ProgramTest

MPIEXEC = shutil.which("mpiexec")
# ranks share the cores of this machine, which may be root's in a container
SETTINGS = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def start(count, folder, *arguments):
    return subprocess.run([MPIEXEC, "--oversubscribe", "-n", str(count), PROGRAM, *map(str, arguments)], cwd=folder, text=True,
                          capture_output=True, timeout=240, env=os.environ | SETTINGS)


@unittest.skipIf(MPIEXEC is None, "no mpiexec here")
class RanksTest(ProgramTest):
    def ranks(self, count, *arguments, code=0):
        """The job, which must end with this code."""
        done = start(count, self.folder, *arguments)
        if "is built without MPI" in done.stderr:
            self.skipTest("the program is built without MPI")
        self.assertEqual(done.returncode, code, f"{arguments}\nstdout: {done.stdout}\nstderr: {done.stderr}")
        return done
