#!/usr/bin/env python3
"""Is every member of auvid_identifier_t, and of what it holds, in the checkpoint?

usage: checkpoint.py LIBRARY.so
Names and offsets come from the library's debugging information. Each member (of an array the first
and the last element) is changed in a live identifier. The change must alter the checkpoint.
Restored into an untouched identifier, the checkpoint must bring the change, or be refused: as
impossible, or as one of another model or configuration. One with a real that is not a number must
be refused, except where a model may fail. Pointers must not be in the checkpoint.
Prints a line "not ok" for each missing member, or one line "ok".
"""
import ctypes
import sys

from auvid_validation.dwarf import Binding

# Unused between calls: unions whose other member is saved; the configuration, which init copies;
# what follows from it.
DEAD = ("cfg.", "refusal.", "actuation.refusal.", "uncertain.refusal.",
        "metric.evaluator.regressor", "confidence.regressor", "metric.layout.",
        "metric.cfg.velocity_us", "default_scale", "instruments.of", "instruments.lags")
# Costs and residuals, infinite or not a number where a model fails; rows not yet checked.
MAY_FAIL = ("change.predicted", "change.statistic", "metric.evaluator.window",
            "metric.evaluator.sum", "metric.evaluator.compensation", "metric.evaluator.squares",
            "metric.evaluator.band_sse", "metric.evaluator.z", "metric.result.cost",
            "metric.result.sse", "optimizer.trial", "linear.newton.cost", "linear.windows.z",
            "uncertain.recorded.accumulator", "uncertain.recorded.channel",
            "instruments.accumulator", "instruments.channel")
# Members that decide on forces stay those of init.
KEPT = tuple("actuation." + name for name in (
    "excitation.cfg.", "excitation.duration_us", "excitation.pause_us", "excitation.fade_us",
    "excitation.sequence_us", "excitation.run_us", "excitation.heaves",
    "guard.cfg.", "guard.ready"))
# Members of unions are used in other phases of work than the rest.
MERGE, ASK, CONFIDENCE, GLOBAL, LOCAL = 5, 6, 10, 1, 6
NEWTON, STEP = "Gauss-Newton steps, in the phase MERGE", 2
LIVE = (("confidence.", CONFIDENCE, GLOBAL), ("optimum.", MERGE, GLOBAL),
        ("linear.", NEWTON, GLOBAL),
        ("optimizer.crs.", ASK, GLOBAL),
        ("optimizer.", ASK, LOCAL), ("", ASK, GLOBAL))
# Pointers that saving follows. Of the last two, it saves whether they are NULL.
FOLLOWED = ("metric.cfg.vehicle", "metric.cfg.rows", "metric.cfg.row_slots", "metric.prior",
            "metric.prior_context", "actuation", "attached.change", "attached.prediction",
            "prediction.vehicle", "actuation.shape", "actuation.shape_context",
            "attached.uncertain", "uncertain.allocation", "uncertain.instruments")
SET_ROWS = 2
ROOM = 1 << 18
REFUSED = -6, -10, -16, -27  # impossible; of other storage, another model, another configuration
POINTERS = ctypes._Pointer, ctypes._CFuncPtr, ctypes.c_void_p, ctypes.c_char_p


def leaves(kind, path="", at=0):
    """(path, offset, type) of all scalars, of arrays' first and last elements."""
    if issubclass(kind, (ctypes.Structure, ctypes.Union)):
        for name, inner in kind._fields_:
            more = "" if name in getattr(kind, "_anonymous_", ()) else "." + name
            yield from leaves(inner, path + more, at + getattr(kind, name).offset)
    elif issubclass(kind, ctypes.Array):
        for i in sorted({0, kind._length_ - 1}):
            size = ctypes.sizeof(kind._type_)
            yield from leaves(kind._type_, f"{path}[{i}]", at + i * size)
    else:
        yield path.lstrip("."), at, kind


