"""wisplab from Python: a model of deformable hair wisps, for methods of your own.

    import wisplab
    swing = wisplab.Scene("swing")
    a = swing.acceleration(swing.t, swing.q, swing.v)

wisplab.h, which is installed beside, says what each function means: shapes, units, errors, sources.
Here vectors are arrays of numpy, a state is (t, q, v) or (t, y) with y = (q, v) in one array of
2 n numbers, and a function that fails raises wisplab.Error with the library's text. What cannot be an
argument, as a text for a number, an array of another shape, or a number that is not finite, raises
TypeError or ValueError. Energy and frames are those of the scene's own state where none is given.

The library is looked for where WISPLAB_LIBRARY says, then beside this file's installation or in
the build of its source tree, then where the system has it.
"""

import contextlib
import ctypes
import glob
import math
import operator
import os
import secrets
from ctypes import byref, c_char_p, c_double, c_int, c_longlong, c_uint, c_void_p

import numpy as np

REFUSED, FAILED, NO_MEMORY, STOPPED = 1, 2, 3, 4
EXACT, SPD = 0, 1
COLLISION, INTERACTION, KINK = 4, 8, 16


class Error(RuntimeError):
    """What the library refuses or fails at; `code` is REFUSED, FAILED, NO_MEMORY or STOPPED."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


class _Unknown(ctypes.Structure):
    _fields_ = [("wisp", c_int), ("node", c_int), ("name", c_char_p), ("unit", c_char_p)]


_FRAME = ctypes.CFUNCTYPE(c_int, c_void_p, c_double, ctypes.POINTER(c_double), c_int)


class _Method(ctypes.Structure):
    _fields_ = [("stepper", c_char_p), ("linear", c_char_p), ("step", c_double),
                ("rtol", c_double), ("atol", c_double), ("options", ctypes.POINTER(c_char_p)),
                ("strain_limit", c_double), ("threads", c_int), ("frame", _FRAME),
                ("context", c_void_p)]


def _load():
    name = "libwisplab.so.0"
    told = os.environ.get("WISPLAB_LIBRARY")
    here = os.path.dirname(os.path.realpath(__file__))
    places = [".", "../..", "../../*", "../../../lib*", "../../build"]
    found = [file for place in places for file in sorted(glob.glob(os.path.join(here, place, name)))]
    return ctypes.CDLL(told or (found + [name])[0])


_lib = _load()
_HANDLE, _TEXTS = c_void_p, ctypes.POINTER(c_char_p)
for _name, _result, _arguments in [
        ("version", c_char_p, []),
        ("open", c_int, [c_void_p, c_char_p, _TEXTS, c_char_p, c_char_p, ctypes.c_size_t]),
        ("open_text", c_int, [c_void_p, c_char_p, c_char_p, _TEXTS, c_char_p, c_char_p,
                              ctypes.c_size_t]),
        ("close", None, [_HANDLE]),
        ("error", c_char_p, [_HANDLE]),
        ("scene", c_char_p, [_HANDLE]),
        ("treatment", c_char_p, [_HANDLE]),
        ("unknowns", c_int, [_HANDLE]),
        ("wisps", c_int, [_HANDLE]),
        ("nodes", c_int, [_HANDLE]),
        ("parent", c_int, [_HANDLE, c_int]),
        ("unknown", c_int, [_HANDLE, c_int, c_void_p]),
        ("times", None, [_HANDLE] + 3 * [c_void_p]),
        ("state", None, [_HANDLE] + 3 * [c_void_p]),
        ("set_state", c_int, [_HANDLE, c_double, c_void_p, c_void_p]),
        ("acceleration", c_int, [_HANDLE, c_double] + 3 * [c_void_p]),
        ("time_rate", c_int, [_HANDLE, c_double] + 3 * [c_void_p]),
        ("project", c_int, [_HANDLE, c_double] + 2 * [c_void_p]),
        ("energies", c_int, []),
        ("energy_name", c_char_p, [c_int]),
        ("energy", c_int, [_HANDLE, c_double] + 3 * [c_void_p]),
        ("linearise", c_int, [_HANDLE, c_int, c_double, c_void_p, c_void_p]),
        ("product", c_int, [_HANDLE] + 3 * [c_double] + 2 * [c_void_p]),
        ("dense", c_int, [_HANDLE] + 3 * [c_double] + [c_void_p]),
        ("entries", c_int, [_HANDLE]),
        ("pattern", c_int, [_HANDLE] + 2 * [c_void_p]),
        ("sparse", c_int, [_HANDLE] + 3 * [c_double] + [c_void_p]),
        ("factor", c_int, [_HANDLE] + 2 * [c_double]),
        ("solve", c_int, [_HANDLE] + 2 * [c_void_p]),
        ("mass_solve", c_int, [_HANDLE, c_double] + 4 * [c_void_p]),
        ("columns", c_int, [_HANDLE]),
        ("column", c_char_p, [_HANDLE, c_int]),
        ("frame", c_int, [_HANDLE, c_double] + 3 * [c_void_p]),
        ("positions", c_int, [_HANDLE, c_double] + 3 * [c_void_p]),
        ("tips", c_int, [_HANDLE, c_double] + 3 * [c_void_p]),
        ("next_stop", None, [_HANDLE] + 2 * [c_void_p]),
        ("tick", c_int, [_HANDLE, c_void_p]),
        ("run", c_int, [_HANDLE, c_void_p, c_double]),
        ("counters", c_int, []),
        ("counter_name", c_char_p, [c_int]),
        ("counts", None, [_HANDLE, c_void_p])]:
    _function = getattr(_lib, "wisplab_" + _name)
    _function.restype, _function.argtypes = _result, _arguments

version = _lib.wisplab_version().decode()
_ENERGIES = [_lib.wisplab_energy_name(i).decode() for i in range(_lib.wisplab_energies())]
_COUNTERS = [_lib.wisplab_counter_name(i).decode() for i in range(_lib.wisplab_counters())]


# ---- what arguments may be: C does not ask


def _text(name, text):
    if not isinstance(text, str):
        raise TypeError(f"{name}: a text is wanted, not {type(text).__name__}")
    return _whole(name, text.encode())


def _whole(name, text):
    """A text that C does not take for a shorter one."""
    if b"\0" in text:
        raise ValueError(f"{name}: has a zero in it, where C would end it: {text!r}")
    return text


def _text_or_none(name, text):
    return None if text is None else _text(name, text)


def _texts(name, values):
    """A list that ends with NULL; of a dictionary, "key=value"."""
    if isinstance(values, (str, bytes)):
        raise TypeError(f"{name}: a dictionary or a list of texts is wanted, not one text")
    if isinstance(values, dict):
        values = [f"{_text(name, key).decode()}={_value(value)}" for key, value in values.items()]
    values = [_text(name, value) for value in ([] if values is None else values)]
    return (c_char_p * (len(values) + 1))(*values, None)


def _value(value):
    return str(value).lower() if isinstance(value, (bool, np.bool_)) else str(value)


def _number(name, x):
    if not isinstance(x, float):
        array = np.asarray(x)
        if array.dtype.kind not in "biuf" or array.shape:
            raise TypeError(f"{name}: a real number is wanted, not {type(x).__name__}")
        x = float(array)
    if not math.isfinite(x):
        raise ValueError(f"{name}: must be finite, not {x}")
    return x


def _positive(name, x):
    x = _number(name, x)
    if x <= 0:
        raise ValueError(f"{name}: must be positive, not {x}")
    return x


_DOUBLE = np.dtype(float)


def _vector(name, x, shape):
    """An array of real numbers, whatever it was, of that shape."""
    if type(x) is np.ndarray and x.dtype is _DOUBLE and x.shape == shape:
        return x  # nearly always, and an evaluation takes no longer than all the questions below
    x = np.asarray(x)
    if x.dtype.kind not in "biuf":
        raise TypeError(f"{name}: real numbers are wanted, not {x.dtype}")
    if x.shape != shape:
        raise ValueError(f"{name}: an array of shape {shape} is wanted, not {x.shape}")
    return x


def _must_be_finite(name, x):
    if not math.isfinite(x.dot(x)) and not np.isfinite(x).all():  # the first takes no time
        i = int(np.argmin(np.isfinite(x)))
        raise ValueError(f"{name}: number {i} is {x[i]}; all must be finite")


def _numbers(name, x, n):
    """n finite numbers as C wants them."""
    x = np.ascontiguousarray(_vector(name, x, (n,)), dtype=float)
    _must_be_finite(name, x)
    return x


# ---- what a scene holds


class _Handle:
    """The library's handle, which a call takes and gives back: another one meanwhile, of another
    thread or of a function that the call calls, would find the model half changed."""

    def __init__(self, at=None):
        self._at = at
        self._free = [] if at is None else [at]

    def __enter__(self):
        try:
            return self._free.pop()  # at once, whatever threads there are
        except IndexError:
            pass
        if self._at is None:
            raise ValueError("the scene is closed")
        raise Error(REFUSED, "the scene is at work: it is for one thread at a time, and not for the "
                             "frame function of its own run")

    def __exit__(self, *_):
        self._free.append(self._at)

    def close(self):
        if self._at is not None:
            at = self.__enter__()
            self._at = None
            _lib.wisplab_close(at)

    def __del__(self):
        if self._at is not None:
            _lib.wisplab_close(self._at)


class _Room:
    """Places for q, v and a result, whose addresses are asked for once: that would take as long as an
    evaluation."""

    def __init__(self, n):
        self.n = n
        self.y, self.a, self.shape = np.zeros(2 * n), np.zeros(n), (n,)
        self.q, self.v = self.y[:n], self.y[n:]
        self.at = tuple(x.ctypes.data for x in (self.q, self.v, self.a))

    def take(self, q, v):
        self.q[:] = _vector("q", q, self.shape)
        self.v[:] = _vector("v", v, self.shape)
        _must_be_finite("(q, v)", self.y)


@contextlib.contextmanager
def _new_file(path):
    """A file that has its name when it is complete; before that, and where it never is, what was
    there stays."""
    path = os.fsdecode(path)
    if os.path.exists(path) and not os.path.isfile(path):
        raise ValueError(f"{path}: cannot be written: there is something, and no file")
    part = f"{path}.{os.getpid()}-{secrets.token_hex(4)}.part"
    try:
        with open(part, "x", encoding="utf-8") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except BaseException:
        with contextlib.suppress(OSError, ValueError):
            os.unlink(part)
        raise


def _head_line(key, value):
    """What the head of a states file says of it, as `wisplab experiment` reads it."""
    if key in ("evaluations", "cpu_seconds", "setting"):
        value = repr(_positive(key, value)).removesuffix(".0")
    line = f"# {key}: {value}"
    if not key.isidentifier() or not line.isprintable():
        raise ValueError(f"{key!r}: {value!r}: must be a name and one line of printable text")
    return line + "\n"


def _method_value(name, value):
    if name == "linear":
        return _text_or_none(name, value)
    if name != "threads":
        return _positive(name, value)
    threads = operator.index(value)
    if not 1 <= threads <= 1024:
        raise ValueError(f"threads: must be from 1 to 1024, not {threads}")
    return threads


class Scene:
    """A scene brought to life, with a state and a clock: the handle of wisplab.h.

    scene: the name of a shipped scene, or a path to a .cfg file; text: the text of one instead, for
    which `scene` is the path that it stands for. sets: changes as `--set` takes them, a dictionary
    {"material.hair_count": 500} or a list of "path=value". treatment: "generalised" (on wisps),
    "projection", "penalty".
    """

    _handle = _Handle()  # until one is opened
    _room = None         # of type _Room; None: to be made, for n may be another one

    def __init__(self, scene="scene.cfg", sets=None, treatment=None, text=None):
        handle, error = c_void_p(), ctypes.create_string_buffer(400)
        path = _whole("scene", os.fsencode(scene))
        rest = (_texts("sets", sets), _text_or_none("treatment", treatment), error, len(error))
        if text is None:
            code = _lib.wisplab_open(byref(handle), path, *rest)
        else:
            code = _lib.wisplab_open_text(byref(handle), _text("text", text), path, *rest)
        if code:
            raise Error(code, error.value.decode(errors="replace"))
        self._handle = _Handle(handle)
        times = [c_double() for _ in range(3)]
        _lib.wisplab_times(handle, *map(byref, times))
        self.begin, self.end, self.frame_rate = (time.value for time in times)
        self.name = _lib.wisplab_scene(handle).decode(errors="replace")
        self.treatment = _lib.wisplab_treatment(handle).decode()
        self._columns = tuple(_lib.wisplab_column(handle, i).decode()
                              for i in range(_lib.wisplab_columns(handle)))

    def close(self):
        """Frees what the scene holds, which otherwise goes with it; nothing can be asked of it then."""
        self._handle.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __reduce__(self):
        raise TypeError("a scene cannot be copied or pickled; open it again")

    def _take_room(self, handle):
        if self._room is None:
            self._room = _Room(_lib.wisplab_unknowns(handle))
        return self._room

    def _room_with(self, handle, q, v):
        room = self._take_room(handle)
        room.take(q, v)
        return room

    def _room_with_own(self, handle, t, q, v):
        """With the state that is given, or the scene's own; returns its time, too."""
        if t is not None and q is not None and v is not None:
            return _number("t", t), self._room_with(handle, q, v)
        if t is not None or q is not None or v is not None:
            raise TypeError("t, q and v go together: give all of them, or none for the scene's own")
        own, room = c_double(), self._take_room(handle)
        _lib.wisplab_state(handle, byref(own), *room.at[:2])
        return own.value, room

    def _must_be_done(self, handle, code):
        if code:
            raise Error(code, _lib.wisplab_error(handle).decode(errors="replace"))

    # ---- what there is

    @property
    def n(self):
        """How many numbers q, v and a have each; a tick may make them more."""
        room = self._room
        if room is None:
            with self._handle as handle:
                room = self._take_room(handle)
        return room.n

    @property
    def columns(self):
        """The names of a frame's columns."""
        return list(self._columns)

    @property
    def wisps(self):
        with self._handle as handle:
            return _lib.wisplab_wisps(handle)

    @property
    def nodes(self):
        with self._handle as handle:
            return _lib.wisplab_nodes(handle)

    @property
    def unknowns(self):
        """A list of (wisp, node, name, unit): what q[i], v[i] and a[i] belong to."""
        one = _Unknown()
        result = []
        with self._handle as handle:
            for i in range(self._take_room(handle).n):
                _lib.wisplab_unknown(handle, i, byref(one))
                result.append((one.wisp, one.node, one.name.decode(), one.unit.decode()))
        return result

    @property
    def frame_times(self):
        """The times of the scene's frames, s."""
        if self.frame_rate == 0:
            return np.array([self.begin, self.end])
        first = np.floor(self.begin * self.frame_rate) + 1
        inside = np.arange(first, self.end * self.frame_rate - 1e-9) / self.frame_rate
        return np.concatenate(([self.begin], inside, [self.end]))

    @property
    def counters(self):
        """A dictionary of what was counted since the scene was opened."""
        counts = (c_longlong * len(_COUNTERS))()
        with self._handle as handle:
            _lib.wisplab_counts(handle, counts)
        return dict(zip(_COUNTERS, counts))

    # ---- the state

    @property
    def t(self):
        t = c_double()
        with self._handle as handle:
            _lib.wisplab_state(handle, byref(t), None, None)
        return t.value

    @property
    def y(self):
        """q and v in one array of 2 n numbers."""
        with self._handle as handle:
            n = self._take_room(handle).n
            y = np.empty(2 * n)
            at = y.ctypes.data
            _lib.wisplab_state(handle, None, at, at + n * y.itemsize)
        return y

    @property
    def q(self):
        return self._halves("y", self.y)[0]

    @property
    def v(self):
        return self._halves("y", self.y)[1]

    def _halves(self, name, y):
        n = self.n
        y = _vector(name, y, (2 * n,))
        return y[:n], y[n:]

    def set_state(self, t, y):
        t, (q, v) = _number("t", t), self._halves("y", y)
        with self._handle as handle:
            room = self._room_with(handle, q, v)
            self._must_be_done(handle, _lib.wisplab_set_state(handle, t, *room.at[:2]))

    # ---- forces and energy

    def acceleration(self, t, q, v):
        t = _number("t", t)
        with self._handle as handle:
            room = self._room_with(handle, q, v)
            self._must_be_done(handle, _lib.wisplab_acceleration(handle, t, *room.at))
            return room.a.copy()

    def time_rate(self, t, q, v):
        t = _number("t", t)
        with self._handle as handle:
            room = self._room_with(handle, q, v)
            self._must_be_done(handle, _lib.wisplab_time_rate(handle, t, *room.at))
            return room.a.copy()

    def project(self, t, q, v):
        t = _number("t", t)
        with self._handle as handle:
            room = self._room_with(handle, q, v)
            self._must_be_done(handle, _lib.wisplab_project(handle, t, *room.at[:2]))
            return room.q.copy(), room.v.copy()

    def energy(self, t=None, q=None, v=None):
        """A dictionary, J; its values add up to all of it."""
        energies = (c_double * len(_ENERGIES))()
        with self._handle as handle:
            t, room = self._room_with_own(handle, t, q, v)
            self._must_be_done(handle, _lib.wisplab_energy(handle, t, *room.at[:2], energies))
        return dict(zip(_ENERGIES, energies))

    def rhs(self, t, y):
        """dy/dt: (v, a), for methods of first order."""
        q, v = self._halves("y", y)
        return np.concatenate((v, self.acceleration(t, q, v)))

    # ---- matrices

    def linearise(self, t, q, v, kind=EXACT):
        t, kind = _number("t", t), operator.index(kind)
        if kind not in (EXACT, SPD):
            raise ValueError(f"kind: must be EXACT or SPD, not {kind}")
        with self._handle as handle:
            room = self._room_with(handle, q, v)
            self._must_be_done(handle, _lib.wisplab_linearise(handle, kind, t, *room.at[:2]))

    def product(self, m, d, k, x):
        factors = _number("m", m), _number("d", d), _number("k", k)
        with self._handle as handle:
            n = self._take_room(handle).n
            x, y = _numbers("x", x, n), np.empty(n)
            self._must_be_done(handle, _lib.wisplab_product(handle, *factors, x.ctypes.data,
                                                            y.ctypes.data))
        return y

    def dense(self, m=0.0, d=0.0, k=0.0):
        """m M + d D + k K of the last linearisation."""
        factors = _number("m", m), _number("d", d), _number("k", k)
        with self._handle as handle:
            n = self._take_room(handle).n
            matrix = np.empty((n, n), order="F")
            self._must_be_done(handle, _lib.wisplab_dense(handle, *factors, matrix.ctypes.data))
        return matrix

    def sparse(self, m=0.0, d=0.0, k=0.0):
        """The same as a scipy.sparse.csc_matrix."""
        from scipy.sparse import csc_matrix
        factors = _number("m", m), _number("d", d), _number("k", k)
        with self._handle as handle:
            n, entries = self._take_room(handle).n, _lib.wisplab_entries(handle)
            start, row = np.empty(n + 1, dtype=np.intc), np.empty(entries, dtype=np.intc)
            values = np.empty(entries)
            self._must_be_done(handle, _lib.wisplab_pattern(handle, start.ctypes.data,
                                                            row.ctypes.data))
            self._must_be_done(handle, _lib.wisplab_sparse(handle, *factors, values.ctypes.data))
        return csc_matrix((values, row, start), shape=(n, n))

    def factor(self, alpha, beta):
        alpha, beta = _number("alpha", alpha), _number("beta", beta)
        with self._handle as handle:
            self._must_be_done(handle, _lib.wisplab_factor(handle, alpha, beta))

    def solve(self, b):
        with self._handle as handle:
            n = self._take_room(handle).n
            b, x = _numbers("b", b, n), np.empty(n)
            self._must_be_done(handle, _lib.wisplab_solve(handle, b.ctypes.data, x.ctypes.data))
        return x

    def mass_solve(self, t, q, v, b):
        t = _number("t", t)
        with self._handle as handle:
            room = self._room_with(handle, q, v)
            b, x = _numbers("b", b, room.n), np.empty(room.n)
            self._must_be_done(handle, _lib.wisplab_mass_solve(handle, t, *room.at[:2],
                                                               b.ctypes.data, x.ctypes.data))
        return x

    def jacobian(self, t, y):
        """The derivative of rhs by y, with the frames of samples held: 2 n by 2 n."""
        q, v = self._halves("y", y)
        n = len(q)
        self.linearise(t, q, v)
        matrix = np.zeros((2 * n, 2 * n))
        matrix[:n, n:] = np.eye(n)
        matrix[n:] = np.linalg.solve(self.dense(m=1), np.hstack((self.dense(k=1), self.dense(d=1))))
        return matrix

    # ---- frames

    def frame(self, t=None, q=None, v=None):
        """The rows of states.tsv without time: nodes by columns."""
        with self._handle as handle:
            t, room = self._room_with_own(handle, t, q, v)
            rows = np.empty((_lib.wisplab_nodes(handle), len(self._columns)))
            self._must_be_done(handle, _lib.wisplab_frame(handle, t, *room.at[:2],
                                                          rows.ctypes.data))
        return rows

    def positions(self, t=None, q=None, v=None):
        """Of all nodes in space, m: nodes by 3."""
        with self._handle as handle:
            t, room = self._room_with_own(handle, t, q, v)
            xyz = np.empty((_lib.wisplab_nodes(handle), 3))
            self._must_be_done(handle, _lib.wisplab_positions(handle, t, *room.at[:2],
                                                              xyz.ctypes.data))
        return xyz

    def tips(self, t=None, q=None, v=None):
        """Of the last node of each wisp, m: wisps by 3."""
        with self._handle as handle:
            t, room = self._room_with_own(handle, t, q, v)
            xyz = np.empty((_lib.wisplab_wisps(handle), 3))
            self._must_be_done(handle, _lib.wisplab_tips(handle, t, *room.at[:2], xyz.ctypes.data))
        return xyz

    def write_states(self, path, times, states, **said):
        """A states.tsv of these times and states y, for `wisplab experiment work-precision
        --states NAME=FILE`. said: what its head says of how it came about, as evaluations=5210,
        cpu_seconds=1.3, setting=1e-6. The file is there when it is complete: where something is
        wrong, as with a state that is not finite, that is raised and `path` is as it was."""
        times = _numbers("times", times, len(times))
        if len(times) == 0 or (np.diff(times) <= 0).any():
            raise ValueError("times: must be one or more, each after the one before")
        if "treatment" in said:
            raise TypeError("treatment: is the scene's")
        head = [_head_line(key, value) for key, value in said.items()]
        with self._handle as handle:
            parents = [_lib.wisplab_parent(handle, i) for i in range(_lib.wisplab_wisps(handle))]
        left, none = iter(states), object()
        with _new_file(path) as file:
            file.write("# states at the frames: s, m, m/s\n")
            file.writelines([_head_line("treatment", self.treatment), *head])
            file.write("\t".join(("t", *self._columns, "parent")) + "\n")
            for i, t in enumerate(times):
                y = next(left, none)
                if y is none:
                    raise ValueError(f"states: {i} of them for {len(times)} times")
                for row in self.frame(t, *self._halves(f"states: that at t = {float(t)!r}", y)):
                    wisp, node = int(row[0]), int(row[1])
                    numbers = "\t".join(repr(float(x)) for x in row[2:])
                    file.write(f"{float(t)!r}\t{wisp}\t{node}\t{numbers}\t{parents[wisp]}\n")
            if next(left, none) is not none:
                raise ValueError(f"states: more of them than the {len(times)} times")

    # ---- the clock, and the program's own methods

    def next_stop(self):
        """(time, events): beyond it nothing is smooth; (inf, 0) where there is none."""
        t, events = c_double(), c_uint()
        with self._handle as handle:
            _lib.wisplab_next_stop(handle, byref(t), byref(events))
        return t.value, events.value

    def tick(self):
        """What is due at the next stop, where the state must be; whether that changed it."""
        changed = c_int()
        with self._handle as handle:
            self._room = None
            self._must_be_done(handle, _lib.wisplab_tick(handle, byref(changed)))
        return bool(changed.value)

    def advance(self, to, smooth):
        """Takes the state to time `to`, ticks included. smooth(t, stop, y) is your method: the
        state at `stop` of the smooth motion from (t, y)."""
        to = _number("to", to)
        if not callable(smooth):
            raise TypeError(f"smooth: a function is wanted, not {type(smooth).__name__}")
        begin, rounding = self.t, 1e-12 * max(1, abs(to))
        if to < begin - rounding:
            raise ValueError(f"to: {to} s is before the state's time, {begin} s")
        while self.t < to:
            stop, _ = self.next_stop()
            last = stop > to + rounding
            at = to if last else stop
            self.set_state(at, smooth(self.t, at, self.y))
            if not last:
                self.tick()

    def run(self, to, stepper=None, frame=None, options=None, **method):
        """Takes the state to time `to` by a stepper of the program. method: linear, step, rtol,
        atol, strain_limit, threads. frame(t, rows) is called with each frame, and may not ask the
        scene; True ends the run."""
        raised = []
        to = _number("to", to)
        if frame is not None and not callable(frame):
            raise TypeError(f"frame: a function is wanted, not {type(frame).__name__}")

        def show(_, t, rows, nodes):
            try:
                shape = (nodes, len(self._columns))
                return bool(frame(t, np.ctypeslib.as_array(rows, shape).copy()))
            except BaseException as error:  # nothing may pass through C
                raised.append(error)
                return True

        request = _Method(stepper=_text_or_none("stepper", stepper),
                          options=_texts("options", options),
                          frame=_FRAME() if frame is None else _FRAME(show))
        for name, value in method.items():
            if name not in ("linear", "step", "rtol", "atol", "strain_limit", "threads"):
                raise TypeError(f"run has no argument {name}")
            setattr(request, name, _method_value(name, value))
        with self._handle as handle:
            self._room = None
            code = _lib.wisplab_run(handle, byref(request), to)
            if raised:
                raise raised[0]
            self._must_be_done(handle, code)
