# SPDX-License-Identifier: GPL-3.0-or-later
"""Elastohydrodynamic contacts by the reduced model of ehdrom, through its C library.

    import ehdrom

    model = ehdrom.Model("model.h5")
    contact = ehdrom.Contact(model, "scene.yml")
    contact["physical.load"] = 300e3
    result = contact.solve()
    print(result.central_film_thickness, "m", result.trusted, result.reason)

Quantities are in SI units: loads in N/m for a line contact and in N for a point contact; m, s, m/s, Pa. With
`dimensionless=True` the quantities are the dimensionless quantities of scenes.

Any number of contacts in any number of threads may use a model. Only one thread at a time may use a contact: a call
during the call of another thread raises Error. Python's global lock is released while a call solves. Contacts and
models are freed by close(), at the end of a with statement, or when no reference to them is left.

The package loads the library from the file that the environment variable EHDROM_LIBRARY names. Without this variable
it loads the file beside the package or, if there is none, the system's library.
"""
from __future__ import annotations

import functools
import os
import pathlib
import re
import threading
from typing import Any, Callable, TypeVar, Union

import cffi
import numpy

__all__ = ["Contact", "Derivatives", "Error", "Model", "NotConverged", "Result", "Untrusted", "version"]

_Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]
_Own = TypeVar("_Own")
_Function = TypeVar("_Function", bound=Callable[..., Any])

_folder = pathlib.Path(__file__).parent


def _declarations(header):
    """Returns the header without preprocessor lines and C++, which cffi does not read."""
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
_FAILED = _lib.EHDROM_DATA  # this status and larger ones are errors


def _text(characters):
    return _ffi.string(characters).decode(errors="replace")


def _characters(text, what):
    """Raises Error for bytes with a NUL character, because the library would end the text there."""
    if b"\0" in text:
        raise Error(_lib.EHDROM_DATA, f"{what}: found a NUL character, expected none")
    return text


def _begun(kind):
    """Creates a struct of the library and sets its size."""
    struct = _ffi.new(f"{kind} *")
    struct.size = _ffi.sizeof(kind)
    return struct


def _doubles(array):
    return _ffi.from_buffer("double[]", array, require_writable=True)


def version() -> str:
    """Returns the version of the library, such as "0.3.0"."""
    return _text(_lib.ehdrom_version())


__version__ = version()


class Error(Exception):
    """A failed call. The text states what was found and expected. `status`: exit code of romrun for this error."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(status, text)
        self.status = status

    def __str__(self) -> str:
        return self.args[1]


class NotConverged(Error):
    """The call found no solution. After a failed step, try a shorter step."""


class Untrusted(Error):
    """Raised by Result.check and Contact.slide: there is a solution, but also a reason not to rely on it."""


# Members that are Boolean: 1 or 0 in C.
_FLAGS = {"trusted", "checked", "checked_in_time", "in_time"}


@functools.lru_cache(maxsize=None)
def _names_of(kind):
    """Returns the names of a struct's members, except the first one (the size)."""
    return [name for name, _ in _ffi.typeof(kind).fields[1:]]


def _member(struct, name):
    value = getattr(struct, name)
    return bool(value) if name in _FLAGS else value


class _Handle:
    """An object that owns memory of the library."""

    _handle: Any = None  # closed

    def close(self) -> None:
        """Frees the memory of this object now."""
        raise NotImplementedError

    def __enter__(self: _Own) -> _Own:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce_ex__(self, _: Any) -> Any:
        raise TypeError(f"{type(self).__name__}: found a copy of it wanted, expected a new one to be made")


class Model(_Handle):
    """A loaded model file. The memory is freed when the model is closed or no longer used and has no contacts left.

    pressure_modes, deformation_modes, rows: numbers of modes and rows to load, from the first one on (0: all).
    stationary: True loads no data for steps in time.
    info: the members of ehdrom_model_info in ehdrom.h: dimensions, num_x, num_y, x_min, y_min, step (half widths), …
    """

    info: dict[str, Any]

    def __init__(self, path: _Path, pressure_modes: int = 0, deformation_modes: int = 0, rows: int = 0,
                 stationary: bool = False) -> None:
        options = _begun("ehdrom_model_options")
        options.pressure_modes, options.deformation_modes = pressure_modes, deformation_modes
        options.rows, options.stationary = rows, stationary
        handle = _ffi.new("ehdrom_model **")
        status = _lib.ehdrom_model_open(handle, _characters(os.fsencode(path), "model"), options)
        self._handle = _ffi.gc(handle[0], _lib.ehdrom_model_close)
        if status:
            raise Error(status, _text(_lib.ehdrom_model_error(self._handle)))
        info = _begun("ehdrom_model_info")
        _lib.ehdrom_model_describe(self._handle, info)
        self.info = {name: _member(info, name) for name in _names_of("ehdrom_model_info")}
        self._path = os.fsdecode(path)

    def close(self) -> None:
        """Closes the model: no further contacts can be made. The memory is freed with the model's last contact."""
        self._handle = None

    def __repr__(self) -> str:
        return (f"Model({self._path!r}: {self.info['num_x']} by {self.info['num_y']} nodes, "
                f"{self.info['pressure_modes']} pressure modes, {self.info['rows']} rows)")


