"""The optimizers, each as search(f, box, seed): minimizes f within +-box, without an initial point.

f is a Counted, which ends the search. An optimizer that needs an initial point gets a random one in
the box. Initial steps are 0.31 units. All other settings are the defaults of the libraries.
"""
import itertools

import cma
import nlopt
import numpy as np
import pybobyqa
from scipy import optimize

from auvid_validation.library import load

#: Incommensurable with the test functions: steps of 0.3, nine of their periods, see no sines.
FIRST_STEP = 0.1 * np.pi
FOREVER = 10**9  # the count ends the search


def start(box, seed):
    return np.random.default_rng(seed).uniform(-box, box)


def auvid(lib, literal=False, per_parameter=0, omega=0.0):
    """auvid with its defaults. literal: Algorithm 2 to the letter; points per parameter and omega
    of the global search."""
    def search(f, box, seed):
        n, config = len(box), lib.auvid_search_config_t()
        optimizer, theta, scale = lib.auvid_optimizer_t(), lib.zeros(17), lib.zeros(17)
        lib.auvid_search_defaults(config, n)
        # The box is already in units of x: steps of one unit.
        config.lower[:n], config.upper[:n] = (-box).tolist(), box.tolist()
        scale[:n] = 1.0
        config.seed, config.omega = seed, omega
        config.population = per_parameter * n
        config.paper = literal
        if literal:
            config.epsilon_line = 1e-5
        assert lib.auvid_optimizer_init(optimizer, config, scale) == 0
        while True:
            status = lib.auvid_optimizer_ask(optimizer, theta)
            if status == lib.AUVID_OK:
                lib.auvid_optimizer_tell(optimizer, f(theta[:n].astype(float)))
            elif status != lib.AUVID_PENDING:
                return
    return search


def by_nlopt(algorithm, box, f, x, evaluations=FOREVER, step=None):
    """The best point after that many evaluations, or at its end."""
    o = nlopt.opt(algorithm, len(box))
    o.set_min_objective(f)
    o.set_lower_bounds(-box)
    o.set_upper_bounds(box)
    o.set_maxeval(evaluations)
    if step:
        o.set_initial_step(step)
    if algorithm != nlopt.GN_CRS2_LM:
        o.set_xtol_rel(1e-9)
    return o.optimize(x)


def crs2(f, box, seed):
    nlopt.srand(seed + 1)
    by_nlopt(nlopt.GN_CRS2_LM, box, f, start(box, seed))


def crs2_bobyqa(evaluations):
    """BOBYQA from the best point of CRS2 after so many evaluations, repeated from its result."""
    def search(f, box, seed):
        nlopt.srand(seed + 1)
        x = by_nlopt(nlopt.GN_CRS2_LM, box, f, start(box, seed), evaluations)
        for step in (FIRST_STEP, FIRST_STEP / 10):
            x = by_nlopt(nlopt.LN_BOBYQA, box, f, np.clip(x, -box, box), step=step)
    return search


def bobyqa(f, box, seed):
    by_nlopt(nlopt.LN_BOBYQA, box, f, start(box, seed), step=FIRST_STEP)


def differential_evolution(f, box, seed):
    optimize.differential_evolution(f, np.column_stack([-box, box]), rng=seed, maxiter=FOREVER,
                                    tol=0, polish=False)


def cma_es(f, box, seed):
    options = {"bounds": [(-box).tolist(), box.tolist()], "seed": seed + 1, "verbose": -9,
               "tolfun": 0, "tolfunhist": 0}
    es = cma.CMAEvolutionStrategy(start(box, seed), FIRST_STEP, options)
    while not es.stop():
        points = es.ask()
        es.tell(points, [f(p) for p in points])


def nelder_mead(f, box, seed):
    x = start(box, seed)
    simplex = np.vstack([x, x + FIRST_STEP * np.eye(len(box)) * np.where(x > 0, -1, 1)])
    optimize.minimize(f, x, method="Nelder-Mead", bounds=np.column_stack([-box, box]),
                      options={"adaptive": True, "initial_simplex": simplex, "maxfev": FOREVER,
                               "maxiter": FOREVER, "xatol": 0, "fatol": 0})


def py_bobyqa(f, box, seed):
    """It allocates memory for all evaluations. Its final steps are not shorter than 1e-4: else
    most evaluations would be those of one minimum."""
    np.random.seed(seed)
    pybobyqa.solve(f, start(box, seed), bounds=(-box, box), rhobeg=FIRST_STEP, rhoend=1e-4,
                   maxfun=f.cap + 1, do_logging=False)


def least_squares(f, box, seed, x=None):
    """From x, or a random point. f returns residuals. Their derivatives are differences, long
    enough for residuals in single precision, from the point that was evaluated last."""
    last = []

    def residuals(x):
        last[:] = x.copy(), f(x)
        return last[1]

    def jacobian(x):
        here = last[1] if np.array_equal(x, last[0]) else f(x)
        steps = np.where(x > 0, -1e-3, 1e-3) * box
        return np.column_stack([(f(x + step) - here) / step.sum() for step in np.diag(steps)])
    x = start(box, seed) if x is None else x
    optimize.least_squares(residuals, x, jacobian, bounds=(-box, box), x_scale="jac")


def restarted(search):
    """From other initial points, until the count ends it."""
    def again(f, box, seed):
        for k in itertools.count():
            search(f, box, seed + 100_000 * k)
    return again


OURS = "auvid: CRS, line search"


#: Their runs are identical for any scale.
INVARIANT = ("NLopt GN_CRS2_LM", "scipy differential_evolution")


def peers():
    """Name: search."""
    lib = load("float")
    return {
        OURS: auvid(lib),
        "auvid, the paper's to the letter": auvid(lib, literal=True),
        "auvid, m = 25 n, omega = 1e3": auvid(load("large"), per_parameter=25, omega=1e3),
        "NLopt GN_CRS2_LM": crs2,
        **{f"NLopt CRS2_LM ({m}), BOBYQA": crs2_bobyqa(m) for m in (140, 500)},
        "NLopt LN_BOBYQA": bobyqa,
        "scipy differential_evolution": differential_evolution,
        "CMA-ES (cma)": cma_es,
        "scipy Nelder-Mead, adaptive": nelder_mead,
    }
