"""Elementary functions, kinematics, the Girona500 model, the simulation of held-out motion and the
simulator: against numpy, scipy's Rotation and solve_ivp, and Fossen's matrices."""
import numpy as np
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from auvid_validation import girona500
from auvid_validation.compare import Row, close
from auvid_validation.library import values


def elementary(lib):
    rng = np.random.default_rng(1)
    x = lib.array(np.r_[rng.uniform(-10, 10, 5000), rng.uniform(-1e4, 1e4, 5000),
                        np.arange(-20, 21) * np.pi / 4])
    out = lib.zeros(2, len(x))
    for i, value in enumerate(x):
        lib.auvid_sincos(value, out[0, i:], out[1, i:])
    reference = np.array([np.sin(x.astype(np.longdouble)), np.cos(x.astype(np.longdouble))])
    yield close(lib, "sin and cos, |x| <= 1e4", "numpy, long double", [(out, reference, 1.0)],
                "relative to 1", 0.75, "the bound of auvid_math_internal.h")
    a, b = lib.array(rng.normal(size=(2, 5000)) * 10.0 ** rng.integers(-6, 6, (2, 5000)))
    ours = [lib.auvid_atan2(y, z) for y, z in zip(a, b)]
    reference = np.arctan2(a.astype(float), b.astype(float))
    yield close(lib, "atan2", "numpy", [(ours, reference, np.abs(reference))],
                "relative to itself", 2, "the bound of auvid_math_internal.h")
    c = np.abs(a)
    reference = np.sqrt(c.astype(float))
    yield close(lib, "square root", "numpy", [([lib.auvid_sqrt(y) for y in c], reference,
                                               reference)],
                "relative to itself", 0.5, "correctly rounded")


def kinematics(lib):
    rng = np.random.default_rng(2)
    linear, angular = [], []
    for _ in range(500):
        euler = lib.array(rng.uniform([-np.pi, -1.4, -np.pi], [np.pi, 1.4, np.pi]))
        nu, eta_dot = lib.array(rng.normal(size=6)), lib.zeros(6)
        assert lib.auvid_kinematics(*euler, nu, eta_dot) == 0
        phi, theta, psi = euler.astype(float)
        turn = Rotation.from_euler("ZYX", [psi, theta, phi])
        linear.append((eta_dot[:3], turn.apply(nu[:3])))
        # Body rates of unit rates of phi, theta, psi: the axes that each turns about.
        about_pitch = Rotation.from_euler("X", phi).inv().apply([0, 1, 0])
        about_yaw = turn.inv().apply([0, 0, 1])
        rates = np.linalg.solve(np.array([[1, 0, 0], about_pitch, about_yaw]).T,
                                nu[3:].astype(float))
        angular.append((eta_dot[3:], rates, np.linalg.norm(nu[3:]) / np.cos(theta)))
    yield close(lib, "kinematics, velocity in the world (Eq. 1)", "scipy Rotation", linear,
                "relative to the largest", 8, "an entry of R: 3 roundings, a sum of three")
    yield close(lib, "kinematics, Euler rates", "scipy Rotation, numpy solve", angular,
                "relative to |omega| / cos", 6, "sin, cos, quotient, a sum of three")


def random_sample(lib, rng):
    s = lib.auvid_sample_t()
    s.phi, s.theta = rng.uniform(-0.5, 0.5, 2)
    s.nu[:] = rng.uniform(-1, 1, 6)
    s.nu_dot[:] = rng.uniform(-0.3, 0.3, 6)
    s.tau[:] = rng.uniform(-100, 100, 6)
    return s, values(s.nu).astype(float), values(s.nu_dot).astype(float), \
        values(s.tau).astype(float)


