/**
 * @file uncertain.h
 * Uncertain inputs: what the user supplies to the identification without knowing it exactly.
 *
 * Thrusters whose curve comes from a data sheet, time stamps, a current, a drag that differs
 * forward and backward: each of these errors is small, and each biases the estimate without leaving
 * a trace in the scatter of the data. The module gives each a column in the equations and a prior,
 * mean zero. The parameters and the uncertain inputs are then estimated together, per DoF j
 *
 *     z_j = R_j pi + C_j b + e_j,   b_k ~ N(0, sigma_k^2).
 *
 * z is the supplied thrust behind a nominal lag of the propellers' speed. The noise is in the
 * acceleration, not in the thrust: in the column of the mass, u' becomes u' + e / m (prediction
 * error, three Gauss-Newton steps; one if an excitation continues). Otherwise columns that contain
 * the thrust would shrink it. Where e is slower than the vehicle, a force of it gives the vehicle
 * speed and little acceleration: half of that share is in the columns of drag. What the inputs
 * leave of their own errors is in the thrust: 0.3 of e is ascribed to it, and more in a quick
 * vehicle.
 * Columns of the hull and its weight are made orthogonal to its drag, so that X_u and X_uu remain
 * the best drag of the model for the motion that was seen. In a model of roll or pitch the weight
 * is no part of the drag.
 *
 * The equations of roll and pitch determine parameters of these two only, with inputs of their own:
 * their moments are small differences of forces, and most often an autopilot's. What is wrong with
 * them bends no mass or drag of other DoF, unless a parameter of theirs that is in other equations,
 * too, is free (couplings, x_G, y_G). If no moment acts in one of the two, its own parameters are
 * not estimated.
 *
 * The common scale of the thrust is not observable. It stays in auvid_uncertainty_t. A known force
 * shows it (auvid_calibrated_t in estimate.h).
 *
 * Thrust f is lost with the speed v of the water along a propeller, by a law that is not known: in
 * proportion to the thrust, f v, or to the propeller's speed n, |n| v (Fossen's bilinear model). It
 * has a column for each, so the loss is their sum at full thrust. Both look like linear drag.
 *
 * The priors may be wrong by a factor of two: they get a common scale, the one with the largest
 * likelihood of what was found. Above 1, the scales of thrust and DVL in auvid_uncertainty_t are
 * taken as less certain by its square: then few parameters are identifiable. From 2 on none
 * is (AUVID_NOTE_UNCHECKED).
 *
 * The columns of current, lever arm, mounting angle, filter and late DVL are formed with the last
 * estimate, those of the parameters with all of these but the last. Rows of an excitation from
 * before the first one have none, and count a sixteenth once there is one; those from before the
 * second one count less where there is a current.
 *
 * More rows than the 480 of four minutes average noise, but count as 480: what the model and the
 * columns lack depends on the motion, and does not average out. So half-widths do not shrink with a
 * longer record of the same motion; larger motion makes them smaller. With instruments all rows
 * count.
 *
 * A passive vehicle adds rows until the first excitation; from then on only the excitation does,
 * unless it ends before it has given a set of rows. In closed loop nothing is identifiable from
 * passive rows (AUVID_NOTE_FEEDBACK), unless it is that of a few DoF (closed_loop in
 * metric_config.h), or the reference of the controller is given (auvid_instruments_t, below). Each
 * search is followed by a solution with uncertain inputs: they are eliminated, and both phases of
 * the optimizer search what is left, within the bounds. auvid_identifier_estimate then returns it.
 * The estimate without uncertain inputs is identifier.estimate; nothing in it is identifiable.
 *
 * After an excitation the last estimate stays, however the vehicle is driven then. After a change
 * of the vehicle the rows begin again: passive ones until the next excitation. Rows of a set that
 * the change test deletes stay. The rows hold about as much as the ring of sets.
 *
 *     static auvid_uncertain_t uncertain;
 *     auvid_uncertain_defaults(&inputs);
 *     auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &thrusters);
 *
 * The commands (auvid_input_t.applied.command, or those of auvid_identifier_applied) must be the
 * thrusters' forces in newtons, as reported, or fractions of their largest forces
 * (auvid_uncertain_config_t.fractions). If they do not make the wrench, there is no estimate with
 * uncertain inputs.
 *
 * Regressor path only. Attach it once; a program without it does not contain it. A checkpoint
 * (checkpoint.h) contains its state. Cost: a tick of the example on a Cortex-M4F takes 25 thousand
 * instructions instead of 17 on average, 63 instead of 59 at most; of these about 0.1 thousand for
 * each thruster and command. Memory:
 * sizeof(auvid_uncertain_t), 36 KiB with default sizes; AUVID_MAX_UNCERTAIN chooses for how many
 * columns.
 *
 * Sources: Fuller 1987 (errors in variables); Ljung 1999, 7 (prediction error); Schmidt 1966
 * (considered parameters); Miller and Dunson 2019 (coarsening). None of it is in the paper.
 */
