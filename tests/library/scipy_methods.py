"""What the library's Python does, by SciPy's methods: scipy_methods.py NAME. Exit code 77 without SciPy.

The scenes are wisplab's own, and so are the reference solutions: by its stepper `reference`, with
another method and another implementation of everything but the forces."""

import copy
import os
import pathlib
import pickle
import re
import sys
import threading

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../../src/library"))
try:
    import numpy as np
    from scipy.integrate import solve_ivp
    import scipy.sparse.linalg
except ImportError as missing:
    print(missing)
    sys.exit(77)
import wisplab


def reference(scene, to):
    """Positions of all nodes at the scene's frames up to `to`."""
    frames = []
    scene.run(to, "reference", frame=lambda t, rows: frames.append(rows[:, 2:5]))
    return np.array(frames)


def largest_error(scene, times, states, right):
    n = scene.n
    return max(np.abs(scene.positions(t, y[:n], y[n:]) - frame).max()
               for t, y, frame in zip(times, states, right))


def smooth():
    """DOP853, Radau and LSODA at relative tolerances of 1e-13 agree with `reference` far within
    1e-7 m; Radau and LSODA are given the exact Jacobian, and use it."""
    times = wisplab.Scene("swing").frame_times[:6]
    right = reference(wisplab.Scene("swing"), times[-1])
    for method in "DOP853", "Radau", "LSODA":
        scene = wisplab.Scene("swing")
        jacobian = {} if method == "DOP853" else {"jac": scene.jacobian}
        found = solve_ivp(scene.rhs, (0, times[-1]), scene.y, method=method, rtol=1e-13,
                          atol=1e-13, t_eval=times, **jacobian)
        assert found.success and len(found.t) == len(right) == 6, found
        error = largest_error(scene, found.t, found.y.T, right)
        assert error < 1e-9, f"{method} is {error} m off"
        assert scene.counters["force_evaluations"] == found.nfev, scene.counters
        assert (scene.counters["linearisations"] > 0) == (method != "DOP853"), scene.counters
    assert np.abs(right[-1] - right[0]).max() > 0.1, "it hardly moved"


CONTACTS = """
duration = 0.2; frame_rate = 30.0; gravity = [0.0, -9.81, 0.0]; material = { };
wisps = ( { root = [0.0, 0.0, 0.0]; direction = [0.0, -1.0, 0.0]; length = 0.30; nodes = 6; } );
body = ( { name = "ball"; center = [-0.11, -0.2, 0.0]; radii = [0.08, 0.08, 0.08];
           velocity = [0.5, 0.0, 0.0]; friction = 50.0; elasticity = 0.1; offset = 1.0e-4; } );
contacts = { interpenetration = false; collision = false; };
"""


def contacts():
    """A ball pushes a wisp: from stop to stop by DOP853, with the model's ticks there."""
    to = 0.2
    other = wisplab.Scene(text=CONTACTS)
    right = reference(other, to)[-1]

    def method(t, stop, y):
        found = solve_ivp(scene.rhs, (t, stop), y, method="DOP853", rtol=1e-12, atol=1e-12)
        assert found.success and found.t[-1] == stop, found
        return found.y[:, -1]

    scene = wisplab.Scene(text=CONTACTS)
    scene.advance(to, method)
    assert scene.t == other.t == to
    touched = scene.counters["body_contacts"]
    assert touched == other.counters["body_contacts"] > 10, scene.counters
    found = scene.positions(scene.t, scene.q, scene.v)
    assert np.abs(found - right).max() < 1e-9, np.abs(found - right).max()

    # without the ticks it is another motion
    scene = wisplab.Scene(text=CONTACTS)
    assert scene.next_stop() == (1 / 300, wisplab.COLLISION)
    y = method(0, to, scene.y)
    assert np.abs(scene.positions(to, y[:scene.n], y[scene.n:]) - right).max() > 1e-2


