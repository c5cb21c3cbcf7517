"""wisplab from Python: a model of deformable hair wisps, for methods of your own.

    import wisplab
    swing = wisplab.Scene("swing")
    a = swing.acceleration(swing.t, swing.q, swing.v)

wisplab.h, which is installed beside, says what each function means: shapes, units, errors, sources.
Here vectors are arrays of numpy, a state is (t, q, v) or (t, y) with y = (q, v) in one array of
2 n numbers, and a function that fails raises wisplab.Error with the library's text. Energy and frames are those of
the scene's own state where none is given.

The library is looked for where WISPLAB_LIBRARY says, then beside this file's installation or in
the build of its source tree, then where the system has it.
"""

import ctypes
import glob
import os
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


def _texts(values):
    """A list that ends with NULL; of a dictionary, "key=value"."""
    if isinstance(values, dict):
        values = [f"{key}={str(value).lower() if isinstance(value, bool) else value}"
                  for key, value in values.items()]
    values = [value.encode() for value in values or []]
    return (c_char_p * (len(values) + 1))(*values, None)


def _encoded(text):
    return None if text is None else os.fspath(text).encode()


def _numbers(x, shape):
    x = np.ascontiguousarray(x, dtype=float)
    if x.shape != shape:
        raise ValueError(f"an array of shape {shape} is wanted, not {x.shape}")
    return x