#ifndef AUVID_UNCERTAIN_H
#define AUVID_UNCERTAIN_H

#include "auvid/allocation.h"
#include "auvid/identifier.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Uncertain inputs that are one number of the vehicle. The gains of its thrusters follow. */
typedef enum {
    AUVID_UNCERTAIN_BACKWARD,  /**< backward thrust is weaker by this part */
    AUVID_UNCERTAIN_DEAD_BAND, /**< thrust is smaller by this force [N] */
    AUVID_UNCERTAIN_CURVE,     /**< thrust follows the power 1 + this of its nominal value */
    AUVID_UNCERTAIN_INFLOW,    /**< thrust is lost with speed, by this part of it per m/s [s/m] */
    AUVID_UNCERTAIN_BILINEAR,  /**< and by this part of full thrust, times the propeller's speed
                                    over that at full thrust, per m/s [s/m] */
    AUVID_UNCERTAIN_SAG, /**< thrust is lost with time, by this part in 240 s, from the first row
                                    on, and in a long dive from an hour ago */
    AUVID_UNCERTAIN_LAG, /**< the propellers' lag beyond the nominal one [s] */
    AUVID_UNCERTAIN_CURRENT_X, /**< current to the north [m/s] */
    AUVID_UNCERTAIN_CURRENT_Y, /**< current to the east [m/s] */
    AUVID_UNCERTAIN_ARM_X,     /**< the DVL is further ahead than configured [m] */
    AUVID_UNCERTAIN_ARM_Y,     /**< the DVL is further to starboard than configured [m] */
    AUVID_UNCERTAIN_ARM_Z,     /**< the DVL is further down than configured [m] */
    AUVID_UNCERTAIN_DVL_PITCH, /**< the DVL is turned further bow up than configured [rad] */
    AUVID_UNCERTAIN_DVL_YAW,   /**< the DVL is turned further to starboard than configured [rad] */
    AUVID_UNCERTAIN_FILTER,    /**< the velocity lags behind the body's turns, too, as if filtered
                                    in the world's axes with this time constant [s] */
    AUVID_UNCERTAIN_DVL_LATE,  /**< the DVL is later than the attitude [s] */
    AUVID_UNCERTAIN_FORCE_RESPONSE,  /**< half the second moment of the response that leads from the
                                         thrust behind its nominal lag to the measured motion, of
                                         forces [s^2]: d^2 / 2 of a delay d, T^2 of a first-order
                                         filter of the velocity with time constant T */
    AUVID_UNCERTAIN_MOMENT_RESPONSE, /**< likewise of moments [s^2] */
    AUVID_UNCERTAIN_GAIN,            /**< the first thruster is stronger by this part */
    AUVID_UNCERTAIN_SHARED = AUVID_UNCERTAIN_GAIN + AUVID_MAX_THRUSTERS
} auvid_uncertain_input_t;

/** Number of those that change the motion: from the current on. */
#define AUVID_UNCERTAIN_SHIFTS ((int)AUVID_UNCERTAIN_FILTER - (int)AUVID_UNCERTAIN_CURRENT_X + 1)

/** Standard deviations of the priors; copied. 0: this input is exact and has no column. */
typedef struct {
    auvid_real_t backward;   /**< relative, 0..1; default 0.05 */
    auvid_real_t dead_band;  /**< relative to the thruster's largest force, 0..1; default 0.012 */
    auvid_real_t curve;      /**< of the exponent, 0..1; default 0.05 */
    auvid_real_t inflow;     /**< loss of thrust per m/s at full thrust, relative, both laws
                                together [s/m], 0..10; default 0.18 */
    auvid_real_t sag;        /**< of the thrust in 240 s, relative, 0..1; default 0.05 */
    auvid_real_t gain;       /**< of each thruster, relative, 0..1; default 0.05 */
    auvid_real_t lag_s;      /**< about nominal_lag_s [s], 0..1; default 0.06 */
    auvid_real_t delay_s;    /**< of the thrust against each DoF's motion [s], 0..1; default 0.04 */
    auvid_real_t current;    /**< each component [m/s], 0..10; default 0.05 */
    auvid_real_t asymmetry;  /**< of drag, relative, 0..1; default 0.12 */
    auvid_real_t cross;      /**< sway by yaw rate, yaw by sway, lift, relative to drag, 0..1;
                                  default 0.15 */
    auvid_real_t force;      /**< constant, relative to tau_max, 0..1; default 0.03. In roll and
                                pitch it is gravity_m */
    auvid_real_t arm_m;      /**< lever arm of the DVL, ahead and aside, and in a model of roll or
                                pitch its height [m], 0..1; default 0.05 */
    auvid_real_t mount_rad;  /**< pitch and yaw of the DVL in the vehicle, in a model of roll or
                                pitch only [rad], 0..1; default 0.015 */
    auvid_real_t dvl_late_s; /**< delay of the DVL against the attitude [s], 0..1; default 0.05 */
    auvid_real_t filter_s;   /**< time constant of a filter of the velocity in the world's axes,
                                  as of an autopilot's [s], 0..1; default 0.05 */
    auvid_real_t response_s2; /**< of AUVID_UNCERTAIN_FORCE_RESPONSE and that of the moments
                                   [s^2], 0..1; default 0.02: a delay of 0.2 s, or a filter with
                                   0.14 s */
    auvid_real_t gravity_m;  /**< centre of gravity ahead and aside [m], 0..1; default 0.01 */
    auvid_real_t cross_flow; /**< part of the quadratic drag that follows the whole speed instead
                                  of that of its axis, 0..1; default 0.5 */
    auvid_real_t nominal_lag_s; /**< no deviation, but the first-order lag of the propellers' speed
                                     [s], 0.01..1; default 0.15 */
    bool fractions; /**< commands are fractions of the thruster's largest force in their direction,
                         as on CAN; default: newtons */
} auvid_uncertain_config_t;