class Subject:
    def __init__(self, path):
        self.lib = lib = Binding(path)
        self.vehicle = lib.auvid_vehicle_t()
        source = lib.auvid_girona500
        ctypes.memmove(ctypes.byref(self.vehicle), ctypes.byref(source), ctypes.sizeof(source))
        self.vehicle.residual = type(self.vehicle.residual)(lambda *_: None)
        self.residual, self.regressor = (ctypes.pointer(path) for path in (
            lib.auvid_path_residual, lib.auvid_path_regressor))
        self.vehicle.path = self.residual
        config = lib.auvid_identifier_config_t()
        lib.auvid_identifier_defaults(config, self.vehicle)
        used = (config.metric.sets + 1) * SET_ROWS
        room = (lib.auvid_row_t * (2 * used))()  # some changes make more of it
        self.rows = (lib.auvid_row_t * used).from_buffer(room)
        config.metric.set_rows = SET_ROWS
        config.metric.rows = ctypes.cast(room, type(config.metric.rows))
        config.metric.row_slots = 2 * used
        self.id = lib.auvid_identifier_t()
        assert lib.auvid_identifier_init(self.id, config) == 0
        acting = lib.auvid_actuation_config_t()
        lib.auvid_actuation_defaults(acting)
        self.actuation = lib.auvid_actuation_t()
        assert lib.auvid_identifier_attach_actuation(self.id, self.actuation, acting, None) == 0
        plan = lib.auvid_adaptive_config_t()
        lib.auvid_adaptive_defaults(plan)
        plan.amplitude[0] = 100
        self.adaptive = lib.auvid_adaptive_t()
        assert lib.auvid_adaptive_begin(self.id, self.adaptive, plan, None) == 0
        self.change = lib.auvid_change_detector_t()
        assert lib.auvid_identifier_attach_change_test(self.id, self.change) == 0
        self.prior = lib.auvid_prior_t()
        assert lib.auvid_identifier_attach_prior(self.id, self.prior) == 0
        self.prediction = lib.auvid_validation_t()
        assert lib.auvid_identifier_attach_prediction(self.id, self.prediction) == 0
        self.prediction.vehicle = ctypes.pointer(self.vehicle)
        self.attach_uncertain()
        self.chunk = (ctypes.c_uint8 * ROOM)()

    def attach_uncertain(self):
        """They need a model with regressor."""
        lib, of = self.lib, self.lib.auvid_allocation_girona500
        self.allocation, inputs = lib.auvid_allocation_t(), lib.auvid_uncertain_config_t()
        assert lib.auvid_allocation_init(self.allocation, of) == 0
        lib.auvid_uncertain_defaults(inputs)
        self.uncertain, self.instruments = lib.auvid_uncertain_t(), lib.auvid_instruments_t()
        self.vehicle.path = self.regressor
        assert lib.auvid_identifier_attach_uncertain(
            self.id, self.uncertain, inputs, self.allocation) == 0
        assert lib.auvid_identifier_attach_instruments(self.id, self.instruments) == 0

    def pose(self, phase, search):
        """Set up a possible state of a search for two values, or of its result's confidence. The
        model has a regressor for the phase that finds the minimum cost, else none."""
        ctypes.memset(ctypes.byref(self.id.optimizer), 0, ctypes.sizeof(self.id.optimizer))
        self.id.work.phase = MERGE if phase == NEWTON else phase
        self.id.work.searching = phase == ASK
        self.id.metric.result.excited = self.id.metric.result.dof_rows[0] = self.id.work.active = 1
        self.id.metric.sets.held = True
        self.vehicle.path = self.regressor if phase == MERGE else self.residual
        self.id.work.seeks_optimum = phase == MERGE
        self.id.work.spent = phase in (MERGE, NEWTON)
        if phase == NEWTON:
            self.id.linear.newton.ls.n = 1 + self.id.metric.cfg.estimate_delay
            self.id.linear.newton.state = STEP
            return
        if phase == MERGE:
            self.id.optimum.n = 1
            return
        if phase == CONFIDENCE:
            self.id.confidence.n = 1
            return
        optimizer = self.id.optimizer
        optimizer.state = search
        optimizer.cfg.n, optimizer.cfg.population, optimizer.cfg.delta = 2, 3, 2

    def save(self):
        cursor, size = self.lib.auvid_checkpoint_t(), ctypes.c_uint32(ROOM)
        assert self.lib.auvid_checkpoint_begin(cursor, self.id) == 0
        assert self.lib.auvid_checkpoint_next(cursor, self.chunk, size) == 0
        return ctypes.string_at(self.chunk, size.value)

    def restore(self, saved):
        return self.lib.auvid_checkpoint_resume(
            self.id, (ctypes.c_uint8 * len(saved)).from_buffer_copy(saved), len(saved))


def wrong(subject, whole, path, at, kind):
    """The fault of the member at this offset of `whole`, or None."""
    before = bytes(whole)
    memory = (ctypes.c_uint8 * ctypes.sizeof(whole)).from_buffer(whole)
    plain = subject.save()

    def saved_with(change):
        memory[at:at + len(change)] = change
        saved = subject.save()
        ctypes.memmove(memory, before, len(before))
        return saved

    changed = memory[at] ^ 1
    saved = saved_with([changed])
    if issubclass(kind, POINTERS):
        return None if saved == plain else "is a pointer, but it is in the checkpoint"
    if saved == plain:
        return "is not in the checkpoint: see lib/src/checkpoint/auvid_checkpoint_layout.c"
    status = subject.restore(saved)
    brought = memory[at] == changed
    ctypes.memmove(memory, before, len(before))
    if not (status == 0 and brought) and status not in REFUSED:
        return f"is not restored ({status!r})"
    if issubclass(kind, (ctypes.c_float, ctypes.c_double)) and not path.startswith(MAY_FAIL):
        status = subject.restore(saved_with([0xFF] * ctypes.sizeof(kind)))
        ctypes.memmove(memory, before, len(before))
        return None if status in REFUSED else "is restored though it is not a number"
    return None


def main():
    subject, looked, bad = Subject(sys.argv[1]), 0, []
    for whole, name in ((subject.id, ""), (subject.actuation, "actuation"),
                        (subject.adaptive, "adaptive"), (subject.prediction, "prediction"),
                        (subject.change, "change"), (subject.prior, "prior"),
                        (subject.uncertain, "uncertain"), (subject.instruments, "instruments"),
                        (subject.rows, "rows")):
        for path, at, kind in leaves(type(whole), name):
            if path.startswith(DEAD + KEPT) or path in FOLLOWED:
                continue
            _, phase, search = next(live for live in LIVE if path.startswith(live[0]))
            subject.pose(phase, search)
            assert subject.restore(subject.save()) == 0
            looked += 1
            if what := wrong(subject, whole, path, at, kind):
                bad.append(f"not ok - {sys.argv[1]}: {path} {what}")
    print("\n".join(bad or [f"ok - {sys.argv[1]}: {looked} members checked"]))


main()
