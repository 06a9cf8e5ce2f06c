/*
 * An eight in C99: 200 m long and 65 m wide, at 22 m/s, by the guidance, with a plant of this program's own.
 *
 *     eight [TRACE]
 *
 * The plant has six degrees of freedom: rates lag 100 ms behind their commands, thrust 50 ms. The controller's idea of the
 * aircraft is wrong on purpose, as in the paper: mass, wing, side force. It has an accelerometer to make up for it. The eight
 * is flown twice: by rates and thrust, and by attitude and thrust, with an attitude loop of the plant's own.
 *
 * The plant needs nothing of the C library but the square root, and that is correctly rounded: the same flight comes out
 * on every machine whose double precision is IEEE 754's, to the last bit. The program prints a sum of all bits of the
 * flight, and checks the figures. With a file name it leaves there what the library was given, for `replay`.
 */
#include "flight.h"
#include "plant.h"

#define SPEED 22.0
#define STEP 0.01
#define STEPS 6000
#define SUBSTEPS 2
/* Figures are taken from here on [s]. */
#define SETTLED 20.0

/* The path, by a parameter that advances with the flight, so that an error along the track is not made up by speed alone. */

struct target {
    double position[3], velocity[3], acceleration[3];
};

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void aim(const alula_controller *controller, double *phase, const double position[3], struct target *target)
{
    const double a = 100.0, b = 65.0;
    double s = sine(*phase), c = cosine(*phase), s2 = sine(2.0 * *phase), c2 = cosine(2.0 * *phase);
    double point[3] = {a * s, 0.5 * b * s2, 0.0}, first[3] = {a * c, b * c2, 0.0}, second[3] = {-a * s, -2.0 * b * s2, 0.0};
    double length = sqrt(dot(first, first)), rate = SPEED / length;
    double change = -rate * rate * dot(first, second) / (length * length);
    float error[3], velocity[3], waits;
    for (int n = 0; n < 3; n++) {
        error[n] = (float)(position[n] - point[n]);
        velocity[n] = (float)(first[n] * rate);
    }
    must(alula_path_time_scale(controller, error, velocity, &waits), "pace");
    double pace = (double)waits;
    *phase += rate * pace * STEP;
    for (int n = 0; n < 3; n++) {
        target->position[n] = point[n];
        target->velocity[n] = first[n] * rate * pace;
        target->acceleration[n] = (second[n] * rate * rate + first[n] * change) * pace * pace;
    }
}

/* The plant and its target as an autopilot has them. */
static void sense(const double *x, const struct target *target, alula_input *input)
{
    double force[3];
    specific_force(x, force);
    for (int n = 0; n < 4; n++)
        input->quaternion[n] = (float)x[ATTITUDE + n];
    for (int n = 0; n < 3; n++) {
        input->velocity[n] = (float)x[VELOCITY + n];
        input->specific_force[n] = (float)force[n];
        input->position_error[n] = (float)(x[POSITION + n] - target->position[n]);
        input->reference_velocity[n] = (float)target->velocity[n];
        input->reference_acceleration[n] = (float)target->acceleration[n];
    }
}

static int failures;

static void expect(const char *what, double value, double most)
{
    int good = value <= most;
    printf("%-40s %8.4f   at most %.2f %s\n", what, value, most, good ? "" : "  <-- WRONG");
    failures += !good;
}

/* An autopilot's attitude loop: the rates that turn the attitude to the set-point, by a proportional gain. */
static void turn_to(const double *q, const float set_point[4], double gain, double rates[3])
{
    const float *s = set_point;
    double w = q[0] * s[0] + q[1] * s[1] + q[2] * s[2] + q[3] * s[3], k = w < 0.0 ? -2.0 * gain : 2.0 * gain;
    rates[0] = k * (q[0] * s[1] - q[1] * s[0] - q[2] * s[3] + q[3] * s[2]);
    rates[1] = k * (q[0] * s[2] + q[1] * s[3] - q[2] * s[0] - q[3] * s[1]);
    rates[2] = k * (q[0] * s[3] - q[1] * s[2] + q[2] * s[1] - q[3] * s[0]);
}