/** Scale of the priors above which the inputs are so much less exact than configured that the
 * estimate without uncertain inputs is better. auvid_identifier_estimate then returns that one, and
 * nothing is identifiable. */
#define AUVID_UNCERTAIN_CONTRADICTED AUVID_C(3.0)

/** Time in which thrust sags by auvid_uncertain_config_t.sag [s]. */
#define AUVID_UNCERTAIN_SAG_S AUVID_C(240.0)

/** Columns of all equations together; numbers of their R factors. Beside the inputs there is room
 * for Girona500's 27 columns of parameters and thrust, or the 47 of a BlueROV2 Heavy. A constant
 * force among the parameters takes the place of that input. */
#if AUVID_MAX_UNCERTAIN == 0 /* nothing is attached */
#define AUVID_UNCERTAIN_COLUMNS 1
#define AUVID_UNCERTAIN_FACTOR 1
#define AUVID_UNCERTAIN_ORDER 1
#elif AUVID_MAX_PARAMETERS >= 22
#define AUVID_UNCERTAIN_COLUMNS (AUVID_MAX_UNCERTAIN + 47)
#define AUVID_UNCERTAIN_FACTOR (AUVID_UNCERTAIN_COLUMNS * (AUVID_UNCERTAIN_COLUMNS + 6) / 12 + 56)
#else
#define AUVID_UNCERTAIN_COLUMNS (AUVID_MAX_UNCERTAIN + 27)
#define AUVID_UNCERTAIN_FACTOR (AUVID_UNCERTAIN_COLUMNS * (AUVID_UNCERTAIN_COLUMNS + 4) / 8 + 40)
#endif
/** Most columns in one equation: gains of all thrusters, 22 other inputs, 5 parameters, and the
 * thrust; with roll and pitch 4 and half of the parameters more. */
#if AUVID_MAX_UNCERTAIN > 0 && AUVID_MAX_PARAMETERS >= 22
#define AUVID_UNCERTAIN_ORDER (AUVID_MAX_THRUSTERS + AUVID_MAX_PARAMETERS / 2 + 18)
#elif AUVID_MAX_UNCERTAIN > 0
#define AUVID_UNCERTAIN_ORDER (AUVID_MAX_THRUSTERS + 28)
#endif
/** Inputs, the thrust of each equation, and the parameters of surge, sway and yaw. */
#define AUVID_UNCERTAIN_CHANNELS (AUVID_MAX_UNCERTAIN + 26)
/** Inputs that belong to one DoF, of all DoF together; their rows. */
#define AUVID_UNCERTAIN_OWN 30
#define AUVID_UNCERTAIN_OWN_ROWS (5 * AUVID_UNCERTAIN_COLUMNS)
/** Order of the joint R factor. */
#define AUVID_UNCERTAIN_JOINT (AUVID_UNCERTAIN_SHARED + AUVID_MAX_PARAMETERS + 1)

/** Classes of causes that motion tells apart. Those of one class look alike. No motion shows the
 * common scale of the thrust, that of the DVL, or an error of heading: they are never found. */
typedef enum {
    AUVID_CAUSE_CURVE,     /**< weaker backward thrust, dead band, another thrust curve */
    AUVID_CAUSE_INFLOW,    /**< thrust lost with speed, or drag of another law */
    AUVID_CAUSE_TIMING,    /**< thrust, DVL or attitude late; lag of the propellers */
    AUVID_CAUSE_MOUNTING,  /**< lever arm or mounting of DVL or IMU; centre of gravity, constant
                                force, force of sway and yaw together */
    AUVID_CAUSE_ASYMMETRY, /**< drag that differs forward and backward */
    AUVID_CAUSE_SAG,       /**< thrust that sags with time, or fouling */
    AUVID_CAUSE_CURRENT,   /**< current, or the pull of a cable */
    AUVID_CAUSE_COUNT
} auvid_cause_class_t;

