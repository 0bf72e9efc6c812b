/* Exact flow of x' = A x + B u, y = C x + D u over a step in which every input is a cubic polynomial of time.

   Written by inerter. model.h has NX, NU, NY, A, B, C and D. The inputs of a step are u and its first three derivatives
   at its begin; at its end, the inputs are those polynomials there. */

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"

#define ORDERS 4
#define WIDTH (NX + ORDERS * NU)
#define TERMS 20

typedef struct {
    double time;
    double x[NX + 1];
    double u[ORDERS][NU + 1];
} State;

typedef struct {
    State now;
    double step;              /* of the flow below; 0 for none */
    double flow[NX + 1][WIDTH + 1];
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
    }
    for (i = NX; i < WIDTH - NU; i++) m[i * WIDTH + i + NU] = step;
    for (i = 0; i < WIDTH; i++) {
        double row = 0.0;
        for (j = 0; j < WIDTH; j++) row += fabs(m[i * WIDTH + j]);
        if (row > norm) norm = row;
    }
    while (ldexp(norm, -halvings) > 0.5) halvings++;
    for (i = 0; i < WIDTH * WIDTH; i++) m[i] = ldexp(m[i], -halvings);
    for (i = 0; i < WIDTH; i++) sum[i * WIDTH + i] = 1.0;
    for (k = TERMS; k > 0; k--) { /* I + m/1 (I + m/2 (I + ...)) */
        multiply(m, sum, other);
        for (i = 0; i < WIDTH * WIDTH; i++) other[i] /= k;
        for (i = 0; i < WIDTH; i++) other[i * WIDTH + i] += 1.0;
        swap = sum, sum = other, other = swap;
    }
    for (k = 0; k < halvings; k++) {
        multiply(sum, sum, other);
        swap = sum, sum = other, other = swap;
    }
    for (i = 0; i < NX; i++)
        for (j = 0; j < WIDTH; j++) model->flow[i][j] = sum[i * WIDTH + j];
    model->step = step;
    free(m);
    return 1;
}

static int advance(Model *model, double step)
{
    State *now = &model->now;
    double next[NX + 1];
    int i, j, k;
    if (step != model->step && !discretise(model, step)) return 0;
    for (i = 0; i < NX; i++) {
        next[i] = 0.0;
        for (j = 0; j < NX; j++) next[i] += model->flow[i][j] * now->x[j];
        for (k = 0; k < ORDERS; k++)
            for (j = 0; j < NU; j++) next[i] += model->flow[i][NX + k * NU + j] * now->u[k][j];
    }
    for (i = 0; i < NX; i++) now->x[i] = next[i];
    for (j = 0; j < NU; j++) {
        double *const u[ORDERS] = {&now->u[0][j], &now->u[1][j], &now->u[2][j], &now->u[3][j]};
        *u[0] += step * (*u[1] + step * (*u[2] / 2.0 + step * *u[3] / 6.0));
        *u[1] += step * (*u[2] + step * *u[3] / 2.0);
        *u[2] += step * *u[3];
    }
    now->time += step;
    return 1;
}

static double output(const Model *model, int number)
{
    double y = 0.0;
    int j;
    for (j = 0; j < NX; j++) y += C[number][j] * model->now.x[j];
    for (j = 0; j < NU; j++) y += D[number][j] * model->now.u[0][j];
    return y;
}

static void rest(Model *model)
{
    memset(&model->now, 0, sizeof model->now);
}
