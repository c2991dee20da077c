# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports FMUs with the functions of FMI 3.0, without a package. It has only the functions for stepping contacts.

step() always starts from the last accepted state, so a step can be tried several times. accept() accepts it."""
import ctypes
import os
import sys
import tempfile
import xml.etree.ElementTree
import zipfile

real, text, boolean, pointer, reference, size = (ctypes.c_double, ctypes.c_char_p, ctypes.c_bool, ctypes.c_void_p,
                                                 ctypes.c_uint32, ctypes.c_size_t)
PROTOTYPES = {  # of the FMI functions that are called here, with their arguments in order
    "EnterInitializationMode": [pointer, boolean, real, real, boolean, real],
    "ExitInitializationMode": [pointer],
    "GetFloat64": [pointer, ctypes.POINTER(reference), size, ctypes.POINTER(real), size],
    "SetFloat64": [pointer, ctypes.POINTER(reference), size, ctypes.POINTER(real), size],
    "GetBoolean": [pointer, ctypes.POINTER(reference), size, ctypes.POINTER(boolean), size],
    "GetFMUState": [pointer, ctypes.POINTER(pointer)],
    "SetFMUState": [pointer, pointer],
    "DoStep": [pointer, real, real, boolean] + 3 * [ctypes.POINTER(boolean)] + [ctypes.POINTER(real)],
}
Log = ctypes.CFUNCTYPE(None, pointer, ctypes.c_int, text, text)


class Error(Exception):
    """The FMU has returned an error. Its message is on stderr."""


class FMU:
    """An unpacked FMU. It may have any number of instances."""

    def __init__(self, path):
        self.folder = tempfile.TemporaryDirectory()
        with zipfile.ZipFile(path) as archive:
            archive.extractall(self.folder.name)
        root = xml.etree.ElementTree.parse(self.folder.name + "/modelDescription.xml").getroot()
        self.references = {variable.get("name"): int(variable.get("valueReference"))
                           for variable in root.find("ModelVariables")}
        self.token = root.get("instantiationToken").encode()
        name = root.find("CoSimulation").get("modelIdentifier")
        self.library = ctypes.CDLL(f"{self.folder.name}/binaries/x86_64-linux/{name}.so")
        for call, arguments in PROTOTYPES.items():
            getattr(self.library, "fmi3" + call).argtypes = arguments
        self.library.fmi3InstantiateCoSimulation.restype = pointer
        self.library.fmi3InstantiateCoSimulation.argtypes = [text, text, text, boolean, boolean, boolean, boolean, pointer,
                                                             size, pointer, Log, pointer]


class Instance:
    """An instance of an FMU. Each instance has its own time, in s."""

    def __init__(self, fmu):
        self.fmu, self.now, self.end, self.saved = fmu, 0.0, 0.0, pointer()
        program = os.path.basename(sys.argv[0])
        self.log = Log(lambda _, status, category, message: print(f"{program}: {message.decode()}", file=sys.stderr))
        self.instance = fmu.library.fmi3InstantiateCoSimulation(
            b"contact", fmu.token, (fmu.folder.name + "/resources/").encode(), False, False, False, False, None, 0, None,
            self.log, None)
        if not self.instance:
            raise Error("fmi3InstantiateCoSimulation: found no instance, expected one")

    def call(self, name, *arguments):
        if getattr(self.fmu.library, "fmi3" + name)(self.instance, *arguments):
            raise Error(f"fmi3{name}: found an error, expected none")

    def _get(self, call, kind, names):
        references = (reference * len(names))(*(self.fmu.references[name] for name in names))
        values = (kind * len(names))()
        self.call(call, references, len(names), values, len(names))
        return list(values)

    def get(self, *names):
        """Returns the values of these variables."""
        return self._get("GetFloat64", real, names)

    def get_boolean(self, name):
        return self._get("GetBoolean", boolean, [name])[0]

    def set(self, name, value):
        self.call("SetFloat64", reference(self.fmu.references[name]), 1, real(value), 1)

    def start(self):
        """Starts at time 0 with the start values of the FMU."""
        self.call("EnterInitializationMode", False, 0, 0, False, 0)
        self.call("ExitInitializationMode")
        self.accept()

    def step(self, length, **inputs):
        """Makes a step from the last accepted state. `inputs` are the inputs at the end of the step."""
        if self.end != self.now:
            self.call("SetFMUState", self.saved)
        for name, value in inputs.items():
            self.set(name, value)
        event, terminate, early, last = boolean(), boolean(), boolean(), real()
        self.end = self.now + length  # also if the step fails, so that the next step restores the saved state
        self.call("DoStep", self.now, length, True, event, terminate, early, last)

    def accept(self):
        self.call("GetFMUState", self.saved)
        self.now = self.end