/** The most important input of a class. */
typedef struct {
    auvid_real_t value; /**< estimate. Thrust curve, sag, current: as in
                             auvid_uncertain_input_t. Inflow: the loss by both laws together, at
                             full thrust [s/m]. Asymmetry: of the drag forward, relative to
                             the mean. Centre of gravity: astern, or to port [m]. Constant force [N,
                             Nm]. Sway and yaw together, lift: relative to drag. Timing: delay of
                             the thrust beyond the nominal lag, or if < 0 before its time stamp [s];
                             0: in between. Lever arm, late DVL, filter: as in
                             auvid_uncertain_input_t */
    auvid_real_t sigma; /**< its standard deviation; 0: this class has no input */
    auvid_real_t share; /**< rms of its force, relative to the thrust of its equation */
    uint8_t input;      /**< which one. Private */
    uint8_t dof;        /**< equation in which its share is largest */
    bool named; /**< more than AUVID_CAUSE_SIGMAS standard deviations from zero, and its share is at
                     least AUVID_CAUSE_SHARE, in an equation whose thrust is at least the same part
                     of the largest force (or moment). Its size is only rough */
    uint8_t reserved[sizeof(auvid_real_t) - 3];
} auvid_cause_t;

/** See named. */
#define AUVID_CAUSE_SIGMAS AUVID_C(4.0)
#define AUVID_CAUSE_SHARE AUVID_C(0.03)

/** What is wrong with the inputs. */
typedef struct {
    uint32_t number;  /**< of the estimate whose data say so; 0: none yet */
    uint32_t differs; /**< bit i: the estimates of parameter i with and without uncertain inputs
                           differ by more than both half-widths */
    auvid_cause_t cause[AUVID_CAUSE_COUNT]; /**< by auvid_cause_class_t */
    auvid_real_t asymmetry[AUVID_DOF_COUNT]; /**< of the drag: forward it is so much larger than
                                                  the mean of both directions, relative to that;
                                                  backward so much smaller */
    auvid_real_t asymmetry_sigma[AUVID_DOF_COUNT]; /**< its standard deviation; 0: not known */
    /* what a unit of it adds to linear and quadratic drag forward, then takes from them backward,
       relative to the drag at 1 m/s or rad/s */
    auvid_real_t one_way[AUVID_DOF_COUNT][2][2];
    uint8_t order[AUVID_CAUSE_COUNT];       /**< the named classes; the first moves masses and drag
                                                 most: the largest share, where those of mounting,
                                                 inflow and current count half */
    uint8_t named;                          /**< their number */
    bool contradicted;                      /**< see auvid_uncertain_t; then no class is named */
    bool thrust_differs;                    /**< likewise: the thrusters' forces (command) do not
                                                 make the wrench */
    uint8_t reserved[AUVID_GAP(sizeof(auvid_real_t), AUVID_CAUSE_COUNT + 3)];
} auvid_causes_t;

/** An equation: its columns are own inputs, shared inputs, parameters, thrust. Private. */
typedef struct {
    uint16_t factor_at, row_at, channel_at; /* its R factors; a row; inputs and thrust */
    uint16_t own_rows_at;                   /* rows of its own inputs in the solution */
    uint8_t own_at;                         /* its own inputs */
    uint8_t own, inputs;                    /* number of own inputs; of own and shared ones */
    uint8_t channels; /* inputs, thrust, and what current and mounting change in the columns of its
                         parameters */
    uint8_t order;    /* all columns; 0: not modelled */
    uint8_t reserved;
} auvid_uncertain_equation_t;

/** Rows under construction, and those being rotated into the R factors. Private. */
typedef struct {
    uint32_t n; /* number of the last cell since the last gap */
    uint32_t since_gap;
    uint16_t pending; /* bit 2 j + band: to be rotated */
    uint8_t successive[AUVID_DOF_COUNT];
    uint8_t begun_before; /* rows under construction that began before begin_us */
    uint8_t slot;         /* of the newest row under construction */
    uint8_t complete;     /* slot of the row that the cell completes */
    uint8_t dofs;         /* that have this row */
    uint8_t waits;        /* is the last cell to be added? 1: yes, 2: its channels are formed */
    bool completes, counts;
    bool takes_rows;
    auvid_real_t accumulator[AUVID_MAX_OVERLAP][AUVID_UNCERTAIN_CHANNELS];
    auvid_real_t previous[AUVID_METRIC_LAGS][AUVID_UNCERTAIN_COLUMNS];
    auvid_real_t band[AUVID_METRIC_BANDS][AUVID_UNCERTAIN_COLUMNS];
    auvid_real_t channel[AUVID_UNCERTAIN_CHANNELS]; /* of the last cell */
    auvid_real_t speed[AUVID_MAX_THRUSTERS];        /* sqrt of force, behind the nominal lag */
    auvid_real_t lagged[AUVID_MAX_THRUSTERS];       /* behind the lag as last estimated */
    /* over each cell of the recorder: mean force [N], and what it loses with the lag [N/s] */
    auvid_real_t response[AUVID_RECORDER_CELLS][AUVID_MAX_THRUSTERS][2];
    auvid_real_t force[AUVID_MAX_THRUSTERS], lag_slope[AUVID_MAX_THRUSTERS]; /* of the last cell */
    auvid_real_t rate[AUVID_MAX_THRUSTERS]; /* of the force [N/s] */
    auvid_real_t curvature[AUVID_MAX_THRUSTERS]; /* its second derivative [N/s^2] */
    auvid_real_t spread;                    /* of the interpolation at the last cell */
    auvid_real_t elapsed;                   /* since begin_us, over AUVID_UNCERTAIN_SAG_S */
    auvid_real_t wrench, difference; /* squares of the wrench; of the thrusters' less the wrench */
} auvid_uncertain_rows_t;

