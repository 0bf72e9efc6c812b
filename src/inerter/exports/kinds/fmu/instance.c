/* What both versions of FMI ask of an instance, over engine.c. Written by inerter.

   A version says what it has before it includes this: FIRST is the reference of the first input, INPUT_ORDERS how many
   derivatives of an input are variables. After the inputs come motions, outputs and parameters. */

#include "engine.c"

#define STRUT (NM > 0) /* alone: then the first output is its force, and its ends are prescribed motions */
#define OUTPUTS (NY + (STRUT ? 3 : 0)) /* with mean_force, inertance and coupling_ratio */
#define INPUTS (FIRST + INPUT_ORDERS * NE)
#define VARIABLES (INPUTS + NM + OUTPUTS + NP)

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING } Status;
typedef enum { TIME, INPUT, MOTION, OUTPUT, PARAMETER, UNKNOWN } Kind;
typedef struct {
    Kind kind;
    int number, order;
} Variable;

static void tell(Model *model, Status status, const char *text);

static Variable variable(unsigned reference)
{
    Variable found = {UNKNOWN, (int)reference, 0};
    if (reference >= VARIABLES) return found;
    if (found.number < FIRST) found.kind = TIME;
    else if (found.number < INPUTS) {
        found.kind = INPUT;
        found.order = (found.number - FIRST) / (NE + !NE);
        found.number = (found.number - FIRST) % (NE + !NE);
    } else if ((found.number -= INPUTS) < NM) found.kind = MOTION;
    else if ((found.number -= NM) < OUTPUTS) found.kind = OUTPUT;
    else found.number -= OUTPUTS, found.kind = PARAMETER;
    return found;
}

/* What to answer when the matrices were to be made, by whether they were. */
static Status answer(Model *model, int is_made)
{
    if (is_made) return OK;
    tell(model, ERROR, "no motion follows from these parameters: the equations are singular, or nearly so in twice the digits of a double");
    return ERROR;
}

/* What the force gains at once for each m/s^2 of the upper end. */
static double inertance(const Model *model)
{
    double dx[NX + 1] = {0.0}, du[NU + 1] = {0.0};
    du[0] = 1.0;
    return sensitivity(model, 0, dx, du);
}

/* Inertance over the masses of the host, as far as they are told: from one on, no acceleration of the step before will do. */
static double coupling_ratio(const Model *model)
{
    double mobility = 0.0;
    int i;
    for (i = 0; STRUT && i < 2; i++)
        if (model->now.p[MASSES + i] > 0.0) mobility += 1.0 / model->now.p[MASSES + i];
    return inertance(model) * mobility;
}

static Status read_values(Model *model, const unsigned references[], size_t n, double value[])
{
    size_t i;
    for (i = 0; i < n; i++) {
        const Variable one = variable(references[i]);
        switch (one.kind) {
        case TIME: value[i] = model->now.time; break;
        case INPUT: value[i] = model->now.e[one.order][one.number]; break;
        case MOTION: value[i] = model->now.x[MOTION_STATE[one.number]]; break;
        case PARAMETER: value[i] = model->now.p[one.number]; break;
        case OUTPUT:
            if (answer(model, prepare(model)) != OK) return ERROR;
            if (one.number < NY) value[i] = output(model, one.number);
            else if (one.number == NY) value[i] = model->now.mean;
            else if (one.number == NY + 1) value[i] = inertance(model), model->is_coupled = 1;
            else value[i] = coupling_ratio(model);
            break;
        default: return ERROR;
        }
    }
    return OK;
}

static Status write_values(Model *model, const unsigned references[], size_t n, const double value[])
{
    size_t i;
    for (i = 0; i < n; i++) {
        const Variable one = variable(references[i]);
        if (!isfinite(value[i])) {
            tell(model, ERROR, "values are finite numbers");
            return ERROR;
        }
        switch (one.kind) {
        case INPUT:
            model->now.e[one.order][one.number] = value[i];
            model->now.given = 1;
            break;
        case MOTION:
            if (answer(model, assemble(model)) != OK) return ERROR;
            move(model, one.number, value[i]);
            break;
        case PARAMETER:
            if (!(value[i] >= SMALLEST && value[i] <= LARGEST) && !(value[i] == 0.0 && MAY_VANISH[one.number])) {
                tell(model, ERROR, "parameters are positive numbers that double precision supports, 1e-12 to 1e15");
                return ERROR;
            }
            if (model->is_running && !TUNABLE[one.number]) {
                tell(model, ERROR, "a fixed parameter cannot change after initialisation");
                return ERROR;
            }
            model->now.p[one.number] = value[i];
            break;
        default: return ERROR;
        }
        model->now.stale = 1;
    }
    return OK;
}

