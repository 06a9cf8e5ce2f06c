/*
 * The plant of the flights in space: six degrees of freedom, rates lag 100 ms behind their commands, thrust 50 ms.
 *
 * It needs nothing of the C library but the square root, and that is correctly rounded: the same flight comes out on every machine whose
 * double precision is IEEE 754's, to the last bit.
 */
#ifndef PLANT_H
#define PLANT_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

#define PI 3.14159265358979323846

/* Elementary functions from sums and products. */

static inline double sine(double x)
{
    x -= 2.0 * PI * floor(x / (2.0 * PI) + 0.5);
    double square = x * x, sum = 1.0;
    for (int n = 26; n >= 2; n -= 2)
        sum = 1.0 - sum * square / (n * (n + 1));
    return x * sum;
}

static inline double cosine(double x) { return sine(x + 0.5 * PI); }

/* atan2(y, x): of a tangent that is halved three times the series is short. */
static double direction(double y, double x)
{
    double t = y / (sqrt(x * x + y * y) + fabs(x) + 1e-300);
    t /= 1.0 + sqrt(1.0 + t * t);
    t /= 1.0 + sqrt(1.0 + t * t);
    double square = t * t, sum = 0.0;
    for (int n = 17; n >= 1; n -= 2)
        sum = 1.0 / n - square * sum;
    double angle = 8.0 * t * sum;
    return x >= 0.0 ? angle : (y >= 0.0 ? PI : -PI) - angle;
}

/* tanh x = 1 - 2 / (e^2x + 1), of a power of two of a short series. */
static double hyperbolic_tangent(double x)
{
    double y = 2.0 * (x > 20.0 ? 20.0 : x < -20.0 ? -20.0 : x) / 1024.0;
    double power = 1.0 + y * (1.0 + y / 2.0 * (1.0 + y / 3.0 * (1.0 + y / 4.0 * (1.0 + y / 5.0))));
    for (int n = 0; n < 10; n++)
        power *= power;
    return 1.0 - 2.0 / (power + 1.0);
}

/* The plant. World vectors are north, east, down; body axes forward (nose), right (wing), down (belly). */

enum { POSITION = 0, VELOCITY = 3, ATTITUDE = 6, RATES = 10, THRUST = 13, SIZE = 14 };

/* World components of a body vector, or with `back` body components of a world vector. */
static void rotate(const double q[4], const double v[3], double out[3], int back)
{
    double w = back ? -q[0] : q[0], x = q[1], y = q[2], z = q[3];
    double s = 2.0 / (w * w + x * x + y * y + z * z);
    double a = s * (y * v[2] - z * v[1]), b = s * (z * v[0] - x * v[2]), c = s * (x * v[1] - y * v[0]);
    out[0] = v[0] + w * a + y * c - z * b;
    out[1] = v[1] + w * b + z * a - x * c;
    out[2] = v[2] + w * c + x * b - y * a;
}

static double blend(double k, double alpha)
{
    const double alpha_bar = 11.0 * PI / 180.0;
    return (1.0 + hyperbolic_tangent(k * (alpha_bar * alpha_bar - alpha * alpha))) /
           (1.0 + hyperbolic_tangent(k * alpha_bar * alpha_bar));
}

/* Force of air and thrust over the mass [m/s^2], in body axes: what an accelerometer measures. */
static void specific_force(const double *x, double out[3])
{
    const double mass = 10.0, k_a = 0.646, c_y = 0.5, c0 = 0.014, c1 = 0.95, c2 = 5.5, c3 = 0.3;
    double v[3];
    rotate(x + ATTITUDE, x + VELOCITY, v, 1);
    double alpha = direction(v[2], v[0]), speed = sqrt(v[0] * v[0] + v[2] * v[2]) + 1e-300;
    double s = v[2] / speed, c = v[0] / speed, lift_blend = blend(28.0, alpha), drag_blend = blend(167.0, alpha);
    double d = (c2 - c3) * c * c + c3;
    double lift = c2 * c2 * s * c / d * lift_blend + 2.0 * c1 * s * c * (1.0 - lift_blend);
    double drag = c0 + c2 * c3 * s * s / d * drag_blend + 2.0 * c1 * s * s * (1.0 - drag_blend);
    double pressure = k_a * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / mass;
    out[0] = pressure * (lift * v[2] - drag * v[0]) + x[THRUST] / mass;
    out[1] = -pressure * c_y * v[1];
    out[2] = -pressure * (lift * v[0] + drag * v[2]);
}

static void derivative(const double *x, const double rates[3], double thrust, double *out)
{
    double force[3];
    specific_force(x, force);
    rotate(x + ATTITUDE, force, out + VELOCITY, 0);
    out[VELOCITY + 2] += 9.81;
    for (int n = 0; n < 3; n++) {
        out[POSITION + n] = x[VELOCITY + n];
        out[RATES + n] = (rates[n] - x[RATES + n]) / 0.1;
    }
    const double *q = x + ATTITUDE, *r = x + RATES;
    out[ATTITUDE] = -0.5 * (q[1] * r[0] + q[2] * r[1] + q[3] * r[2]);
    out[ATTITUDE + 1] = 0.5 * (q[0] * r[0] + q[2] * r[2] - q[3] * r[1]);
    out[ATTITUDE + 2] = 0.5 * (q[0] * r[1] + q[3] * r[0] - q[1] * r[2]);
    out[ATTITUDE + 3] = 0.5 * (q[0] * r[2] + q[1] * r[1] - q[2] * r[0]);
    out[THRUST] = (thrust - x[THRUST]) / 0.05;
}

/* One step of Runge and Kutta's fourth-order method, commands held. */
static void fly(double *x, const double rates[3], double thrust, double h)
{
    static const double part[] = {0.0, 0.5, 0.5, 1.0}, weight[] = {1.0, 2.0, 2.0, 1.0};
    double k[SIZE] = {0}, sum[SIZE] = {0}, y[SIZE];
    for (int stage = 0; stage < 4; stage++) {
        for (int n = 0; n < SIZE; n++)
            y[n] = x[n] + h * part[stage] * k[n];
        derivative(y, rates, thrust, k);
        for (int n = 0; n < SIZE; n++)
            sum[n] += weight[stage] * k[n];
    }
    for (int n = 0; n < SIZE; n++)
        x[n] += h / 6.0 * sum[n];
    double *q = x + ATTITUDE, length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (int n = 0; n < 4; n++)
        q[n] /= length;
}

/* Fowler, Noll and Vo's sum over the bytes of a structure. */
static void add(uint32_t *sum, const void *structure, size_t size)
{
    for (size_t n = 0; n < size; n++)
        *sum = (*sum ^ ((const unsigned char *)structure)[n]) * 16777619u;
}

#endif
