/* Exact flow of x' = A x + B u, y = C x + D u over a step in which every input is a cubic polynomial of time.

   Written by inerter. model.h has NX, NU, NR, NY, A, B, C and D. The inputs of a step are u and its first three derivatives
   at its begin; at its end, the inputs are those polynomials there.

   NR reactions of friction and gaps are such that their laws hold at the end of a step. From their values at its begin they
   change as ramps, so that what sticks beside a light damper does not creep. A step in which one of them changes its
   state is halved, down to 2^(1 - LEVELS) of the whole, where reactions are held; the flows of its parts are powers of
   each other. Reactions at an instant are those of the smallest step from there. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

#define ORDERS 4
#define HELD (NX + ORDERS * NU) /* columns of the reactions, and of their rates */
#define WIDTH (HELD + 2 * NR)
#define SWEEPS 10000
#define LONGEST 1e-4 /* s, with reactions */
#if NR > 0
#define LEVELS 11
#else
#define LEVELS 1
#endif
#define TERMS 20

typedef struct {
    double time;
    double x[NX + 1];
    double u[ORDERS][NU + 1];
    double r[NR + 1]; /* in tension */
} State;

typedef struct {
    double flow[NX + 1][WIDTH + 1];
    double held[NR + 1][NR + 1]; /* weights of reactions in the motions of friction and gaps at the end of the step */
    double ramp[NR + 1][NR + 1]; /* and of reactions that grow to them from zero */
} Flow;

typedef struct {
    State now;
    double step; /* of the first flow; 0 for none. Each flow is of half the step of that before */
    Flow flows[LEVELS];
} Model;

static void multiply(const double *a, const double *b, double *c)
{
    int i, j, k;
    for (i = 0; i < WIDTH * WIDTH; i++) c[i] = 0.0;
    for (i = 0; i < WIDTH; i++)
        for (k = 0; k < WIDTH; k++) {
            const double value = a[i * WIDTH + k];
            if (value != 0.0)
                for (j = 0; j < WIDTH; j++) c[i * WIDTH + j] += value * b[k * WIDTH + j];
        }
}

static void keep(Flow *flow, const double *whole, double step)
{
    int i, j, k;
    for (i = 0; i < NX; i++)
        for (j = 0; j < WIDTH; j++) flow->flow[i][j] = whole[i * WIDTH + j];
    for (i = 0; i < NR; i++)
        for (j = 0; j < NR; j++) {
            flow->held[i][j] = flow->ramp[i][j] = Q[i][NX + NU + j];
            for (k = 0; k < NX; k++) {
                flow->held[i][j] += Q[i][k] * flow->flow[k][HELD + j];
                flow->ramp[i][j] += Q[i][k] * flow->flow[k][HELD + NR + j] / step;
            }
        }
}

/* The exponential of the matrix of states and inputs, by a Taylor polynomial and repeated squaring. 0 if memory lacks. */
static int discretise(Model *model, double step)
{
    const size_t size = (size_t)WIDTH * WIDTH + 1;
    double *m = calloc(3 * size, sizeof(double)), *sum, *other, *swap, norm = 0.0;
    int i, j, k, halvings = 0;
    if (m == NULL) return 0;
    sum = m + size;
    other = sum + size;
    for (i = 0; i < NX; i++) {
        for (j = 0; j < NX; j++) m[i * WIDTH + j] = step * A[i][j];
        for (j = 0; j < NU; j++) m[i * WIDTH + NX + j] = step * B[i][j];
        for (j = 0; j < NR; j++) m[i * WIDTH + HELD + j] = step * B[i][NU + j];
    }
    for (i = NX; i < NX + (ORDERS - 1) * NU; i++) m[i * WIDTH + i + NU] = step;
    for (i = HELD; i < HELD + NR; i++) m[i * WIDTH + i + NR] = step;
    for (i = 0; i < WIDTH; i++) {
        double row = 0.0;
        for (j = 0; j < WIDTH; j++) row += fabs(m[i * WIDTH + j]);
        if (row > norm) norm = row;
    }
    while (halvings < LEVELS - 1 || ldexp(norm, -halvings) > 0.5) halvings++;
    for (i = 0; i < WIDTH * WIDTH; i++) m[i] = ldexp(m[i], -halvings);
    for (i = 0; i < WIDTH; i++) sum[i * WIDTH + i] = 1.0;
    for (k = TERMS; k > 0; k--) { /* I + m/1 (I + m/2 (I + ...)) */
        multiply(m, sum, other);
        for (i = 0; i < WIDTH * WIDTH; i++) other[i] /= k;
        for (i = 0; i < WIDTH; i++) other[i * WIDTH + i] += 1.0;
        swap = sum, sum = other, other = swap;
    }
    for (k = halvings; k >= 0; k--) { /* the flow of step / 2^k */
        if (k < LEVELS) keep(&model->flows[k], sum, ldexp(step, -k));
        if (k == 0) break;
        multiply(sum, sum, other);
        swap = sum, sum = other, other = swap;
    }
    model->step = step;
    free(m);
    return 1;
}

