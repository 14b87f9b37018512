/* macOS has no condition variables that wait until a time of the monotonic clock, but some that wait for a time.
 * Included before batch.cpp there. */
#ifndef GIVEWAY_DARWIN_CONDITION_H
#define GIVEWAY_DARWIN_CONDITION_H

#include <pthread.h>
#include <time.h>

static inline int pthread_condattr_setclock(pthread_condattr_t *attributes, clockid_t clock) {
    (void)attributes;
    (void)clock;
    return 0;
}

/* As pthread_cond_timedwait, until a time of the monotonic clock. */
static inline int giveway_wait_until(pthread_cond_t *condition, pthread_mutex_t *mutex, const struct timespec *until) {
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    struct timespec left;
    left.tv_sec = until->tv_sec - now.tv_sec;
    left.tv_nsec = until->tv_nsec - now.tv_nsec;
    if (left.tv_nsec < 0) {
        left.tv_nsec += 1000000000L;
        left.tv_sec -= 1;
    }
    if (left.tv_sec < 0) {
        left.tv_sec = 0;
        left.tv_nsec = 0;
    }
    return pthread_cond_timedwait_relative_np(condition, mutex, &left);
}
#define pthread_cond_timedwait giveway_wait_until

#endif
