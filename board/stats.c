#include "board/stats.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <sys/resource.h>
#include <unistd.h>

#include "board/profile.h"
#include "platform/base/clock.h"

/* Values below HISTOGRAM_STEPS have a bin each; above, each factor of two is cut into HISTOGRAM_STEPS / 2 equal bins.
 */
static uint32_t bin_of(uint64_t value)
{
	if (value < HISTOGRAM_STEPS)
		return (uint32_t)value;
	uint32_t shift = 63u - (uint32_t)__builtin_clzll(value) - 6u; /* leaves 64 to 127 */
	uint32_t bin = shift * (HISTOGRAM_STEPS / 2) + (uint32_t)(value >> shift);
	uint32_t last = HISTOGRAM_OCTAVES * HISTOGRAM_STEPS - 1;
	return bin < last ? bin : last;
}

/* The largest value of a bin. */
static uint64_t bin_end(uint32_t bin)
{
	if (bin < HISTOGRAM_STEPS)
		return bin;
	uint32_t shift = bin / (HISTOGRAM_STEPS / 2) - 1;
	uint64_t top = bin - shift * (HISTOGRAM_STEPS / 2);
	return ((top + 1) << shift) - 1;
}

void histogram_add(struct histogram *histogram, uint64_t value)
{
	histogram->bins[bin_of(value)]++;
	histogram->count++;
	if (value > histogram->max)
		histogram->max = value;
}

uint64_t histogram_quantile(const struct histogram *histogram, double quantile)
{
	uint64_t wanted = (uint64_t)ceil(quantile * (double)histogram->count), seen = 0;
	for (uint32_t bin = 0; bin < HISTOGRAM_OCTAVES * HISTOGRAM_STEPS && histogram->count; bin++) {
		seen += histogram->bins[bin];
		if (seen >= wanted && seen)
			return bin_end(bin) < histogram->max ? bin_end(bin) : histogram->max;
	}
	return histogram->max;
}

/* A string from outside (a GL driver's name) with what JSON needs escaped. */
static void print_string(FILE *to, const char *text)
{
	fputc('"', to);
	for (; text && *text; text++) {
		if (*text == '"' || *text == '\\')
			fprintf(to, "\\%c", *text);
		else if ((unsigned char)*text < 0x20)
			fprintf(to, "\\u%04x", (unsigned)*text);
		else
			fputc(*text, to);
	}
	fputc('"', to);
}

static void print_times(FILE *to, const char *name, const struct histogram *h)
{
	fprintf(to, "  \"%s\": {\"median\": %.3f, \"p95\": %.3f, \"p99\": %.3f, \"p999\": %.3f, \"max\": %.3f},\n", name,
		(double)histogram_quantile(h, 0.5) / 1e6, (double)histogram_quantile(h, 0.95) / 1e6,
		(double)histogram_quantile(h, 0.99) / 1e6, (double)histogram_quantile(h, 0.999) / 1e6, (double)h->max / 1e6);
}

static void print_counts(FILE *to, const char *name, const struct histogram *h)
{
	fprintf(to, "  \"%s\": {\"median\": %llu, \"p99\": %llu, \"max\": %llu},\n", name,
		(unsigned long long)histogram_quantile(h, 0.5), (unsigned long long)histogram_quantile(h, 0.99),
		(unsigned long long)h->max);
}

static unsigned long long peak_rss_bytes(void)
{
	struct rusage usage;
	return getrusage(RUSAGE_SELF, &usage) == 0 ? (unsigned long long)usage.ru_maxrss * 1024 : 0;
}

static void print_camera(FILE *to, const struct camera_stats *c)
{
	fprintf(to, "  \"camera\": {\"format\": ");
	print_string(to, c->format);
	fprintf(to,
		", \"frames\": %llu, \"bad\": %llu, \"skipped\": %llu, \"sessions\": %llu, \"decode_ms_max\": %.1f,\n"
		"    \"reversed\": %llu, \"shown\": %llu, \"copied\": %llu, \"in_place\": %llu, \"frozen\": %llu, \"missing\": "
		"%llu, \"too_old\": %llu, "
		"\"withdrawn\": %llu, "
		"\"age_max_ms\": %.1f,\n"
		"    \"edge_to_picture_ms\": {\"median\": %.1f, \"max\": %.1f}},\n",
		(unsigned long long)c->frames, (unsigned long long)c->bad, (unsigned long long)c->skipped,
		(unsigned long long)c->sessions, (double)c->decode_ns_max / 1e6, (unsigned long long)c->reversed,
		(unsigned long long)c->shown, (unsigned long long)c->copied, (unsigned long long)c->in_place,
		(unsigned long long)c->frozen, (unsigned long long)c->missing, (unsigned long long)c->too_old,
		(unsigned long long)c->withdrawn, (double)c->age_ns.max / 1e6,
		(double)histogram_quantile(&c->edge_ns, 0.5) / 1e6, (double)c->edge_ns.max / 1e6);
}

