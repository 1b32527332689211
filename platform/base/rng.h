/*
 * Deterministic random numbers: PCG32 (O'Neill, "PCG: A Family of Simple Fast Space-Efficient
 * Statistically Good Algorithms for Random Number Generation", 2014) and a stateless integer hash.
 * The same seed gives the same stream on every machine.
 */
#ifndef BLVD_PLATFORM_BASE_RNG_H
#define BLVD_PLATFORM_BASE_RNG_H

#include <stdint.h>

struct rng {
	uint64_t state;
};

static inline uint32_t rng_u32(struct rng *rng)
{
	uint64_t old = rng->state;
	rng->state = old * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	uint32_t mixed = (uint32_t)(((old >> 18) ^ old) >> 27);
	uint32_t turn = (uint32_t)(old >> 59);
	return (mixed >> turn) | (mixed << (-turn & 31));
}

static inline struct rng rng_seed(uint64_t seed)
{
	struct rng rng = { .state = seed * UINT64_C(0x9E3779B97F4A7C15) + UINT64_C(0xD1B54A32D192ED03) };
	rng_u32(&rng);
	return rng;
}

/* Uniform in [0, 1). */
static inline double rng_unit(struct rng *rng)
{
	return rng_u32(rng) * (1.0 / 4294967296.0);
}

/* Uniform in [low, high). */
static inline double rng_range(struct rng *rng, double low, double high)
{
	return low + (high - low) * rng_unit(rng);
}

/* Well-mixed 64-bit hash of a key (finaliser of MurmurHash3): for choices that belong to an id. */
static inline uint64_t hash_u64(uint64_t key)
{
	key ^= key >> 33;
	key *= UINT64_C(0xFF51AFD7ED558CCD);
	key ^= key >> 33;
	key *= UINT64_C(0xC4CEB9FE1A85EC53);
	key ^= key >> 33;
	return key;
}

#endif
