/* Exact flow of x' = A x + B u, y = C x + D u over a step in which every input is a cubic polynomial of time.

   Written by inerter. model.h has the sizes, and A, B, C, D and Q for the values that the parameters have at first; for
   others they follow from the equations in ENTRIES. The inputs of a step are e and its first three derivatives at its
   begin; at its end, the inputs are those polynomials there. Of them u are the inputs of the matrices, some of them late.

   NR reactions of friction and gaps are such that their laws hold at the end of a step. From their values at its begin they
   change as ramps, so that what sticks beside a light damper does not creep. A step in which one of them changes its
   state is halved, down to HELD_FROM, where reactions are held, or to the last of LEVELS around the strokes of a gap. The
   flows of its parts are powers of each other. So is one that is long for a light mass, at which ramps would ring: an error
   changes its sign with every step and never decays; and one over which the reaction of a contact is not straight, as on a
   stiff stop. Reactions at an instant are those of a step of GLANCE from there. A friction that CREEPS is at a node that
   only springs hold: its force moves the node at once, and its law is about its elongation, which slip alone changes. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

#define ORDERS 4
#define SOME(n) ((n) + !(n)) /* no array is empty */
#define NI (NU + NR)
#define HELD (NX + ORDERS * NU) /* columns of the reactions, and of their rates */
#define WIDTH (HELD + 2 * NR)
#define HEIGHT (NETA + NX + NY + NR) /* of the equations: balance, rates, outputs, motions of friction and gaps */
#define SPAN (NETA + NX + NI)
#define SWEEPS 10000
#define LONGEST 2e-5 /* s, with reactions */
#define MOST 1e9 /* such steps in one */
#define GLANCE (LONGEST / 65536.0)
#if NR > 0
#define LEVELS 16
#else
#define LEVELS 1
#endif
#define HELD_FROM 8 /* level of the shortest steps, but for those at the strokes of a gap */
#define RINGING 1e-4 /* of the largest share of reactions in an output */
#define BENT 1e-5 /* of the largest of a reaction so far */
#define TERMS 20
#define WORST 1e-9 /* error of a row of the matrices by rounding, of its largest entry */
#define KEPT 6 /* flows of so many lengths of steps */
#define BITS 36 /* of a length between two breaks of late inputs, so that rounding makes no new ones */

typedef struct {
    double begin;
    double e[ORDERS][NE + 1];
} Segment; /* inputs of a step */

typedef struct {
    double time;
    double x[NX + 1];
    double e[ORDERS][NE + 1];
    double u[ORDERS][NU + 1];
    double r[NR + 1]; /* in tension */
    double place[NR + 1]; /* elongation of a friction that creeps, which only its slip changes */
    double p[NP + 1];
    double largest[NY + 1]; /* share of the reactions in each output so far */
    double strongest[NR + 1]; /* of each reaction so far */
    double mean; /* of the force of a strut over the last step */
    int stale; /* whether u and r are not yet those of this instant */
    int given; /* whether an input was ever set that is not a motion */
    size_t count; /* of segments */
} State;

typedef struct {
    double flow[NX + 1][WIDTH + 1];
    double held[NR + 1][NR + 1]; /* weights of reactions in the motions of friction and gaps at the end of the step */
    double ramp[NR + 1][NR + 1]; /* and of reactions that grow to them from zero */
} Flow;

typedef struct {
    double step; /* of the first; 0 for none. Each is of half the step of that before */
    Flow flows[LEVELS];
} Flows;

typedef struct {
    State now;
    Segment *past; /* what late inputs still need, the oldest first */
    size_t room;
    double p[NP + 1]; /* of the matrices */
    double A[SOME(NX)][SOME(NX)], B[SOME(NX)][SOME(NI)], C[SOME(NY)][SOME(NX)], D[SOME(NY)][SOME(NI)];
    double Q[SOME(NR)][SOME(NX + NI)];
    double low[NR + 1], high[NR + 1];
    Flow glance;
    Flows kept[KEPT];
    int oldest; /* of those */
    int is_ready, is_running, is_coupled, is_warned;
} Model;

static double gauge(double number) { return ldexp(1.0, number > 0.0 ? ilogb(number) : 0); }

