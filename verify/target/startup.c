/* Starts a Cortex-M program under qemu's mps2 boards: vector table, FPU, then the C library's own start-up, whose
 * printf and exit go to the host by semihosting. */
#include <stdint.h>

extern uint32_t stack_top[];
extern void _start(void); /* newlib: clears .bss, calls main, calls exit */

#define CPACR (*(volatile uint32_t *)0xE000ED88U)
#define FPU_FULL_ACCESS (0xFU << 20U)

static void reset(void)
{
#if defined(__ARM_FP)
    CPACR |= FPU_FULL_ACCESS;
    __asm volatile("dsb\n isb");
#endif
    _start();
}

/* A processor fault must not look like a slow program: SYS_EXIT with ADP_Stopped_InternalError makes qemu exit with 1.
 */
static void fault(void)
{
    __asm volatile("mov r0, #0x18\n ldr r1, =0x20024\n bkpt 0xAB\n b .");
}

typedef union {
    uint32_t *stack;
    void (*handler)(void);
} vector_t;

__attribute__((section(".vectors"), used)) static const vector_t vectors[16] = {
    {.stack = stack_top}, {.handler = reset}, {.handler = fault}, /* NMI */
    {.handler = fault},                                           /* hard fault */
    {.handler = fault},                                           /* memory management */
    {.handler = fault},                                           /* bus */
    {.handler = fault},                                           /* usage */
};
