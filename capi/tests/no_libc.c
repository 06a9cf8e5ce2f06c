/* A program without a C library: it has the functions that docs/integrating.md lists, each where HAS_… says that it is listed, and Arm's names for
   them. capi/check links the whole library with it. */
typedef __SIZE_TYPE__ size;

#ifdef HAS_memcpy
void *memcpy(void *to, const void *from, size n)
{
    char *a = to;
    const char *b = from;
    while (n--)
        *a++ = *b++;
    return to;
}
#endif
#ifdef HAS_memmove
void *memmove(void *to, const void *from, size n)
{
    char *a = to;
    const char *b = from;
    if (a <= b)
        while (n--)
            *a++ = *b++;
    else
        while (n--)
            a[n] = b[n];
    return to;
}
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
#ifdef HAS_memcmp
int memcmp(const void *x, const void *y, size n)
{
    const unsigned char *a = x, *b = y;
    for (; n--; a++, b++)
        if (*a != *b)
            return *a - *b;
    return 0;
}
#endif
#ifdef HAS_bcmp
int bcmp(const void *x, const void *y, size n)
{
    const unsigned char *a = x, *b = y;
    for (; n--; a++, b++)
        if (*a != *b)
            return 1;
    return 0;
}
#endif
#ifdef HAS_sqrtf
float sqrtf(float x)
{
    return __builtin_sqrtf(x);
}
#endif

#ifdef __arm__
#define MOVE(name, by)                                    \
    void name(void *to, const void *from, size n) { by(to, from, n); }
#define SET(name) \
    void name(void *to, size n, int c) { memset(to, c, n); }
#define CLEAR(name) \
    void name(void *to, size n) { memset(to, 0, n); }
MOVE(__aeabi_memcpy, memcpy)
MOVE(__aeabi_memcpy4, memcpy)
MOVE(__aeabi_memcpy8, memcpy)
#ifdef HAS_memmove
MOVE(__aeabi_memmove, memmove)
MOVE(__aeabi_memmove4, memmove)
MOVE(__aeabi_memmove8, memmove)
#endif
SET(__aeabi_memset)
SET(__aeabi_memset4)
SET(__aeabi_memset8)
CLEAR(__aeabi_memclr)
CLEAR(__aeabi_memclr4)
CLEAR(__aeabi_memclr8)
#endif

int _start(void)
{
    return 0;
}
