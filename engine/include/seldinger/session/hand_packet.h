/* The packets of the hand channel (D14): plain C, for a device's firmware as for the session itself.
 *
 * A device sends a request of 48 bytes to the session's UDP port at its own rate; every request that is accepted is answered with
 * 72 bytes. Little-endian, IEEE doubles, no padding. What is lost or late does no harm: the newest request counts, and the answer
 * is of the newest step. */
#ifndef SELDINGER_HAND_PACKET_H
#define SELDINGER_HAND_PACKET_H

#include <stdint.h> /* NOLINT(modernize-deprecated-headers): not only C++ */
#include <string.h> /* NOLINT(modernize-deprecated-headers) */

#define SEL_HAND_REQUEST_MAGIC 0x484C4553u /* "SELH" */
#define SEL_HAND_ANSWER_MAGIC 0x464C4553u  /* "SELF" */
#define SEL_HAND_VERSION 1u
#define SEL_HAND_REQUEST_BYTES 48
#define SEL_HAND_ANSWER_BYTES 72

/* flags of a request */
#define SEL_HAND_FLUOROSCOPY 1u /* the pedal is down */
#define SEL_HAND_CONTRAST 2u    /* contrast is being injected */
#define SEL_HAND_REBASE 4u      /* where the hand is now is where the instrument is: a device that was switched on again */

/* flags of an answer */
#define SEL_HAND_PAUSED 1u  /* no step is taken */
#define SEL_HAND_STOPPED 2u /* nor will be before a reset: the last step found no state */
#define SEL_HAND_LATE 4u    /* the newest step was late */
#define SEL_HAND_CUT 8u     /* force or torque were larger than what is sent */
#define SEL_HAND_REACHED 16u /* the task's target has been reached */
#define SEL_HAND_SHORT 32u  /* the newest step ended at its deadline, before its equations held */

typedef struct SelHandRequest {
    uint16_t instrument;
    uint64_t sequence;  /* rises with every request of a device for an instrument */
    double time_s;      /* the device's own clock [s] */
    double advance_m;   /* pushed in since the start [m] */
    double rotation_rad; /* turned since the start, right-handed about the direction of insertion [rad] */
    uint32_t flags;
} SelHandRequest;

typedef struct SelHandAnswer {
    uint16_t instrument;
    uint64_t sequence; /* of the request that is answered */
    uint64_t step;     /* the newest one */
    double time_s;     /* session time at its end [s] */
    double force_n;    /* against the hand, + resists insertion [N] */
    double torque_nm;  /* likewise, + resists rotation [N m] */
    double force_per_advance_n_m; /* what the force grows by when the hand is pushed on [N/m] */
    double advance_m;  /* of the instrument [m] */
    uint32_t late;     /* steps that were late so far */
    uint32_t flags;
} SelHandAnswer;

static inline void sel_put(unsigned char** at, uint64_t value, int bytes)
{
    int k;
    for (k = 0; k < bytes; ++k) *(*at)++ = (unsigned char)(value >> (8 * k));
}

static inline uint64_t sel_get(const unsigned char** at, int bytes)
{
    uint64_t value = 0;
    int k;
    for (k = 0; k < bytes; ++k) value |= (uint64_t) * (*at)++ << (8 * k);
    return value;
}

static inline void sel_put_double(unsigned char** at, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, 8);
    sel_put(at, bits, 8);
}

static inline double sel_get_double(const unsigned char** at)
{
    const uint64_t bits = sel_get(at, 8);
    double value;
    memcpy(&value, &bits, 8);
    return value;
}

static inline void sel_write_request(const SelHandRequest* r, unsigned char bytes[SEL_HAND_REQUEST_BYTES])
{
    unsigned char* at = bytes;
    sel_put(&at, SEL_HAND_REQUEST_MAGIC, 4);
    sel_put(&at, SEL_HAND_VERSION, 2);
    sel_put(&at, r->instrument, 2);
    sel_put(&at, r->sequence, 8);
    sel_put_double(&at, r->time_s);
    sel_put_double(&at, r->advance_m);
    sel_put_double(&at, r->rotation_rad);
    sel_put(&at, r->flags, 4);
    sel_put(&at, 0, 4);
}

/* Returns 1 when these are a request: size, magic, version and the zero at the end are right. Values are not looked at. */
static inline int sel_read_request(const unsigned char* bytes, size_t size, SelHandRequest* r)
{
    const unsigned char* at = bytes;
    if (size != SEL_HAND_REQUEST_BYTES) return 0;
    if (sel_get(&at, 4) != SEL_HAND_REQUEST_MAGIC || sel_get(&at, 2) != SEL_HAND_VERSION) return 0;
    r->instrument = (uint16_t)sel_get(&at, 2);
    r->sequence = sel_get(&at, 8);
    r->time_s = sel_get_double(&at);
    r->advance_m = sel_get_double(&at);
    r->rotation_rad = sel_get_double(&at);
    r->flags = (uint32_t)sel_get(&at, 4);
    return sel_get(&at, 4) == 0;
}

static inline void sel_write_answer(const SelHandAnswer* a, unsigned char bytes[SEL_HAND_ANSWER_BYTES])
{
    unsigned char* at = bytes;
    sel_put(&at, SEL_HAND_ANSWER_MAGIC, 4);
    sel_put(&at, SEL_HAND_VERSION, 2);
    sel_put(&at, a->instrument, 2);
    sel_put(&at, a->sequence, 8);
    sel_put(&at, a->step, 8);
    sel_put_double(&at, a->time_s);
    sel_put_double(&at, a->force_n);
    sel_put_double(&at, a->torque_nm);
    sel_put_double(&at, a->force_per_advance_n_m);
    sel_put_double(&at, a->advance_m);
    sel_put(&at, a->late, 4);
    sel_put(&at, a->flags, 4);
}

/* Returns 1 when these are an answer. */
static inline int sel_read_answer(const unsigned char* bytes, size_t size, SelHandAnswer* a)
{
    const unsigned char* at = bytes;
    if (size != SEL_HAND_ANSWER_BYTES) return 0;
    if (sel_get(&at, 4) != SEL_HAND_ANSWER_MAGIC || sel_get(&at, 2) != SEL_HAND_VERSION) return 0;
    a->instrument = (uint16_t)sel_get(&at, 2);
    a->sequence = sel_get(&at, 8);
    a->step = sel_get(&at, 8);
    a->time_s = sel_get_double(&at);
    a->force_n = sel_get_double(&at);
    a->torque_nm = sel_get_double(&at);
    a->force_per_advance_n_m = sel_get_double(&at);
    a->advance_m = sel_get_double(&at);
    a->late = (uint32_t)sel_get(&at, 4);
    a->flags = (uint32_t)sel_get(&at, 4);
    return 1;
}

#endif
