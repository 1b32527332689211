/* A thread beside the frame's: signals stay with the others, and its stack is as small as it needs. */
#ifndef BLVD_PLATFORM_BASE_THREAD_H
#define BLVD_PLATFORM_BASE_THREAD_H

#include <pthread.h>
#include <stddef.h>

/* `name` is for debuggers, at most 15 characters. Returns 0 or -errno; on 0 the caller joins *thread. */
int thread_start(pthread_t *thread, const char *name, size_t stack_bytes, void *(*run)(void *context), void *context);

#endif
