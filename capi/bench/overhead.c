/*
 * Instructions and stack of the library's functions, and of the Rust calls that alula_step and alula_guide make, on the
 * emulated Cortex-M4F.
 *
 * Under `-icount shift=0` QEMU's virtual clock advances 1 ns per instruction, and TIM2 of its netduinoplus2 counts at
 * 1 GHz: one tick per instruction. An empty function's ticks are taken off; the method is checked on loops whose
 * instructions are counted by hand.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <alula.h>

#define CASES 2000
#define ROOM 3200

typedef int32_t (*step)(void *controller, const void *input, float dt, void *command);

int32_t overhead_fixture(void *fixture);
void overhead_case(void *rust_case, const float x[20]);
int32_t overhead_any(void *fixture, const void *rust_case, float dt, void *result);
int32_t overhead_combined(void *fixture, const void *rust_case, float dt, void *result);
int32_t overhead_step(void *fixture, const void *rust_case, float dt, void *result);
int32_t overhead_guide_any(void *fixture, const void *rust_case, float dt, void *guided);
int32_t overhead_guide_combined(void *fixture, const void *rust_case, float dt, void *guided);
void overhead_guided(const void *guided, float out[4]);
int32_t overhead_result(const void *result, float out[4]);

#define TIM2_CR1 (*(volatile uint32_t *)0x40000000u)
#define TIM2_CNT (*(volatile uint32_t *)0x40000024u)

static int32_t empty(void *a, const void *b, float c, void *d)
{
    (void)a, (void)b, (void)c, (void)d;
    return 0;
}

static int32_t turns(void *a, const void *b, float c, void *d)
{
    (void)a, (void)b, (void)c, (void)d;
    __asm__ volatile("movw r3, #1000\n1: subs r3, r3, #1\nbne 1b" ::: "r3", "cc");
    return 0;
}

static uint32_t __attribute__((noinline)) ticks(volatile step f, void *a, const void *b, void *d)
{
    uint32_t before = TIM2_CNT;
    f(a, b, 1e-3f, d);
    return TIM2_CNT - before;
}

static uint32_t instructions(step f, void *a, const void *b, void *d)
{
    return ticks(f, a, b, d) - ticks(empty, a, b, d);
}

static alula_parameters parameters;
static alula_controller controller;
static alula_input input;
static alula_command command;
static alula_report report;
static alula_equilibria equilibria;
static alula_fold_map map;
static alula_fold_margin margin;
static alula_table table;
static alula_table_row rows[60];

/* The functions of the table, behind one signature. Passing their arguments, three or four instructions, is counted too. */
#define ENTRY(name, call)                                          \
    static int32_t name(void *a, const void *b, float dt, void *d) \
    {                                                              \
        (void)a, (void)b, (void)dt, (void)d;                       \
        return call;                                               \
    }
ENTRY(step_bare, alula_step(&controller, &input, dt, &command, NULL))
ENTRY(step_fed, (input.flags |= ALULA_FEED_FORWARD, alula_step(&controller, &input, dt, &command, NULL)))
ENTRY(step_reporting, alula_step(&controller, &input, dt, &command, &report))
ENTRY(guide, alula_guide(&controller, &input, dt, &command, NULL))
ENTRY(guide_reporting, alula_guide(&controller, &input, dt, &command, &report))
ENTRY(init, alula_init(&controller, &parameters, NULL))
ENTRY(table_init, alula_table_init(&table, rows, 60, NULL))
ENTRY(equilibria_at, alula_equilibria_at(&controller, &input, &equilibria))
ENTRY(map_init, alula_fold_map_init(&map, &controller))
ENTRY(margin_at, alula_fold_margin_at(&map, &controller, &input, &margin))

/* Bytes that f writes below the stack pointer it is called with. */
static uint32_t __attribute__((noinline)) stack(volatile step f)
{
    enum { WORDS = 6000 };
    volatile uint32_t *top;
    __asm__ volatile("mov %0, sp" : "=r"(top));
    /* A pattern of its own for each word. With one for all, a saved register that holds it would look like untouched
     * memory. */
    for (uint32_t n = 1; n <= WORDS; n++)
        top[-(int32_t)n] = n * 0x9e3779b9u;
    f(NULL, NULL, 1e-3f, NULL);
    uint32_t deepest = WORDS;
    while (deepest > 0 && top[-(int32_t)deepest] == deepest * 0x9e3779b9u)
        deepest--;
    return 4 * deepest;
}

