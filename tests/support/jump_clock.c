// Preloaded: every FAULT_JUMP_EVERY-th look at the wall clock finds it an hour further or an hour back in turn, as where somebody
// sets it or a machine wakes up. With FAULT_JUMP_ALL the clock that is promised to be steady jumps likewise, forwards only.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/time.h>
#include <time.h>

static atomic_long looks;

/* [s] */
static long jump(clockid_t clock)
{
    const char* every = getenv("FAULT_JUMP_EVERY");
    const int wall = clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE;
    if (!every || (!wall && !(getenv("FAULT_JUMP_ALL") && clock == CLOCK_MONOTONIC))) return 0;
    const long turn = atomic_fetch_add(&looks, 1) / atol(every);
    return wall ? 3600 * (turn % 3 - 1) : 3600 * turn;
}

int clock_gettime(clockid_t clock, struct timespec* now)
{
    static int (*real)(clockid_t, struct timespec*);
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, "clock_gettime");
    const int status = real(clock, now);
    if (status == 0) now->tv_sec += jump(clock);
    return status;
}

int gettimeofday(struct timeval* restrict now, void* restrict zone)
{
    (void)zone;
    struct timespec fine;
    if (clock_gettime(CLOCK_REALTIME, &fine) != 0) return -1;
    now->tv_sec = fine.tv_sec;
    now->tv_usec = fine.tv_nsec / 1000;
    return 0;
}

time_t time(time_t* out)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (out) *out = now.tv_sec;
    return now.tv_sec;
}
