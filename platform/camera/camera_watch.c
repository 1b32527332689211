#include "platform/camera/camera_watch.h"

#define AHEAD_OF_TIME_NS INT64_C(50000000) /* clocks of a driver and ours may differ by so much */

bool camera_watch_frame(struct camera_watch *watch, const struct camera_frame *frame, int64_t now_ns)
{
	bool same_session = watch->any && frame->session == watch->session;
	bool older = same_session && (frame->time_ns <= watch->frame_ns || frame->sequence == watch->sequence);
	if (older || frame->time_ns > now_ns + AHEAD_OF_TIME_NS) {
		watch->backwards++;
		return false;
	}
	if (!same_session || frame->digest != watch->digest || !watch->look_for_repeats)
		watch->changed_ns = frame->time_ns;
	watch->any = true;
	watch->session = frame->session;
	watch->sequence = frame->sequence;
	watch->digest = frame->digest;
	watch->frame_ns = frame->time_ns;
	watch->waiting_ns = 0;
	return true;
}

enum watch_state camera_watch_state(struct camera_watch *watch, enum camera_link link, int64_t now_ns, int64_t ahead_ns)
{
	bool fresh = watch->any && now_ns + ahead_ns - watch->frame_ns <= WATCH_AGE_NS;
	if (link == CAMERA_ABSENT) {
		watch->any = false;
		watch->waiting_ns = 0;
		return WATCH_MISSING;
	}
	if (fresh && watch->frame_ns - watch->changed_ns < WATCH_REPEAT_NS)
		return WATCH_LIVE;
	if (watch->any)
		return WATCH_FROZEN;
	if (!watch->waiting_ns)
		watch->waiting_ns = now_ns;
	return now_ns - watch->waiting_ns < WATCH_START_NS ? WATCH_STARTING : WATCH_MISSING;
}