static void print_controls(FILE *to, const struct control_stats *c)
{
	fprintf(to,
		"  \"controls\": {\"edges\": %llu, \"resyncs\": %llu, \"losses\": %llu, \"actions\": %llu, \"dropped\": %llu, "
		"\"fault\": ",
		(unsigned long long)c->edges, (unsigned long long)c->resyncs, (unsigned long long)c->losses,
		(unsigned long long)c->actions, (unsigned long long)c->dropped);
	if (c->fault)
		print_string(to, c->fault);
	else
		fputs("null", to);
	fprintf(to, ",\n    \"view\": \"%s\", \"zoom\": %.4f, \"menu\": %s, \"reverse\": %s, \"ignition\": %s},\n", c->view,
		c->zoom, c->menu_open ? "true" : "false", c->reverse ? "true" : "false", c->ignition ? "true" : "false");
}

void stats_phase(struct stats *stats, const char *name, int64_t began_ns)
{
	struct start_phase now = { name, (double)clock_cpu_ns() / 1e6, (double)(clock_now_ns() - began_ns) / 1e6 };
	for (uint32_t i = 0; i < stats->start_phase_count; i++) {
		now.cpu_ms -= stats->start_phases[i].cpu_ms;
		now.wall_ms -= stats->start_phases[i].wall_ms;
	}
	if (stats->start_phase_count < START_PHASES_MAX)
		stats->start_phases[stats->start_phase_count++] = now;
}

static void print_start(const struct stats *s, FILE *to)
{
	double cpu_ms = 0.0;
	for (uint32_t i = 0; i < s->start_phase_count; i++)
		cpu_ms += s->start_phases[i].cpu_ms;
	fprintf(to, "  \"start_ms\": {\"first_frame\": %.1f, \"cpu\": %.1f, \"phases\": {", s->first_frame_ms, cpu_ms);
	for (uint32_t i = 0; i < s->start_phase_count; i++)
		fprintf(to, "%s\"%s\": {\"cpu\": %.1f, \"wall\": %.1f}", i ? ", " : "", s->start_phases[i].name,
			s->start_phases[i].cpu_ms, s->start_phases[i].wall_ms);
	fprintf(to, "}},\n");
}

static void print_display(const struct stats *s, FILE *to)
{
	const struct display_counts *counts = &s->display_counts;
	fprintf(to, "  \"display\": {\"name\": ");
	print_string(to, s->display);
	fprintf(to, ", \"detail\": ");
	print_string(to, s->display_detail);
	fprintf(to, ", \"flips\": %llu, \"missed\": %llu, \"modesets\": %u, \"hotplugs\": %u, \"switches\": %u},\n",
		(unsigned long long)counts->flips, (unsigned long long)counts->missed, counts->modesets, counts->hotplugs,
		counts->switches);
}

/* Why samples of a signal were not taken, of those signals that have any: {"speed": {"jump": 2}}. */
static void print_signal_faults(const struct stats *s, FILE *to)
{
	const char *between_signals = "";
	fputc('{', to);
	for (int input = 0; input < VEHICLE_INPUT_COUNT; input++) {
		const char *between = "";
		for (int fault = VEHICLE_FAULT_NONE + 1; fault < VEHICLE_FAULT_COUNT; fault++) {
			if (!s->signal_faults[input][fault])
				continue;
			if (!*between)
				fprintf(to, "%s\"%s\": {", between_signals, profile_input_name((enum vehicle_input)input));
			fprintf(to, "%s\"%s\": %u", between, vehicle_fault_name((enum vehicle_fault)fault),
				(unsigned)s->signal_faults[input][fault]);
			between = between_signals = ", ";
		}
		fputs(*between ? "}" : "", to);
	}
	fputc('}', to);
}

