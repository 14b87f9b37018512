/* Start-up of a Cortex-M on qemu's mps2 boards: vector table, memory, FPU, main. No C library is needed. */
#include <stdint.h>

#include "semihosting.h"

extern uint32_t stack_top[];
extern uint32_t data_start[];
extern uint32_t data_end[];
extern const uint32_t data_image[];
extern uint32_t bss_start[];
extern uint32_t bss_end[];

int main(void);

#define CPACR (*(volatile uint32_t *)0xE000ED88U)
#define FPU_FULL_ACCESS (0xFU << 20U)

static void reset(void)
{
    const uint32_t *from = data_image;
    for (uint32_t *to = data_start; to < data_end; to++) {
        *to = *from;
        from++;
    }
    for (uint32_t *to = bss_start; to < bss_end; to++) {
        *to = 0U;
    }
#if defined(__ARM_FP)
    CPACR |= FPU_FULL_ACCESS;
    __asm volatile("dsb\n isb");
#endif
    semihosting_exit(main() == 0);
}

static void fault(void)
{
    semihosting_write("fault\n");
    semihosting_exit(false);
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
