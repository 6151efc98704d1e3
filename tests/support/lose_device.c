// Preloaded: from the FAULT_DEVICE-th command on, every command to an OpenCL device fails as where the device is gone.
#define _GNU_SOURCE
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdlib.h>

static atomic_long count;

static int is_lost(void)
{
    const char* first = getenv("FAULT_DEVICE");
    return first && atomic_fetch_add(&count, 1) + 1 >= atol(first);
}

#define PASS_ON(name, types, ...)                                   \
    cl_int name types                                               \
    {                                                               \
        static cl_int(*real) types;                                 \
        if (!real) *(void**)&real = dlsym(RTLD_NEXT, #name);        \
        return is_lost() ? CL_DEVICE_NOT_AVAILABLE : real(__VA_ARGS__); \
    }

PASS_ON(clEnqueueNDRangeKernel,
        (cl_command_queue queue, cl_kernel kernel, cl_uint dimensions, const size_t* offset, const size_t* global, const size_t* local,
         cl_uint waits, const cl_event* wait_for, cl_event* event),
        queue, kernel, dimensions, offset, global, local, waits, wait_for, event)
PASS_ON(clEnqueueReadBuffer,
        (cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t bytes, void* to, cl_uint waits,
         const cl_event* wait_for, cl_event* event),
        queue, buffer, blocking, offset, bytes, to, waits, wait_for, event)
PASS_ON(clEnqueueWriteBuffer,
        (cl_command_queue queue, cl_mem buffer, cl_bool blocking, size_t offset, size_t bytes, const void* from, cl_uint waits,
         const cl_event* wait_for, cl_event* event),
        queue, buffer, blocking, offset, bytes, from, waits, wait_for, event)
PASS_ON(clFinish, (cl_command_queue queue), queue)
