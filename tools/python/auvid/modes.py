"""The modes of autopilots, by number: name, and the degrees of freedom that they hold."""

ATTITUDE = ("roll", "pitch", "yaw")
DEPTH = ("heave", *ATTITUDE)
ALL = ("surge", "sway", *DEPTH)

#: ArduSub's Mode::Number. In SURFACE the pilot drives surge and sway.
ARDUSUB = {0: ("STABILIZE", ATTITUDE), 1: ("ACRO", ATTITUDE), 2: ("ALT_HOLD", DEPTH),
           3: ("AUTO", ALL), 4: ("GUIDED", ALL), 7: ("CIRCLE", ALL), 9: ("SURFACE", DEPTH),
           16: ("POSHOLD", ALL), 19: ("MANUAL", ()), 20: ("MOTOR_DETECT", ()),
           21: ("SURFTRAK", DEPTH)}
#: PX4's vehicle_status.nav_state.
PX4 = {0: ("MANUAL", ()), 1: ("ALTCTL", DEPTH), 2: ("POSCTL", ALL), 3: ("AUTO_MISSION", ALL),
       4: ("AUTO_LOITER", ALL), 5: ("AUTO_RTL", ALL), 10: ("ACRO", ATTITUDE),
       14: ("OFFBOARD", ALL), 15: ("STAB", ATTITUDE)}

LEAST = 0.01       # share of the time that is worth a word


def shares(changes, begin, end):
    """-> {(name, held): share of the time from begin to end}. changes: (t, name, held)"""
    out = {}
    for (t, *mode), (until, *_) in zip(changes, [*changes[1:], (end,)]):
        time = min(until, end) - max(t, begin)
        out[tuple(mode)] = out.get(tuple(mode), 0.0) + max(time, 0.0) / (end - begin)
    return {mode: share for mode, share in out.items() if share >= LEAST}


def advise(changes, begin, end):
    """-> sentences"""
    found = shares(changes, begin, end)

    def named(test):
        return ", ".join(f"{name} ({100 * share:.0f} %)"
                         for (name, held), share in found.items() if test(held))
    unknown, driven = named(lambda held: held is None), named(lambda held: held == ALL)
    assisted, manual = named(lambda held: held in (ATTITUDE, DEPTH)), named(lambda held: held == ())
    said = []
    if unknown:
        said.append(f"{unknown}: not known to auvid-log; name what it holds by auvid fit "
                    "--closed-loop")
    if driven:
        said.append(f"{driven}: the autopilot drives all degrees of freedom; nothing of that time "
                    "is identifiable: cut it from the CSV")
    if assisted:
        held = DEPTH if any(mode[1] == DEPTH for mode in found) else ATTITUDE
        said.append(f"{assisted}: the autopilot holds {', '.join(held)}; auvid fit --closed-loop "
                    f"{','.join(held)} identifies the others"
                    + (f"; a CSV cut to {manual} needs no option" if manual else ""))
    return said