/* A number in [-limit, limit]: Marsaglia's xorshift. */
static float within(uint32_t *seed, float limit)
{
    for (int n = 0; n < 4; n++) {
        *seed ^= *seed << 13;
        *seed ^= *seed >> 17;
        *seed ^= *seed << 5;
    }
    return limit * ((float)(int32_t)*seed / 2147483648.0f);
}

static int by_value(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static uint64_t fixture[ROOM / 8], rust_case[ROOM / 8], result[ROOM / 8];
static uint32_t counts[4][CASES];
static float last[4][4];

/* Twenty random numbers, and the input with the same. */
static void draw(uint32_t *seed, float x[20])
{
    float square;
    do {
        square = 0.0f;
        for (int k = 0; k < 4; k++) {
            x[k] = within(seed, 1.0f);
            square += x[k] * x[k];
        }
    } while (square < 0.1f);
    for (int k = 0; k < 4; k++)
        x[k] /= sqrtf(square);
    for (int k = 4; k < 20; k++)
        /* The wind, from 7 on, changes by no more than the guidance takes for plausible. */
        x[k] = within(seed, k < 7 ? 25.0f : k < 10 ? 3.0f : k < 13 ? 25.0f : k < 16 ? 5.0f : k < 17 ? 3.0f : 12.0f);
    memcpy(input.quaternion, x, sizeof input.quaternion);
    memcpy(input.velocity, x + 4, sizeof input.velocity);
    memcpy(input.air, x + 7, sizeof input.air);
    memcpy(input.reference_velocity, x + 10, sizeof input.reference_velocity);
    memcpy(input.reference_acceleration, x + 13, sizeof input.reference_acceleration);
    input.heading = x[16];
    memcpy(input.specific_force, x + 17, sizeof input.specific_force);
    input.flags = ALULA_SPECIFIC_FORCE;
}

/* One line of the table. */
static void measure(const char *name, step f, int cases)
{
    uint32_t seed = 7, deepest = 0;
    for (int n = 0; n < cases; n++) {
        float x[20];
        draw(&seed, x);
        counts[0][n] = instructions(f, NULL, NULL, NULL);
        uint32_t bytes = n % 16 == 0 ? stack(f) : 0;
        deepest = bytes > deepest ? bytes : deepest;
    }
    qsort(counts[0], (size_t)cases, sizeof counts[0][0], by_value);
    printf("| %s | %lu | %lu | %lu | %lu |\n", name, (unsigned long)counts[0][0], (unsigned long)counts[0][cases / 2],
           (unsigned long)counts[0][cases - 1], (unsigned long)deepest);
}

/* Most that a C entry may take over a call in Rust, in tenths of a percent of the medians: alula_step over the same work,
 * alula_guide over a step of the guidance that leaves quaternions and attitude set-points to its caller. */
enum { STEP_LIMIT = 200, GUIDE_LIMIT = 150 };

/* Prints by how much the median of the `c`th counts exceeds that of the `rust`th; both are sorted. Returns 1 if it is more
 * than the limit. */
static int over(const char *const *names, int rust, int c, unsigned long limit)
{
    unsigned long base = counts[rust][CASES / 2], more = counts[c][CASES / 2] - base;
    unsigned long share = (1000 * more + base / 2) / base;
    printf("%s over %s: %lu.%lu %%\n", names[c], names[rust], share / 10, share % 10);
    if (share <= limit)
        return 0;
    printf("that is more than %lu %%\n", limit / 10);
    return 1;
}

/* Sorts and prints the counts, and compares two of them. */
static int compare(const char *const *names, int count, int rust, int c, unsigned long limit)
{
    for (int f = 0; f < count; f++) {
        qsort(counts[f], CASES, sizeof counts[f][0], by_value);
        printf("%-38s %4lu %4lu %4lu\n", names[f], (unsigned long)counts[f][0],
               (unsigned long)counts[f][CASES / 2], (unsigned long)counts[f][CASES - 1]);
    }
    return over(names, rust, c, limit);
}

int main(void)
{
    TIM2_CR1 = 1;
    /* Loop: 1 movw and 1000 times 2; the empty function has no more than its return. */
    if (instructions(turns, NULL, NULL, NULL) != 2001) {
        puts("the method does not count what it should");
        return 1;
    }

    parameters.header = ALULA_HEADER(alula_parameters);
    controller.header = ALULA_HEADER(alula_controller);
    input.header = ALULA_HEADER(alula_input);
    command.header = ALULA_HEADER(alula_command);
    report.header = ALULA_HEADER(alula_report);
    equilibria.header = ALULA_HEADER(alula_equilibria);
    map.header = ALULA_HEADER(alula_fold_map);
    margin.header = ALULA_HEADER(alula_fold_margin);
    table.header = ALULA_HEADER(alula_table);
    /* Roughly a flat plate's coefficients, by parabolas: only the work of interpolating them matters. */
    for (int n = 0; n < 60; n++) {
        float turn = (float)n / 59.0f;
        rows[n].alpha = n == 59 ? 3.14159265f : turn * 3.14159265f;
        rows[n].c_l = n % 59 == 0 ? 0.0f : 4.0f * (0.5f - turn) * (turn < 0.5f ? turn : 1.0f - turn) * 4.0f;
        rows[n].c_d = 0.02f + 8.0f * turn * (1.0f - turn);
    }
    int32_t defaults = alula_parameters_default(&parameters);
    parameters.vehicle.mass = 10.0f;
    parameters.vehicle.k_a = 0.646f;
    parameters.vehicle.thrust_max = 196.2f;
    parameters.vehicle.c_y = 0.5f;
    if (defaults || alula_init(&controller, &parameters, NULL) ||
        alula_input_default(&input) || overhead_fixture(fixture)) {
        puts("no controller");
        return 1;
    }

    puts("| function | instructions: least | median | most | stack [bytes] |\n|---|---:|---:|---:|---:|");
    measure("alula_step", step_bare, CASES);
    measure("alula_step with feed-forward", step_fed, CASES);
    measure("alula_step with a report", step_reporting, CASES);
    measure("alula_guide", guide, CASES);
    measure("alula_guide with a report", guide_reporting, CASES);
    if (report.mode != ALULA_MODE_FLYING) {
        puts("the guidance does not fly");
        return 1;
    }
    measure("alula_equilibria_at", equilibria_at, 200);
    measure("alula_init", init, 1);
    measure("alula_fold_map_init", map_init, 1);
    measure("alula_fold_margin_at", margin_at, CASES);
    measure("alula_table_init", table_init, 1);
    puts("");

    printf("%-38s %s\n", "", "instructions: least, median, most");
    uint32_t seed = 1;
    static const step laws[] = {overhead_combined, overhead_any, overhead_step, step_bare};
    for (int n = 0; n < CASES; n++) {
        float x[20], law[4];
        draw(&seed, x);
        overhead_case(rust_case, x);
        for (int f = 3; f >= 0; f--)
            counts[f][n] = instructions(laws[f], fixture, rust_case, result);
        if (overhead_result((overhead_any(fixture, rust_case, 0.0f, result), result), law) ||
            command.status & ALULA_STATUS_SAFE || memcmp(law, &command.thrust, 4) || memcmp(law + 1, command.body_rate, 12)) {
            printf("case %d: C and Rust differ\n", n);
            return 1;
        }
    }
    static const char *const law_names[] = {"law, Rust, chosen by type", "law, Rust, chosen at run time",
                                            "the same from a quaternion, Rust", "alula_step"};
    int failed = compare(law_names, 4, 2, 3, STEP_LIMIT);

    static const step guides[] = {overhead_guide_combined, overhead_guide_any, guide, guide_reporting};
    for (int f = 0; f < 4; f++) {
        /* Each from the same memory, over the same cases. */
        seed = 1;
        if (overhead_fixture(fixture) || alula_reset(&controller))
            return 1;
        for (int n = 0; n < CASES; n++) {
            float x[20];
            draw(&seed, x);
            overhead_case(rust_case, x);
            counts[f][n] = instructions(guides[f], fixture, rust_case, result);
            if (f < 2) {
                overhead_guided(result, last[f]);
            } else {
                last[f][0] = command.thrust;
                memcpy(last[f] + 1, command.body_rate, sizeof command.body_rate);
            }
        }
    }
    /* C and Rust fly the same flight to the bit. */
    if (report.mode != ALULA_MODE_FLYING || memcmp(last[1], last[2], sizeof last[2]) ||
        memcmp(last[1], last[3], sizeof last[2])) {
        puts("the guidance does not fly, or C and Rust differ");
        return 1;
    }
    static const char *const guide_names[] = {"guidance, Rust, chosen by type", "guidance, Rust, chosen at run time",
                                              "alula_guide", "alula_guide with a report"};
    return failed | compare(guide_names, 4, 1, 2, GUIDE_LIMIT);
}
