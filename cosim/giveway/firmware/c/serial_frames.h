/* The controller on a serial line, for simulations with the processor in the loop: the simulation sends the inputs of a
 * tick, the firmware makes one step and answers with the outputs. Nobody waits for a clock: one frame each per tick.
 *
 * A frame, least significant byte first:
 *
 *     byte 0, 1   'g' 'w'
 *     byte 2      kind
 *     byte 3      number of words in it
 *     byte 4..7   counter: the answer has that of the question
 *     ...         words of 32 bits
 *     4 bytes     CRC-32 (polynomial 0xEDB88320, as zip and Ethernet have it) of everything from the kind on
 *
 * Questions: FRAME_START, no words: the controller starts anew. FRAME_TICK, CONTROLLER_INPUT_WORDS.
 * Answers: FRAME_STARTED, START_WORDS: version of this protocol, both halves of ROBOT_DIGEST (lower one first), 1 if
 * the controller started and 0 if it refused its configuration. FRAME_ANSWER, CONTROLLER_OUTPUT_WORDS. FRAME_REFUSED,
 * one word: why. */
#ifndef SERIAL_FRAMES_H
#define SERIAL_FRAMES_H

#include <stdbool.h>
#include <stdint.h>

#define SERIAL_VERSION 1U
#define START_WORDS 4U
#define FRAME_WORDS_MAX 255U

typedef enum {
    FRAME_START = 'S',
    FRAME_TICK = 'T',
    FRAME_STARTED = 's',
    FRAME_ANSWER = 't',
    FRAME_REFUSED = 'e'
} frame_kind_t;

typedef enum {
    REFUSED_CHECKSUM = 1,
    REFUSED_KIND = 2,   /* no question */
    REFUSED_LENGTH = 3, /* another number of words: another version of the controller */
    REFUSED_ORDER = 4   /* a tick before a start that went well */
} refused_t;

typedef struct {
    uint8_t kind;
    uint8_t count; /* of words */
    uint32_t counter;
    uint32_t words[FRAME_WORDS_MAX];
    bool intact; /* the checksum is right */
} frame_t;

/* Waits for the next frame; false: the line was closed. */
bool frame_read(frame_t *frame);
void frame_write(const frame_t *frame);

/* The line, of the computer or board. False: it was closed, which boards' lines never are. */
bool serial_read(uint8_t *byte);
void serial_write(const uint8_t *bytes, uint32_t count);

#endif
