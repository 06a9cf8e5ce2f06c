/*
 * Replays a trace of hover_to_cruise or eight through the library, and prints the bits of every command.
 *
 *     replay TRACE
 *
 * A line of the trace is a letter and the words of a structure after its header: `c` parameters, `s` an input of
 * alula_step, `g` one of alula_guide, every hundredth of a second. A line of the output is the letter and the words after
 * the header of the command and of the report.
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
    alula_input input;
    alula_command command;
    alula_report report;
    parameters.header = ALULA_HEADER(alula_parameters);
    controller.header = ALULA_HEADER(alula_controller);
    input.header = ALULA_HEADER(alula_input);
    command.header = ALULA_HEADER(alula_command);
    report.header = ALULA_HEADER(alula_report);
    for (int number = 1; fgets(line, sizeof line, trace); number++) {
        int32_t code = ALULA_OK;
        int good = 0;
        if (line[0] == 'c' && (good = read_words(line + 1, &parameters, sizeof parameters))) {
            code = alula_init(&controller, &parameters, NULL);
        } else if ((line[0] == 's' || line[0] == 'g') && (good = read_words(line + 1, &input, sizeof input))) {
            if (line[0] == 's')
                code = alula_step(&controller, &input, 0.01f, &command, &report);
            else
                code = alula_guide(&controller, &input, 0.01f, &command, &report);
            if (line[0] == 'g' && code == ALULA_OK && (command.status & ALULA_STATUS_PLAN_DUE))
                code = alula_plan(&controller);
            putchar(line[0]);
            print_words(&command, sizeof command);
            print_words(&report, sizeof report);
            putchar('\n');
        }
        if (!good || code != ALULA_OK) {
            fprintf(stderr, "%s:%d: %s\n", argv[1], number, good ? alula_strerror(code) : "not a line of a trace");
            return 1;
        }
    }
    return 0;
}
