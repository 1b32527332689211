/*
 * One thread beside the frame's, that does jobs in the order in which they are given. A job is a number; what it means
 * is the owner's. What the giver wrote before worker_give() the job sees, and what the job wrote the giver sees after
 * worker_take(). Signals stay with the other threads.
 */
#ifndef BLVD_PLATFORM_BASE_WORKER_H
#define BLVD_PLATFORM_BASE_WORKER_H

#include <pthread.h>
#include <stdbool.h>
#include <stdint.h>

#define WORKER_JOBS_MAX 64 /* given and not yet taken */

struct worker {
	pthread_t thread;
	pthread_mutex_t mutex; /* guards all below; held only to look at the counters */
	pthread_cond_t given_more, done_more;
	void (*work)(void *context, uint32_t job);
	void *context;
	uint32_t jobs[WORKER_JOBS_MAX];
	uint64_t given, done, taken; /* jobs so far: taken <= done <= given */
	bool stop, started;
};

/* `name` is for debuggers, at most 15 characters. Returns 0 or -errno. */
int worker_init(struct worker *worker, const char *name, void (*work)(void *context, uint32_t job), void *context);
/* Waits for the job at hand and drops the rest. Accepts a zeroed worker. */
void worker_finish(struct worker *worker);

/* Returns false when WORKER_JOBS_MAX are under way. */
bool worker_give(struct worker *worker, uint32_t job);

/* The oldest job that is done and not yet taken. With `wait` it waits for the oldest one given. Returns false when
 * there is none. */
bool worker_take(struct worker *worker, bool wait, uint32_t *job);

#endif