/* Reactions by their laws, from the motions that there would be without any; by Gauss-Seidel from the last ones. */
static void react(double weight[][NR + 1], double *r, const double *free_motion)
{
    int i, j, sweep;
    for (sweep = 0; sweep < SWEEPS; sweep++) {
        double change = 0.0, size = 0.0;
        for (i = 0; i < NR; i++) {
            const double own = weight[i][i], before = r[i];
            double motion = free_motion[i];
            for (j = 0; j < NR; j++)
                if (j != i) motion += weight[i][j] * r[j];
            if (!(own < 0.0)) continue;
            if (GAP[i]) r[i] = motion > HIGH[i] ? (HIGH[i] - motion) / own : motion < LOW[i] ? (LOW[i] - motion) / own : 0.0;
            else r[i] = fmin(fmax(-motion / own, LOW[i]), HIGH[i]);
            change = fmax(change, fabs(r[i] - before));
            size = fmax(size, fabs(r[i]));
        }
        if (change <= 1e-14 * size) return;
    }
}

/* -1, 0 or 1 of a friction that slips down, sticks or slips up, and of a gap in contact or not. */
static int contact(const double *r, int i)
{
    if (GAP[i]) return (r[i] > 0.0) - (r[i] < 0.0);
    return (r[i] >= HIGH[i]) - (r[i] <= LOW[i]);
}

/* The end of a step from a state, with the reactions there; these are held, or ramps from those of the state. */
static void follow(Flow *flow, double step, int held, State *now)
{
    double next[NX + 1], motion[NR + 1], before[NR + 1];
    int i, j, k;
    for (i = 0; i < NX; i++) {
        next[i] = 0.0;
        for (j = 0; j < NX; j++) next[i] += flow->flow[i][j] * now->x[j];
        for (k = 0; k < ORDERS; k++)
            for (j = 0; j < NU; j++) next[i] += flow->flow[i][NX + k * NU + j] * now->u[k][j];
    }
    for (j = 0; j < NU; j++) {
        double *const u[ORDERS] = {&now->u[0][j], &now->u[1][j], &now->u[2][j], &now->u[3][j]};
        *u[0] += step * (*u[1] + step * (*u[2] / 2.0 + step * *u[3] / 6.0));
        *u[1] += step * (*u[2] + step * *u[3] / 2.0);
        *u[2] += step * *u[3];
    }
    for (i = 0; i < NR; i++) {
        before[i] = now->r[i];
        motion[i] = 0.0;
        for (j = 0; j < NX; j++) motion[i] += Q[i][j] * next[j];
        for (j = 0; j < NU; j++) motion[i] += Q[i][NX + j] * now->u[0][j];
        if (!held)
            for (j = 0; j < NR; j++) motion[i] += (flow->held[i][j] - flow->ramp[i][j]) * now->r[j];
    }
    if (NR > 0) react(held ? flow->held : flow->ramp, now->r, motion);
    for (i = 0; i < NX; i++) {
        now->x[i] = next[i];
        for (j = 0; j < NR; j++) {
            const double first = held ? now->r[j] : before[j];
            now->x[i] += flow->flow[i][HELD + j] * first;
            now->x[i] += flow->flow[i][HELD + NR + j] * (now->r[j] - first) / step;
        }
    }
}

/* Reactions at the instant of a state: what they are in the smallest step from there. */
static void look(Model *model)
{
    State trial = model->now;
    if (NR == 0) return;
    follow(&model->flows[LEVELS - 1], ldexp(model->step, 1 - LEVELS), 1, &trial);
    memcpy(model->now.r, trial.r, sizeof trial.r);
}

static void advance_part(Model *model, double step, int level)
{
    const State before = model->now;
    int i, changed = 0;
    follow(&model->flows[level], step, level == LEVELS - 1, &model->now);
    for (i = 0; i < NR; i++) changed |= contact(before.r, i) != contact(model->now.r, i);
    if (changed && level < LEVELS - 1) {
        model->now = before;
        advance_part(model, step / 2.0, level + 1);
        advance_part(model, step / 2.0, level + 1);
        return;
    }
    look(model);
}

static int advance(Model *model, double step)
{
    const int parts = NR > 0 ? (int)ceil(step / LONGEST - 1e-9) : 1;
    const double part = step / parts, begin = model->now.time;
    int i;
    if (part != model->step && !discretise(model, part)) return 0;
    look(model); /* inputs may have jumped */
    for (i = 0; i < parts; i++) advance_part(model, part, 0);
    model->now.time = begin + step;
    return 1;
}

static double output(const Model *model, int number)
{
    double y = 0.0;
    int j;
    for (j = 0; j < NX; j++) y += C[number][j] * model->now.x[j];
    for (j = 0; j < NU; j++) y += D[number][j] * model->now.u[0][j];
    for (j = 0; j < NR; j++) y += D[number][NU + j] * model->now.r[j];
    return y;
}

static void rest(Model *model)
{
    memset(&model->now, 0, sizeof model->now);
}