class _Numbers:
    """The members of a struct of ehdrom.h as attributes; repr() shows all of them."""

    __slots__ = ("_struct",)
    _kind: str
    # for type checkers
    load: float
    approach: float
    central_film_thickness: float
    minimum_film_thickness: float
    central_pressure: float
    peak_pressure: float
    exit_position: float
    half_width: float

    def __init__(self, struct: Any) -> None:
        self._struct = struct

    def __getattr__(self, name: str) -> Any:
        # while copying, the new object has no struct yet
        if name.startswith("_") or name == "size" or name not in self._members():
            raise AttributeError(f"{type(self).__name__} has no {name}")
        return _member(self._struct, name)

    @classmethod
    def _members(cls):
        return _names_of(cls._kind)

    def __dir__(self):
        return self._members()

    def __getstate__(self):
        return {name: getattr(self, name) for name in self._members()}

    def __setstate__(self, state):
        self._struct = _begun(self._kind)
        for name in state.keys() & set(self._members()):
            setattr(self._struct, name, state[name])

    def __repr__(self) -> str:
        values = {name: getattr(self, name) for name in self._members()}
        shown = (f"{name}={value if isinstance(value, bool) else format(value, '.6g')}" for name, value in values.items())
        return f"{type(self).__name__}({', '.join(shown)})"


class Result(_Numbers):
    """A solution: the members of ehdrom_result in ehdrom.h, and `reason`, why the solution is not trusted, or ""."""

    __slots__ = ("reason",)
    _kind = "ehdrom_result"
    reason: str
    status: int
    trusted: bool
    time: float
    indicated_deviation: float
    indicated_deviation_minimum: float
    local_error: float
    residual: float
    iterations: int
    inlet_heating_factor: float

    def __init__(self, struct: Any, reason: str) -> None:
        super().__init__(struct)
        self.reason = reason

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}, reason={self.reason!r})"

    def __dir__(self):
        return ["reason", "check", *self._members()]

    def __getstate__(self):
        return {**super().__getstate__(), "reason": self.reason}

    def __setstate__(self, state):
        super().__setstate__(state)
        self.reason = state["reason"]

    def check(self) -> Result:
        """Returns the result itself, or raises Untrusted."""
        if self.status:
            raise Untrusted(self.status, self.reason)
        return self


class Derivatives(_Numbers):
    """Derivatives of load, approach, films, …: the members of ehdrom_derivatives in ehdrom.h."""

    __slots__ = ()
    _kind = "ehdrom_derivatives"


def _alone(method: _Function) -> _Function:
    """Wraps a method of a contact. It raises Error if another thread is in a call, or if the contact is closed."""

    @functools.wraps(method)
    def call(self, *arguments, **named):
        if not self._lock.acquire(blocking=False):
            raise Error(_lib.EHDROM_INTERNAL, "contact: found a call of another thread under way, expected one at a "
                                              "time, or a contact for each")
        try:
            if self._handle is None:
                raise Error(_lib.EHDROM_INTERNAL, "contact: found it closed, expected it open")
            return method(self, *arguments, **named)
        finally:
            self._lock.release()

    return call  # type: ignore[return-value]


