# SPDX-License-Identifier: GPL-3.0-or-later
"""The mass on an FMU, by the calls of FMI 3.0 themselves, without a package for it: oscillator_fmu.py CONTACT.fmu SCENE.yml OUT.csv

The FMU's input is the approach (romrun --fmu, closure: approach). Trials are repeated by its saved states."""
import ctypes
import math
import re
import sys
import tempfile
import xml.etree.ElementTree
import zipfile

import shaken_mass

real, text, boolean, pointer, reference, size = (ctypes.c_double, ctypes.c_char_p, ctypes.c_bool, ctypes.c_void_p,
                                                 ctypes.c_uint32, ctypes.c_size_t)
PROTOTYPES = {  # of what is called here, in FMI's order
    "EnterInitializationMode": [pointer, boolean, real, real, boolean, real],
    "ExitInitializationMode": [pointer],
    "GetFloat64": [pointer, ctypes.POINTER(reference), size, ctypes.POINTER(real), size],
    "SetFloat64": [pointer, ctypes.POINTER(reference), size, ctypes.POINTER(real), size],
    "GetFMUState": [pointer, ctypes.POINTER(pointer)],
    "SetFMUState": [pointer, pointer],
    "DoStep": [pointer, real, real, boolean] + 3 * [ctypes.POINTER(boolean)] + [ctypes.POINTER(real)],
}
Log = ctypes.CFUNCTYPE(None, pointer, ctypes.c_int, text, text)


class FMU:
    def __init__(self, path):
        self.folder = tempfile.TemporaryDirectory()
        with zipfile.ZipFile(path) as archive:
            archive.extractall(self.folder.name)
        root = xml.etree.ElementTree.parse(self.folder.name + "/modelDescription.xml").getroot()
        self.references = {variable.get("name"): int(variable.get("valueReference"))
                           for variable in root.find("ModelVariables")}
        name = root.find("CoSimulation").get("modelIdentifier")
        self.library = ctypes.CDLL(f"{self.folder.name}/binaries/x86_64-linux/{name}.so")
        self.log = Log(lambda _, status, category, message: print(message.decode(), file=sys.stderr))
        instantiate = self.library.fmi3InstantiateCoSimulation
        instantiate.restype = pointer
        instantiate.argtypes = [text, text, text, boolean, boolean, boolean, boolean, pointer, size, pointer, Log, pointer]
        self.instance = instantiate(b"contact", root.get("instantiationToken").encode(),
                                    (self.folder.name + "/resources/").encode(), False, False, False, False, None, 0,
                                    None, self.log, None)
        if not self.instance:
            sys.exit("oscillator_fmu.py: found no instance, expected one")

    def call(self, name, *arguments):
        function = getattr(self.library, "fmi3" + name)
        function.argtypes = PROTOTYPES[name]
        if function(self.instance, *arguments):
            sys.exit(f"oscillator_fmu.py: fmi3{name}: found an error, expected none")

    def get(self, name):
        value = real()
        self.call("GetFloat64", reference(self.references[name]), 1, value, 1)
        return value.value

    def set(self, name, value):
        self.call("SetFloat64", reference(self.references[name]), 1, real(value), 1)

    def initialize(self):
        self.call("EnterInitializationMode", False, 0, 0, False, 0)
        self.call("ExitInitializationMode")

    def step(self, time, length):
        event, terminate, early, last = boolean(), boolean(), boolean(), real()
        self.call("DoStep", time, length, True, event, terminate, early, last)


class Contact:
    """Dimensionless, as the mass wants it; the scales are those of the scene (ehdrom_contact_scales)."""

    def __init__(self, fmu, scene):
        with open(scene, encoding="utf-8") as file:
            given = dict(re.findall(r"(\w+): ([\d.e+-]+)", next(line for line in file if line.startswith("physical:"))))
        load, radius, speed, modulus = (float(given[name]) for name in ("load", "radius", "speed", "modulus"))
        half_width = math.sqrt(8 * load * radius / (math.pi * modulus))
        self.load, self.film, self.time = load, half_width**2 / radius, half_width / speed
        self.fmu, self.now, self.end, self.saved = fmu, 0.0, 0.0, pointer()

    def reply(self, approach):
        return shaken_mass.Reply(approach, self.fmu.get("force") / self.load, self.fmu.get("central_film_thickness") / self.film)

    def start(self):
        self.fmu.initialize()
        self.accept()
        return self.reply(self.fmu.get("approach") / self.film)

    def step(self, approach, step):
        if self.end != self.now:
            self.fmu.call("SetFMUState", self.saved)
        self.fmu.set("approach", approach * self.film)
        self.fmu.step(self.now, step * self.time)
        self.end = self.now + step * self.time
        return self.reply(approach)

    def accept(self):
        self.fmu.call("GetFMUState", self.saved)
        self.now = self.end


fmu, scene, out = sys.argv[1:]
shaken_mass.write(Contact(FMU(fmu), scene), out)
