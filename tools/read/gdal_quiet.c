#include "tools/read/gdal_quiet.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>
#include <stdbool.h>

void gdal_start(void)
{
	static bool started;
	if (started)
		return;
	started = true;
	/* Nothing beside the inputs may be read or written: no side files, no network. */
	CPLSetConfigOption("GDAL_PAM_ENABLED", "NO");
	CPLSetConfigOption("GDAL_DISABLE_READDIR_ON_OPEN", "TRUE");
	CPLSetConfigOption("SHAPE_RESTORE_SHX", "YES");
	CPLSetErrorHandler(CPLQuietErrorHandler);
	GDALAllRegister();
}

const char *gdal_reason(const char *otherwise)
{
	const char *message = CPLGetLastErrorMsg();
	return message && *message ? message : otherwise;
}