def model(lib):
    rng = np.random.default_rng(3)
    vehicle = lib.auvid_girona500
    n = vehicle.parameters
    residuals, accelerations, rows = [], [], []
    for _ in range(500):
        s, nu, nu_dot, tau = random_sample(lib, rng)
        pi = lib.zeros(n)
        pi[:13] = girona500.TRUTH * rng.uniform(0.5, 2, 13)
        p = pi[:13].astype(float)
        out = lib.zeros(6)
        lib.auvid_vehicle_residual(vehicle, s, pi, out)
        theirs = girona500.wrench(p, s.phi, s.theta, nu, nu_dot)
        y = girona500.regressor(s.phi, s.theta, nu, nu_dot)
        size = np.abs(y) @ np.abs(p) + np.abs(tau[girona500.DRIVEN])
        residuals.append((out[girona500.DRIVEN], theirs - tau[girona500.DRIVEN], size))
        regressor = lib.auvid_regressor_t()
        vehicle.regressor(vehicle.context, s, lib.pointer(pi), regressor)
        rows.append((values(regressor.row)[girona500.DRIVEN, :13], y, 1.0))
        out = lib.zeros(6)
        vehicle.acceleration(vehicle.context, s, lib.pointer(pi), lib.pointer(out))
        theirs = girona500.acceleration(p, s.phi, s.theta, nu, tau)
        accelerations.append((out[girona500.DRIVEN], theirs, size / p[:4]))
    yield close(lib, "Girona500, wrench (Eq. 12-15)", "Fossen's matrices in numpy", residuals,
                "relative to sum|Y||pi|", 6, "at most 9 terms of 3 factors, at random")
    yield close(lib, "Girona500, regressor", "Fossen's matrices in numpy", rows,
                "m/s2, m2/s2 or 1", 2, "two roundings of values up to 1")
    yield close(lib, "Girona500, acceleration", "Fossen's matrices in numpy", accelerations,
                "relative to sum|Y||pi| / m", 6, "as the wrench, and a quotient")


def sim_derivative(config, x, tau):
    """Derivative of [position, euler, nu]: the model above, with the simulator's roll and pitch
    (simulator.h) and Euler angles."""
    pi, (phi, theta, psi), nu = values(config.parameter), x[3:6], x[6:]
    out = np.empty(12)
    out[:3] = Rotation.from_euler("ZYX", [psi, theta, phi]).apply(nu[:3])
    turn = nu[4] * np.sin(phi) + nu[5] * np.cos(phi)
    out[3:6] = (nu[3] + turn * np.tan(theta), nu[4] * np.cos(phi) - nu[5] * np.sin(phi),
                turn / np.cos(theta))
    out[6 + girona500.DRIVEN] = girona500.acceleration(pi, phi, theta, nu, tau)
    up = np.array([np.cos(theta) * np.sin(phi), np.sin(theta)])
    arm = np.array([config.roll_arm_m * tau[1], config.pitch_arm_m * tau[0]])
    drag = (config.tilt_linear + config.tilt_quadratic * np.abs(nu[3:5])) * nu[3:5]
    out[9:11] = (tau[3:5] + arm - drag - config.tilt_righting * up) / config.tilt_inertia
    return out


HOLD_S, PIECES = 2.0, 15


def simulator(lib):
    """Half a minute of steps, held 2 s."""
    config, sim, out = lib.sim_config_t(), lib.sim_t(), lib.sim_output_t()
    lib.sim_defaults(config)
    config.position[:], config.euler[:] = (1, 2, 50), (0.05, -0.04, 0.3)
    config.nu[:] = (0.2, -0.1, 0.05, 0.01, 0.02, -0.1)
    assert lib.sim_init(sim, config)
    rng = np.random.default_rng(4)
    x = np.r_[values(config.position), values(config.euler), values(config.nu)]
    ours, theirs = [], []
    for _ in range(PIECES):
        tau = rng.choice([-1, -0.3, 0.3, 1], 6) * [100, 100, 100, 0, 0, 40]
        for _ in range(round(HOLD_S / 0.02)):
            lib.sim_step(sim, None, tau, out)
        x = solve_ivp(lambda _, y, w=tau: sim_derivative(config, y, w), (0, HOLD_S), x, "DOP853",
                      rtol=1e-12, atol=1e-14).y[:, -1]
        truth = sim.truth
        ours.append(np.r_[values(truth.position), values(truth.euler), values(truth.nu)])
        theirs.append(x)
    ours, theirs = np.array(ours), np.array(theirs)
    for part, what, unit in ((slice(0, 3), "position", "m"), (slice(3, 6), "attitude", "rad"),
                             (slice(6, 12), "velocity", "m/s, rad/s")):
        yield close(lib, f"simulator, {what}, {HOLD_S * PIECES:.0f} s", "scipy solve_ivp DOP853",
                    [(ours[:, part], theirs[:, part])], unit, 1, "RK4 of 5 ms")