/* A number of twice the digits of a double, and a bound for what rounding has made of it. A compiler that contracts or
   reorders sums (-ffp-contract=fast, -ffast-math) loses the second half. */
typedef struct {
    double high, low, error;
} Twofold;

/* a - b c */
static Twofold less_product(Twofold a, Twofold b, Twofold c)
{
    const double product = b.high * c.high, sum = a.high - product, taken = sum - a.high;
    const double rest = fma(b.high, c.high, -product) + (b.high * c.low + b.low * c.high);
    const double low = ((a.high - (sum - taken)) - (product + taken)) + (a.low - rest);
    Twofold found;
    found.high = sum + low;
    found.low = low - (found.high - sum);
    found.error = a.error + fabs(b.high) * c.error + b.error * (fabs(c.high) + c.error);
    found.error += ldexp(fabs(a.high) + fabs(product), -102);
    return found;
}

static Twofold quotient(Twofold a, Twofold b)
{
    Twofold first = {0.0, 0.0, 0.0}, found;
    double second;
    first.high = a.high / b.high;
    second = less_product(a, first, b).high / b.high;
    found.high = first.high + second;
    found.low = second - (found.high - first.high);
    found.error = (a.error + fabs(found.high) * b.error) / fabs(b.high) + ldexp(fabs(found.high), -102);
    return found;
}

/* A, B, C, D and Q from the equations, by elimination of the unknowns in twice the digits of a double, since values many
   decades apart cancel. 0 if memory lacks, or the equations are singular or little else than rounding. */
static int eliminate(Model *model)
{
    Twofold *m = calloc((size_t)HEIGHT * SPAN + 1, sizeof(Twofold));
    int i, j, k;
    if (m == NULL) return 0;
    for (i = 0; i < NENTRIES; i++) {
        Twofold *const entry = &m[ENTRY_ROW[i] * SPAN + ENTRY_COLUMN[i]];
        Twofold gain = {0.0, 0.0, 0.0}, value = {-1.0, 0.0, 0.0};
        gain.high = ENTRY_VALUE[i];
        if (ENTRY_PARAMETER[i] >= 0) value.high = -model->now.p[ENTRY_PARAMETER[i]];
        *entry = less_product(*entry, gain, value);
    }
    for (i = 0; i < NETA; i++) { /* rows of the balance have other units each */
        double largest = 0.0;
        for (j = 0; j < NETA; j++) largest = fmax(largest, fabs(m[i * SPAN + j].high));
        largest = gauge(largest);
        for (j = 0; j < SPAN; j++) {
            Twofold *const entry = &m[i * SPAN + j];
            entry->high /= largest, entry->low /= largest, entry->error /= largest;
        }
    }
    for (k = 0; k < NETA; k++) {
        int best = k;
        for (i = k + 1; i < NETA; i++)
            if (fabs(m[i * SPAN + k].high) > fabs(m[best * SPAN + k].high)) best = i;
        if (fabs(m[best * SPAN + k].high) <= m[best * SPAN + k].error) {
            free(m);
            return 0;
        }
        for (j = 0; j < SPAN; j++) {
            const Twofold other = m[k * SPAN + j];
            m[k * SPAN + j] = m[best * SPAN + j];
            m[best * SPAN + j] = other;
        }
        for (i = k + 1; i < HEIGHT; i++) {
            const Twofold factor = quotient(m[i * SPAN + k], m[k * SPAN + k]);
            if (m[i * SPAN + k].high != 0.0)
                for (j = k; j < SPAN; j++) m[i * SPAN + j] = less_product(m[i * SPAN + j], factor, m[k * SPAN + j]);
        }
    }
    for (i = NETA; i < HEIGHT; i++) {
        const int row = i - NETA;
        double largest = 0.0, error = 0.0;
        for (j = NETA; j < SPAN; j++) {
            const Twofold *const entry = &m[i * SPAN + j];
            const double value = fabs(entry->high) > entry->error ? entry->high : 0.0;
            const int column = j - NETA;
            largest = fmax(largest, fabs(value)), error = fmax(error, entry->error);
            if (row < NX) *(column < NX ? &model->A[row][column] : &model->B[row][column - NX]) = value;
            else if (row < NX + NY) *(column < NX ? &model->C[row - NX][column] : &model->D[row - NX][column - NX]) = value;
            else model->Q[row - NX - NY][column] = value;
        }
        if (!(largest == 0.0 || error <= WORST * largest)) {
            free(m);
            return 0;
        }
    }
    free(m);
    return 1;
}

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

