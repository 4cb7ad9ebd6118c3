/* What a program and its slot tell each other. The slot fills it before each call and reads it behind. */
#ifndef LINESHAFT_H
#define LINESHAFT_H

#include <stdint.h>

/* `command` in the call of RESET, in the first call (and behind an exchange that keeps no state), in every other call. */
#define LINESHAFT_RESET 0
#define LINESHAFT_START 1
#define LINESHAFT_NONE 255

/* A signal: a whole number or a bit as i, a real as f, as the signal is. */
typedef union {
    int64_t i;
    double f;
} lineshaft_word;

/* The first 944 bytes of each image. */
typedef struct {
    uint32_t size;               /* bytes of the image, the program's own state included; never write it */
    uint8_t command;             /* see above */
    uint8_t inputs;              /* E1 in bit 0 to E8 in bit 7 */
    uint8_t outputs;             /* A1 in bit 0 to A8 in bit 7, as they are; what is left here they become */
    uint8_t reserved;
    int64_t source;              /* the source, as wide as the cell says, sign-extended */
    int64_t travel;              /* the way of the source since START, which never wraps */
    int64_t sink;                /* the sink, as it is; what is left here it becomes */
    int64_t call_ns;             /* time between two calls (ns) */
    lineshaft_word reads[16];    /* the signals of `reads` in the cell */
    lineshaft_word writes[16];   /* the memory cells of `writes` in the cell, as they are; what is left here they become */
    int64_t parameters[16];      /* `parameter` of the set, from START on */
    uint32_t db_words;           /* words of the table of the cell; 0 without one */
    uint32_t reserved_too;
    uint16_t db[256];            /* its words, from START on */
} lineshaft_image;

_Static_assert(sizeof(lineshaft_image) == 944, "the image is 944 bytes long");

/* The image of a program that keeps `type` from call to call, as `image.state`, zeros at first; the linker exports it. */
#define LINESHAFT_IMAGE(type)                                           \
    typedef struct {                                                    \
        lineshaft_image io;                                             \
        type state;                                                     \
    } program_image;                                                    \
    program_image image = {{sizeof(program_image)}}

/* The one function: `LINESHAFT_CYCLE { .. }`. */
#define LINESHAFT_CYCLE __attribute__((export_name("cycle"))) void cycle(void)

#endif
