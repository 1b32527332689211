/* A record that outlives power cuts, on a disk made of memory that can be cut off at any step and any byte. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/record.h"

#define FILES 8
#define FILE_BYTES 512
#define VERSION 3

/* What a medium may do with what was not synced when the power goes. */
enum loss {
	LOSS_NONE,    /* all of it arrived after all */
	LOSS_CONTENT, /* names arrived, content did not: files are as they were when last synced */
	LOSS_NAMES,   /* content arrived, names did not */
	LOSS_ALL,
	LOSS_ZEROS, /* lengths arrived, content is zeros */
	LOSS_COUNT,
};

struct content {
	uint8_t bytes[FILE_BYTES];
	size_t size;
};

struct inode {
	bool used;
	struct content now, synced;
};

struct name {
	char path[64];
	int inode; /* -1: no such name */
};

/* Names and contents, as the program sees them and as they are on the medium. */
struct disk {
	struct inode inodes[32];
	struct name now[FILES], synced[FILES];
	long steps_left; /* calls and written bytes until the power goes; negative: never */
	bool dead;
	bool full;
};

static bool step(struct disk *disk)
{
	if (disk->dead)
		return false;
	if (disk->steps_left == 0)
		disk->dead = true;
	else if (disk->steps_left > 0)
		disk->steps_left--;
	return !disk->dead;
}

static struct name *name_of(struct name *names, const char *path, bool make)
{
	struct name *free_one = NULL;
	for (int i = 0; i < FILES; i++) {
		if (names[i].inode >= 0 && !strcmp(names[i].path, path))
			return &names[i];
		if (names[i].inode < 0)
			free_one = &names[i];
	}
	if (make && free_one)
		snprintf(free_one->path, sizeof(free_one->path), "%s", path);
	return make ? free_one : NULL;
}

static int disk_create(void *context, const char *path)
{
	struct disk *disk = context;
	if (!step(disk))
		return -EIO;
	struct name *name = name_of(disk->now, path, true);
	if (name->inode < 0)
		for (int i = 0; i < 32 && name->inode < 0; i++)
			if (!disk->inodes[i].used)
				name->inode = i;
	assert_true(name->inode >= 0);
	disk->inodes[name->inode].used = true;
	disk->inodes[name->inode].now.size = 0;
	return name->inode;
}

static int64_t disk_write(void *context, int fd, const void *bytes, size_t size)
{
	struct disk *disk = context;
	struct content *to = &disk->inodes[fd].now;
	size_t done = 0;
	for (; done < size; done++) {
		if (!step(disk))
			return -EIO;
		if (disk->full && to->size >= 20)
			return done ? (int64_t)done : -ENOSPC;
		to->bytes[to->size++] = ((const uint8_t *)bytes)[done];
	}
	return (int64_t)done;
}

static int disk_sync(void *context, int fd)
{
	struct disk *disk = context;
	if (!step(disk))
		return -EIO;
	disk->inodes[fd].synced = disk->inodes[fd].now;
	return 0;
}

static int disk_close(void *context, int fd)
{
	(void)fd;
	return step(context) ? 0 : -EIO;
}

static int disk_rename(void *context, const char *from, const char *to)
{
	struct disk *disk = context;
	if (!step(disk))
		return -EIO;
	struct name *source = name_of(disk->now, from, false), *target = name_of(disk->now, to, true);
	assert_non_null(source);
	target->inode = source->inode;
	source->inode = -1;
	return 0;
}

static int disk_remove(void *context, const char *path)
{
	struct disk *disk = context;
	if (!step(disk))
		return -EIO;
	struct name *name = name_of(disk->now, path, false);
	if (!name)
		return -ENOENT;
	name->inode = -1;
	return 0;
}

static int disk_sync_folder(void *context, const char *path)
{
	struct disk *disk = context;
	(void)path;
	if (!step(disk))
		return -EIO;
	memcpy(disk->synced, disk->now, sizeof(disk->synced));
	return 0;
}

static int64_t disk_read(void *context, const char *path, void *bytes, size_t size)
{
	struct disk *disk = context;
	const struct name *name = name_of(disk->now, path, false);
	if (!name)
		return -ENOENT;
	const struct content *from = &disk->inodes[name->inode].now;
	size_t n = from->size < size ? from->size : size;
	memcpy(bytes, from->bytes, n);
	return (int64_t)n;
}

static const struct file_ops disk_ops = {
	.create = disk_create,
	.write = disk_write,
	.sync = disk_sync,
	.close = disk_close,
	.rename = disk_rename,
	.remove = disk_remove,
	.sync_folder = disk_sync_folder,
	.read = disk_read,
};

