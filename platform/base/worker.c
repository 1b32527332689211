#include "platform/base/worker.h"

#include "platform/base/thread.h"

#define STACK_BYTES (256u << 10)

static void *run(void *argument)
{
	struct worker *worker = argument;
	pthread_mutex_lock(&worker->mutex);
	for (;;) {
		while (!worker->stop && worker->done == worker->given)
			pthread_cond_wait(&worker->given_more, &worker->mutex);
		if (worker->stop)
			break;
		uint32_t job = worker->jobs[worker->done % WORKER_JOBS_MAX];
		pthread_mutex_unlock(&worker->mutex);
		worker->work(worker->context, job);
		pthread_mutex_lock(&worker->mutex);
		worker->done++;
		pthread_cond_signal(&worker->done_more);
	}
	pthread_mutex_unlock(&worker->mutex);
	return NULL;
}

int worker_init(struct worker *worker, const char *name, void (*work)(void *context, uint32_t job), void *context)
{
	*worker = (struct worker){ .work = work, .context = context };
	pthread_mutex_init(&worker->mutex, NULL);
	pthread_cond_init(&worker->given_more, NULL);
	pthread_cond_init(&worker->done_more, NULL);
	int status = thread_start(&worker->thread, name, STACK_BYTES, run, worker);
	worker->started = status == 0;
	return status;
}

void worker_finish(struct worker *worker)
{
	if (worker->started) {
		pthread_mutex_lock(&worker->mutex);
		worker->stop = true;
		pthread_cond_signal(&worker->given_more);
		pthread_mutex_unlock(&worker->mutex);
		pthread_join(worker->thread, NULL);
	}
	if (worker->work) {
		pthread_cond_destroy(&worker->done_more);
		pthread_cond_destroy(&worker->given_more);
		pthread_mutex_destroy(&worker->mutex);
	}
	*worker = (struct worker){ 0 };
}

bool worker_give(struct worker *worker, uint32_t job)
{
	pthread_mutex_lock(&worker->mutex);
	bool room = worker->given - worker->taken < WORKER_JOBS_MAX;
	if (room) {
		worker->jobs[worker->given++ % WORKER_JOBS_MAX] = job;
		pthread_cond_signal(&worker->given_more);
	}
	pthread_mutex_unlock(&worker->mutex);
	return room;
}

bool worker_take(struct worker *worker, bool wait, uint32_t *job)
{
	pthread_mutex_lock(&worker->mutex);
	while (wait && worker->taken == worker->done && worker->done < worker->given)
		pthread_cond_wait(&worker->done_more, &worker->mutex);
	bool any = worker->taken < worker->done;
	if (any)
		*job = worker->jobs[worker->taken++ % WORKER_JOBS_MAX];
	pthread_mutex_unlock(&worker->mutex);
	return any;
}