static void keep(const Model *model, Flow *flow, const double *rise, double step)
{
    int i, j, k;
    for (i = 0; i < NX; i++)
        for (j = 0; j < WIDTH; j++) flow->flow[i][j] = rise[i * WIDTH + j] + (i == j);
    for (i = 0; i < NR; i++)
        for (j = 0; j < NR; j++) {
            flow->held[i][j] = flow->ramp[i][j] = model->Q[i][NX + NU + j];
            for (k = 0; k < NX; k++) {
                flow->held[i][j] += model->Q[i][k] * flow->flow[k][HELD + j];
                flow->ramp[i][j] += model->Q[i][k] * flow->flow[k][HELD + NR + j] / step;
            }
        }
}

/* The flows of step, step / 2, ... of so many levels: the exponential of the matrix of states and inputs, by a Taylor
   polynomial and repeated squaring. 0 if memory lacks, or numbers are too large. */
static int discretise(const Model *model, double step, Flow *flows, int levels)
{
    const size_t size = (size_t)WIDTH * WIDTH + 1;
    double *m = calloc(3 * size, sizeof(double)), *sum, *other, *swap, norm = 0.0;
    int i, j, k, halvings = 0;
    if (m == NULL) return 0;
    sum = m + size;
    other = sum + size;
    for (i = 0; i < NX; i++) {
        for (j = 0; j < NX; j++) m[i * WIDTH + j] = step * model->A[i][j];
        for (j = 0; j < NU; j++) m[i * WIDTH + NX + j] = step * model->B[i][j];
        for (j = 0; j < NR; j++) m[i * WIDTH + HELD + j] = step * model->B[i][NU + j];
    }
    for (i = NX; i < NX + (ORDERS - 1) * NU; i++) m[i * WIDTH + i + NU] = step;
    for (i = HELD; i < HELD + NR; i++) m[i * WIDTH + i + NR] = step;
    for (i = 0; i < WIDTH; i++) {
        double row = 0.0;
        for (j = 0; j < WIDTH; j++) row += fabs(m[i * WIDTH + j]);
        if (!isfinite(row)) {
            free(m);
            return 0;
        }
        if (row > norm) norm = row;
    }
    while (halvings < levels - 1 || ldexp(norm, -halvings) > 0.5) halvings++;
    for (i = 0; i < WIDTH * WIDTH; i++) m[i] = ldexp(m[i], -halvings);
    for (i = 0; i < WIDTH; i++) sum[i * WIDTH + i] = 1.0;
    for (k = TERMS; k > 0; k--) { /* m/1 (I + m/2 (I + ...)): without the identity, whose digits it would lose */
        multiply(m, sum, other);
        for (i = 0; i < WIDTH * WIDTH; i++) other[i] /= k;
        for (i = 0; k > 1 && i < WIDTH; i++) other[i * WIDTH + i] += 1.0;
        swap = sum, sum = other, other = swap;
    }
    for (k = halvings; k >= 0; k--) { /* the flow of step / 2^k */
        if (k < levels) keep(model, &flows[k], sum, ldexp(step, -k));
        if (k == 0) break;
        multiply(sum, sum, other);
        for (i = 0; i < WIDTH * WIDTH; i++) other[i] += 2.0 * sum[i];
        swap = sum, sum = other, other = swap;
    }
    free(m);
    return 1;
}

/* Reactions by their laws, from the motions that there would be without any; by Gauss-Seidel from the last ones. */
static void react(const Model *model, const double weight[][NR + 1], double *r, const double *free_motion)
{
    int i, j, sweep;
    for (sweep = 0; sweep < SWEEPS; sweep++) {
        double change = 0.0, size = 0.0;
        for (i = 0; i < NR; i++) {
            const double own = weight[i][i], before = r[i], low = model->low[i], high = model->high[i];
            double motion = free_motion[i];
            for (j = 0; j < NR; j++)
                if (j != i) motion += weight[i][j] * r[j];
            if (!(own < 0.0)) continue;
            if (GAP[i]) r[i] = motion > high ? (high - motion) / own : motion < low ? (low - motion) / own : 0.0;
            else r[i] = fmin(fmax(-motion / own, low), high);
            change = fmax(change, fabs(r[i] - before));
            size = fmax(size, fabs(r[i]));
        }
        if (change <= 1e-14 * size) return;
    }
}

