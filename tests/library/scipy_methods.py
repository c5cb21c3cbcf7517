"""What the library's Python does, by SciPy's methods: scipy_methods.py NAME. Exit code 77 without SciPy.

The scenes are wisplab's own, and so are the reference solutions: by its stepper `reference`, with
another method and another implementation of everything but the forces."""

import os
import re
import sys

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
    {test.__name__: test for test in (smooth, contacts, matrices, trajectories, readme)}[sys.argv[1]]()
