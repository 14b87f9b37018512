/* The controller at the end of a serial line: serial_frames.h says what is spoken there. */
#include "controller_words.h"
#include "main_step.h"
#include "serial_frames.h"

static bool started;

static void refuse(frame_t *frame, refused_t reason)
{
    frame->kind = (uint8_t)FRAME_REFUSED;
    frame->count = 1U;
    frame->words[0] = (uint32_t)reason;
}

static void start(frame_t *frame)
{
    if (frame->count != 0U) {
        refuse(frame, REFUSED_LENGTH);
        return;
    }
    started = robot_start();
    frame->kind = (uint8_t)FRAME_STARTED;
    frame->count = START_WORDS;
    frame->words[0] = SERIAL_VERSION;
    frame->words[1] = ROBOT_DIGEST_LOW;
    frame->words[2] = ROBOT_DIGEST_HIGH;
    frame->words[3] = started ? 1U : 0U;
}

static void tick(frame_t *frame)
{
    static const gw_controller_input_t nothing = {0};
    static gw_controller_output_t output;
    gw_controller_input_t input = nothing;
    if (frame->count != CONTROLLER_INPUT_WORDS) {
        refuse(frame, REFUSED_LENGTH);
        return;
    }
    if (!started) {
        refuse(frame, REFUSED_ORDER);
        return;
    }
    controller_input_from_words(frame->words, &input);
    const gw_status_t status = robot_step(&input, &output);
    frame->kind = (uint8_t)FRAME_ANSWER;
    frame->count = CONTROLLER_OUTPUT_WORDS;
    controller_output_to_words(status, &output, frame->words);
}

/* The robot and its sensors are in the simulation. */
void board_read_sensors(robot_sensors_t *sensors)
{
    (void)sensors;
}

void board_plan(uint32_t path_ticks, gw_plan_t *plan)
{
    (void)path_ticks;
    (void)plan;
}

void board_requests(bool *stop, bool *tare)
{
    *stop = false;
    *tare = false;
}

void board_write_drives(const robot_drives_t *drives)
{
    (void)drives;
}

int main(void)
{
    static frame_t frame;
    while (frame_read(&frame)) {
        if (!frame.intact) {
            refuse(&frame, REFUSED_CHECKSUM);
        } else if (frame.kind == (uint8_t)FRAME_START) {
            start(&frame);
        } else if (frame.kind == (uint8_t)FRAME_TICK) {
            tick(&frame);
        } else {
            refuse(&frame, REFUSED_KIND);
        }
        frame_write(&frame);
    }
    return 0;
}
