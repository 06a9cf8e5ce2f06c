/*
 * Start-up of a C program on QEMU's netduinoplus2, an STM32F405: memory, floating point unit, semihosting, main.
 * Faults end the emulation with a failure.
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

extern uint32_t data_start[], data_end[], data_load[], bss_start[], bss_end[], stack_top[];
extern void initialise_monitor_handles(void);
extern int main(int argc, char **argv);

static int semihost(int operation, void *argument)
{
    register int r0 __asm__("r0") = operation;
    register void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void fault(void)
{
    enum { SYS_EXIT_EXTENDED = 0x20, RUN_TIME_ERROR = 0x20023 };
    uint32_t block[2] = {RUN_TIME_ERROR, 1};
    semihost(SYS_EXIT_EXTENDED, block);
    for (;;)
        ;
}

static void __attribute__((used)) run(void)
{
    memcpy(data_start, data_load, (size_t)((char *)data_end - (char *)data_start));
    memset(bss_start, 0, (size_t)((char *)bss_end - (char *)bss_start));
    initialise_monitor_handles();

    enum { SYS_GET_CMDLINE = 0x15, MOST = 8 };
    static char line[256], *argv[MOST + 1];
    struct {
        char *text;
        uint32_t length;
    } block = {line, sizeof line};
    int argc = 0;
    if (semihost(SYS_GET_CMDLINE, &block) == 0)
        for (char *word = strtok(line, " "); word && argc < MOST; word = strtok(NULL, " "))
            argv[argc++] = word;
    exit(main(argc, argv));
}

static void __attribute__((naked)) reset(void)
{
    __asm__ volatile("ldr r0, =0xe000ed88\n" /* CPACR: let everyone use the floating point unit. */
                     "ldr r1, [r0]\n"
                     "orr r1, r1, #0xf00000\n"
                     "str r1, [r0]\n"
                     "dsb\n"
                     "isb\n"
                     "b run\n");
}

static const struct {
    uint32_t *stack;
    void (*handler[15])(void);
} vectors __attribute__((section(".vectors"), used)) = {
    stack_top,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault},
};