def matrices():
    """Dense, sparse, products and solves are of the same M, D and K; Jacobians are derivatives."""
    scene = wisplab.Scene("swing-envelope", treatment="penalty")
    random = np.random.default_rng(1)
    n, t = scene.n, 0.3
    q, v = scene.q + 1e-4 * random.standard_normal(n), random.standard_normal(n)
    b = random.standard_normal(n)
    for kind in wisplab.EXACT, wisplab.SPD:
        scene.linearise(t, q, v, kind)
        matrix = scene.dense(1, -1e-3, -1e-6)
        assert np.array_equal(matrix, scene.sparse(1, -1e-3, -1e-6).toarray())
        assert np.allclose(matrix @ b, scene.product(1, -1e-3, -1e-6, b), rtol=1e-12, atol=1e-12)
    scene.factor(1e-3, 1e-6)
    assert np.allclose(matrix @ scene.solve(b), b, rtol=1e-9, atol=1e-12)
    assert np.linalg.eigvalsh(matrix).min() > 0
    assert np.allclose(scene.dense(m=1) @ scene.mass_solve(t, q, v, b), b, rtol=1e-12)

    swing = wisplab.Scene("swing")
    y = swing.y + 1e-4 * random.standard_normal(2 * swing.n)
    exact, h = swing.jacobian(t, y), 1e-7
    for j in range(2 * swing.n):
        step = h * (np.arange(2 * swing.n) == j)
        column = (swing.rhs(t, y + step) - swing.rhs(t, y - step)) / (2 * h)
        assert np.abs(column - exact[:, j]).max() <= 1e-6 * np.abs(exact[:, j]).max(), j


def trajectories():
    """A states file of SciPy's is one to wisplab; errors are raised, with the library's text."""
    scene = wisplab.Scene("swing-envelope", sets={"duration": 0.1})
    found = solve_ivp(scene.rhs, (0, 0.1), scene.y, method="LSODA", t_eval=scene.frame_times)
    scene.write_states("states.tsv", found.t, found.y.T)
    for wrong in ({"scene": "nowhere"}, {"scene": "swing", "sets": {"material.hair": 1}}):
        try:
            wisplab.Scene(**wrong)
        except wisplab.Error as error:
            assert error.code == wisplab.REFUSED and len(str(error)) > 20, error
        else:
            raise AssertionError(f"{wrong} is taken")
    seen = []

    def frame(t, rows):
        seen.append(t)
        if len(seen) == 2:
            raise KeyError("of the caller")

    try:
        scene.run(0.1, "rk4", frame=frame)
    except KeyError:
        assert len(seen) == 2
    else:
        raise AssertionError("an exception of the caller's is lost")


# ---- what cannot be


def refused(error, function, *words, **named):
    try:
        function(*words, **named)
    except error as raised:
        assert len(str(raised)) > 10, raised
        return
    raise AssertionError(f"{words} {named} is taken")


def wrong_texts():
    """Scenes, sets, treatments and texts that C would stumble over, or cut at a zero."""
    open_scene = wisplab.Scene
    for scene in None, 3, [], object():
        refused(TypeError, open_scene, scene)
    for scene in "sw\0ing", b"sw\0ing":
        refused(ValueError, open_scene, scene)
    for sets in "a=1", b"a=1", 3, [3], [None], [b"a=1"], {3: 1}:
        refused(TypeError, open_scene, "swing", sets)
    for sets in ["duration=1\0"], {"duration": "1\0"}, {"duration\0": 1}:
        refused(ValueError, open_scene, "swing", sets)
    for named in ({"treatment": 3}, {"treatment": b"penalty"}, {"text": 3}, {"text": b""},
                  {"scene": None, "text": CONTACTS}):
        refused(TypeError, open_scene, **named)
    refused(ValueError, open_scene, treatment="pen\0alty")
    refused(ValueError, open_scene, text=CONTACTS + "\0")
    assert open_scene(b"swing").name == open_scene(pathlib.Path("swing")).name == "swing"
    assert open_scene("swing", {"run.project": True, "material.stretch": "rigid"}).n > 0


def wrong_vectors(n):
    """What is no vector of n numbers."""
    x = np.linspace(0, 1, n)
    nan, inf = x.copy(), x.copy()
    nan[-1], inf[0] = np.nan, -np.inf
    return [(TypeError, x) for x in (None, "q", [None] * n, x.astype(complex), x.astype(str), {},
                                     x.astype(object), [10**400] * n, [np.datetime64("2020")] * n)
            ] + [(ValueError, x) for x in (x[1:], [*x, 0.0], x.reshape(1, n), x.reshape(n, 1), 0.0,
                                           [], nan, inf, [[1.0], [1.0, 2.0]])]


