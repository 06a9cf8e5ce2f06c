/* A program without a C library: it has the functions that docs/integrating.md lists of the target, each where HAS_… says that it is listed.
   capi/check links the whole library with it. */
typedef __SIZE_TYPE__ size;

#define MOVE(name)                                   \
    void *name(void *to, const void *from, size n)   \
    {                                                \
        char *a = to;                                \
        const char *b = from;                        \
        if (a <= b)                                  \
            while (n--)                              \
                *a++ = *b++;                         \
        else                                         \
            while (n--)                              \
                a[n] = b[n];                         \
        return to;                                   \
    }
#define COMPARE(name)                                \
    int name(const void *x, const void *y, size n)   \
    {                                                \
        const unsigned char *a = x, *b = y;          \
        for (; n--; a++, b++)                        \
            if (*a != *b)                            \
                return *a - *b;                      \
        return 0;                                    \
    }
#define CLEAR(name)              \
    void name(void *to, size n)  \
    {                            \
        char *a = to;            \
        while (n--)              \
            *a++ = 0;            \
    }

#ifdef HAS_memcpy
MOVE(memcpy)
#endif
#ifdef HAS_bcmp
COMPARE(bcmp)
#endif
#ifdef HAS_memcmp
COMPARE(memcmp)
#endif
#ifdef HAS_memset
void *memset(void *to, int c, size n)
{
    char *a = to;
    while (n--)
        *a++ = (char)c;
    return to;
}
#endif
#ifdef HAS___aeabi_memcpy
MOVE(__aeabi_memcpy)
#endif
#ifdef HAS___aeabi_memcpy4
MOVE(__aeabi_memcpy4)
#endif
#ifdef HAS___aeabi_memcpy8
MOVE(__aeabi_memcpy8)
#endif
#ifdef HAS___aeabi_memmove4
MOVE(__aeabi_memmove4)
#endif
#ifdef HAS___aeabi_memclr
CLEAR(__aeabi_memclr)
#endif
#ifdef HAS___aeabi_memclr4
CLEAR(__aeabi_memclr4)
#endif

int _start(void)
{
    return 0;
}
