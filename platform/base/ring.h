/*
 * Places of a ring between one thread that puts and one that takes, header only, without locks. The owner has the
 * elements; a place is an index into them. What was written to a place before ring_put() is seen after ring_get().
 */
#ifndef BLVD_PLATFORM_BASE_RING_H
#define BLVD_PLATFORM_BASE_RING_H

#include <stdatomic.h>
#include <stdint.h>

struct ring {
	uint32_t size; /* a power of two */
	_Atomic uint32_t put, taken;
};

/* Place for the next element, -1 when the ring is full; then ring_put() hands it over. */
static inline int64_t ring_free(const struct ring *ring)
{
	uint32_t put = atomic_load_explicit(&ring->put, memory_order_relaxed);
	uint32_t taken = atomic_load_explicit(&ring->taken, memory_order_acquire);
	return put - taken == ring->size ? -1 : (int64_t)(put & (ring->size - 1));
}

static inline void ring_put(struct ring *ring)
{
	uint32_t put = atomic_load_explicit(&ring->put, memory_order_relaxed);
	atomic_store_explicit(&ring->put, put + 1, memory_order_release);
}

/* Place of the oldest element, -1 when there is none; it stays until ring_take(). */
static inline int64_t ring_get(const struct ring *ring)
{
	uint32_t taken = atomic_load_explicit(&ring->taken, memory_order_relaxed);
	uint32_t put = atomic_load_explicit(&ring->put, memory_order_acquire);
	return put == taken ? -1 : (int64_t)(taken & (ring->size - 1));
}

static inline void ring_take(struct ring *ring)
{
	uint32_t taken = atomic_load_explicit(&ring->taken, memory_order_relaxed);
	atomic_store_explicit(&ring->taken, taken + 1, memory_order_release);
}

#endif