class Scene:
    """A scene brought to life, with a state and a clock: the handle of wisplab.h.

    scene: the name of a shipped scene, or a path to a .cfg file; text: the text of one instead, for
    which `scene` is the path that it stands for. sets: changes as `--set` takes them, a dictionary
    {"material.hair_count": 500} or a list of "path=value". treatment: "generalised" (on wisps),
    "projection", "penalty".
    """

    def __init__(self, scene="scene.cfg", sets=None, treatment=None, text=None):
        self._handle = None
        handle, error = c_void_p(), ctypes.create_string_buffer(400)
        rest = (_texts(sets), _encoded(treatment), error, len(error))
        if text is None:
            code = _lib.wisplab_open(byref(handle), _encoded(scene), *rest)
        else:
            code = _lib.wisplab_open_text(byref(handle), text.encode(), _encoded(scene), *rest)
        if code:
            raise Error(code, error.value.decode())
        self._handle = handle
        times = [c_double() for _ in range(3)]
        _lib.wisplab_times(handle, *map(byref, times))
        self.begin, self.end, self.frame_rate = (time.value for time in times)
        self.name = _lib.wisplab_scene(handle).decode()
        self.treatment = _lib.wisplab_treatment(handle).decode()
        self.columns = [_lib.wisplab_column(handle, i).decode()
                        for i in range(_lib.wisplab_columns(handle))]
        self._make_room()

    def __del__(self):
        if self._handle:
            _lib.wisplab_close(self._handle)

    def _make_room(self):
        """Places for q, v and a result, whose addresses are asked for once: that would take as long
        as an evaluation."""
        self.n = _lib.wisplab_unknowns(self._handle)
        self._q, self._v, self._a = (np.zeros(self.n) for _ in range(3))
        self._at = tuple(x.ctypes.data for x in (self._q, self._v, self._a))

    def _check(self, code):
        if code:
            raise Error(code, _lib.wisplab_error(self._handle).decode())

    def _take(self, q, v):
        if len(q) != self.n or len(v) != self.n:
            raise ValueError(f"q and v have {self.n} numbers each, not {len(q)} and {len(v)}")
        self._q[:] = q
        self._v[:] = v

    def _take_or_own(self, t, q, v):
        """The state that is given, or the scene's own; returns its time."""
        if t is None:
            t, q, v = self.t, self.q, self.v
        self._take(q, v)
        return t

    # ---- what there is

    @property
    def wisps(self):
        return _lib.wisplab_wisps(self._handle)

    @property
    def nodes(self):
        return _lib.wisplab_nodes(self._handle)

    @property
    def unknowns(self):
        """A list of (wisp, node, name, unit): what q[i], v[i] and a[i] belong to."""
        one = _Unknown()
        result = []
        for i in range(self.n):
            _lib.wisplab_unknown(self._handle, i, byref(one))
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
        _lib.wisplab_counts(self._handle, counts)
        return dict(zip(_COUNTERS, counts))

    # ---- the state

    @property
    def t(self):
        t = c_double()
        _lib.wisplab_state(self._handle, byref(t), None, None)
        return t.value

    @property
    def y(self):
        """q and v in one array of 2 n numbers."""
        y = np.empty(2 * self.n)
        at = y.ctypes.data
        _lib.wisplab_state(self._handle, None, at, at + self.n * y.itemsize)
        return y

    @property
    def q(self):
        return self.y[:self.n]

    @property
    def v(self):
        return self.y[self.n:]

    def set_state(self, t, y):
        self._take(y[:self.n], y[self.n:])
        self._check(_lib.wisplab_set_state(self._handle, t, *self._at[:2]))

    # ---- forces and energy

    def acceleration(self, t, q, v):
        self._take(q, v)
        self._check(_lib.wisplab_acceleration(self._handle, t, *self._at))
        return self._a.copy()

    def time_rate(self, t, q, v):
        self._take(q, v)
        self._check(_lib.wisplab_time_rate(self._handle, t, *self._at))
        return self._a.copy()

    def project(self, t, q, v):
        self._take(q, v)
        self._check(_lib.wisplab_project(self._handle, t, *self._at[:2]))
        return self._q.copy(), self._v.copy()

    def energy(self, t=None, q=None, v=None):
        """A dictionary, J; its values add up to all of it."""
        t = self._take_or_own(t, q, v)
        energies = (c_double * len(_ENERGIES))()
        self._check(_lib.wisplab_energy(self._handle, t, *self._at[:2], energies))
        return dict(zip(_ENERGIES, energies))

    def rhs(self, t, y):
        """dy/dt: (v, a), for methods of first order."""
        return np.concatenate((y[self.n:], self.acceleration(t, y[:self.n], y[self.n:])))

    # ---- matrices

    def linearise(self, t, q, v, kind=EXACT):
        self._take(q, v)
        self._check(_lib.wisplab_linearise(self._handle, kind, t, *self._at[:2]))

    def product(self, m, d, k, x):
        x, y = _numbers(x, (self.n,)), np.empty(self.n)
        self._check(_lib.wisplab_product(self._handle, m, d, k, x.ctypes.data, y.ctypes.data))
        return y

    def dense(self, m=0.0, d=0.0, k=0.0):
        """m M + d D + k K of the last linearisation."""
        matrix = np.empty((self.n, self.n), order="F")
        self._check(_lib.wisplab_dense(self._handle, m, d, k, matrix.ctypes.data))
        return matrix

    def sparse(self, m=0.0, d=0.0, k=0.0):
        """The same as a scipy.sparse.csc_matrix."""
        from scipy.sparse import csc_matrix
        entries = _lib.wisplab_entries(self._handle)
        start, row = np.empty(self.n + 1, dtype=np.intc), np.empty(entries, dtype=np.intc)
        values = np.empty(entries)
        self._check(_lib.wisplab_pattern(self._handle, start.ctypes.data, row.ctypes.data))
        self._check(_lib.wisplab_sparse(self._handle, m, d, k, values.ctypes.data))
        return csc_matrix((values, row, start), shape=(self.n, self.n))

    def factor(self, alpha, beta):
        self._check(_lib.wisplab_factor(self._handle, alpha, beta))

    def solve(self, b):
        b, x = _numbers(b, (self.n,)), np.empty(self.n)
        self._check(_lib.wisplab_solve(self._handle, b.ctypes.data, x.ctypes.data))
        return x

    def mass_solve(self, t, q, v, b):
        self._take(q, v)
        b, x = _numbers(b, (self.n,)), np.empty(self.n)
        self._check(_lib.wisplab_mass_solve(self._handle, t, *self._at[:2], b.ctypes.data,
                                            x.ctypes.data))
        return x

    def jacobian(self, t, y):
        """The derivative of rhs by y, with the frames of samples held: 2 n by 2 n."""
        n = self.n
        self.linearise(t, y[:n], y[n:])
        matrix = np.zeros((2 * n, 2 * n))
        matrix[:n, n:] = np.eye(n)
        matrix[n:] = np.linalg.solve(self.dense(m=1), np.hstack((self.dense(k=1), self.dense(d=1))))
        return matrix

    # ---- frames

    def frame(self, t=None, q=None, v=None):
        """The rows of states.tsv without time: nodes by columns."""
        t = self._take_or_own(t, q, v)
        rows = np.empty((self.nodes, len(self.columns)))
        self._check(_lib.wisplab_frame(self._handle, t, *self._at[:2], rows.ctypes.data))
        return rows

    def positions(self, t=None, q=None, v=None):
        """Of all nodes in space, m: nodes by 3."""
        t = self._take_or_own(t, q, v)
        xyz = np.empty((self.nodes, 3))
        self._check(_lib.wisplab_positions(self._handle, t, *self._at[:2], xyz.ctypes.data))
        return xyz

    def tips(self, t=None, q=None, v=None):
        """Of the last node of each wisp, m: wisps by 3."""
        t = self._take_or_own(t, q, v)
        xyz = np.empty((self.wisps, 3))
        self._check(_lib.wisplab_tips(self._handle, t, *self._at[:2], xyz.ctypes.data))
        return xyz

    def write_states(self, path, times, states, **said):
        """A states.tsv of these times and states y, for `wisplab experiment work-precision
        --states NAME=FILE`. said: what its head says of how it came about, as evaluations=5210,
        cpu_seconds=1.3, setting=1e-6."""
        head = {"treatment": self.treatment, **said}
        with open(path, "w", encoding="utf-8") as file:
            file.write("# states at the frames: s, m, m/s\n")
            file.writelines(f"# {key}: {value}\n" for key, value in head.items())
            file.write("\t".join(["t"] + self.columns + ["parent"]) + "\n")
            for t, y in zip(times, states):
                for row in self.frame(t, y[:self.n], y[self.n:]):
                    wisp, node = int(row[0]), int(row[1])
                    parent = _lib.wisplab_parent(self._handle, wisp)
                    numbers = "\t".join(repr(float(x)) for x in row[2:])
                    file.write(f"{float(t)!r}\t{wisp}\t{node}\t{numbers}\t{parent}\n")

    # ---- the clock, and the program's own methods

    def next_stop(self):
        """(time, events): beyond it nothing is smooth; (inf, 0) where there is none."""
        t, events = c_double(), c_uint()
        _lib.wisplab_next_stop(self._handle, byref(t), byref(events))
        return t.value, events.value

    def tick(self):
        """What is due at the next stop, where the state must be; whether that changed it."""
        changed = c_int()
        code = _lib.wisplab_tick(self._handle, byref(changed))
        self._make_room()
        self._check(code)
        return bool(changed.value)

    def advance(self, to, smooth):
        """Takes the state to time `to`, ticks included. smooth(t, stop, y) is your method: the
        state at `stop` of the smooth motion from (t, y)."""
        while self.t < to:
            stop, _ = self.next_stop()
            last = stop > to + 1e-12 * max(1, abs(to))
            at = to if last else stop
            self.set_state(at, smooth(self.t, at, self.y))
            if not last:
                self.tick()

    def run(self, to, stepper=None, frame=None, options=None, **method):
        """Takes the state to time `to` by a stepper of the program. method: linear, step, rtol,
        atol, strain_limit, threads. frame(t, rows) is called with each frame; True ends the run."""
        raised = []

        def show(_, t, rows, nodes):
            try:
                shape = (nodes, len(self.columns))
                return bool(frame(t, np.ctypeslib.as_array(rows, shape).copy()))
            except BaseException as error:  # nothing may pass through C
                raised.append(error)
                return True

        request = _Method(stepper=_encoded(stepper), options=_texts(options),
                          frame=_FRAME(show) if frame else _FRAME())
        for name, value in method.items():
            if name not in ("linear", "step", "rtol", "atol", "strain_limit", "threads"):
                raise TypeError(f"run has no argument {name}")
            setattr(request, name, _encoded(value) if name == "linear" else value)
        code = _lib.wisplab_run(self._handle, byref(request), to)
        self._make_room()
        if raised:
            raise raised[0]
        self._check(code)
