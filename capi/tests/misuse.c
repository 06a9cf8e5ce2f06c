/*
 * Everything that a C caller can do wrong, in a program built with AddressSanitizer and UBSan. The library itself is not
 * instrumented: every structure is put at the end of a page that is followed by one that may not be touched, so that a
 * byte read or written past it ends the program.
 */
#define _DEFAULT_SOURCE
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include <alula.h>

static unsigned long checks;

#define CHECK(condition)                                                                     \
    do {                                                                                     \
        checks++;                                                                            \
        if (!(condition)) {                                                                  \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                  \
            exit(1);                                                                         \
        }                                                                                    \
    } while (0)

/* Zeroed memory of `size` bytes that ends where the next page, which may not be touched, begins. */
static void *at_the_edge(size_t size)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE), pages = (size + page - 1) / page;
    char *memory = mmap(NULL, (pages + 1) * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    CHECK(memory != MAP_FAILED);
    CHECK(mprotect(memory + pages * page, page, PROT_NONE) == 0);
    return memory + pages * page - size;
}

static alula_parameters *parameters;
static alula_controller *controller;
static alula_input *input;
static alula_command *command;
static alula_report *report;
static alula_equilibria *equilibria;
static alula_fold_map *map;
static alula_fold_margin *margin;
static alula_table *table;
static alula_goal *goal;
static alula_mission_setup *setup;
static alula_mission *mission;

static const alula_mission_item items[] = {
    {.kind = ALULA_ITEM_TAKE_OFF, .value = 10.0f},
    {.kind = ALULA_ITEM_LOITER, .place = {300.0f, 0.0f, -30.0f}, .radius = 150.0f},
};

/* Headers right, defaults in, controller initialised. */
static void tidy(void)
{
    parameters->header = ALULA_HEADER(alula_parameters);
    controller->header = ALULA_HEADER(alula_controller);
    input->header = ALULA_HEADER(alula_input);
    command->header = ALULA_HEADER(alula_command);
    report->header = ALULA_HEADER(alula_report);
    equilibria->header = ALULA_HEADER(alula_equilibria);
    map->header = ALULA_HEADER(alula_fold_map);
    margin->header = ALULA_HEADER(alula_fold_margin);
    table->header = ALULA_HEADER(alula_table);
    goal->header = ALULA_HEADER(alula_goal);
    setup->header = ALULA_HEADER(alula_mission_setup);
    mission->header = ALULA_HEADER(alula_mission);
    CHECK(alula_parameters_default(parameters) == ALULA_OK);
    parameters->vehicle.mass = 10.0f;
    parameters->vehicle.k_a = 0.646f;
    parameters->vehicle.thrust_max = 196.2f;
    CHECK(alula_input_default(input) == ALULA_OK);
    CHECK(alula_command_default(command) == ALULA_OK);
    CHECK(alula_init(controller, parameters, NULL) == ALULA_OK);
    CHECK(alula_fold_map_init(map, controller) == ALULA_OK);
    CHECK(alula_goal_default(goal) == ALULA_OK);
    CHECK(alula_mission_default(setup) == ALULA_OK);
    setup->parameters.cruise_speed = 20.0f;
    CHECK(alula_mission_init(mission, setup, controller) == ALULA_OK);
    CHECK(alula_mission_items(mission, items, 2, 0, NULL) == ALULA_OK);
    mission->flags = ALULA_ARMED;
}

static int is_safe(void)
{
    alula_command safe;
    safe.header = ALULA_HEADER(alula_command);
    return alula_command_default(&safe) == ALULA_OK && memcmp(&safe, command, sizeof safe) == 0;
}