static void disk_init(struct disk *disk)
{
	memset(disk, 0, sizeof(*disk));
	for (int i = 0; i < FILES; i++)
		disk->now[i].inode = disk->synced[i].inode = -1;
	disk->steps_left = -1;
}

/* The power comes back. */
static void restart(struct disk *disk, enum loss loss)
{
	if (loss == LOSS_NAMES || loss == LOSS_ALL)
		memcpy(disk->now, disk->synced, sizeof(disk->now));
	for (int i = 0; i < 32; i++) {
		struct inode *inode = &disk->inodes[i];
		if (loss == LOSS_CONTENT || loss == LOSS_ALL)
			inode->now = inode->synced;
		if (loss == LOSS_ZEROS && inode->synced.size != inode->now.size)
			memset(inode->now.bytes, 0, sizeof(inode->now.bytes));
		inode->synced = inode->now;
	}
	memcpy(disk->synced, disk->now, sizeof(disk->synced));
	disk->dead = false;
	disk->steps_left = -1;
}

struct payload {
	uint32_t serial;
	char filling[40];
};

static struct payload payload_of(uint32_t serial)
{
	struct payload out = { .serial = serial };
	memset(out.filling, (int)(serial * 37), sizeof(out.filling));
	return out;
}

static uint32_t found_serial(struct disk *disk, struct record *record)
{
	struct payload found;
	int size = record_open(record, &disk_ops, disk, "/state", "position", VERSION, &found, sizeof(found));
	if (size == 0)
		return 0;
	assert_int_equal(size, sizeof(found));
	struct payload expected = payload_of(found.serial);
	assert_memory_equal(&found, &expected, sizeof(found));
	return found.serial;
}

/* Saves 1, 2, 3... until the power goes. Returns the last whose save was reported done. */
static uint32_t save_until_cut(struct disk *disk, uint32_t first, uint32_t last)
{
	struct record record;
	uint32_t done = 0;
	found_serial(disk, &record);
	for (uint32_t serial = first; serial <= last; serial++) {
		struct payload payload = payload_of(serial);
		if (record_save(&record, VERSION, &payload, sizeof(payload)) == 0)
			done = serial;
		if (disk->dead)
			break;
	}
	return done;
}

static void a_cut_at_any_step_or_byte_leaves_the_newest_whole_record(void **state)
{
	(void)state;
	unsigned cuts = 0, kept = 0;
	for (int loss = 0; loss < LOSS_COUNT; loss++) {
		for (long at = 0;; at++, cuts++) {
			struct disk disk;
			struct record record;
			disk_init(&disk);
			disk.steps_left = at;
			uint32_t done = save_until_cut(&disk, 1, 5);
			bool cut = disk.dead;
			restart(&disk, (enum loss)loss);
			uint32_t found = found_serial(&disk, &record);
			assert_in_range(found, done, done + 1);
			kept += found == done + 1;
			/* and it goes on from there, through a second cut */
			disk.steps_left = at % 97;
			uint32_t again = save_until_cut(&disk, 11, 12);
			restart(&disk, (enum loss)loss);
			uint32_t later = found_serial(&disk, &record);
			assert_true(later == (again ? again : found) || later == (again ? again + 1 : 11));
			if (!cut)
				break;
		}
	}
	assert_true(cuts > 1000 && kept > 0);
}

static void a_full_disk_keeps_what_was_and_leaves_no_part(void **state)
{
	(void)state;
	struct disk disk;
	struct record record;
	disk_init(&disk);
	assert_int_equal(save_until_cut(&disk, 1, 2), 2);
	disk.full = true;
	assert_int_equal(found_serial(&disk, &record), 2);
	struct payload payload = payload_of(3);
	for (int i = 0; i < 5; i++)
		assert_int_equal(record_save(&record, VERSION, &payload, sizeof(payload)), -ENOSPC);
	assert_null(name_of(disk.now, "/state/position.new", false));
	assert_int_equal(found_serial(&disk, &record), 2);
	disk.full = false;
	assert_int_equal(record_save(&record, VERSION, &payload, sizeof(payload)), 0);
	assert_int_equal(found_serial(&disk, &record), 3);
}

