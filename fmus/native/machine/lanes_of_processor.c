#include "lanes/lanes.h"

#ifdef HAS_WIDE_VECTORS

#include <cpuid.h>

/* Whether the processor has AVX2, and the system keeps its registers. */
static bool has_wide_vectors(void)
{
    enum { VECTORS_KEPT = 6 }; /* of xmm and ymm */
    unsigned a, b, c, d, kept, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE) || !__get_cpuid_count(7, 0, &a, &b, &c, &d) ||
        !(b & bit_AVX2)) {
        return false;
    }
    __asm__ volatile("xgetbv" : "=a"(kept), "=d"(high) : "c"(0));
    return (kept & VECTORS_KEPT) == VECTORS_KEPT;
}

#endif

const LaneFunctions *lanes_of_processor(void)
{
#if defined(HAS_WIDE_VECTORS)
    return has_wide_vectors() ? &wide_functions : &lane_functions;
#elif defined(HAS_LANES)
    return &lane_functions;
#else
    return NULL;
#endif
}
