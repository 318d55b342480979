/**
 * @file fossen.h
 * Vehicle model in six degrees of freedom (Fossen 2011), linear in its parameters:
 *
 *     M nu' + C(nu) nu + D(nu) nu + g(eta) = tau
 *
 * - M = M_RB + M_A of a vehicle with port-starboard symmetry; C(nu) belongs to this M (Fossen 2011,
 *   Eq. 3.46).
 * - D is linear and quadratic drag in the velocity of the same degree of freedom.
 * - g contains weight and buoyancy.
 *
 * Data of motion and wrench determine only certain sums of the textbook's coefficients. These sums
 * are the parameters, and their names show the terms. A mass is m - X_udot; m and X_udot are not
 * separable. The effects of W and z_G appear in W-B and z_G W - z_B B.
 *
 * Any parameter may be free; the configuration fixes the others (metric_config.h: `free`, `fixed`).
 * By default 20 are free: masses, inertias, W-B, z_G W - z_B B and all drags. Then the vehicle is
 * trimmed and its other couplings are zero. The model has no products of inertia.
 *
 * The model exists if AUVID_MAX_PARAMETERS is at least 22. From 26 on it has the couplings of
 * forces and moments in M, from 32 on a constant force or moment in each degree of freedom. Models
 * that wrap it add parameters of their own: current.h 2 or 3, thrusters.h 4 for each group. The
 * sizes 24, 25 and 28 to 31 leave room for them; 32 does not. The other sizes follow, with room for
 * all parameters free: where memory is short, AUVID_MAX_FACTOR 322 and AUVID_MAX_COLUMNS 59 suffice
 * for those that are free by default. An unused model is not linked.
 *
 * With p = q = 0, no couplings in M, and the centre of gravity vertically below the centre of
 * buoyancy, the equations of surge, sway, heave and yaw are those of Girona500 (vehicle.h).
 *
 * The regressor costs 400 instructions of a Cortex-M4F (Girona500's 210), 470 with the couplings,
 * and 64 bytes of stack. The code of the model takes 1.6 KiB. The acceleration is not finite in a
 * degree of freedom without positive mass. Nor is it finite in two degrees of freedom
 * whose coupling makes M not positive definite.
 *
 * Signs are the paper's (types.h): a drag that dissipates is negative. Much of the literature
 * prints the same numbers as positive.
 */
#ifndef AUVID_FOSSEN_H
#define AUVID_FOSSEN_H

#include "auvid/types.h"
#include "auvid/vehicle.h"

#ifdef __cplusplus
extern "C" {
#endif

#if AUVID_MAX_PARAMETERS >= 22

/** Parameters, in the order of pi. */
typedef enum {
    AUVID_FOSSEN_M_U, /**< m - X_udot [kg] */
    AUVID_FOSSEN_M_V, /**< m - Y_vdot */
    AUVID_FOSSEN_M_W, /**< m - Z_wdot */
    AUVID_FOSSEN_M_P, /**< I_x - K_pdot [kg m2] */
    AUVID_FOSSEN_M_Q, /**< I_y - M_qdot */
    AUVID_FOSSEN_M_R, /**< I_z - N_rdot */
    AUVID_FOSSEN_W_B, /**< W - B [N] */
    AUVID_FOSSEN_X_G, /**< x_G W - x_B B [Nm] */
    AUVID_FOSSEN_Y_G, /**< y_G W - y_B B [Nm] */
    AUVID_FOSSEN_Z_G, /**< z_G W - z_B B [Nm]; > 0 rights the vehicle */
    AUVID_FOSSEN_X_U, /**< linear drag of the six degrees of freedom [N s/m], [Nm s] */
    AUVID_FOSSEN_Y_V,
    AUVID_FOSSEN_Z_W,
    AUVID_FOSSEN_K_P,
    AUVID_FOSSEN_M_Q_DRAG, /**< M_q */
    AUVID_FOSSEN_N_R,
    AUVID_FOSSEN_X_UU, /**< quadratic drag [N s2/m2], [Nm s2] */
    AUVID_FOSSEN_Y_VV,
    AUVID_FOSSEN_Z_WW,
    AUVID_FOSSEN_K_PP,
    AUVID_FOSSEN_M_QQ,
    AUVID_FOSSEN_N_RR,
#if AUVID_MAX_PARAMETERS >= 26
    AUVID_FOSSEN_M_UQ, /**< m z_G - X_qdot [kg m]: surge and pitch */
    AUVID_FOSSEN_M_VP, /**< -m z_G - Y_pdot: sway and roll */
    AUVID_FOSSEN_M_VR, /**< m x_G - Y_rdot: sway and yaw */
    AUVID_FOSSEN_M_WQ, /**< -m x_G - Z_qdot: heave and pitch */
#endif
#if AUVID_MAX_PARAMETERS >= 32
    AUVID_FOSSEN_X_0, /**< constant forces [N] and moments [Nm] on the hull. Z_0 and W-B, K_0 and
                           y_G W - y_B B, M_0 and x_G W - x_B B are almost indistinguishable:
                           free one of each pair */
    AUVID_FOSSEN_Y_0,
    AUVID_FOSSEN_Z_0,
    AUVID_FOSSEN_K_0,
    AUVID_FOSSEN_M_0,
    AUVID_FOSSEN_N_0,
#endif
    AUVID_FOSSEN_COUNT
} auvid_fossen_parameter_t;

/** Bits of the parameters that are free by default: the first 22 except x_G W - x_B B and
 * y_G W - y_B B. */
#define AUVID_FOSSEN_FREE 0x3FFE7Fu

/** The model; constant and read-only. */
extern const auvid_vehicle_t auvid_fossen;

/** BlueROV2 Heavy: the same model with the vehicle's name. */
extern const auvid_vehicle_t auvid_bluerov2_heavy;
#define auvid_bluerov2_heavy_benzon AUVID_SIZED0(auvid_bluerov2_heavy_benzon)
/** Parameters of BlueROV2 Heavy in fresh water (von Benzon et al. 2022, "An open-source benchmark
 * simulator: control of a BlueROV2 underwater robot", J. Mar. Sci. Eng. 10). */
extern const auvid_real_t auvid_bluerov2_heavy_benzon[AUVID_FOSSEN_COUNT];

#endif

#ifdef __cplusplus
}
#endif

#endif