class Contact(_Handle):
    """A contact with a solver and a time of its own.

    scene: a file with all settings. contact["key"] = value sets one setting by its key in scenes. The value None unsets
    the setting. contact["key"] returns the value. Settings take effect with the next solve or start.
    accuracy: results with a larger error estimate of the films are not trusted; default 0.01. With float("inf") neither
    the estimate nor a model that was never checked makes a result untrusted.
    tolerance, step_tolerance: see ehdrom_contact_set_tolerance and ehdrom_contact_set_step_tolerance in ehdrom.h.
    """

    model: Model

    def __init__(self, model: Model, scene: _Path | None = None, dimensionless: bool = False,
                 accuracy: float | None = None, tolerance: float | None = None,
                 step_tolerance: float | None = None) -> None:
        if not isinstance(model, Model):
            raise TypeError(f"model: found {type(model).__name__}, expected a Model")
        of = model._handle
        if of is None:
            raise Error(_lib.EHDROM_INTERNAL, "model: found it closed, expected it open")
        handle = _ffi.new("ehdrom_contact **")
        status = _lib.ehdrom_contact_create(handle, of)
        self._lock = threading.RLock()
        self.model = model
        # the lambda keeps a reference to the model's handle, so the model lives as long as the contact
        self._handle = _ffi.gc(handle[0], lambda freed, _=of: _lib.ehdrom_contact_free(freed))
        self._passed(status)
        if dimensionless:
            self._passed(_lib.ehdrom_contact_set_units(self._handle, _lib.EHDROM_DIMENSIONLESS))
        if scene is not None:
            self._passed(_lib.ehdrom_contact_read(self._handle, _characters(os.fsencode(scene), "scene")))
        for value, setter in ((accuracy, _lib.ehdrom_contact_set_accuracy),
                              (tolerance, _lib.ehdrom_contact_set_tolerance),
                              (step_tolerance, _lib.ehdrom_contact_set_step_tolerance)):
            if value is not None:
                self._passed(setter(self._handle, value))

    @_alone
    def _free(self):
        _ffi.release(self._handle)
        self._handle = None

    def close(self) -> None:
        """Frees the contact; closing it again does nothing."""
        if self._handle is not None:
            self._free()

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

    @_alone
    def __setitem__(self, key: str, value: float | str | bool | None) -> None:
        name = _characters(key.encode(), "settings")
        if isinstance(value, (bool, numpy.bool_)):
            value = "true" if value else "false"
        if isinstance(value, str) or value is None:
            text = _ffi.NULL if value is None else _characters(value.encode(), "settings")
            self._passed(_lib.ehdrom_contact_set(self._handle, name, text))
        else:
            self._passed(_lib.ehdrom_contact_set_number(self._handle, name, value))

    @_alone
    def __getitem__(self, key: str) -> float | str | bool | None:
        """Returns a setting: a number, a text, True, False, or None if it is not set."""
        text = _ffi.new("char[]", 4096)
        self._passed(_lib.ehdrom_contact_get(self._handle, _characters(key.encode(), "settings"), text, len(text)))
        value = _text(text)
        try:
            return {"": None, "true": True, "false": False}[value] if value in ("", "true", "false") else float(value)
        except ValueError:
            return value

    @_alone
    def scales(self) -> dict[str, float]:
        """Returns the scales of dimensionless quantities in SI units: the members of ehdrom_scales in ehdrom.h.

        These are half_width, film, hertz_pressure, load, speed, time, half_width_across, moes_M and moes_L."""
        scales = _begun("ehdrom_scales")
        self._passed(_lib.ehdrom_contact_scales(self._handle, scales))
        return {name: getattr(scales, name) for name in _names_of("ehdrom_scales")}

    @_alone
    def solve(self) -> Result:
        """Solves the stationary contact of the settings."""
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

    @_alone
    def start(self, *, load: float | None = None, approach: float | None = None, speed: float | None = None,
              radius: float | None = None, modulus: float | None = None) -> Result:
        """Solves the stationary state of these conditions at time 0. The settings give the other conditions."""
        conditions = self._conditions({"load": load, "approach": approach, "speed": speed, "radius": radius,
                                       "modulus": modulus})
        struct = _begun("ehdrom_result")
        return self._result(_lib.ehdrom_start(self._handle, conditions, struct), struct)

    @_alone
    def step(self, step: float, *, load: float | None = None, approach: float | None = None, speed: float | None = None,
             radius: float | None = None, modulus: float | None = None) -> Result:
        """Solves the state `step` seconds after the last accepted state. The call can be repeated as often as wanted.

        Give the load in N or N/m, or the approach in m. The approach of a line contact is measured from approach_length
        half widths (10 unless set)."""
        conditions = self._conditions({"load": load, "approach": approach, "speed": speed, "radius": radius,
                                       "modulus": modulus})
        struct = _begun("ehdrom_result")
        return self._result(_lib.ehdrom_step(self._handle, conditions, step, struct), struct)

    @_alone
    def differentiate(self, *, load: float | None = None, approach: float | None = None, speed: float | None = None,
                      radius: float | None = None, modulus: float | None = None) -> Derivatives:
        """Returns the derivatives of the results along a direction.

        The arguments are the rates of change of the conditions, in their units; other conditions stay constant.
        approach=0 keeps the approach constant, and load=0 keeps the load constant. Without both arguments, the quantity
        that was given for the solution stays constant. With approach=1, `load` of the Derivatives is dF/dh.
        After solve or start the result has the derivatives of stationary solutions. After a step that is not accepted
        yet, it has the derivatives by the conditions at the end of the step."""
        direction = self._conditions({"load": load, "approach": approach, "speed": speed, "radius": radius,
                                      "modulus": modulus})
        struct = _begun("ehdrom_derivatives")
        self._solved(_lib.ehdrom_differentiate(self._handle, direction, struct))
        return Derivatives(struct)

    @_alone
    def respond(self) -> dict[str, float]:
        """Returns stiffness (N/m^2 or N/m), damping (N s/m^2 or N s/m) and damping_bound of the last solve or start.

        They describe the response of the force to a small slow change of the approach,
        dF = -(stiffness + s damping) dh for s -> 0."""
        struct = _begun("ehdrom_response")
        self._solved(_lib.ehdrom_respond(self._handle, struct))
        return {name: getattr(struct, name) for name in _names_of("ehdrom_response")}

    @_alone
    def slide(self, sliding: float | None = None) -> dict[str, float]:
        """Returns the traction of the last solve or the accepted state.

        sliding: u1 - u2 in m/s; by default the slide_roll of the settings.
        The traction has friction_coefficient, friction_force and rolling_resistance (N/m or N), rolling_moment (N or
        N m), power_loss (W/m or W), mean_shear_stress and largest_shear_stress (Pa). indicated_deviation_friction is
        the relative error estimate of the friction. It is nan for a step, and for a model without a check of the
        friction. Raises Untrusted if the friction exceeds the load, as with a Newtonian fluid at high pressure."""
        return self._slid(_lib.ehdrom_slide, sliding)

    def _slid(self, call, sliding):
        struct = _begun("ehdrom_traction")
        status = call(self._handle, numpy.nan if sliding is None else sliding, struct)
        self._solved(status)
        if status == _lib.EHDROM_UNTRUSTED:
            raise Untrusted(status, self._error())
        return {name: getattr(struct, name) for name in _names_of("ehdrom_traction")}

    @_alone
    def slide_step(self, sliding: float | None = None) -> dict[str, float]:
        """Like slide, for the last step, which need not be accepted."""
        return self._slid(_lib.ehdrom_slide_step, sliding)

    @_alone
    def accept(self) -> None:
        """Accepts the last step."""
        self._passed(_lib.ehdrom_accept(self._handle))

    @_alone
    def restart(self) -> None:
        """Makes the next step a step of first order. Call it after a jump of the conditions."""
        self._passed(_lib.ehdrom_restart(self._handle))

    @_alone
    def save(self) -> numpy.ndarray:
        """Returns the accepted state as a numpy array for restore()."""
        count = _ffi.new("size_t *")
        self._passed(_lib.ehdrom_state_size(self._handle, count))
        state = numpy.empty(count[0])
        self._passed(_lib.ehdrom_state_save(self._handle, _doubles(state), state.size))
        return state

    @_alone
    def restore(self, state: numpy.ndarray) -> None:
        """Restores a saved state of any contact with the same model and settings."""
        state = numpy.array(state, dtype=float)
        self._passed(_lib.ehdrom_state_restore(self._handle, _doubles(state), state.size))

    @_alone
    def fields(self) -> tuple[numpy.ndarray, numpy.ndarray, numpy.ndarray, numpy.ndarray]:
        """Returns x [num_x] and y [num_y] in m, pressure in Pa and film in m [num_y, num_x].

        The fields belong to the last solution or the accepted state. For a list of models on different grids, the nodes
        are those of the model that has solved the contact. The library writes into the returned arrays."""
        num_x, num_y = self.model.info["num_x"], self.model.info["num_y"]
        x, y, pressure, film = numpy.empty(num_x), numpy.empty(num_y), numpy.empty((num_y, num_x)), numpy.empty((num_y, num_x))
        self._passed(_lib.ehdrom_axes(self._handle, _doubles(x), _doubles(y)))
        self._passed(_lib.ehdrom_fields(self._handle, _doubles(pressure), _doubles(film)))
        own = self._num_x()
        return x[:own], y, pressure[:, :own], film[:, :own]

    def _num_x(self):
        """Returns the number of nodes along x of the last solution or the accepted state."""
        num_x = _ffi.new("size_t *")
        self._passed(_lib.ehdrom_nodes(self._handle, num_x, _ffi.NULL))
        return num_x[0]

    @_alone
    def shear_stresses(self, sliding: float | None = None) -> tuple[numpy.ndarray, numpy.ndarray]:
        """Returns the stresses of the fluid on surface 1 and on surface 2 along x, Pa, two arrays [num_y, num_x].

        They are given at the nodes of fields(), for the last solution or the accepted state. sliding: see slide()."""
        stresses = numpy.empty((2, self.model.info["num_y"], self.model.info["num_x"]))
        self._passed(_lib.ehdrom_shear_stresses(self._handle, numpy.nan if sliding is None else sliding,
                                                _doubles(stresses[0]), _doubles(stresses[1])))
        own = self._num_x()
        return stresses[0][:, :own], stresses[1][:, :own]
