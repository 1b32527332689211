#include "tools/city/report.h"

void report_fault(struct report *report, enum fault_kind kind, enum fault_outcome outcome, int64_t id)
{
	if (!report->faults[kind][FAULT_MENDED] && !report->faults[kind][FAULT_DROPPED])
		report->first_id[kind] = id;
	report->faults[kind][outcome]++;
}