/* Every call that takes the `which`th structure, with the pointer `wrong` in its place. */
static void call_all(int which, void *wrong, int32_t code)
{
    void *p[] = {parameters, controller, input, command, equilibria, map, margin, table, goal, setup, mission};
    p[which] = wrong;
    alula_table_row row = {0.0f, 0.0f, 1.0f};
    if (which == 0) {
        CHECK(alula_parameters_default(p[0]) == code);
        CHECK(alula_parameters_for_vehicle(p[0], 0.1f, 0.05f, 100.0f, 20.0f) == code);
        CHECK(alula_init(p[1], p[0], NULL) == code);
        CHECK(alula_step(p[1], p[2], 0.01f, p[3], NULL) == ALULA_ERROR_NOT_INITIALISED && is_safe());
    }
    if (which == 1) {
        const float vector[3] = {1.0f, 2.0f, 3.0f};
        float pace = 9.0f;
        CHECK(alula_path_time_scale(p[1], vector, vector, &pace) == code && pace == 1.0f);
        CHECK(alula_init(p[1], p[0], NULL) == code);
        CHECK(alula_reset(p[1]) == code);
        CHECK(alula_take_over(p[1], p[2], 0.5f, vector) == code);
        CHECK(alula_fold_map_init(p[5], p[1]) == code);
    }
    if (which == 2)
        CHECK(alula_input_default(p[2]) == code);
    if (which == 1 || which == 2) {
        command->thrust = 1.0f;
        CHECK(alula_step(p[1], p[2], 0.01f, p[3], NULL) == code && is_safe());
        command->thrust = 1.0f;
        CHECK(alula_guide(p[1], p[2], 0.01f, p[3], NULL) == code && is_safe());
        CHECK(alula_equilibria_at(p[1], p[2], p[4]) == code && equilibria->count == 0);
    }
    if (which == 2)
        CHECK(alula_fold_margin_at(p[5], p[1], p[2], p[6]) == code && margin->a == 0.0f);
    if (which == 3) {
        CHECK(alula_command_default(p[3]) == code);
        CHECK(alula_step(p[1], p[2], 0.01f, p[3], NULL) == code);
        CHECK(alula_guide(p[1], p[2], 0.01f, p[3], report) == code);
    }
    if (which == 4)
        CHECK(alula_equilibria_at(p[1], p[2], p[4]) == code);
    if (which == 5) {
        CHECK(alula_fold_map_init(p[5], p[1]) == code);
        CHECK(alula_fold_margin_at(p[5], p[1], p[2], p[6]) == code);
    }
    if (which == 6)
        CHECK(alula_fold_margin_at(p[5], p[1], p[2], p[6]) == code);
    if (which == 7)
        CHECK(alula_table_init(p[7], &row, 1, NULL) == code);
    if (which == 8)
        CHECK(alula_goal_default(p[8]) == code);
    if (which == 9)
        CHECK(alula_mission_default(p[9]) == code);
    if (which == 10)
        CHECK(alula_mission_items(p[10], items, 2, 0, NULL) == code);
    if (which == 1 || which == 2 || which == 10) {
        command->thrust = 1.0f;
        CHECK(alula_mission_fly(p[10], p[1], p[2], 0.01f, p[3], NULL) == code && is_safe());
    }
    if (which == 3)
        CHECK(alula_mission_fly(p[10], p[1], p[2], 0.01f, p[3], NULL) == code);
    if (which == 1 || which == 9 || which == 10) {
        CHECK(alula_mission_init(p[10], p[9], p[1]) == code);
        CHECK(which == 10 || alula_mission_items(mission, items, 2, 0, NULL) == ALULA_ERROR_NOT_INITIALISED);
    }
    if (which == 8 || which == 2) {
        const float position[3] = {1.0f, 2.0f, -3.0f};
        CHECK(alula_goal_step(p[8], position, 0.01f, p[2]) == code);
    }
}

/* Puts every sort of bits into every word of `structure`: each call returns a known code, and with an error a safe command;
 * every number that comes back is finite. */
static void fuzz(void *structure, size_t size, int32_t (*call)(void))
{
    static const uint32_t bits[] = {
        0x7fc00000, 0xffc00001, 0x7f800000, 0xff800000, 0x7f7fffff, 0xff7fffff, 0x00000001, 0x80000001,
        0x007fffff, 0x80000000, 0x3f800000, 0x49742400, 0xffffffff, 0x00000000, 0x7f800001,
    };
    for (size_t n = 1; n < size / 4; n++) {
        for (size_t k = 0; k < sizeof bits / sizeof *bits; k++) {
            tidy();
            memcpy((char *)structure + 4 * n, &bits[k], 4);
            int32_t code = call();
            CHECK(code <= 0 && strcmp(alula_strerror(code), "unknown code") != 0);
        }
    }
}