CELLS, START = 208, 7  # auvid begins to simulate in the eighth


def held_out(lib, cell_s):
    """auvid_validation, (ours, theirs) of motion and of R2: u v w r integrated under the record's
    wrench, phi theta p q from it. The wrench steps every 20 cells and keeps its sign, and so do the
    velocities: at the kink of |u| u a Runge-Kutta step is less good."""
    rng, dofs = np.random.default_rng(5), girona500.DRIVEN
    level = np.repeat(rng.choice([0.3, 1], (CELLS // 20 + 1, 4)), 20, axis=0)[:CELLS]
    cells, pi = [lib.auvid_sample_t() for _ in range(CELLS)], lib.zeros(17)
    pi[:13] = girona500.TRUTH
    truth = pi[:13].astype(float)
    tilt, tau = np.zeros((CELLS, 8)), np.zeros((CELLS, 6))  # phi theta and nu, p q in it; tau
    for i, cell in enumerate(cells):
        t = i * cell_s
        cell.phi, cell.theta = 0.02 * np.sin(0.9 * t), 0.02 * np.cos(0.7 * t)
        cell.nu[3], cell.nu[4] = 0.018 * np.cos(0.9 * t), -0.014 * np.sin(0.7 * t)
        for k, (dof, most, hover) in enumerate(zip(dofs, (100, -100, 120, -40), (0, 0, 40, 0))):
            cell.tau[dof] = hover + most * level[i, k]
        tilt[i], tau[i] = np.r_[cell.phi, cell.theta, values(cell.nu)], values(cell.tau)
    nu = lib.array([0.5, -0.3, 0.3, -0.4]).astype(float)
    theirs = [nu]
    for i in range(START + 1, CELLS):
        for half in (0, 1):
            def rates(part, y, i=i, half=half):
                now = tilt[i - 1] + part * (tilt[i] - tilt[i - 1])
                now[2 + dofs] = y
                return cell_s * girona500.acceleration(truth, *now[:2], now[2:],
                                                       tau[i - 1 + half])
            nu = solve_ivp(rates, (half / 2, half / 2 + 0.5), nu, "DOP853", rtol=1e-11,
                           atol=1e-13).y[:, -1]
        theirs.append(nu)
    theirs = np.array(theirs)
    seen = np.vstack([np.tile(theirs[0], (START + 1, 1)), theirs[1:]])
    seen[START + 1:] += 0.02 * rng.normal(size=(CELLS - START - 1, 4))
    check, r2, ours = lib.auvid_validation_t(), lib.zeros(6), []
    assert lib.auvid_validation_init(check, lib.auvid_girona500, pi, 0, None, 0, cell_s) == 0
    for cell, measured in zip(cells, seen):
        for dof, value in zip(dofs, measured):
            cell.nu[dof] = value
        assert lib.auvid_validation_add(check, cell) == 0
        ours.append(values(check.predicted)[dofs].astype(float))
    assert lib.auvid_validation_r2(check, r2) == 0
    seen = seen[START:]
    reference = 1 - ((seen - theirs)**2).sum(0) / ((seen - seen.mean(0))**2).sum(0)
    return (ours[START:], theirs), (r2[dofs], reference)


def validation(lib):
    motion, r2 = held_out(lib, 0.025)
    yield close(lib, "held-out motion, u v w r, cells of 25 ms", "scipy solve_ivp DOP853", [motion],
                "m/s, rad/s", 30, "400 steps of RK4, at random")
    yield close(lib, "held-out motion, R2", "solve_ivp and numpy", [r2], "-", 30,
                "that of the motion, against noise; 200 sums")
    motion, _ = held_out(lib, 0.1)
    off = np.abs(np.array(motion[0]) - motion[1]).max()
    yield Row("held-out motion, u v w r, cells of 0.1 s", "scipy solve_ivp DOP853", off, 7e-6,
              "m/s, rad/s", "RK4's own error; a thousandth of the DVL's noise")


def comparisons(lib):
    for part in (elementary, kinematics, model, validation):
        yield from part(lib)
    if lib.real == np.float64:  # the simulator is in double in both libraries
        yield from simulator(lib)
