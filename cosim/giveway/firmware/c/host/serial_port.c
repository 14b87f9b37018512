/* The line of serial_frames.h on a computer: standard input and output. */
#include "serial_frames.h"

#include <stdio.h>

bool serial_read(uint8_t *byte)
{
    const int found = getchar();
    if (found == EOF) {
        return false;
    }
    *byte = (uint8_t)found;
    return true;
}

void serial_write(const uint8_t *bytes, uint32_t count)
{
    (void)fwrite(bytes, 1U, count, stdout);
    (void)fflush(stdout);
}
