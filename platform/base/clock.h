/* The only place that asks the system what time it is. Everything else is handed a time. */
#ifndef BLVD_PLATFORM_BASE_CLOCK_H
#define BLVD_PLATFORM_BASE_CLOCK_H

#include <stdint.h>

#define NS_PER_S INT64_C(1000000000)
#define NS_PER_MS INT64_C(1000000)

/* Monotonic time in ns; the origin is arbitrary. */
int64_t clock_now_ns(void);

/* Wall clock in ns since 1970-01-01 UTC; may step. */
int64_t clock_wall_ns(void);

/* CPU time of this process in ns. */
int64_t clock_cpu_ns(void);

/* CPU time of the calling thread in ns. */
int64_t clock_thread_ns(void);

/* Sleeps until the monotonic time `deadline_ns`; returns at once when it has passed. */
void clock_sleep_until(int64_t deadline_ns);

#endif
