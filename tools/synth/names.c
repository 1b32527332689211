/* Street names: made-up people, trees, trades and places, each used once while they last; some need more than ASCII. */
#include <stdio.h>

#include "tools/synth/synth.h"

static const char *const trees[] = { "Linden", "Chestnut", "Plane", "Birch", "Acacia", "Maple", "Hazel", "Alder",
	"Willow", "Poplar", "Rowan", "Cherry", "Walnut", "Juniper", "Elder", "Cypress" };
static const char *const people[] = { "Aurelia", "Béranger", "Castellan", "Dvořák", "Eszter", "Fontanelle", "Grünwald",
	"Halloran", "Ibsen", "Jourdain", "Kessler", "Lindqvist", "Marchetti", "Nørgaard", "Orsini", "Petrović", "Quintana",
	"Rousseau", "Sørensen", "Tarkovsky", "Ulloa", "Valadier", "Wójcik", "Ximenes", "Yıldız", "Zweig", "Almeida",
	"Brandão", "Curie", "Delacroix", "Euler", "Fischer", "Galvani", "Horvat", "Ivanova", "Janáček", "Kovács",
	"Lagrange", "Meitner", "Noether", "Oersted", "Pasteur", "Ramón", "Somerville", "Tesla", "Urey", "Volta", "Weber",
	"Young", "Zeiss" };
static const char *const trades[] = { "Mill", "Cooper", "Baker", "Weaver", "Tanner", "Smith", "Glover", "Potter",
	"Saddler", "Fisher", "Candle", "Rope", "Copper", "Silver", "Salt", "Corn", "Wool", "Barrel", "Lantern", "Bell",
	"Mason", "Fuller", "Dyer", "Cobbler", "Fletcher", "Goldsmith", "Brewer", "Spicer", "Thatcher", "Wheelwright",
	"Chandler", "Parchment" };
static const char *const places[] = { "Harbour", "Station", "Market", "Garden", "Castle", "Bridge", "Abbey", "Orchard",
	"Vineyard", "Meadow", "Spring", "Quarry", "Arsenal", "Observatory", "Theatre", "College", "Customs", "Foundry",
	"Windmill", "Hospital", "Library", "Museum", "Belvedere", "Fortress", "Academy", "Exchange", "Granary", "Mint" };
static const char *const avenues[] = { "Avenue", "Boulevard", "Parade" };
static const char *const streets[] = { "Street", "Street", "Street", "Road", "Row" };
static const char *const lanes[] = { "Lane", "Alley", "Passage", "Steps Lane", "Yard" };
static const char *const closes[] = { "Close", "Way", "Crescent", "Drive", "Gardens" };
static const char *const first[] = { "Anna", "Bruno", "Clara", "Émile", "Frida", "Georg", "Helena", "Igor", "Júlia",
	"Karl", "Léa", "Milan", "Nadia", "Otto", "Paula", "René", "Sofía", "Tomáš", "Ursula", "Viktor" };

const char *pick(struct rng *rng, const char *const *from, size_t count)
{
	return from[rng_u32(rng) % (uint32_t)count];
}

static const char *suffix_of(struct rng *rng, int rank)
{
	switch (rank) {
	case 2:
		return PICK(rng, avenues);
	case 3:
		return PICK(rng, lanes);
	case 4:
		return "Quay";
	case 5:
		return PICK(rng, closes);
	default:
		return PICK(rng, streets);
	}
}

const char *name_street(struct synth *synth, int rank)
{
	struct rng rng = synth_rng(synth, 77, synth->names_used++);
	char text[160];
	const char *suffix = suffix_of(&rng, rank);
	uint32_t kind = rng_u32(&rng) % 10;
	if (rank == 3)
		snprintf(text, sizeof(text), "%s %s", kind < 7 ? PICK(&rng, trades) : PICK(&rng, places), suffix);
	else if (rank == 5)
		snprintf(text, sizeof(text), "%s %s", kind < 6 ? PICK(&rng, trees) : PICK(&rng, people), suffix);
	else if (kind < 3)
		snprintf(text, sizeof(text), "%s %s %s", PICK(&rng, first), PICK(&rng, people), suffix);
	else if (kind < 7)
		snprintf(text, sizeof(text), "%s %s", PICK(&rng, people), suffix);
	else
		snprintf(text, sizeof(text), "%s %s", kind < 9 ? PICK(&rng, places) : PICK(&rng, trees), suffix);
	return pool_string(&synth->city.pool, text);
}
