/**
 * @file doctor_internal.h
 * The parts of the log doctor (doctor.h). Sums of the identities are kept for each of at most
 * DOCTOR_BLOCKS equal blocks of time, which double in length when they are full. So every identity
 * can be tested over each range of blocks: a slip may concern a part of the log only.
 */
#ifndef PROGRAM_DOCTOR_INTERNAL_H
#define PROGRAM_DOCTOR_INTERNAL_H

/** Cells of 0.1 s. A rate is the difference over a window of five cells. */
#define DOCTOR_CELL_S 0.1
#define DOCTOR_GRAVITY 9.81 /* [m/s2] */
enum {
    DOCTOR_WINDOW = 5,
    DOCTOR_RING = 16,        /* cells that are being filled */
    DOCTOR_HISTORY = 64,     /* past windows */
    DOCTOR_BLOCKS = 16,      /* even */
    DOCTOR_LAGS = 15,        /* of attitude against rates: each way, in cells */
    DOCTOR_EARLY = 20,       /* of an input against acceleration: cells that motion may lead .. */
    DOCTOR_LATE = 20,        /* .. or trail */
    DOCTOR_USUAL = 2,        /* cells by which motion usually trails .. */
    DOCTOR_MOST_USUAL = 6,   /* .. and at most */
    DOCTOR_DISTINCT = 48,    /* distinct values that are remembered of a column */
    DOCTOR_MIN_WINDOWS = 30, /* independent ones, for a decision */
    DOCTOR_INTERVALS = 64,   /* classes of row intervals */
    DOCTOR_WORLD = 6,        /* surge and sway if the velocities are in north, east, down .. */
    DOCTOR_ENU = 8,          /* .. or in east, north, up .. */
    DOCTOR_AXES = 10,        /* .. after the six DoF */
    DOCTOR_READINGS = 5,     /* of the attitude */
    DOCTOR_MOUNT_TERMS = 11  /* X, Y, u, v, |V|u, |V|v, u r, v r, 1; accelerations of u, v */
};

/** Least log likelihood ratio for each window of inputs that move the vehicle: 45 % of the
 * acceleration. Those of a pilot or an excitation have 1 to 4. A controller that only holds the
 * vehicle against waves has up to 0.2 in translation: what follows from them is not its mass, and
 * the lag is the controller's. */
#define DOCTOR_DRIVEN 0.3

/** Lags of a controller, whose output follows the motion by 0.4 s or more. */
enum { DOCTOR_FEEDBACK_FIRST = DOCTOR_EARLY - 10, DOCTOR_FEEDBACK_LAST = DOCTOR_EARLY - 4 };

/** Signals of a cell. */
enum {
    CELL_ANGLE,                      /* [rad], as if the log were in radians */
    CELL_DEGREE = CELL_ANGLE + 3,    /* [rad], as if the log were in degrees */
    CELL_ORDER = CELL_DEGREE + 3,    /* [rad], as if qw .. qz were x, y, z, w */
    CELL_CONJUGATE = CELL_ORDER + 3, /* [rad], as if qw .. qz turned from world to body */
    CELL_NU = CELL_CONJUGATE + 3,
    CELL_INPUT = CELL_NU + 6,
    CELL_POSITION = CELL_INPUT + 6,
    CELL_FORCE = CELL_POSITION + 3, /* specific force */
    CELL_THRUST = CELL_FORCE + 3,   /* forces of the thrusters */
    CELL_SIGNALS = CELL_THRUST + AUVID_MAX_THRUSTERS
};

/** Averages over a cell; NaN: not covered by samples. */
typedef struct {
    double mean[CELL_SIGNALS];
} doctor_cell_t;

/** The resampler. */
typedef struct {
    double last_s[CELL_SIGNALS], last[CELL_SIGNALS]; /* the last sample; NaN: none */
    double sum[DOCTOR_RING][CELL_SIGNALS], covered[DOCTOR_RING][CELL_SIGNALS];
    int64_t next; /* first cell that is not complete */
} doctor_cells_t;

