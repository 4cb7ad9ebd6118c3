/* A program of a slot: copies the source into the sink while E1 is on, and tells it by A1. */
#include "lineshaft.h"

struct state {
    int64_t offset; /* the source less the sink */
};

LINESHAFT_IMAGE(struct state);

LINESHAFT_CYCLE {
    int on = image.io.inputs & 1;
    if (image.io.command == LINESHAFT_START || !on) {
        image.state.offset = image.io.source - image.io.sink;
    }
    image.io.sink = image.io.source - image.state.offset;
    image.io.outputs = on;
}