/** One DoF's part of a pass. Private. */
typedef struct {
    uint8_t drag_at[2]; /* columns of drag; order: there is none */
    uint8_t sag_at;     /* column of sag; order: there is none */
    uint8_t mass_at;    /* column of the mass; below inputs: there is none */
    uint8_t reserved[4];
    union {
        auvid_real_t factor[AUVID_UNCERTAIN_ORDER * (AUVID_UNCERTAIN_ORDER + 1) / 2];
        auvid_regressor_t regressor; /* before the first row */
    };
    auvid_real_t value[AUVID_UNCERTAIN_ORDER];    /* of its columns, at the last pass */
    auvid_real_t residual[AUVID_UNCERTAIN_ORDER]; /* their coefficients in the residual */
    auvid_real_t slope[AUVID_UNCERTAIN_ORDER];    /* what the residual adds to each column */
    auvid_real_t drag[2][AUVID_UNCERTAIN_ORDER];  /* part of each input that is linear, quadratic
                                                     drag */
    auvid_real_t own_side[8];                     /* see auvid_uncertain_solve.c */
    auvid_real_t squares;                         /* of its residuals, over the noise */
    auvid_real_t scale[AUVID_METRIC_BANDS];       /* of its rows: 1 / noise */
} auvid_uncertain_part_t;

/** The solution under way. Private. Whole numbers first, eight bytes at a time: then no gap
 * follows a real (checkpoint.h). */
typedef struct {
    uint16_t row, spent;
    uint8_t phase, pass, dof;
    bool solving;
    uint32_t strong; /* of the instruments, bit i: parameter i is strong; 0: rows not projected */
    auvid_optimizer_work_t searched;
    bool not_converged;
    uint8_t reserved[7];
    auvid_real_t joint[AUVID_UNCERTAIN_JOINT * (AUVID_UNCERTAIN_JOINT + 1) / 2];
    auvid_real_t own_rows[AUVID_UNCERTAIN_OWN_ROWS];
    auvid_real_t side[AUVID_DOF_COUNT][AUVID_UNCERTAIN_JOINT]; /* see auvid_uncertain_solve.c */
    auvid_real_t squares, known;                               /* for the scale of the priors */
    auvid_real_t sag_from; /* where its time is 0, over AUVID_UNCERTAIN_SAG_S */
    auvid_real_t weight;   /* of the squares in the search's cost */
    auvid_causes_t causes; /* under construction */
    auvid_uncertain_part_t part;
} auvid_uncertain_solution_t;

