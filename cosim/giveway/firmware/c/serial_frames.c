#include "serial_frames.h"

#define HEAD_BYTES 8U
#define WORD_BYTES 4U

static uint32_t crc_of(uint32_t crc, uint8_t byte)
{
    crc ^= byte;
    for (uint32_t bit = 0U; bit < 8U; bit++) {
        crc = (crc >> 1U) ^ (((crc & 1U) != 0U) ? 0xEDB88320U : 0U);
    }
    return crc;
}

static bool read_counted(uint32_t *crc, uint8_t *byte)
{
    if (!serial_read(byte)) {
        return false;
    }
    *crc = crc_of(*crc, *byte);
    return true;
}

static bool read_word(uint32_t *crc, uint32_t *word)
{
    *word = 0U;
    for (uint32_t i = 0U; i < WORD_BYTES; i++) {
        uint8_t byte;
        if (!read_counted(crc, &byte)) {
            return false;
        }
        *word |= (uint32_t)byte << (8U * i);
    }
    return true;
}

static bool find_beginning(void)
{
    uint8_t before = 0U;
    uint8_t byte = 0U;
    while ((before != (uint8_t)'g') || (byte != (uint8_t)'w')) {
        before = byte;
        if (!serial_read(&byte)) {
            return false;
        }
    }
    return true;
}

bool frame_read(frame_t *frame)
{
    uint32_t crc = 0xFFFFFFFFU;
    uint32_t ignored = 0U;
    uint32_t sent;
    if (!find_beginning() || !read_counted(&crc, &frame->kind) || !read_counted(&crc, &frame->count) ||
        !read_word(&crc, &frame->counter)) {
        return false;
    }
    for (uint32_t i = 0U; i < frame->count; i++) {
        if (!read_word(&crc, &frame->words[i])) {
            return false;
        }
    }
    if (!read_word(&ignored, &sent)) {
        return false;
    }
    frame->intact = (sent == ~crc);
    return true;
}

static void put_word(uint8_t *bytes, uint32_t word)
{
    for (uint32_t i = 0U; i < WORD_BYTES; i++) {
        bytes[i] = (uint8_t)(word >> (8U * i));
    }
}

void frame_write(const frame_t *frame)
{
    static uint8_t bytes[HEAD_BYTES + (WORD_BYTES * (FRAME_WORDS_MAX + 1U))];
    const uint32_t end = HEAD_BYTES + (WORD_BYTES * frame->count);
    uint32_t crc = 0xFFFFFFFFU;
    bytes[0] = (uint8_t)'g';
    bytes[1] = (uint8_t)'w';
    bytes[2] = frame->kind;
    bytes[3] = frame->count;
    put_word(&bytes[4], frame->counter);
    for (uint32_t i = 0U; i < frame->count; i++) {
        put_word(&bytes[HEAD_BYTES + (WORD_BYTES * i)], frame->words[i]);
    }
    for (uint32_t i = 2U; i < end; i++) {
        crc = crc_of(crc, bytes[i]);
    }
    put_word(&bytes[end], ~crc);
    serial_write(bytes, end + WORD_BYTES);
}
