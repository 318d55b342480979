"""What `auvid-validate peers` searches: eight sets of a simulated vehicle, recorded by an
identifier, and the cost of a model on them.

Each vehicle has 1 N of disturbance and the sensors of README. A function (lib, seed) simulates it,
and returns its identifier, with complete sets and without work, and what must outlive it."""
import ctypes

import numpy as np

from auvid_validation.library import load, values

SETS, SET_S, TICKS_PER_S, HEAVE = 8, 30, 50, 2
LARGE = 4_000_000_000  # units of work


def chain(lib, seed, change=lambda config: None):
    config, run = lib.chain_config_t(), lib.chain_t()
    lib.chain_defaults(config, 1000 + seed, SETS, 1.0)
    config.budget = 0
    change(config)
    assert lib.chain_run_sets(run, config, SETS) == 0
    return run.id, (run, config)


def linear(lib, seed):
    return chain(lib, seed)


def in_current(lib, seed):
    """0.3 m/s of any direction."""
    current, rows = lib.auvid_current_t(), (lib.auvid_row_t * ((SETS + 1) * 60))()

    def change(config):
        angle = 2.4 * seed
        config.sim.current[:2] = [0.3 * np.cos(angle), 0.3 * np.sin(angle)]
        assert lib.auvid_current_init(current, lib.auvid_girona500, False) == 0
        given = lib.auvid_identifier_config_t.from_buffer_copy(config.id)
        lib.auvid_identifier_defaults(config.id, current.vehicle)
        config.id.metric.rows, config.id.metric.row_slots = rows, len(rows)
        config.id.search.seed, config.id.exact_inputs = given.search.seed, True
        lower, upper = (lib.zeros(len(x)) for x in (given.search.lower, given.search.upper))
        lower[:], upper[:] = values(given.search.lower), values(given.search.upper)
        assert lib.auvid_current_bounds(current, 1.0, lower, upper) == 0
        config.id.search.lower[:], config.id.search.upper[:] = lower.tolist(), upper.tolist()
    identifier, kept = chain(lib, seed, change)
    return identifier, (kept, current, rows)


def excited(lib, config, amplitude, seed, guard):
    """An identifier with an excitation. guard(config) changes the guard's limits."""
    acting, identifier = lib.auvid_actuation_config_t(), lib.auvid_identifier_t()
    actuation = lib.auvid_actuation_t()
    config.exact_inputs = True
    config.search.seed = 1000 + seed
    ctypes.memset(ctypes.byref(config.uncertainty), 0, ctypes.sizeof(config.uncertainty))
    lib.auvid_actuation_defaults(acting)
    guard(acting.guard)
    assert lib.auvid_excitation_plan(acting.excitation, lib.array(amplitude), SET_S, SETS,
                                     1000 + seed) == 0
    assert lib.auvid_identifier_init(identifier, config) == 0
    assert lib.auvid_identifier_attach_actuation(identifier, actuation, acting, None) == 0
    return identifier, actuation


def record(lib, identifier, world, force, control):
    """Runs until the sets are complete. force(sim): force of each thruster and wrench, of the next
    tick; control(sim, excitation, commands): sets commands, -> wrench as the identifier knows
    it."""
    commands = lib.zeros(len(lib.auvid_thrusters_config_t().group))
    sim, seen = lib.sim_t(), lib.sim_output_t()
    given, out = lib.auvid_input_t(), lib.auvid_output_t()
    assert lib.sim_init(sim, world)
    running = False
    for _ in range(SETS * SET_S * TICKS_PER_S + 6 * TICKS_PER_S):
        lib.sim_step(sim, *force(sim), seen)
        lib.chain_sense(seen, 0, given)
        if not running and lib.auvid_identifier_arm(identifier) == 0:
            running = lib.auvid_identifier_excite(identifier) == 0
        assert lib.auvid_identifier_step(identifier, given, out) == 0
        nominal = control(sim, values(out.excitation), commands)
        assert lib.auvid_identifier_applied(identifier, given.t_us, nominal, commands) == 0
    assert identifier.metric.sets.recorded == SETS


def world_of(lib, seed):
    world = lib.sim_config_t()
    lib.sim_defaults(world)
    world.seed, world.disturbance_N, world.disturbance_Nm = 1000 + seed, 1.0, 0.4
    return world