/** Uncertain inputs. The caller owns it; only the functions write. */
typedef struct auvid_uncertain {
    union {
        auvid_uncertain_config_t cfg;
        auvid_refusal_t refusal; /**< what attaching was refused for; not after AUVID_OK */
    };
    auvid_identifier_t *id;
    const auvid_allocation_t *allocation;
    struct auvid_instruments *instruments;                                  /* NULL: none */
    uint32_t (*strong)(struct auvid_uncertain *u, const auvid_metric_t *m); /* of these */
    const struct auvid_checkpoint_part *checkpoint; /* how a checkpoint is checked */
    auvid_uncertain_equation_t equation[AUVID_DOF_COUNT];
    uint8_t code[AUVID_FILLED(AUVID_UNCERTAIN_CHANNELS)]; /* what each input is */
    uint16_t place[AUVID_UNCERTAIN_CHANNELS]; /* where its channel is, and that of the thrust */
    uint8_t moved[AUVID_UNCERTAIN_SHIFTS];    /* equations that input CURRENT_X + k changes */
    uint8_t fixes;       /* equations with a fixed parameter that is not 0, bit j */
    uint8_t reserved[AUVID_GAP(2, AUVID_UNCERTAIN_SHIFTS + 1)];
    uint16_t section[5]; /* ends of the channels: none; of forces, formed from motion, then from
                            thrust; of moments likewise */
    /* state: from here on, see checkpoint.h */
    uint64_t begin_us;         /* of the first cell of the rows; 0: none */
    auvid_sample_t cell;       /* the last one */
    auvid_estimate_t estimate; /* read auvid_identifier_estimate */
    auvid_uncertain_rows_t recorded;
    auvid_uncertain_solution_t work;
    auvid_real_t factor[AUVID_METRIC_BANDS][AUVID_UNCERTAIN_FACTOR];
    auvid_real_t rows[AUVID_DOF_COUNT]; /* in the R factors */
    /* products of linear, then of quadratic drag with own inputs, then with both drags of each DoF,
       over rows from before the first solution */
    auvid_real_t forgotten[2][AUVID_UNCERTAIN_OWN + 2 * AUVID_DOF_COUNT];
    auvid_real_t linear[AUVID_DOF_COUNT];        /* part of the drag at 1 m/s or rad/s */
    auvid_real_t hidden[AUVID_DOF_COUNT][2];     /* linear and quadratic drag of the hull, more than
                                                    that of its parameters: the asymmetry's */
    auvid_real_t half_length_m;                  /* half of the length, roughly [m] */
    auvid_real_t pi[AUVID_MAX_PARAMETERS];       /* last solution */
    auvid_real_t shared[AUVID_UNCERTAIN_SHARED]; /**< estimates by auvid_uncertain_input_t, valid
                                                      if estimate.number > 0; 0: no column */
    auvid_real_t own[AUVID_UNCERTAIN_OWN];
    auvid_real_t scale;    /**< of all priors: the one that fits best, limited to 0.5..2 */
    auvid_causes_t causes; /* read auvid_uncertain_causes */
    bool excited;          /* the rows are of the excitation, not of a passive vehicle */
    uint8_t informed;      /* whose estimate the columns of motion are: 0: no solution's, 1: the
                              first one's, 2: a later one's */
    bool contradicted;     /**< the best scale exceeds AUVID_UNCERTAIN_CONTRADICTED: no estimate */
    bool given;            /* by auvid_uncertain_start: pi, shared, own, scale */
    bool fresh;            /* there are rows that the last solution did not have */
    bool gave_set;         /* excited, and a DoF has had the rows of a set */
} auvid_uncertain_t;

#define auvid_uncertain_defaults AUVID_SIZED(auvid_uncertain_defaults)
/** Fill *cfg with the defaults, for thrusters known from a data sheet. NULL is a no-op. */
void auvid_uncertain_defaults(auvid_uncertain_config_t *cfg);

#define auvid_identifier_attach_uncertain AUVID_SIZED(auvid_identifier_attach_uncertain)
/** Attach the uncertain inputs, once, after auvid_identifier_init and before the first step or
 * recorded wrench. After an error the identifier is as before. storage->refusal then names the
 * refused field of *cfg, or the macro of config.h with what it should be ("thrusters": of the
 * allocation), its value and its limit, except after AUVID_ERR_NULL, AUVID_ERR_STATE,
 * AUVID_ERR_ATTACHED and AUVID_ERR_STARTED, which leave *storage as it was.
 * @param storage written; must outlive the identifier
 * @param cfg copied
 * @param allocation the thrusters; must outlive the identifier. A scale of the wrench that is
 * auvid's choice (metric.tau_max 0) becomes what they give
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_ATTACHED (some are
 * attached already); AUVID_ERR_STARTED (it has stepped, or recorded a wrench); AUVID_ERR_MODEL (not
 * a model of the regressor path); AUVID_ERR_SIZE (more columns than AUVID_MAX_UNCERTAIN,
 * for which config.h has examples; no thruster; AUVID_MAX_COMMANDS < AUVID_MAX_THRUSTERS);
 * AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE. */
auvid_status_t auvid_identifier_attach_uncertain(auvid_identifier_t *id, auvid_uncertain_t *storage,
                                                 const auvid_uncertain_config_t *cfg,
                                                 const auvid_allocation_t *allocation);

#define auvid_uncertain_start AUVID_SIZED(auvid_uncertain_start)
/** Start with the solution of another identification of the same vehicle. Call it between attaching
 * and the first step or recorded wrench. The columns of current, lever arm and late DVL are formed
 * with the last solution, so those of the first sets are wrong without one: replay a log twice.
 * @param uncertain attached
 * @param known has an estimate; may be a copy
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (`uncertain` is not attached, or `known` has no
 * estimate); AUVID_ERR_STARTED (the identifier has stepped, or recorded a wrench); AUVID_ERR_MODEL
 * (their columns differ). After an error nothing has changed. Cost: O(columns). */
auvid_status_t auvid_uncertain_start(auvid_uncertain_t *uncertain, const auvid_uncertain_t *known);

#define auvid_uncertain_causes AUVID_SIZED(auvid_uncertain_causes)
/** Copy what is wrong with the inputs, by the last solution. It stays while the next one is under
 * way. Nothing is named if a parameter depends on one at its bound: the inputs then take a part of
 * what the bound forbids.
 * @param causes written if AUVID_OK
 * @return AUVID_OK; AUVID_ERR_NO_DATA (no solution yet, or none since a change of the vehicle);
 * AUVID_ERR_NULL. Cost: O(1). */
