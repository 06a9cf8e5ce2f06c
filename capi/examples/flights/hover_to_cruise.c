/*
 * Hover to cruise in C99: the flight of the paper's section VII by the bare law, with a plant of this program's own.
 *
 *     hover_to_cruise [TRACE]
 *
 * The aircraft flies in the vertical plane of a heading; what the library gets and gives is north-east-down and
 * forward-right-down, as in an autopilot. The controller's idea of the aircraft is wrong on purpose, as in the paper.
 * The program checks its flight against the paper's figures. With a file name it leaves there what the library was
 * given, every hundredth of a second, for `replay`.
 */
#include "flight.h"

#define PI 3.14159265358979323846
#define HEADING 0.7
#define STEP 1e-3
#define STEPS 20000

/* The plant, in double precision: down, forward, angle of the tail from down. */
struct plant {
    double down, forward, theta;
};

static double blend(double k, double alpha)
{
    const double alpha_bar = 11.0 * PI / 180.0;
    return (1.0 + tanh(k * alpha_bar * alpha_bar - k * alpha * alpha)) / (1.0 + tanh(k * alpha_bar * alpha_bar));
}

/* Derivative of the state under a thrust [N] and an angular rate [rad/s]. */
static struct plant derivative(const struct plant *x, double thrust, double rate)
{
    const double mass = 10.0, k_a = 0.646, gravity = 9.81;
    const double c0 = 0.014, c1 = 0.95, c2 = 5.5, c3 = 0.3;
    double alpha = x->theta - atan2(x->forward, x->down) + PI;
    alpha -= 2.0 * PI * floor((alpha + PI) / (2.0 * PI));
    double s = sin(alpha), c = cos(alpha), lift_blend = blend(28.0, alpha), drag_blend = blend(167.0, alpha);
    double d = (c2 - c3) * c * c + c3;
    double lift = c2 * c2 * s * c / d * lift_blend + 2.0 * c1 * s * c * (1.0 - lift_blend);
    double drag = c0 + c2 * c3 * s * s / d * drag_blend + 2.0 * c1 * s * s * (1.0 - drag_blend);
    double pressure = k_a * sqrt(x->down * x->down + x->forward * x->forward) / mass;
    struct plant derivative = {
        gravity - pressure * (lift * x->forward + drag * x->down) - thrust / mass * cos(x->theta),
        pressure * (lift * x->down - drag * x->forward) - thrust / mass * sin(x->theta),
        rate,
    };
    return derivative;
}

static struct plant ahead(const struct plant *x, const struct plant *k, double h)
{
    struct plant y = {x->down + h * k->down, x->forward + h * k->forward, x->theta + h * k->theta};
    return y;
}

/* One step of Runge and Kutta's fourth-order method, thrust and rate held. */
static void fly(struct plant *x, double thrust, double rate)
{
    struct plant k1 = derivative(x, thrust, rate), y = ahead(x, &k1, STEP / 2);
    struct plant k2 = derivative(&y, thrust, rate);
    y = ahead(x, &k2, STEP / 2);
    struct plant k3 = derivative(&y, thrust, rate);
    y = ahead(x, &k3, STEP);
    struct plant k4 = derivative(&y, thrust, rate);
    x->down += STEP / 6 * (k1.down + 2 * k2.down + 2 * k3.down + k4.down);
    x->forward += STEP / 6 * (k1.forward + 2 * k2.forward + 2 * k3.forward + k4.forward);
    x->theta += STEP * rate;
}

/* The plant and its reference as an autopilot's estimator gives them: north-east-down, and the quaternion of the fixed-wing body. */
static void sense(const struct plant *x, double t, alula_input *input)
{
    double speed = t < 10.0 ? 2.0 * t : 20.0, acceleration = t < 10.0 ? 2.0 : 0.0;
    double north = cos(HEADING), east = sin(HEADING), pitch = x->theta + PI / 2;
    input->quaternion[0] = (float)(cos(HEADING / 2) * cos(pitch / 2));
    input->quaternion[1] = (float)(-sin(HEADING / 2) * sin(pitch / 2));
    input->quaternion[2] = (float)(cos(HEADING / 2) * sin(pitch / 2));
    input->quaternion[3] = (float)(sin(HEADING / 2) * cos(pitch / 2));
    input->velocity[0] = (float)(x->forward * north);
    input->velocity[1] = (float)(x->forward * east);
    input->velocity[2] = (float)x->down;
    input->reference_velocity[0] = (float)(speed * north);
    input->reference_velocity[1] = (float)(speed * east);
    input->reference_acceleration[0] = (float)(acceleration * north);
    input->reference_acceleration[1] = (float)(acceleration * east);
}

static int failures;

static void expect(const char *what, double value, double wanted, double tolerance)
{
    int good = fabs(value - wanted) <= tolerance;
    printf("%-32s %8.4f   paper %8.4f +- %.4f %s\n", what, value, wanted, tolerance, good ? "" : "  <-- WRONG");
    failures += !good;
}

int main(int argc, char **argv)
{
    FILE *trace = open_trace(argc, argv);
    alula_parameters parameters;
    believe(&parameters);
    parameters.controller.gains = ALULA_GAINS_CONSTANT;

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
    must(alula_command_default(&command), "command");
    if (trace)
        record(trace, 'c', &parameters, sizeof parameters);

    struct plant x = {0.0, 0.0, 0.0};
    double worst = 0.0, worst_at = 0.0, fastest = 0.0, least = INFINITY, error = 0.0, aside = 0.0;
    for (int n = 0; n < STEPS; n++) {
        double t = n * STEP;
        sense(&x, t, &input);
        must(alula_step(&controller, &input, (float)STEP, &command, &report), "step");
        if (trace && n % 10 == 0)
            record(trace, 's', &input, sizeof input);
        error = hypot(x.down, x.forward - (t < 10.0 ? 2.0 * t : 20.0));
        if (error > worst) {
            worst = error;
            worst_at = t;
        }
        fastest = fmax(fastest, fabs((double)command.body_rate[1]));
        aside = fmax(aside, fmax(fabs((double)command.body_rate[0]), fabs((double)command.body_rate[2])));
        least = fmin(least, (double)report.f_p_norm);
        fly(&x, (double)command.thrust, (double)command.body_rate[1]);
    }
    close_trace(trace);

    /* The tolerances are what single precision, and the order of a step's evaluations, leave of the paper's flight in
     * double precision: |F_p| nearly vanishes at 8 s, and what happens there is amplified. */
    expect("largest velocity error [m/s]", worst, 0.863, 0.01);
    expect("  at [s]", worst_at, 8.215, 0.03);
    expect("least |F_p| [N]", least, 2.6, 0.6);
    expect("largest angular rate [rad/s]", fastest, 12.1, 0.4);
    /* Nothing leaves the plane: what is left is rounding of the quaternion. */
    expect("largest rate out of the plane", aside, 0.0, 1e-3);
    expect("last velocity error [m/s]", error, 0.0132, 0.001);
    expect("last pitch [deg]", x.theta * 180.0 / PI + 90.0, 90.0 - 85.97, 0.02);
    expect("last thrust to weight", (double)command.thrust / 98.1, 0.0410, 0.0006);
    return failures != 0;
}
