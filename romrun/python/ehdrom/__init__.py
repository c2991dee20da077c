# SPDX-License-Identifier: GPL-3.0-or-later
"""Elastohydrodynamic contacts by the reduced model of ehdrom, through its C library.

    import ehdrom

    model = ehdrom.Model("model.h5")
    contact = ehdrom.Contact(model, "scene.yml")
    contact["physical.load"] = 300e3
    result = contact.solve()
    print(result.central_film_thickness, "m", result.trusted, result.reason)

Quantities are SI (N/m of a line contact, N of a point contact, m, s, m/s, Pa), or those of the scenes with
`dimensionless=True`. A model may be used by any number of contacts in any number of threads, each contact by one
thread at a time; no call holds Python's lock while it solves.

The library is looked for where the environment's EHDROM_LIBRARY says, beside this package, and where the system has
libraries.
"""
import os
import pathlib
import re

import cffi
import numpy

__all__ = ["Contact", "Derivatives", "Error", "Model", "NotConverged", "Result", "Untrusted", "version"]

_folder = pathlib.Path(__file__).parent


def _declarations(header):
    """What cffi takes of the header: no preprocessor, and nothing for C++."""
    text = re.sub(r"#ifdef __cplusplus.*?#endif", "", header, flags=re.S)
    text = re.sub(r"^ *#(.*\\\n)*.*$", "", text, flags=re.M)
    return text.replace("EHDROM_API ", "")


def _load(ffi):
    beside = [_folder / "libehdrom.so.0", _folder.parent.parent / "lib" / "libehdrom.so.0"]
    names = [os.environ.get("EHDROM_LIBRARY"), *(str(path) for path in beside if path.exists()), "libehdrom.so.0"]
    return ffi.dlopen(next(name for name in names if name))


_ffi = cffi.FFI()
_ffi.cdef(_declarations((_folder / "ehdrom.h").read_text(encoding="utf-8")))
_lib = _load(_ffi)
_FAILED = _lib.EHDROM_DATA  # from here on a status is an error


def _text(characters):
    return _ffi.string(characters).decode()


def _begun(kind):
    """A struct with its size."""
    struct = _ffi.new(f"{kind} *")
    struct.size = _ffi.sizeof(kind)
    return struct


def _doubles(array):
    return _ffi.from_buffer("double[]", array, require_writable=True)


def version():
    """Version of the library, as "0.3.0"."""
    return _text(_lib.ehdrom_version())