static Status directional_derivative(Model *model, const unsigned unknown[], size_t n, const unsigned known[], size_t m,
                                     const double seed[], double value[])
{
    double dx[NX + 1] = {0.0}, du[NU + 1] = {0.0}, moved[NX + 1];
    size_t i;
    int j;
    if (answer(model, prepare(model)) != OK) return ERROR;
    for (i = 0; i < m; i++) {
        const Variable one = variable(known[i]);
        if (one.kind == MOTION) {
            jump(model, one.number, moved);
            for (j = 0; j < NX; j++) dx[j] += moved[j] * seed[i];
        } else if (one.kind == INPUT) {
            for (j = 0; j < NU && one.order == 0; j++)
                if (SOURCE[j] == one.number && delay(model, j) == 0.0) du[j] += seed[i];
        } else return ERROR;
    }
    for (i = 0; i < n; i++) {
        const Variable one = variable(unknown[i]);
        if (one.kind != OUTPUT) return ERROR;
        value[i] = one.number < NY ? sensitivity(model, one.number, dx, du) : 0.0;
    }
    model->is_coupled = 1;
    return OK;
}

/* A strut with inertance warns a host that seems to take its force as given. */
static Status warn(Model *model)
{
    const double inert = inertance(model), ratio = coupling_ratio(model);
    if (model->is_warned || inert == 0.0) return OK;
    if (!model->now.given) tell(model, WARNING, "the strut has inertance, and no acceleration was set: its force is wrong");
    else if (!model->is_coupled && ratio == 0.0)
        tell(model, WARNING, "the strut has inertance: solve for the accelerations with its directional derivatives");
    else if (!model->is_coupled && ratio >= 1.0)
        tell(model, WARNING,
             "coupling_ratio is one or more: with accelerations of the step before the host diverges. Solve for them with "
             "the directional derivatives or the output inertance");
    else return OK;
    model->is_warned = 1;
    return WARNING;
}

static Status take_step(Model *model, double time, double step)
{
    Status status = OK;
    if (!(step >= 0.0) || !isfinite(step) || !isfinite(time)) return ERROR;
    if (NR > 0 && step > MOST * LONGEST) {
        tell(model, ERROR, "a step with friction or gaps is at most 20000 s long");
        return ERROR;
    }
    model->now.time = time;
    if (answer(model, prepare(model)) != OK) return ERROR;
    if (STRUT && step > 0.0) status = warn(model);
    if (STRUT) model->now.x[NX - 1] = 0.0; /* its last state is the impulse of its force */
    if (step > 0.0 && !advance(model, step)) {
        tell(model, ERROR, "no finite motion follows from these values");
        return ERROR;
    }
    if (STRUT && step > 0.0) model->now.mean = model->now.x[NX - 1] / step;
    return status;
}

static void release(Model *model)
{
    if (model != NULL) free(model->past);
    free(model);
}

static size_t state_size(const void *state)
{
    return sizeof(State) + ((const State *)state)->count * sizeof(Segment);
}

static Status get_state(Model *model, void **state)
{
    void *const room = realloc(*state, state_size(&model->now));
    if (room == NULL) return ERROR;
    *state = room;
    memcpy(room, &model->now, sizeof(State));
    if (model->now.count > 0) memcpy((char *)room + sizeof(State), model->past, model->now.count * sizeof(Segment));
    model->is_coupled = 1;
    return OK;
}

static Status set_state(Model *model, const void *state)
{
    size_t count;
    if (state == NULL) return ERROR;
    count = ((const State *)state)->count;
    if (count > model->room) {
        Segment *const past = realloc(model->past, count * sizeof(Segment));
        if (past == NULL) return ERROR;
        model->past = past, model->room = count;
    }
    memcpy(&model->now, state, sizeof(State));
    if (count > 0) memcpy(model->past, (const char *)state + sizeof(State), count * sizeof(Segment));
    return OK;
}

static Status serialize_state(const void *state, void *bytes, size_t size)
{
    if (state == NULL || size < state_size(state)) return ERROR;
    memcpy(bytes, state, state_size(state));
    return OK;
}

static Status deserialize_state(const void *bytes, size_t size, void **state)
{
    State head;
    void *room;
    if (size < sizeof(State)) return ERROR;
    memcpy(&head, bytes, sizeof head);
    if (head.count > size / sizeof(Segment) || size != state_size(&head) || (room = realloc(*state, size)) == NULL) return ERROR;
    *state = room;
    memcpy(room, bytes, size);
    return OK;
}