static int are_finite(const void *numbers, size_t size)
{
    for (size_t n = 8; n < size; n += 4) {
        float value;
        memcpy(&value, (const char *)numbers + n, 4);
        if (!isfinite(value))
            return 0;
    }
    return 1;
}

static int32_t call_init(void)
{
    int32_t code = alula_init(controller, parameters, table);
    command->thrust = 1.0f;
    int32_t stepped = alula_step(controller, input, 0.01f, command, report);
    CHECK(are_finite(command, sizeof *command));
    CHECK(code == ALULA_OK ? stepped != ALULA_ERROR_NOT_INITIALISED : stepped == ALULA_ERROR_NOT_INITIALISED);
    CHECK(stepped == ALULA_OK || is_safe());
    return code;
}

static int32_t call_step(void)
{
    int32_t code = alula_step(controller, input, 0.01f, command, report);
    CHECK(are_finite(command, sizeof *command) && (code == ALULA_OK || is_safe()));
    CHECK(are_finite(&report->phase, sizeof *report - 12));
    int32_t found = alula_equilibria_at(controller, input, equilibria);
    CHECK(found <= 0 && equilibria->count <= ALULA_EQUILIBRIA && (found == ALULA_OK || equilibria->count == 0));
    CHECK(are_finite(equilibria, sizeof *equilibria));
    int32_t near = alula_fold_margin_at(map, controller, input, margin);
    CHECK(near <= 0 && isfinite(margin->a) && isfinite(margin->alpha));
    return code;
}

/* Whatever was remembered or asked for: the guidance flies on, and a good goal is taken again. */
static int32_t call_goal(void)
{
    const float position[3] = {10.0f, 20.0f, -30.0f};
    int32_t code = alula_goal_step(goal, position, 0.01f, input);
    CHECK(alula_guide(controller, input, 0.01f, command, report) <= 0);
    CHECK(are_finite(command, sizeof *command));
    goal->kind = ALULA_GOAL_STOP;
    goal->speed = goal->climb = goal->acceleration = 2.0f;
    goal->braking_climb = 30.0f;
    goal->altitude_band = 0.0f;
    goal->nose_below_vertical = 0;
    goal->target[0] = goal->target[1] = goal->target[2] = 0.0f;
    CHECK(alula_input_default(input) == ALULA_OK);
    for (int n = 0; n < 2; n++)
        CHECK(alula_goal_step(goal, position, 0.01f, input) == ALULA_OK);
    for (int n = 0; n < 3; n++)
        CHECK(isfinite(input->position_error[n]));
    return code;
}

/* What is told, asked for and remembered of a mission may be anything: a command comes, and it is finite. */
static int32_t call_mission(void)
{
    int32_t code = ALULA_OK;
    for (int n = 0; n < 20; n++) {
        code = alula_mission_fly(mission, controller, input, 0.01f, command, report);
        CHECK(are_finite(command, sizeof *command));
        CHECK(isfinite(mission->distance_to_go) && isfinite(mission->energy) && isfinite(mission->right));
    }
    return code;
}

static int32_t call_setup(void)
{
    int32_t code = alula_mission_init(mission, setup, controller);
    CHECK(code == ALULA_OK || alula_mission_items(mission, items, 2, 0, NULL) == ALULA_ERROR_NOT_INITIALISED);
    return code;
}

static int32_t call_guide(void)
{
    int32_t code = ALULA_OK;
    for (int n = 0; n < 20; n++) {
        code = alula_guide(controller, input, 0.01f, command, report);
        CHECK(are_finite(command, sizeof *command) && are_finite(&report->phase, sizeof *report - 12));
        CHECK(command->thrust >= 0.0f && command->thrust <= parameters->vehicle.thrust_max);
    }
    CHECK(code == ALULA_OK || command->status & ALULA_STATUS_SAFE);
    return code;
}

