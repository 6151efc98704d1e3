// Preloaded: from the FAULT_WRITE-th write, rename or fsync under FAULT_DIR on, each fails as on a full disk.
// The process takes FAULT_EXIT_MS longer to end, as where a driver closes slowly.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static atomic_long count;

static int is_full(const char* path)
{
    const char* dir = getenv("FAULT_DIR");
    const char* first = getenv("FAULT_WRITE");
    if (!dir || !first || strncmp(path, dir, strlen(dir)) != 0) return 0;
    return atomic_fetch_add(&count, 1) + 1 >= atol(first);
}

static int is_full_at(int fd)
{
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t size = readlink(link, path, sizeof path - 1);
    if (size <= 0) return 0;
    path[size] = 0;
    return is_full(path);
}

ssize_t write(int fd, const void* bytes, size_t size)
{
    static ssize_t (*real)(int, const void*, size_t);
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, "write");
    if (is_full_at(fd)) return errno = ENOSPC, -1;
    return real(fd, bytes, size);
}

int fsync(int fd)
{
    static int (*real)(int);
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, "fsync");
    if (is_full_at(fd)) return errno = ENOSPC, -1;
    return real(fd);
}

int rename(const char* from, const char* to)
{
    static int (*real)(const char*, const char*);
    if (!real) *(void**)&real = dlsym(RTLD_NEXT, "rename");
    if (is_full(to)) return errno = ENOSPC, -1;
    return real(from, to);
}

__attribute__((destructor)) static void linger(void)
{
    const char* ms = getenv("FAULT_EXIT_MS");
    if (ms) usleep(1000 * atoi(ms));
}