/** Averages over a window that ends with a cell, and rates over it. */
typedef struct {
    /* of the attitude: as logged; in degrees; psi reversed; another order of the quaternion; its
     * conjugate */
    double body_rate[DOCTOR_READINGS][3];
    double nu[DOCTOR_AXES], quadratic[DOCTOR_AXES], acceleration[DOCTOR_AXES], input[DOCTOR_AXES];
    double couple[DOCTOR_AXES][2]; /* coupling terms of each DoF */
    double angle[3];               /* [rad] */
    double depth_rate, sink[3];    /* parts of the depth rate from u, v, w */
    double over_ground[2][2];      /* position rate in body axes: psi as it is, psi reversed */
    double travel[2], drift[2];    /* rates of north and east; less those of the velocity */
    double force[3];               /* specific force .. */
    double expected[3];            /* .. and what attitude and velocity say of it */
    double inertial[3];            /* its part of the velocity, without gravity */
    bool rests;                    /* no input has acted for a while */
    double thrust[AUVID_MAX_THRUSTERS];
} doctor_window_t;

/** Sums of products of two signals. */
typedef struct {
    double n, a, b, aa, bb, ab;
} doctor_pair_t;

enum { GAIN_TERMS = 7 }; /* input, v, |v|v, two couplings, 1; acceleration */

/** Sums of the identities over a block: doubles only, so that blocks add element by element. */
typedef struct {
    doctor_pair_t turn[DOCTOR_READINGS][3][3];         /* reading of the attitude, its axis, rate */
    doctor_pair_t lag[2 * DOCTOR_LAGS + 1][3];         /* the same axis, radians */
    double fixed[DOCTOR_AXES][GAIN_TERMS][GAIN_TERMS]; /* products of all terms but the input */
    /* own input at a lag, times each */
    double own[DOCTOR_AXES][DOCTOR_EARLY + DOCTOR_LATE + 1][GAIN_TERMS];
    double cross[6][6][GAIN_TERMS];                           /* another input */
    double thrust[6][AUVID_MAX_THRUSTERS][GAIN_TERMS];        /* a thruster, likewise .. */
    double both[6][AUVID_MAX_THRUSTERS][AUVID_MAX_THRUSTERS]; /* .. and times another one */
    double count[DOCTOR_AXES];                                /* of windows */
    double mount[DOCTOR_MOUNT_TERMS][DOCTOR_MOUNT_TERMS];     /* see doctor_mounting.c */
    doctor_pair_t force[3][3];                                /* expected axis, measured axis */
    double depth[6][6];            /* 1, sink from u, v, w, depth rate, sum of sinks */
    doctor_pair_t ground[2][2][2]; /* psi, body axis of position, velocity */
    doctor_pair_t world[2][2];     /* rates of north, east with u, v; with v, u */
    doctor_pair_t drift;           /* of north and east */
    doctor_pair_t inertial[3];     /* acceleration of the velocity, of the accelerometer */
    doctor_pair_t rest;            /* u and v at rest */
} doctor_sums_t;

typedef struct {
    double from_s, to_s;
    doctor_sums_t sums;
} doctor_block_t;

/** A column by itself. */
typedef struct {
    double first, last, min, max;
    double n, sum, square;
    double changed_s, changes;      /* time of the last change; number of changes */
    double longest_s, longest_at_s; /* longest time without change */
    double limit, at_limit;         /* largest absolute value; samples there */
    double held;                    /* samples that repeat the one before */
    double distinct[DOCTOR_DISTINCT];
    int distincts; /* beyond the capacity: many */
    double beyond; /* samples beyond +-1.65, a little more than a right angle */
    double absent_s, absent_at_s, sample_s; /* longest time without sample */
} doctor_column_t;

/** A velocity: how plausible its samples are. */
typedef struct {
    double last, last_s;
    double least;             /* smallest that is not 0 */
    double jumps, jump, at_s; /* number, largest, time of the first */
} doctor_velocity_t;

/** which of sunk: theta or u has the wrong sign. */
enum { DOCTOR_PITCH_REVERSED = 2 };

/** which of mirrored: not one of the axes 0 .. 2. */
enum { DOCTOR_MIRROR_UNKNOWN = 3 };

