/* blvd compare: image measures as JSON. */
#include <argp.h>
#include <stdio.h>

#include "platform/base/log.h"
#include "tools/commands.h"
#include "tools/measure/image.h"
#include "tools/measure/metrics.h"

struct compare_options {
	const char *paths[2];
	int count;
	const char *difference;
};

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	struct compare_options *options = state->input;
	switch (key) {
	case 'd':
		options->difference = value;
		return 0;
	case ARGP_KEY_ARG:
		if (options->count == 2)
			argp_error(state, "two pictures at a time");
		options->paths[options->count++] = value;
		return 0;
	case ARGP_KEY_END:
		if (options->count < 2)
			argp_error(state, "two pictures are wanted");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp_option option_table[] = {
	{ "difference", 'd', "FILE.png", 0, "write the difference, eight times enlarged around grey", 0 },
	{ 0 },
};

static const struct argp parser = {
	.options = option_table,
	.parser = parse_option,
	.args_doc = "A.png B.png",
	.doc = "Measures how two pictures of one size differ. A is the reference.",
};

static void print_json(const struct image_difference *d)
{
	printf("{\"max\": %d, \"mean\": %.6f, \"differing\": %.8f, \"within_2\": %.8f, ", d->max, d->mean, d->differing,
		d->within_2);
	if (d->mse > 0.0)
		printf("\"psnr_db\": %.4f, ", d->psnr_db);
	else
		printf("\"psnr_db\": null, ");
	printf("\"ssim\": %.6f}\n", d->ssim);
}

int cmd_compare(int argc, char **argv)
{
	struct compare_options options = { 0 };
	argp_parse(&parser, argc, argv, 0, NULL, &options);
	struct image a = { 0 }, b = { 0 };
	int status = EXIT_BAD_INPUT;
	if (image_read_png(&a, options.paths[0]) < 0 || image_read_png(&b, options.paths[1]) < 0)
		goto done;
	if (a.width != b.width || a.height != b.height) {
		log_error(
			"%s is %u x %u, %s is %u x %u", options.paths[0], a.width, a.height, options.paths[1], b.width, b.height);
		goto done;
	}
	struct image_difference difference;
	image_compare(&a, &b, &difference);
	print_json(&difference);
	status = EXIT_DONE;
	if (options.difference && image_write_difference(&a, &b, options.difference) < 0)
		status = EXIT_FAILED;
done:
	image_finish(&a);
	image_finish(&b);
	return status;
}
