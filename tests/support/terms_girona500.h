/**
 * @file terms_girona500.h
 * Shared by the tests of tables of terms: Eq. 12-15 of the Girona500 as a table, with the
 * parameters of auvid_girona500 and in their order, so that sums have the same rounding errors.
 */
#ifndef TERMS_GIRONA500_H
#define TERMS_GIRONA500_H

#include "auvid/vehicle.h"

#define G500_TERM(parameter, dof, sign, ...)                                                       \
    {                                                                                              \
        AUVID_G500_##parameter, AUVID_##dof, sign,                                                 \
        {                                                                                          \
            __VA_ARGS__                                                                            \
        }                                                                                          \
    }
#define IS(name) AUVID_FACTOR_##name

static const auvid_term_t terms_girona500_term[] = {
    G500_TERM(M_U, SURGE, 1, IS(U_DOT)),
    G500_TERM(M_V, SURGE, -1, IS(V), IS(R)),
    G500_TERM(M_W, SURGE, 1, IS(W), IS(Q)),
    G500_TERM(W_B, SURGE, 1, IS(SIN_THETA)),
    G500_TERM(X_U, SURGE, -1, IS(U)),
    G500_TERM(X_UU, SURGE, -1, IS(ABS_U), IS(U)),
    G500_TERM(M_U, SWAY, 1, IS(U), IS(R)),
    G500_TERM(M_V, SWAY, 1, IS(V_DOT)),
    G500_TERM(M_W, SWAY, -1, IS(W), IS(P)),
    G500_TERM(W_B, SWAY, -1, IS(COS_THETA), IS(SIN_PHI)),
    G500_TERM(Y_V, SWAY, -1, IS(V)),
    G500_TERM(Y_VV, SWAY, -1, IS(ABS_V), IS(V)),
    G500_TERM(M_U, HEAVE, -1, IS(U), IS(Q)),
    G500_TERM(M_V, HEAVE, 1, IS(V), IS(P)),
    G500_TERM(M_W, HEAVE, 1, IS(W_DOT)),
    G500_TERM(W_B, HEAVE, -1, IS(COS_THETA), IS(COS_PHI)),
    G500_TERM(Z_W, HEAVE, -1, IS(W)),
    G500_TERM(Z_WW, HEAVE, -1, IS(ABS_W), IS(W)),
    G500_TERM(M_U, YAW, -1, IS(U), IS(V)),
    G500_TERM(M_V, YAW, 1, IS(U), IS(V)),
    G500_TERM(M_R, YAW, 1, IS(R_DOT)),
    G500_TERM(N_R, YAW, -1, IS(R)),
    G500_TERM(N_RR, YAW, -1, IS(ABS_R), IS(R)),
    G500_TERM(X_0, SURGE, -1, IS(ONE)),
    G500_TERM(Y_0, SWAY, -1, IS(ONE)),
    G500_TERM(Z_0, HEAVE, -1, IS(ONE)),
    G500_TERM(N_0, YAW, -1, IS(ONE)),
};

#undef IS
#undef G500_TERM

static inline auvid_term_table_t terms_girona500(void)
{
    return (auvid_term_table_t){
        .name = "Girona500, terms",
        .parameter = auvid_girona500.parameter,
        .term = terms_girona500_term,
        .terms = sizeof terms_girona500_term / sizeof terms_girona500_term[0],
        .parameters = auvid_girona500.parameters,
    };
}

#endif