int main(void)
{
    parameters = at_the_edge(sizeof *parameters);
    controller = at_the_edge(sizeof *controller);
    input = at_the_edge(sizeof *input);
    command = at_the_edge(sizeof *command);
    report = at_the_edge(sizeof *report);
    equilibria = at_the_edge(sizeof *equilibria);
    map = at_the_edge(sizeof *map);
    margin = at_the_edge(sizeof *margin);
    table = at_the_edge(sizeof *table);
    goal = at_the_edge(sizeof *goal);
    setup = at_the_edge(sizeof *setup);
    mission = at_the_edge(sizeof *mission);

    /* Memory that was never initialised. */
    CHECK(alula_step(controller, input, 0.01f, command, NULL) == ALULA_ERROR_LAYOUT);

    /* Parameters by rule: all of them, or none. */
    tidy();
    CHECK(alula_parameters_for_vehicle(parameters, 0.4f, 0.05f, 100.0f, 20.0f) == ALULA_OK);
    CHECK(parameters->guidance.rate_lag == 0.4f && parameters->guidance.natural_frequency < 2.5f);
    CHECK(alula_init(controller, parameters, NULL) == ALULA_OK);
    const alula_parameters ruled = *parameters;
    CHECK(alula_parameters_for_vehicle(parameters, 0.1f, 0.05f, 100.0f, 0.0f) == ALULA_ERROR_CRUISE_SPEED);
    CHECK(alula_parameters_for_vehicle(parameters, 0.1f, 0.05f, NAN, 20.0f) == ALULA_ERROR_CONTROL_RATE);
    CHECK(alula_parameters_for_vehicle(parameters, 0.1f, 9.0f, 100.0f, 20.0f) < ALULA_ERROR_PARAMETER);
    CHECK(memcmp(parameters, &ruled, sizeof ruled) == 0);

    for (int which = 0; which < 11; which++) {
        tidy();
        call_all(which, NULL, ALULA_ERROR_NULL);
        /* Unaligned, and not even a header's worth of memory. */
        for (size_t off = 1; off < 4; off++) {
            char *edge = at_the_edge(4);
            tidy();
            call_all(which, edge + off, ALULA_ERROR_UNALIGNED);
        }
        /* A header word alone, with every size and version but the right one. */
        uint64_t *lone = at_the_edge(8);
        for (uint32_t size = 0; size < 6000; size += 4) {
            for (uint32_t version = 0; version < 5; version++) {
                uint32_t header = version << 16 | size;
                static const size_t sizes[] = {
                    sizeof *parameters, sizeof *controller, sizeof *input,  sizeof *command,
                    sizeof *equilibria, sizeof *map,        sizeof *margin, sizeof *table,   sizeof *goal,
                    sizeof *setup,      sizeof *mission,
                };
                if (version == ALULA_ABI_VERSION && size == sizes[which])
                    continue;
                memcpy(lone, &header, 4);
                tidy();
                call_all(which, lone, ALULA_ERROR_LAYOUT);
            }
        }
    }
    tidy();
    report->header++;
    CHECK(alula_guide(controller, input, 0.01f, command, report) == ALULA_ERROR_LAYOUT && is_safe());
    CHECK(alula_step(controller, input, 0.01f, command, report) == ALULA_ERROR_LAYOUT && is_safe());
    tidy();
    CHECK(alula_table_init(table, NULL, 40, NULL) == ALULA_ERROR_NULL);
    parameters->controller.model = ALULA_MODEL_TABLE;
    CHECK(alula_init(controller, parameters, table) == ALULA_ERROR_NOT_INITIALISED);

    fuzz(parameters, sizeof *parameters, call_init);
    fuzz(input, sizeof *input, call_step);
    fuzz(input, sizeof *input, call_guide);
    fuzz(goal, sizeof *goal, call_goal);
    fuzz(setup, sizeof *setup, call_setup);
    /* What it is told: flags and position. */
    fuzz(mission, 5 * sizeof(float), call_mission);
    fuzz(input, sizeof *input, call_mission);

    /* A copy is another controller: the end of the first one does not touch it. */
    tidy();
    alula_controller copy = *controller;
    controller->header = 0;
    CHECK(alula_step(&copy, input, 0.01f, command, NULL) == ALULA_OK);

    for (int32_t code = -400; code < 10; code++)
        CHECK(alula_strerror(code) && strlen(alula_strerror(code)) > 3);
    printf("%lu checks\n", checks);
    return 0;
}