/** A range of blocks in which an explanation is better than that without slip. */
typedef struct {
    double llr;      /* logarithm of the ratio of likelihoods; <= 0: none */
    int first, last; /* blocks */
    int which;       /* explanation, as its identity numbers them */
} doctor_range_t;

typedef struct {
    bool has[CSV_COLUMNS];
    const csv_log_t *log; /* knows what resembles a missing column; NULL: no log */
    int inputs;     /* first column of the inputs: CSV_WRENCH or CSV_COMMAND; -1: none */
    bool thrusters; /* it has inputs of single thrusters */
    double start_s, last_s;
    double rows, back, back_at_s;         /* rows; rows whose time does not advance */
    double gaps, longest_gap_s, gap_at_s; /* over half a second */
    double record_s, longest_record_s;    /* start of the last one between gaps, longest length */
    double interval[DOCTOR_INTERVALS];    /* rows by interval, six classes an octave */
    double gap_total_s;
    double any_moves, all_move;     /* rows in which one, or each of u, v, w changes */
    double sampled_s;               /* last row with a velocity */
    double still[3], still_since_s; /* velocities that do not change, since then */
    double still_s, still_at_s;     /* the longest time of that, and its start */
    double still_total_s;           /* sum of those over a second */
    bool still_at_zero, still_counted;
    bool dropped;        /* the velocities went from motion to exactly zero */
    double drops, zeros; /* times of that; rows of it */
    doctor_velocity_t velocity[3];
    units_t units;
    doctor_cells_t cells;
    doctor_cell_t past[DOCTOR_HISTORY];
    doctor_window_t window[DOCTOR_HISTORY];
    int64_t windows; /* number of windows so far */
    int idle;        /* cells since an input of surge, sway or yaw acted */
    doctor_block_t block[DOCTOR_BLOCKS];
    int blocks, cells_in_block, block_cells;
    doctor_column_t column[CSV_COLUMNS];
    doctor_range_t turned[3]; /* an angle and its rate have opposite signs there */
    doctor_range_t pushed[6]; /* a velocity and its input have opposite signs there */
    doctor_range_t sunk;      /* depth and heave velocity have opposite signs there */
    doctor_range_t gone[2];   /* position and velocity, of surge and sway, likewise */
    doctor_range_t mirrored;  /* an angle and its rate are both reversed there: which axis */
    double depth_scale;       /* of depth_m: of its unit in a metre; 1: metres, or not known */
    double world_llr;         /* ratio by which in_world holds */
    double mounted;           /* angle of u and v to starboard, against the forces; 0: none [rad] */
    int yaw_is_wrong;         /* 1: psi and r are; -1: they are right; 0: not known */
    int lag[6];               /* of a velocity that follows its input, as an index of
                                 doctor_sums_t.own */
    bool answers[6];          /* .. which it does */
    bool reordered;           /* the quaternion is x, y, z, w */
    bool conjugated;          /* it turns from world to body, or p, q, r are all reversed */
    bool degrees;             /* angles or rates are in degrees */
    bool in_world;            /* the velocities are to the north and east, .. */
    bool in_enu;              /* .. the first one to the east, the third one upwards */
    double input_variance[6]; /* over the whole log */
    const log_use_t *use;     /* the inputs are these thrusters; NULL: those of the log */
    double thruster[AUVID_MAX_THRUSTERS], voltage_V; /* last inputs of the thrusters; NaN: none */
    double largest_thrust_N;                         /* of a thruster */
    double unit;                                     /* specific force of one m/s2 */
    double dry_mass_kg;                              /* 0: not known */
    bool known_force;                                /* .. shows the scale of the thrust */
    double usable_s[6], time_constant_s[6];
    /* results */
    bool sparse_inputs; /* most are further apart than fit bridges */
    bool usable;
    unsigned left_out; /* bit j: the velocity of DoF j is too coarse, or stuck */
    double shift_s;    /* the inputs act so much later than their rows say; negative: earlier */
    char verdict[360];
    doctor_finding_t finding[DOCTOR_FINDINGS];
    int findings;
} doctor_t;