WRONG_NUMBERS = [(TypeError, x) for x in (None, "1", b"1", [1.0], np.ones(1), 1j, {}, 10**400)
                 ] + [(ValueError, x) for x in (np.nan, -np.inf, np.float32("nan"))]


def wrong_numbers():
    """Every number and every array of every function is another one than it wants, in turn; after
    all that the scene is as it was."""
    scene = wisplab.Scene("swing-envelope", treatment="penalty")
    n, t, q, v, y = scene.n, scene.t, scene.q, scene.v, scene.y
    a = scene.acceleration(t, q, v)
    twice = np.repeat(q, 2)
    for same in list(q), twice[::2], q[::-1].copy()[::-1], q.astype(np.longdouble), q.astype(">f8"):
        assert np.array_equal(scene.acceleration(np.float32(t), same, v.astype(int)), a)
    scene.linearise(t, q, v, wisplab.SPD)
    scene.factor(1e-3, 1e-6)
    right = {"t": t, "q": q, "v": v, "y": y, "b": q, "x": q, "alpha": 1e-3, "beta": 1e-6, "m": 1.0,
             "d": 0.0, "k": 0.0, "to": 1.0}
    asked = [(scene.acceleration, "tqv"), (scene.time_rate, "tqv"), (scene.project, "tqv"),
             (scene.energy, "tqv"), (scene.linearise, "tqv"), (scene.frame, "tqv"),
             (scene.positions, "tqv"), (scene.tips, "tqv"), (scene.mass_solve, "tqvb"),
             (scene.set_state, "ty"), (scene.rhs, "ty"), (scene.jacobian, "ty"),
             (scene.product, "mdkx"), (scene.dense, "mdk"), (scene.sparse, "mdk"),
             (scene.factor, ["alpha", "beta"]), (scene.solve, "b")]
    for function, names in asked:
        for name in names:
            wrong = (WRONG_NUMBERS if np.ndim(right[name]) == 0 else wrong_vectors(len(right[name])))
            for error, x in wrong:
                refused(error, function, **{**{other: right[other] for other in names}, name: x})
    for kind in 2, -1:
        refused(ValueError, scene.linearise, t, q, v, kind)
    for kind in "spd", None, 1.0:
        refused(TypeError, scene.linearise, t, q, v, kind)
    for some in {"t": t}, {"q": q, "v": v}, {"t": t, "q": q}:
        refused(TypeError, scene.energy, **some)
    for error, to in WRONG_NUMBERS:
        refused(error, scene.advance, to, lambda *_: y)
        refused(error, scene.run, to)
    for error, smooth in ((TypeError, None), (TypeError, lambda *_: None), (ValueError, lambda *_: y[1:]),
                          (ValueError, lambda *_: y * np.nan)):
        refused(error, scene.advance, 1.0, smooth)
    refused(ValueError, scene.advance, -1.0, lambda *_: y)
    for name in "step", "rtol", "atol", "strain_limit":
        for error, x in WRONG_NUMBERS + [(ValueError, 0), (ValueError, -1e-4)]:
            refused(error, scene.run, 1.0, **{name: x})
    for error, named in ((TypeError, {"threads": 1.5}), (TypeError, {"threads": "2"}),
                         (ValueError, {"threads": 0}), (ValueError, {"threads": 2**32 + 1}),
                         (TypeError, {"stepper": 3}), (TypeError, {"stepper": b"rk4"}),
                         (ValueError, {"stepper": "rk4\0"}), (TypeError, {"linear": 3}),
                         (TypeError, {"options": "a=1"}), (ValueError, {"options": ["a=\0"]}),
                         (TypeError, {"frame": 3}), (TypeError, {"steps": 3})):
        refused(error, scene.run, 1.0, **named)
    assert scene.t == t and np.array_equal(scene.y, y) and n == scene.n
    assert np.array_equal(scene.acceleration(t, q, v), a)


