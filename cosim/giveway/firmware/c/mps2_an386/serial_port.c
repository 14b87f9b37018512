/* The line of serial_frames.h on qemu's mps2 boards: the first of Arm's simple UARTs. While nothing arrives the
 * processor sleeps, so that qemu has time for the line; interrupts only wake it, and are never taken. */
#include "serial_frames.h"

typedef struct {
    volatile uint32_t data;
    volatile uint32_t state; /* bit 0: there is no room to send; bit 1: a byte was received */
    volatile uint32_t control;
    volatile uint32_t interrupts; /* writing a one takes it away */
    volatile uint32_t divider;    /* of the board's clock, for the baud rate */
} uart_t;

#define UART ((uart_t *)0x40004000U)
#define FULL 1U
#define RECEIVED 2U
#define SEND_RECEIVE_AND_WAKE 11U
#define DIVIDER_MIN 16U
#define INTERRUPT_ENABLE (*(volatile uint32_t *)0xE000E100U)
#define INTERRUPT_FORGET (*(volatile uint32_t *)0xE000E280U)
#define RECEIVE_INTERRUPT 1U /* bit of number 0 */

static void open_line(void)
{
    if (UART->control != SEND_RECEIVE_AND_WAKE) {
        __asm volatile("cpsid i");
        UART->divider = DIVIDER_MIN;
        UART->control = SEND_RECEIVE_AND_WAKE;
        INTERRUPT_ENABLE = RECEIVE_INTERRUPT;
    }
}

bool serial_read(uint8_t *byte)
{
    open_line();
    while ((UART->state & RECEIVED) == 0U) {
        __asm volatile("wfi");
    }
    UART->interrupts = RECEIVED;
    INTERRUPT_FORGET = RECEIVE_INTERRUPT;
    *byte = (uint8_t)UART->data;
    return true;
}

void serial_write(const uint8_t *bytes, uint32_t count)
{
    open_line();
    for (uint32_t i = 0U; i < count; i++) {
        while ((UART->state & FULL) != 0U) {
        }
        UART->data = bytes[i];
    }
}
