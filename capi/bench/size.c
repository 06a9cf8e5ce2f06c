/*
 * How much the library adds to an image: this program is linked without it and with the functions that PARTS names, and the
 * sizes are compared. It is never run. Both have the C library's memory functions.
 */
#include <string.h>

#include <alula.h>

enum { STEP = 1, GUIDE = 2, ENVELOPE = 4, TABLE = 8, TEXT = 16 };

extern char somewhere[];

int main(void)
{
    void *volatile p = somewhere;
    memcpy(p, (char *)p + 64, *(unsigned *)p);
    memset(p, 0, *(unsigned *)p);
    int32_t code = memcmp(p, (char *)p + 64, *(unsigned *)p);
    if (PARTS & (STEP | GUIDE))
        code |= alula_parameters_default(p) | alula_init(p, p, p);
    if (PARTS & STEP)
        code |= alula_step(p, p, 0.01f, p, p);
    if (PARTS & GUIDE)
        code |= alula_guide(p, p, 0.01f, p, p) | alula_reset(p);
    if (PARTS & ENVELOPE)
        code |= alula_equilibria_at(p, p, p) | alula_fold_map_init(p, p) | alula_fold_margin_at(p, p, p, p);
    if (PARTS & TABLE)
        code |= alula_table_init(p, p, 40, p);
    if (PARTS & TEXT)
        code |= *alula_strerror(code);
    return code;
}