/* -1, 0 or 1 of a friction that slips down, sticks or slips up, and of a gap in contact or not. */
static int contact(const Model *model, const double *r, int i)
{
    if (GAP[i]) return (r[i] > 0.0) - (r[i] < 0.0);
    return (r[i] >= model->high[i]) - (r[i] <= model->low[i]);
}

/* Reactions, zero but for the active ones, that leave these no motion. */
static void hold(const double weight[][NR + 1], const int *active, double *r, const double *free_motion)
{
    int i, j, sweep;
    memset(r, 0, sizeof(double) * NR);
    for (sweep = 0; sweep < SWEEPS; sweep++) {
        double change = 0.0, size = 0.0;
        for (i = 0; i < NR; i++) {
            const double own = weight[i][i], before = r[i];
            double motion = free_motion[i];
            for (j = 0; j < NR; j++)
                if (j != i) motion += weight[i][j] * r[j];
            if (!active[i] || !(own < 0.0)) continue;
            r[i] = -motion / own;
            change = fmax(change, fabs(r[i] - before));
            size = fmax(size, fabs(r[i]));
        }
        if (change <= 1e-14 * size) return;
    }
}

static double cubic(double e[][NE + 1], int input, int order, double time)
{
    double value = e[ORDERS - 1][input];
    int k;
    for (k = ORDERS - 2; k >= order; k--) value = e[k][input] + value * time / (k - order + 1);
    return value;
}

/* The motion of a friction or gap, without what reactions add at once if there are none. */
static double motion_of(const Model *model, int i, const double *x, const double *u, const double *r)
{
    double motion = 0.0;
    int j;
    for (j = 0; j < NX; j++) motion += model->Q[i][j] * x[j];
    for (j = 0; j < NU; j++) motion += model->Q[i][NX + j] * u[j];
    for (j = 0; r != NULL && j < NR; j++) motion += model->Q[i][NX + NU + j] * r[j];
    return motion;
}

/* The end of a step from a state, with the reactions there; these are held, or ramps from those of the state. */
static void follow(const Model *model, const Flow *flow, double step, int held, State *now)
{
    double next[NX + 1], motion[NR + 1], before[NR + 1];
    int i, j, k;
    for (i = 0; i < NR; i++) motion[i] = CREEPS[i] ? -now->place[i] : 0.0;
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
        motion[i] += motion_of(model, i, next, now->u[0], NULL);
        if (!held)
            for (j = 0; j < NR; j++) motion[i] += (flow->held[i][j] - flow->ramp[i][j]) * now->r[j];
    }
    if (NR > 0) react(model, held ? flow->held : flow->ramp, now->r, motion);
    for (i = 0; i < NX; i++) {
        now->x[i] = next[i];
        for (j = 0; j < NR; j++) {
            const double first = held ? now->r[j] : before[j];
            now->x[i] += flow->flow[i][HELD + j] * first;
            now->x[i] += flow->flow[i][HELD + NR + j] * (now->r[j] - first) / step;
        }
    }
    for (i = 0; i < NR; i++)
        if (CREEPS[i] && !(now->r[i] > model->low[i] && now->r[i] < model->high[i]))
            now->place[i] = motion_of(model, i, now->x, now->u[0], now->r);
}

/* Reactions at the instant of a state: what they are in the smallest step from there. */
static void look(Model *model)
{
    State trial = model->now;
    if (NR == 0) return;
    follow(model, &model->glance, GLANCE, 1, &trial);
    memcpy(model->now.r, trial.r, sizeof trial.r);
}

static double delay(const Model *model, int input)
{
    return SPEED < 0 || DISTANCE[input] == 0.0 ? 0.0 : DISTANCE[input] / model->now.p[SPEED < 0 ? 0 : SPEED];
}