/* doctor_cells.c */
void doctor_cells_init(doctor_t *d);
/** Adds the samples of a row at t seconds after the first row. */
void doctor_cells_add(doctor_t *d, double t, const double value[CELL_SIGNALS]);
void doctor_cells_flush(doctor_t *d);

/* doctor_gain.c */
/** A regression of the acceleration of DoF j on its input and other terms. */
typedef struct {
    double without, with; /* sums of squares, without and with the input */
    double b;
    double drag; /* share of the velocity that is lost per second: positive dissipates */
    double coefficient[GAIN_TERMS], t[GAIN_TERMS];
} doctor_gain_t;
/** products: of the input with each term. */
void doctor_regress(const doctor_sums_t *s, int j, const double products[GAIN_TERMS],
                    doctor_gain_t *out);
/** Sums of squares with the usual lags, of the usual and of the opposite sign; best: at the best
 * of these lags. */
void doctor_usual(const doctor_sums_t *s, int j, double *clean, double *against,
                  doctor_gain_t *best);
/** Sum of squares with a reversed input at one of the lags first .. last, as indices of own. */
double doctor_reversed(const doctor_sums_t *s, int j, int first, int last);
/** Lag at which input j explains the blocks best, whatever its sign in each. At others, an input
 * that oscillates seems to be reversed. */
int doctor_best_lag(const doctor_t *d, int j);
/** doctor_ratio of the windows of DoF j. */
double doctor_gain_ratio(const doctor_sums_t *s, int j, double without, double with);

/* doctor_window.c: makes windows */
/** Turns a vector from world to body axes. */
void doctor_to_body(const double angle[3], const double world[3], double body[3]);
void doctor_window_add(doctor_t *d, const doctor_cell_t *cell);

/* doctor_sums.c: sums over windows */
/** The window `cells` before the one that is being made. */
const doctor_window_t *doctor_window_before(const doctor_t *d, int cells);
/** Adds the last window to the sums of its block. */
void doctor_sums_add(doctor_t *d);

/* doctor_scan.c */
/** Score of a sum of blocks: writes the best explanation. Returns its log likelihood ratio. */
typedef double doctor_score_t(const doctor_t *d, const doctor_sums_t *sums, int axis, int *which);
/** The range of blocks with the largest score. */
doctor_range_t doctor_scan(const doctor_t *d, doctor_score_t *score, int axis);
/** Sums of a range. */
void doctor_sum(const doctor_t *d, int first, int last, doctor_sums_t *sum);
/** n/2 ln(without / with) for n independent windows and two residuals; 0 for too few windows. */
double doctor_ratio(double windows, double without, double with);
/** Do two ranges overlap? False if one of them is none. */
bool doctor_overlap(const doctor_range_t *a, const doctor_range_t *b);
/** Sum of squares of a - gain b about their means, over that of both: 1 - concordance (Lin). */
double doctor_discord(const doctor_pair_t *p, double gain);
/** Are both signals, rates over a second, well above the errors of the sensors? */
bool doctor_is_fast(const doctor_pair_t *p);
/** The rate of the depth, and what the velocities say of it (doctor_travel.c). */
doctor_pair_t doctor_depth(const doctor_t *d, const doctor_sums_t *s);
/** Is depth_m not in metres? Then the velocity over ground, which contains its rate, is not
 * known. */
bool doctor_depth_has_other_unit(const doctor_t *d);
/** Correlation. */
double doctor_correlation(const doctor_pair_t *p);
/** Sweeps row k of a symmetric matrix of this size (Beaton 1964). Returns false if it depends on
 * others. */
bool doctor_sweep(double *m, int size, int k, double before);

/* doctor_velocity.c */
void doctor_velocity_add(doctor_t *d, const csv_row_t *row);
/** Do the velocities drop to zero again and again, as in cells without a sample? */
bool doctor_velocity_drops(const doctor_t *d);
void doctor_velocity(doctor_t *d);

/* The tests. *_scan writes turned, pushed .., the others add findings. */
void doctor_attitude_scan(doctor_t *d); /* doctor_attitude.c */
void doctor_attitude(doctor_t *d);
/** Is a sum of squares that an input explains a visible part of the acceleration? What explains
 * less may be an error of other terms: an input that follows the pitch of a hull that swings. */
