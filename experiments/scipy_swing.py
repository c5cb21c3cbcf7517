"""SciPy's BDF on the scene `swing`: a trajectory for each tolerance, in swing-RTOL.tsv, for

    wisplab experiment work-precision --scene swing --states scipy-bdf=swing-1e-06.tsv ...
"""

import time

from scipy.integrate import solve_ivp

import wisplab

for rtol in [10.0**-digits for digits in range(2, 11)]:
    swing = wisplab.Scene("swing")
    begin = time.process_time()
    found = solve_ivp(swing.rhs, (swing.begin, swing.end), swing.y, method="BDF", rtol=rtol,
                      atol=1e-3 * rtol, jac=swing.jacobian, t_eval=swing.frame_times)
    swing.write_states(f"swing-{rtol:g}.tsv", found.t, found.y.T, setting=rtol,
                       evaluations=swing.counters["force_evaluations"],
                       cpu_seconds=time.process_time() - begin)