class Error(Exception):
    """What was found and what was expected; `status` is the library's, as the exit codes of romrun."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


class NotConverged(Error):
    """There is no solution; of a step, try a shorter one."""


class Untrusted(Error):
    """Raised by Result.check: solved, but not to be relied on."""


class Model:
    """A model file, loaded; closed with the last contact of it.

    pressure_modes, deformation_modes, rows: the first ones alone (0: all). stationary: without what steps in time
    need. `info` has its sizes: dimensions, num_x, num_y, x_min, y_min, step (half widths), …
    """

    def __init__(self, path, pressure_modes=0, deformation_modes=0, rows=0, stationary=False):
        options = _begun("ehdrom_model_options")
        options.pressure_modes, options.deformation_modes = pressure_modes, deformation_modes
        options.rows, options.stationary = rows, stationary
        handle = _ffi.new("ehdrom_model **")
        status = _lib.ehdrom_model_open(handle, os.fsencode(path), options)
        self._handle = _ffi.gc(handle[0], _lib.ehdrom_model_close)
        if status:
            raise Error(status, _text(_lib.ehdrom_model_error(self._handle)))
        info = _begun("ehdrom_model_info")
        _lib.ehdrom_model_describe(self._handle, info)
        self.info = {name: getattr(info, name) for name, _ in _ffi.typeof("ehdrom_model_info").fields[1:]}
        self._path = os.fsdecode(path)

    def __repr__(self):
        return (f"Model({self._path!r}: {self.info['num_x']} by {self.info['num_y']} nodes, "
                f"{self.info['pressure_modes']} pressure modes, {self.info['rows']} rows)")


class _Numbers:
    """The members of a struct of ehdrom.h as attributes, all of which are shown."""

    __slots__ = ("_struct",)

    def __init__(self, struct):
        self._struct = struct

    def __getattr__(self, name):
        return getattr(self._struct, name)

    def _members(self):
        return [name for name, _ in _ffi.typeof(self._struct).item.fields[1:]]

    def __dir__(self):
        return self._members()

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(f'{name}={getattr(self, name):.6g}' for name in self._members())})"


class Result(_Numbers):
    """One solution: the members of ehdrom_result in ehdrom.h, and `reason`, why it is not trusted, or ""."""

    __slots__ = ("reason",)

    def __init__(self, struct, reason):
        super().__init__(struct)
        self.reason = reason

    def __repr__(self):
        return f"{super().__repr__()[:-1]}, reason={self.reason!r})"

    def __dir__(self):
        return ["reason", "check", *self._members()]

    def check(self):
        """Returns itself, or raises Untrusted."""
        if self.status:
            raise Untrusted(self.status, self.reason)
        return self


class Derivatives(_Numbers):
    """The members of ehdrom_derivatives in ehdrom.h: how load, approach, films, … change."""

    __slots__ = ()


class Contact:
    """A contact with a solver and a time of its own.

    scene: a file that all settings are taken from. contact["key"] = value sets one by its key in scenes, None unsets
    it, contact["key"] tells it; they count from the next solve or start on. accuracy: films that are indicated to be further off are not
    trusted, 0.01 unless given; float("inf"): whatever is indicated, and also by a model that was never checked.
    tolerance, step_tolerance: as ehdrom_contact_set_tolerance and ehdrom_contact_set_step_tolerance.
    """

    def __init__(self, model, scene=None, dimensionless=False, accuracy=None, tolerance=None, step_tolerance=None):
        if not isinstance(model, Model):
            raise TypeError(f"model: found {type(model).__name__}, expected a Model")
        handle = _ffi.new("ehdrom_contact **")
        status = _lib.ehdrom_contact_create(handle, model._handle)
        self.model = model  # has to outlive the handle
        self._handle = _ffi.gc(handle[0], _lib.ehdrom_contact_free)
        self._passed(status)
        if dimensionless:
            self._passed(_lib.ehdrom_contact_set_units(self._handle, _lib.EHDROM_DIMENSIONLESS))
        if scene is not None:
            self._passed(_lib.ehdrom_contact_read(self._handle, os.fsencode(scene)))
        for value, setter in ((accuracy, _lib.ehdrom_contact_set_accuracy),
                              (tolerance, _lib.ehdrom_contact_set_tolerance),
                              (step_tolerance, _lib.ehdrom_contact_set_step_tolerance)):
            if value is not None:
                self._passed(setter(self._handle, value))

    def _error(self):
        return _text(_lib.ehdrom_contact_error(self._handle))

    def _passed(self, status):
        if status >= _FAILED:
            raise Error(status, self._error())

    def _solved(self, status):
        self._passed(status)
        if status == _lib.EHDROM_NOT_CONVERGED:
            raise NotConverged(status, self._error())

    def _result(self, status, struct):
        self._solved(status)
        return Result(struct, self._error())

    def __setitem__(self, key, value):
        if isinstance(value, (bool, str)) or value is None:
            text = {True: "true", False: "false"}.get(value, value) if isinstance(value, bool) else value
            value = _ffi.NULL if text is None else text.encode()
            self._passed(_lib.ehdrom_contact_set(self._handle, key.encode(), value))
        else:
            self._passed(_lib.ehdrom_contact_set_number(self._handle, key.encode(), value))

    def __getitem__(self, key):
        """What a setting is set to: a number, a text, True, False, or None where it is not."""
        text = _ffi.new("char[]", 4096)
        self._passed(_lib.ehdrom_contact_get(self._handle, key.encode(), text, len(text)))
        value = _text(text)
        try:
            return {"": None, "true": True, "false": False}[value] if value in ("", "true", "false") else float(value)
        except ValueError:
            return value

    def scales(self):
        """What makes quantities dimensionless, SI: half_width, film, hertz_pressure, load, speed, time; moes_M, moes_L."""
        scales = _begun("ehdrom_scales")
        self._passed(_lib.ehdrom_contact_scales(self._handle, scales))
        return {name: getattr(scales, name) for name, _ in _ffi.typeof("ehdrom_scales").fields[1:]}

    def solve(self):
        """The stationary solution of the settings."""
        struct = _begun("ehdrom_result")
        return self._result(_lib.ehdrom_solve(self._handle, struct), struct)

    @staticmethod
    def _conditions(given):
        conditions = _begun("ehdrom_conditions")
        for name, value in given.items():
            if value is None:
                continue
            conditions.given |= getattr(_lib, f"EHDROM_{name.upper()}")
            setattr(conditions, name, value)
        return conditions

    def start(self, *, load=None, approach=None, speed=None, radius=None, modulus=None):
        """The stationary state of these conditions at time 0; what is not given is as set."""
        conditions = self._conditions({"load": load, "approach": approach, "speed": speed, "radius": radius,
                                       "modulus": modulus})
        struct = _begun("ehdrom_result")
        return self._result(_lib.ehdrom_start(self._handle, conditions, struct), struct)

    def step(self, step, *, load=None, approach=None, speed=None, radius=None, modulus=None):
        """The state `step` s after the last accepted one, as often as wanted; load in N or N/m, or approach in m, for
        which of a line contact is measured from approach_length half widths (10 unless set)."""
        conditions = self._conditions({"load": load, "approach": approach, "speed": speed, "radius": radius,
                                       "modulus": modulus})
        struct = _begun("ehdrom_result")
        return self._result(_lib.ehdrom_step(self._handle, conditions, step, struct), struct)

    def differentiate(self, *, load=None, approach=None, speed=None, radius=None, modulus=None):
        """How results change along a direction in which conditions change so fast, in their units: of the last solve
        or start the stationary derivatives, of the last step, until it is accepted, the tangent at its end. Others are
        held; approach=0 holds the approach, load=0 the load, and with neither that which was given. `load` of the
        Derivatives by approach=1 is dF/dh."""
        direction = self._conditions({"load": load, "approach": approach, "speed": speed, "radius": radius,
                                      "modulus": modulus})
        struct = _begun("ehdrom_derivatives")
        self._solved(_lib.ehdrom_differentiate(self._handle, direction, struct))
        return Derivatives(struct)

    def respond(self):
        """stiffness (N/m^2 or N/m), damping (N s/m^2 or N s/m) and damping_bound of the last solve or start: the force's
        response to a small slow change of the approach, dF = -(stiffness + s damping) dh for s -> 0."""
        struct = _begun("ehdrom_response")
        self._solved(_lib.ehdrom_respond(self._handle, struct))
        return {name: getattr(struct, name) for name, _ in _ffi.typeof("ehdrom_response").fields[1:]}

    def slide(self, sliding=None):
        """Traction of the last solve or the accepted state with the surfaces sliding at u1 - u2 (m/s; by default as
        slide_roll is set): friction_coefficient, friction_force and rolling_resistance (N/m or N), rolling_moment (N or
        N m), power_loss (W/m or W), mean_shear_stress and largest_shear_stress (Pa); and indicated_deviation_friction,
        relative, nan of a step and of a model that was not checked for it."""
        struct = _begun("ehdrom_traction")
        self._solved(_lib.ehdrom_slide(self._handle, numpy.nan if sliding is None else sliding, struct))
        return {name: getattr(struct, name) for name, _ in _ffi.typeof("ehdrom_traction").fields[1:]}

    def slide_step(self, sliding=None):
        """As slide, of the last step, which need not be accepted."""
        struct = _begun("ehdrom_traction")
        self._solved(_lib.ehdrom_slide_step(self._handle, numpy.nan if sliding is None else sliding, struct))
        return {name: getattr(struct, name) for name, _ in _ffi.typeof("ehdrom_traction").fields[1:]}

    def accept(self):
        """Accepts the last step."""
        self._passed(_lib.ehdrom_accept(self._handle))

    def restart(self):
        """After a jump of the conditions: the next step is first order."""
        self._passed(_lib.ehdrom_restart(self._handle))

    def save(self):
        """The accepted state, a numpy array for restore()."""
        count = _ffi.new("size_t *")
        self._passed(_lib.ehdrom_state_size(self._handle, count))
        state = numpy.empty(count[0])
        self._passed(_lib.ehdrom_state_save(self._handle, _doubles(state), state.size))
        return state

    def restore(self, state):
        """Goes back to a saved state, of any contact of the same model and settings."""
        state = numpy.array(state, dtype=float)
        self._passed(_lib.ehdrom_state_restore(self._handle, _doubles(state), state.size))

    def fields(self):
        """x [num_x], y [num_y] in m, pressure and film [num_y, num_x] in Pa and m, of the last solution or the accepted
        state; the library writes into the arrays that are returned. Of a list of models on different grids the nodes are
        those of the model that has solved it."""
        num_x, num_y = self.model.info["num_x"], self.model.info["num_y"]
        x, y, pressure, film = numpy.empty(num_x), numpy.empty(num_y), numpy.empty((num_y, num_x)), numpy.empty((num_y, num_x))
        self._passed(_lib.ehdrom_axes(self._handle, _doubles(x), _doubles(y)))
        self._passed(_lib.ehdrom_fields(self._handle, _doubles(pressure), _doubles(film)))
        own = self._num_x()
        return x[:own], y, pressure[:, :own], film[:, :own]

    def _num_x(self):
        """Nodes along x of the last solution or the accepted state."""
        num_x = _ffi.new("size_t *")
        self._passed(_lib.ehdrom_nodes(self._handle, num_x, _ffi.NULL))
        return num_x[0]

    def shear_stresses(self, sliding=None):
        """What the fluid does to surface 1 and to surface 2 along x, Pa, two arrays [num_y, num_x] at the nodes of
        fields(); of the last solution or the accepted state, sliding as of slide()."""
        stresses = numpy.empty((2, self.model.info["num_y"], self.model.info["num_x"]))
        self._passed(_lib.ehdrom_shear_stresses(self._handle, numpy.nan if sliding is None else sliding,
                                                _doubles(stresses[0]), _doubles(stresses[1])))
        own = self._num_x()
        return stresses[0][:, :own], stresses[1][:, :own]