static void damage_of_any_byte_falls_back_to_the_generation_before(void **state)
{
	(void)state;
	struct disk disk;
	struct record record;
	disk_init(&disk);
	assert_int_equal(save_until_cut(&disk, 1, 4), 4);
	found_serial(&disk, &record);
	struct content *newest = &disk.inodes[name_of(disk.now, record.path[record.newest], false)->inode].now;
	for (size_t i = 0; i < newest->size; i++) {
		for (int bit = 0; bit < 8; bit++) {
			newest->bytes[i] ^= (uint8_t)(1 << bit);
			assert_int_equal(found_serial(&disk, &record), 3);
			newest->bytes[i] ^= (uint8_t)(1 << bit);
		}
	}
	for (size_t size = newest->size; size-- > 0;) {
		newest->size = size;
		assert_int_equal(found_serial(&disk, &record), 3);
	}
}

static void another_version_is_not_read_and_not_lost_at_once(void **state)
{
	(void)state;
	struct disk disk;
	struct record record;
	struct payload payload = payload_of(1), found;
	disk_init(&disk);
	assert_int_equal(record_open(&record, &disk_ops, &disk, "/state", "position", VERSION + 1, &found, 8), 0);
	assert_int_equal(record_save(&record, VERSION + 1, &payload, sizeof(payload)), 0);
	assert_int_equal(found_serial(&disk, &record), 0);
	assert_int_equal(record_save(&record, VERSION, &payload, sizeof(payload)), 0);
	assert_int_equal(found_serial(&disk, &record), 1);
	assert_non_null(name_of(disk.now, "/state/position.0", false));
	assert_non_null(name_of(disk.now, "/state/position.1", false));
}

/* On the real file system: a process that saves without a pause is killed, again and again. */
static void kill_9_loses_nothing_that_was_saved(void **state)
{
	(void)state;
	char folder[] = "/tmp/blvd_record_XXXXXX";
	assert_non_null(mkdtemp(folder));
	struct record record;
	struct payload found;
	uint32_t last = 0;
	for (int round = 0; round < 8; round++) {
		int told[2];
		assert_int_equal(pipe(told), 0);
		pid_t child = fork();
		assert_true(child >= 0);
		if (child == 0) {
			record_open(&record, &file_ops_system, NULL, folder, "position", VERSION, &found, sizeof(found));
			for (uint32_t serial = last + 1;; serial++) {
				struct payload payload = payload_of(serial);
				if (record_save(&record, VERSION, &payload, sizeof(payload)) ||
					write(told[1], &serial, sizeof(serial)) != sizeof(serial))
					_exit(1);
			}
		}
		close(told[1]);
		uint32_t done = 0;
		for (int i = 0; i < 3 + round; i++)
			assert_int_equal(read(told[0], &done, sizeof(done)), sizeof(done));
		usleep((useconds_t)(round * 130));
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
		for (uint32_t more; read(told[0], &more, sizeof(more)) == sizeof(more);)
			done = more;
		close(told[0]);
		int size = record_open(&record, &file_ops_system, NULL, folder, "position", VERSION, &found, sizeof(found));
		assert_int_equal(size, sizeof(found));
		assert_in_range(found.serial, done, done + 1);
		last = found.serial;
	}
	unlink(record.path[0]);
	unlink(record.path[1]);
	unlink(record.part);
	rmdir(folder);
}

/* A folder that is not there, cannot be written, or is a file. */
static void a_folder_that_cannot_be_used_is_an_error_of_the_save_alone(void **state)
{
	(void)state;
	static const struct {
		const char *folder;
		int error;
	} cases[] = { { "/nowhere/at/all", -ENOENT }, { "/dev/null", -ENOTDIR } };
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct record record;
		struct payload payload = payload_of(1);
		assert_int_equal(record_open(&record, &file_ops_system, NULL, cases[i].folder, "position", VERSION, &payload,
							 sizeof(payload)),
			0);
		assert_int_equal(record_save(&record, VERSION, &payload, sizeof(payload)), cases[i].error);
	}
	char longer[RECORD_PATH_MAX];
	struct record record;
	memset(longer, 'x', sizeof(longer));
	longer[sizeof(longer) - 1] = 0;
	assert_int_equal(record_open(&record, &file_ops_system, NULL, longer, "p", VERSION, longer, 1), -ENAMETOOLONG);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_cut_at_any_step_or_byte_leaves_the_newest_whole_record),
		cmocka_unit_test(a_full_disk_keeps_what_was_and_leaves_no_part),
		cmocka_unit_test(damage_of_any_byte_falls_back_to_the_generation_before),
		cmocka_unit_test(another_version_is_not_read_and_not_lost_at_once),
		cmocka_unit_test(kill_9_loses_nothing_that_was_saved),
		cmocka_unit_test(a_folder_that_cannot_be_used_is_an_error_of_the_save_alone),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