class Thrusters:
    """Five thrusters with gains, dead band and lag; a pilot holds the depth."""
    FORWARD, BACKWARD, DEAD_BAND, LAG_S = 80.0, 62.0, 0.1, 0.2

    def __init__(self, lib, world):
        self.lib, self.weight = lib, world.parameter[lib.SIM_WB]
        self.force, self.command = np.zeros(5), np.zeros(5)
        self.allocation, self.result = lib.auvid_allocation_t(), lib.auvid_allocation_result_t()
        assert lib.auvid_allocation_init(self.allocation, lib.auvid_allocation_girona500) == 0

    def mean_force(self, _):
        """Over a tick."""
        c, d = self.command, self.DEAD_BAND
        goal = self.FORWARD * np.maximum(c - d, 0) + self.BACKWARD * np.minimum(c + d, 0)
        a = 1 / TICKS_PER_S / self.LAG_S
        mean = goal + (self.force - goal) * (1 - np.exp(-a)) / a
        self.force = goal + (self.force - goal) * np.exp(-a)
        return np.append(mean, np.zeros(3)), None

    def control(self, sim, excitation, commands):
        """Commands are the force divided by 70."""
        wrench = excitation.copy()
        wrench[HEAVE] += -self.weight - 30 * (sim.truth.position[2] - 50)
        assert self.lib.auvid_allocation_solve(self.allocation, wrench, self.result) >= 0
        commands[:5] = values(self.result.force_N)[:5] / self.lib.real.type(70)
        self.command = commands[:5].astype(float)
        return wrench


def girona500_thrusters(lib):
    """The model, with a log of commands in slots of 40 ms."""
    config, model, period_us = lib.auvid_thrusters_config_t(), lib.auvid_thrusters_t(), 40_000
    slots = ((SETS + 1) * SET_S * 1_000_000 + 9_000_000) // period_us
    log, world = np.zeros(5 * slots, np.int16), world_of(lib, 0)
    lib.auvid_thrusters_defaults(config)
    config.hull, config.thrusters = ctypes.pointer(lib.auvid_girona500), 5
    for j in range(6):
        config.matrix[j][:5] = world.thruster_matrix[j][:5]
    config.command_max, config.gain_max, config.period_us, config.slots = 2, 300, period_us, slots
    config.log = log.ctypes.data_as(ctypes.POINTER(ctypes.c_int16))
    assert lib.auvid_thrusters_init(model, config, None) == 0
    return model, log


def with_thrusters(lib, seed):
    """The mass in surge is known: it sets the scale."""
    world, config = world_of(lib, seed), lib.auvid_identifier_config_t()
    rows = (lib.auvid_row_t * ((SETS + 1) * SET_S * 2))()
    model, log = girona500_thrusters(lib)
    lib.auvid_identifier_defaults(config, model.vehicle)
    config.metric.rows, config.metric.row_slots, config.metric.sets = rows, len(rows), SETS
    config.metric.free &= ~(1 << lib.AUVID_G500_M_U)
    config.metric.fixed[lib.AUVID_G500_M_U] = world.parameter[lib.SIM_M_U]
    assert lib.auvid_thrusters_configure(model, config) == 0

    def guard(limits):
        limits.distance_max_m, limits.speed_max = 1000, 5
    identifier, actuation = excited(lib, config, [100, 100, 100, 0, 0, 40], seed, guard)
    thrusters = Thrusters(lib, world)
    record(lib, identifier, world, thrusters.mean_force, thrusters.control)
    return identifier, (model, log, rows, actuation)


def dead_band(lib, seed):
    """A user's model, with surge alone: two thrusters whose dead band acts on mean commands, which
    gives its cost kinks, and a delay of 0.14 s."""
    world, config = world_of(lib, seed), lib.auvid_identifier_config_t()
    rows, vehicle = (lib.auvid_row_t * ((SETS + 1) * 150))(), lib.dead_band_vehicle()
    lower, upper = lib.zeros(5), lib.zeros(5)
    late = [0.0] * 7
    lib.dead_band_bounds(lower, upper)
    lib.auvid_identifier_defaults(config, vehicle)
    config.metric.rows, config.metric.row_slots = rows, len(rows)
    config.metric.sets, config.metric.set_rows = SETS, 150
    config.metric.row_cells = 2
    config.search.lower[:5], config.search.upper[:5] = lower.tolist(), upper.tolist()

    def guard(limits):  # the depth is not held
        limits.off = 1 << lib.AUVID_GUARD_DEPTH_MIN | 1 << lib.AUVID_GUARD_DEPTH_MAX

    def force(sim):
        surge = lib.dead_band_force(late.pop(0), sim.truth.nu[0])
        return None, np.array([surge, 0, -world.parameter[lib.SIM_WB], 0, 0, 0])

    def control(_, excitation, commands):
        commands[:2] = excitation[0]
        late.append(float(excitation[0]))
        return 100 * excitation
    identifier, actuation = excited(lib, config, [1, 0, 0, 0, 0, 0], seed, guard)
    record(lib, identifier, world, force, control)
    return identifier, (vehicle, rows, actuation)


