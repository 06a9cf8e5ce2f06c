/* A vehicle of one's own in C: `vehicle.h`, as `alula-sil new` leaves it, and the loop around it, for a second of hover that is asked to climb. */
#include <stdio.h>

#include "vehicle.h"

/* Period of the control loop [s]. */
#define PERIOD 0.01f

static alula_controller controller;
static alula_table table;
static alula_input input;
static alula_command command;

int main(void)
{
    int32_t code = vehicle_init(&controller, &table);
    if (code != ALULA_OK) {
        puts(alula_strerror(code));
        return 1;
    }
    input.header = ALULA_HEADER(alula_input);
    command.header = ALULA_HEADER(alula_command);
    alula_input_default(&input);
    /* What the estimator knows: nose up (the quaternion from nose, right wing and belly to north-east-down), still air. Asked for: 1 m/s up. */
    input.quaternion[0] = 0.70710678f, input.quaternion[2] = 0.70710678f;
    input.reference_velocity[2] = -1.0f;
    for (int step = 0; step < 100; step++) {
        /* The first calls give the safe command: keep the motors to yourself until inputs were good for a while. */
        code = alula_guide(&controller, &input, PERIOD, &command, NULL);
    }
    if (code != ALULA_OK) {
        puts(alula_strerror(code));
        return 1;
    }
    printf("flying: thrust %.1f N\n", (double)command.thrust);
    /* More than the weight of 29.4 N: it is to climb. */
    return command.thrust > 29.4f ? 0 : 1;
}