/* The inputs of the matrices at a time, as they go on until `until`, which is not beyond the next segment of any. */
static void load(Model *model, double time, double until)
{
    int j, k;
    for (j = 0; j < NU; j++) {
        const double late = delay(model, j), seen = 0.5 * (time + until) - late;
        size_t at = model->now.count;
        if (late > 0.0) {
            while (at > 0 && model->past[at - 1].begin > seen) at--;
            for (k = 0; k < ORDERS; k++)
                model->now.u[k][j] =
                    at == 0 ? 0.0 : cubic(model->past[at - 1].e, SOURCE[j], k, time - late - model->past[at - 1].begin);
        } else
            for (k = 0; k < ORDERS; k++) model->now.u[k][j] = cubic(model->now.e, SOURCE[j], k, time - model->now.time);
    }
}

/* The matrices of the parameters. 0 if memory lacks, or the equations are singular. */
static int assemble(Model *model)
{
    int i;
    if (model->is_ready && memcmp(model->p, model->now.p, sizeof model->p) == 0) return 1;
    if (memcmp(model->now.p, START, sizeof(double) * NP) == 0) {
        memcpy(model->A, A, sizeof A), memcpy(model->B, B, sizeof B), memcpy(model->C, C, sizeof C);
        memcpy(model->D, D, sizeof D), memcpy(model->Q, Q, sizeof Q);
    } else if (!eliminate(model)) return 0;
    for (i = 0; i < NR; i++) {
        const double value = LIMIT[i] < 0 ? 0.0 : model->now.p[LIMIT[i]] * LIMIT_GAIN[i];
        model->low[i] = LIMIT[i] < 0 ? LOW[i] : -value;
        model->high[i] = LIMIT[i] < 0 ? HIGH[i] : value;
    }
    if (NR > 0 && !discretise(model, GLANCE, &model->glance, 1)) return 0;
    memset(model->kept, 0, sizeof model->kept);
    memcpy(model->p, model->now.p, sizeof model->p);
    return model->is_ready = model->now.stale = 1;
}

/* Matrices of the parameters, and inputs and reactions of this instant. 0 as `assemble`. */
static int prepare(Model *model)
{
    if (!assemble(model)) return 0;
    if (model->now.stale) {
        load(model, model->now.time, model->now.time);
        look(model);
        model->now.stale = 0;
    }
    return 1;
}

/* What an output changes by with the states and the inputs at once, while what sticks sticks, and contacts last. A
   reaction of one size never sticks; a gap without width is always in contact. */
static double sensitivity(const Model *model, int number, const double *dx, const double *du)
{
    double next[NX + 1], motion[NR + 1], dr[NR + 1], y = 0.0;
    int active[NR + 1], i, j;
    for (i = 0; i < NX; i++) {
        next[i] = 0.0;
        for (j = 0; j < NX; j++) next[i] += model->glance.flow[i][j] * dx[j];
        for (j = 0; j < NU; j++) next[i] += model->glance.flow[i][NX + j] * du[j];
    }
    for (i = 0; i < NR; i++) {
        active[i] = model->low[i] < model->high[i] ? (contact(model, model->now.r, i) == 0) != GAP[i] : GAP[i];
        motion[i] = motion_of(model, i, next, du, NULL);
    }
    hold(model->glance.held, active, dr, motion);
    for (j = 0; j < NX; j++) y += model->C[number][j] * dx[j];
    for (j = 0; j < NU; j++) y += model->D[number][j] * du[j];
    for (j = 0; j < NR; j++) y += model->D[number][NU + j] * dr[j];
    return y;
}

/* What reactions add to an output at once. */
static double share(const Model *model, int number, const double *r)
{
    double y = 0.0;
    int j;
    for (j = 0; j < NR; j++) y += model->D[number][NU + j] * r[j];
    return y;
}

/* Whether reactions at the end of a step are not those of that instant in some output, as when they ring. */
static int rings(Model *model)
{
    double at_end[NR + 1];
    int i, found = 0;
    if (NR == 0) return 0;
    memcpy(at_end, model->now.r, sizeof at_end);
    look(model);
    for (i = 0; i < NY; i++) {
        const double now = share(model, i, model->now.r);
        model->now.largest[i] = fmax(model->now.largest[i], fabs(now));
        found |= fabs(share(model, i, at_end) - now) > RINGING * model->now.largest[i];
    }
    memcpy(model->now.r, at_end, sizeof at_end);
    return found;
}

