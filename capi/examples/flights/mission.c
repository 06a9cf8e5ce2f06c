/*
 * A mission in C99: up, 150 m away, a hover of 3 s, back, and down, with the plant of the eight and a ground under it.
 *
 *     mission
 *
 * The controller's idea of the aircraft is wrong on purpose, as in the paper. The program prints when each item begins and a sum of all bits
 * of the commands, and checks the touch-down.
 */
#include "flight.h"
#include "plant.h"

#define STEP 0.01
#define MOST_STEPS 9000

static int failures;

static void expect(const char *what, double value, double most)
{
    int good = value <= most;
    printf("%-40s %8.4f   at most %.2f %s\n", what, value, most, good ? "" : "  <-- WRONG");
    failures += !good;
}

/* On the ground the plant stands upright. The speed down at which it last met the ground is left in `met` [m/s]. */
static void ground(double *x, double *met)
{
    if (x[POSITION + 2] < 0.0 || x[VELOCITY + 2] < 0.0)
        return;
    if (x[VELOCITY + 2] > 0.1)
        *met = x[VELOCITY + 2];
    x[POSITION + 2] = 0.0;
    for (int n = 0; n < 3; n++)
        x[VELOCITY + n] = x[RATES + n] = 0.0;
}

int main(void)
{
    alula_parameters parameters;
    believe(&parameters);
    parameters.vehicle.c_y = 0.35f;
    parameters.guidance.max_rate = 3.5f;
    static alula_controller controller;
    controller.header = ALULA_HEADER(alula_controller);
    must(alula_init(&controller, &parameters, NULL), "controller");

    alula_mission_setup setup;
    setup.header = ALULA_HEADER(alula_mission_setup);
    must(alula_mission_default(&setup), "setup");
    setup.parameters.cruise_speed = 20.0f;
    setup.battery = ALULA_RESPONSE_RETURN;
    static alula_mission mission;
    mission.header = ALULA_HEADER(alula_mission);
    must(alula_mission_init(&mission, &setup, &controller), "mission");
    static const alula_mission_item items[] = {
        {.kind = ALULA_ITEM_TAKE_OFF, .value = 10.0f},
        {.kind = ALULA_ITEM_HOVER, .place = {150.0f, 0.0f, -20.0f}, .value = 3.0f},
        {.kind = ALULA_ITEM_RETURN},
    };
    uint32_t refused = 0;
    int32_t code = alula_mission_items(&mission, items, sizeof items / sizeof *items, 0, &refused);
    if (code != ALULA_OK) {
        printf("item %lu: ", (unsigned long)refused);
        must(code, "items");
    }

    alula_input input;
    alula_command command;
    input.header = ALULA_HEADER(alula_input);
    command.header = ALULA_HEADER(alula_command);
    must(alula_input_default(&input), "input");
    input.flags = ALULA_SPECIFIC_FORCE;
    mission.flags = ALULA_ARMED;

    /* Upright, the belly to the north. */
    double x[SIZE] = {0}, met = 0.0, highest = 0.0, farthest = 0.0;
    x[ATTITUDE] = x[ATTITUDE + 2] = sqrt(0.5);
    uint32_t sum = 2166136261u, item = 99, steps = 0;
    while (mission.item < sizeof items / sizeof *items && steps < MOST_STEPS) {
        double force[3];
        specific_force(x, force);
        for (int n = 0; n < 4; n++)
            input.quaternion[n] = (float)x[ATTITUDE + n];
        for (int n = 0; n < 3; n++) {
            input.velocity[n] = (float)x[VELOCITY + n];
            input.specific_force[n] = (float)force[n];
            mission.position[n] = (float)x[POSITION + n];
        }
        must(alula_mission_fly(&mission, &controller, &input, (float)STEP, &command, NULL), "flight");
        if (command.status & ALULA_STATUS_PLAN_DUE)
            must(alula_plan(&controller), "plan");
        if (mission.item != item) {
            printf("%6.2f s  item %lu\n", steps * STEP, (unsigned long)mission.item);
            item = mission.item;
        }
        add(&sum, &command, sizeof command);
        double rates[3] = {(double)command.body_rate[0], (double)command.body_rate[1], (double)command.body_rate[2]};
        fly(x, rates, (double)command.thrust, STEP);
        ground(x, &met);
        highest = fmax(highest, -x[POSITION + 2]);
        farthest = fmax(farthest, x[POSITION]);
        steps++;
    }
    /* Measured: 2 cm, 10 cm, 0.40 m/s, 1 mm. */
    expect("still to fly", 3.0 - mission.item, 0.0);
    expect("highest, off its 20 m", fabs(highest - 20.0), 0.5);
    expect("farthest, off its 150 m", fabs(farthest - 150.0), 3.0);
    expect("touch-down [m/s]", met, 0.6);
    expect("touch-down, off the place [m]", sqrt(x[POSITION] * x[POSITION] + x[POSITION + 1] * x[POSITION + 1]), 0.3);
    expect("thrust after it [N]", (double)command.thrust, 0.0);
    printf("%.1f kJ; all bits of the commands: %08lx\n", (double)mission.energy / 1e3, (unsigned long)sum);
    return failures != 0;
}