auvid_status_t auvid_uncertain_causes(const auvid_uncertain_t *u, auvid_causes_t *causes);

#define auvid_causes_drag AUVID_SIZED(auvid_causes_drag)
/** Drag force of one degree of freedom in one direction: as auvid_estimate_drag, whose force is
 * that of one curve for both directions, with the asymmetry of the hull. It is identifiable only if
 * that one is, too. Where the asymmetry is not known (asymmetry_sigma 0), it is that of the curve:
 * if inputs are contradicted, the model has no drag in this DoF, or the causes came by the bus.
 * @param causes of the same estimate, else the asymmetry is not known
 * @param estimate, vehicle, dof, speed, drag as in auvid_estimate_drag; the estimate may be one of
 * auvid_calibrated_estimate
 * @return as auvid_estimate_drag; AUVID_ERR_NULL also for causes. Cost: O(n), at most 1.7 thousand
 * instructions of a Cortex-M4F for Girona500. */
auvid_status_t auvid_causes_drag(const auvid_causes_t *causes, const auvid_estimate_t *estimate,
                                 const auvid_vehicle_t *vehicle, auvid_dof_t dof,
                                 auvid_real_t speed, auvid_drag_t *drag);

#define auvid_causes_sentence AUVID_SIZED(auvid_causes_sentence)
/** Write one sentence on what is wrong, with the remedy: "backward thrust is weaker than
 * supplied, by 10 % or so; measure the thrusters astern". The last one lists the parameters in
 * `differs`. Cost: O(size).
 * @param vehicle the model
 * @param which 0, 1, ... : sentence number
 * @param text [size] written, truncated to size and always zero-terminated; empty if there is no
 * such sentence
 * @return AUVID_OK; AUVID_FINISHED (there are not so many sentences); AUVID_ERR_NULL;
 * AUVID_ERR_RANGE (size 0). */
auvid_status_t auvid_causes_sentence(const auvid_causes_t *causes, const auvid_vehicle_t *vehicle,
                                     unsigned which, char *text, size_t size);

/* ---- instruments ---- */

/** Lags of the reference. Fewer are used, the shortest ones, if there is no room for the columns of
 * all; at least two. */
#define AUVID_INSTRUMENT_LAGS 5
/** Columns of all equations together; most in one equation. */
#define AUVID_INSTRUMENT_COLUMNS (6 * AUVID_MAX_PARAMETERS + 8)
#define AUVID_INSTRUMENT_ORDER (AUVID_INSTRUMENT_LAGS * 6 + 1)
/** Numbers of the projected rows: an equation with c instruments and n columns has
 * c n + c (c + 1) / 2. No columns that fit need more than this. */
#define AUVID_INSTRUMENT_FACTOR                                                                    \
    (AUVID_INSTRUMENT_ORDER * AUVID_UNCERTAIN_COLUMNS +                                            \
     (AUVID_INSTRUMENT_ORDER + 1) / 2 * AUVID_INSTRUMENT_COLUMNS)
/** References that wait for the cell of their time. */
#define AUVID_INSTRUMENT_PAST 32

/** A reference. Private. */
typedef struct {
    uint64_t t_us;
    auvid_real_t nu[AUVID_DOF_COUNT];
} auvid_reference_t;

/** Instruments of one DoF. Private. */
typedef struct {
    uint16_t factor_at; /* its rows of the factor of [Z C R z] */
    uint16_t column_at; /* its columns */
    uint8_t count;      /* their number; 0: none */
} auvid_instrument_t;