bool doctor_moves(const doctor_sums_t *s, int j, double explained);
void doctor_inputs_scan(doctor_t *d); /* doctor_inputs.c */
/** Do the couplings v r (surge) and u r (sway) have their signs? In standard errors: above zero
 * yes, below zero no. */
double doctor_coupling(const doctor_t *d, int first, int last);
void doctor_mirror_scan(doctor_t *d); /* doctor_mirror.c: after the other scans */
/** Names an angle that is reversed with its rate. Returns whether there is one. */
bool doctor_mirror(doctor_t *d);
void doctor_inputs(doctor_t *d);
/** What the log calls input j; of thrusters, whose forces make it, in words. */
const char *doctor_input_name(const doctor_t *d, int j);
/** Has DoF j an input and a velocity that can be compared? */
bool doctor_has_input(const doctor_t *d, int j);
/** Finds inputs that are early or late. sign_llr: of all wrong signs together, which explain a
 * shift as well, but less likely. Returns whether they are. */
bool doctor_shift(doctor_t *d, double sign_llr); /* doctor_shift.c */
/** Finds u, v, w that are late against r, or r against them. Returns whether they are. */
bool doctor_late_velocity(doctor_t *d);
/** Takes a lag that is usual, but long. */
void doctor_long_lag(doctor_t *d);
void doctor_travel_scan(doctor_t *d); /* doctor_travel.c */
void doctor_travel(doctor_t *d);
/** Does the position change as if u and v were turned by this angle to starboard (1), as they are
 * (-1), or is that not known (0)? */
int doctor_position_turns(const doctor_t *d, double angle);
/** Does the position change as if psi were reversed? A log likelihood ratio; below zero: no. */
double doctor_position_mirrored(const doctor_t *d);
/** Does the depth change as if u had the wrong sign? */
bool doctor_depth_reverses_surge(const doctor_t *d);
void doctor_mounting_scan(doctor_t *d); /* doctor_mounting.c: after pushed is known */
void doctor_mounting(doctor_t *d);
void doctor_offset(doctor_t *d);     /* doctor_offset.c */
void doctor_world_scan(doctor_t *d); /* doctor_world.c: after leaving out quiet blocks */
void doctor_world(doctor_t *d);
void doctor_scale(doctor_t *d);                                          /* doctor_scale.c */
void doctor_column_add(doctor_t *d, int column, double t, double value); /* doctor_columns.c */
void doctor_columns(doctor_t *d);
/** Are they pulse widths? */
bool doctor_is_pulse(const doctor_column_t *c);
void doctor_time(doctor_t *d);  /* doctor_time.c */
void doctor_force(doctor_t *d); /* doctor_force.c: needs a sound attitude */
/** The forces of the thrusters in a row, and their wrench, which it writes into the row. */
void doctor_thrusters_row(doctor_t *d, csv_row_t *row, double force_N[AUVID_MAX_THRUSTERS]);
/** Are the forces of the thrusters much larger than those of the vehicle? */
bool doctor_thrust_is_wrong(const doctor_t *d);
/** Finds thrusters in another unit, or with the wrong sign. Returns whether there is one. */
bool doctor_thrusters(doctor_t *d); /* doctor_thrusters.c */
/** Names thrusters whose slips motion cannot show. */
void doctor_thrusters_hidden(doctor_t *d);

/* doctor.c */
/** Adds a finding; range NULL: the whole log. Returns it. */
doctor_finding_t *doctor_add(doctor_t *d, doctor_severity_t severity, doctor_code_t code,
                             int column, int other, const doctor_range_t *range, const char *format,
                             ...);
/** "" or ", from t_s 12 to 40". */
const char *doctor_where(const doctor_t *d, const doctor_range_t *range, char text[48]);
/** Interval of rows in the middle of class k [s]. */
double doctor_interval(int k);
/** Interval that is not exceeded by a share of the rows [s]. */
double doctor_interval_quantile(const doctor_t *d, double share);
bool doctor_has_finding(const doctor_t *d, doctor_code_t code, int column);

#endif
