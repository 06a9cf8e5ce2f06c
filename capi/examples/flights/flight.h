/* What the flights in this directory share: a trace for `replay`, and checked results. */
#ifndef FLIGHT_H
#define FLIGHT_H

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <alula.h>

/* One line of a trace: a letter and the structure's words after the header. */
static inline void record(FILE *file, char letter, const void *structure, size_t size)
{
    fputc(letter, file);
    for (size_t n = sizeof(uint32_t); n < size; n += sizeof(uint32_t)) {
        uint32_t word;
        memcpy(&word, (const char *)structure + n, sizeof word);
        fprintf(file, " %08lx", (unsigned long)word);
    }
    fputc('\n', file);
}

/* The trace named by the program's argument, or NULL if there is none. */
static inline FILE *open_trace(int argc, char **argv)
{
    FILE *trace = NULL;
    if (argc > 1 && !(trace = fopen(argv[1], "w"))) {
        perror(argv[1]);
        exit(1);
    }
    return trace;
}

static inline void close_trace(FILE *trace)
{
    if (trace && (ferror(trace) | fclose(trace))) {
        fputs("the trace could not be written\n", stderr);
        exit(1);
    }
}

/* Ends the program with the library's text of a code that is not ALULA_OK. */
static void must(int32_t code, const char *what)
{
    if (code != ALULA_OK) {
        fprintf(stderr, "%s: %s\n", what, alula_strerror(code));
        exit(1);
    }
}

/* What the paper's section VII says of its vehicle, wrong on purpose. */
static void believe(alula_parameters *parameters)
{
    parameters->header = ALULA_HEADER(alula_parameters);
    must(alula_parameters_default(parameters), "parameters");
    parameters->vehicle.mass = 9.0f;
    parameters->vehicle.k_a = 0.51f;
    parameters->vehicle.thrust_max = 196.2f;
    parameters->coefficients.c0 = 0.020f;
    parameters->coefficients.c1 = 0.9f;
    parameters->coefficients.c2 = 5.0f;
    parameters->coefficients.c3 = 0.5f;
    parameters->coefficients.alpha_bar = 0.17453293f; /* 10 degrees */
}

#endif