/**
 * Instruments: what a passive vehicle shows in closed loop, from the reference of its controller.
 *
 * In closed loop the thrust answers each disturbance, so least squares takes part of the
 * disturbance for the vehicle (AUVID_NOTE_FEEDBACK: nothing is identifiable). The reference of the
 * controller does not depend on disturbances. Instrumental variables use only the part of motion
 * and thrust that the reference explains. Per DoF j, with the rows of uncertain.h
 *
 *     z_j = R_j pi + C_j b + e_j,
 *
 * instruments Z_j are formed: the columns of the model, at the reference's velocity behind each of
 * up to five first-order lags, 0.3, 1, 3, 10 and 30 s, and a constant. The longest is left out
 * where there is no room for it, as of Girona500. They pass the same smoother. z, R and C are
 * projected onto Z (two-stage least squares), and the solution of uncertain.h takes the projected
 * rows, with its priors and scales, but e as an error of the thrust: projected motion has no noise.
 * The size of e is that of the whole rows; it is larger where the projected ones disagree more
 * (Sargan's test).
 *
 * Only if the wrench is feedback in all DoF (not of single ones: closed_loop in metric_config.h),
 * before any excitation, and if a reference was given. A parameter is strong if the instruments
 * explain its column beyond those of the DoF's other parameters: F of that regression >= 10. The
 * others are not identifiable (AUVID_NOTE_FEEDBACK), nor is a constant force. If none is strong,
 * the estimate is as without instruments. Read it from auvid_identifier_estimate.
 *
 * A reference that is itself computed from measurements is not one: it must be what would be the
 * same in another dive with the same orders. A vehicle that keeps its place shows nothing; let the
 * set points alternate by 0.5 m and 15 degrees each way, every 3 to 12 s.
 *
 *     static auvid_uncertain_t uncertain;
 *     static auvid_instruments_t instruments;
 *     auvid_identifier_attach_uncertain(&id, &uncertain, &inputs, &thrusters);
 *     auvid_identifier_attach_instruments(&id, &instruments);
 *     for each tick: auvid_instruments_reference(&instruments, now_us, reference);
 *
 * Where the inputs are exact, set all deviations of uncertain.h to 0: the estimate is then plain
 * two-stage least squares.
 *
 * Regressor path only. A program without it does not contain it. A checkpoint contains its state.
 * Cost, Girona500: 4 calls of the regressor and 0.8k multiplications in each cell, and 15k for each
 * row, half of them at most in one cell. Memory: sizeof(auvid_instruments_t), 28 KiB with default
 * sizes.
 *
 * Sources: Soederstroem and Stoica 1989, 8; Ljung 1999, 7.6 and 13.5; Shea 1997 (strength), Staiger
 * and Stock 1997 (F of 10); Sargan 1958. None of it is in the paper.
 *
 * The caller owns it; only the functions write.
 */
typedef struct auvid_instruments {
    auvid_uncertain_t *uncertain;
    const struct auvid_checkpoint_part *checkpoint; /* how a checkpoint is checked */
    auvid_instrument_t of[AUVID_DOF_COUNT];
    uint8_t lags; /* in use */
    /* state: from here on, see checkpoint.h */
    uint64_t last_us; /* time of the last reference given */
    auvid_reference_t past[AUVID_INSTRUMENT_PAST];
    uint32_t given;  /* references */
    uint32_t taken;  /* of them, by cells */
    uint32_t strong; /**< bit i: parameter i was strong at the last solution */
    uint8_t waiting; /* bit j: a row of DoF j is to be rotated in */
    uint8_t reserved[3];
    auvid_real_t lagged[AUVID_INSTRUMENT_LAGS][AUVID_DOF_COUNT];
    auvid_real_t channel[AUVID_INSTRUMENT_COLUMNS]; /* of the last cell */
    auvid_real_t accumulator[AUVID_MAX_OVERLAP][AUVID_INSTRUMENT_COLUMNS];
    auvid_real_t factor[AUVID_INSTRUMENT_FACTOR];
    auvid_real_t rows[AUVID_DOF_COUNT];                                    /* in the factor */
    auvid_real_t wide[AUVID_INSTRUMENT_COLUMNS + AUVID_UNCERTAIN_COLUMNS]; /* rows that wait */
} auvid_instruments_t;

#define auvid_identifier_attach_instruments AUVID_SIZED(auvid_identifier_attach_instruments)
/** Attach the instruments, once, after auvid_identifier_attach_uncertain and before the first step
 * or recorded wrench.
 * @param storage written; must outlive the identifier
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not initialised); AUVID_ERR_DETACHED (there
 * are no uncertain inputs); AUVID_ERR_ATTACHED (some are attached already); AUVID_ERR_STARTED (it
 * has stepped, or recorded a wrench); AUVID_ERR_SIZE (more columns than there is room for, even
 * with two lags). After an error nothing has changed. Cost: clears *storage. */
auvid_status_t auvid_identifier_attach_instruments(auvid_identifier_t *id,
                                                   auvid_instruments_t *storage);

#define auvid_instruments_reference AUVID_SIZED(auvid_instruments_reference)
/** Give the reference from t_us on. Call it in each tick, before auvid_identifier_step. References
 * less than half a cell after the last one replace it. Where one comes when cells of its time are
 * complete, or 32 half cells before they are, it counts as 0: weaker, not wrong.
 * @param t_us of the tick [us], in the time of auvid_identifier_step
 * @param velocity [AUVID_DOF_COUNT] of the reference, along its own axes [m/s, rad/s], in magnitude
 * up to AUVID_RECORDER_LARGEST: of a set point that moves, or is filtered, its velocity; 0 where
 * nothing is commanded
 * @return AUVID_OK; AUVID_ERR_NULL; AUVID_ERR_STATE (not attached: all zeros);
 * AUVID_ERR_NOT_FINITE; AUVID_ERR_RANGE; AUVID_ERR_TIME_BACK, AUVID_ERR_TIME_SAME (the time did not
 * advance). One that is refused changes nothing. Cost: O(1). */
auvid_status_t auvid_instruments_reference(auvid_instruments_t *instruments, uint64_t t_us,
                                           const auvid_real_t *velocity);

#ifdef __cplusplus
}
#endif

#endif