/* Whether the reaction of a contact or of a creeping friction is not straight over a step, as an oscillation between a mass
   and what it touches is not: a ramp would then have another impulse. If it is, the two halves are the step. */
static int bends(Model *model, const State *before, const Flows *flows, double step, int level)
{
    State halves = *before;
    double middle[NR + 1];
    int i, asked = 0, found = 0;
    for (i = 0; i < NR; i++) asked |= GAP[i] ? contact(model, model->now.r, i) : CREEPS[i];
    if (!asked) return 0;
    follow(model, &flows->flows[level + 1], step / 2.0, 0, &halves);
    memcpy(middle, halves.r, sizeof middle);
    follow(model, &flows->flows[level + 1], step / 2.0, 0, &halves);
    for (i = 0; i < NR; i++) {
        halves.strongest[i] = fmax(halves.strongest[i], fabs(halves.r[i]));
        found |= (GAP[i] || CREEPS[i]) && fabs(before->r[i] - 2.0 * middle[i] + halves.r[i]) > BENT * halves.strongest[i];
    }
    memcpy(halves.largest, model->now.largest, sizeof halves.largest);
    model->now = halves;
    return found;
}

static void advance_part(Model *model, const Flows *flows, double step, int level)
{
    const State before = model->now;
    int i, touches = 0, struck = 0, slipped = 0;
    follow(model, &flows->flows[level], step, 0, &model->now);
    for (i = 0; i < NR; i++) {
        const int now = contact(model, model->now.r, i);
        *(GAP[i] ? &struck : &slipped) |= contact(model, before.r, i) != now;
        touches |= GAP[i] && now != 0;
    }
    if (level < HELD_FROM ? struck || slipped || rings(model) || bends(model, &before, flows, step, level)
                          : level < LEVELS - 1 && (struck || (touches && rings(model)))) {
        model->now = before;
        advance_part(model, flows, step / 2.0, level + 1);
        advance_part(model, flows, step / 2.0, level + 1);
    } else if (struck || slipped || rings(model)) {
        model->now = before;
        follow(model, &flows->flows[level], step, 1, &model->now);
        look(model);
    }
}

/* The flows of a step; NULL as `discretise`. */
static const Flows *flows_of(Model *model, double step)
{
    Flows *found;
    int i;
    for (i = 0; i < KEPT; i++)
        if (model->kept[i].step == step) return &model->kept[i];
    found = &model->kept[model->oldest];
    model->oldest = (model->oldest + 1) % KEPT;
    found->step = 0.0;
    if (!discretise(model, step, found->flows, LEVELS)) return NULL;
    found->step = step;
    return found;
}

/* The inputs of a step from now on, for those that are late; what none needs any more is dropped. 0 if memory lacks. */
static int record(Model *model)
{
    double latest = 0.0;
    size_t first = 0;
    int j;
    for (j = 0; j < NU; j++) latest = fmax(latest, delay(model, j));
    if (latest == 0.0) return 1;
    while (first + 1 < model->now.count && model->past[first + 1].begin + latest < model->now.time) first++;
    if (first > model->now.count / 2) {
        model->now.count -= first;
        memmove(model->past, model->past + first, model->now.count * sizeof(Segment));
    }
    if (model->now.count == model->room) {
        const size_t room = 2 * model->room + 64;
        Segment *const past = realloc(model->past, room * sizeof(Segment));
        if (past == NULL) return 0;
        model->past = past, model->room = room;
    }
    model->past[model->now.count].begin = model->now.time;
    memcpy(model->past[model->now.count].e, model->now.e, sizeof model->now.e);
    model->now.count++;
    return 1;
}

/* Where one of the late inputs begins its next segment, at most `end`. */
static double next_break(const Model *model, double time, double end)
{
    const double least = 1e-9 * (end - model->now.time);
    double found = end;
    int j;
    for (j = 0; j < NU; j++) {
        const double late = delay(model, j);
        size_t at = model->now.count;
        if (late == 0.0) continue;
        while (at > 0 && model->past[at - 1].begin + late > time + least) {
            at--;
            if (model->past[at].begin + late < found - least) found = model->past[at].begin + late;
        }
    }
    return found;
}