/* One flight; adds its bits to the sum. */
static void flight(int by_attitude, FILE *trace, uint32_t *sum)
{
    alula_parameters parameters;
    believe(&parameters);
    parameters.vehicle.c_y = 0.35f;
    parameters.guidance.max_rate = 3.5f;
    parameters.guidance.max_lateral_acceleration = 3.0f;

    static alula_controller controller;
    controller.header = ALULA_HEADER(alula_controller);
    must(alula_init(&controller, &parameters, NULL), "controller");
    alula_input input;
    alula_command command;
    alula_report report;
    input.header = ALULA_HEADER(alula_input);
    command.header = ALULA_HEADER(alula_command);
    report.header = ALULA_HEADER(alula_report);
    must(alula_input_default(&input), "input");
    input.flags = ALULA_POSITION | ALULA_SPECIFIC_FORCE;
    if (trace)
        record(trace, 'c', &parameters, sizeof parameters);

    /* Level to the north at 22 m/s, 4 degrees nose up; the path sets out to the north-east. */
    double x[SIZE] = {0}, phase = 0.0, velocity = 0.0, position = 0.0, sideslip = 0.0, fastest = 0.0, upright = 1.0;
    x[VELOCITY] = SPEED;
    x[ATTITUDE] = cosine(2.0 * PI / 180.0);
    x[ATTITUDE + 2] = sine(2.0 * PI / 180.0);
    x[THRUST] = 5.0;
    int seen = 0;
    for (int n = 0; n < STEPS; n++) {
        struct target target;
        aim(&controller, &phase, x + POSITION, &target);
        sense(x, &target, &input);
        must(alula_guide(&controller, &input, (float)STEP, &command, &report), "guidance");
        if (command.status & ALULA_STATUS_PLAN_DUE)
            must(alula_plan(&controller), "plan");
        if (trace)
            record(trace, 'g', &input, sizeof input);
        add(sum, &input, sizeof input);
        add(sum, &command, sizeof command);
        add(sum, &report, sizeof report);
        if (n * STEP >= SETTLED) {
            double v[3], off[3], away[3], wing[3];
            const double right[3] = {0.0, 1.0, 0.0};
            rotate(x + ATTITUDE, x + VELOCITY, v, 1);
            rotate(x + ATTITUDE, right, wing, 0);
            for (int k = 0; k < 3; k++) {
                off[k] = x[VELOCITY + k] - target.velocity[k];
                away[k] = x[POSITION + k] - target.position[k];
            }
            velocity += dot(off, off);
            position += dot(away, away);
            sideslip += v[1] * v[1] / dot(v, v);
            upright = fmin(upright, sqrt(1.0 - wing[2] * wing[2]));
            seen++;
        }
        double rates[3] = {(double)command.body_rate[0], (double)command.body_rate[1], (double)command.body_rate[2]};
        for (int k = 0; k < 3; k++)
            fastest = fmax(fastest, fabs(rates[k]));
        for (int k = 0; k < SUBSTEPS; k++) {
            if (by_attitude)
                turn_to(x + ATTITUDE, command.quaternion, (double)parameters.controller.attitude_gain, rates);
            fly(x, rates, (double)command.thrust, STEP / SUBSTEPS);
        }
    }
    add(sum, x, sizeof x);

    puts(by_attitude ? "by attitude and thrust" : "by rates and thrust");
    /* By rates 0.27 m/s, 0.23 m and 0.23 degrees, by attitude 0.27, 0.27 and 0.23. */
    expect("  velocity error, rms [m/s]", sqrt(velocity / seen), 0.3);
    expect("  position error, rms [m]", sqrt(position / seen), 0.4);
    expect("  sideslip, rms [deg]", sqrt(sideslip / seen) * 180.0 / PI, 0.5);
    expect("  largest angular rate commanded [rad/s]", fastest, 3.5);
    printf("  largest bank of the wing [deg] %.1f\n", direction(sqrt(1.0 - upright * upright), upright) * 180.0 / PI);
}

int main(int argc, char **argv)
{
    FILE *trace = open_trace(argc, argv);
    uint32_t sum = 2166136261u;
    flight(0, trace, &sum);
    flight(1, trace, &sum);
    close_trace(trace);
    printf("all bits of both flights: %08lx\n", (unsigned long)sum);
    return failures != 0;
}