def closed():
    """A scene that is closed, was never opened, is copied, or is at work in another thread or below
    its own run."""
    scene = wisplab.Scene("subdivision")
    y = scene.y
    for copied in copy.copy, copy.deepcopy, pickle.dumps:
        refused(TypeError, copied, scene)
    refused(ValueError, lambda: wisplab.Scene.__new__(wisplab.Scene).t)
    entered, left, raised = threading.Event(), threading.Event(), []

    def frame(t, rows):
        entered.set()
        left.wait()
        for inside in scene.close, scene.tick, lambda: scene.y, lambda: scene.run(1.0):
            refused(wisplab.Error, inside)
        return True

    def work():
        try:
            scene.run(1.0, "rk4", frame=frame)
        except wisplab.Error as error:
            raised.append(error.code)

    thread = threading.Thread(target=work)
    thread.start()
    entered.wait()
    for function in (lambda: scene.t, lambda: scene.rhs(0, y), lambda: scene.n, scene.next_stop,
                     scene.tips, lambda: scene.run(2.0), scene.close):
        refused(wisplab.Error, function)
    left.set()
    thread.join()
    assert raised == [wisplab.STOPPED], raised
    with scene:
        assert np.array_equal(scene.y, y)
    scene.close()
    for function in (lambda: scene.t, lambda: scene.y, lambda: scene.wisps, lambda: scene.unknowns,
                     lambda: scene.counters, scene.next_stop, scene.tick, scene.frame, scene.energy,
                     lambda: scene.set_state(0, y), lambda: scene.rhs(0, y),
                     lambda: scene.dense(1), lambda: scene.run(1.0)):
        refused(ValueError, function)


def written():
    """What is no trajectory is not written, and what was there stays."""
    scene = wisplab.Scene("swing", sets={"duration": 0.1})
    times, states = scene.frame_times, np.array([scene.y] * 4)
    nan = states.copy()
    nan[2, 1] = np.nan
    with open("states.tsv", "w", encoding="utf-8") as file:
        file.write("old")
    for error, t, y, said in (
            (ValueError, times, states[1:], {}), (ValueError, times[1:], states, {}),
            (ValueError, [], [], {}), (ValueError, times, nan, {}), (ValueError, times, states.T, {}),
            (ValueError, times[::-1], states, {}), (ValueError, [0, 0, 1, 2], states, {}),
            (ValueError, [0, 1, 2, np.nan], states, {}), (TypeError, None, states, {}),
            (TypeError, times, None, {}), (TypeError, times, [None, "y", 3, 4], {}),
            (TypeError, times, states.astype(str), {}), (ValueError, times, states, {"evaluations": -1}),
            (ValueError, times, states, {"cpu_seconds": np.nan}), (ValueError, times, states, {"setting": 0}),
            (TypeError, times, states, {"evaluations": "many"}), (TypeError, times, states, {"treatment": "magic"}),
            (ValueError, times, states, {"by": "me\n# evaluations: 1"}), (ValueError, times, states, {"a\nb": 1}),
            (ValueError, times, states, {"scene swing, hash 0": 1})):
        refused(error, scene.write_states, "states.tsv", t, y, **said)
        assert os.listdir() == ["states.tsv"], os.listdir()
        with open("states.tsv", encoding="utf-8") as file:
            assert file.read() == "old", said
    for error, path in (TypeError, None), (TypeError, 3), (ValueError, "."), (ValueError, "/dev/null"):
        refused(error, scene.write_states, path, times, states)
    scene.write_states("states.tsv", times, iter(states), evaluations=5210, setting=1e-6, by="me")
    with open(b"states.tsv", encoding="utf-8") as file:
        head = file.read().split("t\twisp")[0]
    assert head == ("# states at the frames: s, m, m/s\n# treatment: generalised\n"
                    "# evaluations: 5210\n# setting: 1e-06\n# by: me\n"), head
    assert os.listdir() == ["states.tsv"], os.listdir()


def readme():
    """What README shows, as it stands: the first is exact enough, the second sees contacts."""
    said = []
    with open(os.path.join(HERE, "../../README.md"), encoding="utf-8") as file:
        pieces = re.findall(r"^```python\n(.*?)^```", file.read(), re.DOTALL | re.MULTILINE)
    for piece in pieces:
        if "import wisplab" not in piece:
            continue
        exec(compile(piece, "README.md", "exec"), {"print": lambda *words: said.append(words)})
    assert len(said) == 2, said
    assert said[0][1] < 2e-5 and 1000 < said[0][3] < 10000, said
    assert said[1][0] > 10 and np.isfinite(said[1][2]), said


if __name__ == "__main__":
    {test.__name__: test for test in (smooth, contacts, matrices, trajectories, wrong_texts,
                                       wrong_numbers, closed, written, readme)}[sys.argv[1]]()