static void print_bus(const struct stats *s, FILE *to)
{
	uint64_t errors = 0;
	for (unsigned i = 0; i < s->can_interface_count; i++)
		errors += s->can_interfaces[i].error_frames;
	fprintf(to, "  \"can\": {\"frames_lost\": %llu, \"error_frames\": %llu, \"cpu_ms\": %.1f, \"interfaces\": [",
		(unsigned long long)s->can_frames_lost, (unsigned long long)errors, s->can_cpu_ms);
	for (unsigned i = 0; i < s->can_interface_count; i++) {
		const struct can_interface *interface = &s->can_interfaces[i];
		fprintf(to, "%s{\"name\": ", i ? ", " : "");
		print_string(to, interface->name);
		fprintf(to, ", \"health\": \"%s\", \"frames\": %llu, \"error_frames\": %llu}",
			can_health_name(interface->health), (unsigned long long)interface->frames,
			(unsigned long long)interface->error_frames);
	}
	fputs("]},\n", to);
}

void stats_print_json(const struct stats *s, FILE *to)
{
	fprintf(to, "{\n  \"frames\": %llu,\n  \"renderer\": ", (unsigned long long)s->frames);
	print_string(to, s->renderer);
	fprintf(to, ",\n  \"size\": [%u, %u],\n  \"samples\": %u,\n  \"far\": ", s->width, s->height, s->samples);
	print_string(to, s->far_name);
	fprintf(to, ",\n  \"tau_px\": %g,\n", s->tau_px);
	print_times(to, "frame_ms", &s->frame_ns);
	print_counts(to, "triangles", &s->triangles);
	print_counts(to, "far_triangles", &s->far_triangles);
	print_counts(to, "draws", &s->draws);
	fprintf(to,
		"  \"cells\": {\"entered\": %llu, \"late_frames\": %llu, \"fallback_frames\": %llu, "
		"\"late_cell_frames\": %llu, \"damaged_chunks\": %llu, \"damaged_cells\": %llu, \"error_px\": %.3f},\n",
		(unsigned long long)s->cells_entered, (unsigned long long)s->late_frames,
		(unsigned long long)s->fallback_frames, (unsigned long long)s->late_cell_frames,
		(unsigned long long)s->damaged_chunks, (unsigned long long)s->damaged_cells, s->far_error_px);
	fprintf(to,
		"  \"memory\": {\"budget_bytes\": %llu, \"cpu_high_water_bytes\": %llu, \"gpu_high_water_bytes\": %llu, "
		"\"allocations_after_start\": %llu, \"peak_rss_bytes\": %llu},\n",
		(unsigned long long)s->budget_bytes, (unsigned long long)s->cpu_high_water_bytes,
		(unsigned long long)s->gpu_high_water_bytes, (unsigned long long)s->allocations_after_start, peak_rss_bytes());
	print_start(s, to);
	print_display(s, to);
	fprintf(to, "  \"route\": {\"reroutes\": %llu, \"off_street_frames\": %llu},\n", (unsigned long long)s->reroutes,
		(unsigned long long)s->off_street_frames);
	print_bus(s, to);
	fprintf(to, "  \"record\": {\"lines\": %llu, \"lost\": %llu},\n", (unsigned long long)s->record_lines,
		(unsigned long long)s->record_lost);
	if (s->controls.configured)
		print_controls(to, &s->controls);
	if (s->camera.configured)
		print_camera(to, &s->camera);
	fprintf(to, "  \"vehicle\": {\"frames_in\": %llu, \"frames_bad\": %llu, \"stale_ms_max\": %lld, \"faults\": ",
		(unsigned long long)s->can_frames_in, (unsigned long long)s->can_frames_bad,
		(long long)(s->stale_ns_max / 1000000));
	print_signal_faults(s, to);
	fputs("}\n}\n", to);
}

int stats_write(const struct stats *stats, const char *path)
{
	char part[PATH_MAX];
	if (snprintf(part, sizeof(part), "%s.part", path) >= (int)sizeof(part))
		return -ENAMETOOLONG;
	FILE *file = fopen(part, "w");
	if (!file)
		return -errno;
	stats_print_json(stats, file);
	int status = ferror(file) ? -EIO : 0;
	if (fclose(file) && !status)
		status = -errno;
	if (!status && rename(part, path))
		status = -errno;
	if (status)
		unlink(part);
	return status;
}