static double shortened(double length)
{
    const int scale = BITS - ilogb(length);
    return ldexp(floor(ldexp(length, scale) + 0.5), -scale);
}

/* A step. 0 if memory lacks, or its end is not finite. */
static int advance(Model *model, double step)
{
    const double begin = model->now.time, end = begin + step;
    double time = begin;
    int i, k;
    if (!prepare(model) || !record(model)) return 0;
    while (time < end) {
        const double until = next_break(model, time, end);
        const double piece = time == begin && until == end ? step : shortened(until - time);
        const int parts = NR > 0 && piece > LONGEST ? (int)ceil(piece / LONGEST - 1e-9) : 1;
        const Flows *flows = flows_of(model, piece / parts);
        if (flows == NULL) return 0;
        load(model, time, until);
        if (time > begin) look(model); /* inputs may have jumped */
        for (i = 0; i < parts; i++) advance_part(model, flows, piece / parts, 0);
        time = until;
    }
    for (i = 0; i < NE; i++)
        for (k = 0; k < ORDERS; k++) model->now.e[k][i] = cubic(model->now.e, i, k, step);
    look(model);
    model->now.time = end;
    for (i = 0; i < NX; i++)
        if (!isfinite(model->now.x[i])) return 0;
    return 1;
}

static double output(const Model *model, int number)
{
    double y = 0.0;
    int j;
    for (j = 0; j < NX; j++) y += model->C[number][j] * model->now.x[j];
    for (j = 0; j < NU; j++) y += model->D[number][j] * model->now.u[0][j];
    for (j = 0; j < NR; j++) y += model->D[number][NU + j] * model->now.r[j];
    return y;
}

/* How the states move as a motion jumps by one: by a pulse of its acceleration, or by two against each other. */
static void jump(const Model *model, int motion, double *dx)
{
    int i, j;
    for (i = 0; i < NX; i++) {
        dx[i] = model->B[i][MOTION_INPUT[motion]];
        if (!MOTION_IS_RATE[motion])
            for (dx[i] = 0.0, j = 0; j < NX; j++) dx[i] += model->A[i][j] * model->B[j][MOTION_INPUT[motion]];
    }
}

/* A prescribed motion, which the state follows at once; gaps in contact stay so, by pulses of their reactions. */
static void move(Model *model, int motion, double value)
{
    const double change = value - model->now.x[MOTION_STATE[motion]];
    double dx[NX + 1], weight[NR + 1][NR + 1], pulse[NR + 1], beyond[NR + 1];
    int active[NR + 1], i, j, k;
    if (change == 0.0) return;
    jump(model, motion, dx);
    for (i = 0; i < NX; i++) model->now.x[i] += dx[i] * change;
    model->now.x[MOTION_STATE[motion]] = value;
    for (i = 0; i < NR; i++) {
        const int side = GAP[i] ? contact(model, model->now.r, i) : 0;
        double q = 0.0;
        for (j = 0; j < NX; j++) q += model->Q[i][j] * model->now.x[j];
        active[i] = GAP[i] && (side != 0 || q > model->high[i] || q < model->low[i]);
        beyond[i] = active[i] ? q - (side > 0 || (side == 0 && q > model->high[i]) ? model->high[i] : model->low[i]) : 0.0;
        for (j = 0; j < NR; j++)
            for (weight[i][j] = 0.0, k = 0; k < NX; k++) weight[i][j] += model->Q[i][k] * model->B[k][NU + j];
        if (weight[i][i] * GLANCE > 0.5 * model->glance.held[i][i]) weight[i][i] = 0.0; /* of inertia, but for rounding */
    }
    hold((const double(*)[NR + 1])weight, active, pulse, beyond);
    for (i = 0; i < NX; i++)
        for (j = 0; j < NR; j++) model->now.x[i] += model->B[i][NU + j] * pulse[j];
}

static void rest(Model *model)
{
    memset(&model->now, 0, sizeof model->now);
    memcpy(model->now.p, START, sizeof(double) * NP);
    model->now.stale = 1;
    model->is_running = model->is_coupled = model->is_warned = 0;
}
