/*
 * Replays a trace of hover_to_cruise through the library, and prints the bits of every command.
 *
 *     replay TRACE
 *
 * A line of the trace is a letter and the words of a structure after its header: `c` parameters, `n` an input in
 * north-east-down, `p` one in the plane. A line of the output is the words of its command after the header, and of its
 * report in north-east-down.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <alula.h>

static int read_words(const char *text, void *structure, size_t size)
{
    for (size_t n = sizeof(uint32_t); n < size; n += sizeof(uint32_t)) {
        char *end;
        uint32_t word = (uint32_t)strtoul(text, &end, 16);
        if (end == text)
            return 0;
        memcpy((char *)structure + n, &word, sizeof word);
        text = end;
    }
    return *text == '\n';
}

static void print_words(const void *structure, size_t size)
{
    for (size_t n = sizeof(uint32_t); n < size; n += sizeof(uint32_t)) {
        uint32_t word;
        memcpy(&word, (const char *)structure + n, sizeof word);
        printf(" %08lx", (unsigned long)word);
    }
}

int main(int argc, char **argv)
{
    FILE *trace = argc == 2 ? fopen(argv[1], "r") : NULL;
    if (!trace) {
        fprintf(stderr, "usage: replay TRACE\n");
        return 2;
    }
    static alula_controller controller;
    static char line[1024];
    alula_parameters parameters;
    alula_ned_input ned;
    alula_ned_command ned_command;
    alula_ned_report report;
    alula_input plane;
    alula_command plane_command;
    parameters.header = ALULA_HEADER(alula_parameters);
    controller.header = ALULA_HEADER(alula_controller);
    ned.header = ALULA_HEADER(alula_ned_input);
    ned_command.header = ALULA_HEADER(alula_ned_command);
    report.header = ALULA_HEADER(alula_ned_report);
    plane.header = ALULA_HEADER(alula_input);
    plane_command.header = ALULA_HEADER(alula_command);
    for (int number = 1; fgets(line, sizeof line, trace); number++) {
        int32_t code = ALULA_OK;
        int good = 0;
        if (line[0] == 'c' && (good = read_words(line + 1, &parameters, sizeof parameters))) {
            code = alula_init(&controller, &parameters, NULL);
        } else if (line[0] == 'n' && (good = read_words(line + 1, &ned, sizeof ned))) {
            code = alula_step_ned(&controller, &ned, 1e-3f, &ned_command, &report);
            putchar('n');
            print_words(&ned_command, sizeof ned_command);
            print_words(&report, sizeof report);
            putchar('\n');
        } else if (line[0] == 'p' && (good = read_words(line + 1, &plane, sizeof plane))) {
            code = alula_step(&controller, &plane, 1e-3f, &plane_command);
            putchar('p');
            print_words(&plane_command, sizeof plane_command);
            putchar('\n');
        }
        if (!good || code != ALULA_OK) {
            fprintf(stderr, "%s:%d: %s\n", argv[1], number, good ? alula_strerror(code) : "not a line of a trace");
            return 1;
        }
    }
    return 0;
}