class Record:
    """The sets of a vehicle, the search on board, and then the cost for all others, in single
    precision. x is in -1..1 of the bounds."""

    def __init__(self, vehicle, seed, clock):
        self.lib, self.rows = load("wide"), vehicle is not linear
        self.identifier, self.kept = vehicle(self.lib, seed)
        history = self.identify(clock)
        # A copy, as rows keep what the last metric computed from them.
        self.metric = self.lib.auvid_metric_t.from_buffer_copy(self.identifier.metric)
        self.budget = np.zeros(1, np.uint32)
        self.lib.auvid_metric_merge_begin(self.metric)
        merge = self.finish(self.lib.auvid_metric_merge)
        search, free = self.identifier.search, self.lib.auvid_metric_searched(self.metric)
        self.free = [i for i in range(len(search.lower)) if free >> i & 1]
        self.delayed = self.rows and self.metric.cfg.estimate_delay
        longest = [self.lib.auvid_metric_longest_delay(self.metric)] * self.delayed
        self.low = np.append(values(search.lower)[self.free], np.zeros(len(longest)))
        self.high = np.append(values(search.upper)[self.free], longest)
        self.pi = values(self.metric.cfg.fixed).copy()
        self.constant = self.metric.result.constant
        self.room = np.zeros(SETS * 150 * 6)
        self.lowest = np.inf
        self.set_found(history, merge)

    def identify(self, clock):
        """The search on board. -> units of work, cost and seconds after each point."""
        lib, identifier = self.lib, self.identifier
        budget = 150 if self.rows else 20  # less than a point takes
        units, began, history = 0, clock(), []
        cost = identifier.metric.result.cost
        while identifier.work.phase < lib.AUVID_WORK_MEASURE:
            lib.auvid_identifier_work(identifier, budget)
            units += identifier.work.last_units
            if identifier.metric.result.cost != cost:
                cost = identifier.metric.result.cost
                history.append((units, cost, clock() - began))
        while lib.auvid_identifier_work(identifier, 1_000_000) == lib.AUVID_PENDING:
            pass
        return history

    def set_found(self, history, merge):
        """found: x of the estimate. history: after each point all work of the search, in
        evaluations, or the number of points if that is more; its cost; seconds. The others begin
        with merged sets. At the end the cost is that of the estimate."""
        e = self.identifier.estimate
        theta = np.append(values(e.pi)[self.free], [max(values(e.delay_s))] * self.delayed)
        self.found = 2.0 * (theta - self.low) / (self.high - self.low) - 1.0
        self.cost(np.zeros(len(theta)))  # at an unchanged thrust the next one would be cheaper
        units_of_cost, cost = self.units, self.cost(self.found)
        own = e.cost + self.constant
        assert abs(own / cost - 1) < 1e-5, (own, cost)
        self.history = [(max((units - merge) / units_of_cost, k), at + self.constant, seconds)
                        for k, (units, at, seconds) in enumerate(history, 1)]
        evaluations = e.evaluations_crs + e.evaluations_line
        self.history.append((max(self.history[-1][0], evaluations), cost, self.history[-1][2]))

    def finish(self, step):
        """-> units of work"""
        self.budget[0] = LARGE
        assert step(self.metric, self.budget) == 0
        return LARGE - int(self.budget[0])

    def place(self, x):
        """Sets the parameters. -> the delay"""
        theta = self.low + 0.5 * (np.asarray(x) + 1.0) * (self.high - self.low)
        self.pi[self.free] = theta[:len(self.free)]
        return float(theta[-1]) if self.delayed else 0.0

    def seen(self, cost):
        self.lowest = min(self.lowest, cost)
        return cost

    def cost(self, x):
        self.lib.auvid_metric_cost_begin(self.metric, self.pi, self.place(x))
        self.units = self.finish(self.lib.auvid_metric_cost)
        return self.seen(self.metric.result.cost + self.constant)

    def squares(self, x):
        """The same cost; the residuals are in self.residuals."""
        delay = self.place(x)
        count = self.lib.residuals_at(self.metric, self.pi, delay, self.room, len(self.room))
        assert count > 0
        self.residuals = self.room[:count].copy()
        return self.seen(float(self.residuals @ self.residuals))
